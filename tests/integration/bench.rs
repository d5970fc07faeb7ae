//! The `bench` command: rays are those that the renderer sends, files come back, answers are right, and the
//! table has its shape. No test looks at a time.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::Arc;

use glam::Vec3;
use reliefscope::geometry::bvh::{AcceptAll, Bvh};
use reliefscope::geometry::simd::SimdLevel;
use reliefscope::geometry::triangle::Watertight;
use reliefscope::measure::bench::ray_file::{RayFileError, read_rays, write_hits, write_rays};
use reliefscope::measure::bench::{FrameCase, RayRace, grid_scene, scalar_twin};
use reliefscope::render::{
    Counters, PixelStory, Progressive, RayKind, RayList, Snapshot, Visibility, probe, rays_of,
};
use reliefscope::scene::load::LoadOptions;
use reliefscope::scene::open;
use reliefscope::surface::mapping::Method;
use serde_json::Value;

use crate::scene_file::Folder;
use crate::support::edited;

fn built_in(name: &str, size: [u32; 2]) -> Snapshot {
    let loaded = open(Path::new(name), &LoadOptions::default()).unwrap();
    Snapshot {
        scene: loaded.scene,
        settings: Arc::new(loaded.settings),
        size,
    }
}

fn counted(snapshot: &Snapshot) -> Counters {
    let mut renderer = Progressive::new(2).unwrap();
    renderer.start(snapshot.clone());
    renderer.pass(&|| false);
    renderer.counters()
}

#[test]
fn as_many_rays_are_listed_as_the_renderer_counts() {
    let deep = |s: &Snapshot| edited(s, |s| s.shading.max_bounces = 8);
    let cases = [
        built_in("wall", [100, 37]),
        deep(&built_in("mirrors", [97, 64])),
        edited(&built_in("torus", [70, 40]), |s| {
            s.mapping.method = Method::Parallax;
        }),
        edited(&built_in("wall", [40, 30]), |s| s.shading.shadows = false),
        edited(&built_in("mirrors", [40, 30]), |s| {
            s.shading.max_bounces = 0
        }),
        grid_scene(20, [33, 9]),
    ];
    for (i, snapshot) in cases.iter().enumerate() {
        let counters = counted(snapshot);
        let [camera, point, sun, mirror] =
            RayKind::ALL.map(|kind| rays_of(snapshot, kind).active() as u64);
        assert_eq!(camera, counters.camera_rays, "camera, case {i}");
        assert_eq!(point + sun, counters.shadow_rays, "shadow, case {i}");
        assert_eq!(mirror, counters.mirror_rays, "mirror, case {i}");
    }
    assert!(counted(&cases[1]).mirror_rays > 1000, "there are mirrors");
}

type Bits = [u32; 3];

fn directions(list: &RayList) -> Vec<Bits> {
    let rays = list.rays.iter().zip(&list.t_max);
    let active = rays.filter(|(_, t_max)| RayList::is_active(**t_max));
    active
        .map(|(ray, _)| ray.dir.to_array().map(f32::to_bits))
        .collect()
}

/// The stories of a picture of one tile, pixels in blocks of 8 × 8.
fn stories(snapshot: &Snapshot) -> Vec<PixelStory> {
    let [width, height] = snapshot.size;
    let mut pixels: Vec<_> = (0..height)
        .flat_map(|y| (0..width).map(move |x| [x, y]))
        .collect();
    pixels.sort_by_key(|&[x, y]| (y / 8, x / 8, y % 8, x % 8));
    let story = |pixel| probe(snapshot, pixel).unwrap();
    pixels.into_iter().map(story).collect()
}

