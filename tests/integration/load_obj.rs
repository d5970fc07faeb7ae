//! Loading OBJ files: every syntax case, the usual models, broken input, and tobj as the oracle.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use glam::{DVec3, Vec3};
use reliefscope::scene::load::{LoadOptions, load_model};
use reliefscope::scene::{LoadError, LoadWarning, LoadedScene};
use serde_json::{Map, Value};

fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data")
}

/// The folder of large models, which are not part of the repository.
fn models() -> Option<PathBuf> {
    let folder = std::env::var_os("RELIEFSCOPE_MODELS").map(PathBuf::from);
    if folder.is_none() {
        eprintln!("RELIEFSCOPE_MODELS is not set: the large models are skipped");
    }
    folder
}

fn expectations(folder: &Path) -> Map<String, Value> {
    let text = fs::read_to_string(folder.join("expected.json")).expect("expected.json is there");
    let Value::Object(mut cases) = serde_json::from_str(&text).expect("expected.json is JSON")
    else {
        panic!("expected.json is an object");
    };
    cases.remove("_about");
    cases
}

fn load(path: &Path) -> Result<LoadedScene, LoadError> {
    load_model(path, &LoadOptions::default())
}

fn load_text(text: &[u8]) -> Result<LoadedScene, LoadError> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("model.obj");
    fs::write(&path, text).expect("writing into it");
    load(&path)
}

/// World area of the mesh's triangles: larger than the polygons' where they are cut wrongly or warped.
fn mesh_area(loaded: &LoadedScene) -> f64 {
    let mesh = &loaded.scene.mesh;
    let triangles = (0..mesh.len() as u32).map(|prim| mesh.corners(prim).map(Vec3::as_dvec3));
    let area: f64 = triangles
        .map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length())
        .sum();
    area / loaded.scene.normalization.scale.powi(2)
}

fn used_materials(loaded: &LoadedScene) -> BTreeSet<String> {
    let attributes = loaded.scene.mesh.attributes.iter();
    attributes
        .map(|a| {
            loaded.settings.materials[usize::from(a.material)]
                .name
                .clone()
        })
        .collect()
}

fn point(value: &Value) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|i| value[i].as_f64().expect("a coordinate")))
}

/// What holds for whatever loads at all.
fn check_invariants(loaded: &LoadedScene, name: &str) {
    let (mesh, facts) = (&loaded.scene.mesh, &loaded.scene.facts);
    let vertices = mesh.positions.len();
    assert_eq!(mesh.attributes.len(), mesh.len(), "{name}");
    assert_eq!(facts.triangles, mesh.len() + facts.degenerate, "{name}");
    assert!(mesh.positions.iter().all(|p| p.is_finite()), "{name}");
    assert!(
        mesh.indices
            .iter()
            .flatten()
            .all(|&i| (i as usize) < vertices),
        "{name}"
    );
    let any =
        |f: fn(&reliefscope::geometry::TriangleAttributes) -> bool| mesh.attributes.iter().any(f);
    assert_eq!(
        mesh.uvs.len(),
        if any(|a| a.has_uv) { vertices } else { 0 },
        "{name}"
    );
    assert_eq!(
        mesh.normals.len(),
        if any(|a| a.smooth) { vertices } else { 0 },
        "{name}"
    );
    assert!(mesh.uvs.iter().all(|uv| uv.is_finite()), "{name}");
    assert!(mesh.normals.iter().all(|n| n.is_normalized()), "{name}");
    let materials = loaded.settings.materials.len();
    assert!(
        mesh.attributes
            .iter()
            .all(|a| usize::from(a.material) < materials),
        "{name}"
    );
    let camera = &loaded.settings.camera;
    assert!(camera.eye.is_finite() && camera.distance() > 0.0, "{name}");
}

/// How the area of the triangles may exceed that of the polygons.
#[derive(Clone, Copy)]
enum Faces {
    Planar,
    MaybeWarped,
}

