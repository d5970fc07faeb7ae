//! The program as a user runs it: exit codes, what goes to which stream, what the files hold.

use std::process::{Command, Output, Stdio};

use serde_json::Value;

use crate::scene_file::Folder;
use reliefscope::scene::built_in::SCENES;
use reliefscope::scene::load::{PictureLimits, decode_picture};
use reliefscope::surface::mapping::Method;
use reliefscope::texture::{RawImage, Samples};

const SCENE: &str = r#"model = "plane.obj"
[camera]
eye = [0.0, -2.0, 2.0]
target = [0.0, 0.0, 0.0]
up = [0.0, 0.0, 1.0]
vfov_deg = 40.0
[[light]]
kind = "directional"
direction = [0.3, 0.2, -1.0]
intensity = 3.0
[render]
size = [24, 16]
samples = 2
"#;

pub fn run(folder: &Folder, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_reliefscope"))
        .args(arguments)
        .current_dir(folder.path(""))
        .stdin(Stdio::null())
        .output()
        .expect("the program starts")
}

pub fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("UTF-8")
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("UTF-8")
}

/// Standard output of a run that must be good.
pub fn good(folder: &Folder, arguments: &[&str]) -> String {
    let output = run(folder, arguments);
    let (code, errors) = (output.status.code(), stderr(&output));
    assert_eq!(code, Some(0), "{arguments:?}: {errors}");
    stdout(&output)
}

/// Standard error of a run that cannot be good: nothing on standard output, exit code 2.
pub fn refused(folder: &Folder, arguments: &[&str]) -> String {
    let output = run(folder, arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}");
    assert_eq!(stdout(&output), "", "{arguments:?}");
    let errors = stderr(&output);
    assert!(!errors.contains("panicked"), "{arguments:?}: {errors}");
    errors
}

fn picture(folder: &Folder, name: &str) -> RawImage {
    let decoded = decode_picture(&folder.path(name), &PictureLimits::default());
    decoded.expect("is a picture").image
}

fn with_scene() -> Folder {
    let folder = Folder::new();
    folder.write("scene.toml", SCENE);
    folder
}

#[test]
fn help_teaches() {
    let folder = Folder::new();
    let text = good(&folder, &["--help"]);
    for method in Method::ALL {
        assert!(text.contains(method.info().name));
        let first_words = &method.info().summary[..20];
        assert!(text.contains(first_words), "{first_words}");
    }
    for scene in SCENES {
        assert!(text.contains(scene.name));
    }
    for word in [
        "Examples:",
        "Exit codes:",
        "render",
        "inspect",
        "probe",
        "--set",
    ] {
        assert!(text.contains(word), "{word}");
    }
    for command in [
        "view", "render", "inspect", "probe", "bench", "measure", "methods", "scenes",
    ] {
        assert!(good(&folder, &[command, "--help"]).contains("Usage:"));
    }
    assert!(good(&folder, &["--version"]).contains(env!("CARGO_PKG_VERSION")));
}

#[test]
fn lists_name_everything() {
    let folder = Folder::new();
    let methods = good(&folder, &["methods"]);
    assert!(Method::ALL.iter().all(|m| methods.contains(m.name())));
    let scenes = good(&folder, &["scenes"]);
    assert!(SCENES.iter().all(|s| scenes.contains(s.name)));
}

