//! One pixel explained: the cut through the relief along its view ray, and where every method lands on it.

use std::fmt;
use std::sync::Arc;

use glam::Vec3;
use serde::Serialize;

use super::material::FrameMaterial;
use super::probe::first_hit;
use super::{Frame, Snapshot};
use crate::geometry::{Hit, Ray};
use crate::math::{V2, V3, normalize_or};
use crate::scene::TextureFilter;
use crate::surface::mapping::relief::{Layers, ReliefField, is_shadowed};
use crate::surface::mapping::{Derivative, MappingSettings, Method};
use crate::surface::{SurfaceInteraction, SurfaceParts, surface_at};

/// Most points of the drawn relief.
const MOST_POINTS: usize = 4000;

/// The cut through a relief that contains a pixel's view ray.
///
/// Places are `[x, z]` in world units: x along the surface away from the eye, z along its normal, `[0, 0]`
/// where the ray meets the mesh. The chart is taken as flat, as every method but displacement takes it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReliefProfile {
    /// Column and row.
    pub pixel: [u32; 2],
    /// Material name.
    pub material: String,
    /// The method chosen in the settings.
    pub method: &'static str,
    /// Angle between the view ray and the normal, degrees.
    pub angle_deg: f64,
    /// Length of a texel along the cut.
    pub texel: f64,
    /// Lowest and highest displacement of the map.
    pub range: [f64; 2],
    /// The relief along the cut.
    pub relief: Vec<[f64; 2]>,
    /// Where the ray comes in at the top of the relief, and where it would leave at the bottom.
    pub ray: [[f64; 2]; 2],
    /// The place that is really seen: the exact walk's.
    pub truth: [f64; 2],
    /// What each method makes of the pixel.
    pub methods: Vec<MethodProfile>,
    /// Lights as seen from the true place.
    pub lights: Vec<LightProfile>,
}

/// One method on the cut.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodProfile {
    /// Name.
    pub method: &'static str,
    /// Label.
    pub label: &'static str,
    /// The place on the relief whose colour and normal it shows.
    pub place: [f64; 2],
    /// Where it took samples on the way, on the ray.
    pub samples: Vec<[f64; 2]>,
    /// Height look-ups, or nodes for the exact walk; 0 for methods that only tilt normals.
    pub steps: u32,
    /// Distance of the texture coordinate from the true one, texels.
    pub uv_error_texels: f64,
    /// Angle of the shading normal to the true one, degrees.
    pub normal_error_deg: f64,
}

/// One light over the true place.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LightProfile {
    /// Name in the settings.
    pub name: String,
    /// Direction to it, projected on the cut; shorter than 1 where it stands to the side.
    pub dir: [f64; 2],
    /// Whether the relief is between.
    pub shadowed_by_relief: bool,
    /// Whether it is behind the surface there.
    pub behind: bool,
}

/// Why a pixel has no cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoProfile {
    /// It is not in the picture.
    Outside,
    /// Its ray leaves the scene.
    Nothing,
    /// What it hits has no height map, no texture coordinates, or amplitude 0.
    NoRelief,
    /// The eye is behind the surface.
    Behind,
}

impl fmt::Display for NoProfile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Outside => "the pixel is outside the picture",
            Self::Nothing => "the pixel's ray leaves the scene",
            Self::NoRelief => {
                "there is no relief to cut: no height map, no texture coordinates, or amplitude 0"
            }
            Self::Behind => "the eye is behind the surface there",
        })
    }
}

impl std::error::Error for NoProfile {}

