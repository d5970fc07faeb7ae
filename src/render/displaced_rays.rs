//! Single rays against the displaced surfaces of a frame, through the holes that are cut out of them.

use super::Frame;
use crate::geometry::Ray;
use crate::surface::displaced::{SurfaceHit, Tracer};

/// A ray goes through so many holes at the most: more layers than foliage has.
const MOST_HOLES: usize = 256;

/// Follows rays through holes. Keeps its lists, so that only the first ray allocates.
#[derive(Debug, Default)]
pub struct Passage {
    tracer: Tracer,
    /// Steps that its rays took.
    pub steps: u64,
    /// Places that it asked for holes.
    pub tests: u64,
}

impl Passage {
    /// What a ray meets of displaced surfaces before `t_max`, internal units.
    #[must_use]
    pub fn closest(&mut self, frame: &Frame<'_>, ray: &Ray, t_max: f32) -> Option<SurfaceHit> {
        let mesh = frame.displaced.as_ref()?.mesh(frame.mesh);
        let hit = mesh.closest(&mut self.tracer, ray, t_max, frame.level);
        self.steps += self.tracer.steps();
        self.past_holes(frame, ray, t_max, hit?)
    }

    /// Whether a ray meets any displaced surface before `t_max`.
    #[must_use]
    pub fn is_blocked(&mut self, frame: &Frame<'_>, ray: &Ray, t_max: f32) -> bool {
        let Some(displaced) = &frame.displaced else {
            return false;
        };
        if displaced.has_holes {
            return self.closest(frame, ray, t_max).is_some();
        }
        let mesh = displaced.mesh(frame.mesh);
        let blocked = mesh.blocks(&mut self.tracer, ray, t_max, frame.level);
        self.steps += self.tracer.steps();
        blocked
    }

    /// The first solid place from `hit` on, which is what the ray meets first, holes or not.
    #[must_use]
    pub fn past_holes(
        &mut self,
        frame: &Frame<'_>,
        ray: &Ray,
        t_max: f32,
        mut hit: SurfaceHit,
    ) -> Option<SurfaceHit> {
        let mesh = frame.displaced.as_ref()?.mesh(frame.mesh);
        for _ in 0..MOST_HOLES {
            if frame
                .holes(frame.mesh.attributes[hit.prim as usize])
                .is_none()
            {
                return Some(hit);
            }
            self.tests += 1;
            if frame.is_solid(hit.prim, hit.weights[0], hit.weights[1]) {
                return Some(hit);
            }
            // Out on the other side, as light that shines through would leave.
            let beyond = Ray::leaving((hit.p, hit.bound, hit.normal), ray.dir);
            let gone = (beyond.origin - ray.origin).dot(ray.dir);
            let next = mesh.closest(&mut self.tracer, &beyond, t_max - gone, frame.level);
            self.steps += self.tracer.steps();
            hit = next?;
            hit.t += gone;
        }
        None
    }
}
