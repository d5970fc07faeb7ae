//! What is known of pixels beside their colours: the same as one pixel's story and as the counters tell.

use glam::{Vec2, Vec3};
use reliefscope::geometry::{Kernel, OffsetRule};
use reliefscope::math::LinearRgb;
use reliefscope::measure::error_map::{ErrorMetric, ErrorSummary, Shown, error_map};
use reliefscope::render::{
    Legend, PassEnd, PixelRecord, Progressive, Recording, Records, Snapshot, probe,
};
use reliefscope::scene::View;
use reliefscope::scene::built_in;
use reliefscope::scene::load::LoadOptions;
use reliefscope::surface::mapping::{Lookup, Method};
use reliefscope::texture::MapRole;

use crate::support::{QuadScene, bits, converged, edited, heights, plain_float};

/// Hills, with a normal map that leans, seen from the side.
fn hills() -> Snapshot {
    let relief = heights(24, 16, |s, t| {
        0.5 + 0.5 * (s * 19.0).sin() * (t * 13.0).cos()
    });
    let scene = QuadScene::new()
        .with_map(MapRole::Height, relief)
        .with_map(MapRole::Normal, plain_float(4, 4, [0.8, 0.4, 0.7]));
    let mut snapshot = scene.snapshot();
    snapshot = edited(&snapshot, |settings| settings.samples = 1);
    snapshot
}

fn by(snapshot: &Snapshot, method: Method) -> Snapshot {
    edited(snapshot, |settings| settings.mapping.method = method)
}

fn recorder(snapshot: &Snapshot, threads: usize) -> Progressive {
    let mut renderer = Progressive::new(threads).expect("threads");
    renderer.record(Recording::Pixels);
    renderer.start(snapshot.clone());
    renderer
}

fn records(snapshot: &Snapshot) -> Records {
    let mut renderer = recorder(snapshot, 2);
    assert_eq!(renderer.pass(&|| false), PassEnd::Complete);
    renderer.records().expect("records")
}

fn at(records: &Records, [x, y]: [u32; 2]) -> PixelRecord {
    records.pixels[(y * records.size[0] + x) as usize]
}

#[test]
fn records_tell_what_the_story_tells() {
    let snapshot = hills();
    for method in Method::ALL {
        let snapshot = by(&snapshot, method);
        let records = records(&snapshot);
        let mut hits = 0;
        for pixel in [[3, 3], [20, 20], [30, 25], [47, 39], [24, 12], [11, 30]] {
            let record = at(&records, pixel);
            let story = probe(&snapshot, pixel).expect("in the picture");
            let Some(hit) = &story.bounces[0].hit else {
                assert_eq!((record.material, record.uv), (None, None));
                continue;
            };
            hits += 1;
            let place = format!("{} {pixel:?}", method.name());
            assert_eq!(record.material, Some(0), "{place}");
            assert_eq!(record.normal.to_array(), hit.n_shade, "{place}");
            assert_eq!(record.smooth_normal.to_array(), hit.n_smooth, "{place}");
            if let Some(uv) = hit.uv_moved {
                assert_eq!(record.uv, Some(Vec2::from(uv)), "{place}");
            }
            assert!(record.uv.is_some() && record.height.is_some(), "{place}");
            assert_eq!(
                record.steps > 0,
                method.searches() || method == Method::Displacement
            );
        }
        assert!(hits >= 4, "{}: {hits}", method.name());
    }
}

#[test]
fn costs_add_up_to_the_counters() {
    // Mirrors, colours, shadows of two lights and of the relief.
    let snapshot = edited(&hills(), |settings| {
        settings.materials[0].reflectivity = 0.3;
    });
    for method in Method::ALL {
        let snapshot = by(&snapshot, method);
        let mut renderer = recorder(&snapshot, 2);
        renderer.pass(&|| false);
        let counters = renderer.counters();
        let records = renderer.records().expect("records");
        let cost: u64 = records.pixels.iter().map(|p| u64::from(p.cost)).sum();
        let work = counters.rays() + counters.texture_fetches + counters.relief_steps;
        assert_eq!(cost, work, "{}", method.name());
        assert!(counters.mirror_rays > 0 && counters.shadow_rays > 0);
    }
}

