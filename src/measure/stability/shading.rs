//! Highlights of any exponent, lights in impossible places, mirrors that face each other.

use glam::{DVec3, Vec3};

use super::board::{Album, Board, bumps, plane, tilts};
use super::{Finding, Plan, Test};
use crate::math::{LinearRgb, V3};
use crate::measure::report_equations as report;
use crate::scene::ShadingModel;
use crate::scene::built_in::meshes::WorldMesh;
use crate::shading::{Falloff, Light, LightKind, phong_lobe, reflect};
use crate::surface::mapping::Method;

/// Exponents in pictures; files may say any.
const EXPONENTS: [f32; 9] = [0.0, 1e-3, 1.0, 1e3, 1e4, 1e5, 1e6, 1e7, f32::MAX];
/// Exponents against `f64`; beyond 10⁶ a direction's own rounding is wider than the highlight.
const MEASURED: [f64; 6] = [1.0, 1e2, 1e4, 1e5, 1e6, 1e7];
/// Share of the highlight's peak.
const LOBE_BAR: f64 = 0.01;
/// Bounces between mirrors.
const BOUNCES: [u32; 5] = [0, 1, 8, 64, 512];

/// Lines for exponents, lights and mirrors.
pub(super) fn tests(_plan: &Plan) -> Vec<Test> {
    let mut all = Vec::new();
    for exponent in EXPONENTS {
        let name = format!("exponent {exponent:e}");
        all.push(Test::new("shading", name, move |plan| {
            glossy(plan, exponent)
        }));
    }
    for exponent in MEASURED {
        let name = format!("highlight against f64, exponent {exponent:e}");
        all.push(Test::new("shading", name.clone(), move |plan| {
            lobe(plan, &name, exponent)
        }));
    }
    for (name, position) in places() {
        all.push(Test::new("shading", format!("lamp {name}"), move |plan| {
            lamp(plan, position)
        }));
    }
    all.push(Test::new("shading", "lights of intensity 0", dark));
    for bounces in BOUNCES {
        let name = format!("parallel mirrors, {bounces} bounces");
        all.push(Test::new("shading", name, move |plan| {
            mirrors(plan, bounces)
        }));
    }
    all
}

fn board() -> Board {
    let mut board = Board::new(bumps(64), tilts(64));
    board.seen_at(50.0);
    board.mapped(Method::Bump, 0.1);
    board
}

fn glossy(plan: &Plan, exponent: f32) -> Finding {
    let mut album = Album::default();
    for model in ShadingModel::ALL {
        for method in [Method::None, Method::Normal, Method::Exact] {
            let mut board = board();
            board.mapped(method, 0.1);
            board.settings.shading.model = model;
            board.settings.materials[0].shininess = exponent;
            album.add(&board, plan.effort.pick(16, 48, 256));
        }
    }
    album.finding()
}

/// The lobe of single precision against the power in double, for directions as single precision has them.
fn lobe(plan: &Plan, name: &str, exponent: f64) -> Finding {
    let mut random = plan.random(name);
    let (mut cases, mut worst) = (0, 0.0_f64);
    for _ in 0..plan.effort.pick(2_000, 100_000, 4_000_000) {
        let unit = |v: DVec3| v.normalize_or(DVec3::Z).as_vec3();
        let normal = unit(random.direction());
        let light = unit(random.direction() + normal.as_dvec3() * 1.2);
        let mirrored = report::reflect(normal.as_dvec3(), light.as_dvec3());
        let spread = (2.0 / (exponent + 1.0)).sqrt();
        let view = unit(mirrored + random.cube() * spread);
        let reflected = reflect(V3::from(normal), V3::from(light));
        let found = phong_lobe(reflected, V3::from(view), exponent as f32).0;
        // The angle between rounded directions, without the rounding of their lengths.
        let (r, v) = (Vec3::from(reflected).as_dvec3(), view.as_dvec3());
        let cos = r.dot(v) / (r.length() * v.length());
        worst = worst.max((f64::from(found) - cos.max(0.0).powf(exponent)).abs());
        cases += 1;
    }
    let bar = (exponent <= 1e6).then_some(LOBE_BAR);
    Finding::worst_of(cases, "of the peak", worst, bar)
}

/// Where lamps should not be.
fn places() -> [(&'static str, DVec3); 9] {
    let mut seen = board();
    seen.seen_at(50.0);
    let camera = seen.settings.camera;
    [
        ("just over the surface", DVec3::new(0.1, 0.05, 1e-12)),
        ("in the surface", camera.target),
        ("in a corner", DVec3::new(20.0, 20.0, 0.0)),
        ("just under the surface", DVec3::new(0.1, 0.05, -1e-12)),
        ("behind the surface", DVec3::new(0.1, 0.05, -1.0)),
        ("at the eye", camera.eye),
        ("behind the eye", camera.eye * 2.0),
        ("1e20 away", DVec3::new(1e20, 2e20, 3e20)),
        ("1e300 away", DVec3::new(1e300, 2e300, 3e300)),
    ]
}

fn lamp(plan: &Plan, position: DVec3) -> Finding {
    let mut album = Album::default();
    for falloff in [Falloff::None, Falloff::InverseSquare] {
        for intensity in [-1.0, 1e-40, 1.0, 1e20, f32::MAX] {
            let mut board = board();
            let kind = LightKind::Point { position, falloff };
            board.settings.lights = vec![Light::new("lamp", kind, intensity)];
            album.add(&board, plan.effort.pick(16, 48, 256));
        }
    }
    album.finding()
}

/// Shadow rays to lights that send nothing.
fn dark(plan: &Plan) -> Finding {
    let (mut pixels, mut rays) = (0, 0);
    for intensity in [0.0, -0.0, -1.0] {
        let mut board = board();
        for light in &mut board.settings.lights {
            light.intensity = intensity;
        }
        let rendered = board.render(plan.effort.pick(16, 64, 256));
        pixels += rendered.picture.pixels.len() as u64;
        rays += rendered.counters.shadow_rays;
    }
    Finding::none_of(pixels, "shadow rays", rays)
}

/// Two planes that face each other and reflect all.
fn mirrors(plan: &Plan, bounces: u32) -> Finding {
    let board = board();
    let mut mesh: WorldMesh = plane();
    let mut above = plane();
    for vertex in &mut above.vertices {
        vertex.position.z = 4.0;
        vertex.normal = -vertex.normal;
    }
    for corners in &mut above.indices {
        corners.swap(1, 2);
    }
    mesh.append(above);
    let mut board = board.on(&mesh);
    let material = &mut board.settings.materials[0];
    (material.reflectivity, material.kd) = (1.0, LinearRgb::WHITE);
    board.settings.shading.max_bounces = bounces;
    let mut album = Album::default();
    let mut too_many = 0;
    for method in [Method::None, Method::Normal, Method::Exact] {
        board.mapped(method, 0.05);
        let rendered = album.add(&board, plan.effort.pick(8, 32, 128));
        let most = rendered.picture.pixels.len() as u64 * u64::from(bounces);
        too_many += rendered.counters.mirror_rays.saturating_sub(most);
    }
    let finding = album.finding();
    Finding {
        figure: finding.figure + too_many as f64,
        ..finding
    }
}
