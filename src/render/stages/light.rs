//! Mapped surfaces → reflected light: one light at a time over a tile's points.

use std::f32::consts::{FRAC_1_PI, TAU};

use super::super::frame::{FrameLight, FrameLightKind};
use super::super::material::FrameMaterial;
use super::super::{Counters, Frame};
use super::relief;
use super::trace::any_hits;
use super::walks::Walks;
use super::{
    Column, Mirrors, PLACES, Places, Rays, Shadows, Stage, StageWatch, Surfaces, get_rgb, get3,
    groups, set, set_rgb, set3,
};
use crate::geometry::{HitLanes, NO_HIT, offset_by_bound};
use crate::math::lanes::Lanes;
use crate::math::simd::{Kernel, Simd};
use crate::math::wide::Wide;
use crate::math::{LinearRgb, Real, V3, gamma};
use crate::scene::{BentNormals, ShadingModel};
use crate::shading::{Falloff, phong_lobe, reflect, softened_horizon, widened_exponent};
use crate::surface::displaced::Tracer;

/// Shadow rays end this share short of the light, so that a mesh around the lamp does not shadow it by
/// rounding.
pub const LIGHT_END: f32 = 1.0 - 1.0 / 1_048_576.0;

/// A lamp nearer than this (internal units) lies in the surface: there is no direction to it.
const MIN_LIGHT_DISTANCE: f32 = 1e-18;

/// Works out the light that every point sends to the eye, mirrors left out (2.14 corrected).
pub fn reflected_light(
    frame: &Frame<'_>,
    mirrors: Mirrors,
    (rays, hits): (&Rays, &HitLanes<PLACES>),
    surfaces: &mut Surfaces,
    (shadows, (walks, tracer)): (&mut Shadows, (&mut Walks, &mut Tracer)),
    counters: &mut Counters,
    watch: &mut impl StageWatch,
) {
    // A facet that counts as smooth may stand in the way of its own points.
    shadows.rays.leaving = if surfaces.runs.iter().any(|run| run.smoothed) {
        Lanes::splat(NO_HIT)
    } else {
        hits.prim
    };
    frame.level.run_or_plain(Ambient {
        frame,
        count: rays.count,
        surfaces,
    });
    if surfaces.runs.iter().any(|run| run.searches) {
        // Their rays leave from elsewhere, by method and amplitude.
        shadows.known = None;
    }
    if let Some(known) = &mut shadows.known {
        known.keep_for(frame);
    }
    for light in &frame.lights {
        aim_at_light(frame, light, mirrors, (rays, surfaces), shadows);
        shadows.occluded = Places::EMPTY;
        if frame.shadows {
            watch.done(Stage::Shade);
            relief::shadow_by_relief(frame, (hits, surfaces), shadows, walks, counters, watch);
            watch.done(Stage::Perturb);
        }
        if frame.shadows && !shadows.lit.is_empty() {
            let mut trace =
                |shadows: &mut Shadows| any_hits(frame, rays.count, shadows, tracer, counters);
            match shadows.known.take() {
                None => trace(shadows),
                Some(mut known) => {
                    known.any_hits(light, shadows, trace);
                    shadows.known = Some(known);
                }
            }
            watch.shadowed(frame, (rays, surfaces), (shadows, tracer));
            watch.done(Stage::Trace);
        }
        frame.level.run_or_plain(AddLight {
            frame,
            light,
            rays,
            surfaces,
            shadows,
            counters,
        });
    }
}

/// More light than this counts as this: what the largest floats make would be infinite, and infinity times
/// nothing is no colour.
const MOST_LIGHT: f32 = 1e30;

/// Sets the shadow rays to one light.
pub fn aim_at_light(
    frame: &Frame<'_>,
    light: &FrameLight,
    mirrors: Mirrors,
    (rays, surfaces): (&Rays, &Surfaces),
    shadows: &mut Shadows,
) {
    frame.level.run_or_plain(AimAtLight {
        frame,
        light,
        mirrors,
        rays,
        surfaces,
        shadows,
    });
}

/// Starts with the light from everywhere.
struct Ambient<'a> {
    frame: &'a Frame<'a>,
    count: usize,
    surfaces: &'a mut Surfaces,
}

impl Kernel for Ambient<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let ambient = LinearRgb::splat(Wide::new(simd, 0.0), self.frame.ambient);
        for group in 0..groups::<S>(self.count) {
            let light = get_rgb(simd, &self.surfaces.diffuse, group) * ambient;
            let [r, g, b] = &mut self.surfaces.reflected;
            r.set(group, light.r);
            g.set(group, light.g);
            b.set(group, light.b);
        }
    }
}

