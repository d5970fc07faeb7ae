//! Light on reliefs: where rays from a sunken point come out of the surface, and what the relief itself
//! shadows.

use super::super::{Counters, Frame};
use super::{Places, Shadows, Surfaces, get3};
use crate::math::simd::{Kernel, Simd, SimdBase as _};
use crate::math::wide::Wide;
use crate::math::{Real, V2, V3};
use crate::surface::mapping::relief::is_shadowed;

/// From a point of a relief to where a ray from it in the direction `dir` starts on the mesh.
///
/// A point sunk under its triangle's plane sees the scene through the plane, where `dir` leaves it. Where
/// normals are interpolated the mesh is not that plane: there the ray starts where the eye's ray entered,
/// which is on the triangle itself. Points over the plane stay.
#[inline(always)]
pub fn way_out<F: Real>((sunk, n_geo): (F, V3<F>), wo: V3<F>, dir: V3<F>, smooth: bool) -> V3<F> {
    let zero = sunk.splat(0.0);
    let along = if smooth { wo } else { dir };
    let distance = sunk.larger(zero) / along.dot(n_geo);
    let usable = distance.is_finite() & distance.gt(zero);
    along * F::select(usable, distance, zero)
}

/// Takes the light from points that their own relief shadows.
pub fn shadow_by_relief(
    frame: &Frame<'_>,
    surfaces: &Surfaces,
    shadows: &mut Shadows,
    counters: &mut Counters,
) {
    let shadowing = |material: usize| frame.materials[material].mapping.self_shadow().is_some();
    if surfaces.runs.iter().any(|run| shadowing(run.material)) {
        frame.level.run_or_plain(ShadowByRelief {
            frame,
            surfaces,
            shadows,
            counters,
        });
    }
}

struct ShadowByRelief<'a> {
    frame: &'a Frame<'a>,
    surfaces: &'a Surfaces,
    shadows: &'a mut Shadows,
    counters: &'a mut Counters,
}

impl Kernel for ShadowByRelief<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let (from, to) = (&self.surfaces.relief, self.shadows);
        let mut shadowed = Places::EMPTY;
        let mut taken = 0.0;
        for run in &self.surfaces.runs {
            let Some(field) = self.frame.materials[run.material].mapping.self_shadow() else {
                continue;
            };
            if run.kind.parts < crate::surface::SurfaceParts::Gradients {
                continue;
            }
            let lit = run.places & to.lit;
            self.counters.relief_shadow_walks += lit.count();
            for group in lit.groups::<S>() {
                // Where nothing was searched (the eye is behind the surface), nothing shadows.
                let searched = from.steps.get(simd, group).gt(Wide::new(simd, 0.0));
                let mask = lit.mask(simd, group) & searched;
                let uv = V2::new(from.uv[0].get(simd, group), from.uv[1].get(simd, group));
                let gradients = [
                    get3(simd, &from.grad_u, group),
                    get3(simd, &from.grad_v, group),
                ];
                let n = get3(simd, &from.n_smooth, group);
                let wi = get3(simd, &to.rays.dir, group);
                let (in_shadow, steps) = is_shadowed(field, mask, (uv, gradients, n), wi);
                shadowed.add(group, in_shadow);
                taken += steps
                    .0
                    .as_slice()
                    .iter()
                    .copied()
                    .map(f64::from)
                    .sum::<f64>();
            }
        }
        self.counters.relief_steps += taken as u64;
        for place in shadowed.iter() {
            to.rays.t_max.0[place] = -1.0;
        }
        to.lit = to.lit & !shadowed;
    }
}
