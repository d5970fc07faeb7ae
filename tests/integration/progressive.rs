//! Passes, previews and the hit cache: what may change when, and what never does.

use std::f32::consts::TAU;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use glam::DVec3;
use reliefscope::geometry::simd::SimdLevel;
use reliefscope::math::LinearRgb;
use reliefscope::render::{PassEnd, Progressive, Snapshot, probe};
use reliefscope::scene::load::LoadOptions;
use reliefscope::scene::open;
use reliefscope::shading::{Light, LightKind};
use reliefscope::surface::mapping::Method;
use reliefscope::texture::MapRole;

use crate::support::{QuadScene, bits, converged, edited, heights, picture, plain_rgb};

fn waves() -> Snapshot {
    let map = heights(32, 32, |s, t| {
        0.5 + 0.25 * ((s * 2.0 * TAU).sin() + (t * TAU).cos())
    });
    QuadScene::new().with_map(MapRole::Height, map).snapshot()
}

fn mirrored(snapshot: &Snapshot) -> Snapshot {
    edited(snapshot, |s| {
        s.materials[0].reflectivity = 0.4;
        s.materials[0].ks = LinearRgb::gray(0.3);
    })
}

#[test]
fn any_thread_count_gives_the_same_bits() {
    let snapshot = mirrored(&waves());
    let one = bits(&converged(&snapshot, 1).picture());
    for threads in [2, 3, 8] {
        assert_eq!(
            one,
            bits(&converged(&snapshot, threads).picture()),
            "{threads} threads"
        );
    }
}

/// The vector code of the stages against itself with four plain lanes, and so, as `probe` agrees with the
/// film, against the code for one point.
#[test]
fn every_vector_level_gives_the_same_bits() {
    for name in ["wall", "materials", "columns"] {
        let loaded = open(Path::new(name), &LoadOptions::default()).expect("built in");
        for method in Method::ALL {
            // Once with the scene itself, so that its copies find the maps that searches read.
            let snapshot = Snapshot {
                scene: Arc::clone(&loaded.scene),
                settings: Arc::new(loaded.settings.clone()),
                size: [8, 8],
            };
            picture(&edited(&snapshot, |s| {
                s.mapping.method = method;
                s.samples = 1;
            }));
            let picture_at = |level| {
                let mut scene = (*loaded.scene).clone();
                scene.bvh = scene.bvh.with_level(level).expect("available");
                let mut settings = loaded.settings.clone();
                settings.mapping.method = method;
                settings.samples = 2;
                bits(&picture(&Snapshot {
                    scene: Arc::new(scene),
                    settings: Arc::new(settings),
                    size: [75, 50],
                }))
            };
            let plain = picture_at(SimdLevel::Scalar);
            for level in SimdLevel::ALL.into_iter().filter(|l| l.is_available()) {
                assert!(
                    picture_at(level) == plain,
                    "{name}, {}, {level}",
                    method.name()
                );
            }
        }
    }
}

#[test]
fn previews_leave_no_trace() {
    let snapshot = mirrored(&waves());
    let plain = bits(&picture(&snapshot));
    for strides in [&[8, 4, 2, 1][..], &[4], &[2, 8], &[1]] {
        let mut renderer = Progressive::new(2).expect("threads");
        renderer.start(snapshot.clone());
        for &stride in strides {
            assert_eq!(renderer.preview(stride, &|| false), PassEnd::Complete);
        }
        while !renderer.is_converged() {
            renderer.pass(&|| false);
        }
        assert_eq!(plain, bits(&renderer.picture()), "previews {strides:?}");
        let rays = renderer.counters().camera_rays;
        assert_eq!(
            rays,
            48 * 40 * 4,
            "previews {strides:?} trace no pixel twice"
        );
    }
}

