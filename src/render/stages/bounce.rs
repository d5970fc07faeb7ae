//! Reflected light → the samples, and mirror rays → the next bounce's queue.

use super::super::Frame;
use super::{Mirrors, RayQueue, SurfaceBatch};
use crate::geometry::{Hit, OriginRule, Ray, offset_origin};
use crate::math::LinearRgb;
use crate::shading::mirror_direction;

/// A mirror ray with a smaller share of its pixel than this is not followed: half a step of 8 bits.
const MIN_WEIGHT: f32 = 1.0 / 512.0;

/// Adds the own colour, `(1 − r) · local` while mirrors are followed, of every hit and the background of every miss to the samples.
pub fn gather(
    frame: &Frame<'_>,
    mirrors: Mirrors,
    (queue, hits): (&RayQueue, &[Option<Hit>]),
    batch: &SurfaceBatch,
    radiance: &mut [LinearRgb],
) {
    for (i, _) in hits.iter().enumerate().filter(|(_, hit)| hit.is_none()) {
        radiance[queue.slots[i] as usize] += frame.background(queue.rays[i].dir) * queue.weights[i];
    }
    for (material, run) in &batch.runs {
        let local = mirrors.local_share(frame.materials[*material].reflectivity);
        for i in run.clone() {
            let ray = batch.ray[i] as usize;
            radiance[queue.slots[ray] as usize] +=
                batch.reflected[i] * (queue.weights[ray] * local);
        }
    }
}

/// Queues the mirror rays of all points whose material reflects. `next` was empty.
pub fn queue_mirrors(
    frame: &Frame<'_>,
    queue: &RayQueue,
    batch: &SurfaceBatch,
    next: &mut RayQueue,
) {
    for (material, run) in &batch.runs {
        let reflectivity = frame.materials[*material].reflectivity;
        if reflectivity <= 0.0 {
            continue;
        }
        for i in run.clone() {
            let ray = batch.ray[i] as usize;
            let weight = queue.weights[ray] * reflectivity;
            if weight < MIN_WEIGHT {
                continue;
            }
            let s = &batch.points[i];
            let dir = mirror_direction(s.n_shade, s.n_geo, s.wo);
            let origin = offset_origin(s.p, s.p_error, s.n_geo, dir, OriginRule::Bound);
            next.push(Ray { origin, dir }, queue.slots[ray], weight);
        }
    }
}
