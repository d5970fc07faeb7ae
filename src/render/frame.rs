//! A snapshot made ready for tiles: everything in internal units, every choice made.

use std::sync::Arc;

use glam::Vec3;

use super::material::{BoundOpacity, FrameMaterial};
use super::{Snapshot, Stop};
use crate::geometry::bvh::Bvh;
use crate::geometry::{Hit, Ray, TangentCell, TriangleAttributes, TriangleMesh, UvChart, UvCharts};
use crate::math::simd::SimdLevel;
use crate::math::{LinearRgb, Real, V3};
use crate::scene::{Background, BentNormals, Scene, ShadingModel, TextureFilter};
use crate::shading::{Falloff, LightKind};
use crate::surface::displaced::{DisplacedMesh, Displacement, MicroMesh, Reliefs};
use crate::surface::mapping::MappingSettings;
use crate::surface::mapping::relief::ReliefField;
use crate::surface::{SurfaceParts, surface_at, uv_at};

/// Camera rays of a pinhole in internal units (report 2.1–2.3 with rotation; pixel row 0 on top).
#[derive(Debug, Clone, Copy)]
pub struct FrameCamera {
    /// Pinhole.
    pub origin: Vec3,
    /// Direction to the middle of the picture.
    pub forward: Vec3,
    /// Change of direction per pixel to the right.
    pub per_column: Vec3,
    /// Change of direction per pixel downwards.
    pub per_row: Vec3,
    /// Half the picture's size in pixels.
    pub half: [f32; 2],
}

/// Where a light's rays come from, in internal units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FrameLightKind {
    /// Unit direction to the light.
    Directional(Vec3),
    /// Place, and whether light fades with the square of the distance.
    Point(Vec3, Falloff),
}

/// A light that sends something.
#[derive(Debug, Clone, Copy)]
pub struct FrameLight {
    /// Index in the settings.
    pub index: usize,
    /// Kind and place.
    pub kind: FrameLightKind,
    /// Irradiance on a facing surface; for inverse-square lights at internal distance 1.
    pub irradiance: LinearRgb,
}

/// Everything that tiles of one snapshot share.
#[derive(Debug)]
pub struct Frame<'a> {
    /// Triangles.
    pub mesh: &'a TriangleMesh,
    /// Their tangents; made already if a material needs them.
    pub tangents: &'a TangentCell,
    /// Tree over them.
    pub bvh: &'a Bvh,
    /// Vector instructions of the stages: those of the tree.
    pub level: SimdLevel,
    /// Rays of the eye.
    pub camera: FrameCamera,
    /// Point and directional lights that are on.
    pub lights: Vec<FrameLight>,
    /// Sum of the ambient lights.
    pub ambient: LinearRgb,
    /// One per material index.
    pub materials: Vec<FrameMaterial<'a>>,
    /// Whether any material has holes.
    pub has_cutouts: bool,
    /// The charts that reliefs end with, where they do.
    pub charts: Option<&'a UvCharts>,
    /// The reliefs that are geometry of their own, if there are any.
    pub displaced: Option<FrameDisplacement<'a>>,
    /// Reflection model.
    pub model: ShadingModel,
    /// Normals bent by maps.
    pub bent_normals: BentNormals,
    /// Whether meshes with smooth normals count as the smooth surfaces that they stand for, where light ends.
    pub smooth_terminator: bool,
    /// Growth of a ray's cone per distance, where maps are read as means over it.
    pub cone_spread: Option<f32>,
    /// Whether shadow rays are traced.
    pub shadows: bool,
    /// Mirror bounces at the most.
    pub max_bounces: u32,
    /// Behind everything.
    pub background: Background,
    /// Unit direction of the gradient's top.
    pub up: Vec3,
    /// Internal units per world unit.
    pub scale: f64,
    /// Asked while a tile is made whose rays may take long.
    pub stop: Stop<'a>,
}

impl<'a> Frame<'a> {
    /// Resolves a snapshot.
    #[must_use]
    pub fn new(snapshot: &'a Snapshot) -> Self {
        let (scene, settings) = (&*snapshot.scene, &*snapshot.settings);
        let lights = frame_lights(snapshot);
        let has_shadows = settings.shading.shadows && !lights.is_empty();
        let (mapping, shading) = (&settings.mapping, &settings.shading);
        let materials: Vec<_> = settings
            .materials
            .iter()
            .map(|m| FrameMaterial::new(m, scene, (mapping, shading), has_shadows))
            .collect();
        if materials.iter().any(|m| m.mapping.needs_baked_frame()) {
            scene.tangents.get(&scene.mesh);
        }
        Self {
            mesh: &scene.mesh,
            tangents: &scene.tangents,
            bvh: &scene.bvh,
            level: scene.bvh.level(),
            camera: FrameCamera::new(snapshot),
            lights,
            ambient: ambient(snapshot),
            has_cutouts: materials.iter().any(|m| m.opacity.is_some()),
            charts: (settings.mapping.cut_at_border
                && materials.iter().any(|m| m.mapping.shifts()))
            .then(|| scene.uv_charts.get(&scene.mesh)),
            displaced: FrameDisplacement::new(scene, &materials, mapping, has_shadows),
            materials,
            model: settings.shading.model,
            bent_normals: settings.shading.bent_normals,
            smooth_terminator: settings.shading.smooth_terminator,
            cone_spread: (settings.shading.filter == TextureFilter::Mip)
                .then(|| pixel_spread(snapshot)),
            shadows: settings.shading.shadows,
            max_bounces: settings.shading.max_bounces,
            background: settings.shading.background,
            scale: scene.normalization.scale,
            up: settings.camera.up.normalize_or(glam::DVec3::Z).as_vec3(),
            stop: Stop::default(),
        }
    }

