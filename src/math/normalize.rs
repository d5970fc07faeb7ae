//! Directions of vectors of any length.

use glam::Vec3;

use super::V3;

/// `v / |v|`, or `fallback` where the length is zero or not finite.
#[must_use]
pub fn normalize_or(v: Vec3, fallback: Vec3) -> Vec3 {
    V3::from(v).normalize_or(fallback.into()).into()
}
