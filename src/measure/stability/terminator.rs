//! Where light ends on coarse meshes with smooth normals: no steps along the facets with the smooth terminator on, and
//! no light where there is none.

use std::sync::Arc;

use glam::DVec3;

use super::convex::{at_level, differing};
use super::placement::Placement;
use super::trees::levels;
use super::{Finding, Plan, Test, bodies};
use crate::math::LinearRgb;
use crate::render::{Picture, PixelRecord, Progressive, Recording, Records, Snapshot};
use crate::scene::built_in::meshes::{Vertex, WorldMesh};
use crate::scene::{Background, Camera, RenderSettings, Scene, ShadingSettings};
use crate::shading::{Falloff, Light, LightKind, Material};
use crate::surface::mapping::{MappingSettings, Method};

/// Angles between the eye and the sun, degrees.
const SUNS: [f64; 5] = [30.0, 60.0, 90.0, 120.0, 150.0];
/// Quads along an edge of the cube that a coarse sphere is made of.
const COARSE: [i32; 3] = [2, 4, 16];
/// A pixel whose smooth normal has a smaller cosine with the sun may be lit or not.
const MARGIN: f64 = 1e-4;

/// Steps on spheres of all sizes; light in closed bodies; boxes.
pub(super) fn tests(_plan: &Plan) -> Vec<Test> {
    let mut all = Vec::new();
    let mut add = |n: i32, placement: Placement| {
        let name = format!("sphere of {} facets, {}", 12 * n * n, placement.name());
        all.push(Test::new("terminator", name, move |plan| {
            steps(plan, n, placement)
        }));
    };
    for n in COARSE {
        add(n, Placement::PLAIN);
    }
    // Farther away and not normalised, rounding bends facets by more than they are curved.
    let holds = |p: &Placement| *p != Placement::PLAIN && (p.normalize || p.offset == 0.0);
    for placement in Placement::extremes().into_iter().filter(holds) {
        add(4, placement);
    }
    for (what, eye) in [("in a closed sphere", 0.5), ("between two spheres", 1.5)] {
        let name = format!("light {what}, sun and lamp outside");
        all.push(Test::new("terminator", name, move |plan| {
            enclosed(plan, eye)
        }));
    }
    all.push(Test::new("terminator", "box of flat faces", flat_box));
    all
}

/// Pixels of a sphere that face the sun by their smooth normal and are dark, or differ at some level; under all suns.
fn steps(plan: &Plan, n: i32, placement: Placement) -> Finding {
    let scene = placement.scene(&bodies::sphere(n), true);
    let side = plan.effort.pick(24, 96, 384);
    let (mut pixels, mut wrong, mut without) = (0, 0, 0);
    let mut notes = Vec::new();
    for angle in SUNS {
        let (settings, to_sun) = under_sun(&placement, angle);
        let (picture, records) = look(&scene, &settings, side);
        let mut textbook = settings.clone();
        textbook.shading.smooth_terminator = false;
        let steps = dark(&look(&scene, &textbook, side).0, &records, to_sun);
        pixels += picture.pixels.len() as u64;
        wrong += dark(&picture, &records, to_sun);
        for level in levels() {
            let twin = look(&at_level(&scene, level), &settings, side).0;
            wrong += differing(&twin, &picture);
        }
        without += steps;
        notes.push(format!("{steps} at {angle}°"));
    }
    // Where nothing is dark without the remedy, nothing was tested.
    let cases = if without > 0 { pixels } else { 0 };
    let note = format!("without the smooth terminator {}", notes.join(", "));
    Finding::none_of(cases, "dark pixels that face the sun", wrong).with_note(note)
}

/// Settings with the smooth terminator on, under a sun at an angle to the eye; the unit direction to the sun.
fn under_sun(placement: &Placement, angle: f64) -> (RenderSettings, DVec3) {
    let eye = DVec3::new(0.5, -2.6, 0.8);
    let to_eye = eye / eye.length();
    let (sin, cos) = angle.to_radians().sin_cos();
    let to_sun = to_eye * cos + to_eye.any_orthonormal_vector() * sin;
    let sun = LightKind::Directional { direction: -to_sun };
    let camera = Camera {
        eye: placement.world(eye),
        target: placement.world(DVec3::ZERO),
        up: DVec3::Z,
        vfov: 45_f64.to_radians(),
    };
    let settings = settings(camera, vec![Light::new("sun", sun, 1.0)]);
    (settings, to_sun)
}

/// Pixels whose smooth normal faces the sun and that are dark.
fn dark(picture: &Picture, records: &Records, to_sun: DVec3) -> u64 {
    let pairs = picture.pixels.iter().zip(&records.pixels);
    let is_dark = |(color, record): &(&LinearRgb, &PixelRecord)| {
        let cos = record.smooth_normal.as_dvec3().dot(to_sun);
        record.material.is_some() && cos > MARGIN && !(color.g > 0.0)
    };
    pairs.filter(is_dark).count() as u64
}

