//! Rays → hits, with cut-outs as holes.

use std::cell::Cell;

use super::super::{Counters, Frame};
use crate::geometry::bvh::AcceptAll;
use crate::geometry::triangle::Watertight;
use crate::geometry::{Hit, Ray};
use crate::surface::uv_at;

/// Closest hits of all rays. `hits` is resized to fit.
pub fn closest_hits(
    frame: &Frame<'_>,
    rays: &[Ray],
    t_max: &mut Vec<f32>,
    hits: &mut Vec<Option<Hit>>,
    counters: &mut Counters,
) {
    t_max.clear();
    t_max.resize(rays.len(), f32::INFINITY);
    hits.clear();
    hits.resize(rays.len(), None);
    if frame.has_cutouts {
        let tests = CutoutTests::default();
        let solid = |prim, u, v| tests.is_solid(frame, prim, u, v);
        frame
            .bvh
            .intersect_many::<Watertight, _>(rays, t_max, &solid, hits);
        tests.count(counters);
    } else {
        frame
            .bvh
            .intersect_many::<Watertight, _>(rays, t_max, &AcceptAll, hits);
    }
}

/// Whether anything solid lies before `t_max` on each ray. `occluded` is resized to fit.
pub fn any_hits(
    frame: &Frame<'_>,
    rays: &[Ray],
    t_max: &[f32],
    occluded: &mut Vec<bool>,
    counters: &mut Counters,
) {
    occluded.clear();
    occluded.resize(rays.len(), false);
    counters.shadow_rays += rays.len() as u64;
    if frame.has_cutouts {
        let tests = CutoutTests::default();
        let solid = |prim, u, v| tests.is_solid(frame, prim, u, v);
        frame
            .bvh
            .occluded_many::<Watertight, _>(rays, t_max, &solid, occluded);
        tests.count(counters);
    } else {
        frame
            .bvh
            .occluded_many::<Watertight, _>(rays, t_max, &AcceptAll, occluded);
    }
}

/// Counts cut-out decisions from inside the traversal, where counters cannot be borrowed mutably.
#[derive(Default)]
pub struct CutoutTests(Cell<u64>);

impl CutoutTests {
    pub fn is_solid(&self, frame: &Frame<'_>, prim: u32, u: f32, v: f32) -> bool {
        let attributes = frame.mesh.attributes[prim as usize];
        let Some(opacity) = &frame.materials[usize::from(attributes.material)].opacity else {
            return true;
        };
        if !attributes.has_uv {
            return true;
        }
        self.0.set(self.0.get() + 1);
        opacity.is_solid(uv_at(frame.mesh, prim, u, v))
    }

    fn count(&self, counters: &mut Counters) {
        counters.cutout_tests += self.0.get();
        counters.texture_fetches += self.0.get();
    }
}