    /// Makes what takes a while and many rays gain by: the micro-triangles of displaced surfaces, if there is memory
    /// for them. It changes no pixel. Leaves off soon after `stop` says so.
    pub fn make_ready(&mut self, stop: &(dyn Fn() -> bool + Sync)) {
        let (mesh, level) = (self.mesh, self.level);
        if let Some(displaced) = &mut self.displaced {
            let memory = displaced.memory;
            let made =
                (displaced.displacement).make_micro(displaced.mesh(mesh), memory, level, stop);
            displaced.micro = made;
        }
    }

    /// Whether the tile under way was left off, so that nothing in it is to be used.
    #[must_use]
    pub fn is_left_off(&self) -> bool {
        self.displaced.is_some() && self.stop.now()
    }

    /// Whether triangles of this kind are displaced, so that they are not there themselves.
    #[inline]
    #[must_use]
    pub fn displaces(&self, attributes: TriangleAttributes) -> bool {
        let material = || &self.materials[usize::from(attributes.material)];
        self.displaced.is_some() && attributes.has_uv && material().relief.is_some()
    }

    /// The map of the holes in triangles of this kind.
    #[inline]
    #[must_use]
    pub fn holes(&self, attributes: TriangleAttributes) -> Option<&BoundOpacity<'a>> {
        let material = &self.materials[usize::from(attributes.material)];
        material.opacity.as_ref().filter(|_| attributes.has_uv)
    }

    /// Whether a point of a triangle is not cut out.
    #[must_use]
    pub fn is_solid(&self, prim: u32, u: f32, v: f32) -> bool {
        let holes = self.holes(self.mesh.attributes[prim as usize]);
        holes.is_none_or(|opacity| opacity.is_solid(uv_at(self.mesh, prim, u, v).into()))
    }

    /// The chart of a triangle that its relief ends with.
    #[inline]
    #[must_use]
    pub fn border(&self, prim: u32) -> Option<&'a UvChart> {
        self.charts.map(|charts| charts.chart(prim))
    }

    /// Whether a ray in the direction `dir` leaves the relief over a triangle by the border of its chart, so that
    /// what it hits is not there.
    #[must_use]
    pub fn is_cut(&self, dir: Vec3, prim: u32, u: f32, v: f32) -> bool {
        let Some(border) = self.border(prim) else {
            return false;
        };
        let attributes = self.mesh.attributes[prim as usize];
        let mapping = &self.materials[usize::from(attributes.material)].mapping;
        if !attributes.has_uv || !mapping.shifts() {
            return false;
        }
        let ray = Ray {
            origin: Vec3::ZERO,
            dir,
        };
        let hit = Hit {
            t: 0.0,
            prim,
            sub: 0,
            u,
            v,
        };
        let s = surface_at(self.mesh, &hit, &ray, SurfaceParts::Gradients);
        !border.contains(mapping.uv_seen(s))
    }

    /// Whether triangles of the tree may not be there.
    #[must_use]
    pub const fn has_holes(&self) -> bool {
        self.has_cutouts || self.displaced.is_some()
    }

    /// What a ray sees that leaves the scene in the unit direction `dir`.
    #[inline(always)]
    #[must_use]
    pub fn background<F: Real>(&self, dir: V3<F>) -> LinearRgb<F> {
        let Background { top, bottom } = self.background;
        let like = dir.x;
        if top == bottom {
            return LinearRgb::splat(like, top);
        }
        let height = dir.dot(V3::splat(like, self.up)) * 0.5 + 0.5;
        let height = height.larger(like.splat(0.0)).smaller(like.splat(1.0));
        LinearRgb::splat(like, bottom) + LinearRgb::splat(like, top - bottom) * height
    }
}

/// Reliefs that are geometry of their own.
#[derive(Debug)]
pub struct FrameDisplacement<'a> {
    /// One for each material.
    fields: Vec<Option<ReliefField<'a>>>,
    weld_seams: bool,
    /// Bytes that micro-triangles may be kept in.
    memory: usize,
    /// Whether holes are cut out of any of them.
    pub has_holes: bool,
    /// What was made of them and the mesh.
    pub displacement: Arc<Displacement>,
    /// All its micro-triangles, if they are there.
    micro: Option<Arc<MicroMesh>>,
}