/// Lit pixels inside of a closed coarse shell, where no light gets in.
fn enclosed(plan: &Plan, eye: f64) -> Finding {
    let mut mesh = bodies::sphere(4).mesh(true);
    if eye > 1.0 {
        let mut around = bodies::sphere(3).mesh(true);
        for vertex in &mut around.vertices {
            vertex.position *= 3.0;
        }
        mesh.append(around);
    }
    let scene = Placement::PLAIN.place(mesh, "shells");
    let lamp = LightKind::Point {
        position: DVec3::new(-3.5, 1.0, 2.5),
        falloff: Falloff::None,
    };
    let sun = LightKind::Directional {
        direction: DVec3::new(0.3, 0.9, -0.2),
    };
    let side = plan.effort.pick(24, 96, 384);
    let (mut lit, mut pixels) = (0, 0);
    for turn in 0..6 {
        let (sin, cos) = f64::from(turn).sin_cos();
        let eye = DVec3::new(cos, sin, 0.3) * eye;
        let camera = Camera {
            eye,
            target: DVec3::new(sin, -cos, -0.2) * 0.4,
            up: DVec3::Z,
            vfov: 80_f64.to_radians(),
        };
        let lights = vec![Light::new("sun", sun, 1.0), Light::new("lamp", lamp, 1.0)];
        let (picture, _) = look(&scene, &settings(camera, lights), side);
        lit += picture.pixels.iter().filter(|c| c.g > 0.0).count() as u64;
        pixels += picture.pixels.len() as u64;
    }
    Finding::none_of(pixels, "lit pixels", lit)
}

/// Pixels of a box, and of one in it, that the smooth terminator changes: its normals are those of its faces.
fn flat_box(plan: &Plan) -> Finding {
    let mut mesh = box_of(1.0);
    mesh.append(box_of(3.0));
    let scene = Placement::PLAIN.place(mesh, "shells");
    let lamp = LightKind::Point {
        position: DVec3::new(-1.9, -0.5, 2.1),
        falloff: Falloff::None,
    };
    let camera = Camera {
        eye: DVec3::new(2.5, -2.6, 1.8),
        target: DVec3::ZERO,
        up: DVec3::Z,
        vfov: 80_f64.to_radians(),
    };
    let smooth = settings(camera, vec![Light::new("lamp", lamp, 1.0)]);
    let mut textbook = smooth.clone();
    textbook.shading.smooth_terminator = false;
    let side = plan.effort.pick(24, 96, 384);
    let (with, without) = (
        look(&scene, &smooth, side).0,
        look(&scene, &textbook, side).0,
    );
    let dark = without.pixels.iter().filter(|c| !(c.g > 0.0)).count();
    // A picture without shadow and light tells nothing.
    let tells = (1..without.pixels.len()).contains(&dark);
    let cases = if tells { with.pixels.len() as u64 } else { 0 };
    let finding = Finding::none_of(cases, "pixels changed", differing(&with, &without));
    finding.with_note(format!("{dark} dark pixels"))
}

fn settings(camera: Camera, lights: Vec<Light>) -> RenderSettings {
    RenderSettings {
        camera,
        lights,
        materials: vec![Material::matte("clay", LinearRgb::new(0.7, 0.6, 0.5))],
        shading: ShadingSettings {
            background: Background::plain(LinearRgb::BLACK),
            smooth_terminator: true,
            ..ShadingSettings::default()
        },
        mapping: MappingSettings {
            method: Method::None,
            ..MappingSettings::default()
        },
        samples: 1,
    }
}

/// A square picture and what its pixels show; black if the system gives no thread.
fn look(scene: &Scene, settings: &RenderSettings, side: u32) -> (Picture, Records) {
    let Ok(mut renderer) = Progressive::new(1) else {
        return (Picture::black([side; 2]), Records::default());
    };
    renderer.record(Recording::Pixels);
    renderer.start(Snapshot {
        scene: Arc::new(scene.clone()),
        settings: Arc::new(settings.clone()),
        size: [side; 2],
    });
    renderer.pass(&|| false);
    (renderer.picture(), renderer.records().unwrap_or_default())
}

/// A box about the origin whose vertices have the normals of their faces.
fn box_of(half: f64) -> WorldMesh {
    let mut mesh = WorldMesh::default();
    for (k, side) in (0..3).flat_map(|k| [(k, 1.0), (k, -1.0)]) {
        let normal = DVec3::AXES[k] * side;
        let (across, up) = (DVec3::AXES[(k + 1) % 3], DVec3::AXES[(k + 2) % 3]);
        mesh.patch([3, 3], 0, |s, t| Vertex {
            position: (normal + across * (2.0 * s - 1.0) + up * (2.0 * t - 1.0)) * half,
            normal,
            uv: glam::DVec2::new(s, t),
        });
    }
    mesh
}