#[test]
fn the_listed_rays_are_those_of_the_stages() {
    for name in ["mirrors", "wall"] {
        let snapshot = built_in(name, [28, 20]);
        let stories = stories(&snapshot);
        let bits = |dir: [f32; 3]| dir.map(f32::to_bits);
        let camera: Vec<_> = stories.iter().map(|s| bits(s.bounces[0].dir)).collect();
        assert!(directions(&rays_of(&snapshot, RayKind::Camera)) == camera);

        let sorted = |mut bits: Vec<Bits>| {
            bits.sort_unstable();
            bits
        };
        let mirrors = stories.iter().flat_map(|s| &s.bounces[1..]);
        let mirrors = sorted(mirrors.map(|b| bits(b.dir)).collect());
        let listed = rays_of(&snapshot, RayKind::Mirror);
        assert!(sorted(directions(&listed)) == mirrors, "{name}");

        let hits = stories.iter().flat_map(|s| &s.bounces);
        let lights = hits
            .filter_map(|b| b.hit.as_ref())
            .flat_map(|hit| &hit.lights);
        let towards = |far: bool| {
            let lights = lights
                .clone()
                .filter(|l| l.visibility != Visibility::Behind && l.distance.is_none() == far);
            sorted(lights.map(|l| bits(l.wi)).collect())
        };
        for (kind, far) in [(RayKind::PointShadow, false), (RayKind::SunShadow, true)] {
            let listed = rays_of(&snapshot, kind);
            assert!(
                sorted(directions(&listed)) == towards(far),
                "{name} {kind:?}"
            );
        }
    }
}

#[test]
fn pixels_keep_their_places() {
    // Two tiles side by side; one light of each kind.
    let snapshot = grid_scene(20, [40, 16]);
    for kind in [RayKind::Camera, RayKind::PointShadow, RayKind::SunShadow] {
        assert_eq!(rays_of(&snapshot, kind).rays.len(), 40 * 16, "{kind:?}");
    }
    assert_eq!(rays_of(&snapshot, RayKind::Mirror).active(), 0);
}

#[test]
fn files_of_rays_come_back_to_the_bit() {
    let folder = Folder::new();
    let path = folder.path("a.rays");
    let snapshot = built_in("mirrors", [40, 24]);
    let mesh = &snapshot.scene.mesh;
    for kind in RayKind::ALL {
        let list = rays_of(&snapshot, kind);
        write_rays(&path, kind, mesh, &list).unwrap();
        let file = read_rays(&path).unwrap();
        assert_eq!((&*file.kind, file.query), (kind.name(), kind.query()));
        assert_eq!(file.mesh.len(), mesh.len());
        for prim in 0..mesh.len() as u32 {
            assert_eq!(file.mesh.corners(prim), mesh.corners(prim));
        }
        let back = file.list();
        assert!(back.t_max == list.t_max, "{kind:?}");
        assert!(back.rays == list.rays, "{kind:?}");

        // Same triangles in the same order, same rays: the same answers.
        let of = |bvh: &Bvh| {
            let (list, query) = (&back, kind.query());
            RayRace { bvh, list, query }.check().unwrap()
        };
        assert!(of(&Bvh::build(&file.mesh)) == of(&snapshot.scene.bvh));
    }
}

/// A file with the given first line and numbers.
fn file_of(folder: &Folder, line: &str, numbers: &[f32]) -> PathBuf {
    let mut bytes = format!("{line}\n").into_bytes();
    bytes.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
    let path = folder.path("made.rays");
    std::fs::write(&path, bytes).unwrap();
    path
}

const TRIANGLE: [f32; 9] = [0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 4.0, 0.0];

/// A ray from z = 3 that goes down two units at a time.
fn ray(t_min: f32, t_max: f32) -> [f32; 8] {
    [1.0, 1.0, 3.0, t_min, 0.0, 0.0, -2.0, t_max]
}

