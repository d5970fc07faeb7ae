//! Reliefs that end at the border of their chart: against the sunk floor that one must see through the opening.

use std::sync::Arc;

use glam::{DVec3, Vec2};
use reliefscope::geometry::bvh::Bvh;
use reliefscope::geometry::{UvBox, UvCharts};
use reliefscope::render::{Snapshot, Visibility, probe};
use reliefscope::surface::mapping::Method;
use reliefscope::texture::MapRole;

use crate::support::{QuadScene, bits, converged, edited, heights, picture};

/// Depth of the floor under both quads.
const DEPTH: f64 = 0.3;

/// Both quads over a floor, seen from aside, with a hole for everything that looks past it.
fn sunk(method: Method) -> Snapshot {
    let mut scene = QuadScene::new().with_map(MapRole::Height, heights(16, 16, |_, _| 0.0));
    scene.settings.mapping.method = method;
    scene.settings.mapping.amplitude = Some(DEPTH);
    scene.settings.mapping.cut_at_border = true;
    // As many as it takes to come to rest.
    scene.settings.mapping.search.iterations = 64;
    scene.settings.samples = 1;
    scene.settings.camera.eye = DVec3::new(0.8, -2.4, 1.2);
    scene.snapshot()
}

/// Half the width and height of the quads; the higher first, as a ray from above meets them.
const QUADS: [(f64, f64); 2] = [(0.2, 0.4), (1.0, 0.0)];

/// The point of a ray at a height, and how far it is inside a square around the axis; negative outside.
fn crossing(origin: DVec3, dir: DVec3, z: f64, half: f64) -> (DVec3, f64) {
    let p = origin + dir * ((z - origin.z) / dir.z);
    (p, half - p.x.abs().max(p.y.abs()))
}

#[test]
fn rays_see_the_floor_through_the_opening_or_go_on() {
    let searches = [
        Method::Parallax,
        Method::Iterative,
        Method::Steep,
        Method::Occlusion,
        Method::Relief,
        Method::RelaxedCone,
        Method::Exact,
    ];
    for method in searches {
        let snapshot = sunk(method);
        let film = picture(&snapshot);
        let [mut seen, mut past, mut shadowed] = [0; 3];
        for (x, y) in (0..40).flat_map(|y| (0..48).map(move |x| (x, y))) {
            let story = probe(&snapshot, [x, y]).expect("inside");
            assert_eq!(
                story.color,
                film.at(x, y),
                "{method:?} at {x}, {y}\n{story}"
            );
            let bounce = &story.bounces[0];
            let (origin, dir) = (
                DVec3::from(bounce.origin),
                DVec3::from(bounce.dir.map(f64::from)),
            );
            let ways = QUADS.map(|(half, z)| {
                let (_, opening) = crossing(origin, dir, z, half);
                let (_, inside) = crossing(origin, dir, z - DEPTH, half);
                (opening, inside)
            });
            let unclear =
                |(opening, inside): &(f64, f64)| opening.abs() < 1e-3 || inside.abs() < 1e-3;
            if dir.z > -1e-3 || ways.iter().any(unclear) {
                continue;
            }
            let met = ways
                .iter()
                .position(|(opening, inside)| opening.min(*inside) > 0.0);
            past += usize::from(met != ways.iter().position(|(opening, _)| *opening > 0.0));
            let what = format!("{method:?} at {x}, {y}\n{story}");
            assert_eq!(bounce.hit.is_some(), met.is_some(), "{what}");
            let (Some(hit), Some(met)) = (&bounce.hit, met) else {
                continue;
            };
            // The larger quad's triangles come first.
            assert_eq!(hit.triangle < 2, met == 1, "{what}");
            seen += 1;
            for light in hit.lights.iter().filter(|_| method.searches()) {
                let wi = DVec3::from(light.wi.map(f64::from));
                // Where normals are interpolated, shadow rays start where the eye's ray entered.
                let entry = DVec3::from(hit.p);
                let (_, under) = crossing(entry, wi, QUADS[0].1, QUADS[0].0);
                if under.abs() < 1e-3 {
                    continue;
                }
                let is_under = met == 1 && under > 0.0;
                shadowed += usize::from(is_under);
                let found = matches!(light.visibility, Visibility::Shadowed { .. });
                assert_eq!(found, is_under, "{}: {what}", light.name);
                assert!(light.visibility != Visibility::ShadowedByRelief, "{what}");
            }
        }
        assert!(
            seen > 200 && past > 50,
            "{method:?}: {seen} seen, {past} past"
        );
        assert!(
            shadowed > 20 || !method.searches(),
            "{method:?}: {shadowed}"
        );
    }
}

