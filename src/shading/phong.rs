//! Diffuse and specular reflection of one light (report 2.10–2.14, corrected).

use std::ops::Mul;

use crate::math::{Mask as _, Real, V3, power_below_one};

/// Mirror image of the unit direction `w` about the unit normal: `R = 2 (N·w) N − w` (2.11–2.12).
#[inline(always)]
#[must_use]
pub fn reflect<F: Real>(n: V3<F>, w: V3<F>) -> V3<F> {
    n * (n.dot(w) * 2.0) - w
}

/// `max(0, R·V)^s` for unit directions (2.13, the cosine clamped before the power), and where the highlight
/// does not point away from the eye, so that a power was taken. `0⁰` counts as 1.
#[inline(always)]
#[must_use]
pub fn phong_lobe<F: Real + Mul<E, Output = F>, E>(
    r: V3<F>,
    v: V3<F>,
    exponent: E,
) -> (F, F::Mask) {
    let zero = r.x.splat(0.0);
    let faces = r.dot(v).gt(zero);
    if !faces.any() {
        return (zero, faces);
    }
    // 1 − cos = |R − V|² / 2 without cancellation.
    let apart = r - v;
    let miss = (apart.dot(apart) * 0.5).smaller(zero.splat(1.0));
    let lobe = power_below_one(miss, exponent);
    (F::select(faces, lobe, zero), faces)
}

/// Exponent of a lobe over normals whose slopes differ: `s / (1 + 4 s v)` for a variance `v` of slopes, the mean
/// of both axes.
///
/// Blinn's lobe of exponent `n` is nearly that of slopes with variance `1/n`, variances add, and Phong's lobe is
/// Blinn's with four times the exponent.
///
/// Source: Olano & Baker 2010, "LEAN Mapping"; Toksvig 2005, "Mipmapping Normal Maps".
#[inline(always)]
#[must_use]
pub fn widened_exponent<F: Real>(exponent: f32, slope_variance: F) -> F {
    slope_variance.splat(exponent) / (slope_variance * (4.0 * exponent) + 1.0)
}

/// Share of the light from the unit direction `wi` that a bent normal keeps: 1 far from the horizon of the
/// geometric surface, falling smoothly to 0 at it, where otherwise a lit slope would end in a hard edge.
///
/// `G = −g³ + g² + g` with `g = min(1, (N_g·L) / ((N·L) (N·N_g)))`. Both cosines with the light must be
/// above 0.
///
/// Source: Chiang, Li and Burley 2019, "Taming the Shadow Terminator".
#[inline(always)]
#[must_use]
pub fn softened_horizon<F: Real>(n_geo: V3<F>, n_shade: V3<F>, wi: V3<F>) -> F {
    let one = wi.x.splat(1.0);
    let bent = n_shade.dot(wi) * n_shade.dot(n_geo);
    let g = n_geo.dot(wi) / bent;
    // A normal bent beyond the surface, or by nothing: no edge to soften.
    let g = F::select(bent.gt(one.splat(0.0)), g.smaller(one), one);
    ((one - g) * g + one) * g
}

/// Direction of the mirror ray for an eye in direction `wo`, lifted so that it never enters the surface.
///
/// A tilted normal can send the mirror image of the eye below the geometric surface. Then the direction
/// is raised until it just leaves.
///
/// Source: Keller et al. 2017 (Iray), the treatment of reflections below the surface.
#[inline(always)]
#[must_use]
pub fn mirror_direction<F: Real>(n_shade: V3<F>, n_geo: V3<F>, wo: V3<F>) -> V3<F> {
    let r = reflect(n_shade, wo);
    let below = r.dot(n_geo);
    let zero = below.splat(0.0);
    let leaves = below.gt(zero);
    if leaves.all() {
        return r;
    }
    let toward = n_shade.dot(n_geo).larger(zero.splat(1e-3));
    let lifted = r + n_shade * ((below.abs() + 0.01) / toward);
    let lifted = lifted.normalize_or(n_geo);
    // Rounding can leave a grazing direction a hair below: the surface's own plane is the limit.
    let lifted = V3::select(lifted.dot(n_geo).gt(zero), lifted, n_geo);
    V3::select(leaves, r, lifted)
}