#[test]
fn bad_arguments_are_refused() {
    let folder = with_scene();
    let cases: [(&[&str], &str); 16] = [
        (&["render", "scene.toml"], "--output"),
        (&["render", "-o", "a.png"], "<INPUT>"),
        (&["render", "scene.toml", "-o", "a.jpg"], ".png or .exr"),
        (&["render", "scene.toml", "-o", "a"], ".png or .exr"),
        (&["render", "scene.toml", "-o", "no/a.png"], "no folder no"),
        (
            &["render", "scene.toml", "-o", "a.png", "--size", "0x4"],
            "--size",
        ),
        (
            &["render", "scene.toml", "-o", "a.exr", "--view", "uv"],
            "written as .png",
        ),
        (
            &["render", "scene.toml", "-o", "a.png", "--view", "colour"],
            "invalid-normals",
        ),
        (
            &["render", "scene.toml", "-o", "a.png", "--samples", "0"],
            "--samples",
        ),
        (
            &["render", "scene.toml", "-o", "a.png", "--method", "bumb"],
            "'bump'",
        ),
        (
            &["render", "scene.toml", "-o", "a.png", "--set", "kd"],
            "KEY=VALUE",
        ),
        (
            &["render", "scene.toml", "-o", "a.png", "--exposure", "99"],
            "--exposure",
        ),
        (&["probe", "scene.toml"], "--pixel"),
        (&["probe", "scene.toml", "--pixel", "3"], "--pixel"),
        (
            &["probe", "scene.toml", "--pixel", "24,0"],
            "outside the picture of 24 by 16",
        ),
        (&["--colour"], "--colour"),
    ];
    for (arguments, word) in cases {
        let errors = refused(&folder, arguments);
        assert!(errors.contains(word), "{arguments:?}: {errors}");
    }
    assert!(!folder.path("a.png").exists());
}

#[test]
fn broken_inputs_are_refused_in_one_line() {
    let folder = with_scene();
    folder.write("key.toml", &SCENE.replace("vfov_deg", "vfow_deg"));
    folder.write("cut.toml", "model = \"plane.obj\"\n[camera\n");
    folder.write("lost.toml", "model = \"nowhere.obj\"\n");
    folder.write("empty.obj", "");
    let cases = [
        ("nowhere", "wall"),
        ("nowhere.obj", "nowhere.obj"),
        ("nowhere.toml", "nowhere.toml"),
        ("key.toml", "key.toml:6: "),
        ("cut.toml", "cut.toml:2: "),
        ("lost.toml", "lost.toml:1: "),
        ("empty.obj", "empty.obj"),
        ("albedo.png", "albedo.png"),
        (".", "."),
    ];
    for (input, word) in cases {
        for arguments in [
            &["inspect", input][..],
            &["probe", input, "--pixel", "0,0"],
            &["render", input, "-o", "out.png"],
        ] {
            let errors = refused(&folder, arguments);
            assert!(errors.contains(word), "{arguments:?}: {errors}");
            assert_eq!(errors.lines().count(), 1, "{arguments:?}: {errors}");
        }
    }
    let errors = refused(
        &folder,
        &[
            "render",
            "scene.toml",
            "-o",
            "out.png",
            "--set",
            "light.0.intensity=-1",
        ],
    );
    assert!(errors.contains("`light.0.intensity`"), "{errors}");
    assert!(!folder.path("out.png").exists());
}

#[test]
fn render_writes_both_formats() {
    let folder = with_scene();
    let line = good(&folder, &["render", "scene.toml", "-o", "out.png"]);
    assert_eq!(line.lines().count(), 1, "{line}");
    for word in ["out.png", "24x16", "2 samples", "rays"] {
        assert!(line.contains(word), "{word}: {line}");
    }
    let png = picture(&folder, "out.png");
    assert_eq!(
        (png.width, png.height, png.channels, png.bits()),
        (24, 16, 3, 8)
    );
    good(
        &folder,
        &["render", "scene.toml", "-o", "out.exr", "--exposure", "3"],
    );
    let exr = picture(&folder, "out.exr");
    assert_eq!((exr.width, exr.height, exr.bits()), (24, 16, 32));
    let Samples::F32(linear) = &exr.samples else {
        panic!("floats")
    };
    assert!(linear.iter().any(|&x| x > 0.0), "something is lit");
    // The EXR has no exposure; the PNG is its encoding.
    for y in 0..16 {
        for x in 0..24 {
            for c in 0..3 {
                let wanted = reliefscope::math::srgb_from_linear(exr.fraction(x, y, c));
                let shown = png.fraction(x, y, c);
                assert!((wanted - shown).abs() < 1.0 / 255.0, "{x} {y} {c}");
            }
        }
    }
}

