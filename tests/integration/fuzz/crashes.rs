//! Files that were slow, large or fatal once, each by name.

use std::fmt::Write as _;
use std::fs;
use std::time::Instant;

use reliefscope::scene::load::{LoadOptions, PictureLimits, decode_picture};
use reliefscope::scene::open;

use super::HANG;

const QUAD: &str = "mtllib case.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n";

/// Loads a model with a library.
fn load(model: &str, library: &str) -> Vec<String> {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("case.mtl"), library).expect("written");
    let path = folder.path().join("case.obj");
    fs::write(&path, model).expect("written");
    let began = Instant::now();
    let loaded = open(&path, &LoadOptions::default()).expect("a model");
    assert!(began.elapsed() < HANG, "{:?}", began.elapsed());
    loaded.warnings.iter().map(ToString::to_string).collect()
}

/// Each `newmtl` was compared with all before it: 20 billion comparisons here.
#[test]
fn a_library_of_many_materials_is_read_in_step_with_its_length() {
    let mut library = String::new();
    for i in 0..200_000 {
        let _ = writeln!(library, "newmtl material{i}");
    }
    load(&format!("{QUAD}usemtl material199999\nf 1 2 3\n"), &library);
}

/// A material takes some hundred bytes, its shortest definition nine.
#[test]
fn no_more_materials_are_kept_than_a_model_could_use() {
    let mut library = String::new();
    for i in 0..(1 << 18) + 3 {
        let _ = writeln!(library, "newmtl m{i}\nKd 1 0 0");
    }
    let warnings = load(&format!("{QUAD}usemtl m262144\nf 1 2 3\n"), &library);
    let says = |what: &str| warnings.iter().any(|w| w.contains(what));
    assert!(says("3 are left out"), "{warnings:?}");
    assert!(says("m262144"), "{warnings:?}");
}

/// Each name that is nowhere was compared, in lower case, with all that are.
#[test]
fn names_that_are_nowhere_are_looked_for_in_step_with_their_number() {
    let (mut library, mut model) = (String::new(), QUAD.to_owned());
    for i in 0..50_000 {
        let _ = writeln!(library, "newmtl here{i}");
        let _ = writeln!(model, "usemtl There{i}\nf 1 2 3");
    }
    load(&model, &library);
}

/// Ear clipping looked for diagonals in a tangle of 9000 corners over 4 places: a minute.
#[test]
fn a_face_that_repeats_its_corners_is_quick() {
    let model = format!("{QUAD}v 1 1 0\nf{}\n", " 1 2 3 4 1 3".repeat(1500));
    let warnings = load(&model, "");
    assert!(
        warnings.iter().any(|w| w.contains("crosses itself")),
        "{warnings:?}"
    );
}

/// `Kd 1e38` made pixels that were not finite.
#[test]
fn colours_without_measure_stay_finite() {
    let mut bench = super::Bench::new();
    for line in [
        "Kd 0.5 0.4 1e38",
        "Ks 0 0 1e38",
        "Kd -1e38 0 9e18\nKs 1e38 1e38 1e38",
    ] {
        let library = format!("newmtl a\n{line}\nnewmtl b\nillum 3\n{line}\n");
        let answer = bench.read(super::corpus::Format::Mtl, library.as_bytes());
        assert_eq!(answer, super::Answer::Read, "{line}");
    }
}

#[test]
fn a_name_as_long_as_a_file_is_cut() {
    let name = "n".repeat(1 << 20);
    let model = format!("{QUAD}usemtl {name}\nf 1 2 3\n");
    for text in load(&model, "newmtl other\n") {
        assert!(text.len() < 8_000, "{} bytes", text.len());
    }
    // Cut alike on both sides, it is still found.
    let warnings = load(&model, &format!("newmtl {name}\nKd 1 0 0\n"));
    assert!(!warnings.iter().any(|w| w.contains("not")), "{warnings:?}");
}

#[test]
fn a_scene_file_without_end_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("long.toml");
    fs::write(&path, "#".repeat(5 << 20)).expect("written");
    let error = open(&path, &LoadOptions::default()).expect_err("refused");
    assert!(error.to_string().contains("too many"), "{error}");
}

#[test]
fn what_is_no_plain_file_is_no_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    let error = decode_picture(folder.path(), &PictureLimits::default()).expect_err("refused");
    assert!(error.to_string().contains("plain file"), "{error}");
    if cfg!(unix) {
        let endless = std::path::Path::new("/dev/zero");
        let error = decode_picture(endless, &PictureLimits::default()).expect_err("refused");
        assert!(error.to_string().contains("plain file"), "{error}");
    }
}

/// The file takes no room on the disk; its text would.
#[test]
fn a_model_longer_than_the_limit_is_refused_unread() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("long.obj");
    let file = fs::File::create(&path).expect("made");
    if file.set_len((16 << 30) + 1).is_err() {
        // Not every file system has room for holes.
        return;
    }
    let error = open(&path, &LoadOptions::default()).expect_err("refused");
    assert!(error.to_string().contains("at most"), "{error}");
}
