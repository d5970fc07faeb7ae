//! The whole story of one pixel.

use std::fmt;

use glam::{DVec3, Vec3};
use serde::Serialize;

use super::stages::camera::Pixels;
use super::stages::{
    self, Column, Column3, Places, Scratch, Surfaces, camera, light, surface, trace,
};
use super::{Counters, Frame, Passage, Snapshot};
use crate::geometry::triangle::Watertight;
use crate::geometry::{Hit, Ray, UvChart, offset_by_bound};
use crate::math::{LinearRgb, V3, angle, gamma, srgb8_from_linear};
use crate::scene::BentNormals;
use crate::shading::softened_horizon;
use crate::surface::displaced::SurfaceHit;
use crate::surface::mapping::relief::is_shadowed;
use crate::surface::{
    Facet, FacetKind, SmoothedPoint, SurfaceInteraction, SurfaceParts, surface_at,
};

/// Every step from a pixel's first ray to its colour. Lengths are world units, directions unit vectors,
/// colours linear.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PixelStory {
    /// Column and row.
    pub pixel: [u32; 2],
    /// Method in use.
    pub method: &'static str,
    /// The camera ray and every mirror ray after it.
    pub bounces: Vec<BounceStory>,
    /// Colour of the first sample, without exposure.
    pub color: LinearRgb,
    /// The same as a screen takes it, without exposure.
    pub srgb8: [u8; 3],
}

/// One ray and what it found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BounceStory {
    /// Start.
    pub origin: [f64; 3],
    /// Direction.
    pub dir: [f32; 3],
    /// Share of this ray's colour in the pixel.
    pub weight: f32,
    /// What it hit; `None` if it left the scene.
    pub hit: Option<HitStory>,
    /// What it saw: reflected light without the mirror's share, or the background.
    pub color: LinearRgb,
}

/// A surface point, before and after the maps.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HitStory {
    /// Distance.
    pub t: f64,
    /// Triangle index in the traced mesh.
    pub triangle: u32,
    /// Weights of its three corners.
    pub barycentrics: [f32; 3],
    /// Material name.
    pub material: String,
    /// The point.
    pub p: [f64; 3],
    /// Bound on its rounding, per axis.
    pub p_error: [f64; 3],
    /// Whether the eye sees the front.
    pub front: bool,
    /// Texture coordinate of the point; `None` if the material needs none or the mesh has none.
    pub uv: Option<[f32; 2]>,
    /// The same after the method moved it.
    pub uv_moved: Option<[f32; 2]>,
    /// Surface gradients of u and v per world unit; zero where not needed.
    pub gradients: [[f64; 3]; 2],
    /// Geometric normal towards the eye.
    pub n_geo: [f32; 3],
    /// Interpolated normal towards the eye.
    pub n_smooth: [f32; 3],
    /// Perturbed normal towards the eye.
    pub n_shade: [f32; 3],
    /// Angle between the last two, degrees.
    pub tilt_deg: f32,
    /// Diffuse colour at the moved coordinate.
    pub diffuse: LinearRgb,
    /// How far along the geometric normal shadow rays start above the facet, because light takes the coarse mesh as
    /// smooth; `None` where it does not.
    pub lifted: Option<f64>,
    /// Light from everywhere, reflected.
    pub ambient: LinearRgb,
    /// Every point and directional light that is on.
    pub lights: Vec<LightStory>,
    /// Mirror share of the material.
    pub reflectivity: f32,
}

/// One light at one point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LightStory {
    /// Name in the settings.
    pub name: String,
    /// Direction to it.
    pub wi: [f32; 3],
    /// Distance; `None` for directional lights.
    pub distance: Option<f64>,
    /// Irradiance on a facing surface.
    pub irradiance: LinearRgb,
    /// Cosine with the geometric normal.
    pub cos_geo: f32,
    /// Cosine with the perturbed normal.
    pub cos_shade: f32,
    /// What became of it.
    pub visibility: Visibility,
    /// Diffuse light sent to the eye.
    pub diffuse: LinearRgb,
    /// Specular light sent to the eye.
    pub specular: LinearRgb,
}

/// Whether a light reaches a point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Visibility {
    /// It does.
    Visible,
    /// It is behind the geometric or the perturbed surface; no shadow ray was traced.
    Behind,
    /// The relief itself stands in between.
    ShadowedByRelief,
    /// A triangle stands in between, at this distance from the point.
    Shadowed {
        /// Triangle index.
        triangle: u32,
        /// World units.
        t: f64,
    },
}