fn records(path: &Path) -> Vec<(f32, u32, f32, f32)> {
    let word = |bytes: &[u8]| u32::from_le_bytes(bytes.try_into().unwrap());
    let float = |bytes: &[u8]| f32::from_bits(word(bytes));
    let bytes = std::fs::read(path).unwrap();
    assert_eq!(bytes.len() % 16, 0);
    let record = |b: &[u8]| {
        let (t, u, v) = (float(&b[..4]), float(&b[8..12]), float(&b[12..]));
        (t, word(&b[4..8]), u, v)
    };
    bytes.chunks(16).map(record).collect()
}

#[test]
fn distances_are_told_in_the_files_units() {
    let folder = Folder::new();
    let inf = f32::INFINITY;
    let rays = [
        ray(0.0, inf),
        ray(1.0, inf),
        ray(0.0, 1.6),
        ray(1.6, inf),
        ray(0.0, 1.4),
        ray(2.0, 1.0),
        ray(f32::NAN, inf),
        ray(0.0, f32::NAN),
    ];
    let numbers = [&TRIANGLE[..], rays.as_flattened()].concat();
    for (query, hit) in [
        ("closest", (1.5, 0, 0.25, 0.25)),
        ("any", (0.0, 0, 0.0, 0.0)),
    ] {
        let line = format!("reliefscope-rays 1 kind=diffuse query={query} triangles=1 rays=8");
        let file = read_rays(&file_of(&folder, &line, &numbers)).unwrap();
        let (list, bvh) = (file.list(), Bvh::build(&file.mesh));
        assert_eq!(list.active(), 5);
        let race = RayRace {
            bvh: &bvh,
            list: &list,
            query: file.query,
        };
        let path = folder.path("made.hits");
        write_hits(&path, &file.rays, &race.check().unwrap()).unwrap();
        let miss = (inf, u32::MAX, 0.0, 0.0);
        let wanted = [hit, hit, hit, miss, miss, miss, miss, miss];
        assert_eq!(records(&path), wanted, "{query}");
    }
}

#[test]
fn bad_files_are_refused_with_their_place() {
    let folder = Folder::new();
    let good = "reliefscope-rays 1 kind=camera query=closest triangles=1 rays=1";
    let refuse = |line: &str, numbers: &[f32], wanted: &str| {
        let error = read_rays(&file_of(&folder, line, numbers)).unwrap_err();
        let text = error.to_string();
        assert!(text.contains("made.rays"), "{text}");
        assert!(text.contains(wanted), "{wanted}: {text}");
        error
    };
    let numbers = [&TRIANGLE[..], &ray(0.0, 1.0)].concat();
    assert!(read_rays(&file_of(&folder, good, &numbers)).is_ok());

    for (line, wanted) in [
        ("", "not a file of rays"),
        ("reliefscope-rays 2 kind=camera", "not a file of rays"),
        (&good.replace("camera", "cam"), "kind=cam"),
        (&good.replace("closest", "most"), "query=most"),
        (&good.replace("triangles=1", "triangles=x"), "triangles=x"),
        (&good.replace("rays=1", "rays=-1"), "rays=-1"),
        (&good.replace("rays=1", ""), "`rays` is missing"),
        (&format!("{good} rays=1"), "`rays` is there twice"),
        (&format!("{good} more"), "`more` is unknown"),
    ] {
        let error = refuse(line, &numbers, wanted);
        assert!(matches!(error, RayFileError::Header { .. }), "{error}");
    }

    let begin = good.len() + 1;
    let at = |offset: usize| format!("byte {}: ", begin + offset);
    refuse(good, &numbers[..16], &at(16 * 4));
    refuse(good, &[&numbers[..], &[0.0]].concat(), &at(18 * 4));
    let huge = good.replace("rays=1", "rays=18446744073709551615");
    refuse(&huge, &numbers, "end at byte");
    for (slot, value, offset) in [
        (4, f32::NAN, 0),
        (9, f32::INFINITY, 36),
        (12, -0.5, 36),
        (13, f32::NAN, 36),
        (15, 0.0, 36),
    ] {
        let mut bad = numbers.clone();
        bad[slot] = value;
        refuse(good, &bad, &at(offset));
    }
    let missing = read_rays(&folder.path("nowhere.rays")).unwrap_err();
    assert!(missing.to_string().contains("nowhere.rays"), "{missing}");
    let list = RayList::default();
    let nowhere = folder.path("no/a.rays");
    let error = write_rays(&nowhere, RayKind::Camera, &Default::default(), &list).unwrap_err();
    assert!(error.to_string().contains("a.rays"), "{error}");
}

