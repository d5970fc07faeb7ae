//! What was really computed.

use std::ops::AddAssign;

use serde::Serialize;

/// Exact counts of work. A feature that the scene does not use must leave its count at 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Counters {
    /// Camera rays traced (cached hits are not traced again).
    pub camera_rays: u64,
    /// Shadow rays traced.
    pub shadow_rays: u64,
    /// Mirror reflection rays traced.
    pub mirror_rays: u64,
    /// Bilinear look-ups in any map.
    pub texture_fetches: u64,
    /// Surface points whose normal or texture coordinate a map changed.
    pub perturbations: u64,
    /// Powers taken for highlights.
    pub power_calls: u64,
    /// Cut-out decisions taken for eye, mirror and shadow rays.
    pub cutout_tests: u64,
    /// Height samples and pyramid nodes that searches and relief shadows looked at.
    pub relief_steps: u64,
    /// Points asked whether their own relief shadows them.
    pub relief_shadow_walks: u64,
    /// Walks of these and over flat displaced surfaces that a horizon spared.
    pub walks_spared: u64,
    /// Samples that were not finite and counted as black.
    pub non_finite: u64,
}

impl Counters {
    /// Nothing yet.
    pub const ZERO: Self = Self {
        camera_rays: 0,
        shadow_rays: 0,
        mirror_rays: 0,
        texture_fetches: 0,
        perturbations: 0,
        power_calls: 0,
        cutout_tests: 0,
        relief_steps: 0,
        relief_shadow_walks: 0,
        walks_spared: 0,
        non_finite: 0,
    };

    /// Rays of all kinds.
    #[must_use]
    pub const fn rays(&self) -> u64 {
        self.camera_rays + self.shadow_rays + self.mirror_rays
    }
}

impl AddAssign for Counters {
    fn add_assign(&mut self, o: Self) {
        self.camera_rays += o.camera_rays;
        self.shadow_rays += o.shadow_rays;
        self.mirror_rays += o.mirror_rays;
        self.texture_fetches += o.texture_fetches;
        self.perturbations += o.perturbations;
        self.power_calls += o.power_calls;
        self.cutout_tests += o.cutout_tests;
        self.relief_steps += o.relief_steps;
        self.relief_shadow_walks += o.relief_shadow_walks;
        self.walks_spared += o.walks_spared;
        self.non_finite += o.non_finite;
    }
}
