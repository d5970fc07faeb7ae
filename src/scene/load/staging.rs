//! Camera, lights and background that a model starts with when nothing else says.

use glam::DVec3;

use crate::geometry::{Normalization, TriangleMesh};
use crate::math::LinearRgb;
use crate::scene::{Background, Camera, RenderSettings, ShadingSettings};
use crate::shading::{Light, LightKind, Material};
use crate::surface::mapping::MappingSettings;

/// Vertical field of view, radians: 40°, a short portrait lens.
const VFOV: f64 = 0.698_131_700_797_731_8;

/// Thickness over width below which a model counts as flat, like a wall or a floor.
const FLAT: f64 = 0.02;

/// Samples before a picture counts as converged.
const SAMPLES: u32 = 16;

/// Settings that show all of a model well, whose world box is `bounds`: three-quarter view with y up (the face of a flat model), a key
/// light from the upper left of the camera, a weak fill from the right, some ambient light.
pub(super) fn staged(
    mesh: &TriangleMesh,
    bounds: [DVec3; 2],
    materials: Vec<Material>,
) -> RenderSettings {
    let camera = camera(mesh, bounds);
    RenderSettings {
        lights: lights(&camera),
        camera,
        materials,
        shading: ShadingSettings {
            background: Background {
                top: LinearRgb::new(0.05, 0.07, 0.10),
                bottom: LinearRgb::new(0.16, 0.17, 0.18),
            },
            ..ShadingSettings::default()
        },
        mapping: MappingSettings::default(),
        samples: SAMPLES,
    }
}

fn camera(mesh: &TriangleMesh, [min, max]: [DVec3; 2]) -> Camera {
    let extent = max - min;
    let flat = extent.min_element() < FLAT * extent.max_element();
    let axis = extent.min_position();
    let side = || facing(mesh, axis);
    let from = match (flat, axis) {
        (false, _) => DVec3::new(0.6, 0.45, 1.0),
        (true, 0) => DVec3::new(side(), 0.25, 0.35),
        (true, 1) => DVec3::new(0.35, 0.9 * side(), 0.9),
        (true, _) => DVec3::new(0.35, 0.25, side()),
    };
    // Framed at unit size: squares of extreme coordinates would overflow or vanish.
    let unit = Normalization::fit(min, max);
    let half = if extent == DVec3::ZERO {
        DVec3::splat(0.5)
    } else {
        extent * 0.5 * unit.scale
    };
    let framed = Camera::framing(-half, half, from, DVec3::Y, VFOV);
    let moved = Camera {
        eye: framed.eye / unit.scale + unit.center,
        target: unit.center,
        ..framed
    };
    if moved.eye.is_finite() && moved.distance() > 0.0 {
        moved
    } else {
        framed
    }
}

/// The side of an axis (+1 or −1) that most of the mesh faces; a balanced mesh shows its positive side.
fn facing(mesh: &TriangleMesh, axis: usize) -> f64 {
    let sum: f64 = (0..mesh.len() as u32)
        .map(|prim| {
            let [a, b, c] = mesh.corners(prim).map(|p| p.as_dvec3());
            (b - a).cross(c - a)[axis]
        })
        .sum();
    if sum < -1e-9 { -1.0 } else { 1.0 }
}

fn lights(camera: &Camera) -> Vec<Light> {
    let axes = camera.axes();
    let shining = |right: f64, up: f64, back: f64| LightKind::Directional {
        direction: (axes.forward * back - axes.right * right - axes.up * up)
            .normalize_or(DVec3::NEG_Y),
    };
    let mut key = Light::new("Key", shining(-0.7, 0.8, 0.6), 2.2);
    key.color = LinearRgb::new(1.0, 0.97, 0.92);
    let mut fill = Light::new("Fill", shining(0.9, 0.2, 0.5), 0.5);
    fill.color = LinearRgb::new(0.85, 0.92, 1.0);
    vec![Light::new("Ambient", LightKind::Ambient, 0.25), key, fill]
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn quad(corners: [[f32; 3]; 4]) -> TriangleMesh {
        TriangleMesh {
            positions: corners.map(Vec3::from).to_vec(),
            indices: vec![[0, 1, 2], [0, 2, 3]],
            ..TriangleMesh::default()
        }
    }

    fn world(mesh: &TriangleMesh) -> [DVec3; 2] {
        let bounds = mesh.bounds();
        [bounds.min.as_dvec3(), bounds.max.as_dvec3()]
    }

    #[test]
    fn a_flat_model_shows_its_front() {
        let wall = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]];
        for turn in 0..3 {
            for back in [false, true] {
                let mut corners = wall.map(|mut p: [f32; 3]| {
                    p.rotate_right(turn);
                    p
                });
                if back {
                    corners.reverse();
                }
                let mesh = quad(corners);
                let camera = camera(&mesh, world(&mesh));
                let [a, b, c] = mesh.corners(0);
                let normal = (b - a).cross(c - a).as_dvec3();
                let cosine = normal.dot((camera.eye - camera.target).normalize());
                assert!(cosine > 0.6, "turn {turn}, back {back}: {cosine}");
            }
        }
    }

    #[test]
    fn the_key_light_comes_from_the_upper_left() {
        let mesh = quad([[0., 0., 0.], [1., 0., 0.], [1., 1., 1.], [0., 1., 1.]]);
        let settings = staged(&mesh, world(&mesh), Vec::new());
        let axes = settings.camera.axes();
        let LightKind::Directional { direction } = settings.lights[1].kind else {
            panic!("the key light is directional");
        };
        assert!(direction.dot(axes.right) > 0.0 && direction.dot(axes.up) < 0.0);
        assert!(direction.dot(axes.forward) > 0.0);
    }
}
