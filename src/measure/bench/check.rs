//! What must be true before a time means anything.

use std::sync::Arc;

use crate::geometry::simd::SimdLevel;
use crate::render::Picture;
use crate::scene::Scene;

/// Why something could not be timed.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// The system gives no threads.
    #[error("cannot start worker threads: {0}")]
    Threads(std::io::Error),
    /// A bundle of rays did not find what single rays find.
    #[error(
        "wrong answer, so not timed: ray {ray} traced together with others differs from the same ray alone"
    )]
    Ray {
        /// Place in the list.
        ray: usize,
    },
    /// Two ways to the same picture differ.
    #[error("wrong answer, so not timed: {what} changes pixel {},{}", pixel[0], pixel[1])]
    Picture {
        /// What should have changed nothing.
        what: &'static str,
        /// Column and row of the first pixel that differs.
        pixel: [u32; 2],
    },
}

impl BenchError {
    /// Whether an answer was wrong, as opposed to there being none.
    #[must_use]
    pub const fn is_wrong_answer(&self) -> bool {
        matches!(self, Self::Ray { .. } | Self::Picture { .. })
    }
}

/// The same scene with a tree that traces one ray at a time.
#[must_use]
pub fn scalar_twin(scene: &Scene) -> Arc<Scene> {
    let mut twin = scene.clone();
    // No machine lacks scalar instructions.
    if let Ok(bvh) = twin.bvh.clone().with_level(SimdLevel::Scalar) {
        twin.bvh = bvh;
    }
    Arc::new(twin)
}

/// Pictures must agree in all bits; `what` made the difference.
pub(super) fn same_picture(what: &'static str, a: &Picture, b: &Picture) -> Result<(), BenchError> {
    let bits = |p: &Picture, i: usize| p.pixels[i].to_array().map(f32::to_bits);
    match (0..a.pixels.len()).find(|&i| bits(a, i) != bits(b, i)) {
        Some(i) => Err(BenchError::Picture {
            what,
            pixel: [i as u32 % a.width, i as u32 / a.width],
        }),
        None => Ok(()),
    }
}
