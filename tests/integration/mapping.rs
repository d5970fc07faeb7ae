//! What every method must do alike, run over the one list.

use glam::{DMat3, DVec3, Vec2};
use reliefscope::render::Snapshot;
use reliefscope::surface::mapping::{Derivative, Lookup, Method};
use reliefscope::texture::{MapRole, RawImage, Wrap};

use crate::support::{QuadScene, bits, edited, heights, max_difference, picture, plain_float};

/// A quad with all three kinds of relief map that say the same: heights `f(s, t)` of amplitude 0.05 on a
/// tile two units wide, their normals and their slopes.
fn quad_with(size: [u32; 2], f: impl Fn(f32, f32) -> f32 + Copy) -> QuadScene {
    let [w, h] = size;
    let slope = move |s: f32, t: f32| {
        let (ds, dt) = (0.5 / w as f32, 0.5 / h as f32);
        let along_u = (f(s + ds, t) - f(s - ds, t)) / (2.0 * ds);
        let along_v = -(f(s, t + dt) - f(s, t - dt)) / (2.0 * dt);
        [along_u * 0.05 / 2.0, along_v * 0.05 / 2.0]
    };
    let float_map = |g: &dyn Fn(f32, f32) -> [f32; 3]| {
        let mut samples = Vec::new();
        for y in 0..h {
            for x in 0..w {
                samples.extend(g((x as f32 + 0.5) / w as f32, (y as f32 + 0.5) / h as f32));
            }
        }
        RawImage {
            width: w,
            height: h,
            channels: 3,
            samples: reliefscope::texture::Samples::F32(samples),
        }
    };
    let normals = float_map(&|s, t| {
        let [x, y] = slope(s, t);
        glam::Vec3::new(-x, -y, 1.0)
            .normalize_or_zero()
            .to_array()
            .map(|c| 0.5 + 0.5 * c)
    });
    let slopes = float_map(&|s, t| {
        let [x, y] = slope(s, t);
        [0.5 + 0.5 * x, 0.5 + 0.5 * y, 0.0]
    });
    QuadScene::new()
        .with_map(MapRole::Height, heights(w, h, f))
        .with_map(MapRole::Normal, normals)
        .with_map(MapRole::Slope, slopes)
}

fn waves(s: f32, t: f32) -> f32 {
    let turn = std::f32::consts::TAU;
    0.5 + 0.2 * (s * turn).sin() + 0.15 * (t * 2.0 * turn).cos()
}

/// Every method, with both look-ups and both derivatives where they matter.
fn every_method(snapshot: &Snapshot) -> Vec<(String, Snapshot)> {
    let mut all = Vec::new();
    for method in Method::ALL {
        for lookup in Lookup::ALL {
            for derivative in Derivative::ALL {
                let name = format!(
                    "{} with {} look-up, {} slopes",
                    method.name(),
                    lookup.name(),
                    derivative.name()
                );
                let with = edited(snapshot, |s| {
                    s.mapping.method = method;
                    s.mapping.lookup = lookup;
                    s.mapping.derivative = derivative;
                });
                all.push((name, with));
            }
        }
    }
    all
}

/// Every method that keeps the smooth normals of the mesh where the relief is flat. Displacement shades with
/// the normal of the moved surface itself.
fn every_smooth_method(snapshot: &Snapshot) -> Vec<(String, Snapshot)> {
    let mut all = every_method(snapshot);
    all.retain(|(_, with)| with.settings.mapping.method != Method::Displacement);
    all
}

fn none(snapshot: &Snapshot) -> Snapshot {
    edited(snapshot, |s| s.mapping.method = Method::None)
}

