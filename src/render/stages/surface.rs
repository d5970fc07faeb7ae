//! Hits → mapped surfaces: one material and one kind of triangle at a time.

use super::super::material::FrameMaterial;
use super::super::{Counters, Frame};
use super::facets::Facets;
use super::walks::Walks;
use super::{
    Column, PLACES, Places, Rays, ReliefPoints, Run, Surfaces, get3, groups, set, set_rgb, set3,
};
use crate::geometry::{HitLanes, NO_HIT};
use crate::math::lanes::ones;
use crate::math::simd::{Kernel, Simd, SimdBase as _, SimdLevel, SimdMask as _};
use crate::math::wide::{Wide, WideBits};
use crate::math::{Bits as _, LinearRgb, Mask as _, Real as _, V2, V3};
use crate::scene::TextureFilter;
use crate::surface::mapping::relief::{Found, ReliefField, found, landed, sinking_ray, view_ray};
use crate::surface::{BakedFrame, FacetKind, SurfaceInteraction, SurfaceParts, footprint};

/// Makes the surfaces that the rays hit, perturbed by their materials' maps and turned towards the eye.
pub fn mapped_surfaces(
    frame: &Frame<'_>,
    (rays, hits): (&Rays, &HitLanes<PLACES>),
    surfaces: &mut Surfaces,
    walks: &mut Walks,
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
        if run.smoothed && surfaces.smoothed.is_none() {
            surfaces.smoothed = Some(Box::default());
        }
        if let Some(field) = frame.materials[run.material].mapping.walks()
            && run.kind.parts == SurfaceParts::Gradients
        {
            frame.level.run_or_plain(AimWalks {
                frame,
                rays,
                hits,
                run,
                field,
                surfaces,
            });
            walk(field, frame.level, &run, &mut surfaces.relief, walks);
        }
        frame.level.run_or_plain(MapRun {
            frame,
            rays,
            hits,
            run,
            surfaces,
        });
        if run.searches {
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
        let index = usize::from(attributes.material);
        let material = &frame.materials[index];
        let parts = material.parts(attributes.has_uv);
        runs.push(Run {
            attributes,
            material: index,
            kind: FacetKind {
                smooth: attributes.smooth,
                parts,
            },
            searches: parts == SurfaceParts::Gradients && material.mapping.searches(),
            smoothed: frame.smooth_terminator && attributes.smooth && !frame.displaces(attributes),
            displaced: frame.displaces(attributes),
            places: Places::EMPTY,
        });
        runs.len() - 1
    })
}

/// Counts the look-ups that a run costs.
fn count(material: &FrameMaterial<'_>, run: &Run, counters: &mut Counters) {
    let points = run.places.count();
    if run.kind.parts == SurfaceParts::Gradients && material.mapping.is_active() {
        counters.perturbations += points;
    }
    counters.texture_fetches += points * fetches_per_point(material, run);
}

/// Look-ups that a point of a run costs, beside the steps of a search.
pub fn fetches_per_point(material: &FrameMaterial<'_>, run: &Run) -> u64 {
    let mapping = if run.kind.parts == SurfaceParts::Gradients {
        material.mapping.fetches_per_point()
    } else {
        0
    };
    let has_color = material.albedo.is_some() && run.kind.parts >= SurfaceParts::Uv;
    // A mean lies between two of the halvings.
    let each = match material.filter {
        TextureFilter::Bilinear => 1,
        TextureFilter::Mip => 2,
    };
    each * (mapping + u64::from(has_color))
}

/// The texture coordinates of a run's points, and how they change along the view rays.
struct AimWalks<'a> {
    frame: &'a Frame<'a>,
    rays: &'a Rays,
    hits: &'a HitLanes<PLACES>,
    run: Run,
    field: &'a ReliefField<'a>,
    surfaces: &'a mut Surfaces,
}

