//! A wavy square of as many triangles as wanted: what changes between two sizes is the number of triangles alone.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};

use crate::geometry::bvh::Bvh;
use crate::geometry::{Normalization, TriangleAttributes, TriangleMesh};
use crate::math::{LinearRgb, normalize_or};
use crate::render::Snapshot;
use crate::scene::{Camera, ModelFacts, RenderSettings, Scene, SceneSource, ShadingSettings};
use crate::shading::{Falloff, Light, LightKind, Material};
use crate::surface::mapping::{MappingSettings, Method};

/// Height of the waves over the square, whose side is 2.
const WAVE_HEIGHT: f32 = 0.05;
/// Waves along a side.
const WAVES: f32 = 4.0;

/// The mesh: `n` × `n` cells of two triangles each, at least one cell.
pub(super) fn grid_mesh(n: u32) -> TriangleMesh {
    let n = n.max(1);
    let side = n as usize + 1;
    let mut mesh = TriangleMesh::default();
    mesh.positions.reserve_exact(side * side);
    mesh.normals.reserve_exact(side * side);
    mesh.uvs.reserve_exact(side * side);
    for y in 0..=n {
        for x in 0..=n {
            let uv = Vec2::new(x as f32, y as f32) / n as f32;
            let (phase, k) = (uv * WAVES * TAU, WAVE_HEIGHT * WAVES * TAU * 0.5);
            let slope = [
                k * phase.x.cos() * phase.y.sin(),
                k * phase.x.sin() * phase.y.cos(),
            ];
            let height = WAVE_HEIGHT * phase.x.sin() * phase.y.sin();
            mesh.positions.push((uv * 2.0 - Vec2::ONE).extend(height));
            let normal = Vec3::new(-slope[0], -slope[1], 1.0);
            mesh.normals.push(normalize_or(normal, Vec3::Z));
            mesh.uvs.push(uv);
        }
    }
    let triangles = 2 * n as usize * n as usize;
    mesh.indices.reserve_exact(triangles);
    for y in 0..n {
        for x in 0..n {
            let corner = y * (n + 1) + x;
            let [a, b, c, d] = [corner, corner + 1, corner + n + 2, corner + n + 1];
            mesh.indices.extend([[a, b, c], [a, c, d]]);
        }
    }
    let attributes = TriangleAttributes {
        material: 0,
        has_uv: true,
        smooth: true,
    };
    mesh.attributes = vec![attributes; triangles];
    mesh
}

/// The grid of `n` × `n` cells seen at 45°, glossy, lit by a lamp and a sun that both cast shadows.
#[must_use]
pub fn grid_scene(n: u32, size: [u32; 2]) -> Snapshot {
    let mesh = grid_mesh(n);
    let bvh = Bvh::build(&mesh);
    grid_snapshot(mesh, bvh, size)
}

/// [`grid_scene`] from its parts.
pub(super) fn grid_snapshot(mesh: TriangleMesh, bvh: Bvh, size: [u32; 2]) -> Snapshot {
    let scene = Scene {
        name: "grid".to_owned(),
        source: SceneSource::BuiltIn("grid".to_owned()),
        mesh,
        bvh,
        normalization: Normalization::IDENTITY,
        images: Vec::new(),
        displaced: crate::surface::displaced::DisplacementCell::default(),
        tangents: crate::geometry::TangentCell::default(),
        uv_charts: crate::geometry::UvChartCell::default(),
        facts: ModelFacts::default(),
    };
    let mut material = Material::matte("grid", LinearRgb::new(0.6, 0.6, 0.6));
    material.ks = LinearRgb::new(0.3, 0.3, 0.3);
    material.shininess = 40.0;
    let sun = LightKind::Directional {
        direction: DVec3::new(-0.5, 0.3, -0.8),
    };
    let settings = RenderSettings {
        camera: Camera {
            eye: DVec3::new(0.0, -2.0, 2.0),
            target: DVec3::ZERO,
            up: DVec3::Z,
            vfov: 40_f64.to_radians(),
        },
        lights: vec![lamp(0, 1), Light::new("sun", sun, 1.0)],
        materials: vec![material],
        shading: ShadingSettings::default(),
        mapping: MappingSettings {
            method: Method::None,
            ..MappingSettings::default()
        },
        samples: 1,
    };
    Snapshot {
        scene: Arc::new(scene),
        settings: Arc::new(settings),
        size,
    }
}

/// One of `count` lamps in a circle above the square.
pub(super) fn lamp(index: u32, count: u32) -> Light {
    let angle = std::f64::consts::TAU * f64::from(index) / f64::from(count.max(1));
    let kind = LightKind::Point {
        position: DVec3::new(angle.cos(), angle.sin(), 1.0),
        falloff: Falloff::InverseSquare,
    };
    Light::new(format!("lamp {index}"), kind, 2.0 / count.max(1) as f32)
}
