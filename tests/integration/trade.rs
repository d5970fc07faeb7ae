//! What accuracy costs: sweeps that repeat to the bit, and the known shape of the trade on the reference plane.

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use reliefscope::measure::trade::{
    Cell, Plan, Record, Shard, Subject, TradeError, Truth, Watch, csv_table, measure, merge, page,
};
use reliefscope::render::Snapshot;
use reliefscope::scene::load::LoadOptions;
use reliefscope::surface::mapping::Method;
use reliefscope::texture::MapRole;

use crate::support::{QuadScene, heights, plain_rgb};

/// Seconds in the debug build of a slow machine.
fn tiny(methods: &[Method]) -> Plan {
    Plan {
        angles_deg: vec![20.0, 60.0],
        amplitudes: vec![1.0],
        methods: methods.to_vec(),
        rays: 300,
        size: [32, 20],
        samples: 2,
        most_samples: 8,
        timed_size: [16, 12],
        rounds: 1,
        eight_bits: true,
        ..Plan::quick()
    }
}

fn waves() -> Snapshot {
    let waves = heights(64, 64, |s, t| {
        0.5 + 0.25 * (s * 25.0).sin() + 0.25 * (t * 19.0).cos()
    });
    QuadScene::new().with_map(MapRole::Height, waves).snapshot()
}

fn reference() -> Snapshot {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/reference");
    let loaded = reliefscope::scene::open(&root.join("bump.toml"), &LoadOptions::default());
    let loaded = loaded.expect("the scene file can be read");
    Snapshot {
        scene: loaded.scene,
        size: loaded.size.expect("the scene file gives a size"),
        settings: std::sync::Arc::new(loaded.settings),
    }
}

fn swept(snapshot: Snapshot, parts: (&Plan, Option<Shard>), threads: usize) -> Record {
    let truth = Truth::suiting(&snapshot);
    let mut subject = Subject::new(snapshot, truth).expect("there is a relief");
    let watch = Watch {
        stop: &|| false,
        reached: &|_, _| {},
    };
    measure(&mut subject, "test", parts, threads, &watch).expect("threads")
}

const SOME: [Method; 5] = [
    Method::None,
    Method::Bump,
    Method::Parallax,
    Method::Relief,
    Method::Exact,
];

#[test]
fn errors_repeat_on_any_threads_and_shards() {
    let plan = tiny(&SOME);
    let whole = swept(waves(), (&plan, None), 1);
    assert!(!whole.partial && whole.cells.len() > 10);
    let again = swept(waves(), (&plan, None), 3);
    assert_eq!(whole.without_times(), again.without_times());
    let part = |index| {
        let shard = Shard { index, count: 2 };
        swept(waves(), (&plan, Some(shard)), 2)
    };
    let (first, second) = (part(1), part(2));
    let joined = merge(vec![second.clone(), first.clone()]).expect("of one sweep");
    assert_eq!(whole.without_times(), joined.without_times());
    let alone = merge(vec![second.clone(), second.clone()]).expect("twice the same");
    assert!(alone.partial, "half of it is missing");
    assert_eq!(alone.cells.len(), second.cells.len());
    let other_seed = Plan { seed: 2, ..plan };
    let other = swept(waves(), (&other_seed, None), 2);
    assert_ne!(whole.cells[2].geometry, other.cells[2].geometry);
    assert!(merge(vec![first.clone(), other]).is_err(), "another plan");
    let mut wrong = second;
    wrong.cells = first.cells.clone();
    wrong.cells[0].geometry.depth.p50 += 1e-9;
    let error = merge(vec![first, wrong]).expect_err("a contradiction");
    assert!(error.to_string().contains("different errors"), "{error}");
}

