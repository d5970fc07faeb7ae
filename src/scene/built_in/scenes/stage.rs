//! What a scene function sets up, and how it becomes a loaded scene.

use std::sync::Arc;

use glam::DVec3;

use super::super::meshes::WorldMesh;
use super::super::{BuiltInInfo, Palette, Placement, assemble};
use crate::math::LinearRgb;
use crate::scene::load::LoadOptions;
use crate::scene::{
    Background, Camera, DisplaySettings, LoadedScene, RenderSettings, SceneSource, ShadingSettings,
};
use crate::shading::{Falloff, Light, LightKind};
use crate::surface::mapping::MappingSettings;

/// Geometry, materials, light and camera of a scene.
#[derive(Debug)]
pub struct Stage {
    /// Everything solid, world units.
    pub mesh: WorldMesh,
    /// Materials and their pictures.
    pub palette: Palette,
    /// Where the eye is.
    pub camera: Camera,
    /// Ambient, sun and lamps.
    pub lights: Vec<Light>,
    /// Behind everything.
    pub background: Background,
    /// Stops, see [`DisplaySettings`].
    pub exposure_ev: f32,
}

impl Stage {
    /// The scene with its starting settings.
    pub fn finish(
        mut self,
        info: &BuiltInInfo,
        placement: Placement,
        options: &LoadOptions,
    ) -> LoadedScene {
        placement.apply(&mut self);
        let source = SceneSource::BuiltIn(placement.name(info.name));
        let scene = assemble(info.label, source, &self.mesh, self.palette.images, options);
        LoadedScene {
            scene: Arc::new(scene),
            settings: RenderSettings {
                camera: self.camera,
                lights: self.lights,
                materials: self.palette.materials,
                shading: ShadingSettings {
                    background: self.background,
                    ..ShadingSettings::default()
                },
                mapping: MappingSettings::default(),
                samples: 64,
            },
            display: DisplaySettings {
                exposure_ev: self.exposure_ev,
                ..DisplaySettings::default()
            },
            size: None,
            warnings: Vec::new(),
        }
    }
}

/// A camera with z up; `vfov_deg` is the vertical field of view.
pub fn camera(eye: [f64; 3], target: [f64; 3], vfov_deg: f64) -> Camera {
    Camera {
        eye: DVec3::from(eye),
        target: DVec3::from(target),
        up: DVec3::Z,
        vfov: vfov_deg.to_radians(),
    }
}

/// Light from all sides: the sky's share.
pub fn ambient(color: [f32; 3], radiance: f32) -> Light {
    light("Sky", LightKind::Ambient, color, radiance)
}

/// Parallel light that travels along `direction`; `irradiance` on a facing surface.
pub fn sun(direction: [f64; 3], color: [f32; 3], irradiance: f32) -> Light {
    let direction = DVec3::from(direction);
    light(
        "Sun",
        LightKind::Directional { direction },
        color,
        irradiance,
    )
}

/// A small light that fades with the square of the distance; `intensity` is the irradiance at 1 m.
pub fn lamp(name: &str, position: [f64; 3], color: [f32; 3], intensity: f32) -> Light {
    let kind = LightKind::Point {
        position: DVec3::from(position),
        falloff: Falloff::InverseSquare,
    };
    light(name, kind, color, intensity)
}

fn light(name: &str, kind: LightKind, color: [f32; 3], intensity: f32) -> Light {
    Light {
        color: LinearRgb::from(color),
        ..Light::new(name, kind, intensity)
    }
}

/// A sky: `top` overhead, `bottom` underfoot, half of each at the horizon.
pub fn sky(top: [f32; 3], bottom: [f32; 3]) -> Background {
    Background {
        top: LinearRgb::from(top),
        bottom: LinearRgb::from(bottom),
    }
}

/// A flat floor at z = 0, `half` metres to every side of the origin.
pub fn floor(half: f64, tile: f64, material: u16) -> WorldMesh {
    let corner = DVec3::new(-half, -half, 0.0);
    let edges = [DVec3::X * (2.0 * half), DVec3::Y * (2.0 * half)];
    super::super::meshes::quad(corner, edges, tile, material)
}