/// Everything that differs between a case and what loads.
fn differences(name: &str, loaded: &LoadedScene, found: &Value, faces: Faces) -> Vec<String> {
    let facts = &loaded.scene.facts;
    let mut wrong = Vec::new();
    let mut claim = |holds: bool, what: String| {
        if !holds {
            wrong.push(format!("{name}: {what}"));
        }
    };
    let count = |key: &str| found[key].as_u64().unwrap_or(0) as usize;
    claim(
        facts.triangles == count("triangles"),
        format!("{} triangles", facts.triangles),
    );
    claim(
        facts.vertices == count("v"),
        format!("{} vertices", facts.vertices),
    );
    if let Some(area) = found["area"].as_f64() {
        let near = |x: f64, tolerance: f64| (x - area).abs() <= tolerance * area;
        claim(
            near(facts.area, 1e-4),
            format!("area {}, not {area}", facts.area),
        );
        let tolerance = match faces {
            Faces::Planar => 1e-4,
            Faces::MaybeWarped => 0.05,
        };
        let crossed = loaded
            .warnings
            .iter()
            .any(|w| w.message.contains("crosses itself"));
        let triangles = if crossed { area } else { mesh_area(loaded) };
        claim(
            near(triangles, tolerance),
            format!("triangles' area {triangles}, not {area}"),
        );
    }
    let [min, max] = facts.bounds.expect("a loaded model has bounds");
    let [low, high] = [0, 1].map(|i| point(&found["bbox"][i]));
    // Six decimals were kept.
    let near = |a: DVec3, b: DVec3| (a - b).abs().max_element() <= 1e-6 + 1e-9 * b.length();
    claim(
        near(min, low) && near(max, high),
        format!("box {min} to {max}"),
    );
    let names = used_materials(loaded);
    let by_material = found["faces_by_material"]
        .as_object()
        .expect("faces by material");
    let utf8 = !names.iter().any(|n| n.contains('\u{FFFD}'));
    let expected: BTreeSet<_> = by_material
        .keys()
        .map(|n| match (n.as_str(), found.get("usemtl_distinct")) {
            ("None", None) => "default".into(),
            _ => n.clone(),
        })
        .collect();
    if utf8 && loaded.scene.facts.degenerate == 0 {
        claim(
            names == expected,
            format!("materials {names:?}, not {expected:?}"),
        );
    }
    wrong
}