fn rms(a: &reliefscope::render::Picture, b: &reliefscope::render::Picture) -> f64 {
    let channels = |p: &reliefscope::render::Picture| {
        let encode = |c: f32| f64::from(reliefscope::math::srgb_from_linear(c));
        p.pixels
            .iter()
            .flat_map(|c| c.to_array())
            .map(encode)
            .collect::<Vec<_>>()
    };
    let (a, b) = (channels(a), channels(b));
    (a.iter().zip(&b).map(|(x, y)| (x - y).powi(2)).sum::<f64>() / a.len() as f64).sqrt()
}

#[test]
fn every_method_changes_the_picture() {
    let snapshot = quad_with([64, 64], waves).snapshot();
    let flat = picture(&none(&snapshot));
    for (name, with) in every_method(&snapshot) {
        let changed = rms(&flat, &picture(&with)) > 1e-3;
        assert_eq!(
            changed,
            with.settings.mapping.method != Method::None,
            "{name}"
        );
    }
}

#[test]
fn amplitude_zero_is_none_to_the_bit() {
    let snapshot = quad_with([64, 64], waves).snapshot();
    let flat = bits(&picture(&none(&snapshot)));
    for (name, with) in every_method(&snapshot) {
        let with = edited(&with, |s| s.mapping.amplitude = Some(0.0));
        assert_eq!(flat, bits(&picture(&with)), "{name}");
    }
}

#[test]
fn a_ten_thousandth_of_a_tile_is_within_60_db_of_none() {
    let snapshot = quad_with([64, 64], waves).snapshot();
    let flat = picture(&none(&snapshot));
    for (name, with) in every_smooth_method(&snapshot) {
        let with = edited(&with, |s| s.mapping.amplitude = Some(2.0 * 1e-4));
        let error = rms(&flat, &picture(&with));
        assert!(error < 1e-3, "{name}: {:.1} dB", -20.0 * error.log10());
    }
}

#[test]
fn a_flat_map_is_the_identity() {
    for size in [[1, 1], [5, 3], [64, 64]] {
        let snapshot = quad_with(size, |_, _| 1.0).snapshot();
        let flat = picture(&none(&snapshot));
        for (name, with) in every_smooth_method(&snapshot) {
            assert!(
                max_difference(&flat, &picture(&with)) < 1e-6,
                "{name} on {size:?}"
            );
        }
    }
}

#[test]
fn a_flat_map_below_the_mesh_moves_only_parallax() {
    // Heights of one half at midlevel 1 lie half an amplitude under the mesh.
    let snapshot = quad_with([4, 4], |_, _| 0.5).snapshot();
    let flat = picture(&none(&snapshot));
    for (name, with) in every_smooth_method(&snapshot) {
        let method = with.settings.mapping.method;
        // A search finds the floor itself, which lamps see from elsewhere; the others stay where they are.
        assert!(
            method.searches() || max_difference(&flat, &picture(&with)) < 1e-6,
            "{name}: no albedo map, nothing to see move"
        );
        let story = reliefscope::render::probe(&with, [20, 30]).expect("inside");
        let hit = story.bounces[0]
            .hit
            .as_ref()
            .expect("the quad fills this pixel");
        if method.shifts_uv() {
            let (uv, moved) = (hit.uv.expect("uv"), hit.uv_moved.expect("uv"));
            let shift = Vec2::from(moved) - Vec2::from(uv);
            let wo = -glam::Vec3::from(story.bounces[0].dir).as_dvec3();
            // A few steps do not reach the floor.
            let tolerance = if method == Method::Iterative {
                1e-3
            } else {
                1e-6
            };
            let divisor = if method == Method::ParallaxLimited {
                1.0
            } else {
                wo.z
            };
            // d · V_xy / V_z in world units, half of it in texture units: a tile is two units wide.
            let expected = (-0.025 * wo.truncate() / divisor * 0.5).as_vec2();
            assert!(
                (shift - expected).length() < tolerance,
                "{name}: {shift} should be {expected}"
            );
        }
    }
}

