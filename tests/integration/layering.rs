//! Holds the plan of the house: which room may use which, and through which door an outside crate comes in.

use std::fs;
use std::path::{Path, PathBuf};

/// A room uses itself and the rooms before it.
const ROOMS: [&str; 10] = [
    "math", "geometry", "texture", "surface", "shading", "scene", "render", "measure", "cli",
    "viewer",
];

/// Outside crates that have a door, and where under `src` it is.
const DOORS: [(&str, &[&str]); 18] = [
    ("fearless_simd", &["math/simd"]),
    ("bevy_mikktspace", &["geometry/tangents"]),
    (
        "rayon",
        &[
            "geometry/bvh/build",
            "scene/load",
            "surface/displaced",
            "texture/cone_map",
            "texture/destair",
            "texture/horizon_map",
            "render",
            "measure/bench",
            "measure/stability",
        ],
    ),
    ("image", &["scene/load", "scene/save_picture"]),
    ("tempfile", &["scene/file", "scene/save_picture"]),
    ("tobj", &[]),
    ("earcut", &["scene/load"]),
    ("toml", &["scene/file"]),
    ("serde_json", &["cli"]),
    ("clap", &["cli"]),
    ("indicatif", &["cli"]),
    ("ctrlc", &["cli"]),
    ("csv", &["measure/trade"]),
    ("base64", &["measure/trade"]),
    ("egui", &["viewer"]),
    ("egui_plot", &["viewer"]),
    ("eframe", &["viewer"]),
    ("rfd", &["viewer"]),
];

/// Only these read clocks: a picture must not depend on when it was made.
const CLOCKS: [&str; 5] = [
    "measure",
    "cli",
    "viewer/worker",
    "viewer/pacing",
    "viewer/feel",
];

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let paths = entries.map(|e| e.expect("a folder can be listed").path());
    let (folders, files): (Vec<_>, Vec<_>) = paths.partition(|p| p.is_dir());
    let own = files
        .into_iter()
        .filter(|p| p.extension().is_some_and(|e| e == "rs"));
    own.chain(folders.iter().flat_map(|f| rust_files(f)))
        .collect()
}

/// The text without line comments: a link in a comment uses nothing.
fn code(text: &str) -> String {
    let lines = text.lines().map(|l| l.split("//").next().unwrap_or(""));
    lines.collect::<Vec<_>>().join("\n")
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// What follows each `word::` that begins a path.
fn after<'a>(code: &'a str, word: &'a str) -> impl Iterator<Item = &'a str> {
    code.match_indices(word).filter_map(move |(at, _)| {
        let begins = !code[..at].ends_with(|c: char| is_word(c) || c == ':');
        code[at + word.len()..]
            .strip_prefix("::")
            .filter(|_| begins)
    })
}

/// First names of a path's rest: `a::b` gives a, `{a::b, c}` gives a and c (and b, which harms nothing).
fn first_names(rest: &str) -> Vec<&str> {
    let group = rest
        .strip_prefix('{')
        .map(|g| g.split([';', '}']).next().unwrap_or(""));
    let list = group.unwrap_or_else(|| rest.split(|c| !is_word(c)).next().unwrap_or(""));
    list.split(|c| !is_word(c))
        .filter(|n| !n.is_empty())
        .collect()
}

/// Every way in which the file `src/{place}` breaks the plan.
fn offences(place: &str, text: &str) -> Vec<String> {
    let mut found = Vec::new();
    if !text.starts_with("//!") {
        found.push(format!("src/{place} does not open with a `//!` line"));
    }
    let code = code(text);
    for (word, doors) in DOORS {
        if after(&code, word).next().is_some() && !doors.iter().any(|d| place.starts_with(d)) {
            found.push(format!("src/{place} names `{word}` outside its door"));
        }
    }
    let reads_clock = code.contains("Instant::now") || code.contains("SystemTime::now");
    if reads_clock && !CLOCKS.iter().any(|d| place.starts_with(d)) {
        found.push(format!("src/{place} reads a clock"));
    }
    let room = |name: &str| ROOMS.iter().position(|r| *r == name);
    let segments: Vec<&str> = place.trim_end_matches(".rs").split('/').collect();
    let Some(own) = room(segments[0]) else {
        return found;
    };
    let depth = segments.iter().filter(|s| **s != "mod").count();
    let from_root = after(&code, "super").filter_map(|rest| {
        let ups = 1 + rest.split("::").take_while(|s| *s == "super").count();
        (ups == depth).then(|| rest.trim_start_matches("super::"))
    });
    for rest in after(&code, "crate").chain(from_root) {
        for name in first_names(rest) {
            if room(name).is_some_and(|r| r > own) {
                found.push(format!(
                    "src/{place} uses `{name}`, a room below `{}`",
                    segments[0]
                ));
            }
        }
    }
    found
}

#[test]
fn every_file_keeps_to_the_plan() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let files = rust_files(&src);
    assert!(files.len() > 20, "the sources were not found");
    let check = |path: &PathBuf| {
        let place = path.strip_prefix(&src).expect("listed from there");
        let place = place.to_string_lossy().replace('\\', "/");
        offences(
            &place,
            &fs::read_to_string(path).expect("sources are UTF-8"),
        )
    };
    let found: Vec<String> = files.iter().flat_map(check).collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn an_offender_is_named() {
    let one = |place: &str, text: &str| {
        let found = offences(place, &format!("//! Idea.\n{text}"));
        assert_eq!(found.len(), 1, "{place}: {text}: {found:?}");
        found[0].clone()
    };
    assert!(one("scene/open.rs", "use crate::render::Film;").contains("`render`"));
    assert!(one("scene/open.rs", "use crate::{math, measure::x};").contains("`measure`"));
    assert!(one("scene/open.rs", "use super::super::viewer::App;").contains("`viewer`"));
    assert!(one("scene/mod.rs", "use super::cli::Args;").contains("`cli`"));
    assert!(one("texture/grid.rs", "use rayon::prelude::*;").contains("`rayon`"));
    assert!(one("render/film.rs", "let t = std::time::Instant::now();").contains("clock"));
    assert_eq!(
        offences("math/float.rs", "use std::fmt;").len(),
        1,
        "no `//!`"
    );
    let clean = "//! See [`crate::viewer`].\nuse super::render::f;\nuse crate::{math::{EPS}};\nx.image::y()";
    assert_eq!(offences("scene/load/mod.rs", clean), Vec::<String>::new());
}