#[test]
fn records_repeat_and_change_no_pixel() {
    for method in [Method::Exact, Method::Displacement, Method::ParallaxLimited] {
        let snapshot = by(&hills(), method);
        let mut plain = Progressive::new(1).expect("threads");
        plain.start(snapshot.clone());
        plain.pass(&|| false);
        assert_eq!(plain.records(), None);
        let mut renderer = recorder(&snapshot, 3);
        // Previews hand their hits on, which must not show in what the picture costs.
        renderer.preview(4, &|| false);
        let preview = renderer.records().expect("records");
        renderer.pass(&|| false);
        assert_eq!(bits(&renderer.picture()), bits(&plain.picture()));
        let first = renderer.records().expect("records");
        assert_eq!(first, records(&snapshot), "{method:?}");
        assert_eq!((preview.size, first.size), ([12, 10], [48, 40]));
        for (x, y) in (0..10).flat_map(|y| (0..12).map(move |x| (x, y))) {
            let coarse = PixelRecord {
                samples: 1,
                ..at(&preview, [x, y])
            };
            assert_eq!(coarse, at(&first, [4 * x, 4 * y]), "{method:?} {x} {y}");
        }
        // Kept hits must not show either.
        renderer.start(edited(&snapshot, |settings| {
            settings.lights[0].intensity *= 2.0
        }));
        renderer.pass(&|| false);
        assert!(renderer.reuses_hits());
        assert_eq!(renderer.records().expect("records"), first, "{method:?}");
        renderer.record(Recording::Nothing);
        renderer.start(snapshot.clone());
        renderer.pass(&|| false);
        assert_eq!(renderer.records(), None);
    }
}

#[test]
fn samples_are_counted() {
    let snapshot = edited(&hills(), |settings| settings.samples = 3);
    let mut renderer = recorder(&snapshot, 1);
    for samples in 1..=3 {
        renderer.pass(&|| false);
        let records = renderer.records().expect("records");
        assert!(records.pixels.iter().all(|p| p.samples == samples));
    }
}

#[test]
fn places_on_a_plain_relief_are_known() {
    // A floor half way down: every search that is right finds depth 0.5 and the stored height.
    let floor = heights(8, 8, |_, _| 0.5);
    let snapshot = QuadScene::new().with_map(MapRole::Height, floor).snapshot();
    for method in [Method::Exact, Method::Relief, Method::Displacement] {
        let records = records(&by(&snapshot, method));
        let seen = at(&records, [20, 30]);
        assert!((seen.depth - 0.5).abs() < 0.01, "{method:?} {seen:?}");
        assert!(
            (seen.height.unwrap_or(0.0) - 0.5).abs() < 1e-3,
            "{method:?}"
        );
    }
    let bumped = at(&records(&by(&snapshot, Method::Bump)), [20, 30]);
    assert_eq!((bumped.depth, bumped.steps), (0.0, 0));
    let [yardstick] = records(&snapshot).yardsticks[..] else {
        panic!("one material");
    };
    assert_eq!(yardstick.texels_per_uv, Vec2::new(8.0, 8.0));
    assert_eq!(yardstick.turns_per_uv, Vec2::ONE);
}

/// Mean and 95th percentile of a metric between two methods.
fn apart(snapshot: &Snapshot, metric: ErrorMetric, methods: [Method; 2]) -> ErrorSummary {
    let [a, b] = methods.map(|method| records(&by(snapshot, method)));
    let pixels = vec![[0; 4]; a.pixels.len()];
    let shown = |records| Shown {
        pixels: &pixels,
        records: Some(records),
    };
    let map = error_map(metric, [shown(&a), shown(&b)], a.size[0] as usize, 1);
    ErrorSummary::of(metric, &map)
}