#[test]
fn a_tilted_map_is_a_tilted_frame() {
    // A plane of slope 0.3 along u by map, and the same plane as the shading normal itself.
    let slope = 0.3_f32;
    let expected = glam::Vec3::new(-slope, 0.0, 1.0).normalize_or_zero();
    let stored = expected.to_array().map(|c| 0.5 + 0.5 * c);
    let scene = QuadScene::new()
        .with_map(MapRole::Normal, plain_float(2, 2, stored))
        .with_map(
            MapRole::Slope,
            plain_float(2, 2, [0.5 + 0.5 * slope, 0.5, 0.5]),
        );
    let snapshot = scene.snapshot();
    for method in [Method::Normal, Method::Slope] {
        let with = edited(&snapshot, |s| s.mapping.method = method);
        let story = reliefscope::render::probe(&with, [20, 30]).expect("inside");
        let n = glam::Vec3::from(story.bounces[0].hit.as_ref().expect("hit").n_shade);
        assert!(
            (n - expected).length() < 1e-6,
            "{}: {n} should be {expected}",
            method.name()
        );
    }
    // A ramp of stored heights from 0 to 0.6 across a tile of 2 units with amplitude 1.
    let ramp = QuadScene::new()
        .with_map(MapRole::Height, heights(256, 1, |s, _| s * 0.6))
        .snapshot();
    for derivative in Derivative::ALL {
        let with = edited(&ramp, |s| {
            s.mapping.method = Method::Bump;
            s.mapping.derivative = derivative;
            s.mapping.amplitude = Some(1.0);
        });
        let story = reliefscope::render::probe(&with, [20, 30]).expect("inside");
        let n = glam::Vec3::from(story.bounces[0].hit.as_ref().expect("hit").n_shade);
        // 16-bit steps of 1.5e-5 over texels of 1/256: slopes to 0.4 %.
        assert!(
            (n - expected).length() < 4e-3,
            "{}: {n} should be {expected}",
            derivative.name()
        );
    }
}

/// The same relief on the same place of the quad, whatever the chart looks like.
#[test]
fn mirrored_and_turned_charts_show_the_same_relief() {
    let plain = quad_with([64, 64], waves);
    let reference: Vec<_> = every_method(&plain.snapshot())
        .iter()
        .map(|(_, s)| picture(s))
        .collect();
    // u mirrored: the chart runs right to left, and the picture is mirrored to match.
    let mut mirrored = quad_with([64, 64], waves);
    mirrored.uv = |p| Vec2::new(1.0 - (p.x + 1.0) * 0.5, (p.y + 1.0) * 0.5);
    for slot in &mut mirrored.settings.materials[0].maps {
        slot.uv_scale[0] = -1.0;
        slot.uv_offset[0] = 1.0;
    }
    // v upside down, picture flipped to match.
    let mut flipped = quad_with([64, 64], waves);
    flipped.uv = |p| Vec2::new((p.x + 1.0) * 0.5, 1.0 - (p.y + 1.0) * 0.5);
    for slot in &mut flipped.settings.materials[0].maps {
        slot.flip_v = true;
    }
    for (what, scene) in [("mirrored u", mirrored), ("flipped v", flipped)] {
        for ((name, with), reference) in every_method(&scene.snapshot()).iter().zip(&reference) {
            let error = rms(reference, &picture(with));
            assert!(error < 1e-4, "{what}, {name}: {error}");
        }
    }
}

/// Turning quad, lights and camera together turns nothing in the picture: no method knows the world's
/// axes. Done by turning the texture instead: a quarter turn of chart and map.
#[test]
fn a_turned_chart_with_a_turned_map_shows_the_same_relief() {
    let turned = |s: f32, t: f32| waves(t, 1.0 - s);
    let mut scene = quad_with([64, 64], turned);
    // uv' = (v, 1 − u) of the plain chart, t down: the map above is turned to match.
    scene.uv = |p| {
        let plain = (p + Vec2::ONE) * 0.5;
        Vec2::new(plain.y, 1.0 - plain.x)
    };
    let plain = quad_with([64, 64], |s, t| {
        // What the turned chart shows at the plain chart's (s, t): u' = v = 1 − t, t' = 1 − v' = u = s.
        turned(1.0 - t, s)
    });
    for ((name, a), (_, b)) in every_method(&scene.snapshot())
        .iter()
        .zip(&every_method(&plain.snapshot()))
    {
        let error = rms(&picture(a), &picture(b));
        assert!(error < 1e-3, "{name}: {error}");
    }
}

