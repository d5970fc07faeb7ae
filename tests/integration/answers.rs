//! Scenes whose answer is known on paper.

use std::f32::consts::{PI, TAU};

use glam::DVec3;
use reliefscope::math::LinearRgb;
use reliefscope::render::{PixelStory, Snapshot, Visibility, probe};
use reliefscope::scene::{Background, ShadingModel};
use reliefscope::shading::{Falloff, Light, LightKind, Material};

use crate::support::{QuadScene, edited, picture};

/// A camera right above the point (x, y) of the quad, looking down on it.
fn above(x: f64, y: f64) -> Snapshot {
    let mut scene = QuadScene::new();
    scene.settings.camera.eye = DVec3::new(x, y, 0.3);
    scene.settings.camera.target = DVec3::new(x, y, 0.0);
    scene.settings.camera.up = DVec3::Y;
    scene.settings.lights.clear();
    scene.size = [33, 33];
    scene.snapshot()
}

/// The middle pixel looks straight down.
fn middle(snapshot: &Snapshot) -> PixelStory {
    probe(snapshot, [16, 16]).expect("inside")
}

fn lit_by(snapshot: &Snapshot, kind: LightKind, intensity: f32) -> Snapshot {
    edited(snapshot, |s| {
        s.lights.push(Light::new("light", kind, intensity))
    })
}

#[track_caller]
fn assert_close(a: f32, b: f32) {
    assert!(
        (a - b).abs() <= 2e-6 * b.abs().max(1e-3),
        "{a} should be {b}"
    );
}

#[test]
fn a_lambert_surface_sends_albedo_over_pi_times_irradiance() {
    let slant = LightKind::Directional {
        direction: DVec3::new(0.0, -(3_f64.sqrt()), -1.0),
    };
    let story = middle(&lit_by(&above(0.7, 0.7), slant, 2.0));
    // The light stands 60° from the normal: E = 2 · cos 60° = 1.
    assert_close(story.color.r, 0.8 / PI);
    assert_close(story.color.g, 0.6 / PI);
    assert_close(story.color.b, 0.4 / PI);
    let letter = edited(&lit_by(&above(0.7, 0.7), slant, 2.0), |s| {
        s.shading.model = ShadingModel::Report
    });
    assert_close(middle(&letter).color.r, 0.8);
}

#[test]
fn a_point_light_fades_with_the_square_of_the_distance_or_not_at_all() {
    let place = DVec3::new(0.7, 0.7, 2.0);
    let fading = LightKind::Point {
        position: place,
        falloff: Falloff::InverseSquare,
    };
    assert_close(
        middle(&lit_by(&above(0.7, 0.7), fading, 8.0)).color.r,
        0.8 / PI * 8.0 / 4.0,
    );
    let constant = LightKind::Point {
        position: place,
        falloff: Falloff::None,
    };
    assert_close(
        middle(&lit_by(&above(0.7, 0.7), constant, 8.0)).color.r,
        0.8 / PI * 8.0,
    );
}

#[test]
fn ambient_light_comes_back_times_the_diffuse_colour() {
    let story = middle(&lit_by(&above(0.7, 0.7), LightKind::Ambient, 0.5));
    assert_eq!(story.color, LinearRgb::new(0.8, 0.6, 0.4) * 0.5);
}

#[test]
fn the_highlight_peaks_at_its_normalisation() {
    // Light and eye both on the normal: R·V = 1, and the lobe is (s + 2) / 2π times k_s.
    let down = LightKind::Directional {
        direction: DVec3::NEG_Z,
    };
    let glossy = edited(&lit_by(&above(0.7, 0.7), down, 1.0), |s| {
        s.materials[0].kd = LinearRgb::BLACK;
        s.materials[0].ks = LinearRgb::gray(0.25);
        s.materials[0].shininess = 30.0;
    });
    assert_close(middle(&glossy).color.g, 0.25 * 32.0 / TAU);
    assert_close(
        middle(&edited(&glossy, |s| s.shading.model = ShadingModel::Report))
            .color
            .g,
        0.25,
    );
}