#[test]
fn preview_pixels_are_those_of_the_first_pass() {
    let snapshot = waves();
    let mut renderer = Progressive::new(2).expect("threads");
    renderer.start(snapshot);
    renderer.preview(4, &|| false);
    let preview = renderer.picture();
    assert_eq!(renderer.samples(), 0, "a preview is no sample");
    renderer.pass(&|| false);
    let full = renderer.picture();
    for y in 0..40 {
        for x in 0..48 {
            assert_eq!(
                preview.at(x, y),
                full.at(x - x % 4, y - y % 4),
                "at {x}, {y}"
            );
        }
    }
}

#[test]
fn a_stopped_pass_goes_on_where_it_stopped() {
    let snapshot = waves();
    let plain = bits(&picture(&snapshot));
    let mut renderer = Progressive::new(2).expect("threads");
    renderer.start(snapshot);
    let mut stops = 0;
    while !renderer.is_converged() {
        let polls = std::sync::atomic::AtomicU32::new(0);
        let end = renderer.pass(&|| polls.fetch_add(1, std::sync::atomic::Ordering::Relaxed) > 1);
        stops += u32::from(end == PassEnd::Stopped);
    }
    assert!(stops > 0, "the pass was stopped at least once");
    assert_eq!(plain, bits(&renderer.picture()));
}

#[test]
fn edits_that_cannot_change_visibility_trace_no_camera_ray_again() {
    let snapshot = waves();
    let edits: [(&str, Snapshot); 4] = [
        ("light", edited(&snapshot, |s| s.lights[1].intensity = 0.7)),
        (
            "material",
            edited(&snapshot, |s| s.materials[0].kd = LinearRgb::WHITE),
        ),
        (
            "method",
            edited(&snapshot, |s| s.mapping.method = Method::ParallaxLimited),
        ),
        (
            "map",
            edited(&snapshot, |s| s.materials[0].maps[0].enabled = false),
        ),
    ];
    for (what, after) in edits {
        let mut renderer = converged(&snapshot, 2);
        renderer.start(after.clone());
        assert!(renderer.reuses_hits(), "{what}");
        renderer.pass(&|| false);
        assert_eq!(
            renderer.counters().camera_rays,
            0,
            "{what}: the first sample re-shades cached hits"
        );
        while !renderer.is_converged() {
            renderer.pass(&|| false);
        }
        assert_eq!(bits(&picture(&after)), bits(&renderer.picture()), "{what}");
    }
}

#[test]
fn edits_that_change_visibility_forget_the_hits() {
    let snapshot = waves();
    let holes = plain_rgb(2, 2, [0, 0, 0]);
    let moved = edited(&snapshot, |s| s.camera.eye.x += 0.1);
    let larger = Snapshot {
        size: [50, 40],
        ..snapshot.clone()
    };
    let cut = QuadScene::new()
        .with_map(MapRole::Opacity, holes)
        .snapshot();
    for after in [moved, larger, cut] {
        let mut renderer = converged(&snapshot, 2);
        renderer.start(after.clone());
        assert!(!renderer.reuses_hits());
        while !renderer.is_converged() {
            renderer.pass(&|| false);
        }
        assert_eq!(bits(&picture(&after)), bits(&renderer.picture()));
    }
}

#[test]
fn the_screen_shows_the_mean_with_exposure() {
    let renderer = converged(&waves(), 2);
    let mut rgba = vec![[0_u8; 4]; 48 * 40];
    renderer.encode_into(1.5, &mut rgba);
    for (pixel, color) in rgba.iter().zip(&renderer.picture().pixels) {
        let [r, g, b] = reliefscope::math::srgb8_from_linear(*color * 1.5_f32.exp2());
        assert_eq!(*pixel, [r, g, b, 255]);
    }
}

#[test]
fn a_probe_tells_the_first_sample_to_the_bit() {
    let snapshot = edited(&mirrored(&waves()), |s| s.samples = 1);
    let film = picture(&snapshot);
    for y in (0..40).step_by(3) {
        for x in (0..48).step_by(5) {
            let story = probe(&snapshot, [x, y]).expect("inside");
            assert_eq!(story.color, film.at(x, y), "pixel {x}, {y}\n{story}");
        }
    }
    assert!(probe(&snapshot, [48, 0]).is_none());
}

