//! How to load, how far a load is, and how to stop it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use super::super::LoadError;

/// How to load.
#[derive(Debug, Clone)]
pub struct LoadOptions {
    /// Centre the model and scale it by a power of two, in `f64`, before rounding to `f32`.
    pub normalize: bool,
    /// Watches and stops the load.
    pub monitor: Arc<LoadMonitor>,
}

impl Default for LoadOptions {
    fn default() -> Self {
        Self {
            normalize: true,
            monitor: Arc::default(),
        }
    }
}

/// What a load is busy with. Stages follow one another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// The file's bytes come in.
    Reading,
    /// Text becomes vertices and faces.
    Parsing,
    /// Faces become triangles with normals.
    Assembling,
    /// Material libraries and pictures.
    Materials,
    /// The tree over the triangles.
    Tree,
}

impl Stage {
    /// All, in their order.
    pub const ALL: [Self; 5] = [
        Self::Reading,
        Self::Parsing,
        Self::Assembling,
        Self::Materials,
        Self::Tree,
    ];

    /// What the window shows.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Reading => "reading",
            Self::Parsing => "parsing",
            Self::Assembling => "joining triangles",
            Self::Materials => "reading materials",
            Self::Tree => "building the tree",
        }
    }

    /// The thousandth of the whole at which it begins: shares of the time that a large model without
    /// pictures takes.
    const fn begin(self) -> u32 {
        match self {
            Self::Reading => 0,
            Self::Parsing => 100,
            Self::Assembling => 450,
            Self::Materials => 600,
            Self::Tree => 650,
        }
    }

    fn end(self) -> u32 {
        let next = Self::ALL.get(self as usize + 1);
        next.map_or(1000, |stage| stage.begin())
    }
}

/// Shared between the threads that load and the one that watches.
#[derive(Debug, Default)]
pub struct LoadMonitor {
    cancelled: AtomicBool,
    /// Thousandths of the whole; never less than before.
    permille: AtomicU32,
}

impl LoadMonitor {
    /// Asks the load to stop; it then returns [`LoadError::Cancelled`] soon.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Share of the work done, 0…1.
    #[must_use]
    pub fn fraction(&self) -> f32 {
        self.permille.load(Ordering::Relaxed) as f32 / 1000.0
    }

    /// What the load is busy with.
    #[must_use]
    pub fn stage(&self) -> Stage {
        let done = self.permille.load(Ordering::Relaxed);
        let begun = |stage: &Stage| stage.begin() <= done;
        let stage = Stage::ALL.into_iter().rev().find(begun);
        stage.unwrap_or(Stage::Reading)
    }

    /// Called by the loader every few milliseconds, from any thread: notes the share of a stage that is
    /// done, 0…1.
    ///
    /// # Errors
    /// [`LoadError::Cancelled`] once the load was cancelled.
    pub fn reached(&self, stage: Stage, share: f32) -> Result<(), LoadError> {
        let (begin, end) = (stage.begin(), stage.end());
        let done = begin + (share.clamp(0.0, 1.0) * (end - begin) as f32) as u32;
        self.permille.fetch_max(done, Ordering::Relaxed);
        self.check()
    }

    /// Whether to go on, where nothing can be said about progress.
    ///
    /// # Errors
    /// [`LoadError::Cancelled`] once the load was cancelled.
    pub fn check(&self) -> Result<(), LoadError> {
        if self.cancelled.load(Ordering::Relaxed) {
            Err(LoadError::Cancelled)
        } else {
            Ok(())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_follow_one_another_and_progress_never_falls() {
        let monitor = LoadMonitor::default();
        let mut before = 0.0;
        for stage in Stage::ALL {
            for share in [0.0, 0.5, 0.25, 0.99] {
                assert!(monitor.reached(stage, share).is_ok());
                assert_eq!(monitor.stage(), stage);
                assert!(monitor.fraction() >= before);
                before = monitor.fraction();
            }
        }
        assert!(monitor.reached(Stage::Tree, 1.0).is_ok());
        assert_eq!(monitor.fraction(), 1.0);
        monitor.cancel();
        assert!(matches!(monitor.check(), Err(LoadError::Cancelled)));
    }
}