#[test]
fn better_searches_are_nearer_to_the_truth() {
    let snapshot = hills();
    for metric in [
        ErrorMetric::Uv,
        ErrorMetric::Depth,
        ErrorMetric::NormalAngle,
    ] {
        let from_truth = |method| apart(&snapshot, metric, [method, Method::Displacement]);
        let [none, steep, exact] = [Method::Bump, Method::Steep, Method::Exact].map(from_truth);
        let said = format!("{metric:?} {none:?} {steep:?} {exact:?}");
        // Means hold the few pixels along borders, where a little decides what is seen at all.
        assert!(exact.p95 <= 0.1 * none.p95 && none.p95 > 0.0, "{said}");
        assert!(exact.p95 <= steep.p95 && steep.p95 < none.p95, "{said}");
        assert!(exact.mean < none.mean, "{said}");
        let same = apart(&snapshot, metric, [Method::Exact; 2]);
        assert_eq!((same.mean, same.p95, same.lone), (0.0, 0.0, 0));
    }
}

#[test]
fn normals_that_cannot_be_are_marked() {
    let leaning = plain_float(4, 4, [1.0, 0.5, 0.55]);
    let scene = QuadScene::new().with_map(MapRole::Normal, leaning);
    let snapshot = edited(&scene.snapshot(), |settings| {
        settings.mapping.method = Method::Normal;
        settings.mapping.lookup = Lookup::Normal;
        settings.camera.eye.x = -2.5;
    });
    let marked = |records: &Records| records.pixels.iter().filter(|p| p.invalid_normal).count();
    let found = records(&snapshot);
    let mut checked = 0;
    for (i, record) in found.pixels.iter().enumerate().step_by(7) {
        let pixel = [i as u32 % found.size[0], i as u32 / found.size[0]];
        let story = probe(&snapshot, pixel).expect("in the picture");
        let Some(hit) = &story.bounces[0].hit else {
            continue;
        };
        let n = Vec3::from(hit.n_shade);
        let wo = -Vec3::from(story.bounces[0].dir);
        let valid = n.dot(wo) > 0.0 && n.dot(Vec3::from(hit.n_geo)) > 0.0;
        assert_eq!(record.invalid_normal, !valid, "{pixel:?}");
        checked += 1;
    }
    assert!(checked > 10 && marked(&found) > 100, "{}", marked(&found));
    assert_eq!(marked(&records(&by(&snapshot, Method::None))), 0);
    let legend = Legend::of(View::InvalidNormals, &[&found]).expect("a legend");
    assert_eq!(legend.marked, marked(&found) as u64);
}

#[test]
fn samples_that_are_no_numbers_are_marked() {
    let snapshot = edited(&hills(), |settings| {
        settings.materials[0].kd = LinearRgb::new(f32::NAN, 0.5, 0.5);
    });
    let mut renderer = recorder(&snapshot, 1);
    renderer.pass(&|| false);
    let records = renderer.records().expect("records");
    let marked = records.pixels.iter().filter(|p| p.non_finite).count() as u64;
    assert_eq!(marked, renderer.counters().non_finite);
    assert!(marked > 100);
    assert!(
        records
            .pixels
            .iter()
            .all(|p| !p.non_finite || p.material.is_some())
    );
}

#[test]
fn searches_that_stopped_short_are_marked() {
    let cones = |layers| {
        let snapshot = edited(&by(&hills(), Method::RelaxedCone), |settings| {
            settings.mapping.search.layers = layers;
        });
        let records = records(&snapshot);
        records.pixels.iter().filter(|p| p.at_the_cap).count()
    };
    assert!(cones(1) > 100, "{}", cones(1));
    assert_eq!(cones(4096), 0);
    assert!(
        records(&by(&hills(), Method::Exact))
            .pixels
            .iter()
            .all(|p| !p.at_the_cap)
    );
}

