//! The exact walk for surface points: one lane after the other, in doubles.

use super::walk::{ReliefField, ReliefRay};
use super::{Found, shell::Shell};
use crate::math::{Real, V2, V3};
use crate::surface::SurfaceInteraction;

/// Shadow walks start this share of the relief's thickness above it, 2⁻²⁰: enough that no rounding of the
/// start shadows it, a thousandth of a step of 10 bits.
const LIFT: f64 = 1.0 / 1_048_576.0;

/// A light lower over the smooth surface than this cosine is below every relief.
const MIN_LIGHT_COS: f32 = 1e-6;

/// Where the view ray first meets the bilinear relief; see [`ReliefField::walk`].
#[inline(always)]
pub fn exact<F: Real>(
    field: &ReliefField<'_>,
    s: &SurfaceInteraction<F>,
    wanted: F::Mask,
) -> Found<F> {
    let shell = Shell::new(&field.height, s);
    let per_z = shell.per_z();
    let inputs = [s.uv.x, s.uv.y, per_z.x, per_z.y];
    let [u, v, z, steps] = F::each(wanted & shell.usable, inputs, |[u, v, du, dv]| {
        walk_down(field, [u, v].map(f64::from), [du, dv].map(f64::from))
    });
    let usable = shell.usable & u.is_finite() & v.is_finite() & z.is_finite();
    let zero = z.splat(0.0);
    Found {
        uv: V2::select(usable, V2::new(u, v), s.uv),
        z: F::select(usable, z, zero),
        steps: F::select(usable, steps, zero),
    }
}

/// From the top of the relief to its bottom: u, v and z of the hit, and the steps.
#[inline(never)]
fn walk_down(field: &ReliefField<'_>, uv: [f64; 2], per_z: [f64; 2]) -> [f32; 4] {
    let [low, high] = field.range();
    let rates = field.texels_per_uv();
    let per_z_texels = [per_z[0] * rates[0], per_z[1] * rates[1]];
    let [x, y] = field.texels_from_uv(uv);
    let start = [x + per_z_texels[0] * high, y + per_z_texels[1] * high];
    // A little further, so that rounding cannot end the walk above the lowest height.
    let z_end = low - LIFT * (high - low);
    let ray = ReliefRay::by_height(start, per_z_texels, high, z_end);
    let walk = field.walk(&ray);
    let z = walk.at.map_or(low, |tau| ray.z_at(tau).clamp(low, high));
    let (u, v) = (uv[0] + per_z[0] * z, uv[1] + per_z[1] * z);
    [u as f32, v as f32, z as f32, walk.steps as f32]
}

/// Which points of a relief are shadowed by the relief itself, and the steps it took to find out.
///
/// `uv` is a place on the relief, `wi` the unit direction to the light; `n` the smooth normal and
/// `gradients` those of u and v. The walk starts on the relief at `uv`, whatever found the place, so that
/// an inexact search does not shadow itself.
#[inline(always)]
pub fn is_shadowed<F: Real>(
    field: &ReliefField<'_>,
    wanted: F::Mask,
    (uv, gradients, n): (V2<F>, [V3<F>; 2], V3<F>),
    wi: V3<F>,
) -> (F::Mask, F) {
    let cos = wi.dot(n);
    let one = cos.splat(1.0);
    let is_up = cos.gt(cos.splat(MIN_LIGHT_COS));
    let (du, dv) = (wi.dot(gradients[0]) / cos, wi.dot(gradients[1]) / cos);
    let inputs = [uv.x, uv.y, du, dv];
    let [shadowed, steps] = F::each(wanted & is_up, inputs, |[u, v, du, dv]| {
        walk_up(field, [u, v].map(f64::from), [du, dv].map(f64::from))
    });
    (wanted & (!is_up | shadowed.eq(one)), steps)
}

/// From a place on the relief to above its top: 1 if something is in the way, else 0; and the steps.
#[inline(never)]
fn walk_up(field: &ReliefField<'_>, uv: [f64; 2], per_z: [f64; 2]) -> [f32; 2] {
    let [low, high] = field.range();
    let start = field.texels_from_uv(uv);
    let rates = field.texels_per_uv();
    if !(start[0].is_finite() && start[1].is_finite()) {
        return [0.0; 2];
    }
    let z_start = field.displacement(start) + LIFT * (high - low);
    if z_start >= high {
        return [0.0; 2];
    }
    let per_z = [per_z[0] * rates[0], per_z[1] * rates[1]];
    let walk = field.walk(&ReliefRay::by_height(start, per_z, z_start, high));
    [f32::from(u8::from(walk.at.is_some())), walk.steps as f32]
}
