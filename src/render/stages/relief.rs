//! Light on reliefs: where rays from a sunken point come out of the surface, and what the relief itself
//! shadows.

use super::super::{Counters, Frame};
use super::walks::Walks;
use super::{Column, PLACES, Places, Shadows, StageWatch, Surfaces, get3};
use crate::geometry::HitLanes;
use crate::math::simd::{Kernel, Simd};
use crate::math::wide::Wide;
use crate::math::{Real, V2, V3};
use crate::surface::SurfaceParts;
use crate::surface::mapping::relief::{ReliefField, light_ray, rising_ray};

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
    (hits, surfaces): (&HitLanes<PLACES>, &Surfaces),
    shadows: &mut Shadows,
    walks: &mut Walks,
    counters: &mut Counters,
    watch: &mut impl StageWatch,
) {
    for run in &surfaces.runs {
        let material = &frame.materials[run.material];
        let Some(field) = material.mapping.self_shadow() else {
            continue;
        };
        if run.kind.parts < SurfaceParts::Gradients {
            continue;
        }
        let lit = run.places & shadows.lit;
        counters.relief_shadow_walks += lit.count();
        let mut rays = LightRays::default();
        frame.level.run_or_plain(AimOverRelief {
            field,
            surfaces,
            shadows,
            lit,
            rays: &mut rays,
        });
        counters.walks_spared += rays.clear.count();
        walks.clear();
        let uv = &surfaces.relief.uv;
        for place in (lit & rays.up).iter() {
            let per_z = [rays.per_z[0].0[place], rays.per_z[1].0[place]];
            let border = frame.border(hits.prim.0[place]);
            let uv = [uv[0].0[place], uv[1].0[place]];
            if let Some(ray) = rising_ray(field, border, uv, per_z) {
                walks.push(place, ray);
            }
        }
        counters.relief_steps += walks.run(field, frame.level);
        watch.walked(walks);
        let in_the_way = walks.iter().filter(|(_, _, walk)| walk.at.is_some());
        let shadowed = in_the_way.map(|(place, ..)| place);
        for place in shadowed.chain((lit & rays.under).iter()) {
            shadows.rays.t_max.0[place] = -1.0;
            shadows.lit.remove(place);
        }
    }
}

/// Rays over the chart from a tile's points to one light.
struct LightRays {
    /// Change of the texture coordinate per unit of displacement.
    per_z: [Column; 2],
    /// Places that see the light over the relief's own surface and must walk to know more.
    up: Places,
    /// Places whose horizon says that nothing of the relief is in the way.
    clear: Places,
    /// Places whose surface faces away from it.
    under: Places,
}

impl Default for LightRays {
    fn default() -> Self {
        Self {
            per_z: [Column::splat(0.0); 2],
            up: Places::EMPTY,
            clear: Places::EMPTY,
            under: Places::EMPTY,
        }
    }
}

struct AimOverRelief<'a> {
    field: &'a ReliefField<'a>,
    surfaces: &'a Surfaces,
    shadows: &'a Shadows,
    lit: Places,
    rays: &'a mut LightRays,
}

impl Kernel for AimOverRelief<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let (from, to) = (&self.surfaces.relief, self.rays);
        for group in self.lit.groups::<S>() {
            // Where nothing was searched (the eye is behind the surface), nothing shadows.
            let searched = from.steps.get(simd, group).gt(Wide::new(simd, 0.0));
            let mask = self.lit.mask(simd, group) & searched;
            let gradients = [
                get3(simd, &from.grad_u, group),
                get3(simd, &from.grad_v, group),
            ];
            let n = get3(simd, &from.n_smooth, group);
            let wi = get3(simd, &self.shadows.rays.dir, group);
            let (per_z, is_up) = light_ray(gradients, n, wi);
            to.per_z[0].set(group, per_z.x);
            to.per_z[1].set(group, per_z.y);
            let uv = [0, 1].map(|k| from.uv[k].get(simd, group));
            let is_clear = self.field.is_clear(V2::new(uv[0], uv[1]), per_z);
            to.up.add(group, mask & is_up & !is_clear);
            to.clear.add(group, mask & is_up & is_clear);
            to.under.add(group, mask & !is_up);
        }
    }
}