#[test]
fn repeating_maps_have_no_seam() {
    let snapshot = quad_with([32, 32], waves).snapshot();
    let shifted = {
        let mut scene = quad_with([32, 32], waves);
        scene.uv = |p| (p + Vec2::ONE) * 0.5 + Vec2::new(3.0, -7.0);
        scene.snapshot()
    };
    for ((name, a), (_, b)) in every_method(&snapshot).iter().zip(&every_method(&shifted)) {
        let error = rms(&picture(a), &picture(b));
        assert!(error < 1e-3, "{name}: {error}");
    }
}

#[test]
fn toggles_switch_their_maps_off() {
    let snapshot = quad_with([64, 64], waves).snapshot();
    let flat = bits(&picture(&none(&snapshot)));
    let off = |method, edit: fn(&mut reliefscope::surface::mapping::MappingSettings)| {
        let with = edited(&snapshot, |s| {
            s.mapping.method = method;
            edit(&mut s.mapping);
        });
        bits(&picture(&with))
    };
    assert_eq!(flat, off(Method::Bump, |m| m.use_height = false));
    assert_eq!(flat, off(Method::Normal, |m| m.use_normal = false));
    let bump = edited(&snapshot, |s| s.mapping.method = Method::Bump);
    assert_eq!(
        bits(&picture(&bump)),
        off(Method::Parallax, |m| m.use_parallax = false)
    );
}

#[test]
fn every_wrap_rule_and_odd_size_stays_finite() {
    for size in [[1, 1], [1, 7], [3, 5], [17, 2]] {
        for wrap in Wrap::ALL {
            let mut scene = quad_with(size, waves);
            scene.uv = |p| p * 2.3;
            for slot in &mut scene.settings.materials[0].maps {
                slot.wrap = wrap;
            }
            for (name, with) in every_method(&scene.snapshot()) {
                let film = picture(&with);
                assert!(
                    film.pixels.iter().all(|c| c.is_finite()),
                    "{name}, {size:?}, {}",
                    wrap.name()
                );
            }
        }
    }
}

#[test]
fn a_chart_without_area_is_not_perturbed() {
    let mut scene = quad_with([16, 16], waves);
    scene.uv = |_| Vec2::new(0.3, 0.4);
    let snapshot = scene.snapshot();
    let flat = bits(&picture(&none(&snapshot)));
    for (name, with) in every_smooth_method(&snapshot) {
        assert_eq!(flat, bits(&picture(&with)), "{name}");
    }
}

#[test]
fn the_back_shows_the_same_relief_from_behind() {
    // Seen from below, a light from below: what is a bump above is a dent there.
    let mut scene = quad_with([64, 64], waves);
    scene.settings.camera.eye = DVec3::new(0.3, -2.0, -2.0);
    for light in &mut scene.settings.lights {
        if let reliefscope::shading::LightKind::Directional { direction } = &mut light.kind {
            *direction = DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0)) * *direction;
        }
    }
    let snapshot = scene.snapshot();
    for method in [Method::Bump, Method::Normal, Method::Slope] {
        let with = edited(&snapshot, |s| s.mapping.method = method);
        let story = reliefscope::render::probe(&with, [24, 12]).expect("inside");
        let hit = story.bounces[0].hit.as_ref().expect("hit");
        assert!(
            !hit.front && hit.n_shade[2] < 0.0 && hit.tilt_deg > 0.1,
            "{story}"
        );
    }
}