#[test]
fn a_relief_ends_with_a_chart_that_is_no_rectangle() {
    for method in [Method::Parallax, Method::Relief, Method::Exact] {
        let mut snapshot = sunk(method);
        let scene = Arc::get_mut(&mut snapshot.scene).expect("nobody else has it");
        // The half of the larger quad below the diagonal.
        scene.mesh.indices.truncate(1);
        scene.mesh.attributes.truncate(1);
        scene.bvh = Bvh::build(&scene.mesh);
        let film = picture(&snapshot);
        let [mut seen, mut past] = [0; 2];
        for (x, y) in (0..40).flat_map(|y| (0..48).map(move |x| (x, y))) {
            let story = probe(&snapshot, [x, y]).expect("inside");
            let what = format!("{method:?} at {x}, {y}\n{story}");
            assert_eq!(story.color, film.at(x, y), "{what}");
            let bounce = &story.bounces[0];
            let dir = DVec3::from(bounce.dir.map(f64::from));
            let inside = |z: f64| {
                let (p, square) = crossing(DVec3::from(bounce.origin), dir, z, QUADS[1].0);
                square.min((p.x - p.y) * 0.5_f64.sqrt())
            };
            let (opening, floor) = (inside(0.0), inside(-DEPTH));
            if dir.z > -1e-3 || opening.abs() < 1e-3 || floor.abs() < 1e-3 {
                continue;
            }
            assert_eq!(bounce.hit.is_some(), opening.min(floor) > 0.0, "{what}");
            seen += usize::from(bounce.hit.is_some());
            past += usize::from(opening > 0.0 && floor < 0.0);
        }
        assert!(
            seen > 100 && past > 30,
            "{method:?}: {seen} seen, {past} past"
        );
    }
}

#[test]
fn light_over_the_border_is_not_in_the_shadow_of_relief_that_ended() {
    // A wall near the right border: the next copy of the picture has it on the left.
    let wall = |s, _| if (0.85..0.93).contains(&s) { 1.0 } else { 0.0 };
    let map = heights(64, 64, wall);
    let mut scene = QuadScene::new().with_map(MapRole::Height, map);
    scene.settings.mapping.method = Method::Exact;
    scene.settings.mapping.amplitude = Some(0.1);
    scene.settings.samples = 1;
    // From the left, low.
    scene.settings.lights[1].kind = reliefscope::shading::LightKind::Directional {
        direction: DVec3::new(0.9, 0.0, -0.3),
    };
    let endless = scene.snapshot();
    let ended = edited(&endless, |s| s.mapping.cut_at_border = true);
    let mut lit = 0;
    for (x, y) in (0..40).flat_map(|y| (0..48).map(move |x| (x, y))) {
        let [before, after] = [&endless, &ended].map(|snapshot| {
            let story = probe(snapshot, [x, y]).expect("inside");
            let hit = story.bounces[0].hit.clone();
            hit.map(|hit| (hit.triangle, hit.uv_moved, hit.lights[0].visibility))
        });
        let (Some((0..2, Some([u, _]), before)), Some((_, _, after))) = (before, after) else {
            continue;
        };
        if u < 0.05 && before == Visibility::ShadowedByRelief {
            assert_eq!(after, Visibility::Visible, "{x}, {y}: u {u}");
            lit += 1;
        }
    }
    assert!(lit > 5, "{lit}");
}

#[test]
fn nothing_is_asked_where_reliefs_go_on() {
    let cut = sunk(Method::Exact);
    let whole = edited(&cut, |s| s.mapping.cut_at_border = false);
    let renderer = converged(&whole, 2);
    assert_eq!(renderer.counters().cutout_tests, 0);
    assert_eq!(whole.scene.uv_charts.bytes(), 0, "nobody needs charts");
    // The same where nothing moves the texture coordinate.
    for method in [Method::None, Method::Bump, Method::Displacement] {
        let [cut, whole] = [&cut, &whole].map(|s| edited(s, |s| s.mapping.method = method));
        assert_eq!(bits(&picture(&cut)), bits(&picture(&whole)), "{method:?}");
    }
    assert_eq!(whole.scene.uv_charts.bytes(), 0, "nobody needs charts");
    assert!(converged(&cut, 2).counters().cutout_tests > 0);
    assert!(cut.scene.uv_charts.bytes() > 0);
}

#[test]
fn a_chart_is_what_shares_corners() {
    let snapshot = sunk(Method::Exact);
    let charts = UvCharts::new(&snapshot.scene.mesh);
    assert_eq!(charts.len(), 2, "two quads");
    let [large, small] = [0, 3].map(|prim| charts.chart(prim).around);
    assert_eq!(charts.chart(1).around, large);
    let square = |low: f32, high: f32| UvBox {
        low: Vec2::splat(low),
        high: Vec2::splat(high),
    };
    assert_eq!(large, square(0.0, 1.0));
    assert_eq!(small, square(0.4, 0.6));
    assert_eq!(large.exit([0.25, 0.5], [0.5, -1.0]), 0.5);
    assert_eq!(large.exit([0.25, 0.5], [0.0, 0.0]), f64::INFINITY);
}
