//! Object space: the stored vector is the normal, whatever the chart does.

use std::fs;
use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};
use reliefscope::render::Snapshot;
use reliefscope::scene::load::LoadOptions;
use reliefscope::scene::open;
use reliefscope::surface::mapping::{Lookup, Method};
use reliefscope::texture::{MapRole, NormalAxes, NormalSpace, Wrap};
use tempfile::TempDir;

use super::{normal_at, same_bits_everywhere};
use crate::support::{QuadScene, bits, edited, heights, picture, plain_float};

const N: Vec3 = Vec3::new(0.36, -0.48, 0.8);

fn quad_with(n: Vec3) -> QuadScene {
    let stored = n.to_array().map(|c| 0.5 + 0.5 * c);
    let mut scene = QuadScene::new().with_map(MapRole::Normal, plain_float(2, 2, stored));
    scene.settings.materials[0].maps[0].space = NormalSpace::Object;
    scene.settings.mapping.method = Method::Normal;
    scene
}

#[track_caller]
fn shows(snapshot: &Snapshot, expected: Vec3) {
    let n = normal_at(snapshot, [20, 30]);
    assert!((n - expected).length() < 1e-6, "{n} should be {expected}");
}

#[test]
fn the_stored_vector_is_the_normal_on_any_chart() {
    shows(&quad_with(N).snapshot(), N);
    let charts: [fn(Vec2) -> Vec2; 4] = [
        |p| Vec2::new(-p.x, p.y),
        |p| Vec2::new(p.y, -p.x),
        |p| Vec2::new(p.x + 0.7 * p.y, 3.0 * p.y),
        // Without area: there is a place on the map, and it needs no frame.
        |_| Vec2::new(0.3, 0.4),
    ];
    for (i, chart) in charts.into_iter().enumerate() {
        let mut scene = quad_with(N);
        scene.uv = chart;
        eprintln!("chart {i}");
        shows(&scene.snapshot(), N);
    }
}

#[test]
fn turned_over_pictures_and_mirrored_copies_say_the_same() {
    let mut scene = quad_with(N);
    let slot = &mut scene.settings.materials[0].maps[0];
    slot.flip_v = true;
    slot.uv_scale = [-2.0, 3.0];
    slot.wrap = Wrap::Mirror;
    shows(&scene.snapshot(), N);
}

#[test]
fn green_may_grow_downwards() {
    let mut scene = quad_with(N);
    scene.settings.materials[0].maps[0].flip_green = true;
    shows(&scene.snapshot(), Vec3::new(N.x, -N.y, N.z));
}

#[test]
fn channels_tell_the_axes_that_they_are_said_to() {
    let axes = NormalAxes::parse("-z +x -y").expect("each once");
    let mut scene = quad_with(N);
    scene.settings.materials[0].maps[0].axes = axes;
    let turned = scene.snapshot();
    shows(&turned, Vec3::new(N.y, -N.z, -N.x));
    // Of tangent space they say nothing.
    let tangent = |axes| {
        let with = edited(&turned, |s| {
            s.materials[0].maps[0].space = NormalSpace::Tangent;
            s.materials[0].maps[0].axes = axes;
        });
        bits(&picture(&with))
    };
    assert_eq!(tangent(axes), tangent(NormalAxes::FILE));
}

#[test]
fn the_back_shows_the_other_side_of_the_same_relief() {
    let mut scene = quad_with(N);
    scene.settings.camera.eye = DVec3::new(0.3, -2.0, -2.0);
    let story = reliefscope::render::probe(&scene.snapshot(), [24, 12]).expect("inside");
    let hit = story.bounces[0].hit.as_ref().expect("a hit");
    assert!(!hit.front);
    assert!((Vec3::from(hit.n_shade) + N).length() < 1e-6, "{story}");
}

#[test]
fn the_amplitude_scales_the_tilt_against_the_mesh() {
    let snapshot = quad_with(N).snapshot();
    // Baked for 0.05: half the slopes.
    let half = edited(&snapshot, |s| s.mapping.amplitude = Some(0.025));
    shows(
        &half,
        Vec3::new(0.5 * N.x, 0.5 * N.y, N.z).normalize_or_zero(),
    );
    let flat = edited(&snapshot, |s| s.mapping.amplitude = Some(0.0));
    let none = edited(&snapshot, |s| s.mapping.method = Method::None);
    assert_eq!(bits(&picture(&flat)), bits(&picture(&none)));
}

#[test]
fn parallax_reads_it_at_the_moved_place() {
    // Two halves with different normals: the relief's floor moves the border.
    let mut scene = QuadScene::new().with_map(MapRole::Height, heights(4, 4, |_, _| 0.0));
    let [a, b] = [N, Vec3::new(-0.6, 0.0, 0.8)].map(|n| n.to_array().map(|c| 0.5 + 0.5 * c));
    let rows = [[a; 64], [b; 64]].concat().concat();
    let image = reliefscope::texture::RawImage {
        width: 64,
        height: 2,
        channels: 3,
        samples: reliefscope::texture::Samples::F32(rows),
    };
    scene = scene.with_map(MapRole::Normal, image);
    scene.settings.materials[0].maps[1].space = NormalSpace::Object;
    scene.settings.mapping.lookup = Lookup::Normal;
    let snapshot = scene.snapshot();
    let film = |method| {
        let with = edited(&snapshot, |s| {
            s.mapping.method = method;
            s.mapping.amplitude = Some(0.2);
        });
        same_bits_everywhere(&with);
        bits(&picture(&with))
    };
    assert_ne!(film(Method::Parallax), film(Method::Normal));
}

/// The axes are those of the file: being centred and scaled while loading turns nothing.
#[test]
fn a_model_far_away_and_large_shows_the_same_normal() {
    let folder = TempDir::new().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let quad = "v 70000 0 500\nv 70800 0 500\nv 70800 600 500\nv 70000 600 500\n\
        vt 1 0\nvt 0 0\nvt 0 1\nvt 1 1\nf 1/1 2/2 3/3 4/4\n";
    fs::write(path("quad.obj"), quad).expect("is written");
    reliefscope::scene::save_picture::write_png(&path("n.png"), [1, 1], &[[173, 66, 230]])
        .expect("is written");
    let scene = "model = \"quad.obj\"\n[mapping]\nmethod = \"normal\"\n\
        [[material]]\nname = \"*\"\nnormal_map = \"n.png\"\nnormal_space = \"object\"\n";
    fs::write(path("scene.toml"), scene).expect("is written");
    let loaded = open(&path("scene.toml"), &LoadOptions::default()).expect("opens");
    let snapshot = Snapshot {
        scene: loaded.scene,
        settings: Arc::new(loaded.settings),
        size: [32, 32],
    };
    let stored = Vec3::new(173.0, 66.0, 230.0) / 255.0 * 2.0 - 1.0;
    let n = normal_at(&snapshot, [16, 16]);
    assert!((n - stored.normalize_or_zero()).length() < 1e-6, "{n}");
    assert_eq!(snapshot.scene.tangents.bytes(), 0);
}