/// Cuts the relief along the view ray of a pixel's centre.
///
/// Every method of the list is run on that one ray, by the code that renders; relaxed cones only where they
/// are the chosen method, because their map takes seconds to make.
///
/// # Errors
/// Where there is no relief to cut.
pub fn profile(snapshot: &Snapshot, pixel: [u32; 2]) -> Result<ReliefProfile, NoProfile> {
    let truth_settings = with_method(&snapshot.settings.mapping, Method::Exact);
    let mut settings = (*snapshot.settings).clone();
    settings.mapping = truth_settings;
    // What methods do at points, whatever the picture's filter makes of it.
    settings.shading.filter = TextureFilter::Bilinear;
    let exact = Snapshot {
        settings: Arc::new(settings),
        ..snapshot.clone()
    };
    let frame = Frame::new(&exact);
    let (ray, hit) = first_hit(&frame, &exact, pixel).ok_or(NoProfile::Outside)?;
    let hit = hit.ok_or(NoProfile::Nothing)?;
    let attributes = frame.mesh.attributes[hit.prim as usize];
    let index = usize::from(attributes.material);
    let material = &frame.materials[index];
    let field = material.mapping.self_shadow().ok_or(NoProfile::NoRelief)?;
    if !attributes.has_uv {
        return Err(NoProfile::NoRelief);
    }
    let cut = Cut::new(&frame, field, &ray, &hit)?;
    let mut truth = cut.surface;
    material.place_baked_frame((frame.mesh, frame.tangents), &hit, &mut truth);
    material.mapping.apply_to_point(&mut truth);
    let run = |method: Method, edit: &dyn Fn(&mut MappingSettings)| {
        let mut mapping = with_method(&snapshot.settings.mapping, method);
        edit(&mut mapping);
        let material = FrameMaterial::new(
            &exact.settings.materials[index],
            &exact.scene,
            (&mapping, &exact.settings.shading),
            false,
        );
        let mut s = cut.surface;
        material.place_baked_frame((frame.mesh, frame.tangents), &hit, &mut s);
        material.mapping.apply_to_point(&mut s);
        s
    };
    let chosen = snapshot.settings.mapping.method;
    // Displacement has no place on this ray but the truth itself.
    let shown = |method: &Method| match method {
        Method::Displacement => false,
        Method::RelaxedCone => chosen == *method,
        _ => true,
    };
    let methods = Method::ALL
        .into_iter()
        .filter(shown)
        .map(|method| cut.method(method, &snapshot.settings.mapping, &truth, &run))
        .collect();
    Ok(ReliefProfile {
        pixel,
        material: snapshot.settings.materials[index].name.clone(),
        method: chosen.name(),
        angle_deg: f64::from(cut.cos.acos().to_degrees()),
        texel: cut.texel,
        range: field.range().map(|z| cut.world(z)),
        relief: cut.relief(),
        ray: [field.range()[1], field.range()[0]].map(|z| cut.on_ray(z)),
        truth: cut.place(&truth),
        methods,
        lights: lights(&exact, &frame, &cut, &truth),
    })
}

/// The same mapping by another method, with everything on that it needs.
fn with_method(mapping: &MappingSettings, method: Method) -> MappingSettings {
    let mut mapping = *mapping;
    mapping.method = method;
    mapping.use_parallax = true;
    mapping.use_height = true;
    mapping.derivative = Derivative::Analytic;
    mapping.search.self_shadow = true;
    mapping.cut_at_border = false;
    mapping
}

/// The surface that a method makes of the pixel after an edit of its settings.
type Run<'a> = dyn Fn(Method, &dyn Fn(&mut MappingSettings)) -> SurfaceInteraction + 'a;

/// The plane of the cut.
struct Cut<'a> {
    field: &'a ReliefField<'a>,
    surface: SurfaceInteraction,
    cos: f32,
    /// Internal units on the surface per unit of z towards the eye.
    tan: f64,
    /// Unit tangent away from the eye.
    away: V3,
    /// Change of uv per internal unit along it.
    uv_per_x: [f64; 2],
    texel: f64,
    /// World units per internal unit.
    unit: f64,
}

impl<'a> Cut<'a> {
    fn new(
        frame: &'a Frame<'_>,
        field: &'a ReliefField<'a>,
        ray: &Ray,
        hit: &Hit,
    ) -> Result<Self, NoProfile> {
        let s = surface_at(frame.mesh, hit, ray, SurfaceParts::Gradients);
        let cos = s.wo.dot(s.n_shade);
        if cos <= 1e-4 {
            return Err(NoProfile::Behind);
        }
        let towards = s.wo - s.n_shade * cos;
        let along = normalize_or(Vec3::from(s.dp_du), Vec3::X);
        let away = V3::from(normalize_or(-Vec3::from(towards), along));
        let uv_per_x = [away.dot(s.grad_u), away.dot(s.grad_v)].map(f64::from);
        let rates = field.texels_per_uv();
        let per_x = (uv_per_x[0] * rates[0]).hypot(uv_per_x[1] * rates[1]);
        if !(per_x > 0.0 && per_x.is_finite()) {
            return Err(NoProfile::NoRelief);
        }
        let unit = 1.0 / frame.scale;
        Ok(Self {
            field,
            surface: s,
            cos: cos.min(1.0),
            tan: f64::from(towards.dot(towards).sqrt() / cos),
            away,
            uv_per_x,
            texel: unit / per_x,
            unit,
        })
    }

    fn world(&self, length: f64) -> f64 {
        length * self.unit
    }

    /// The place of the view ray at displacement z.
    fn on_ray(&self, z: f64) -> [f64; 2] {
        [self.world(-z * self.tan), self.world(z)]
    }

    /// Displacement of the relief at x, internal units.
    fn height(&self, x: f64) -> f64 {
        let V2 { x: u, y: v } = self.surface.uv;
        let uv = [
            f64::from(u) + self.uv_per_x[0] * x,
            f64::from(v) + self.uv_per_x[1] * x,
        ];
        self.field.displacement(self.field.texels_from_uv(uv))
    }

