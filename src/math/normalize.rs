//! Normalisation that cannot produce NaN.

use glam::Vec3;

/// `v / |v|`, or `fallback` where the length is zero, not finite or under- or overflows.
#[must_use]
pub fn normalize_or(v: Vec3, fallback: Vec3) -> Vec3 {
    let largest = v.abs().max_element();
    if !(largest > 0.0 && largest.is_finite()) {
        return fallback;
    }
    // Scaling first keeps the squared length inside the range of f32 for lengths of 10^±30.
    let scaled = if (1e-15..1e15).contains(&largest) {
        v
    } else {
        v / largest
    };
    let length = scaled.length();
    if length > 0.0 {
        scaled / length
    } else {
        fallback
    }
}
