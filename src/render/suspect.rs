//! Camera and shadow rays traced once more, by a kernel and an offset that may be wrong.

use glam::Vec3;

use super::Frame;
use super::stages::relief::way_out;
use super::stages::trace::CutoutTests;
use super::stages::{Rays, Run, Shadows, Surfaces, vec_at};
use crate::geometry::{Kernel, OffsetRule, Ray, offset_origin};

/// Hits that differ by less than this share of the mesh's extent count as the same: neighbours along an edge.
const SAME_PLACE: f32 = 1e-3;

/// A textbook's ray–triangle test and its offset, held against the program's own.
#[derive(Debug, Clone, Copy)]
pub struct Suspect {
    /// The test.
    pub kernel: Kernel,
    /// Where leaving rays start.
    pub offset_rule: OffsetRule,
}

impl Suspect {
    /// Whether a camera ray ends elsewhere than at the distance `truth` (`None`: it leaves the scene).
    #[must_use]
    pub fn leaks(&self, frame: &Frame<'_>, ray: &Ray, truth: Option<f32>) -> bool {
        let tests = CutoutTests::default();
        let solid = |prim, u, v| tests.is_there(frame, ray, (prim, u, v));
        let found = self.kernel.closest(frame.bvh, ray, &solid).map(|hit| hit.t);
        let bounds = frame.bvh.bounds();
        let tolerance = SAME_PLACE * (bounds.max - bounds.min).length();
        match (found, truth) {
            (None, None) => false,
            // Written so that NaN counts as elsewhere.
            (Some(found), Some(truth)) => !((found - truth).abs() <= tolerance),
            _ => true,
        }
    }

    /// Whether the shadow ray from a place says something else than the one that was traced.
    #[must_use]
    pub fn shadows_wrongly(
        &self,
        frame: &Frame<'_>,
        (rays, surfaces): (&Rays, &Surfaces),
        shadows: &Shadows,
        (run, place): (&Run, usize),
    ) -> bool {
        let traced = shadows.rays.ray(place);
        let origin = match self.offset_rule {
            OffsetRule::Bound => traced.origin,
            OffsetRule::Fixed => {
                let n_geo = vec_at(&surfaces.n_geo, place);
                let smoothed = surfaces.smoothed.as_deref().filter(|_| run.smoothed);
                let lift = smoothed.map_or(Vec3::ZERO, |points| vec_at(&points.lift, place));
                let base = vec_at(&surfaces.p, place)
                    + out_of_relief((rays, surfaces), (run, place), traced.dir)
                    + lift;
                let rule = self.offset_rule.origin_rule();
                offset_origin(base, Vec3::ZERO, n_geo, n_geo, rule)
            }
        };
        let ray = Ray {
            origin,
            dir: traced.dir,
        };
        let tests = CutoutTests::default();
        let solid = |prim, u, v| tests.is_there(frame, &ray, (prim, u, v));
        let t_max = shadows.rays.t_max.0[place];
        let stopped = self.kernel.occluded(frame.bvh, &ray, t_max, &solid);
        stopped != shadows.occluded.contains(place)
    }
}

/// From a place on a relief to where its ray starts on the mesh.
fn out_of_relief(
    (rays, surfaces): (&Rays, &Surfaces),
    (run, place): (&Run, usize),
    dir: Vec3,
) -> Vec3 {
    if !run.searches {
        return Vec3::ZERO;
    }
    let sunk = surfaces.relief.sunk.0[place];
    let n_geo = vec_at(&surfaces.n_geo, place).into();
    let wo = (-rays.lanes.ray(place).dir).into();
    way_out((sunk, n_geo), wo, dir.into(), run.kind.smooth).into()
}