#[test]
fn every_syntax_case_loads_as_expected() {
    let folder = data().join("syntax");
    let mut wrong = Vec::new();
    let cases = expectations(&folder);
    assert_eq!(cases.len(), 64);
    for (name, case) in &cases {
        let loaded = load(&folder.join(name));
        let expect = case["expect"].as_str().expect("an expectation");
        let loaded = match (loaded, expect) {
            (Err(LoadError::Invalid { message, .. }), "error-or-empty") => {
                assert!(!message.is_empty());
                continue;
            }
            (Ok(loaded), "ok" | "ok-with-warning") => loaded,
            (other, _) => {
                wrong.push(format!("{name}: {expect}, got {:?}", other.err()));
                continue;
            }
        };
        check_invariants(&loaded, name);
        let faces = match name.as_str() {
            "nonplanar_quad.obj" => {
                // Both cuts of this saddle have the area √3.
                assert!((mesh_area(&loaded) - 3_f64.sqrt()).abs() < 1e-6);
                continue;
            }
            _ => Faces::Planar,
        };
        wrong.extend(differences(name, &loaded, &case["ref"], faces));
        if expect == "ok-with-warning" && loaded.warnings.is_empty() {
            wrong.push(format!("{name}: no warning"));
        }
        let damage = |w: &&LoadWarning| {
            let words = ["dropped", "without its", "finite", "not found", "no usable"];
            words.iter().any(|word| w.message.contains(word))
        };
        if expect == "ok" {
            wrong.extend(
                loaded
                    .warnings
                    .iter()
                    .filter(damage)
                    .map(ToString::to_string),
            );
        }
        if loaded
            .warnings
            .iter()
            .any(|w| w.file.as_os_str().is_empty())
        {
            wrong.push(format!("{name}: a warning without its file"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn the_usual_models_load_as_expected() {
    let Some(folder) = models() else { return };
    let mut wrong = Vec::new();
    for (name, case) in expectations(&folder) {
        let found = &case["ref"];
        if name.starts_with("syntax/") {
            continue;
        }
        let loaded = match load(&folder.join(&name)) {
            Err(LoadError::Invalid { .. }) if found["triangles"] == 0 => continue,
            Ok(loaded) if found["triangles"] != 0 => loaded,
            other => {
                wrong.push(format!("{name}: {:?}", other.err()));
                continue;
            }
        };
        check_invariants(&loaded, &name);
        wrong.extend(differences(&name, &loaded, found, Faces::MaybeWarped));
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// World corners of all triangles by tobj, if it can read the file.
fn tobj_triangles(path: &Path) -> Option<Vec<[Vec3; 3]>> {
    let (models, _) = tobj::load_obj(path, &tobj::GPU_LOAD_OPTIONS).ok()?;
    let mut triangles = Vec::new();
    for mesh in models.iter().map(|m| &m.mesh) {
        let p = |i: u32| Vec3::from_slice(&mesh.positions[3 * i as usize..]);
        triangles.extend(
            mesh.indices
                .chunks_exact(3)
                .map(|t| [p(t[0]), p(t[1]), p(t[2])]),
        );
    }
    Some(triangles)
}

/// Triangles of clean files must be tobj's, corner by corner; of clean polygons, as many.
fn compare_with_tobj(path: &Path, corners_too: bool) {
    let theirs = tobj_triangles(path).unwrap_or_else(|| panic!("tobj reads {}", path.display()));
    let loaded = load(path).expect("what tobj reads loads here");
    let (mesh, normalization) = (&loaded.scene.mesh, &loaded.scene.normalization);
    assert_eq!(
        theirs.len(),
        loaded.scene.facts.triangles,
        "{}",
        path.display()
    );
    if corners_too {
        assert_eq!(theirs.len(), mesh.len(), "{}", path.display());
        for (prim, expected) in theirs.iter().enumerate() {
            for (ours, expected) in mesh.corners(prim as u32).iter().zip(expected) {
                let ours = normalization.world_from_internal(*ours).as_vec3();
                let close = 1e-6 * (1.0 + expected.abs().max_element());
                assert!(
                    (ours - expected).abs().max_element() <= close,
                    "{}",
                    path.display()
                );
            }
        }
    }
}

#[test]
fn clean_files_agree_with_tobj() {
    let folder = data().join("syntax");
    for name in ["far_away", "groups", "mtllib_two", "negative", "tiny"] {
        compare_with_tobj(&folder.join(name).with_extension("obj"), name != "negative");
    }
    for name in ["concave_star", "crlf", "smooth", "uv_mirror", "uv_outside"] {
        compare_with_tobj(&folder.join(name).with_extension("obj"), false);
    }
    let Some(folder) = models() else { return };
    for name in ["armadillo", "cow", "fandisk", "stanford-bunny", "teapot"] {
        compare_with_tobj(
            &folder.join("classic").join(name).with_extension("obj"),
            true,
        );
    }
    compare_with_tobj(&folder.join("classic/spot/spot_triangulated.obj"), true);
    compare_with_tobj(&folder.join("classic/horse_quad.obj"), false);
    compare_with_tobj(&folder.join("sponza/sponza.obj"), false);
}

/// Splitmix64.
fn random(state: &mut u64) -> usize {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    (z ^ (z >> 31)) as usize
}

fn mutate(text: &mut Vec<u8>, state: &mut u64) {
    const PIECES: [&[u8]; 16] = [
        b"nan",
        b" -1",
        b"/",
        b"\\\n",
        b"\n",
        b"\r",
        b" 1e999 ",
        b"99999999999",
        b"#",
        b"f 1 2 3\n",
        b"v 1e300 -1e300 1e-300\n",
        b"s 3\n",
        b"\xff\x00",
        b"usemtl \n",
        b" 0",
        b"vn 0 0 0\nvt 7\n",
    ];
    for _ in 0..1 + random(state) % 4 {
        let at = random(state) % (text.len() + 1);
        let end = (at + random(state) % 20).min(text.len());
        match random(state) % 4 {
            0 if at < text.len() => text[at] = random(state) as u8,
            1 => drop(text.drain(at..end)),
            2 => {
                let copy = text[at..end].to_vec();
                text.splice(at..at, copy);
            }
            _ => drop(text.splice(at..at, PIECES[random(state) % 16].iter().copied())),
        }
    }
}

#[test]
fn mutated_files_never_panic_and_stay_sound() {
    let folder = data().join("syntax");
    let scratch = tempfile::tempdir().expect("a temporary folder");
    let path = scratch.path().join("mutated.obj");
    let mut loads = 0;
    for (index, name) in expectations(&folder).keys().enumerate() {
        let original = fs::read(folder.join(name)).expect("the case is there");
        for round in 0..60 {
            let mut state = (index * 1_000 + round) as u64;
            let mut text = original.clone();
            mutate(&mut text, &mut state);
            fs::write(&path, &text).expect("writing into the temporary folder");
            if let Ok(loaded) = load(&path) {
                check_invariants(&loaded, &format!("{name}, round {round}"));
                loads += 1;
            }
        }
    }
    assert!(
        loads > 1_500,
        "most mutations leave something to load: {loads}"
    );
}

#[test]
fn warnings_name_lines_and_do_not_flood() {
    let loaded = load(&data().join("syntax/bad_indices.obj")).expect("one face is good");
    let lines: Vec<_> = loaded.warnings.iter().filter_map(|w| w.line).collect();
    assert_eq!(lines, [5, 6, 8, 9]);
    assert!(
        loaded.warnings[0].message.contains("vertex 9 of 4"),
        "{}",
        loaded.warnings[0]
    );

    let mut text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_vec();
    (0..1_000).for_each(|_| text.extend_from_slice(b"f 1 2 9\nl 1 2\n"));
    let warnings = load_text(&text).expect("one face is good").warnings;
    assert_eq!(warnings.len(), 22, "{warnings:?}");
    assert!(warnings.iter().any(|w| w.message.contains("and 980 more")));
    assert!(
        warnings
            .iter()
            .any(|w| w.message.contains("1000 in this file"))
    );
}

#[test]
fn errors_are_clear() {
    let missing = load(Path::new("no such.obj"));
    assert!(matches!(missing, Err(LoadError::Io { .. })));
    let no_faces = load_text(b"v 0 0 0\nf 1 2 3\n").expect_err("no face is good");
    assert!(
        no_faces
            .to_string()
            .contains("no usable faces (1 vertices)"),
        "{no_faces}"
    );
    let nowhere = load_text(b"v a\nf 1 1 1\n").expect_err("no finite corner");
    assert!(
        nowhere.to_string().contains("none of the 1 triangles"),
        "{nowhere}"
    );

    let options = LoadOptions::default();
    options.monitor.cancel();
    let cancelled = load_model(&data().join("syntax/smooth.obj"), &options);
    assert!(matches!(cancelled, Err(LoadError::Cancelled)));
}

#[test]
fn faces_without_area_can_be_inspected() {
    let loaded = load_text(b"v 1 2 3\nv 2 4 6\nv 3 6 9\nf 1 2 3\nf 1 1 1\n").expect("it loads");
    check_invariants(&loaded, "no area");
    assert!(loaded.scene.mesh.is_empty());
    let facts = &loaded.scene.facts;
    assert_eq!((facts.triangles, facts.degenerate), (2, 2));
    assert!(loaded.warnings[0].message.contains("2 of 2 triangles"));
    let point = load_text(b"v 1 2 3\nf 1 1 1\n").expect("it loads");
    check_invariants(&point, "one point");
}

#[test]
fn materials_are_limited() {
    let with_materials = |count: usize| {
        let mut text = String::from("v 0 0 0\nv 1 0 0\nv 0 1 0\n");
        (0..count).for_each(|i| text += &format!("usemtl m{i}\nf 1 2 3\n"));
        load_text(text.as_bytes())
    };
    let loaded = with_materials(65_535).expect("the limit itself loads");
    assert_eq!(loaded.settings.materials.len(), 65_535);
    let error = with_materials(65_536)
        .expect_err("one too many")
        .to_string();
    assert!(
        error.contains("131075") && error.contains("65,535"),
        "{error}"
    );
}

/// Normal at the corner of triangle `prim` that lies at `world`; `None` if the triangle is flat.
fn normal_at(loaded: &LoadedScene, prim: usize, world: DVec3) -> Option<Vec3> {
    let (mesh, normalization) = (&loaded.scene.mesh, &loaded.scene.normalization);
    let place = normalization.internal_from_world(world);
    let vertex = mesh.indices[prim]
        .into_iter()
        .find(|&v| mesh.positions[v as usize] == place)
        .expect("the triangle has this corner");
    mesh.attributes[prim]
        .smooth
        .then(|| mesh.normals[vertex as usize])
}

#[test]
fn smoothing_groups_average_within_the_group_only() {
    let loaded = load(&data().join("syntax/smooth.obj")).expect("it loads");
    let at = |prim: usize, p: [f64; 3]| normal_at(&loaded, prim, DVec3::from(p));
    let close = |n: Option<Vec3>, expected: [f32; 3]| {
        n.is_some_and(|n| n.distance(Vec3::from(expected).normalize_or_zero()) < 1e-6)
    };
    // Triangles 0 and 1 are the face −z of group 1, which meets −y of the same group.
    assert!(close(at(0, [-1., -1., -1.]), [0., -1., -1.]));
    assert!(close(at(0, [-1., 1., -1.]), [0., 0., -1.]));
    // +y is off; −x and +x of group 2 share no corner, so their normals are their own.
    let attributes = &loaded.scene.mesh.attributes;
    assert!(attributes[6..12].iter().all(|a| !a.smooth));
    assert!(attributes[..6].iter().all(|a| a.smooth));
}

#[test]
fn without_smoothing_groups_edges_below_60_degrees_are_smooth() {
    let prism = |sides: u32| {
        let mut text = String::new();
        for i in 0..sides {
            let (s, c) = (std::f64::consts::TAU * f64::from(i) / f64::from(sides)).sin_cos();
            text += &format!("v {c} {s} 0\nv {c} {s} 1\n");
        }
        for i in 0..sides {
            let (a, b) = (2 * i + 1, 2 * ((i + 1) % sides) + 1);
            text += &format!("f {a} {b} {} {}\n", b + 1, a + 1);
        }
        text + "f "
            + &(0..sides)
                .map(|i| format!("{} ", 2 * i + 2))
                .collect::<String>()
    };
    // The cap meets the sides at 90°.
    for (sides, smooth) in [(4, false), (5, false), (7, true), (40, true)] {
        let loaded = load_text(prism(sides).as_bytes()).expect("it loads");
        let attributes = &loaded.scene.mesh.attributes;
        let (side, cap) = attributes.split_at(2 * sides as usize);
        assert!(side.iter().all(|a| a.smooth == smooth), "{sides} sides");
        assert!(cap.iter().all(|a| !a.smooth), "the cap of {sides}");
    }
    let off = format!("s off\n{}", prism(40));
    let loaded = load_text(off.as_bytes()).expect("it loads");
    assert!(loaded.scene.mesh.normals.is_empty());
}

#[test]
fn normals_do_not_depend_on_how_faces_are_cut() {
    // The corner of a cube in one smoothing group: three faces, equal angles, the diagonal.
    let corner = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 0\nv 1 0 1\nv 0 1 1\ns 1\n";
    let quads = "f 1 3 5 2\nf 1 2 6 4\nf 1 4 7 3\n";
    let mixed = "f 1 3 5\nf 1 5 2\nf 1 2 6 4\nf 1 4 7 3\n";
    for faces in [quads, mixed] {
        let loaded = load_text(format!("{corner}{faces}").as_bytes()).expect("it loads");
        let normal = normal_at(&loaded, 0, DVec3::ZERO).expect("smooth");
        assert!(
            normal.distance(Vec3::splat(-1.0).normalize_or_zero()) < 1e-6,
            "{normal}"
        );
    }
}

#[test]
fn bad_normals_and_texture_coordinates_cost_only_themselves() {
    let loaded = load(&data().join("syntax/bad_normals.obj")).expect("it loads");
    // The zero normal becomes the face's own; the opposite one is kept.
    assert_eq!(normal_at(&loaded, 0, DVec3::ZERO), None);
    assert_eq!(normal_at(&loaded, 2, DVec3::ZERO), Some(Vec3::NEG_Z));
    assert!(loaded.warnings.iter().any(|w| w.line == Some(5)));

    for name in ["bad_vt", "partial_vt_in_face"] {
        let path = data().join("syntax").join(name).with_extension("obj");
        let loaded = load(&path).expect("it loads");
        assert!(!loaded.scene.mesh.attributes[0].has_uv, "{name}");
    }
    let mixed = load(&data().join("syntax/mixed_formats.obj")).expect("it loads");
    let has_uv: Vec<_> = mixed
        .scene
        .mesh
        .attributes
        .iter()
        .map(|a| a.has_uv)
        .collect();
    assert_eq!(has_uv, [false, true, false, true, false, false]);
}

#[test]
fn normalization_can_be_turned_off() {
    let path = data().join("syntax/far_away.obj");
    let near = load(&path).expect("it loads").scene;
    assert_eq!(near.mesh.bounds().max, Vec3::new(0.5, 0.5, 0.0));
    let options = LoadOptions {
        normalize: false,
        ..LoadOptions::default()
    };
    let far = load_model(&path, &options).expect("it loads").scene;
    assert_eq!(
        far.mesh.bounds().max,
        Vec3::new(1_000_001.0, 1_000_001.0, 0.0)
    );
    assert_eq!(far.facts.bounds, near.facts.bounds);
}

#[test]
fn indices_may_point_forward() {
    let loaded = load_text(b"f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").expect("it loads");
    assert_eq!(loaded.scene.facts.triangles, 1);
    assert!(loaded.warnings.is_empty());
}
