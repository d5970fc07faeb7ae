//! The window: the picture fills it, a panel edits the settings, a worker renders.
//!
//! - `app`: the frame loop: collect what the threads brought, take input, draw, send what changed
//! - `worker`: the rendering thread
//! - `loader`, `loading`, `dialogs`: files, on threads of their own, and how far they are
//! - `feel`: a scripted hand, for measuring
//! - `document`: what is open, and undo
//! - `viewport`, `picking`, `light_markers`: the mouse in the picture
//! - `comparison`, `compare_view`: two methods in one view, and how far they are apart; `legend`: what colours mean
//! - `panels`, `status`, `windows`, `toasts`, `widgets`, `color_edit`, `theme`: what is drawn over it
//! - `trade`: what accuracy costs, measured on a thread of its own
//! - `commands`: the table behind keys, menu and help
//!
//! Settings travel back by cost: panels edit three plain structs in place (display, render, source), and
//! after them the app compares with what it last sent. There are no dirty flags and no callbacks.

mod app;
mod color_edit;
pub mod commands;
mod compare_view;
pub mod comparison;
mod dialogs;
pub mod document;
mod feel;
mod legend;
mod light_markers;
mod loader;
mod loading;
mod meter;
mod pacing;
pub mod panels;
mod picking;
mod preferences;
pub mod status;
mod still;
pub mod story;
mod theme;
mod toasts;
pub mod trade;
mod viewport;
mod widgets;
mod windows;
pub mod worker;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;

pub use app::ViewerApp;
pub use feel::{FeelOptions, Felt, measure_feel};

/// What the command line says about the window.
#[derive(Debug, Clone, Default)]
pub struct ViewOptions {
    /// What to open; `None` for the first built-in scene.
    pub input: Option<PathBuf>,
    /// Worker threads, 0 for one per core.
    pub threads: usize,
    /// Centre and scale models when they are loaded.
    pub normalize: bool,
}

/// Why no window could be shown.
#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    /// There is nothing to show it on.
    #[error(
        "no display: neither DISPLAY nor WAYLAND_DISPLAY is set; `reliefscope render` works without one"
    )]
    NoDisplay,
    /// The window system refused.
    #[error("no window could be opened: {0}; `reliefscope render` works without one")]
    Window(String),
    /// Somebody closed the window before everything was measured.
    #[error("the window was closed before everything was measured")]
    Closed,
}

/// Size of the window when it opens, points.
const WINDOW: [u32; 2] = [1280, 720];

/// Shows the window until it is closed.
///
/// # Errors
/// [`ViewError`], one line for the user, where no window can be shown.
pub fn run(options: ViewOptions) -> Result<(), ViewError> {
    show_window(WINDOW, Memory::Kept, |creation| {
        Ok(Box::new(ViewerApp::new(creation, options)?))
    })
}

/// What a window knows of those before it: size, place, what is folded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Memory {
    /// As the user left the last one, and keeps it.
    Kept,
    /// Nothing, and leaves nothing.
    Blank,
}

/// Shows a window until it is closed.
fn show_window(
    size: [u32; 2],
    memory: Memory,
    app: impl FnOnce(&eframe::CreationContext<'_>) -> std::io::Result<Box<dyn eframe::App>>,
) -> Result<(), ViewError> {
    if !has_display() {
        return Err(ViewError::NoDisplay);
    }
    let native = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("Reliefscope")
            .with_app_id("reliefscope")
            .with_inner_size(size.map(|n| n as f32))
            .with_min_inner_size([480.0, 320.0])
            .with_drag_and_drop(true),
        dithering: false,
        persist_window: memory == Memory::Kept,
        // A file that is not there, and that nothing is written to.
        persistence_path: (memory == Memory::Blank)
            .then(|| std::env::temp_dir().join(format!("reliefscope-{}.ron", std::process::id()))),
        ..eframe::NativeOptions::default()
    };
    // Without a server the window system's libraries panic instead of returning an error.
    let quiet = QuietPanics::begin();
    let shown = catch_unwind(AssertUnwindSafe(|| {
        eframe::run_native(
            "reliefscope",
            native,
            Box::new(move |creation| {
                quiet.end();
                Ok(app(creation)?)
            }),
        )
    }));
    match shown {
        Ok(result) => result.map_err(|error| ViewError::Window(one_line(&error.to_string()))),
        Err(panic) => Err(ViewError::Window(one_line(&panic_text(&*panic)))),
    }
}

/// On X11 and Wayland systems the environment says whether there is a display.
fn has_display() -> bool {
    if cfg!(any(target_os = "windows", target_os = "macos")) {
        return true;
    }
    let set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    set("DISPLAY") || set("WAYLAND_DISPLAY") || set("WAYLAND_SOCKET")
}

type Hook = Box<dyn Fn(&std::panic::PanicHookInfo<'_>) + Sync + Send + 'static>;

/// Keeps panics from printing until the window stands: they become an error of one line.
struct QuietPanics(Option<Hook>);

impl QuietPanics {
    fn begin() -> Self {
        let hook = std::panic::take_hook();
        std::panic::set_hook(Box::new(|_| {}));
        Self(Some(hook))
    }

    fn end(mut self) {
        self.restore();
    }

    fn restore(&mut self) {
        if let Some(hook) = self.0.take() {
            std::panic::set_hook(hook);
        }
    }
}

impl Drop for QuietPanics {
    fn drop(&mut self) {
        // The hook cannot be changed while unwinding; the program ends then anyway.
        if !std::thread::panicking() {
            self.restore();
        }
    }
}

fn panic_text(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "the window system failed".into())
}

/// One line without the place in a library's source that some errors begin with.
fn one_line(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let after_place = line
        .rsplit_once(".rs:")
        .and_then(|(_, rest)| rest.split_once(": "));
    after_place.map_or(line.clone(), |(_, cause)| cause.to_owned())
}

#[cfg(test)]
mod tests {
    use super::one_line;

    #[test]
    fn errors_of_the_window_system_fit_on_a_line() {
        let long = "os error at lib/mod.rs:788: Failed to open\n  connection to X server";
        assert_eq!(one_line(long), "Failed to open connection to X server");
        assert_eq!(one_line("no\nGL"), "no GL");
    }
}