/// Replays the first sample (the pixel's centre) of one pixel; `None` outside the picture.
///
/// Runs the very stages that render tiles, so its colour is the film's first sample to the bit.
#[must_use]
pub fn probe(snapshot: &Snapshot, pixel: [u32; 2]) -> Option<PixelStory> {
    let frame = Frame::new(snapshot);
    let Scratch {
        mut hits, mut work, ..
    } = Scratch::default();
    aim(&frame, snapshot, pixel, &mut work.rays)?;
    work.radiance = [Column::splat(0.0); 3];
    work.rays.count = 1;
    let mut bounces = Vec::new();
    for index in 0..=frame.max_bounces {
        let counters = &mut Counters::default();
        let (ray, weight) = (work.rays.lanes.ray(0), work.rays.weight.0[0]);
        let travelled = work.rays.travelled.0[0];
        let tracer = &mut work.tracer;
        trace::closest_hits(&frame, &mut work.rays, &mut hits, tracer, counters);
        work.shade_hits(
            &frame,
            &hits,
            stages::mirrors_at(&frame, index),
            counters,
            &mut (),
        );
        bounces.push(one_bounce(
            snapshot,
            &frame,
            (&ray, weight, travelled),
            &work.surfaces,
        ));
        if work.rays.active.is_empty() {
            break;
        }
    }
    let color = first(&work.radiance);
    let method = snapshot.settings.mapping.method.name();
    Some(PixelStory {
        pixel,
        method,
        bounces,
        color,
        srgb8: srgb8_from_linear(color),
    })
}

/// Puts the ray through the pixel's centre in the first place; `None` outside the picture.
fn aim(
    frame: &Frame<'_>,
    snapshot: &Snapshot,
    pixel: [u32; 2],
    rays: &mut stages::Rays,
) -> Option<()> {
    let [x, y] = pixel;
    if x >= snapshot.size[0] || y >= snapshot.size[1] {
        return None;
    }
    let mut active = Places::EMPTY;
    active.insert(0);
    let pixels = Pixels {
        corner: pixel,
        stride: 1,
        active,
    };
    camera::camera_rays(frame, &pixels, 0, rays);
    Some(())
}

/// The ray through a pixel's centre and what it hits; `None` outside the picture.
pub(super) fn first_hit(
    frame: &Frame<'_>,
    snapshot: &Snapshot,
    pixel: [u32; 2],
) -> Option<(Ray, Option<Hit>)> {
    let mut work = Scratch::default().work;
    aim(frame, snapshot, pixel, &mut work.rays)?;
    let ray = work.rays.lanes.ray(0);
    let found = nearest(frame, &ray, f32::INFINITY);
    Some((ray, found.map(|found| found.hit)))
}

/// The colour in the first place.
fn first([r, g, b]: &Column3) -> LinearRgb {
    LinearRgb::new(r.0[0], g.0[0], b.0[0])
}

fn one_bounce(
    snapshot: &Snapshot,
    frame: &Frame<'_>,
    (ray, weight, travelled): (&Ray, f32, f32),
    surfaces: &Surfaces,
) -> BounceStory {
    let hit = nearest(frame, ray, f32::INFINITY);
    let color = match hit {
        Some(_) => first(&surfaces.reflected),
        None => frame.background(V3::from(ray.dir)),
    };
    BounceStory {
        origin: snapshot
            .scene
            .normalization
            .world_from_internal(ray.origin)
            .to_array(),
        dir: ray.dir.to_array(),
        weight,
        hit: hit.map(|found| hit_story(snapshot, frame, (ray, travelled), &found)),
        color,
    }
}

/// A hit, and the point if it lies on a displaced surface.
struct Nearest {
    hit: Hit,
    displaced: Option<SurfaceHit>,
}

/// The nearest solid thing on a ray.
fn nearest(frame: &Frame<'_>, ray: &Ray, t_max: f32) -> Option<Nearest> {
    let tests = trace::CutoutTests::default();
    let solid = |prim, u, v| tests.is_there(frame, ray, (prim, u, v));
    let displaced = Passage::default().closest(frame, ray, t_max);
    let t_max = displaced.map_or(t_max, |hit| hit.t);
    let plain = frame.bvh.intersect::<Watertight, _>(ray, t_max, &solid);
    match (plain, displaced) {
        (Some(hit), _) => Some(Nearest {
            hit,
            displaced: None,
        }),
        (None, Some(point)) => Some(Nearest {
            hit: Hit {
                t: point.t,
                prim: point.prim,
                sub: 0,
                u: point.weights[0],
                v: point.weights[1],
            },
            displaced: Some(point),
        }),
        (None, None) => None,
    }
}

