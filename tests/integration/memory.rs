//! How much memory reading a file takes at its peak, each file in a process of its own: this test binary once more,
//! asked for [`child`] alone. Linux tells a process its peak.
//!
//! `cargo test --release --test integration memory -- --nocapture` prints the figures.

use std::env::{current_exe, var};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;

use image::{DynamicImage, ImageBuffer, ImageFormat};
use reliefscope::scene::load::{LoadOptions, PictureLimits, decode_picture};
use reliefscope::scene::open;
use reliefscope::texture::{RawImage, Samples};
use serde_json::{Value, json};

use crate::support::PICTURE_FORMATS;

/// Tells the child which file to read …
const FILE: &str = "RELIEFSCOPE_MEMORY_FILE";
/// … and how many columns and rows a picture may have.
const SIDE: &str = "RELIEFSCOPE_MEMORY_SIDE";

/// Beside what files are charged with: thread stacks, decoders' tables, rounding by the allocator.
const SPARE: u64 = 16 << 20;
/// Text counts so often.
const TEXT: u64 = 4;
/// Bytes that a triangle may take beside the text that names it.
const TRIANGLE: u64 = 200;
/// Bytes that a material may take beside its text.
const MATERIAL: u64 = 800;

/// Bytes of memory that this process has held at most.
fn peak() -> u64 {
    let status = fs::read_to_string("/proc/self/status").expect("Linux");
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    let kib = line.and_then(|l| l.trim().strip_suffix("kB"));
    kib.expect("a peak")
        .trim()
        .parse::<u64>()
        .expect("a number")
        << 10
}

fn bytes(image: &RawImage) -> u64 {
    let size = match &image.samples {
        Samples::U8(all) => all.len(),
        Samples::U16(all) => all.len() * 2,
        Samples::F32(all) => all.len() * 4,
    };
    size as u64
}

/// Reads the file that the environment names and prints what that took.
#[test]
#[ignore = "the others start it in a process of its own"]
fn child() {
    let Ok(file) = var(FILE) else { return };
    let path = Path::new(&file);
    let limits = PictureLimits {
        max_side: var(SIDE)
            .ok()
            .and_then(|s| s.parse().ok())
            .unwrap_or(16_384),
        ..PictureLimits::default()
    };
    let before = peak();
    let is_text = ["obj", "toml"]
        .map(|e| Some(e.as_ref()))
        .contains(&path.extension());
    let found = if is_text {
        let loaded = open(path, &LoadOptions::default());
        let triangles = loaded.as_ref().map_or(0, |l| l.scene.facts.triangles);
        json!({"grown": peak() - before, "triangles": triangles, "refused": loaded.err().map(|e| e.to_string())})
    } else {
        let decoded = decode_picture(path, &limits);
        let held = decoded.as_ref().map_or(0, |d| bytes(&d.image));
        json!({"grown": peak() - before, "decoded": held, "refused": decoded.err().map(|e| e.to_string())})
    };
    eprintln!("\nfound {found}");
}

/// What reading a file took in another process.
fn read(path: &Path, side: u32) -> Value {
    let output = Command::new(current_exe().expect("a path"))
        .args(["memory::child", "--exact", "--ignored", "--nocapture"])
        .env(FILE, path)
        .env(SIDE, side.to_string())
        .output()
        .expect("it starts");
    let text = String::from_utf8_lossy(&output.stderr);
    let found = text.lines().find_map(|line| line.strip_prefix("found "));
    let found = found.unwrap_or_else(|| panic!("{text}"));
    serde_json::from_str(found).expect("JSON")
}

fn number(found: &Value, key: &str) -> u64 {
    found[key]
        .as_u64()
        .unwrap_or_else(|| panic!("{key} in {found}"))
}

/// 3000 × 2000 texels: 12 MB of grey 16 bits, 18 MB of colours, 72 MB of floats.
fn write_picture(path: &Path, format: ImageFormat, is_grey: bool) {
    let [width, height] = [3000, 2000];
    let value = |x: u32, y: u32, c: u32| (x / 8 + y / 16 + 40 * c) % 256;
    let picture = match format {
        ImageFormat::Hdr | ImageFormat::OpenExr => {
            let texel = |x, y| image::Rgb([0, 1, 2].map(|c| value(x, y, c) as f32 / 100.0));
            DynamicImage::ImageRgb32F(ImageBuffer::from_fn(width, height, texel))
        }
        _ if is_grey => {
            let texel = |x, y| image::Luma([(value(x, y, 0) * 257) as u16]);
            DynamicImage::ImageLuma16(ImageBuffer::from_fn(width, height, texel))
        }
        _ => {
            let texel = |x, y| image::Rgb([0, 1, 2].map(|c| value(x, y, c) as u8));
            DynamicImage::ImageRgb8(ImageBuffer::from_fn(width, height, texel))
        }
    };
    picture.save_with_format(path, format).expect("written");
}

