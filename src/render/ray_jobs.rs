//! The rays of one kind that a picture's first pass sends, as a list: for timing them alone, and for other tracers.
//!
//! Made point by point with the scalar functions that the stages' kernels are measured against. As many rays
//! of each kind are active as [`Counters`](super::Counters) counts.

use super::film::{centre_first, tiles_of};
use super::frame::{FrameLight, FrameLightKind};
use super::ray_list::{RayKind, RayList};
use super::stages::light::{LIGHT_END, arriving};
use super::stages::{Mirrors, trace};
use super::tile::Tile;
use super::{Counters, Frame, Snapshot, pixel_sample};
use crate::geometry::{Hit, OriginRule, Ray, offset_origin};
use crate::shading::mirror_direction;
use crate::surface::{SurfaceInteraction, SurfaceParts, surface_at};

/// Side of the blocks in which a tile's pixels are listed.
const BLOCK_SIZE: u32 = 8;
/// A mirror ray with a smaller share of its pixel than this is not followed, as in the stages.
const MIN_WEIGHT: f32 = 1.0 / 512.0;

/// Rays of `kind` that the first sample of every pixel sends, in the tracer's order: tiles from the middle
/// outwards, bounce by bounce, light by light, pixels in blocks of 8 × 8.
///
/// Pixels keep their places within a tile: one that sends no such ray leaves an inactive place.
#[must_use]
pub fn rays_of(snapshot: &Snapshot, kind: RayKind) -> RayList {
    let frame = Frame::new(snapshot);
    let tiles = tiles_of(snapshot.size);
    let mut list = RayList::default();
    for index in centre_first(&tiles, snapshot.size) {
        walk(&frame, kind, camera_rays(&frame, &tiles[index]), &mut list);
    }
    list
}

/// A ray, and its share in the colour of its pixel.
type Sent = Option<(Ray, f32)>;

fn camera_rays(frame: &Frame<'_>, tile: &Tile) -> Vec<Sent> {
    let blocks = |n: u32| (0..n).step_by(BLOCK_SIZE as usize);
    let mut rays = Vec::new();
    for y_block in blocks(tile.height) {
        for x_block in blocks(tile.width) {
            for y in y_block..(y_block + BLOCK_SIZE).min(tile.height) {
                for x in x_block..(x_block + BLOCK_SIZE).min(tile.width) {
                    let (column, row) = (tile.x0 + x, tile.y0 + y);
                    let [sx, sy] = pixel_sample([column, row], 0);
                    let camera = &frame.camera;
                    let (origin, dir) = (
                        camera.origin,
                        camera.direction(column as f32 + sx, row as f32 + sy),
                    );
                    rays.push(Some((Ray { origin, dir }, 1.0)));
                }
            }
        }
    }
    rays
}

/// Follows a tile's rays through all bounces.
fn walk(frame: &Frame<'_>, kind: RayKind, mut sent: Vec<Sent>, list: &mut RayList) {
    for bounce in 0..=frame.max_bounces {
        if kind == RayKind::Camera || (kind == RayKind::Mirror && bounce > 0) {
            let endless = |sent: &Sent| sent.map(|(ray, _)| (ray, f32::INFINITY));
            sent.iter().for_each(|sent| list.push(endless(sent)));
        }
        let is_last = bounce == frame.max_bounces;
        if kind == RayKind::Camera || (kind == RayKind::Mirror && is_last) {
            return;
        }
        let mirrors = if is_last {
            Mirrors::End
        } else {
            Mirrors::Follow
        };
        let points = points(frame, &sent);
        let lights = frame.lights.iter().filter(|light| is_sent_to(kind, light));
        for light in lights.filter(|_| frame.shadows) {
            for point in &points {
                let point = point.as_ref();
                list.push(point.and_then(|point| shadow_ray(frame, mirrors, light, point)));
            }
        }
        sent.clear();
        sent.extend(points.iter().map(|point| match (mirrors, point) {
            (Mirrors::Follow, Some(point)) => mirror_ray(frame, point),
            _ => None,
        }));
        if sent.iter().all(Option::is_none) {
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

/// What a ray hit.
struct Point {
    surface: SurfaceInteraction,
    material: usize,
    has_uv: bool,
    weight: f32,
}

fn points(frame: &Frame<'_>, sent: &[Sent]) -> Vec<Option<Point>> {
    let rays: Vec<Ray> = sent.iter().flatten().map(|(ray, _)| *ray).collect();
    let (mut t_max, mut hits) = (Vec::new(), Vec::new());
    trace::closest_hits(
        frame,
        &rays,
        &mut t_max,
        &mut hits,
        &mut Counters::default(),
    );
    let mut hits = hits.into_iter();
    let of = |(ray, weight): (Ray, f32), hit: Hit| mapped_point(frame, &ray, &hit, weight);
    sent.iter()
        .map(|sent| sent.and_then(|sent| hits.next().flatten().map(|hit| of(sent, hit))))
        .collect()
}

/// The surface that a ray hit, perturbed, turned towards where the ray came from.
fn mapped_point(frame: &Frame<'_>, ray: &Ray, hit: &Hit, weight: f32) -> Point {
    let attributes = frame.mesh.attributes[hit.prim as usize];
    let material = usize::from(attributes.material);
    let parts = frame.materials[material].parts(attributes.has_uv);
    let mut s = surface_at(frame.mesh, hit, ray, parts);
    if parts == SurfaceParts::Gradients {
        let mapping = &frame.materials[material].mapping;
        mapping.apply(std::slice::from_mut(&mut s));
    }
    if s.wo.dot(s.n_geo) < 0.0 {
        s.n_geo = -s.n_geo;
        s.n_shade = -s.n_shade;
    }
    Point {
        surface: s,
        material,
        has_uv: parts >= SurfaceParts::Uv,
        weight,
    }
}

/// The ray to a light, if the light could make a difference.
fn shadow_ray(
    frame: &Frame<'_>,
    mirrors: Mirrors,
    light: &FrameLight,
    point: &Point,
) -> Option<(Ray, f32)> {
    let (material, s) = (&frame.materials[point.material], &point.surface);
    if mirrors.local_share(material.reflectivity) <= 0.0 {
        return None;
    }
    let albedo = material.albedo.as_ref().filter(|_| point.has_uv);
    let diffuse = albedo.map_or(material.kd, |map| material.kd * map.color(s.uv));
    if diffuse.max_channel() <= 0.0 && !material.is_glossy {
        return None;
    }
    let (wi, distance, _) = arriving(light, s)?;
    let is_outside = s.n_geo.dot(wi) > 0.0 && s.n_shade.dot(wi) > 0.0;
    is_outside.then(|| (leaving(s, wi), distance * LIGHT_END))
}

/// The ray to what is seen in a mirror.
fn mirror_ray(frame: &Frame<'_>, point: &Point) -> Sent {
    let reflectivity = frame.materials[point.material].reflectivity;
    let (s, weight) = (&point.surface, point.weight * reflectivity);
    let is_sent = reflectivity > 0.0 && weight >= MIN_WEIGHT;
    is_sent.then(|| {
        (
            leaving(s, mirror_direction(s.n_shade, s.n_geo, s.wo)),
            weight,
        )
    })
}

fn leaving(s: &SurfaceInteraction, dir: glam::Vec3) -> Ray {
    let origin = offset_origin(s.p, s.p_error, s.n_geo, dir, OriginRule::Bound);
    Ray { origin, dir }
}
