//! Sixty pictures a second are enough where the processor draws the window too.
//!
//! Software OpenGL has no vertical sync to wait for, and repainting at every mouse event would take the cores
//! that render. So the window rests between taking the input and drawing, and shows in the same frame what
//! the worker makes of that input meanwhile. Only the viewer's `worker`, `feel` and this file read a clock.

use std::path::Path;
use std::time::{Duration, Instant};

use eframe::glow::HasContext as _;
use egui::TextureOptions;

use super::worker::{FIRST_PASS_MILLIS, RenderWorker};

/// Shortest interval between two pictures under software OpenGL.
const INTERVAL: Duration = Duration::from_micros(16_400);
/// Longest wait for a picture. Drawing the window without one costs as much, and shows nothing new.
const PATIENCE: Duration = Duration::from_millis(50);
/// Share of what is left of the interval that a first pass may take: encoding needs the rest.
const PASS_SHARE: f32 = 0.85;
/// First passes are allowed this much even where drawing takes all of the interval, milliseconds.
const LEAST_PASS_MILLIS: f32 = 4.0;

/// The window's clock; delays a picture that comes too early.
#[derive(Debug)]
pub struct Pacing {
    software: bool,
    started: Instant,
    /// When this frame took its input.
    began: Instant,
    /// When the last frame went to be drawn.
    drawn: Option<Instant>,
    /// Time that the worker has nothing to do because the window is drawn, or the least of it seen lately.
    drawing: Duration,
}

impl Pacing {
    /// Looks at how the window is drawn; without a context (tests) nothing is delayed.
    #[must_use]
    pub fn new(gl: Option<&eframe::glow::Context>) -> Self {
        let now = Instant::now();
        Self {
            software: gl.is_some_and(is_software),
            started: now,
            began: now,
            drawn: None,
            drawing: INTERVAL,
        }
    }

    /// Called when a frame has just taken its input.
    pub fn begin(&mut self) {
        self.began = Instant::now();
    }

    /// How the picture is stretched. The picture itself looks the same either way; of a preview, the processor
    /// draws plain blocks in half the time.
    #[must_use]
    pub const fn filter(&self) -> TextureOptions {
        if self.software {
            TextureOptions::NEAREST
        } else {
            TextureOptions::LINEAR
        }
    }

    /// Whether the processor draws the window.
    #[must_use]
    pub const fn is_software(&self) -> bool {
        self.software
    }

    /// When this frame took its input, seconds.
    #[must_use]
    pub fn began_secs(&self) -> f64 {
        (self.began - self.started).as_secs_f64()
    }

    /// Now, seconds.
    #[must_use]
    pub fn now_secs(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }

    /// How long a first pass may take, milliseconds.
    #[must_use]
    pub fn first_pass_millis(&self) -> f32 {
        if !self.software {
            return FIRST_PASS_MILLIS;
        }
        let left = INTERVAL.saturating_sub(self.drawing).as_secs_f32() * 1e3;
        (left * PASS_SHARE).max(LEAST_PASS_MILLIS)
    }

    /// Called once a frame has told the worker what it wants: waits for the picture if `wants_picture`, and for
    /// the end of the interval.
    pub fn wait(&mut self, worker: &RenderWorker, wants_picture: bool) {
        if !self.software {
            return;
        }
        if let Some(drawn) = self.drawn {
            // Pauses of the hand look like drawing; a drag soon corrects that.
            let gap = drawn.elapsed();
            self.drawing = gap.min(self.drawing + self.drawing / 16).min(INTERVAL);
        }
        if wants_picture {
            worker.wait_for_frame(PATIENCE);
        }
        let early = self.drawn.map(|drawn| drawn + INTERVAL);
        if let Some(rest) = early.and_then(|end| end.checked_duration_since(Instant::now())) {
            std::thread::sleep(rest);
        }
        self.drawn = Some(Instant::now());
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