#[test]
fn a_probe_adds_up() {
    let snapshot = waves();
    let mut lit = 0;
    for x in 0..48 {
        let story = probe(&snapshot, [x, 22]).expect("inside");
        let bounce = &story.bounces[0];
        let Some(hit) = &bounce.hit else { continue };
        let sum = hit
            .lights
            .iter()
            .fold(hit.ambient, |sum, l| sum + l.diffuse + l.specular);
        for (a, b) in sum.to_array().into_iter().zip(bounce.color.to_array()) {
            assert!((a - b).abs() <= 1e-6 * b.abs().max(1e-3), "{story}");
        }
        lit += 1;
    }
    assert!(lit > 30);
}

#[test]
fn nothing_is_computed_for_what_the_scene_lacks() {
    let bare = QuadScene::new().snapshot();
    let counters = converged(&bare, 2).counters();
    assert_eq!(counters.texture_fetches, 0, "no maps, no look-ups");
    assert_eq!(counters.perturbations, 0);
    assert_eq!(counters.power_calls, 0, "a matte scene takes no power");
    assert_eq!(counters.mirror_rays, 0, "and sends no mirror ray");
    assert_eq!(counters.cutout_tests, 0, "no holes, no questions");
    assert_eq!(counters.camera_rays, 48 * 40 * 4);
    assert_eq!(counters.non_finite, 0);

    let behind = edited(&bare, |s| {
        let up = LightKind::Directional {
            direction: DVec3::Z,
        };
        s.lights = vec![Light::new("from below", up, 3.0)];
    });
    assert_eq!(
        converged(&behind, 2).counters().shadow_rays,
        0,
        "a light behind the surface costs no shadow ray"
    );

    let dark = edited(&bare, |s| {
        s.lights.iter_mut().for_each(|l| l.intensity = 0.0)
    });
    assert_eq!(
        converged(&dark, 2).counters().shadow_rays,
        0,
        "nor does one without light"
    );
}

#[test]
fn counts_are_exact() {
    // Every camera ray of this view hits the quad, which both lights see in full.
    let close = edited(
        &QuadScene::new()
            .with_map(MapRole::Height, heights(8, 8, |s, _| s))
            .snapshot(),
        |s| {
            s.camera.eye = DVec3::new(0.6, 0.6, 0.3);
            s.camera.target = DVec3::new(0.6, 0.6, 0.0);
            s.camera.up = DVec3::Y;
            s.samples = 3;
            s.materials[0].ks = LinearRgb::gray(0.2);
            s.mapping.method = Method::Bump;
        },
    );
    let counters = converged(&close, 2).counters();
    let points = 48 * 40 * 3;
    assert_eq!(counters.camera_rays, points);
    assert_eq!(counters.perturbations, points);
    assert_eq!(
        counters.texture_fetches, points,
        "bump costs one look-up a point"
    );
    assert_eq!(counters.shadow_rays, 2 * points, "one a light and point");
    assert!(counters.power_calls > 0 && counters.power_calls <= 2 * points);
}

/// Passes of one snapshot after the other, by one renderer: the last picture must be as if it had come first.
#[track_caller]
fn shadow_rays_after(changes: &[&Snapshot]) -> u64 {
    let mut renderer = Progressive::new(2).expect("threads");
    let Some((&last, before)) = changes.split_last() else {
        return 0;
    };
    for &snapshot in before {
        renderer.start(snapshot.clone());
        while !renderer.is_converged() {
            renderer.pass(&|| false);
        }
    }
    renderer.start(last.clone());
    renderer.pass(&|| false);
    let traced = renderer.counters().shadow_rays;
    while !renderer.is_converged() {
        renderer.pass(&|| false);
    }
    let same = bits(&renderer.picture()) == bits(&picture(last));
    assert!(same, "what came before changed the picture");
    traced
}

