//! The exact walk for surface points, for the eye and for lights: from a point to a ray over the chart and back.

use super::field::ReliefField;
use super::ray::ReliefRay;
use super::walk::Walk;
use super::{Found, shell::Shell};
use crate::geometry::UvChart;
use crate::math::{Real, V2, V3};
use crate::surface::SurfaceInteraction;

/// Shadow walks start this share of the relief's thickness above it, 2⁻²⁰: enough that no rounding of the
/// start shadows it, a thousandth of a step of 10 bits.
pub const LIFT: f64 = 1.0 / 1_048_576.0;

/// A light lower over the smooth surface than this cosine is below every relief.
const MIN_LIGHT_COS: f32 = 1e-6;

/// Where the view ray first meets the bilinear relief; see [`ReliefField::walk`].
#[inline(always)]
pub fn exact<F: Real>(
    field: &ReliefField<'_>,
    s: &SurfaceInteraction<F>,
    wanted: F::Mask,
) -> Found<F> {
    let (per_z, usable) = view_ray(field, s);
    let inputs = [s.uv.x, s.uv.y, per_z.x, per_z.y];
    let walked = F::each(wanted & usable, inputs, |[u, v, du, dv]| {
        walk_down(field, [u, v], [du, dv])
    });
    found(s, walked, usable)
}

/// Change of the texture coordinate along the view ray per unit of displacement, and where a walk along it
/// means something.
#[inline(always)]
pub fn view_ray<F: Real>(field: &ReliefField<'_>, s: &SurfaceInteraction<F>) -> (V2<F>, F::Mask) {
    let shell = Shell::new(&field.height, s);
    (shell.per_z(), shell.usable)
}

/// What a walk along the view ray came to, from what [`landed`] says of it; the surface itself where the
/// walk means nothing.
#[inline(always)]
pub fn found<F: Real>(
    s: &SurfaceInteraction<F>,
    [u, v, z, steps]: [F; 4],
    usable: F::Mask,
) -> Found<F> {
    let usable = usable & u.is_finite() & v.is_finite() & z.is_finite();
    let zero = z.splat(0.0);
    Found {
        uv: V2::select(usable, V2::new(u, v), s.uv),
        z: F::select(usable, z, zero),
        steps: F::select(usable, steps, zero),
    }
}

/// From the top of the relief to its bottom: u, v and z of the hit, and the steps.
#[inline(never)]
fn walk_down(field: &ReliefField<'_>, uv: [f32; 2], per_z: [f32; 2]) -> [f32; 4] {
    let ray = sinking_ray(field, uv, per_z);
    landed(field, (uv, per_z), &ray, &field.walk(&ray))
}

/// The ray from the top of the relief to its bottom that passes the surface at `uv`.
#[inline]
#[must_use]
pub fn sinking_ray(field: &ReliefField<'_>, uv: [f32; 2], per_z: [f32; 2]) -> ReliefRay {
    let [low, high] = field.range();
    let rates = field.texels_per_uv();
    let per_z = [0, 1].map(|k| f64::from(per_z[k]) * rates[k]);
    let [x, y] = field.texels_from_uv(uv.map(f64::from));
    let start = [x + per_z[0] * high, y + per_z[1] * high];
    // A little further, so that rounding cannot end the walk above the lowest height.
    let z_end = low - LIFT * (high - low);
    ReliefRay::by_height(start, per_z, high, z_end)
}

/// Steps at which the walk along a point's view ray is given up.
#[must_use]
pub fn most_steps(field: &ReliefField<'_>, s: &SurfaceInteraction) -> f32 {
    let (per_z, _) = view_ray(field, s);
    let ray = sinking_ray(field, [s.uv.x, s.uv.y], [per_z.x, per_z.y]);
    // The step that goes beyond the cap is counted, too.
    (field.step_cap(&ray) as f32) + 1.0
}

/// u, v and z of the place where the walk of a [`sinking_ray`] ended, and its steps.
#[inline]
#[must_use]
pub fn landed(
    field: &ReliefField<'_>,
    (uv, per_z): ([f32; 2], [f32; 2]),
    ray: &ReliefRay,
    walk: &Walk,
) -> [f32; 4] {
    let [low, high] = field.range();
    let z = walk.at.map_or(low, |tau| ray.z_at(tau).clamp(low, high));
    let [u, v] = [0, 1].map(|k| f64::from(uv[k]) + f64::from(per_z[k]) * z);
    [u as f32, v as f32, z as f32, walk.steps as f32]
}

/// Which points of a relief are shadowed by the relief itself, and the steps it took to find out.
///
/// `uv` is a place on the relief, `wi` the unit direction to the light; `n` the smooth normal and
/// `gradients` those of u and v. The walk starts on the relief at `uv`, whatever found the place, so that
/// an inexact search does not shadow itself. Beyond `border` there is no relief.
#[inline(always)]
pub fn is_shadowed<F: Real>(
    field: &ReliefField<'_>,
    border: Option<&UvChart>,
    wanted: F::Mask,
    (uv, gradients, n): (V2<F>, [V3<F>; 2], V3<F>),
    wi: V3<F>,
) -> (F::Mask, F) {
    let (per_z, is_up) = light_ray(gradients, n, wi);
    let inputs = [uv.x, uv.y, per_z.x, per_z.y];
    let one = uv.x.splat(1.0);
    let [shadowed, steps] = F::each(wanted & is_up, inputs, |[u, v, du, dv]| {
        walk_up(field, border, [u, v], [du, dv])
    });
    (wanted & (!is_up | shadowed.eq(one)), steps)
}

/// Change of the texture coordinate towards a light per unit of displacement, and where the light is above
/// the surface at all.
#[inline(always)]
pub fn light_ray<F: Real>(gradients: [V3<F>; 2], n: V3<F>, wi: V3<F>) -> (V2<F>, F::Mask) {
    let cos = wi.dot(n);
    let is_up = cos.gt(cos.splat(MIN_LIGHT_COS));
    let per_z = V2::new(wi.dot(gradients[0]) / cos, wi.dot(gradients[1]) / cos);
    (per_z, is_up)
}

/// From a place on the relief to above its top: 1 if something is in the way, else 0; and the steps.
#[inline(never)]
fn walk_up(
    field: &ReliefField<'_>,
    border: Option<&UvChart>,
    uv: [f32; 2],
    per_z: [f32; 2],
) -> [f32; 2] {
    let Some(ray) = rising_ray(field, border, uv, per_z) else {
        return [0.0; 2];
    };
    let walk = field.walk(&ray);
    [f32::from(u8::from(walk.at.is_some())), walk.steps as f32]
}

/// The ray from the relief at `uv` to its top or to the border; `None` if it starts there.
#[inline]
#[must_use]
pub fn rising_ray(
    field: &ReliefField<'_>,
    border: Option<&UvChart>,
    uv: [f32; 2],
    per_z: [f32; 2],
) -> Option<ReliefRay> {
    let [low, high] = field.range();
    let start = field.texels_from_uv(uv.map(f64::from));
    let rates = field.texels_per_uv();
    let z_start = field.displacement(start) + LIFT * (high - low);
    let stays = border.map_or(f64::INFINITY, |border| {
        border.exit(uv, per_z, high - z_start)
    });
    let per_z = [0, 1].map(|k| f64::from(per_z[k]) * rates[k]);
    let z_end = high.min(z_start + stays);
    (start.iter().all(|place| place.is_finite()) && z_start < z_end)
        .then(|| ReliefRay::by_height(start, per_z, z_start, z_end))
}
