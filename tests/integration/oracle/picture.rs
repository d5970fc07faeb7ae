//! A whole picture by the report: camera, hit and light, 2.1–2.14 in a row.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use reliefscope::geometry::Normalization;
use reliefscope::geometry::bvh::Bvh;
use reliefscope::math::LinearRgb;
use reliefscope::measure::report_equations as report;
use reliefscope::render::{Picture, Progressive, Snapshot};
use reliefscope::scene::{
    Background, Camera, ModelFacts, RenderSettings, Scene, SceneSource, ShadingModel,
    ShadingSettings,
};
use reliefscope::shading::{Falloff, Light, LightKind, Material};
use reliefscope::surface::mapping::MappingSettings;

use super::{Random, RandomDirections, one_triangle, rounded};

const SIZE: [u32; 2] = [24, 16];

fn random_color(random: &mut Random) -> LinearRgb {
    let mut channel = || random.between(0.0, 1.0) as f32;
    LinearRgb::new(channel(), channel(), channel())
}

fn random_light(random: &mut Random, kind: LightKind) -> Light {
    Light {
        color: random_color(random),
        ..Light::new("light", kind, random.between(0.5, 2.0) as f32)
    }
}

/// A matt or glossy triangle under one light of each kind, seen from its front.
fn random_settings(random: &mut Random, corners: [DVec3; 3]) -> RenderSettings {
    let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    let normal = report::face_normal(&corners).normalize();
    let eye = middle + random.direction_above(normal, 0.3) * random.between(1.5, 3.0);
    let position = middle + random.direction() * random.between(0.5, 2.0);
    let lights = [
        LightKind::Ambient,
        LightKind::Directional {
            direction: -random.direction() * 3.0,
        },
        LightKind::Point {
            position,
            falloff: Falloff::None,
        },
        LightKind::Point {
            position: middle + random.direction_above(normal, 0.2),
            falloff: Falloff::InverseSquare,
        },
    ];
    RenderSettings {
        camera: Camera {
            eye,
            target: middle,
            up: random.direction(),
            vfov: random.between(0.3, 0.9),
        },
        lights: lights.map(|kind| random_light(random, kind)).to_vec(),
        materials: vec![Material {
            ks: random_color(random),
            shininess: random.between(0.0, 60.0) as f32,
            ..Material::matte("all", random_color(random))
        }],
        shading: ShadingSettings {
            model: ShadingModel::Report,
            background: Background::plain(LinearRgb::BLACK),
            ..ShadingSettings::default()
        },
        mapping: MappingSettings::default(),
        samples: 1,
    }
}

fn rendered(corners: [DVec3; 3], settings: &RenderSettings) -> Picture {
    let mesh = one_triangle(corners, [DVec2::ZERO; 3]);
    let scene = Scene {
        displaced: Default::default(),
        tangents: Default::default(),
        uv_charts: Default::default(),
        name: "one triangle".to_owned(),
        source: SceneSource::BuiltIn("one triangle".to_owned()),
        bvh: Bvh::build(&mesh),
        mesh,
        normalization: Normalization::IDENTITY,
        images: Vec::new(),
        facts: ModelFacts::default(),
    };
    let mut renderer = Progressive::new(1).expect("the system gives a thread");
    renderer.start(Snapshot {
        scene: Arc::new(scene),
        settings: Arc::new(settings.clone()),
        size: SIZE,
    });
    while !renderer.is_converged() {
        renderer.pass(&|| false);
    }
    renderer.picture()
}

/// One channel of the centre of pixel (x, y) by the report; `None` where the ray passes within a
/// thousandth of an edge.
fn reported(
    corners: [DVec3; 3],
    settings: &RenderSettings,
    [x, y]: [u32; 2],
    channel: usize,
) -> Option<f64> {
    let camera = &settings.camera;
    let forward = (camera.target - camera.eye).normalize();
    let right = forward.cross(camera.up).normalize();
    let viewport = report::Viewport::from_vfov(camera.vfov, SIZE[0], SIZE[1]);
    let canvas = viewport.canvas_from_picture(f64::from(x) + 0.5, f64::from(y) + 0.5);
    let axes = [right, right.cross(forward), forward];
    let dir = report::ray_direction(viewport.window_from_canvas(canvas), axes);
    let normal = report::face_normal(&corners);
    let t = report::plane_parameter(camera.eye, dir, corners[0], normal)?;
    let p = report::point_on_ray(camera.eye, dir, t);
    let weights = report::barycentrics(p, corners)?;
    if weights.iter().any(|w| w.abs() < 1e-3) {
        return None;
    }
    if report::intersect_convex(camera.eye, dir, &corners).is_none() {
        return Some(0.0);
    }
    let pick = |c: LinearRgb| f64::from(c.to_array()[channel]);
    let material = &settings.materials[0];
    let surface = report::ReportSurface {
        normal: normal.normalize(),
        view: -dir,
        k_d: pick(material.kd),
        k_s: pick(material.ks),
        shininess: f64::from(material.shininess),
    };
    let mut ambient = 0.0;
    let mut lights = Vec::new();
    for light in &settings.lights {
        let emitted = pick(light.emitted());
        let (intensity, direction) = match light.kind {
            LightKind::Ambient => {
                ambient += emitted;
                continue;
            }
            LightKind::Directional { direction } => (emitted, -direction),
            LightKind::Point {
                position,
                falloff: Falloff::None,
            } => (emitted, position - p),
            LightKind::Point { position, .. } => {
                (emitted / position.distance_squared(p), position - p)
            }
        };
        lights.push(report::ReportLight {
            intensity,
            direction,
            visible: true,
        });
    }
    Some(report::full_light(&surface, ambient, &lights))
}

#[test]
fn a_lit_triangle_is_the_reports_picture() {
    let mut random = Random::new(7);
    let (mut lit, mut black) = (0, 0);
    for case in 0..40 {
        let corners = [(); 3].map(|()| rounded(random.cube()));
        if report::face_normal(&corners).length() < 0.5 {
            continue;
        }
        let settings = random_settings(&mut random, corners);
        let picture = rendered(corners, &settings);
        for (y, x) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (y, x))) {
            let found = picture.at(x, y).to_array();
            for (channel, &found) in found.iter().enumerate() {
                let Some(expected) = reported(corners, &settings, [x, y], channel) else {
                    continue;
                };
                let tolerance = 1e-4 * (1.0 + expected);
                assert!(
                    (f64::from(found) - expected).abs() < tolerance,
                    "case {case}, pixel {x} {y}: {found} is not {expected}"
                );
                if expected > 0.0 { lit += 1 } else { black += 1 }
            }
        }
    }
    assert!(lit > 5_000 && black > 5_000, "{lit} lit, {black} black");
}