fn hit_story(
    snapshot: &Snapshot,
    frame: &Frame<'_>,
    (ray, travelled): (&Ray, f32),
    found: &Nearest,
) -> HitStory {
    let hit = &found.hit;
    let normalization = &snapshot.scene.normalization;
    let attributes = frame.mesh.attributes[hit.prim as usize];
    let index = usize::from(attributes.material);
    let material = &frame.materials[index];
    let parts = material.parts(attributes.has_uv);
    let mut plain = surface_at(frame.mesh, hit, ray, parts);
    if let Some(spread) = frame.cone_spread
        && parts == SurfaceParts::Gradients
    {
        plain.footprint = surface::cone_footprint(&plain, ray.origin.into(), travelled, spread);
    }
    if let Some(point) = &found.displaced {
        point.replace_point(&mut plain);
    }
    let mut mapped = plain;
    if found.displaced.is_some() {
        mapped.n_shade = plain.n_geo;
    }
    material.place_baked_frame((frame.mesh, frame.tangents), hit, &mut mapped);
    let front = plain.wo.dot(plain.n_geo) >= 0.0;
    let smoothed = smoothed(frame, found, &plain, front);
    let diffuse = surface::perturb(material, parts, &mut mapped);
    let slope_variance = surface::slope_variance(material, parts, &mapped);
    let has_uv = parts > SurfaceParts::Plain;
    let towards_eye = |n: V3| Vec3::from(if front { n } else { -n });
    (mapped.n_geo, mapped.n_shade) = (
        towards_eye(mapped.n_geo).into(),
        towards_eye(mapped.n_shade).into(),
    );
    let n_smooth = towards_eye(plain.n_shade);
    let point = LitPoint {
        s: &mapped,
        smooth: attributes.smooth,
        smoothed,
        material: index,
        border: frame.border(hit.prim),
        diffuse,
        slope_variance,
    };
    let tilt = angle(n_smooth.as_dvec3(), Vec3::from(mapped.n_shade).as_dvec3());
    let per_world = |g: V3| (Vec3::from(g).as_dvec3() * normalization.scale).to_array();
    HitStory {
        t: normalization.world_length(hit.t),
        triangle: hit.prim,
        barycentrics: [1.0 - hit.u - hit.v, hit.u, hit.v],
        material: snapshot.settings.materials[index].name.clone(),
        p: normalization.world_from_internal(plain.p.into()).to_array(),
        p_error: (Vec3::from(plain.p_error).as_dvec3() / normalization.scale).to_array(),
        front,
        uv: has_uv.then(|| plain.uv.into()),
        uv_moved: has_uv.then(|| mapped.uv.into()),
        gradients: [per_world(plain.grad_u), per_world(plain.grad_v)],
        n_geo: mapped.n_geo.into(),
        n_smooth: n_smooth.to_array(),
        n_shade: mapped.n_shade.into(),
        tilt_deg: tilt.to_degrees() as f32,
        diffuse,
        lifted: smoothed.map(|p| normalization.world_length(p.lift.dot(mapped.n_geo))),
        ambient: diffuse * frame.ambient,
        lights: frame
            .lights
            .iter()
            .filter_map(|light| light_story(snapshot, frame, light, &point))
            .collect(),
        reflectivity: material.reflectivity,
    }
}

/// The hit as a point of the smooth surface that its mesh stands for, where light takes it so.
fn smoothed(
    frame: &Frame<'_>,
    found: &Nearest,
    s: &SurfaceInteraction,
    front: bool,
) -> Option<SmoothedPoint> {
    let hit = &found.hit;
    let smooth = frame.mesh.attributes[hit.prim as usize].smooth;
    if !(frame.smooth_terminator && smooth && found.displaced.is_none()) {
        return None;
    }
    let parts = SurfaceParts::Plain;
    let facet = Facet::fetch(frame.mesh, hit.prim, FacetKind { smooth, parts });
    let towards_eye = |n: V3| if front { n } else { -n };
    let normals = (towards_eye(s.n_smooth), towards_eye(s.n_geo), !front);
    Some(SmoothedPoint::new(&facet, (hit.u, hit.v), s.p, normals))
}

