//! Rays → hits, with cut-outs as holes.

use std::cell::Cell;

use super::super::{Counters, Frame};
use super::{PLACES, Rays, Shadows, displaced};
use crate::geometry::HitLanes;
use crate::geometry::bvh::AcceptAll;
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
    let (bvh, rays, count) = (frame.bvh, &rays.lanes, rays.count);
    if frame.has_holes() {
        let tests = CutoutTests::default();
        let solid = |prim, u, v| tests.is_solid(frame, prim, u, v);
        bvh.intersect_lanes(rays, count, &solid, hits);
        tests.count(counters);
    } else {
        bvh.intersect_lanes(rays, count, &AcceptAll, hits);
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

    fn count(&self, counters: &mut Counters) {
        counters.cutout_tests += self.0.get();
        counters.texture_fetches += self.0.get();
    }
}