    /// The relief from a little before the ray comes in to a little after it would leave.
    fn relief(&self) -> Vec<[f64; 2]> {
        let [low, high] = self.field.range();
        let texel = self.texel / self.unit;
        let (first, last) = ((-high * self.tan).min(0.0), (-low * self.tan).max(0.0));
        let margin = (0.25 * (last - first)).max(high - low).max(4.0 * texel);
        let (first, last) = (first - margin, last + margin);
        // Four points a texel show the patches' curves.
        let count = ((last - first) / texel * 4.0).ceil().max(16.0) as usize;
        let count = count.min(MOST_POINTS);
        let at = |i: usize| first + (last - first) * i as f64 / count as f64;
        (0..=count)
            .map(at)
            .map(|x| [self.world(x), self.world(self.height(x))])
            .collect()
    }

    /// How far along the cut a texture coordinate lies, internal units.
    fn x_of(&self, uv: V2) -> f64 {
        let d = [uv.x - self.surface.uv.x, uv.y - self.surface.uv.y].map(f64::from);
        let [a, b] = self.uv_per_x;
        (d[0] * a + d[1] * b) / (a * a + b * b)
    }

    /// The place on the relief that a surface's texture coordinate means.
    fn place(&self, s: &SurfaceInteraction) -> [f64; 2] {
        let x = self.x_of(s.uv);
        [self.world(x), self.world(self.height(x))]
    }

    fn method(
        &self,
        method: Method,
        mapping: &MappingSettings,
        truth: &SurfaceInteraction,
        run: &Run<'_>,
    ) -> MethodProfile {
        let s = run(method, &|_| {});
        let rates = self.field.texels_per_uv();
        let du = f64::from(s.uv.x - truth.uv.x) * rates[0];
        let dv = f64::from(s.uv.y - truth.uv.y) * rates[1];
        let (n, t) = (Vec3::from(s.n_shade), Vec3::from(truth.n_shade));
        let steps = match method {
            Method::Parallax | Method::ParallaxLimited => 1,
            _ => s.steps as u32,
        };
        MethodProfile {
            method: method.name(),
            label: method.info().label,
            place: self.place(&s),
            samples: self.samples(method, mapping, steps, run),
            steps,
            uv_error_texels: du.hypot(dv),
            normal_error_deg: f64::from(n.cross(t).length().atan2(n.dot(t)).to_degrees()),
        }
    }

    /// Where a method looked on its way, bisections left out.
    fn samples(
        &self,
        method: Method,
        mapping: &MappingSettings,
        steps: u32,
        run: &Run<'_>,
    ) -> Vec<[f64; 2]> {
        let [low, high] = self.field.range();
        let search = &mapping.search;
        let layered = |layers: Layers, taken: u32| {
            let count = f64::from(layers.count(self.cos));
            (0..taken)
                .map(|k| self.on_ray(high - (high - low) * f64::from(k) / count))
                .collect()
        };
        // Where a search that is cut short stands.
        let stopped = |edit: &dyn Fn(&mut MappingSettings)| {
            let x = self.x_of(run(method, edit).uv);
            let z = if self.tan > 0.0 { -x / self.tan } else { 0.0 };
            self.on_ray(z)
        };
        match method {
            Method::Parallax | Method::ParallaxLimited => vec![[0.0; 2]],
            Method::Steep => layered(Layers::fixed(search.layers), steps),
            Method::Relief => {
                let linear = steps.saturating_sub(search.bisections);
                layered(Layers::fixed(search.layers), linear)
            }
            Method::Occlusion => layered(
                Layers {
                    fewest: search.min_layers.min(search.layers),
                    most: search.layers,
                },
                steps,
            ),
            Method::Iterative => std::iter::once([0.0; 2])
                .chain((1..search.iterations).map(|k| stopped(&|m| m.search.iterations = k)))
                .collect(),
            Method::RelaxedCone => (1..=steps.saturating_sub(search.bisections))
                .map(|k| {
                    stopped(&|m| {
                        m.search.layers = k;
                        m.search.bisections = 0;
                    })
                })
                .collect(),
            _ => Vec::new(),
        }
    }
}

fn lights(
    snapshot: &Snapshot,
    frame: &Frame<'_>,
    cut: &Cut<'_>,
    truth: &SurfaceInteraction,
) -> Vec<LightProfile> {
    let each = frame.lights.iter().filter_map(|light| {
        let arriving = super::stages::light::arriving(light, truth.p);
        if !arriving.arrives {
            return None;
        }
        let wi = arriving.wi;
        let behind = wi.dot(truth.n_geo) <= 0.0 || wi.dot(truth.n_shade) <= 0.0;
        let gradients = [truth.grad_u, truth.grad_v];
        let at = (truth.uv, gradients, truth.n_smooth);
        Some(LightProfile {
            name: snapshot.settings.lights[light.index].name.clone(),
            dir: [wi.dot(cut.away), wi.dot(truth.n_smooth)].map(f64::from),
            shadowed_by_relief: !behind && is_shadowed(cut.field, None, true, at, wi).0,
            behind,
        })
    });
    each.collect()
}
