//! Highlights that widen where a pixel covers slopes that differ.

use glam::{DVec3, Vec3};
use reliefscope::math::{LinearRgb, V3};
use reliefscope::render::{Picture, Snapshot, probe};
use reliefscope::scene::{ShadingModel, TextureFilter};
use reliefscope::shading::{Light, LightKind, phong_lobe, widened_exponent};
use reliefscope::surface::mapping::Method;
use reliefscope::texture::{MapRole, NormalSpace, RawImage, Samples};

use crate::support::{QuadScene, bits, edited, heights, picture};

const SIDE: u32 = 64;
/// Waves across the map.
const WAVES: f32 = 16.0;
/// Largest slope of the relief.
const STEEP: f32 = 0.25;

/// Slopes of the relief at a texel's centre.
fn slopes(x: u32, y: u32) -> [f32; 2] {
    let at = |i: u32| {
        let turn = std::f32::consts::TAU * WAVES / SIDE as f32;
        STEEP * ((i as f32 + 0.5) * turn).cos()
    };
    [at(x), -at(y)]
}

fn float_map(color: impl Fn([f32; 2]) -> Vec3) -> RawImage {
    let places = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y)));
    let samples = places.flat_map(|(x, y)| (color(slopes(x, y)) * 0.5 + 0.5).to_array());
    RawImage {
        width: SIDE,
        height: SIDE,
        channels: 3,
        samples: Samples::F32(samples.collect()),
    }
}

/// A glossy floor with waves far finer than a pixel, a highlight in its middle.
fn far_floor(method: Method, space: NormalSpace) -> Snapshot {
    let turn = std::f32::consts::TAU * WAVES;
    // One tile is one unit wide, so that slopes are amplitude times derivative.
    let amplitude = 0.05;
    let depth = STEEP / turn / amplitude;
    let waves = move |s: f32, t: f32| 0.5 + depth * ((s * turn).sin() + (t * turn).sin());
    let mut scene = QuadScene::new()
        .with_map(MapRole::Height, heights(SIDE, SIDE, waves))
        .with_map(
            MapRole::Normal,
            float_map(|[x, y]| Vec3::new(-x, -y, 1.0).normalize_or_zero()),
        )
        .with_map(MapRole::Slope, float_map(|[x, y]| Vec3::new(x, y, 0.0)));
    scene.uv = |p| p;
    let settings = &mut scene.settings;
    settings.materials[0].maps[1].space = space;
    settings.materials[0].kd = LinearRgb::BLACK;
    settings.materials[0].ks = LinearRgb::WHITE;
    settings.materials[0].shininess = 60.0;
    settings.camera.eye = DVec3::new(0.0, -12.0, 12.0);
    settings.camera.vfov = 9_f64.to_radians();
    let sun = LightKind::Directional {
        direction: DVec3::new(0.1, -1.0, -1.1),
    };
    settings.lights = vec![Light::new("sun", sun, 1.0)];
    settings.mapping.method = method;
    scene.size = [24, 24];
    scene.snapshot()
}

fn film(snapshot: &Snapshot, filter: TextureFilter, antialiasing: bool, samples: u32) -> Picture {
    picture(&edited(snapshot, |s| {
        s.shading.filter = filter;
        s.shading.specular_antialiasing = antialiasing;
        s.samples = samples;
    }))
}

fn rmse(a: &Picture, b: &Picture) -> f64 {
    let squares = a.pixels.iter().zip(&b.pixels);
    let sum: f64 = squares.map(|(x, y)| f64::from(x.g - y.g).powi(2)).sum();
    (sum / a.pixels.len() as f64).sqrt()
}

#[test]
fn one_sample_shows_the_highlight_of_many() {
    for (method, space) in [
        (Method::Bump, NormalSpace::Tangent),
        (Method::Slope, NormalSpace::Tangent),
        (Method::Normal, NormalSpace::Tangent),
        (Method::Normal, NormalSpace::MikkTSpace),
        (Method::Normal, NormalSpace::Object),
    ] {
        for model in ShadingModel::ALL {
            let snapshot = edited(&far_floor(method, space), |s| s.shading.model = model);
            let truth = film(&snapshot, TextureFilter::Bilinear, false, 256);
            let errors = [
                film(&snapshot, TextureFilter::Bilinear, false, 1),
                film(&snapshot, TextureFilter::Mip, false, 1),
                film(&snapshot, TextureFilter::Mip, true, 1),
            ]
            .map(|shown| rmse(&shown, &truth));
            let [points, means, widened] = errors;
            let name = format!("{}, {}, {}", method.name(), space.name(), model.name());
            eprintln!("{name}: points {points:.4}, means {means:.4}, widened {widened:.4}");
            assert!(
                widened < 0.35 * means && widened < 0.35 * points,
                "{name}: {errors:?}"
            );
        }
    }
}

