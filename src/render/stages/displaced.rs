//! Rays → hits where surfaces are truly displaced: geometry of its own, beside the triangles that are not.

use super::super::frame::FrameDisplacement;
use super::super::{Counters, Frame, Passage};
use super::trace::{plain_any_hits, plain_closest_hits};
use super::{Column, PLACES, Places, Rays, Shadows};
use crate::geometry::{HitLanes, NO_HIT};
use crate::surface::displaced::{Search, Tracer};

/// Closest hits of all rays. Of a displaced and a plain surface at the same distance the displaced one is
/// seen.
pub fn closest_hits(
    frame: &Frame<'_>,
    displaced: &FrameDisplacement<'_>,
    rays: &mut Rays,
    hits: &mut HitLanes<PLACES>,
    tracer: &mut Tracer,
    counters: &mut Counters,
) {
    let mesh = displaced.mesh(frame.mesh);
    let places = with_rays(&rays.active, &rays.lanes.t_max);
    tracer.clear();
    for place in places.iter() {
        tracer.push_for(place, rays.lanes.ray(place), rays.lanes.t_max.0[place]);
    }
    tracer.run_until(mesh, Search::Closest, frame.level, &|| frame.stop.now());
    counters.relief_steps += tracer.steps();
    counters.walks_spared += tracer.walks_spared();
    let mut lanes = hits.displaced.take().unwrap_or_default();
    lanes.places = Places::EMPTY;
    let ends = rays.lanes.t_max;
    let mut passage = Passage::default();
    for (place, mut hit) in places.iter().zip(tracer.hits(mesh)) {
        if displaced.has_holes {
            let (ray, t_max) = (rays.lanes.ray(place), ends.0[place]);
            hit = hit.and_then(|hit| passage.past_holes(frame, &ray, t_max, hit));
        }
        if let Some(hit) = hit {
            lanes.put(place, hit.p, hit.normal, hit.bound);
            lanes.prim.0[place] = hit.prim;
            lanes.weights[0].0[place] = hit.weights[0];
            lanes.weights[1].0[place] = hit.weights[1];
            rays.lanes.t_max.0[place] = hit.t;
        }
    }
    count_passage(&passage, counters);
    if displaced.displacement.has_plain() {
        plain_closest_hits(frame, rays, hits, counters);
    } else {
        hits.prim = crate::math::lanes::Lanes::splat(NO_HIT);
    }
    rays.lanes.t_max = ends;
    let places = lanes.places;
    for place in places.iter() {
        if hits.prim.0[place] == NO_HIT {
            let [u, v] = [0, 1].map(|k| lanes.weights[k].0[place]);
            hits.put(place, (lanes.prim.0[place], u, v));
        } else {
            lanes.places.remove(place);
        }
    }
    hits.displaced = Some(lanes);
}

/// Finds the shadow rays with something before their end.
pub fn any_hits(
    frame: &Frame<'_>,
    displaced: &FrameDisplacement<'_>,
    count: usize,
    shadows: &mut Shadows,
    tracer: &mut Tracer,
    counters: &mut Counters,
) {
    let mesh = displaced.mesh(frame.mesh);
    if displaced.displacement.has_plain() {
        plain_any_hits(frame, count, shadows, counters);
    }
    let open = shadows.lit & !shadows.occluded;
    let places = with_rays(&open, &shadows.rays.t_max);
    tracer.clear();
    for place in places.iter() {
        tracer.push_for(place, shadows.rays.ray(place), shadows.rays.t_max.0[place]);
    }
    tracer.run_until(mesh, Search::Any, frame.level, &|| frame.stop.now());
    counters.relief_steps += tracer.steps();
    counters.walks_spared += tracer.walks_spared();
    let mut passage = Passage::default();
    for (index, place) in places.iter().enumerate() {
        let mut blocked = tracer.is_hit(index);
        if blocked && displaced.has_holes {
            // Whatever came first may be a hole; which of all comes first was not asked.
            let (ray, t_max) = (shadows.rays.ray(place), shadows.rays.t_max.0[place]);
            blocked = passage.is_blocked(frame, &ray, t_max);
        }
        if blocked {
            shadows.occluded.insert(place);
        }
    }
    count_passage(&passage, counters);
}

fn count_passage(passage: &Passage, counters: &mut Counters) {
    counters.relief_steps += passage.steps;
    counters.cutout_tests += passage.tests;
    counters.texture_fetches += passage.tests;
}

/// The places whose rays have a length.
fn with_rays(places: &Places, t_max: &Column) -> Places {
    let mut with = *places;
    for place in places.iter() {
        if !(t_max.0[place] > 0.0) {
            with.remove(place);
        }
    }
    with
}
