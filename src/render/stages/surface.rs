//! Hits → mapped surfaces: one material and one kind of triangle at a time.

use super::super::material::FrameMaterial;
use super::super::{Counters, Frame};
use super::{PLACES, Places, Rays, Run, Surfaces, get3, groups, set, set_rgb, set3};
use crate::geometry::{HitLanes, NO_HIT};
use crate::math::lanes::ones;
use crate::math::simd::{Kernel, Simd, SimdBase as _, SimdMask as _};
use crate::math::wide::{Wide, WideBits, WideMask};
use crate::math::{Bits as _, LinearRgb, Mask as _, Real as _, V3};
use crate::surface::{Facet, FacetKind, SurfaceInteraction, SurfaceParts, surface_on};

/// Makes the surfaces that the rays hit, perturbed by their materials' maps and turned towards the eye.
pub fn mapped_surfaces(
    frame: &Frame<'_>,
    rays: &Rays,
    hits: &HitLanes<PLACES>,
    surfaces: &mut Surfaces,
    counters: &mut Counters,
) {
    frame.level.run_or_plain(FindRuns {
        frame,
        rays,
        hits,
        runs: &mut surfaces.runs,
    });
    for run in 0..surfaces.runs.len() {
        let run = surfaces.runs[run];
        count(&frame.materials[run.material], &run, counters);
        frame.level.run_or_plain(MapRun {
            frame,
            rays,
            hits,
            run,
            surfaces,
        });
        if frame.materials[run.material].mapping.searches() {
            let steps = &surfaces.relief.steps;
            let taken = run.places.iter().map(|place| f64::from(steps.0[place]));
            counters.relief_steps += taken.sum::<f64>() as u64;
        }
    }
}

/// Cuts the places that hit something up by material and kind of triangle.
struct FindRuns<'a> {
    frame: &'a Frame<'a>,
    rays: &'a Rays,
    hits: &'a HitLanes<PLACES>,
    runs: &'a mut Vec<Run>,
}

impl Kernel for FindRuns<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        self.runs.clear();
        let mut last = (NO_HIT, 0);
        for group in 0..groups::<S>(self.rays.count) {
            let prims = self.hits.prim.get(simd, group);
            let hit = self.rays.active.mask(simd, group) & !prims.equals(NO_HIT);
            // On large triangles whole groups lie on one.
            if !(hit & !prims.equals(last.0)).any() {
                if let Some(run) = self.runs.get_mut(last.1) {
                    run.places.add(group, hit);
                }
                continue;
            }
            let first = group * S::f32s::LEN;
            for lane in ones(hit.0.to_bitmask()) {
                let prim = prims.0.as_slice()[lane];
                if prim != last.0 {
                    last = (prim, run_of(self.frame, prim, self.runs, last.1));
                }
                self.runs[last.1].places.insert(first + lane);
            }
        }
    }
}

/// Index of the run that a triangle's points belong to, perhaps `likely`.
#[inline]
fn run_of(frame: &Frame<'_>, prim: u32, runs: &mut Vec<Run>, likely: usize) -> usize {
    let attributes = frame.mesh.attributes[prim as usize];
    if runs
        .get(likely)
        .is_some_and(|run| run.attributes == attributes)
    {
        return likely;
    }
    let known = runs.iter().position(|run| run.attributes == attributes);
    known.unwrap_or_else(|| {
        let material = usize::from(attributes.material);
        runs.push(Run {
            attributes,
            material,
            kind: FacetKind {
                smooth: attributes.smooth,
                parts: frame.materials[material].parts(attributes.has_uv),
            },
            places: Places::EMPTY,
        });
        runs.len() - 1
    })
}

/// Counts the look-ups that a run costs.
fn count(material: &FrameMaterial<'_>, run: &Run, counters: &mut Counters) {
    let points = run.places.count();
    if run.kind.parts == SurfaceParts::Gradients {
        counters.perturbations += points;
        counters.texture_fetches += points * material.mapping.fetches_per_point();
    }
    if material.albedo.is_some() && run.kind.parts >= SurfaceParts::Uv {
        counters.texture_fetches += points;
    }
}

