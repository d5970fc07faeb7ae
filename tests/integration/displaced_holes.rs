//! Holes in displaced surfaces: with a relief that displaces nothing, they are those of the mesh.

use std::sync::Arc;

use glam::Vec3;
use reliefscope::render::{PixelStory, Snapshot, Visibility, probe};
use reliefscope::surface::mapping::Method;
use reliefscope::texture::{MapRole, RawImage};

use crate::support::{QuadScene, bits, converged, edited, heights, picture};

/// Black and white squares, eight in a row.
fn squares() -> RawImage {
    heights(64, 64, |s, t| {
        if ((s * 8.0) as i32 + (t * 8.0) as i32) % 2 == 0 {
            1.0
        } else {
            0.0
        }
    })
}

/// Both quads, chequered with holes, displaced by nothing: walked as flat reliefs, or cut up because their normals lean
/// apart.
fn chequered(is_flat: bool, holes: bool) -> Snapshot {
    let mut scene = QuadScene::new().with_map(MapRole::Height, heights(16, 16, |_, _| 1.0));
    if holes {
        scene = scene.with_map(MapRole::Opacity, squares());
    }
    scene.settings.mapping.method = Method::Displacement;
    scene.settings.samples = 1;
    let mut snapshot = scene.snapshot();
    if !is_flat {
        let scene = Arc::get_mut(&mut snapshot.scene).expect("nobody else has it");
        for (normal, position) in scene.mesh.normals.iter_mut().zip(&scene.mesh.positions) {
            *normal = (Vec3::Z + position.truncate().extend(0.0) * 0.1).normalize_or(Vec3::Z);
        }
    }
    snapshot
}

/// The triangle that is seen, and whether another stands between it and each light.
fn seen(story: &PixelStory) -> Option<(u32, Vec<bool>)> {
    let hit = story.bounces[0].hit.as_ref()?;
    let is_shadowed = |v: Visibility| matches!(v, Visibility::Shadowed { .. });
    let shadows = hit.lights.iter().map(|l| is_shadowed(l.visibility));
    Some((hit.triangle, shadows.collect()))
}

#[test]
fn rays_go_through_holes_of_displaced_surfaces() {
    for (is_flat, memory) in [(true, 0), (false, 0), (false, 256)] {
        let snapshot = edited(&chequered(is_flat, true), |s| {
            s.mapping.displacement_memory = memory;
        });
        let plain = edited(&snapshot, |s| s.mapping.method = Method::None);
        let film = picture(&snapshot);
        let (mut other, [mut missed, mut shadowed]) = (Vec::new(), [0; 2]);
        for (x, y) in (0..40).flat_map(|y| (0..48).map(move |x| (x, y))) {
            let story = probe(&snapshot, [x, y]).expect("inside");
            let what = format!("flat {is_flat}, {memory} MiB, {x}, {y}\n{story}");
            assert_eq!(story.color, film.at(x, y), "{what}");
            let found = seen(&story);
            let expected = seen(&probe(&plain, [x, y]).expect("inside"));
            missed += usize::from(found.is_none());
            if let Some((_, shadows)) = &found {
                shadowed += shadows.iter().filter(|s| **s).count();
            }
            if found != expected {
                other.push([x, y]);
            }
        }
        // A ray to within rounding of the rim of a hole may go either way.
        assert!(other.len() <= 4, "flat {is_flat}, {memory} MiB: {other:?}");
        // Through one hole and through two, and light through holes, too.
        assert!(missed > 300 && shadowed > 20, "{missed}, {shadowed}");
        let tests = converged(&snapshot, 2).counters().cutout_tests;
        assert!(tests > 500, "flat {is_flat}, {memory} MiB: {tests}");
    }
}

#[test]
fn a_relief_that_displaces_nothing_is_met() {
    for is_flat in [true, false] {
        let snapshot = chequered(is_flat, false);
        let plain = edited(&snapshot, |s| s.mapping.method = Method::None);
        for (x, y) in (0..40).flat_map(|y| (0..48).map(move |x| (x, y))) {
            let [found, expected] =
                [&snapshot, &plain].map(|s| seen(&probe(s, [x, y]).expect("inside")));
            let what = format!("flat {is_flat}, {x}, {y}");
            assert_eq!(found, expected, "{what}");
        }
    }
}

#[test]
fn a_map_of_holes_without_any_changes_nothing() {
    for is_flat in [true, false] {
        let whole = chequered(is_flat, false);
        let mut scene = QuadScene::new()
            .with_map(MapRole::Height, heights(16, 16, |_, _| 1.0))
            .with_map(MapRole::Opacity, heights(4, 4, |_, _| 1.0));
        scene.settings = (*whole.settings).clone();
        let slot = reliefscope::texture::MapSlot::new(1, MapRole::Opacity);
        scene.settings.materials[0].maps.push(slot);
        let mut solid = scene.snapshot();
        let scene = Arc::get_mut(&mut solid.scene).expect("nobody else has it");
        scene.mesh = whole.scene.mesh.clone();
        assert_eq!(bits(&picture(&whole)), bits(&picture(&solid)));
        assert_eq!(converged(&whole, 2).counters().cutout_tests, 0);
    }
}
