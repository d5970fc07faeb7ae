//! Maps read as means over what a ray's cone covers.

use std::sync::Arc;

use glam::{DVec3, Vec2};
use reliefscope::geometry::simd::SimdLevel;
use reliefscope::math::LinearRgb;
use reliefscope::render::{Picture, Snapshot, probe};
use reliefscope::scene::{Background, TextureFilter};
use reliefscope::shading::{Light, LightKind};
use reliefscope::surface::mapping::{Derivative, Lookup, Method};
use reliefscope::texture::{MapRole, RawImage, Samples};

use crate::support::{QuadScene, bits, converged, edited, heights, picture, plain_float};

/// Squares of one texel, black and white.
fn checkerboard(side: u32) -> RawImage {
    let texels = (0..side).flat_map(|y| (0..side).map(move |x| (x + y) % 2));
    let samples = texels.flat_map(|white| [white as u8 * 255; 3]).collect();
    RawImage {
        width: side,
        height: side,
        channels: 3,
        samples: Samples::U8(samples),
    }
}

/// A piece of floor that fills the picture, so far away that a pixel covers many texels of a checkerboard.
fn far_floor(method: Method) -> Snapshot {
    let waves = |s: f32, t: f32| {
        let turn = std::f32::consts::TAU;
        0.5 + 0.25 * (s * 13.0 * turn).sin() + 0.25 * (t * 11.0 * turn).cos()
    };
    let normals = {
        let side = 64;
        let mut samples = Vec::new();
        for (x, y) in (0..side).flat_map(|y| (0..side).map(move |x| (x, y))) {
            let at = |i: u32, k: f32| (i as f32 * std::f32::consts::TAU * k / side as f32).sin();
            let n = glam::Vec3::new(0.6 * at(x, 13.0), 0.6 * at(y, 11.0), 1.0).normalize_or_zero();
            samples.extend(n.to_array().map(|c| 0.5 + 0.5 * c));
        }
        RawImage {
            width: side,
            height: side,
            channels: 3,
            samples: Samples::F32(samples),
        }
    };
    let mut scene = QuadScene::new()
        .with_map(MapRole::Albedo, checkerboard(64))
        .with_map(MapRole::Height, heights(64, 64, waves))
        .with_map(MapRole::Normal, normals.clone())
        .with_map(MapRole::Slope, normals);
    scene.uv = |p| p * 8.0;
    scene.settings.camera.eye = DVec3::new(0.6, -9.0, 4.0);
    scene.settings.camera.target = DVec3::new(0.6, -0.5, 0.0);
    scene.settings.camera.vfov = 2_f64.to_radians();
    scene.settings.shading.background = Background::plain(LinearRgb::gray(0.4));
    let sun = LightKind::Directional {
        direction: DVec3::new(0.5, 0.4, -0.8),
    };
    scene.settings.lights = vec![Light::new("sun", sun, 2.0)];
    scene.settings.mapping.method = method;
    scene.settings.mapping.amplitude = Some(0.002);
    for slot in &mut scene.settings.materials[0].maps {
        slot.baked_amplitude = Some(0.002);
    }
    scene.snapshot()
}

fn with(snapshot: &Snapshot, filter: TextureFilter, samples: u32) -> Snapshot {
    edited(snapshot, |s| {
        s.shading.filter = filter;
        s.samples = samples;
    })
}

fn rmse(a: &Picture, b: &Picture) -> f64 {
    let channels = |p: &Picture| -> Vec<f64> {
        let all = p.pixels.iter().flat_map(|c| c.to_array());
        all.map(f64::from).collect()
    };
    let (a, b) = (channels(a), channels(b));
    (a.iter().zip(&b).map(|(x, y)| (x - y).powi(2)).sum::<f64>() / a.len() as f64).sqrt()
}

#[test]
fn one_sample_with_mip_maps_is_nearer_to_many_without() {
    for method in [
        Method::None,
        Method::Bump,
        Method::Normal,
        Method::Slope,
        Method::Parallax,
    ] {
        let snapshot = far_floor(method);
        let converged = picture(&with(&snapshot, TextureFilter::Bilinear, 64));
        let error = |filter| rmse(&picture(&with(&snapshot, filter, 1)), &converged);
        let (points, means) = (error(TextureFilter::Bilinear), error(TextureFilter::Mip));
        eprintln!(
            "{}: one sample at points {points:.4}, as means {means:.4}",
            method.name()
        );
        assert!(
            means < 0.5 * points,
            "{}: {means} against {points}",
            method.name()
        );
    }
}

/// Every method and both derivatives, with maps of all kinds.
fn near_methods() -> Vec<(String, Snapshot)> {
    let waves = |s: f32, t: f32| 0.5 + 0.4 * (s * 6.3).sin() * (t * 12.6).cos();
    // Four texels over the whole tile: the widest cone covers less than one.
    let mut scene = QuadScene::new()
        .with_map(MapRole::Albedo, checkerboard(4))
        .with_map(MapRole::Height, heights(4, 4, waves))
        .with_map(MapRole::Normal, plain_float(2, 2, [0.6, 0.55, 0.9]))
        .with_map(MapRole::Slope, plain_float(2, 2, [0.6, 0.45, 0.0]));
    scene.settings.materials[0].reflectivity = 0.3;
    scene.settings.materials[0].ks = LinearRgb::gray(0.3);
    let snapshot = scene.snapshot();
    let mut all = Vec::new();
    for method in Method::ALL {
        for (lookup, derivative) in Lookup::ALL.into_iter().zip(Derivative::ALL) {
            let name = format!("{}, {}", method.name(), lookup.name());
            let edit = edited(&snapshot, |s| {
                s.mapping.method = method;
                s.mapping.lookup = lookup;
                s.mapping.derivative = derivative;
            });
            all.push((name, edit));
        }
    }
    all
}

