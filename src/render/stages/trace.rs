//! Rays → hits, with cut-outs as holes.

use std::cell::Cell;

use super::super::{Counters, Frame};
use super::{PLACES, Rays, Shadows, displaced};
use crate::geometry::bvh::AcceptAll;
use crate::geometry::triangle::Watertight;
use crate::geometry::{CachedHit, HitLanes, NO_HIT, Ray};
use crate::surface::displaced::Tracer;

/// Closest hits of all rays.
pub fn closest_hits(
    frame: &Frame<'_>,
    rays: &mut Rays,
    hits: &mut HitLanes<PLACES>,
    tracer: &mut Tracer,
    counters: &mut Counters,
) {
    match &frame.displaced {
        Some(relief) => displaced::closest_hits(frame, relief, rays, hits, tracer, counters),
        None => {
            tracer.clear();
            hits.displaced = None;
            plain_closest_hits(frame, rays, hits, counters);
        }
    }
}

/// Closest hits on triangles that are not displaced.
pub fn plain_closest_hits(
    frame: &Frame<'_>,
    rays: &Rays,
    hits: &mut HitLanes<PLACES>,
    counters: &mut Counters,
) {
    let (bvh, count, active) = (frame.bvh, rays.count, &rays.active);
    let rays = &rays.lanes;
    if frame.has_holes() {
        let tests = CutoutTests::default();
        let solid = |prim, u, v| tests.is_solid(frame, prim, u, v);
        bvh.intersect_lanes(rays, count, &solid, hits);
        tests.count(counters);
    } else {
        bvh.intersect_lanes(rays, count, &AcceptAll, hits);
    }
    if frame.charts.is_some() {
        let tests = CutoutTests::default();
        for place in active.iter() {
            let ray = rays.ray(place);
            let (prim, u, v) = (hits.prim.0[place], hits.u.0[place], hits.v.0[place]);
            if prim == NO_HIT || !tests.is_cut(frame, &ray, (prim, u, v)) {
                continue;
            }
            // Few rays; alone, each knows its direction.
            let there = |prim, u, v| tests.is_there(frame, &ray, (prim, u, v));
            match bvh.intersect::<Watertight, _>(&ray, rays.t_max.0[place], &there) {
                Some(hit) => hits.put(place, (hit.prim, hit.u, hit.v)),
                None => hits.prim.0[place] = NO_HIT,
            }
        }
        tests.count(counters);
    }
}

/// Finds the shadow rays with something solid before their end.
pub fn any_hits(
    frame: &Frame<'_>,
    count: usize,
    shadows: &mut Shadows,
    tracer: &mut Tracer,
    counters: &mut Counters,
) {
    counters.shadow_rays += shadows.lit.count();
    match &frame.displaced {
        Some(relief) => displaced::any_hits(frame, relief, count, shadows, tracer, counters),
        None => {
            tracer.clear();
            plain_any_hits(frame, count, shadows, counters);
        }
    }
}

/// Finds the shadow rays with a solid triangle that is not displaced before their end.
pub fn plain_any_hits(
    frame: &Frame<'_>,
    count: usize,
    shadows: &mut Shadows,
    counters: &mut Counters,
) {
    let (bvh, rays, occluded) = (frame.bvh, &shadows.rays, &mut shadows.occluded.0);
    if frame.has_holes() {
        let tests = CutoutTests::default();
        let solid = |prim, u, v| tests.is_solid(frame, prim, u, v);
        bvh.occluded_lanes(rays, count, &solid, occluded);
        tests.count(counters);
    } else {
        bvh.occluded_lanes(rays, count, &AcceptAll, occluded);
    }
    if frame.charts.is_some() {
        let tests = CutoutTests::default();
        for place in (shadows.lit & shadows.occluded).iter() {
            let (ray, t_max) = (shadows.rays.ray(place), shadows.rays.t_max.0[place]);
            let there = |prim, u, v| tests.is_there(frame, &ray, (prim, u, v));
            if !bvh.occluded::<Watertight, _>(&ray, t_max, &there) {
                shadows.occluded.remove(place);
            }
        }
        tests.count(counters);
    }
}

/// Counts cut-out decisions from inside the traversal, where counters cannot be borrowed mutably.
#[derive(Default)]
pub struct CutoutTests(Cell<u64>);

impl CutoutTests {
    /// Whether there is surface at this point of a triangle.
    pub fn is_solid(&self, frame: &Frame<'_>, prim: u32, u: f32, v: f32) -> bool {
        let attributes = frame.mesh.attributes[prim as usize];
        if frame.displaces(attributes) {
            return false;
        }
        if frame.holes(attributes).is_some() {
            self.0.set(self.0.get() + 1);
        }
        frame.is_solid(prim, u, v)
    }

    /// Whether a ray leaves the relief at this point of a triangle by its border.
    fn is_cut(&self, frame: &Frame<'_>, ray: &Ray, (prim, u, v): CachedHit) -> bool {
        if frame.charts.is_none() {
            return false;
        }
        self.0.set(self.0.get() + 1);
        frame.is_cut(ray.dir, prim, u, v)
    }

    /// Whether a ray meets a surface at this point of a triangle.
    pub fn is_there(&self, frame: &Frame<'_>, ray: &Ray, (prim, u, v): CachedHit) -> bool {
        self.is_solid(frame, prim, u, v) && !self.is_cut(frame, ray, (prim, u, v))
    }

    fn count(&self, counters: &mut Counters) {
        counters.cutout_tests += self.0.get();
        counters.texture_fetches += self.0.get();
    }
}
