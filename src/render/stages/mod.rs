//! The stages that a tile's rays walk through, each over flat arrays: rays → hits → surfaces → mapped
//! surfaces → light → next bounce. A stage knows only its neighbours' arrays.

pub mod bounce;
pub mod light;
pub mod surface;
pub mod trace;

use glam::Vec3;

use super::{Counters, Frame};
use crate::geometry::{Hit, Ray};
use crate::math::LinearRgb;
use crate::surface::SurfaceInteraction;

/// Whether points of this bounce send mirror rays on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mirrors {
    /// They do; the mirror's share of the colour comes from the next bounce.
    Follow,
    /// The last bounce: a mirror shows its own colour in full, as if it did not reflect.
    End,
}

impl Mirrors {
    /// Share of a point's own colour in what it shows.
    #[must_use]
    pub fn local_share(self, reflectivity: f32) -> f32 {
        match self {
            Self::Follow => 1.0 - reflectivity,
            Self::End => 1.0,
        }
    }
}

/// Rays of one bounce and the pixels they belong to.
#[derive(Debug, Default)]
pub struct RayQueue {
    /// The rays.
    pub rays: Vec<Ray>,
    /// Slot of each ray's pixel in the tile's list of samples.
    pub slots: Vec<u32>,
    /// Share of each ray's colour in its pixel.
    pub weights: Vec<f32>,
}

impl RayQueue {
    /// Forgets all rays, keeps the memory.
    pub fn clear(&mut self) {
        self.rays.clear();
        self.slots.clear();
        self.weights.clear();
    }

    /// Adds a ray.
    pub fn push(&mut self, ray: Ray, slot: u32, weight: f32) {
        self.rays.push(ray);
        self.slots.push(slot);
        self.weights.push(weight);
    }
}

/// Surface points of one bounce, those of one material next to each other.
#[derive(Debug, Default)]
pub struct SurfaceBatch {
    /// Index into the ray queue, sorted by material.
    pub ray: Vec<u32>,
    /// The points.
    pub points: Vec<SurfaceInteraction>,
    /// Diffuse colour of each: `k_d` times the albedo map.
    pub diffuse: Vec<LinearRgb>,
    /// Reflected light of each.
    pub reflected: Vec<LinearRgb>,
    /// Material index and range of points of every run.
    pub runs: Vec<(usize, std::ops::Range<usize>)>,
}

/// Shadow rays of one light.
#[derive(Debug, Default)]
pub struct ShadowBatch {
    /// Index of the lit point in the surface batch.
    pub point: Vec<u32>,
    /// Unit direction to the light and irradiance on a facing surface.
    pub arriving: Vec<(Vec3, LinearRgb)>,
    /// From the point to the light.
    pub rays: Vec<Ray>,
    /// Distance to the light.
    pub t_max: Vec<f32>,
    /// Whether something is between.
    pub occluded: Vec<bool>,
}

/// Arrays that a worker uses for one tile after another, so that the steady state allocates nothing.
#[derive(Debug, Default)]
pub struct Scratch {
    /// The tile's pixels in this pass.
    pub pixels: Vec<super::tile::TilePixel>,
    /// Rays of this bounce.
    pub queue: RayQueue,
    /// Rays of the next.
    pub next: RayQueue,
    /// How far each ray may go.
    pub t_max: Vec<f32>,
    /// Closest hits of `queue`.
    pub hits: Vec<Option<Hit>>,
    /// What they hit.
    pub surfaces: SurfaceBatch,
    /// One light at a time.
    pub shadows: ShadowBatch,
    /// Sum of each sample in the tile's list.
    pub radiance: Vec<LinearRgb>,
}

/// Everything that follows once the hits of the queue's rays are known: the samples get what these rays saw,
/// and `next` holds the mirror rays of the bounce after.
pub fn shade_hits(
    frame: &Frame<'_>,
    mirrors: Mirrors,
    scratch: &mut Scratch,
    counters: &mut Counters,
) {
    let Scratch {
        queue,
        next,
        hits,
        surfaces,
        shadows,
        radiance,
        ..
    } = scratch;
    surface::mapped_surfaces(frame, queue, hits, surfaces, counters);
    light::reflected_light(frame, mirrors, surfaces, shadows, counters);
    bounce::gather(frame, mirrors, (queue, hits), surfaces, radiance);
    next.clear();
    if mirrors == Mirrors::Follow {
        bounce::queue_mirrors(frame, queue, surfaces, next);
    }
}

/// Traces the queue's rays.
pub fn trace_queue(frame: &Frame<'_>, scratch: &mut Scratch, counters: &mut Counters) {
    let Scratch {
        queue, t_max, hits, ..
    } = scratch;
    trace::closest_hits(frame, &queue.rays, t_max, hits, counters);
}