fn run(folder: &Folder, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_reliefscope"))
        .arg("bench")
        .args(arguments)
        .current_dir(folder.path(""))
        .stdin(Stdio::null())
        .output()
        .expect("the program starts")
}

fn json(folder: &Folder, arguments: &[&str]) -> Value {
    let output = run(folder, arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {errors}");
    serde_json::from_slice(&output.stdout).expect("JSON")
}

#[test]
fn a_dumped_file_is_raced_and_its_hits_are_the_scalar_kernels() {
    let folder = Folder::new();
    let dumped = run(
        &folder,
        &[
            "torus-study",
            "--kind",
            "camera",
            "--size",
            "64x36",
            "--dump-rays",
            "a.rays",
        ],
    );
    assert_eq!(dumped.status.code(), Some(0));
    let race = |level: &str| {
        let arguments = [
            "--rays",
            "a.rays",
            "--hits",
            "a.hits",
            "--threads",
            "2,1",
            "--passes",
            "1",
            "--json",
            "--level",
            level,
        ];
        let told = json(&folder, &arguments);
        (told, records(&folder.path("a.hits")))
    };
    let (told, hits) = race(SimdLevel::best().name());
    assert_eq!(told["rays"], 64 * 36);
    assert_eq!(told["triangles"], 102_400);
    for threads in ["1", "2"] {
        for figure in ["best", "median"] {
            let speed = &told["mrays_per_s"][threads][figure];
            assert!(speed.as_f64().is_some_and(|x| x > 0.0), "{told}");
        }
    }
    assert_eq!(
        told["mrays_per_s"].as_object().map(serde_json::Map::len),
        Some(2)
    );

    let file = read_rays(&folder.path("a.rays")).unwrap();
    let (list, bvh) = (file.list(), Bvh::build(&file.mesh));
    assert_eq!(hits.len(), list.rays.len());
    for (i, ray) in list.rays.iter().enumerate() {
        let hit = bvh.intersect::<Watertight, _>(ray, list.t_max[i], &AcceptAll);
        let wanted = hit.map_or((f32::INFINITY, u32::MAX, 0.0, 0.0), |h| {
            (h.t, h.prim, h.u, h.v)
        });
        assert_eq!(hits[i], wanted, "ray {i}");
    }
    let found = hits.iter().filter(|h| h.0.is_finite()).count();
    assert!(found > 100);
    assert_eq!(told["hits"], found);
    assert_eq!(race("scalar").1, hits);
}

#[test]
fn the_table_has_its_shape() {
    let folder = Folder::new();
    let told = json(
        &folder,
        &[
            "plane.obj",
            "wall",
            "--quick",
            "--size",
            "24x16",
            "--passes",
            "1",
            "--threads",
            "1,2",
            "--json",
        ],
    );
    assert_eq!(told["threads"], serde_json::json!([1, 2]));
    assert_eq!(told["level"], SimdLevel::best().name());
    assert_eq!(told["version"], env!("CARGO_PKG_VERSION"));
    assert!(told.get("cpu").is_some() && told.get("commit").is_some());
    let part = |name: &str| told[name].as_array().expect("a list").clone();
    let is_time = |row: &Value, name: &str| {
        let number = |key: String| row[key].as_f64().expect("a number");
        let median = number(format!("{name}_ms"));
        let (min, max) = (
            number(format!("{name}_ms_min")),
            number(format!("{name}_ms_max")),
        );
        assert!(0.0 < min && min <= median && median <= max, "{row}");
    };
    let frames = part("frame");
    assert_eq!(frames.len(), 2 * Method::ALL.len());
    for (row, method) in frames.iter().zip(Method::ALL.iter().cycle()) {
        assert_eq!(row["method"], method.name());
        for name in ["start", "preview", "full", "reshade", "relight", "encode"] {
            is_time(row, name);
        }
        assert_eq!(row["counters"]["camera_rays"], 24 * 16);
    }
    assert_eq!(frames[0]["scene"], "plane.obj");
    assert_eq!(part("scaling").len(), 4);
    let rays = part("rays");
    for kind in ["camera", "point-shadow", "sun-shadow", "mirror"] {
        for threads in [1, 2] {
            let row = rays
                .iter()
                .find(|r| r["scene"] == "wall" && r["kind"] == kind && r["threads"] == threads);
            let row = row.unwrap_or_else(|| panic!("{kind} by {threads}"));
            assert!(row["mrays_per_s"].as_f64().is_some_and(|x| x > 0.0));
        }
    }
    let growth = part("growth");
    for study in ["mesh", "lights", "mirrors", "columns"] {
        let rows: Vec<_> = growth.iter().filter(|r| r["study"] == study).collect();
        assert!(rows.len() >= 2, "{study}");
        for row in rows {
            is_time(row, "full");
            assert!(row["fps"].as_f64().is_some_and(|x| x > 0.0));
            assert_eq!(row.get("build_ms").is_some(), study == "mesh");
        }
    }
    let triangles: Vec<_> = growth
        .iter()
        .take(3)
        .map(|r| r["triangles"].clone())
        .collect();
    assert_eq!(triangles, [5_000, 20_000, 80_000]);
}

#[test]
fn what_does_not_go_together_is_refused() {
    let folder = Folder::new();
    std::fs::write(folder.path("text.rays"), "nonsense").unwrap();
    let cases: [(&[&str], &str); 9] = [
        (&["wall", "--kind", "camera"], "--dump-rays"),
        (&["wall", "--dump-rays", "a.rays"], "--kind"),
        (&["wall", "--rays", "a.rays"], "--rays"),
        (&["--hits", "a.hits"], "--rays"),
        (&["--threads", "0"], "--threads"),
        (&["--rays", "nowhere.rays"], "nowhere.rays"),
        (&["--rays", "text.rays"], "text.rays:1: "),
        (
            &["wall", "plane", "--kind", "camera", "--dump-rays", "a.rays"],
            "one INPUT",
        ),
        (
            &[
                "torus-study",
                "--kind",
                "mirror",
                "--size",
                "32x32",
                "--dump-rays",
                "a.rays",
            ],
            "sends no mirror rays",
        ),
    ];
    for (arguments, word) in cases {
        let output = run(&folder, arguments);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(errors.contains(word), "{arguments:?}: {errors}");
        assert!(output.stdout.is_empty(), "{arguments:?}");
    }
    let lacking = SimdLevel::ALL.into_iter().find(|l| !l.is_available());
    if let Some(level) = lacking {
        let output = run(&folder, &["wall", "--level", level.name()]);
        assert_eq!(output.status.code(), Some(2));
        assert!(String::from_utf8_lossy(&output.stderr).contains(level.name()));
    }
    assert!(!folder.path("a.rays").exists());
}

#[test]
fn a_wrong_twin_is_noticed() {
    let snapshot = grid_scene(10, [32, 16]);
    let case = FrameCase::new(snapshot.clone());
    assert!(case.check(&scalar_twin(&snapshot.scene)).is_ok());
    let mut other = (*snapshot.scene).clone();
    other.mesh.normals.fill(Vec3::X);
    let error = case.check(&Arc::new(other)).unwrap_err();
    assert!(error.is_wrong_answer(), "{error}");
}