/// A point as lights see it.
struct LitPoint<'a> {
    /// Its normals point to the eye.
    s: &'a SurfaceInteraction,
    /// Whether normals are interpolated.
    smooth: bool,
    smoothed: Option<SmoothedPoint>,
    material: usize,
    /// Of the relief that it is on.
    border: Option<&'a UvChart>,
    diffuse: LinearRgb,
    slope_variance: Option<f32>,
}

impl LitPoint<'_> {
    /// Where a ray in the unit direction `wi` starts before it is offset, and the bound on its rounding.
    fn start(&self, wi: V3) -> (V3, f32) {
        let s = self.s;
        let way_out = stages::relief::way_out((s.sunk, s.n_geo), s.wo, wi, self.smooth);
        let rounding = way_out.abs().dot(s.n_geo.abs()) * gamma(8);
        let (base, bound) = (s.p + way_out, s.n_geo.abs().dot(s.p_error) + rounding);
        match self.smoothed {
            Some(point) => (base + point.lift, bound + point.rounding(base, s.n_geo)),
            None => (base, bound),
        }
    }

    /// Normal of the surface whose horizon ends light.
    fn horizon(&self) -> V3 {
        self.smoothed.map_or(self.s.n_geo, |point| point.normal)
    }

    /// Whether light from the unit direction `wi` comes from outside.
    fn faces(&self, wi: V3) -> bool {
        let s = self.s;
        let outside = match self.smoothed {
            Some(point) => point.faces(wi, s.n_geo, self.start(wi).1),
            None => s.n_geo.dot(wi) > 0.0,
        };
        outside && s.n_shade.dot(wi) > 0.0
    }
}

fn light_story(
    snapshot: &Snapshot,
    frame: &Frame<'_>,
    light: &super::frame::FrameLight,
    point: &LitPoint<'_>,
) -> Option<LightStory> {
    let normalization = &snapshot.scene.normalization;
    let (s, diffuse, material) = (point.s, point.diffuse, point.material);
    let arriving = light::arriving(light, s.p);
    if !arriving.arrives {
        return None;
    }
    let (wi, distance) = (arriving.wi, arriving.distance);
    let mut irradiance = light.irradiance * arriving.falloff;
    if frame.bent_normals == BentNormals::Softened {
        irradiance *= softened_horizon(point.horizon(), s.n_shade, wi);
    }
    let (cos_geo, cos_shade) = (s.n_geo.dot(wi), s.n_shade.dot(wi));
    let visibility = if !point.faces(wi) {
        Visibility::Behind
    } else if frame.shadows && is_shadowed_by_relief(frame, s, wi, (material, point.border)) {
        Visibility::ShadowedByRelief
    } else if let Some(found) = frame
        .shadows
        .then(|| occluder(frame, point, (wi, distance)))
        .flatten()
    {
        Visibility::Shadowed {
            triangle: found.hit.prim,
            t: normalization.world_length(found.hit.t),
        }
    } else {
        Visibility::Visible
    };
    let material = &frame.materials[material];
    let response = light::response(
        frame.model,
        material,
        s.n_shade,
        s.wo,
        diffuse,
        wi,
        point.slope_variance,
    );
    let seen = if visibility == Visibility::Visible {
        irradiance
    } else {
        LinearRgb::BLACK
    };
    Some(LightStory {
        name: snapshot.settings.lights[light.index].name.clone(),
        wi: wi.into(),
        distance: distance
            .is_finite()
            .then(|| normalization.world_length(distance)),
        irradiance,
        cos_geo,
        cos_shade,
        visibility,
        diffuse: response.diffuse * seen,
        specular: response.specular * seen,
    })
}

/// Whether the relief at a point keeps a light from it.
fn is_shadowed_by_relief(
    frame: &Frame<'_>,
    s: &SurfaceInteraction,
    wi: V3,
    (material, border): (usize, Option<&UvChart>),
) -> bool {
    let field = frame.materials[material].mapping.self_shadow();
    field.filter(|_| s.steps > 0.0).is_some_and(|field| {
        let gradients = [s.grad_u, s.grad_v];
        is_shadowed(field, border, true, (s.uv, gradients, s.n_smooth), wi).0
    })
}

/// The nearest thing between a point and a light.
fn occluder(frame: &Frame<'_>, point: &LitPoint<'_>, (wi, distance): (V3, f32)) -> Option<Nearest> {
    let (start, bound) = point.start(wi);
    let ray = Ray {
        origin: offset_by_bound(start, bound, point.s.n_geo, point.s.n_geo).into(),
        dir: wi.into(),
    };
    nearest(frame, &ray, distance * light::LIGHT_END)
}

