//! A convex body in pictures: with shadows and without it looks the same to the bit, at every scale and offset.

use std::sync::Arc;

use glam::DVec3;

use super::placement::Placement;
use super::trees::levels;
use super::{Finding, Plan, Test, bodies};
use crate::geometry::simd::SimdLevel;
use crate::math::LinearRgb;
use crate::render::{Picture, Progressive, Snapshot};
use crate::scene::{Background, Camera, RenderSettings, Scene, ShadingSettings};
use crate::shading::{Falloff, Light, LightKind, Material};
use crate::surface::mapping::{MappingSettings, Method};

/// A line for each placement, flat and smooth.
pub(super) fn tests(_plan: &Plan) -> Vec<Test> {
    let mut all = Vec::new();
    // Farther away and not normalised, rounding leaves no convex body.
    let is_convex = |p: &Placement| p.normalize || p.offset <= 100.0;
    for placement in Placement::all().into_iter().filter(is_convex) {
        for smooth in [false, true] {
            let word = if smooth { "smooth" } else { "flat" };
            let name = format!("{word} sphere, {}", placement.name());
            all.push(Test::new("convex", name, move |plan| {
                shadowed(plan, placement, smooth)
            }));
        }
    }
    all
}

/// Pixels that shadows change, or a level.
fn shadowed(plan: &Plan, placement: Placement, smooth: bool) -> Finding {
    let scene = placement.scene(&bodies::sphere(16), smooth);
    let side = plan.effort.pick(16, 48, 192);
    let settings = settings(&placement);
    let lit = {
        let mut lit = settings.clone();
        lit.shading.shadows = false;
        render(&scene, lit, side)
    };
    let pixels = lit.pixels.len() as u64;
    let bright = lit.pixels.iter().filter(|c| c.g > 0.0).count();
    let mut wrong = 0;
    for level in levels() {
        let picture = render(&at_level(&scene, level), settings.clone(), side);
        wrong += differing(&picture, &lit);
    }
    let note = format!("{bright} lit pixels, {} levels", levels().len());
    // A black picture has no false shadow, and shows nothing.
    let cases = if bright * 8 > lit.pixels.len() {
        pixels
    } else {
        0
    };
    Finding::none_of(cases, "pixels changed", wrong).with_note(note)
}

/// A sun and a lamp, both grazing part of the body.
fn settings(placement: &Placement) -> RenderSettings {
    let lamp = LightKind::Point {
        position: placement.world(DVec3::new(-1.5, -1.0, 1.2)),
        falloff: Falloff::None,
    };
    let sun = LightKind::Directional {
        direction: DVec3::new(-0.6, 0.8, -0.3),
    };
    RenderSettings {
        camera: Camera {
            eye: placement.world(DVec3::new(0.5, -2.6, 0.8)),
            target: placement.world(DVec3::ZERO),
            up: DVec3::Z,
            vfov: 45_f64.to_radians(),
        },
        lights: vec![Light::new("lamp", lamp, 1.0), Light::new("sun", sun, 1.0)],
        materials: vec![Material::matte("clay", LinearRgb::new(0.7, 0.6, 0.5))],
        shading: ShadingSettings {
            background: Background::plain(LinearRgb::BLACK),
            ..ShadingSettings::default()
        },
        mapping: MappingSettings {
            method: Method::None,
            ..MappingSettings::default()
        },
        samples: 1,
    }
}

/// The same scene for other vector instructions.
pub(super) fn at_level(scene: &Scene, level: SimdLevel) -> Scene {
    let mut scene = scene.clone();
    // Only levels of this machine are asked for.
    if let Ok(bvh) = scene.bvh.clone().with_level(level) {
        scene.bvh = bvh;
    }
    scene
}

/// A square picture; black if the system gives no thread.
fn render(scene: &Scene, settings: RenderSettings, side: u32) -> Picture {
    let Ok(mut renderer) = Progressive::new(1) else {
        return Picture::black([side; 2]);
    };
    renderer.start(Snapshot {
        scene: Arc::new(scene.clone()),
        settings: Arc::new(settings),
        size: [side; 2],
    });
    renderer.pass(&|| false);
    renderer.picture()
}

/// Pixels whose bits differ.
pub(super) fn differing(a: &Picture, b: &Picture) -> u64 {
    let bits = |c: &LinearRgb| c.to_array().map(f32::to_bits);
    let pairs = a.pixels.iter().zip(&b.pixels);
    pairs.filter(|(a, b)| bits(a) != bits(b)).count() as u64
}
