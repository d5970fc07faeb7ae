//! Native file dialogs on a thread of their own.

use std::future::Future;
use std::path::PathBuf;
use std::pin::pin;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::task::{Context, Poll, Wake, Waker};
use std::thread::Thread;

use rfd::AsyncFileDialog;

/// Endings of pictures that can be opened.
pub const PICTURES: [&str; 11] = [
    "png", "jpg", "jpeg", "tga", "bmp", "tif", "tiff", "hdr", "exr", "webp", "gif",
];

/// What a chosen file is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// Open a model or scene file.
    Open,
    /// Write a scene file.
    SaveScene,
    /// Write the picture.
    SavePicture,
    /// Put a picture on a material: its index, and the slot to replace.
    Picture(usize, Option<usize>),
}

/// The dialog that is open, if any.
pub struct Dialogs {
    wake_window: Arc<dyn Fn() + Send + Sync>,
    open: Option<(Purpose, Receiver<Option<PathBuf>>)>,
}

impl Dialogs {
    /// No dialog is open. `wake_window` is called when one is closed.
    pub fn new(wake_window: impl Fn() + Send + Sync + 'static) -> Self {
        Self {
            wake_window: Arc::new(wake_window),
            open: None,
        }
    }

    /// Shows a dialog unless one is open. `name` is proposed for a file to be written.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn ask(&mut self, purpose: Purpose, name: &str) -> std::io::Result<()> {
        if self.open.is_some() {
            return Ok(());
        }
        let (sender, receiver) = channel();
        let wake = Arc::clone(&self.wake_window);
        let thread = std::thread::Builder::new().name("dialog".into());
        let dialog = AsyncFileDialog::new();
        // The futures are made here: some systems insist that dialogs start on the window's thread.
        let chosen: std::pin::Pin<Box<dyn Future<Output = _> + Send>> = match purpose {
            Purpose::Open => Box::pin(
                dialog
                    .set_title("Open a model or scene")
                    .add_filter("Models and scenes", &["obj", "toml"])
                    .add_filter("All files", &["*"])
                    .pick_file(),
            ),
            Purpose::SaveScene => Box::pin(
                dialog
                    .set_title("Save the scene")
                    .add_filter("Scene", &["toml"])
                    .set_file_name(name)
                    .save_file(),
            ),
            Purpose::SavePicture => Box::pin(
                dialog
                    .set_title("Save the picture")
                    .add_filter("PNG, as shown", &["png"])
                    .add_filter("OpenEXR, linear", &["exr"])
                    .set_file_name(name)
                    .save_file(),
            ),
            Purpose::Picture(..) => Box::pin(
                dialog
                    .set_title("Choose a picture")
                    .add_filter("Pictures", &PICTURES)
                    .pick_file(),
            ),
        };
        thread.spawn(move || {
            let file = block_on(chosen).map(|handle| handle.path().to_owned());
            // The window may be gone.
            let _ = sender.send(file);
            wake();
        })?;
        self.open = Some((purpose, receiver));
        Ok(())
    }

    /// The answer of a closed dialog, once; `None` inside if nothing was chosen.
    pub fn poll(&mut self) -> Option<(Purpose, Option<PathBuf>)> {
        let (purpose, receiver) = self.open.as_ref()?;
        let answer = match receiver.try_recv() {
            Ok(file) => (*purpose, file),
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => (*purpose, None),
        };
        self.open = None;
        Some(answer)
    }
}

struct Unpark(Thread);

impl Wake for Unpark {
    fn wake(self: Arc<Self>) {
        self.0.unpark();
    }
}

/// Runs one future to its end on this thread; an executor would be a big dependency for that.
fn block_on<T>(future: impl Future<Output = T>) -> T {
    let waker = Waker::from(Arc::new(Unpark(std::thread::current())));
    let mut context = Context::from_waker(&waker);
    let mut future = pin!(future);
    loop {
        match future.as_mut().poll(&mut context) {
            Poll::Ready(value) => return value,
            Poll::Pending => std::thread::park(),
        }
    }
}