#[test]
fn render_writes_views() {
    let folder = with_scene();
    good(&folder, &["render", "scene.toml", "-o", "plain.png"]);
    let plain = picture(&folder, "plain.png");
    let view = |name: &str| {
        let file = format!("{name}.png");
        let lines = good(
            &folder,
            &["render", "scene.toml", "-o", &file, "--view", name],
        );
        (lines, picture(&folder, &file))
    };
    let (lines, normals) = view("normals");
    assert!(
        lines.contains("normals: normal used for shading"),
        "{lines}"
    );
    assert!(lines.contains("1 sample per pixel"), "{lines}");
    assert_ne!(normals.samples, plain.samples);
    // The plane faces +z: red and green in the middle, blue full.
    let rgb = [0, 1, 2].map(|c| (normals.fraction(12, 8, c) * 255.0).round() as u8);
    let off = rgb
        .iter()
        .zip([128, 128, 255])
        .map(|(&a, b)| u8::abs_diff(a, b));
    assert!(off.max() <= Some(3), "{rgb:?}");
    let (lines, marks) = view("invalid-normals");
    assert!(
        lines.contains("invalid-normals") && lines.contains("0 pixels"),
        "{lines}"
    );
    assert_eq!(marks.samples, plain.samples);
    let (lines, samples) = view("samples");
    assert!(
        lines.contains("2 samples") && lines.contains("from 0 to 2"),
        "{lines}"
    );
    assert_ne!(samples.samples, plain.samples);
    // A scene file may ask for one; an EXR holds the picture's light all the same.
    let set = ["--set", "display.view=normals"];
    let mut arguments = vec!["render", "scene.toml", "-o", "set.png"];
    arguments.extend(set);
    good(&folder, &arguments);
    assert_eq!(picture(&folder, "set.png").samples, normals.samples);
    good(&folder, &["render", "scene.toml", "-o", "a.exr"]);
    let mut arguments = vec!["render", "scene.toml", "-o", "b.exr"];
    arguments.extend(set);
    good(&folder, &arguments);
    assert_eq!(
        picture(&folder, "a.exr").samples,
        picture(&folder, "b.exr").samples
    );
}

#[test]
fn options_reach_the_picture() {
    let folder = with_scene();
    let bytes = |name: &str, more: &[&str]| {
        let mut arguments = vec!["render", "scene.toml", "-o", name];
        arguments.extend(more);
        good(&folder, &arguments);
        std::fs::read(folder.path(name)).expect("was written")
    };
    let plain = bytes("a.png", &[]);
    assert_eq!(plain, bytes("b.png", &["--threads", "1"]));
    assert_eq!(plain, bytes("b.png", &["--threads", "2"]));
    assert_eq!(plain, bytes("b.png", &["--set", "light.0.intensity=3"]));
    assert_ne!(plain, bytes("b.png", &["--set", "light.0.intensity=1"]));
    assert_ne!(plain, bytes("b.png", &["--exposure", "-1"]));
    assert_ne!(plain, bytes("b.png", &["--method", "none"]));
    assert_ne!(plain, bytes("b.png", &["--samples", "1"]));
    bytes("b.png", &["--size", "7x5"]);
    let small = picture(&folder, "b.png");
    assert_eq!((small.width, small.height), (7, 5));
    let by_set = bytes("c.png", &["--set", "mapping.method=normal"]);
    assert_eq!(by_set, bytes("b.png", &["--method", "normal"]));
}

#[test]
fn a_folder_does_not_hide_a_built_in_scene() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("plane")).expect("a folder");
    let told = good(&folder, &["inspect", "plane"]);
    assert!(told.contains("Paved plane"), "{told}");
    std::fs::create_dir(folder.path("maps")).expect("a folder");
    let errors = refused(&folder, &["inspect", "maps"]);
    assert!(
        errors.contains("neither a file nor a built-in scene"),
        "{errors}"
    );
}