#[test]
fn pictures_take_three_times_their_samples_and_none_beyond_the_limit() {
    let folder = tempfile::tempdir().expect("a folder");
    let grey = [("png", ImageFormat::Png), ("tif", ImageFormat::Tiff)];
    let all = PICTURE_FORMATS
        .map(|f| (f, false))
        .into_iter()
        .chain(grey.map(|f| (f, true)));
    for ((ending, format), is_grey) in all {
        let path = folder.path().join(format!("wide.{ending}"));
        write_picture(&path, format, is_grey);
        let found = read(&path, 16_384);
        let (grown, decoded) = (number(&found, "grown"), number(&found, "decoded"));
        eprintln!("{ending}: {grown} bytes for {decoded}");
        assert!(decoded >= 12_000_000, "{ending}: {found}");
        assert!(grown <= 3 * decoded + SPARE, "{ending}: {found}");
        // One column too many: refused by the header.
        let found = read(&path, 2999);
        eprintln!("{ending}: {} bytes when refused", number(&found, "grown"));
        assert!(
            found["refused"]
                .as_str()
                .is_some_and(|why| why.contains("at most")),
            "{ending}: {found}"
        );
        assert!(number(&found, "grown") <= decoded / 3, "{ending}: {found}");
    }
}

/// A wavy square of n×n quads, two triangles each, as exporters write it.
fn exported(n: usize) -> String {
    let mut text = String::new();
    for (x, y) in (0..=n).flat_map(|j| (0..=n).map(move |i| (i as f64 / 9.0, j as f64 / 9.0))) {
        let _ = writeln!(
            text,
            "v {x:.6} {:.6} {y:.6}\nvt {x:.6} {y:.6}\nvn 0.0 1.0 0.0",
            (x * y).sin()
        );
    }
    for a in (0..n).flat_map(|j| (1..=n).map(move |i| j * (n + 1) + i)) {
        let (b, c, d) = (a + 1, a + n + 2, a + n + 1);
        let _ = writeln!(
            text,
            "f {a}/{a}/{a} {d}/{d}/{d} {c}/{c}/{c}\nf {a}/{a}/{a} {c}/{c}/{c} {b}/{b}/{b}"
        );
    }
    text
}

#[test]
fn text_takes_four_times_its_length_and_what_it_makes() {
    const MANY: usize = 250_000;
    let folder = tempfile::tempdir().expect("a folder");
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let library = "newmtl a\n".repeat(MANY);
    let names: String = (0..MANY).fold(String::new(), |mut text, i| {
        let _ = writeln!(text, "newmtl m{i}");
        text
    });
    let models = [
        ("exported", exported(250), String::new(), 0),
        (
            "only vertices",
            "v 1 2 3\n".repeat(2 * MANY),
            String::new(),
            0,
        ),
        (
            "only faces",
            format!("{corners}{}", "f 1 2 3\n".repeat(MANY)),
            String::new(),
            0,
        ),
        ("one long line", "#".repeat(24 << 20), String::new(), 0),
        (
            "one material again and again",
            format!("mtllib all.mtl\n{corners}f 1 2 3\n"),
            library,
            MANY as u64,
        ),
        (
            "many materials",
            format!("mtllib all.mtl\n{corners}f 1 2 3\n"),
            names,
            MANY as u64,
        ),
    ];
    for (name, model, library, materials) in models {
        let path = folder.path().join("model.obj");
        fs::write(&path, &model).expect("written");
        fs::write(folder.path().join("all.mtl"), &library).expect("written");
        let found = read(&path, 1);
        let length = (model.len() + library.len()) as u64;
        let triangles = found["triangles"].as_u64().unwrap_or(0);
        let grown = number(&found, "grown");
        eprintln!(
            "{name}: {grown} bytes for {length} of text, {triangles} triangles, {materials} materials"
        );
        let most = TEXT * length + TRIANGLE * triangles + MATERIAL * materials + SPARE;
        assert!(grown <= most, "{name}: {found}");
    }
}

/// Scene files are read into a tree of tables first, so they count more often, and are short.
#[test]
fn scene_files_take_a_hundred_times_their_length() {
    const HUNDRED: u64 = 100;
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.toml");
    let head = "built_in = \"plane\"\n";
    let material = "[[material]]\nname = \"a\"\n";
    let texts = [
        ("materials", format!("{head}{}", material.repeat(40_000))),
        (
            "numbers",
            format!("{head}light = [{}]", "1,".repeat(500_000)),
        ),
        ("a comment", format!("{head}#{}", "x".repeat(1 << 20))),
    ];
    for (name, text) in texts {
        fs::write(&path, &text).expect("written");
        let found = read(&path, 1);
        let grown = number(&found, "grown");
        eprintln!("{name}: {grown} bytes for {} of text", text.len());
        let most = HUNDRED * text.len() as u64 + SPARE;
        assert!(grown <= most, "{name}: {found}");
    }
}

/// Files of holes, which take no room on the disk.
#[test]
fn what_is_longer_than_its_limit_is_not_read() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, length) in [
        ("long.obj", (16 << 30) + 1),
        ("long.png", 5 << 30),
        ("long.tga", 5 << 30),
    ] {
        let path = folder.path().join(name);
        let file = fs::File::create(&path).expect("made");
        if file.set_len(length).is_err() {
            // Not every file system has room for holes.
            continue;
        }
        let found = read(&path, 16_384);
        assert!(found["refused"].is_string(), "{name}: {found}");
        assert!(number(&found, "grown") <= SPARE, "{name}: {found}");
    }
}