#[test]
fn near_maps_are_as_they_are_to_the_bit() {
    for (name, snapshot) in near_methods() {
        let film = |filter| bits(&picture(&with(&snapshot, filter, 2)));
        assert_eq!(
            film(TextureFilter::Bilinear),
            film(TextureFilter::Mip),
            "{name}"
        );
    }
}

#[test]
fn every_vector_level_and_the_probe_tell_the_same_bits() {
    for method in [
        Method::None,
        Method::Bump,
        Method::Normal,
        Method::Parallax,
        Method::Exact,
    ] {
        let mut snapshot = with(&far_floor(method), TextureFilter::Mip, 1);
        snapshot = edited(&snapshot, |s| {
            s.materials[0].reflectivity = 0.4;
            s.materials[0].ks = LinearRgb::gray(0.4);
        });
        let mut first: Option<Vec<[u32; 3]>> = None;
        for level in SimdLevel::ALL.into_iter().filter(|l| l.is_available()) {
            let mut scene = (*snapshot.scene).clone();
            scene.bvh = scene.bvh.with_level(level).expect("is available");
            let at_level = Snapshot {
                scene: Arc::new(scene),
                ..snapshot.clone()
            };
            let film = bits(&picture(&at_level));
            let first = first.get_or_insert_with(|| film.clone());
            assert_eq!(*first, film, "{}: {level:?}", method.name());
            for (x, y) in (0..40)
                .step_by(7)
                .flat_map(|y| (0..48).step_by(5).map(move |x| (x, y)))
            {
                let told = probe(&at_level, [x, y]).expect("inside").color;
                let shown = film[(y * 48 + x) as usize];
                assert_eq!(
                    shown,
                    told.to_array().map(f32::to_bits),
                    "{level:?} at {x}, {y}"
                );
            }
        }
    }
}

/// In a mirror a floor looks as it would from behind the mirror: as far away, and as calm.
#[test]
fn a_mirror_does_not_shorten_the_cone() {
    // A mirror over a checkerboard, looked into at a slant: what is seen there is means only, half of white.
    let mut scene = QuadScene::new().with_map(MapRole::Albedo, checkerboard(256));
    scene.uv = |p| p * 8.0;
    scene.settings.lights = vec![Light::new("sky", LightKind::Ambient, 1.0)];
    scene.settings.materials[0].kd = LinearRgb::WHITE;
    scene.settings.materials[0].reflectivity = 0.5;
    scene.settings.camera.eye = DVec3::new(0.0, -4.0, 0.3);
    scene.settings.camera.target = DVec3::new(0.0, 0.0, 0.2);
    scene.settings.camera.vfov = 14_f64.to_radians();
    let snapshot = with(&scene.snapshot(), TextureFilter::Mip, 1);
    let mut mirrored = 0;
    for (x, y) in (0..40).flat_map(|y| (0..48).map(move |x| (x, y))) {
        let story = probe(&snapshot, [x, y]).expect("inside");
        if story.bounces.len() < 2 {
            continue;
        }
        for bounce in &story.bounces {
            if let Some(hit) = &bounce.hit {
                mirrored += 1;
                let off = (hit.diffuse.r - 0.5).abs();
                assert!(off < 0.02, "{x}, {y}: {}", hit.diffuse.r);
            }
        }
    }
    assert!(mirrored > 100, "{mirrored}");
}

#[test]
fn halvings_are_made_only_where_they_are_asked_for() {
    let snapshot = far_floor(Method::Bump);
    let bytes = |s: &Snapshot| -> usize { s.scene.images.iter().map(|i| i.filter_bytes()).sum() };
    let plain = converged(&with(&snapshot, TextureFilter::Bilinear, 1), 1).counters();
    assert_eq!(bytes(&snapshot), 0);
    let mip = converged(&with(&snapshot, TextureFilter::Mip, 1), 1).counters();
    // A third of the texels, floats: three of the colours, one of the heights; no normals.
    let texels = 32 * 32 + 16 * 16 + 8 * 8 + 4 * 4 + 2 * 2 + 1;
    assert_eq!(bytes(&snapshot), texels * (12 + 4));
    assert_eq!(mip.texture_fetches, 2 * plain.texture_fetches);
    assert_eq!(mip.perturbations, plain.perturbations);
}

#[test]
fn colours_alone_need_no_perturbation() {
    let mut scene = QuadScene::new().with_map(MapRole::Albedo, checkerboard(64));
    scene.uv = |p| Vec2::new(p.x * 9.0, p.y * 5.0);
    let snapshot = with(&scene.snapshot(), TextureFilter::Mip, 1);
    let counters = converged(&snapshot, 1).counters();
    assert_eq!(counters.perturbations, 0);
    assert!(counters.texture_fetches > 0);
}