#[test]
fn records_survive_their_files() {
    let record = swept(waves(), (&tiny(&SOME), None), 2);
    let json = serde_json::to_string(&record).expect("plain numbers");
    let back: Record = serde_json::from_str(&json).expect("the same program wrote it");
    assert_eq!(record, back);
    let table = csv_table(&record);
    let mut lines = csv::Reader::from_reader(table.as_bytes());
    let names = lines.headers().expect("names").clone();
    let rows: Vec<_> = lines.records().map(|row| row.expect("a row")).collect();
    assert_eq!(rows.len(), record.cells.len());
    let column = names
        .iter()
        .position(|n| n == "uv_p95_texels")
        .expect("there");
    for (row, cell) in rows.iter().zip(&record.cells) {
        let p95: f64 = row[column].parse().expect("a number");
        assert_eq!(p95, cell.geometry.uv_texels.p95);
    }
    let html = page(&record);
    let outside = html.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    assert!(!outside.contains("http"), "the page asks for nothing else");
    assert!(html.matches("<svg").count() >= 6 && html.contains("data:image/png;base64,"));
}

#[test]
fn a_stopped_sweep_keeps_what_is_done() {
    let asked = AtomicUsize::new(0);
    let stop = || asked.fetch_add(1, Ordering::Relaxed) > 60;
    let watch = Watch {
        stop: &stop,
        reached: &|_, _| {},
    };
    let mut subject = Subject::new(waves(), Truth::default()).expect("there is a relief");
    let plan = Plan {
        angles_deg: (0..80).map(f64::from).collect(),
        ..tiny(&SOME)
    };
    let record = measure(&mut subject, "test", (&plan, None), 1, &watch).expect("threads");
    let all = plan.views().len() * 15;
    assert!(record.partial && (1..all).contains(&record.cells.len()));
    assert!(
        record.cells.iter().all(|cell| cell.cost.rays > 0.0),
        "every cell is whole"
    );
    assert!(record.notes()[0].contains("stopped"));
    assert!(page(&record).contains("the sweep was stopped"));
}

#[test]
fn on_a_curved_mesh_the_displaced_surface_is_the_truth() {
    let loaded = reliefscope::scene::open(Path::new("torus"), &LoadOptions::default());
    let loaded = loaded.expect("it is built in");
    let torus = Snapshot {
        scene: loaded.scene,
        size: [64, 40],
        settings: std::sync::Arc::new(loaded.settings),
    };
    assert_eq!(Truth::suiting(&torus), Truth::Displaced);
    assert_eq!(Truth::suiting(&waves()), Truth::Walk);
    let plan = Plan {
        samples: 2,
        most_samples: 8,
        eight_bits: false,
        ..tiny(&[Method::None, Method::Exact, Method::Displacement])
    };
    let record = swept(torus, (&plan, None), 0);
    let of = |method: Method, angle: f64| -> &Cell {
        let is = |c: &&Cell| c.variant.method == method && c.angle_deg == angle;
        record.cells.iter().find(is).expect("it was measured")
    };
    for &angle in &plan.angles_deg {
        let [none, exact, displaced] = [Method::None, Method::Exact, Method::Displacement]
            .map(|method| &of(method, angle).geometry);
        let texels = [none, exact, displaced].map(|g| g.uv_texels.p50);
        // The micro-triangles are half a texel wide, and they are all that it is off by.
        assert!(displaced.uv_texels.p95 < 0.5, "{angle}: {displaced:?}");
        assert!(texels[1] < 0.5 * texels[0], "{angle}: {texels:?}");
        assert_eq!(displaced.silhouette_iou, Some(1.0), "{angle}");
        let flat = none.silhouette_iou.expect("the truth has an outline");
        assert!(flat > 0.8 && flat <= 1.0, "{angle}: {flat}");
        assert!(displaced.shadow_disagreement < none.shadow_disagreement);
        // Only where normals of micro-triangles and of the surface between them turn to different sides.
        assert!(
            displaced
                .shadow_disagreement
                .is_some_and(|share| share < 0.03),
            "{angle}: {displaced:?}"
        );
    }
    let doubt = record.views.iter().map(|view| view.truth_doubt_texels);
    assert!(doubt.fold(0.0, f64::max) < 1e-3);
}

#[test]
fn without_a_relief_nothing_is_measured() {
    let flat = QuadScene::new().snapshot();
    let error = Subject::new(flat, Truth::default()).expect_err("no height map");
    assert!(matches!(error, TradeError::NoRelief), "{error}");
    let only_color = plain_rgb(2, 2, [200, 100, 50]);
    let colored = QuadScene::new().with_map(MapRole::Albedo, only_color);
    assert!(Subject::new(colored.snapshot(), Truth::default()).is_err());
}