impl fmt::Display for PixelStory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "pixel ({}, {}), method {}",
            self.pixel[0], self.pixel[1], self.method
        )?;
        for (i, bounce) in self.bounces.iter().enumerate() {
            let kind = if i == 0 {
                "camera ray".to_owned()
            } else {
                format!("mirror ray {i}")
            };
            writeln!(
                f,
                "{kind}: from {} towards {}, weight {:.4}",
                V(bounce.origin),
                W(bounce.dir),
                bounce.weight
            )?;
            match &bounce.hit {
                None => writeln!(f, "  leaves the scene: background {}", C(bounce.color))?,
                Some(hit) => {
                    write!(f, "{hit}")?;
                    writeln!(f, "  own colour    {}", C(bounce.color))?;
                }
            }
        }
        let [r, g, b] = self.srgb8;
        writeln!(f, "colour {} linear, sRGB {r} {g} {b}", C(self.color))
    }
}

impl fmt::Display for HitStory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let side = if self.front { "front" } else { "back" };
        let [b0, b1, b2] = self.barycentrics;
        writeln!(
            f,
            "  hit           t = {:.6}, triangle {}, material {:?}, {side} side",
            self.t, self.triangle, self.material
        )?;
        writeln!(f, "  barycentrics  {b0:.6} {b1:.6} {b2:.6}")?;
        writeln!(
            f,
            "  point         {}, rounding at most {:.2e}",
            V(self.p),
            DVec3::from(self.p_error).max_element()
        )?;
        if let (Some([u, v]), Some([mu, mv])) = (self.uv, self.uv_moved) {
            writeln!(
                f,
                "  uv            {u:.6} {v:.6}, after mapping {mu:.6} {mv:.6} (moved {:+.6} {:+.6})",
                mu - u,
                mv - v
            )?;
            writeln!(f, "  grad u        {} per unit", V(self.gradients[0]))?;
            writeln!(f, "  grad v        {} per unit", V(self.gradients[1]))?;
        }
        writeln!(f, "  n geometric   {}", W(self.n_geo))?;
        writeln!(f, "  n smooth      {}", W(self.n_smooth))?;
        writeln!(
            f,
            "  n shading     {}, tilted {:.3} degrees",
            W(self.n_shade),
            self.tilt_deg
        )?;
        writeln!(f, "  diffuse       {}", C(self.diffuse))?;
        if let Some(lifted) = self.lifted {
            writeln!(f, "  shadow rays   start {lifted:.3e} over the facet")?;
        }
        writeln!(f, "  ambient       {}", C(self.ambient))?;
        for light in &self.lights {
            write!(f, "{light}")?;
        }
        if self.reflectivity > 0.0 {
            writeln!(f, "  mirror share  {:.3}", self.reflectivity)?;
        }
        Ok(())
    }
}

impl fmt::Display for LightStory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "  light {:?}: towards {}", self.name, W(self.wi))?;
        if let Some(distance) = self.distance {
            write!(f, ", {distance:.6} away")?;
        }
        writeln!(f, ", irradiance {}", C(self.irradiance))?;
        write!(
            f,
            "    cosines {:.4} geometric, {:.4} shading: ",
            self.cos_geo, self.cos_shade
        )?;
        match self.visibility {
            Visibility::Visible => writeln!(
                f,
                "diffuse {}, specular {}",
                C(self.diffuse),
                C(self.specular)
            ),
            Visibility::Behind => writeln!(f, "behind the surface, no shadow ray"),
            Visibility::ShadowedByRelief => writeln!(f, "shadowed by the relief itself"),
            Visibility::Shadowed { triangle, t } => {
                writeln!(f, "shadowed by triangle {triangle} at {t:.6}")
            }
        }
    }
}

/// Prints a point.
struct V([f64; 3]);
/// Prints a direction.
struct W([f32; 3]);
/// Prints a colour.
struct C(LinearRgb);

impl fmt::Display for V {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "({:.6}, {:.6}, {:.6})", self.0[0], self.0[1], self.0[2])
    }
}
impl fmt::Display for W {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "({:+.5}, {:+.5}, {:+.5})",
            self.0[0], self.0[1], self.0[2]
        )
    }
}
impl fmt::Display for C {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "({:.5}, {:.5}, {:.5})", self.0.r, self.0.g, self.0.b)
    }
}