impl Kernel for AimWalks<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let to = &mut self.surfaces.relief;
        to.usable = Places::EMPTY;
        let mut facets = Facets::new(self.frame, self.run.kind);
        for group in self.run.places.groups::<S>() {
            let s = facets.surface(simd, (&self.run, group), self.rays, self.hits);
            let (per_z, usable) = view_ray(self.field, &s);
            let mask = self.run.places.mask(simd, group);
            set(&mut to.uv[0], group, mask, s.uv.x);
            set(&mut to.uv[1], group, mask, s.uv.y);
            set(&mut to.per_z[0], group, mask, per_z.x);
            set(&mut to.per_z[1], group, mask, per_z.y);
            to.usable.add(group, mask & usable);
        }
    }
}

/// Replaces the texture coordinates of a run's points by those of the places that the eye sees.
fn walk(
    field: &ReliefField<'_>,
    level: SimdLevel,
    run: &Run,
    points: &mut ReliefPoints,
    walks: &mut Walks,
) {
    walks.clear();
    let at = |columns: &[Column; 2], place: usize| [columns[0].0[place], columns[1].0[place]];
    for place in (run.places & points.usable).iter() {
        let (uv, per_z) = (at(&points.uv, place), at(&points.per_z, place));
        walks.push(place, sinking_ray(field, uv, per_z));
    }
    walks.run(field, level);
    for (place, ray, walk) in walks.iter() {
        let view = (at(&points.uv, place), at(&points.per_z, place));
        let [u, v, z, steps] = landed(field, view, ray, walk);
        points.uv[0].0[place] = u;
        points.uv[1].0[place] = v;
        points.z.0[place] = z;
        points.steps.0[place] = steps;
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
        let perturbed = self.run.kind.parts == SurfaceParts::Gradients;
        let searches = self.run.searches;
        let walked = material.mapping.walks().is_some() && searches;
        let mut facets = Facets::new(self.frame, self.run.kind);
        let mut last_uv = None;
        for group in self.run.places.groups::<S>() {
            let mask = self.run.places.mask(simd, group);
            let mut s = facets.surface(simd, (&self.run, group), self.rays, self.hits);
            if let Some(to) = &mut self.surfaces.smoothed
                && self.run.smoothed
            {
                let point = facets.smoothed(simd, (&self.run, group), self.hits, &s);
                set3(&mut to.normal, group, mask, point.normal);
                set3(&mut to.lift, group, mask, point.lift);
            }
            if let Some(spread) = self.frame.cone_spread
                && self.run.kind.parts == SurfaceParts::Gradients
            {
                let origin = get3(simd, &self.rays.lanes.origin, group);
                let travelled = self.rays.travelled.get(simd, group);
                s.footprint = cone_footprint(&s, origin, travelled, spread);
            }
            if perturbed && material.mapping.needs_baked_frame() {
                let frame = self.baked_frame(simd, group);
                let barycentrics = (self.hits.u.get(simd, group), self.hits.v.get(simd, group));
                frame.place(barycentrics, &mut s);
            }
            if perturbed {
                let known = if walked {
                    Some(self.walked(simd, group, &s))
                } else {
                    None
                };
                material.mapping.apply(&mut s, mask, known);
            }
            let slope_variance = slope_variance(material, self.run.kind.parts, &s);
            if let Some(points) = self
                .hits
                .displaced
                .as_deref()
                .filter(|_| self.run.displaced)
            {
                s.p = get3(simd, &points.p, group);
                s.n_geo = get3(simd, &points.normal, group);
                s.n_shade = s.n_geo;
            }
            let diffuse = diffuse(material, self.run.kind.parts, &s);
            if self.run.kind.parts >= SurfaceParts::Uv
                && let Some(last) = last_uv
            {
                prefetch(material, perturbed, s.uv + (s.uv - last));
            }
            last_uv = Some(s.uv);
            // Perturbed on the front side; an eye behind it sees the other side of the same relief.
            let from_behind = s.wo.dot(s.n_geo).lt(Wide::new(simd, 0.0));
            let n_geo = V3::select(from_behind, -s.n_geo, s.n_geo);
            let n_shade = V3::select(from_behind, -s.n_shade, s.n_shade);
            let to = &mut *self.surfaces;
            set3(&mut to.p, group, mask, s.p);
            if let Some(variance) = slope_variance {
                set(&mut to.slope_variance, group, mask, variance);
            }
            let bound = match &self.hits.displaced {
                Some(points) if self.run.displaced => points.bound.get(simd, group),
                _ => s.n_geo.abs().dot(s.p_error),
            };
            set(&mut to.bound, group, mask, bound);
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
    /// Where the walks of a group's points came out.
    #[inline(always)]
    fn walked<S: Simd>(
        &self,
        simd: S,
        group: usize,
        s: &SurfaceInteraction<Wide<S>>,
    ) -> Found<Wide<S>> {
        let from = &self.surfaces.relief;
        let [u, v] = &from.uv;
        let (u, v) = (u.get(simd, group), v.get(simd, group));
        let (z, steps) = (from.z.get(simd, group), from.steps.get(simd, group));
        found(s, [u, v, z, steps], from.usable.mask(simd, group))
    }

    /// The frames of baked normal maps on the triangles of a group.
    #[inline(always)]
    fn baked_frame<S: Simd>(&self, simd: S, group: usize) -> BakedFrame<Wide<S>> {
        let Self { frame, run, .. } = self;
        let prims = self.hits.prim.get(simd, group);
        let lane = run.places.bits::<S>(group).trailing_zeros() as usize;
        let one = prims.splat(prims.0.as_slice()[lane]);
        // Lanes outside the mask hold no triangle: they take part with any.
        let prims = WideBits::select(run.places.mask(simd, group), prims, one);
        let from = (frame.mesh, frame.tangents.get(frame.mesh));
        BakedFrame::fetch(from, prims, run.kind.smooth)
    }
}

/// What the cone of a ray covers that comes from `origin` after a way of `travelled`.
#[inline(always)]
pub fn cone_footprint<F: crate::math::Real>(
    s: &SurfaceInteraction<F>,
    origin: V3<F>,
    travelled: F,
    spread: f32,
) -> F {
    let width = (travelled + (s.p - origin).length()) * spread;
    footprint(width, s)
}

/// Applies the material's maps to a single point; returns the diffuse colour.
#[must_use]
pub fn perturb(
    material: &FrameMaterial<'_>,
    parts: SurfaceParts,
    s: &mut SurfaceInteraction,
) -> LinearRgb {
    if parts == SurfaceParts::Gradients {
        material.mapping.apply_to_point(s);
    }
    diffuse(material, parts, s)
}

/// How much slopes differ under a point that maps were applied to, if its highlight widens by it.
#[inline(always)]
pub fn slope_variance<F: crate::math::Real>(
    material: &FrameMaterial<'_>,
    parts: SurfaceParts,
    s: &SurfaceInteraction<F>,
) -> Option<F> {
    material.widens_highlights.then(|| match parts {
        SurfaceParts::Gradients => material.mapping.slope_variance(s),
        _ => s.footprint.splat(0.0),
    })
}

/// Has memory bring what the next points will probably look up. From one group to the next texture coordinates mostly go
/// on as they did before, but across the rows of a picture, where processors do not see that by themselves.
#[inline(always)]
fn prefetch<F: crate::math::Real>(material: &FrameMaterial<'_>, perturbed: bool, uv: V2<F>) {
    if perturbed {
        material.mapping.prefetch(uv);
    }
    if let Some(albedo) = &material.albedo {
        albedo.prefetch(uv);
    }
}

/// The diffuse colour at a point.
#[inline(always)]
fn diffuse<F: crate::math::Real>(
    material: &FrameMaterial<'_>,
    parts: SurfaceParts,
    s: &SurfaceInteraction<F>,
) -> LinearRgb<F> {
    let kd = LinearRgb::splat(s.uv.x, material.kd);
    match &material.albedo {
        Some(albedo) if parts >= SurfaceParts::Uv => kd * albedo.color(s.uv, s.footprint),
        _ => kd,
    }
}