#[test]
fn every_built_in_scene_has_records_by_every_method() {
    for scene in built_in::SCENES {
        let loaded = built_in::built_in(scene.name, &LoadOptions::default()).expect("built in");
        for method in [Method::Exact, Method::Displacement, Method::Normal] {
            let snapshot = Snapshot {
                scene: loaded.scene.clone(),
                settings: loaded.settings.clone().into(),
                size: [40, 30],
            };
            let records = records(&by(&snapshot, method));
            let name = scene.name;
            assert_eq!(records.pixels.len(), 1200);
            assert!(
                records.pixels.iter().any(|p| p.material.is_some()),
                "{name}"
            );
            for pixel in &records.pixels {
                let unit = pixel.material.is_none() || (pixel.normal.length() - 1.0).abs() < 1e-3;
                assert!(
                    unit && pixel.depth.is_finite() && !pixel.non_finite,
                    "{name} {pixel:?}"
                );
                assert!(pixel.depth.abs() < 1.5, "{name} {method:?} {pixel:?}");
            }
        }
    }
}

/// The scene of that name, small; normalised or not.
fn extremes(name: &str, normalize: bool) -> Snapshot {
    let options = LoadOptions {
        normalize,
        ..LoadOptions::default()
    };
    let loaded = built_in::built_in(name, &options).expect("built in");
    Snapshot {
        scene: loaded.scene,
        settings: loaded.settings.into(),
        size: [64, 48],
    }
}

/// Pixels with leaks and with false shadows.
fn mistakes(snapshot: &Snapshot, kernel: Kernel, offset_rule: OffsetRule) -> [usize; 2] {
    let mut renderer = Progressive::new(2).expect("threads");
    renderer.record(Recording::Suspect(kernel, offset_rule));
    renderer.start(snapshot.clone());
    renderer.pass(&|| false);
    let pixels = renderer.records().expect("records").pixels;
    [
        pixels.iter().filter(|p| p.leak).count(),
        pixels.iter().filter(|p| p.false_shadow).count(),
    ]
}

#[test]
fn textbooks_fail_where_numbers_run_out_and_the_program_does_not() {
    let places = [
        ("extremes", true),
        ("extremes@1e-12", false),
        ("extremes@1e6", false),
        ("extremes@1e15,1e6", true),
    ];
    for (name, normalize) in places {
        for method in [Method::Bump, Method::Exact, Method::Displacement] {
            let snapshot = by(&extremes(name, normalize), method);
            let own = mistakes(&snapshot, Kernel::Watertight, OffsetRule::Bound);
            assert_eq!(own, [0, 0], "{name} {method:?}");
        }
    }
    // Products of coordinates of 10^-12 vanish: nearly everything is missed.
    let tiny = extremes("extremes@1e-12", false);
    let [leaks, _] = mistakes(&tiny, Kernel::Report, OffsetRule::Bound);
    assert!(leaks > 500, "{leaks}");
    // An offset of 10^-4 is nothing beside coordinates of 10^6.
    let large = extremes("extremes@1e6", false);
    let [leaks, shadows] = mistakes(&large, Kernel::Watertight, OffsetRule::Fixed);
    assert!(leaks == 0 && shadows > 100, "{leaks} {shadows}");
    // Centred and scaled first, the same place is no extreme.
    let [_, shadows] = mistakes(
        &extremes("extremes@1e6", true),
        Kernel::Watertight,
        OffsetRule::Fixed,
    );
    assert!(shadows < 10, "{shadows}");
}

#[test]
fn a_placement_changes_no_picture() {
    let render = |name| {
        let snapshot = edited(&extremes(name, true), |settings| settings.samples = 1);
        converged(&snapshot, 2).picture()
    };
    let plain = render("extremes");
    for name in ["extremes@1e-15", "extremes@1e15", "extremes@1e3,1e6"] {
        let placed = render(name);
        let pairs = plain.pixels.iter().zip(&placed.pixels);
        let differ = |(a, b): &(&LinearRgb, &LinearRgb)| {
            let [a, b] = [a.to_array(), b.to_array()];
            a.iter().zip(b).any(|(a, b)| (a - b).abs() > 0.02)
        };
        let different = pairs.filter(differ).count();
        // Single floats of normals and light are rounded elsewhere: pixels on edges may differ.
        assert!(different < 30, "{name}: {different} pixels");
    }
}