#[test]
fn inspect_tells_what_is_there() {
    let folder = with_scene();
    folder.write(
        "odd.obj",
        "mtllib nowhere.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\n",
    );
    let output = run(&folder, &["inspect", "odd.obj", "--json"]);
    assert_eq!(output.status.code(), Some(0));
    let json: Value = serde_json::from_str(&stdout(&output)).expect("JSON");
    assert_eq!(json["vertices"], 4);
    assert_eq!(json["triangles"], 2);
    assert_eq!(json["degenerate"], 1);
    assert_eq!(json["area"], 0.5);
    assert_eq!(json["bbox"][1][0].as_f64(), Some(2.0));
    assert_eq!(json["bvh"]["triangles"], 1);
    let warnings = json["warnings"].as_array().expect("a list");
    let library = warnings
        .iter()
        .find(|w| w["message"].to_string().contains("nowhere.mtl"))
        .expect("the missing library is noted");
    assert_eq!(library["line"], 1);
    assert!(library["file"].to_string().contains("odd.obj"));
    let errors = stderr(&output);
    assert!(
        errors.lines().any(|l| l.starts_with("odd.obj:1: ")),
        "{errors}"
    );

    let text = good(&folder, &["inspect", "scene.toml", "--json"]);
    let json: Value = serde_json::from_str(&text).expect("JSON");
    let ground = &json["materials"][0];
    assert_eq!(ground["name"], "ground");
    let maps = ground["maps"].as_array().expect("a list");
    let height = maps.iter().find(|m| m["role"] == "height").expect("a map");
    assert_eq!(height["image"], "height16.png");
    let amplitude = ground["default_amplitude"].as_f64().expect("a number");
    assert!((amplitude - 0.03).abs() < 1e-8, "{amplitude}");
    assert_eq!(json["images"].as_array().map(Vec::len), Some(2));

    let text = good(&folder, &["inspect", "scene.toml"]);
    for word in [
        "triangles   2",
        "material \"ground\"",
        "height16.png",
        "area        4",
    ] {
        assert!(text.contains(word), "{word}: {text}");
    }
}

#[test]
fn probe_tells_the_story_of_a_pixel() {
    let folder = with_scene();
    let text = good(&folder, &["probe", "scene.toml", "--pixel", "12,8"]);
    assert!(text.contains("ground") || text.contains("rim"), "{text}");
    let text = good(
        &folder,
        &["probe", "scene.toml", "--pixel", "12,8", "--json"],
    );
    let json: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(json["pixel"], serde_json::json!([12, 8]));
    assert_eq!(json["method"], "bump");
    assert!(
        json["bounces"][0]["hit"]["t"]
            .as_f64()
            .is_some_and(|t| t > 0.0)
    );
    // Its colour is what the renderer writes with one sample.
    good(
        &folder,
        &["render", "scene.toml", "-o", "one.exr", "--samples", "1"],
    );
    let exr = picture(&folder, "one.exr");
    for c in 0..3_u8 {
        let told = json["color"][usize::from(c)].as_f64().expect("a number");
        let rendered = f64::from(exr.fraction(12, 8, c));
        assert!(
            (told - rendered).abs() <= 1e-6 * rendered.abs(),
            "{told} {rendered}"
        );
    }
}

#[test]
fn a_reader_that_goes_is_no_panic() {
    let folder = Folder::new();
    let mut child = Command::new(env!("CARGO_BIN_EXE_reliefscope"))
        .arg("methods")
        .current_dir(folder.path(""))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("ends");
    assert_eq!(stderr(&output), "");
    assert_eq!(output.status.code(), Some(0));
}

#[cfg(not(feature = "viewer"))]
#[test]
fn without_a_window_the_program_says_so() {
    let folder = with_scene();
    for arguments in [&[][..], &["scene.toml"], &["view", "scene.toml"]] {
        let errors = refused(&folder, arguments);
        assert_eq!(errors.lines().count(), 1, "{errors}");
        assert!(errors.contains("render"), "{errors}");
    }
}

#[test]
fn a_probe_draws_the_cut_through_the_relief() {
    let folder = Folder::new();
    let probe = |pixel| {
        [
            "probe", "plane", "--pixel", pixel, "--method", "steep", "--svg", "cut.svg",
        ]
    };
    good(&folder, &probe("640,360"));
    let svg = std::fs::read_to_string(folder.path("cut.svg")).expect("the drawing is there");
    assert!(svg.starts_with("<svg ") && svg.contains("Steep parallax") && svg.contains("polygon"));
    refused(&folder, &probe("9999,0"));
}