/// Sets shadow rays from the points that can see the light if nothing is between: it must be outside for the
/// geometric and for the shading normal, or reliefs leak light. The others cost no shadow ray. On facets that count as
/// smooth the interpolated normal stands for the geometric one.
struct AimAtLight<'a> {
    frame: &'a Frame<'a>,
    light: &'a FrameLight,
    mirrors: Mirrors,
    rays: &'a Rays,
    surfaces: &'a Surfaces,
    shadows: &'a mut Shadows,
}

impl Kernel for AimAtLight<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let zero = Wide::new(simd, 0.0);
        let (from, to) = (self.surfaces, self.shadows);
        to.lit = Places::EMPTY;
        to.rays.t_max = Column::splat(-1.0);
        for run in &from.runs {
            let material = &self.frame.materials[run.material];
            if self.mirrors.local_share(material.reflectivity) <= 0.0 {
                continue;
            }
            for group in run.places.groups::<S>() {
                let mut lit = run.places.mask(simd, group);
                if !material.is_glossy {
                    let LinearRgb { r, g, b } = get_rgb(simd, &from.diffuse, group);
                    lit = lit & r.larger(g).larger(b).gt(zero);
                }
                let p = get3(simd, &from.p, group);
                let n_geo = get3(simd, &from.n_geo, group);
                let n_shade = get3(simd, &from.n_shade, group);
                let light = arriving(self.light, p);
                lit = lit & light.arrives & n_shade.dot(light.wi).gt(zero);
                let mut bound = from.bound.get(simd, group);
                let mut base = p;
                if run.searches {
                    let sunk = from.relief.sunk.get(simd, group);
                    let wo = -get3(simd, &self.rays.lanes.dir, group);
                    let way_out = relief::way_out((sunk, n_geo), wo, light.wi, run.kind.smooth);
                    base = p + way_out;
                    bound = bound + way_out.abs().dot(n_geo.abs()) * zero.splat(gamma(8));
                }
                if let Some(points) = from.smoothed.as_deref().filter(|_| run.smoothed) {
                    let point = points.get(simd, group);
                    bound = bound + point.rounding(base, n_geo);
                    base = base + point.lift;
                    lit = lit & point.faces(light.wi, n_geo, bound);
                } else {
                    lit = lit & n_geo.dot(light.wi).gt(zero);
                }
                let origin = offset_by_bound(base, bound, n_geo, n_geo);
                set3(&mut to.rays.origin, group, lit, origin);
                set3(&mut to.rays.dir, group, lit, light.wi);
                set(&mut to.rays.t_max, group, lit, light.distance * LIGHT_END);
                set(&mut to.falloff, group, lit, light.falloff);
                to.lit.add(group, lit);
            }
        }
    }
}

/// What reaches a point if nothing is between; with vector lanes, for each.
#[derive(Debug, Clone, Copy)]
pub struct Arriving<F: Real> {
    /// Unit direction to the light.
    pub wi: V3<F>,
    /// Distance to it; infinite for directional lights.
    pub distance: F,
    /// Irradiance on a surface that faces it, as a share of the light's.
    pub falloff: F,
    /// Whether there is a direction at all.
    pub arrives: F::Mask,
}

/// What reaches the point `p`.
#[inline(always)]
pub fn arriving<F: Real>(light: &FrameLight, p: V3<F>) -> Arriving<F> {
    let one = p.x.splat(1.0);
    match light.kind {
        FrameLightKind::Directional(wi) => Arriving {
            wi: V3::splat(one, wi),
            distance: one.splat(f32::INFINITY),
            falloff: one,
            arrives: one.eq(one),
        },
        FrameLightKind::Point(place, falloff) => {
            let to_light = V3::splat(one, place) - p;
            let distance = to_light.length();
            let per_distance = one / distance;
            Arriving {
                wi: to_light * per_distance,
                distance,
                falloff: match falloff {
                    Falloff::None => one,
                    Falloff::InverseSquare => per_distance * per_distance,
                },
                arrives: distance.gt(one.splat(MIN_LIGHT_DISTANCE)) & distance.is_finite(),
            }
        }
    }
}

/// Adds what the points that see the light make of it.
struct AddLight<'a> {
    frame: &'a Frame<'a>,
    light: &'a FrameLight,
    rays: &'a Rays,
    surfaces: &'a mut Surfaces,
    shadows: &'a Shadows,
    counters: &'a mut Counters,
}

