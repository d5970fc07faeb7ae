//! Sixty pictures a second are enough where the processor draws the window too.
//!
//! Software OpenGL has no vertical sync to wait for, and repainting at every mouse event would take the cores
//! that render. Only this file and the worker read a clock.

use std::path::Path;
use std::time::{Duration, Instant};

use eframe::glow::HasContext as _;

/// Shortest interval between two pictures under software OpenGL.
const INTERVAL: Duration = Duration::from_micros(16_400);

/// Delays a picture that comes too early.
#[derive(Debug, Default)]
pub struct Pacing {
    software: bool,
    last: Option<Instant>,
}

impl Pacing {
    /// Looks at how the window is drawn; without a context (tests) nothing is delayed.
    #[must_use]
    pub fn new(gl: Option<&eframe::glow::Context>) -> Self {
        Self {
            software: gl.is_some_and(is_software),
            last: None,
        }
    }

    /// Called at the start of every picture.
    pub fn wait(&mut self) {
        if !self.software {
            return;
        }
        if let Some(rest) = self
            .last
            .and_then(|last| INTERVAL.checked_sub(last.elapsed()))
        {
            std::thread::sleep(rest);
        }
        self.last = Some(Instant::now());
    }
}

/// Whether Mesa draws without a graphics card.
///
/// The name of the renderer (llvmpipe, softpipe) can only be asked for through an unsafe call, so this asks
/// for what makes Mesa fall back on them: no render node, or the user's wish.
fn is_software(gl: &eframe::glow::Context) -> bool {
    let mesa = gl.version().vendor_info.contains("Mesa");
    let wished = |name: &str| std::env::var_os(name);
    let forced = wished("LIBGL_ALWAYS_SOFTWARE")
        .is_some_and(|value| value != "0" && value != "false")
        || wished("GALLIUM_DRIVER").is_some_and(|name| name == "llvmpipe" || name == "softpipe");
    mesa && (forced || !has_render_node())
}

fn has_render_node() -> bool {
    let nodes = std::fs::read_dir(Path::new("/dev/dri"));
    nodes.is_ok_and(|entries| {
        let mut names = entries.flatten().map(|entry| entry.file_name());
        names.any(|name| name.to_string_lossy().starts_with("renderD"))
    })
}