impl<'a> FrameDisplacement<'a> {
    /// `None` if no material has such a relief.
    fn new(
        scene: &'a Scene,
        materials: &[FrameMaterial<'a>],
        mapping: &MappingSettings,
        has_shadows: bool,
    ) -> Option<Self> {
        let weld_seams = mapping.weld_seams;
        let has_holes = |m: &FrameMaterial<'_>| m.relief.is_some() && m.opacity.is_some();
        materials.iter().any(|m| m.relief.is_some()).then(|| {
            let mut fields: Vec<_> = materials.iter().map(|m| m.relief).collect();
            let reliefs = Reliefs {
                fields: &fields,
                weld_seams,
            };
            let displacement = scene.displaced.get(&scene.mesh, &reliefs);
            for (i, (field, material)) in fields.iter_mut().zip(materials).enumerate() {
                if has_shadows && displacement.walks(i) {
                    *field = material.relief_with_horizons();
                }
            }
            let memory = (mapping.displacement_memory as usize) << 20;
            Self {
                micro: displacement.micro(memory),
                fields,
                weld_seams,
                memory,
                has_holes: materials.iter().any(has_holes),
                displacement,
            }
        })
    }

    /// Everything that tracing needs.
    #[must_use]
    pub fn mesh<'f>(&'f self, mesh: &'f TriangleMesh) -> DisplacedMesh<'f, 'a> {
        DisplacedMesh {
            mesh,
            reliefs: Reliefs {
                fields: &self.fields,
                weld_seams: self.weld_seams,
            },
            displacement: &self.displacement,
            micro: self.micro.as_deref(),
        }
    }
}

/// Width of a pixel at distance 1.
fn pixel_spread(snapshot: &Snapshot) -> f32 {
    let height = f64::from(snapshot.size[1]);
    (2.0 * (snapshot.settings.camera.vfov * 0.5).tan() / height) as f32
}

impl FrameCamera {
    fn new(snapshot: &Snapshot) -> Self {
        let camera = &snapshot.settings.camera;
        let axes = camera.axes();
        let [width, height] = snapshot.size.map(f64::from);
        // Square pixels: the vertical field of view sets the size of both sides.
        let pixel = 2.0 * (camera.vfov * 0.5).tan() / height;
        Self {
            origin: snapshot.scene.normalization.internal_from_world(camera.eye),
            forward: axes.forward.as_vec3(),
            per_column: (axes.right * pixel).as_vec3(),
            per_row: (-axes.up * pixel).as_vec3(),
            half: [(width * 0.5) as f32, (height * 0.5) as f32],
        }
    }

    /// Unit direction through the point `(x, y)` of the picture, in pixels from its top left corner.
    #[inline(always)]
    #[must_use]
    pub fn direction<F: Real>(&self, x: F, y: F) -> V3<F> {
        let forward = V3::splat(x, self.forward);
        let right = V3::splat(x, self.per_column) * (x - self.half[0]);
        let down = V3::splat(x, self.per_row) * (y - self.half[1]);
        (forward + right + down).normalize_or(forward)
    }
}

fn frame_lights(snapshot: &Snapshot) -> Vec<FrameLight> {
    let normalization = &snapshot.scene.normalization;
    let mut lights = Vec::new();
    for (index, light) in snapshot.settings.lights.iter().enumerate() {
        let emitted = light.emitted();
        if emitted == LinearRgb::BLACK || !emitted.is_finite() {
            continue;
        }
        let (kind, irradiance) = match light.kind {
            LightKind::Ambient => continue,
            LightKind::Directional { direction } => {
                let Some(wi) = (-direction).try_normalize() else {
                    continue;
                };
                (
                    FrameLightKind::Directional(wi.as_vec3().normalize_or_zero()),
                    emitted,
                )
            }
            LightKind::Point { position, falloff } => {
                // d_world = d_internal / scale, so I / d_world² = I · scale² / d_internal².
                let factor = match falloff {
                    Falloff::None => 1.0,
                    Falloff::InverseSquare => normalization.scale * normalization.scale,
                };
                let place = normalization.internal_from_world(position);
                (
                    FrameLightKind::Point(place, falloff),
                    emitted.map(|c| (f64::from(c) * factor).min(f64::from(f32::MAX)) as f32),
                )
            }
        };
        lights.push(FrameLight {
            index,
            kind,
            irradiance,
        });
    }
    lights
}

fn ambient(snapshot: &Snapshot) -> LinearRgb {
    let ambient = snapshot
        .settings
        .lights
        .iter()
        .filter(|l| l.kind == LightKind::Ambient);
    ambient
        .map(crate::shading::Light::emitted)
        .fold(LinearRgb::BLACK, |sum, e| sum + e)
}