impl Kernel for AddLight<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let irradiance = LinearRgb::splat(Wide::new(simd, 0.0), self.light.irradiance);
        let seen = self.shadows.lit & !self.shadows.occluded;
        let surfaces = self.surfaces;
        let mut powers = Places::EMPTY;
        for run in &surfaces.runs {
            let material = &self.frame.materials[run.material];
            let (seen, smoothed) = (run.places & seen, run.smoothed);
            for group in seen.groups::<S>() {
                let mask = seen.mask(simd, group);
                let response = response(
                    self.frame.model,
                    material,
                    get3(simd, &surfaces.n_shade, group),
                    -get3(simd, &self.rays.lanes.dir, group),
                    get_rgb(simd, &surfaces.diffuse, group),
                    get3(simd, &self.shadows.rays.dir, group),
                    material
                        .widens_highlights
                        .then(|| surfaces.slope_variance.get(simd, group)),
                );
                powers.add(group, response.took_power & mask);
                let mut falloff = self.shadows.falloff.get(simd, group);
                if self.frame.bent_normals == BentNormals::Softened {
                    let smoothed = surfaces.smoothed.as_deref().filter(|_| smoothed);
                    let horizon = match smoothed {
                        Some(points) => points.get(simd, group).normal,
                        None => get3(simd, &surfaces.n_geo, group),
                    };
                    let n_shade = get3(simd, &surfaces.n_shade, group);
                    let wi = get3(simd, &self.shadows.rays.dir, group);
                    falloff = falloff * softened_horizon(horizon, n_shade, wi);
                }
                let arriving = at_most(irradiance * falloff);
                let sum =
                    get_rgb(simd, &surfaces.reflected, group) + at_most(arriving * response.sum());
                set_rgb(&mut surfaces.reflected, group, mask, sum);
            }
        }
        self.counters.power_calls += powers.count();
    }
}

/// Each channel up to [`MOST_LIGHT`]; NaN stays, to be counted.
#[inline(always)]
fn at_most<F: Real>(LinearRgb { r, g, b }: LinearRgb<F>) -> LinearRgb<F> {
    let most = r.splat(MOST_LIGHT);
    LinearRgb {
        r: most.smaller(r),
        g: most.smaller(g),
        b: most.smaller(b),
    }
}

/// What a point makes of one unit of irradiance (on a facing surface); with vector lanes, for each.
#[derive(Debug, Clone, Copy)]
pub struct Response<F: Real = f32> {
    /// Diffuse part.
    pub diffuse: LinearRgb<F>,
    /// Specular part; black for matte materials and highlights that point away.
    pub specular: LinearRgb<F>,
    /// Whether a power was taken for it.
    pub took_power: F::Mask,
}

impl<F: Real> Response<F> {
    /// Both parts.
    #[inline(always)]
    #[must_use]
    pub fn sum(&self) -> LinearRgb<F> {
        self.diffuse + self.specular
    }
}

/// Lambert and Phong for one light direction on the lit side (2.10, 2.13, 2.14 corrected).
#[inline(always)]
#[must_use]
pub fn response<F: Real>(
    model: ShadingModel,
    material: &FrameMaterial<'_>,
    n_shade: V3<F>,
    wo: V3<F>,
    diffuse: LinearRgb<F>,
    wi: V3<F>,
    slope_variance: Option<F>,
) -> Response<F> {
    let (diffuse_factor, specular_factor) = factors(model, material);
    let cos = n_shade.dot(wi);
    let zero = cos.splat(0.0);
    let diffuse = diffuse * (cos * diffuse_factor);
    if !material.is_glossy {
        return Response {
            diffuse,
            specular: LinearRgb::splat(zero, LinearRgb::BLACK),
            took_power: zero.lt(zero),
        };
    }
    let r = reflect(n_shade, wi);
    let (specular_factor, (lobe, took_power)) = match slope_variance {
        None => (
            zero.splat(specular_factor),
            phong_lobe(r, wo, material.shininess),
        ),
        Some(variance) => {
            let exponent = widened_exponent(material.shininess, variance);
            let factor = widened_factor(model, material.shininess, exponent);
            (factor, phong_lobe(r, wo, exponent))
        }
    };
    let foreshortened = match model {
        ShadingModel::Normalized => lobe * cos,
        ShadingModel::Report => lobe,
    };
    Response {
        diffuse,
        specular: LinearRgb::splat(zero, material.ks) * (foreshortened * specular_factor),
        took_power,
    }
}

/// Factor of the specular term of a widened lobe. What the report leaves unnormalised keeps its energy,
/// `2π/(s+1)`.
#[inline(always)]
fn widened_factor<F: Real>(model: ShadingModel, shininess: f32, exponent: F) -> F {
    match model {
        ShadingModel::Report => (exponent + 1.0) / exponent.splat(shininess + 1.0),
        ShadingModel::Normalized => (exponent + 2.0) / exponent.splat(TAU),
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
