//! The rays of one kind that a picture's first pass sends, as a list: for timing them alone, and for other tracers.
//!
//! The very stages that render tiles make them. As many rays of each kind are active as
//! [`Counters`] counts.

use super::film::{Film, lock};
use super::frame::{FrameLight, FrameLightKind};
use super::ray_list::{RayKind, RayList};
use super::stages::{
    PLACES, Places, Scratch, bounce, camera, light, mirrors_at, relief, surface, trace,
};
use super::{Counters, Frame, Snapshot};
use crate::geometry::RayLanes;

/// Rays of `kind` that the first sample of every pixel sends, in the tracer's order: tiles from the middle
/// outwards, bounce by bounce, light by light, pixels in blocks of 8 × 8.
///
/// Pixels keep their places within a tile: one that sends no such ray leaves an inactive place.
#[must_use]
pub fn rays_of(snapshot: &Snapshot, kind: RayKind) -> RayList {
    let frame = Frame::new(snapshot);
    let film = Film::new(snapshot.size, 1);
    let (mut list, mut scratch) = (RayList::default(), Scratch::default());
    for &index in &film.order {
        let pixels = lock(&film.tiles[index]).pixels;
        camera::camera_rays(&frame, &pixels, 0, &mut scratch.work.rays);
        let mut add = |rays: &RayLanes<PLACES>, active: Places| {
            for place in pixels.active.iter() {
                let ray = active.contains(place).then(|| rays.ray(place));
                list.push(ray.map(|ray| (ray, rays.t_max.0[place])));
            }
        };
        walk(&frame, kind, &mut scratch, &mut add);
    }
    list
}

/// Follows a tile's rays through all bounces and adds those of one kind, with their places.
fn walk(
    frame: &Frame<'_>,
    kind: RayKind,
    scratch: &mut Scratch,
    add: &mut impl FnMut(&RayLanes<PLACES>, Places),
) {
    let Scratch { hits, work, .. } = scratch;
    let counters = &mut Counters::default();
    for index in 0..=frame.max_bounces {
        let mirrors = mirrors_at(frame, index);
        if kind == RayKind::Camera || (kind == RayKind::Mirror && index > 0) {
            add(&work.rays.lanes, work.rays.active);
        }
        if kind == RayKind::Camera || (kind == RayKind::Mirror && index == frame.max_bounces) {
            return;
        }
        trace::closest_hits(frame, &mut work.rays, hits, &mut work.tracer, counters);
        let hit = (&work.rays, &**hits);
        surface::mapped_surfaces(frame, hit, &mut work.surfaces, &mut work.walks, counters);
        let lights = frame.lights.iter().filter(|light| is_sent_to(kind, light));
        for light in lights.filter(|_| frame.shadows) {
            let shadows = &mut work.shadows;
            light::aim_at_light(frame, light, mirrors, (&work.rays, &work.surfaces), shadows);
            let walks = &mut work.walks;
            relief::shadow_by_relief(
                frame,
                (hits, &work.surfaces),
                shadows,
                walks,
                counters,
                &mut (),
            );
            add(&shadows.rays, shadows.lit);
        }
        work.rays.active = bounce::turn_to_mirror_rays(frame, &mut work.rays, hits, &work.surfaces);
        if work.rays.active.is_empty() {
            return;
        }
    }
}

/// Whether shadow rays to this light are of that kind.
const fn is_sent_to(kind: RayKind, light: &FrameLight) -> bool {
    match light.kind {
        FrameLightKind::Point(..) => matches!(kind, RayKind::PointShadow),
        FrameLightKind::Directional(_) => matches!(kind, RayKind::SunShadow),
    }
}