struct MapRun<'a> {
    frame: &'a Frame<'a>,
    rays: &'a Rays,
    hits: &'a HitLanes<PLACES>,
    run: Run,
    surfaces: &'a mut Surfaces,
}

impl Kernel for MapRun<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let material = &self.frame.materials[self.run.material];
        let searches =
            self.run.kind.parts == SurfaceParts::Gradients && material.mapping.searches();
        let mut last = None;
        for group in self.run.places.groups::<S>() {
            let lane = self.run.places.bits::<S>(group).trailing_zeros() as usize;
            let mask = self.run.places.mask(simd, group);
            let facet = self.facet(self.hits.prim.get(simd, group), (mask, lane), &mut last);
            let barycentrics = (self.hits.u.get(simd, group), self.hits.v.get(simd, group));
            let wo = -get3(simd, &self.rays.lanes.dir, group);
            let mut s = surface_on(&facet, barycentrics, wo, self.run.kind);
            let diffuse = perturb(material, self.run.kind.parts, &mut s, mask);
            // Perturbed on the front side; an eye behind it sees the other side of the same relief.
            let from_behind = s.wo.dot(s.n_geo).lt(Wide::new(simd, 0.0));
            let n_geo = V3::select(from_behind, -s.n_geo, s.n_geo);
            let n_shade = V3::select(from_behind, -s.n_shade, s.n_shade);
            let to = &mut *self.surfaces;
            set3(&mut to.p, group, mask, s.p);
            set(&mut to.bound, group, mask, s.n_geo.abs().dot(s.p_error));
            set3(&mut to.n_geo, group, mask, n_geo);
            set3(&mut to.n_shade, group, mask, n_shade);
            set_rgb(&mut to.diffuse, group, mask, diffuse);
            if searches {
                let to = &mut to.relief;
                set(&mut to.sunk, group, mask, s.sunk);
                set(&mut to.steps, group, mask, s.steps);
                set(&mut to.uv[0], group, mask, s.uv.x);
                set(&mut to.uv[1], group, mask, s.uv.y);
                set3(&mut to.n_smooth, group, mask, s.n_smooth);
                set3(&mut to.grad_u, group, mask, s.grad_u);
                set3(&mut to.grad_v, group, mask, s.grad_v);
            }
        }
    }
}

impl MapRun<'_> {
    /// The triangle of each lane. On large triangles all lanes share one; it is prepared once, and kept in
    /// `last` for the groups that follow. `lane` is one in the mask.
    #[inline(always)]
    fn facet<S: Simd>(
        &self,
        prims: WideBits<S>,
        (mask, lane): (WideMask<S>, usize),
        last: &mut Option<(u32, Facet)>,
    ) -> Facet<Wide<S>> {
        let (mesh, kind) = (self.frame.mesh, self.run.kind);
        let prim = prims.0.as_slice()[lane];
        if !(prims.equals(prim) | !mask).all() {
            // Lanes outside the mask hold no triangle: they take part with any.
            let prims = WideBits::select(mask, prims, prims.splat(prim));
            return Facet::fetch(mesh, prims, kind);
        }
        let facet = match last {
            Some((cached, facet)) if *cached == prim => *facet,
            _ => Facet::fetch(mesh, prim, kind),
        };
        *last = Some((prim, facet));
        Facet::splat(prims.to_real(), &facet)
    }
}

/// Applies the material's maps; returns the diffuse colour.
#[inline(always)]
pub fn perturb<F: crate::math::Real>(
    material: &FrameMaterial<'_>,
    parts: SurfaceParts,
    s: &mut SurfaceInteraction<F>,
    wanted: F::Mask,
) -> LinearRgb<F> {
    if parts == SurfaceParts::Gradients {
        material.mapping.apply(s, wanted);
    }
    let kd = LinearRgb::splat(s.uv.x, material.kd);
    match &material.albedo {
        Some(albedo) if parts >= SurfaceParts::Uv => kd * albedo.color(s.uv),
        _ => kd,
    }
}
