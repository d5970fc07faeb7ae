//! Scenes and pictures are read on threads of their own; the window stays alive meanwhile.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use super::loading::Loading;
use crate::scene::load::{LoadMonitor, LoadOptions, PictureError, PictureStore};
use crate::scene::{LoadError, LoadedScene, Scene, open};

/// A picture that found its way into a scene.
pub struct AddedPicture {
    /// The scene with the picture behind the others.
    pub scene: Arc<Scene>,
    /// Index of the picture.
    pub image: usize,
    /// The scene it was added to; if another one is open by now, the result is of no use.
    pub before: Arc<Scene>,
    /// Material that wants it.
    pub material: usize,
    /// Slot whose picture it replaces; `None` makes a new slot.
    pub slot: Option<usize>,
}

/// What a loading thread brought.
pub enum Loaded {
    /// A scene, and what was asked for.
    Scene(PathBuf, Box<Result<LoadedScene, LoadError>>),
    /// A picture.
    Picture(PathBuf, Result<AddedPicture, String>),
}

struct Active {
    input: PathBuf,
    monitor: Arc<LoadMonitor>,
    result: Receiver<Loaded>,
}

/// The loads under way: one scene at most, any number of pictures.
pub struct Loader {
    normalize: bool,
    wake_window: Arc<dyn Fn() + Send + Sync>,
    scene: Option<Active>,
    pictures: Vec<(PathBuf, Receiver<Loaded>)>,
}

impl Loader {
    /// Nothing is loading yet. `wake_window` is called from the threads when they are done.
    pub fn new(normalize: bool, wake_window: impl Fn() + Send + Sync + 'static) -> Self {
        Self {
            normalize,
            wake_window: Arc::new(wake_window),
            scene: None,
            pictures: Vec::new(),
        }
    }

    /// Opens a model, a scene file or a built-in scene. A load under way is cancelled.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn open(&mut self, input: PathBuf) -> std::io::Result<()> {
        self.open_as(input, self.normalize)
    }

    /// [`Self::open`], normalised or not whatever the others are.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn open_as(&mut self, input: PathBuf, normalize: bool) -> std::io::Result<()> {
        self.cancel();
        let monitor = Arc::new(LoadMonitor::default());
        let options = LoadOptions {
            normalize,
            monitor: Arc::clone(&monitor),
        };
        let path = input.clone();
        let result = self.spawn(move || {
            let result = open(&path, &options);
            Loaded::Scene(path, Box::new(result))
        })?;
        self.scene = Some(Active {
            input,
            monitor,
            result,
        });
        Ok(())
    }

    /// Decodes a picture and puts it into a copy of the scene, for a material's slot.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn add_picture(
        &mut self,
        scene: &Arc<Scene>,
        path: PathBuf,
        (material, slot): (usize, Option<usize>),
    ) -> std::io::Result<()> {
        let (before, file) = (Arc::clone(scene), path.clone());
        let result = self.spawn(move || {
            let added = with_picture(&before, &file).map(|(scene, image)| AddedPicture {
                scene,
                image,
                before,
                material,
                slot,
            });
            Loaded::Picture(file, added.map_err(|error| error.to_string()))
        })?;
        self.pictures.push((path, result));
        Ok(())
    }

    fn spawn(
        &self,
        work: impl FnOnce() -> Loaded + Send + 'static,
    ) -> std::io::Result<Receiver<Loaded>> {
        let (sender, receiver) = channel();
        let wake = Arc::clone(&self.wake_window);
        std::thread::Builder::new()
            .name("load".into())
            .spawn(move || {
                // Dropped on a panic too: the window then learns of it from the closed channel.
                let waker = WakeOnDrop(wake);
                // Nobody listens any more if the load was replaced by another.
                let _ = sender.send(work());
                drop(sender);
                drop(waker);
            })?;
        Ok(receiver)
    }

    /// Asks the scene's load to stop and forgets it.
    pub fn cancel(&mut self) {
        if let Some(active) = self.scene.take() {
            active.monitor.cancel();
        }
    }

    /// What is loading, the scene first.
    #[must_use]
    pub fn progress(&self) -> Option<Loading> {
        let name = |path: &Path| {
            let name = path.file_name().unwrap_or(path.as_os_str());
            name.to_string_lossy().into_owned()
        };
        let scene = self.scene.as_ref().map(|active| Loading {
            name: name(&active.input),
            progress: Some((active.monitor.stage(), active.monitor.fraction())),
        });
        let picture = self.pictures.first().map(|(path, _)| Loading {
            name: name(path),
            progress: None,
        });
        scene.or(picture)
    }

    /// Whether anything is loading.
    #[must_use]
    pub const fn is_loading(&self) -> bool {
        self.scene.is_some() || !self.pictures.is_empty()
    }

    /// Something that is done, once.
    pub fn poll(&mut self) -> Option<Loaded> {
        if let Some(active) = &self.scene
            && let Some(done) = received(&active.result, || {
                Loaded::Scene(active.input.clone(), Box::new(Err(crashed(&active.input))))
            })
        {
            self.scene = None;
            return Some(done);
        }
        for (i, (path, result)) in self.pictures.iter().enumerate() {
            let crash = || Loaded::Picture(path.clone(), Err(crashed(path).to_string()));
            if let Some(done) = received(result, crash) {
                self.pictures.remove(i);
                return Some(done);
            }
        }
        None
    }
}

impl Drop for Loader {
    fn drop(&mut self) {
        self.cancel();
    }
}

struct WakeOnDrop(Arc<dyn Fn() + Send + Sync>);

impl Drop for WakeOnDrop {
    fn drop(&mut self) {
        (self.0)();
    }
}

fn received(result: &Receiver<Loaded>, crash: impl FnOnce() -> Loaded) -> Option<Loaded> {
    match result.try_recv() {
        Ok(loaded) => Some(loaded),
        Err(TryRecvError::Empty) => None,
        Err(TryRecvError::Disconnected) => Some(crash()),
    }
}

/// A panic while loading is our fault; the user learns which file caused it.
fn crashed(path: &Path) -> LoadError {
    LoadError::Invalid {
        path: path.to_owned(),
        line: None,
        message: "the loader crashed on this file; please report it".into(),
    }
}

/// A scene that has the picture too, and its index. A file that is there already is not decoded again.
fn with_picture(scene: &Arc<Scene>, path: &Path) -> Result<(Arc<Scene>, usize), PictureError> {
    let mut store = PictureStore::with_images(scene.images.clone());
    let (image, _remark) = store.load(path)?;
    if image < scene.images.len() {
        return Ok((Arc::clone(scene), image));
    }
    let mut scene = Scene::clone(scene);
    scene.images = store.images;
    Ok((Arc::new(scene), image))
}
