//! Mapped surfaces → reflected light: one light at a time over a tile's points.

use std::f32::consts::{FRAC_1_PI, TAU};

use glam::Vec3;

use super::super::frame::{FrameLight, FrameLightKind};
use super::super::material::FrameMaterial;
use super::super::{Counters, Frame};
use super::trace::any_hits;
use super::{Mirrors, ShadowBatch, SurfaceBatch};
use crate::geometry::{OriginRule, Ray, offset_origin};
use crate::math::LinearRgb;
use crate::scene::ShadingModel;
use crate::shading::{Falloff, phong_lobe, reflect};
use crate::surface::SurfaceInteraction;

/// Shadow rays end this share short of the light, so that a mesh around the lamp does not shadow it by
/// rounding.
pub const LIGHT_END: f32 = 1.0 - 1.0 / 1_048_576.0;

/// A lamp nearer than this (internal units) lies in the surface: there is no direction to it.
const MIN_LIGHT_DISTANCE: f32 = 1e-18;

/// Fills `batch.reflected` with the light that every point sends to the eye, mirrors left out (2.14
/// corrected).
pub fn reflected_light(
    frame: &Frame<'_>,
    mirrors: Mirrors,
    batch: &mut SurfaceBatch,
    shadows: &mut ShadowBatch,
    counters: &mut Counters,
) {
    let ambient = frame.ambient;
    batch.reflected.clear();
    batch
        .reflected
        .extend(batch.diffuse.iter().map(|&kd| kd * ambient));
    for light in &frame.lights {
        collect_lit(frame, light, mirrors, batch, shadows);
        if frame.shadows {
            any_hits(
                frame,
                &shadows.rays,
                &shadows.t_max,
                &mut shadows.occluded,
                counters,
            );
        } else {
            shadows.occluded.clear();
            shadows.occluded.resize(shadows.rays.len(), false);
        }
        add_light(frame, batch, shadows, counters);
    }
}

/// Lists the points that can see the light if nothing is between: it must be outside for the geometric
/// and for the shading normal, or reliefs leak light. The others cost no shadow ray.
fn collect_lit(
    frame: &Frame<'_>,
    light: &FrameLight,
    mirrors: Mirrors,
    batch: &SurfaceBatch,
    shadows: &mut ShadowBatch,
) {
    shadows.point.clear();
    shadows.arriving.clear();
    shadows.rays.clear();
    shadows.t_max.clear();
    for (material, run) in &batch.runs {
        let material = &frame.materials[*material];
        if mirrors.local_share(material.reflectivity) <= 0.0 {
            continue;
        }
        for i in run.clone() {
            let s = &batch.points[i];
            if batch.diffuse[i].max_channel() <= 0.0 && !material.is_glossy {
                continue;
            }
            let Some((wi, distance, irradiance)) = arriving(light, s) else {
                continue;
            };
            if !(s.n_geo.dot(wi) > 0.0 && s.n_shade.dot(wi) > 0.0) {
                continue;
            }
            shadows.point.push(i as u32);
            shadows.arriving.push((wi, irradiance));
            let origin = offset_origin(s.p, s.p_error, s.n_geo, wi, OriginRule::Bound);
            shadows.rays.push(Ray { origin, dir: wi });
            shadows.t_max.push(distance * LIGHT_END);
        }
    }
}

/// Unit direction to the light, distance to it and irradiance on a surface that faces it.
pub fn arriving(light: &FrameLight, s: &SurfaceInteraction) -> Option<(Vec3, f32, LinearRgb)> {
    match light.kind {
        FrameLightKind::Directional(wi) => Some((wi, f32::INFINITY, light.irradiance)),
        FrameLightKind::Point(place, falloff) => {
            let to_light = place - s.p;
            let distance = to_light.length();
            if !(distance > MIN_LIGHT_DISTANCE && distance.is_finite()) {
                return None;
            }
            let irradiance = match falloff {
                Falloff::None => light.irradiance,
                Falloff::InverseSquare => light.irradiance * (1.0 / (distance * distance)),
            };
            Some((to_light / distance, distance, irradiance))
        }
    }
}

fn add_light(
    frame: &Frame<'_>,
    batch: &mut SurfaceBatch,
    shadows: &ShadowBatch,
    counters: &mut Counters,
) {
    // Points of the list are in run order, so each run is one stretch of it.
    let mut next = 0;
    for (material, run) in &batch.runs {
        let material = &frame.materials[*material];
        while next < shadows.point.len() && run.contains(&(shadows.point[next] as usize)) {
            let i = shadows.point[next] as usize;
            let (wi, irradiance) = shadows.arriving[next];
            let visible = !shadows.occluded[next];
            next += 1;
            if !visible {
                continue;
            }
            let response = response(
                frame.model,
                material,
                &batch.points[i],
                batch.diffuse[i],
                wi,
            );
            counters.power_calls += u64::from(response.took_power);
            batch.reflected[i] += irradiance * response.sum();
        }
    }
}

/// What a point makes of one unit of irradiance (on a facing surface) that arrives from `wi`.
#[derive(Debug, Clone, Copy)]
pub struct Response {
    /// Diffuse part.
    pub diffuse: LinearRgb,
    /// Specular part; black for matte materials and highlights that point away.
    pub specular: LinearRgb,
    /// Whether a power was taken for it.
    pub took_power: bool,
}

impl Response {
    /// Both parts.
    #[must_use]
    pub fn sum(&self) -> LinearRgb {
        self.diffuse + self.specular
    }
}

/// Lambert and Phong for one light direction on the lit side (2.10, 2.13, 2.14 corrected).
#[must_use]
pub fn response(
    model: ShadingModel,
    material: &FrameMaterial<'_>,
    s: &SurfaceInteraction,
    diffuse: LinearRgb,
    wi: Vec3,
) -> Response {
    let (diffuse_factor, specular_factor) = factors(model, material);
    let cos = s.n_shade.dot(wi);
    let diffuse = diffuse * (diffuse_factor * cos);
    let lobe = if material.is_glossy {
        phong_lobe(reflect(s.n_shade, wi), s.wo, material.shininess)
    } else {
        None
    };
    let foreshortening = if model == ShadingModel::Normalized {
        cos
    } else {
        1.0
    };
    let specular = lobe.map_or(LinearRgb::BLACK, |l| {
        material.ks * (specular_factor * foreshortening * l)
    });
    Response {
        diffuse,
        specular,
        took_power: lobe.is_some(),
    }
}

/// Factors of the diffuse and specular terms: 1 for the report's letter, `1/π` and `(s+2)/2π` for
/// energy-conserving Phong.
fn factors(model: ShadingModel, material: &FrameMaterial<'_>) -> (f32, f32) {
    match model {
        ShadingModel::Report => (1.0, 1.0),
        ShadingModel::Normalized => (FRAC_1_PI, (material.shininess + 2.0) / TAU),
    }
}