#[test]
fn without_variance_nothing_changes_to_the_bit() {
    // Near, where a cone covers less than a texel.
    let mut near = far_floor(Method::Bump, NormalSpace::Tangent);
    near = edited(&near, |s| {
        s.camera.eye = DVec3::new(0.0, -0.06, 0.06);
        s.camera.target = DVec3::new(0.0, 0.01, 0.0);
    });
    for method in [Method::None, Method::Bump, Method::Slope, Method::Normal] {
        for model in ShadingModel::ALL {
            let near = edited(&near, |s| {
                s.mapping.method = method;
                s.shading.model = model;
            });
            let plain = film(&near, TextureFilter::Bilinear, false, 1);
            let widened = film(&near, TextureFilter::Mip, true, 1);
            assert_eq!(bits(&plain), bits(&widened), "{}", method.name());
        }
    }
}

#[test]
fn the_probe_tells_the_same_bits() {
    for method in [Method::Bump, Method::Slope, Method::Normal] {
        let snapshot = edited(&far_floor(method, NormalSpace::Tangent), |s| {
            s.shading.filter = TextureFilter::Mip;
            s.shading.specular_antialiasing = true;
            s.samples = 1;
        });
        let film = bits(&picture(&snapshot));
        for (x, y) in (0..24)
            .step_by(5)
            .flat_map(|y| (0..24).step_by(5).map(move |x| (x, y)))
        {
            let story = probe(&snapshot, [x, y]).expect("inside");
            let told = story.color.to_array().map(f32::to_bits);
            assert_eq!(
                film[(y * 24 + x) as usize],
                told,
                "{} at {x}, {y}",
                method.name()
            );
            // The lights of the story add up to its colour: they know of the widening, too.
            let lights = story.bounces[0].hit.iter().flat_map(|hit| &hit.lights);
            let sum: f32 = lights.map(|light| light.specular.g).sum();
            assert!((sum - story.color.g).abs() <= 1e-5 * (1.0 + sum), "{sum}");
        }
    }
}

/// A lobe over normals whose slopes are spread by chance, added up, against one widened lobe.
#[test]
fn a_widened_lobe_is_the_mean_of_lobes() {
    for (exponent, deviation) in [(20.0_f32, 0.05_f32), (100.0, 0.05), (400.0, 0.03)] {
        // Slopes on a grid of equal shares of a normal distribution (Box–Muller).
        let count = 60;
        let share = |i: u32| (i as f32 + 0.5) / count as f32;
        let mut normals = Vec::new();
        for (i, j) in (0..count).flat_map(|i| (0..count).map(move |j| (i, j))) {
            let radius = deviation * (-2.0 * share(i).ln()).sqrt();
            let (sin, cos) = (share(j) * std::f32::consts::TAU).sin_cos();
            normals.push(Vec3::new(radius * cos, radius * sin, 1.0).normalize_or_zero());
        }
        let wide = widened_exponent(exponent, deviation * deviation);
        for tilt in [0.0_f32, 0.5, 1.0] {
            // Off the middle by a part of the lobe's own width.
            let angle = tilt * (2.0 / wide).sqrt();
            let wo = Vec3::new(angle.sin(), 0.0, angle.cos());
            let lobe = |n: Vec3, exponent: f32| {
                let r = n * (2.0 * n.z) - Vec3::Z;
                phong_lobe(V3::from(r), wo.into(), exponent).0
            };
            let mean =
                normals.iter().map(|n| lobe(*n, exponent)).sum::<f32>() / normals.len() as f32;
            // With the energy of the narrow one.
            let found = lobe(Vec3::Z, wide) * (wide + 1.0) / (exponent + 1.0);
            assert!(
                (found - mean).abs() < 0.12 * mean,
                "{exponent}, {deviation}, {tilt}: {found}, not {mean}"
            );
        }
    }
}

#[test]
fn moments_are_made_only_for_glossy_maps_that_ask() {
    let snapshot = far_floor(Method::Bump, NormalSpace::Tangent);
    let bytes = |s: &Snapshot| -> usize { s.scene.images.iter().map(|i| i.filter_bytes()).sum() };
    let _ = film(&snapshot, TextureFilter::Bilinear, true, 1);
    assert_eq!(
        bytes(&snapshot),
        0,
        "without mip maps there is nothing to widen by"
    );
    let texels = 32 * 32 + 16 * 16 + 8 * 8 + 4 * 4 + 2 * 2 + 1;
    let matte = edited(&snapshot, |s| s.materials[0].ks = LinearRgb::BLACK);
    let _ = film(&matte, TextureFilter::Mip, true, 1);
    assert_eq!(bytes(&snapshot), texels * 4);
    let _ = film(&snapshot, TextureFilter::Mip, true, 1);
    assert_eq!(bytes(&snapshot), texels * (4 + 20));
}
