//! `measure` as a user runs it: files, exit codes, shards, Ctrl-C.

use serde_json::Value;

use crate::cli::{good, refused, run, stdout};
use crate::scene_file::Folder;

/// The arguments of a sweep that takes no time.
const TINY: [&str; 15] = [
    "measure",
    "plane",
    "--angles",
    "30,60",
    "--amplitudes",
    "1",
    "--methods",
    "none,parallax,exact",
    "--rays",
    "50",
    "--size",
    "16x9",
    "--samples",
    "2",
    "--quick",
];

fn with<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&TINY, more].concat()
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).expect("JSON")
}

fn file(folder: &Folder, name: &str) -> String {
    std::fs::read_to_string(folder.path(name)).expect("was written")
}

/// Cells without what was timed.
fn errors(record: &Value) -> Vec<[Value; 4]> {
    let cells = record["cells"].as_array().expect("cells");
    let keys = ["variant", "geometry", "picture", "angle_deg"];
    cells
        .iter()
        .map(|c| keys.map(|key| c[key].clone()))
        .collect()
}

#[test]
fn a_report_is_three_files() {
    let folder = Folder::new();
    let text = good(&folder, &with(&["--report", "out"]));
    assert!(text.contains("cheapest method with p95 ≤ 1 texel from this view"));
    assert!(text.contains("exact") && text.contains("60 degrees"));
    let record = json(&file(&folder, "out/measure.json"));
    assert_eq!(record["partial"], false);
    assert!(
        record["command"]
            .as_str()
            .is_some_and(|c| c.contains("--rays 50"))
    );
    let cells = record["cells"].as_array().expect("cells").len();
    // None, parallax, exact, exact without own shadow; two angles.
    assert_eq!(cells, 8);
    let table = file(&folder, "out/measure.csv");
    assert_eq!(table.lines().count(), 1 + cells);
    let page = file(&folder, "out/index.html");
    assert!(page.contains("<svg") && page.ends_with("</html>\n"));
}

#[test]
fn shards_make_the_whole() {
    let folder = Folder::new();
    let whole = json(&good(&folder, &with(&["--json"])));
    for part in ["1/2", "2/2"] {
        let report = [
            "--shard",
            part,
            "--report",
            &part[..1],
            "--threads",
            &part[..1],
        ];
        good(&folder, &with(&report));
    }
    let parts = [
        "measure",
        "--json",
        "--merge",
        "2/measure.json",
        "1/measure.json",
    ];
    let joined = json(&good(&folder, &parts));
    assert_eq!(joined["partial"], false);
    assert_eq!(joined["shard"], Value::Null);
    assert_eq!(errors(&joined), errors(&whole));
    let half = json(&good(
        &folder,
        &["measure", "--json", "--merge", "2/measure.json"],
    ));
    assert_eq!(half["partial"], true);
}

#[test]
fn what_cannot_be_measured_is_refused() {
    let folder = Folder::new();
    folder.write("note.json", "{\"format\": 99}");
    folder.write("cut.json", "{\"format\": 1");
    folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let cases: [(&[&str], &str); 11] = [
        (&["measure"], "INPUT"),
        (&["measure", "nowhere"], "nowhere"),
        (&["measure", "plane", "--shard", "3/2"], "2/8"),
        (&["measure", "plane", "--angles", "90"], "0 to 89"),
        (&["measure", "plane", "--amplitudes", "0"], "above 0"),
        (&["measure", "plane", "--methods", "bumb"], "'bump'"),
        (&["measure", "flat.obj", "--quick"], "relief"),
        (&["measure", "plane", "--merge", "note.json"], "--merge"),
        (&["measure", "--merge", "lost.json"], "lost.json"),
        (&["measure", "--merge", "note.json"], "format 99"),
        (&["measure", "--merge", "cut.json"], "not a record"),
    ];
    for (arguments, word) in cases {
        let errors = refused(&folder, arguments);
        assert!(errors.contains(word), "{arguments:?}: {errors}");
    }
    folder.write("taken", "");
    let errors = refused(&folder, &with(&["--report", "taken"]));
    assert!(errors.contains("taken"), "{errors}");
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_a_valid_report() {
    use std::process::{Command, Stdio};
    use std::time::Duration;

    let folder = Folder::new();
    // Would take hours.
    let long = [
        "measure",
        "plane",
        "--samples",
        "4096",
        "--size",
        "800x600",
        "--methods",
        "none,exact",
    ];
    let child = Command::new(env!("CARGO_BIN_EXE_reliefscope"))
        .args(long)
        .args(["--report", "out", "--threads", "1", "--json"])
        .current_dir(folder.path(""))
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    // The folder is made after Ctrl-C is listened to.
    for _ in 0..60_000 {
        if folder.path("out").is_dir() {
            break;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    let pid = child.id().to_string();
    let told = Command::new("kill").args(["-INT", &pid]).status();
    assert!(told.expect("there is kill").success());
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(2));
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(errors.contains("stopped: 0 of "), "{errors}");
    assert_eq!(json(&stdout(&output))["partial"], true);
    assert_eq!(json(&file(&folder, "out/measure.json"))["partial"], true);
    assert!(file(&folder, "out/index.html").contains("was stopped"));
    let merged = run(&folder, &["measure", "--merge", "out/measure.json"]);
    assert_eq!(merged.status.code(), Some(0), "a part can be merged");
}