/// The cell of a method's usual variant, or of the one whose relief does not shadow itself.
fn cell(record: &Record, method: Method, angle_deg: f64, (amplitude, bare): (f64, bool)) -> &Cell {
    let is_it = |c: &&Cell| {
        let steps = c
            .variant
            .steps
            .is_none_or(|n| n == 32 || method == Method::Iterative);
        let own = c.variant.method == method && c.variant.is_bare() == bare && steps;
        own && c.angle_deg == angle_deg && c.amplitude == amplitude && c.bits == 16
    };
    record.cells.iter().find(is_it).expect("was measured")
}

/// What the literature says of the trade, on a plane with a photographed relief.
#[test]
fn the_known_shape_comes_out_on_the_reference_plane() {
    let plan = Plan {
        angles_deg: vec![15.0, 45.0, 75.0],
        amplitudes: vec![0.25, 1.0, 2.0],
        methods: Method::ALL.to_vec(),
        rays: 1500,
        size: [96, 54],
        samples: 8,
        most_samples: 32,
        timed_size: [16, 9],
        rounds: 1,
        ..Plan::quick()
    };
    let record = swept(reference(), (&plan, None), 0);
    let texels = |method, angle, amplitude| {
        cell(&record, method, angle, (amplitude, false))
            .geometry
            .uv_texels
    };
    let looks = |method, angle| cell(&record, method, angle, (1.0, false)).picture;
    for angle in [15.0, 45.0, 75.0] {
        for amplitude in [0.25, 1.0, 2.0] {
            for method in [Method::Exact, Method::Displacement] {
                let found = texels(method, angle, amplitude);
                let what = format!("{method:?} at {angle}°, ×{amplitude}: {found:?}");
                assert!(found.p95 < 0.05, "{what}");
            }
            let [none, bump] = [Method::None, Method::Bump].map(|m| texels(m, angle, amplitude));
            assert_eq!(none, bump, "neither moves a texture coordinate");
        }
        let exact = cell(&record, Method::Exact, angle, (1.0, false));
        assert!(
            exact.picture.linear_rmse < 1e-6,
            "on a flat chart it is the truth: {:?}",
            exact.picture
        );
        assert!(exact.geometry.shadow_disagreement.is_some_and(|s| s < 0.01));
    }
    // Tilted normals do not help where the relief shifts.
    let [none, bump] = [Method::None, Method::Bump].map(|m| looks(m, 75.0));
    let (a, b) = (
        none.psnr_db.expect("differs"),
        bump.psnr_db.expect("differs"),
    );
    assert!((a - b).abs() < 2.0, "none {a} dB, bump {b} dB at 75°");
    // Offset helps from above, and runs away later.
    assert!(texels(Method::Parallax, 15.0, 1.0).rms < 0.5 * texels(Method::None, 15.0, 1.0).rms);
    assert!(texels(Method::Parallax, 75.0, 1.0).rms > 0.7 * texels(Method::None, 75.0, 1.0).rms);
    // Limited: worse on shallow relief, better on deep relief from aside.
    let [plain, limited] = [Method::Parallax, Method::ParallaxLimited];
    assert!(texels(limited, 45.0, 0.25).p50 > texels(plain, 45.0, 0.25).p50);
    assert!(texels(limited, 75.0, 2.0).rms < texels(plain, 75.0, 2.0).rms);
    // Without its own shadows even the exact place looks wrong.
    let bare = cell(&record, Method::Exact, 45.0, (1.0, true));
    let relief = cell(&record, Method::Relief, 45.0, (1.0, false));
    assert!(bare.geometry.uv_texels.p95 < 0.05);
    assert!(bare.picture.psnr_db < relief.picture.psnr_db);
    assert!(bare.geometry.shadow_disagreement > relief.geometry.shadow_disagreement);
    // Bisection lands nearer than the first sample under the relief.
    assert!(texels(Method::Relief, 45.0, 1.0).p50 < texels(Method::Steep, 45.0, 1.0).p50);
}

