//! Between the user's units and the internal ones.

use glam::{DVec3, Vec3};

/// `internal = (world − center) · scale`, with `scale` a power of two.
///
/// Centring and scaling in `f64` before the cast to `f32` removes what global scale and offset would
/// do to single-precision rays. A power of two changes no mantissa.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Normalization {
    /// World point that becomes the internal origin.
    pub center: DVec3,
    /// Internal units per world unit: a power of two.
    pub scale: f64,
}

impl Normalization {
    /// No change: internal units are world units.
    pub const IDENTITY: Self = Self {
        center: DVec3::ZERO,
        scale: 1.0,
    };

    /// Centres the box and scales it so that its largest extent is in `[1, 2)`.
    ///
    /// A box without extent (one point) or with non-finite corners is only centred, or left alone.
    #[must_use]
    pub fn fit(min: DVec3, max: DVec3) -> Self {
        if !(min.is_finite() && max.is_finite()) {
            return Self::IDENTITY;
        }
        let center = min * 0.5 + max * 0.5;
        let extent = (max - min).max_element();
        let scale = if extent > 0.0 && extent.is_finite() {
            // Exponents beyond ±1000 would overflow the power itself.
            2.0_f64.powi(-(extent.log2().floor().clamp(-1000.0, 1000.0) as i32))
        } else {
            1.0
        };
        Self { center, scale }
    }

    /// A world point in internal coordinates.
    #[must_use]
    pub fn internal_from_world(&self, p: DVec3) -> Vec3 {
        ((p - self.center) * self.scale).as_vec3()
    }

    /// An internal point in world coordinates.
    #[must_use]
    pub fn world_from_internal(&self, p: Vec3) -> DVec3 {
        p.as_dvec3() / self.scale + self.center
    }

    /// A world length in internal units.
    #[must_use]
    pub fn internal_length(&self, length: f64) -> f32 {
        (length * self.scale) as f32
    }

    /// An internal length in world units.
    #[must_use]
    pub fn world_length(&self, length: f32) -> f64 {
        f64::from(length) / self.scale
    }
}
