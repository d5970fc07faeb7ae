//! Diffuse and specular reflection of one light (report 2.10–2.14, corrected).

use glam::Vec3;

/// Above this exponent the power is taken through the angle between the two directions: a cosine near 1
/// has only steps of 6·10⁻⁸ in `f32`, which such a power turns into visible rings.
const SHARP_EXPONENT: f32 = 1e4;

/// Mirror image of the unit direction `w` about the unit normal: `R = 2 (N·w) N − w` (2.11–2.12).
#[must_use]
pub fn reflect(n: Vec3, w: Vec3) -> Vec3 {
    n * (2.0 * n.dot(w)) - w
}

/// `max(0, R·V)^s` for unit directions (2.13, the cosine clamped before the power).
///
/// `None` where the highlight points away from the eye, so that no power is taken. `0⁰` counts as 1.
#[must_use]
pub fn phong_lobe(r: Vec3, v: Vec3, exponent: f32) -> Option<f32> {
    let cos = r.dot(v);
    if !(cos > 0.0) {
        return None;
    }
    Some(if exponent > SHARP_EXPONENT {
        // 1 − cos = |R − V|² / 2 without cancellation.
        let miss = (0.5 * (r - v).length_squared()).min(1.0);
        (exponent * (-miss).ln_1p()).exp()
    } else {
        cos.min(1.0).powf(exponent)
    })
}

/// Direction of the mirror ray for an eye in direction `wo`, lifted so that it never enters the surface.
///
/// A tilted normal can send the mirror image of the eye below the geometric surface. Then the direction
/// is raised until it just leaves.
///
/// Source: Keller et al. 2017 (Iray), the treatment of reflections below the surface.
#[must_use]
pub fn mirror_direction(n_shade: Vec3, n_geo: Vec3, wo: Vec3) -> Vec3 {
    let r = reflect(n_shade, wo);
    let below = r.dot(n_geo);
    if below > 0.0 {
        return r;
    }
    let toward = n_shade.dot(n_geo).max(1e-3);
    let lifted = r + n_shade * ((below.abs() + 0.01) / toward);
    let lifted = crate::math::normalize_or(lifted, n_geo);
    // Rounding can leave a grazing direction a hair below: the surface's own plane is the limit.
    if lifted.dot(n_geo) > 0.0 {
        lifted
    } else {
        n_geo
    }
}