/// Distances to the displaced plane that another renderer's march came to (tests/data/reference/README.md), within
/// one decibel.
#[test]
fn the_published_table_comes_out_against_our_own_truth() {
    let plan = Plan {
        angles_deg: vec![45.0],
        amplitudes: vec![1.0],
        methods: Method::ALL.to_vec(),
        rays: 10,
        size: [512, 288],
        samples: 4,
        most_samples: 16,
        timed_size: [16, 9],
        rounds: 1,
        ..Plan::quick()
    };
    let record = swept(reference(), (&plan, None), 0);
    for (method, bare, published) in [
        (Method::None, false, 11.8),
        (Method::Bump, false, 12.3),
        (Method::Parallax, false, 14.5),
        (Method::ParallaxLimited, false, 14.7),
        (Method::Steep, true, 22.8),
        (Method::Occlusion, true, 22.4),
        (Method::Relief, true, 22.4),
        (Method::Exact, true, 22.4),
    ] {
        let cell = cell(&record, method, 45.0, (1.0, bare));
        let psnr = cell.picture.psnr_db.expect("no method is the truth");
        assert!(
            (psnr - published).abs() < 1.0,
            "{}: {psnr} dB",
            cell.variant.label()
        );
    }
}

/// Slopes in a file, made from the normals that the plane has: the same relief, so the same look.
#[test]
fn slopes_are_measured_where_there_are_normals() {
    let methods = [Method::Bump, Method::Slope, Method::Normal];
    let plan = Plan {
        angles_deg: vec![30.0],
        eight_bits: false,
        ..tiny(&methods)
    };
    let record = swept(reference(), (&plan, None), 0);
    assert_eq!(record.left_out, Vec::<String>::new());
    let made = record.precompute.iter().find(|p| p.what.contains("slope"));
    assert!(made.is_some_and(|p| p.bytes > 1 << 20), "{made:?}");
    let [bump, slope, normal] =
        methods.map(|m| cell(&record, m, 30.0, (1.0, false)).geometry.normal_deg);
    assert!(slope.rms > 0.0);
    for other in [bump, normal] {
        let off = (slope.rms - other.rms).abs();
        assert!(off < 0.15 * other.rms, "{slope:?}, {other:?}");
    }
    // Without normals there is nothing to make it of, and the record says so.
    let record = swept(waves(), (&plan, None), 0);
    assert!(
        record
            .left_out
            .iter()
            .any(|what| what.starts_with("slope:"))
    );
    assert!(
        record
            .cells
            .iter()
            .all(|c| c.variant.method != Method::Slope)
    );
}

/// What smooths stairs is part of what a method needs beforehand.
#[test]
fn smoothed_stairs_are_told_before_what_is_made_of_them() {
    let told = |destair| {
        let mut snapshot = waves();
        let mut settings = (*snapshot.settings).clone();
        settings.materials[0].maps[0].destair = destair;
        snapshot.settings = std::sync::Arc::new(settings);
        let record = swept(snapshot, (&tiny(&[Method::Exact]), None), 1);
        let names = record.precompute.into_iter().map(|p| p.what);
        names.collect::<Vec<_>>()
    };
    let (stored, smoothed) = (told(false), told(true));
    assert_eq!(stored.len() + 1, smoothed.len());
    assert!(smoothed[0].contains("stairs"), "{smoothed:?}");
}

#[test]
fn fewer_bits_cost_accuracy() {
    // A slope so gentle that 8 bits make stairs of it.
    let ramp = heights(64, 64, |s, _| 0.5 + 0.01 * (s * 6.2).sin());
    let snapshot = QuadScene::new().with_map(MapRole::Height, ramp).snapshot();
    let record = swept(snapshot, (&tiny(&[Method::Exact]), None), 0);
    let normal = |bits| {
        let is_it = |c: &&Cell| c.bits == bits && c.angle_deg == 20.0 && !c.variant.is_bare();
        let cell = record.cells.iter().find(is_it).expect("was measured");
        cell.geometry.normal_deg.rms
    };
    assert!(
        normal(8) > 10.0 * normal(16),
        "{} and {}",
        normal(8),
        normal(16)
    );
}
