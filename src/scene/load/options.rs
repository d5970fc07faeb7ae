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

/// Shared between the thread that loads and the one that watches.
#[derive(Debug, Default)]
pub struct LoadMonitor {
    cancelled: AtomicBool,
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

    /// Called by the loader at every stage: notes the share done.
    ///
    /// # Errors
    /// [`LoadError::Cancelled`] once the load was cancelled.
    pub fn reached(&self, fraction: f32) -> Result<(), LoadError> {
        self.permille.store(
            (fraction.clamp(0.0, 1.0) * 1000.0) as u32,
            Ordering::Relaxed,
        );
        if self.cancelled.load(Ordering::Relaxed) {
            Err(LoadError::Cancelled)
        } else {
            Ok(())
        }
    }
}
