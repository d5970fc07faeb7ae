//! Files that are read in several chunks: the same answer as from top to bottom, small in memory, and
//! stopped on request.

use std::fmt::Write as _;
use std::fs;
use std::sync::atomic::{AtomicBool, Ordering};

use reliefscope::scene::load::{LoadOptions, Stage, load_model};
use reliefscope::scene::{LoadError, LoadedScene};

fn load_with(text: &str, options: &LoadOptions) -> Result<LoadedScene, LoadError> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("model.obj");
    fs::write(&path, text).expect("writing into it");
    let mut loaded = load_model(&path, options)?;
    // The folder is another one every time.
    let here = folder.path().display().to_string();
    for warning in &mut loaded.warnings {
        warning.file = "model.obj".into();
        warning.message = warning.message.replace(&here, "here");
    }
    Ok(loaded)
}

fn load(text: &str) -> LoadedScene {
    load_with(text, &LoadOptions::default()).expect("it loads")
}

/// A wavy square of n×n quads, two triangles each, as exporters write it.
fn grid(n: usize) -> String {
    let mut text = String::new();
    let at = |i: usize| i as f64 / n as f64;
    for (x, y) in (0..=n).flat_map(|j| (0..=n).map(move |i| (at(i), at(j)))) {
        let slope = 0.4 * (20.0 * x).cos();
        let length = slope.hypot(1.0);
        let height = 0.02 * (20.0 * x).sin();
        let _ = writeln!(text, "v {x:.6} {height:.6} {y:.6}\nvt {x:.6} {y:.6}");
        let _ = writeln!(text, "vn {:.4} {:.4} 0.0000", -slope / length, 1.0 / length);
    }
    for a in (0..n).flat_map(|j| (1..=n).map(move |i| j * (n + 1) + i)) {
        let (b, c, d) = (a + 1, a + n + 2, a + n + 1);
        let _ = writeln!(text, "f {a}/{a}/{a} {d}/{d}/{d} {c}/{c}/{c}");
        let _ = writeln!(text, "f {a}/{a}/{a} {c}/{c}/{c} {b}/{b}/{b}");
    }
    text
}

/// Statements that depend on what was before them, some of them doubtful.
fn stateful_lines() -> Vec<String> {
    let mut lines = vec!["\u{FEFF}# a file".to_owned(), "mtllib none.mtl".to_owned()];
    for i in 0..600 {
        lines.extend([
            format!("v {i} 0 {}", i % 7),
            format!("v {i} 1 {}", i % 5),
            format!("v {i}.5 0.5 \\"),
            "3".to_owned(),
            format!("vt 0.{i} 0.5"),
        ]);
        match i % 50 {
            3 => lines.push(format!("usemtl m{}", i % 4)),
            9 => lines.push("s off".to_owned()),
            17 => lines.push(format!("s {}", i % 3)),
            20 => lines.push("f 1 2 oops".to_owned()),
            21 => lines.push("f -9999 -2 -1".to_owned()),
            25 => lines.push("wat".to_owned()),
            29 => lines.push("p 1".to_owned()),
            33 => lines.push("v nothing".to_owned()),
            40 => lines.push("f 1 2 999999".to_owned()),
            _ => lines.push("f -3/-1 -2/-1 -1/-1".to_owned()),
        }
        lines.push(format!("f {} {} 5000", i + 1, i + 2));
    }
    lines
}

#[test]
fn chunks_leave_no_trace() {
    let lines = stateful_lines();
    let short = load(&lines.join("\n"));
    assert!(short.warnings.len() > 40, "{}", short.warnings.len());
    assert!(short.settings.materials.len() > 2);
    for (blanks, end) in [(3000, "\n"), (1777, "\r\n"), (2500, "\r")] {
        // The same lines, much longer: several chunks.
        let padded = lines.iter().map(|line| match line.strip_suffix('\\') {
            Some(start) => format!("{start}{:blanks$}\\{end}", ""),
            None => format!("{line}{:blanks$}{end}", ""),
        });
        let long = load(&padded.collect::<String>());
        assert_eq!(long.warnings, short.warnings);
        assert_eq!(long.settings, short.settings);
        let (long, short) = (&long.scene, &short.scene);
        assert_eq!(long.facts.area, short.facts.area);
        assert_eq!(long.facts.triangles, short.facts.triangles);
        assert_eq!(long.mesh.indices, short.mesh.indices);
        assert_eq!(long.mesh.attributes, short.mesh.attributes);
        assert_eq!(long.mesh.positions, short.mesh.positions);
        assert_eq!(long.mesh.normals, short.mesh.normals);
        assert_eq!(long.mesh.uvs, short.mesh.uvs);
    }
}

#[test]
fn mesh_and_tree_are_small() {
    let loaded = load(&grid(180));
    let (mesh, bvh) = (&loaded.scene.mesh, &loaded.scene.bvh);
    assert_eq!(mesh.len(), 64_800);
    assert_eq!(mesh.positions.len(), 181 * 181);
    let stats = bvh.stats();
    assert!(stats.leaf_fill > 0.8, "{stats:?}");
    let bytes = (mesh.bytes() + stats.bytes) as f64 / mesh.len() as f64;
    assert!(bytes <= 120.0, "{bytes:.1} bytes a triangle");
    // What counts is what is held.
    assert_eq!(mesh.indices.capacity(), mesh.indices.len());
    assert_eq!(mesh.positions.capacity(), mesh.positions.len());
}

/// Wherever the request falls, a load is either whole or cancelled.
#[test]
fn a_load_stops_at_every_stage() {
    let text = grid(120);
    for stage in Stage::ALL {
        let options = LoadOptions::default();
        let over = AtomicBool::new(false);
        std::thread::scope(|threads| {
            threads.spawn(|| {
                while (options.monitor.stage() as usize) < stage as usize
                    && !over.load(Ordering::Relaxed)
                {
                    std::hint::spin_loop();
                }
                options.monitor.cancel();
            });
            let result = load_with(&text, &options);
            over.store(true, Ordering::Relaxed);
            match result {
                Ok(loaded) => assert_eq!(loaded.scene.bvh.len(), 28_800),
                Err(LoadError::Cancelled) => {}
                Err(other) => panic!("{other}"),
            }
        });
    }
}