#[test]
fn the_small_quad_shadows_the_large_one() {
    // The small quad spans 0.4 around the axis at height 0.4; the camera looks below it from the side.
    let mut scene = QuadScene::new();
    scene.settings.camera.eye = DVec3::new(0.0, -1.5, 0.2);
    scene.settings.camera.target = DVec3::new(0.0, 0.0, 0.0);
    scene.settings.lights.clear();
    scene.size = [33, 33];
    let dark = scene.snapshot();
    let down = LightKind::Directional {
        direction: DVec3::NEG_Z,
    };
    let near = LightKind::Point {
        position: DVec3::new(0.0, 0.0, 0.3),
        falloff: Falloff::None,
    };
    let far = LightKind::Point {
        position: DVec3::new(0.0, 0.0, 0.5),
        falloff: Falloff::None,
    };
    for (kind, shadowed) in [(down, true), (far, true), (near, false)] {
        let story = middle(&lit_by(&dark, kind, 1.0));
        let hit = story.bounces[0]
            .hit
            .as_ref()
            .expect("the middle of the large quad");
        assert_eq!(story.color == LinearRgb::BLACK, shadowed, "{story}");
        match hit.lights[0].visibility {
            Visibility::Shadowed { t, .. } => {
                assert!(shadowed && (t - 0.4).abs() < 1e-6, "{story}")
            }
            Visibility::Visible => assert!(!shadowed, "{story}"),
            Visibility::Behind | Visibility::ShadowedByRelief => panic!("{story}"),
        }
    }
    let without = edited(&lit_by(&dark, down, 1.0), |s| s.shading.shadows = false);
    assert_close(middle(&without).color.r, 0.8 / PI);
}

#[test]
fn a_mirror_shows_its_share_of_the_background() {
    let snapshot = edited(&above(0.7, 0.7), |s| {
        s.materials[0].reflectivity = 0.25;
        s.shading.background = Background {
            top: LinearRgb::new(0.1, 0.2, 0.4),
            bottom: LinearRgb::BLACK,
        };
        s.lights.push(Light::new("sky", LightKind::Ambient, 1.0));
        // The gradient runs along the camera's up direction, which must not lie in the mirror's plane here.
        s.camera.up = DVec3::new(0.0, 0.001, 1.0);
    });
    let story = middle(&snapshot);
    assert_eq!(story.bounces.len(), 2);
    let straight_up = LinearRgb::new(0.1, 0.2, 0.4);
    for ((own, seen), color) in [0.8, 0.6, 0.4]
        .into_iter()
        .zip(straight_up.to_array())
        .zip(story.color.to_array())
    {
        assert!((0.75 * own + 0.25 * seen - color).abs() < 1e-5, "{story}");
    }
}

#[test]
fn parallel_mirrors_end_at_the_bounce_limit() {
    // Between the two quads a ray goes up and down for ever.
    let mut scene = QuadScene::new();
    scene.settings.camera.eye = DVec3::new(0.0, 0.0, 0.2);
    scene.settings.camera.target = DVec3::ZERO;
    scene.settings.camera.up = DVec3::Y;
    scene.settings.lights = vec![Light::new("sky", LightKind::Ambient, 1.0)];
    scene.settings.materials = vec![Material::matte("mirror", LinearRgb::gray(0.5))];
    scene.settings.materials[0].reflectivity = 0.5;
    scene.size = [33, 33];
    let snapshot = scene.snapshot();
    for bounces in 0..6 {
        let story = middle(&edited(&snapshot, |s| s.shading.max_bounces = bounces));
        assert_eq!(story.bounces.len() as u32, bounces + 1);
        // Every bounce shows one half of its share; the last one shows all of it: 0.5 in the end.
        assert_close(story.color.r, 0.5);
    }
    let total = edited(&snapshot, |s| {
        s.materials[0].reflectivity = 1.0;
        s.shading.max_bounces = 40;
    });
    assert!(picture(&total).pixels.iter().all(|c| c.is_finite()));
}