#[test]
fn shadows_are_traced_again_only_for_what_changes_them() {
    let snapshot = edited(&mirrored(&waves()), |s| {
        s.samples = 2;
        s.shading.max_bounces = 0;
        s.mapping.method = Method::Bump;
        s.lights.retain(|light| light.kind != LightKind::Ambient);
    });
    let whole = shadow_rays_after(&[&snapshot]);
    assert!(whole > 500, "{whole}");
    assert_eq!(snapshot.settings.lights.len(), 2);

    let colours = edited(&snapshot, |s| {
        s.lights[0].intensity *= 0.5;
        s.lights[1].color = LinearRgb::new(1.0, 0.5, 0.2);
        s.materials[0].kd = LinearRgb::gray(0.3);
        s.materials[0].shininess = 90.0;
    });
    assert_eq!(shadow_rays_after(&[&snapshot, &colours]), 0);
    let swapped = edited(&snapshot, |s| s.lights.swap(0, 1));
    assert_eq!(shadow_rays_after(&[&snapshot, &swapped]), 0);

    // Other normals turn other points to the light; only those are new.
    let none = edited(&snapshot, |s| s.mapping.method = Method::None);
    let new = shadow_rays_after(&[&snapshot, &none]);
    assert!(new < whole / 4, "{new} of {whole}");
    assert_eq!(shadow_rays_after(&[&snapshot, &none, &snapshot]), 0);

    let moved = edited(&snapshot, |s| match &mut s.lights[0].kind {
        LightKind::Point { position, .. } => position.x += 0.3,
        LightKind::Directional { direction } => direction.x += 0.3,
        LightKind::Ambient => {}
    });
    let new = shadow_rays_after(&[&snapshot, &moved]);
    assert!(new > whole / 4 && new < whole * 3 / 4, "{new} of {whole}");
    let unlit = edited(&snapshot, |s| {
        s.lights.remove(0);
    });
    assert_eq!(shadow_rays_after(&[&snapshot, &unlit]), 0);
    // Of a light that was gone nothing is known.
    assert_eq!(
        shadow_rays_after(&[&snapshot, &unlit, &snapshot]),
        whole - shadow_rays_after(&[&unlit])
    );

    // Where points, or what starts from them, are not the same, all rays are.
    let searched = edited(&snapshot, |s| s.mapping.method = Method::Exact);
    shadow_rays_after(&[&snapshot, &searched]);
    assert_eq!(shadow_rays_after(&[&snapshot, &searched, &snapshot]), whole);
    let smooth = edited(&snapshot, |s| {
        s.shading.smooth_terminator = !s.shading.smooth_terminator;
    });
    assert_eq!(shadow_rays_after(&[&smooth, &snapshot]), whole);
    let displaced = edited(&snapshot, |s| s.mapping.method = Method::Displacement);
    assert_eq!(
        shadow_rays_after(&[&displaced, &snapshot]),
        whole,
        "after displacement"
    );
    let turned = edited(&snapshot, |s| s.camera.orbit(0.1, 0.0));
    shadow_rays_after(&[&snapshot, &turned]);
}

#[test]
fn displaced_tiles_that_are_left_off_on_the_way_leave_no_trace() {
    let snapshot = edited(&mirrored(&waves()), |s| {
        s.mapping.method = Method::Displacement;
        s.samples = 2;
    });
    let whole = converged(&snapshot, 1);
    let mut renderer = Progressive::new(1).expect("a thread");
    renderer.start(snapshot.clone());
    let mut stopped = 0;
    // Each time a little later, until nothing is left to stop.
    for patience in 0.. {
        if renderer.is_converged() {
            break;
        }
        let asked = AtomicU32::new(0);
        let stop = || asked.fetch_add(1, Ordering::Relaxed) >= patience;
        stopped += u32::from(renderer.pass(&stop) == PassEnd::Stopped);
    }
    assert!(stopped > 20, "asked within tiles: stopped {stopped} times");
    assert_eq!(bits(&whole.picture()), bits(&renderer.picture()));
    assert_eq!(whole.counters(), renderer.counters());
}
