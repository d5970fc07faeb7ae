//! How long a large OBJ file takes to load, stage by stage, and the memory it needs.
//!
//! `cargo bench --bench load` writes a wavy grid of a million triangles (100 MB of text) into a temporary
//! folder and loads it; `cargo bench --bench load -- FILE…` loads other files. The stages are those that a
//! watching thread sees, medians of 5 loads; the peak is what Linux says the process needed at most beyond what it had
//! before, and means something for the first file only, as freed memory is used again. Without `--bench` (as `cargo test` runs it) a small grid is checked.

#![expect(clippy::print_stdout, reason = "a benchmark's figures are its output")]

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use reliefscope::scene::LoadedScene;
use reliefscope::scene::load::{LoadMonitor, LoadOptions, Stage, load_model};

const ROUNDS: usize = 5;

fn main() -> std::io::Result<()> {
    let (flags, files): (Vec<_>, Vec<_>) =
        std::env::args().skip(1).partition(|a| a.starts_with('-'));
    let timed = flags.iter().any(|flag| flag == "--bench");
    let folder = tempfile::tempdir()?;
    let mut files: Vec<_> = files.into_iter().map(PathBuf::from).collect();
    if files.is_empty() {
        let n = if timed { 708 } else { 40 };
        files.push(folder.path().join("grid.obj"));
        write_grid(&files[0], n)?;
        let loaded = load_model(&files[0], &LoadOptions::default()).expect("the grid loads");
        assert_eq!(loaded.scene.mesh.len(), 2 * n * n);
        assert_eq!(loaded.scene.bvh.validate(&loaded.scene.mesh), Ok(()));
    }
    if !timed {
        println!("the grid is loaded right; times with: cargo bench --bench load");
        return Ok(());
    }
    for file in files {
        measure(&file)?;
    }
    Ok(())
}

/// A wavy square of n×n quads, two triangles each, with texture coordinates and normals.
fn write_grid(path: &Path, n: usize) -> std::io::Result<()> {
    let mut file = BufWriter::new(File::create(path)?);
    let at = |i: usize| i as f64 / n as f64;
    let vertices = || (0..=n).flat_map(|j| (0..=n).map(move |i| (at(i), at(j))));
    for (x, y) in vertices() {
        let height = 0.02 * (37.0 * x).sin() * (29.0 * y).cos();
        writeln!(file, "v {x:.6} {height:.6} {y:.6}")?;
    }
    for (x, y) in vertices() {
        writeln!(file, "vt {x:.6} {y:.6}")?;
    }
    for (x, y) in vertices() {
        let dx = 0.74 * (37.0 * x).cos() * (29.0 * y).cos();
        let dy = -0.58 * (37.0 * x).sin() * (29.0 * y).sin();
        let length = (dx * dx + dy * dy + 1.0).sqrt();
        let [x, y, z] = [-dx, 1.0, -dy].map(|c| c / length);
        writeln!(file, "vn {x:.4} {y:.4} {z:.4}")?;
    }
    for a in (0..n).flat_map(|j| (1..=n).map(move |i| j * (n + 1) + i)) {
        let (b, c, d) = (a + 1, a + n + 2, a + n + 1);
        writeln!(file, "f {a}/{a}/{a} {d}/{d}/{d} {c}/{c}/{c}")?;
        writeln!(file, "f {a}/{a}/{a} {c}/{c}/{c} {b}/{b}/{b}")?;
    }
    file.flush()
}

fn measure(file: &Path) -> std::io::Result<()> {
    let mut times: [Vec<f64>; Stage::ALL.len() + 1] = Default::default();
    let (mut peak, mut resident) = (0, 0);
    let mut triangles = 0;
    for _ in 0..ROUNDS {
        forget_peak();
        let before = memory("VmRSS:");
        let (loaded, millis) = watched_load(file);
        for (times, millis) in times.iter_mut().zip(millis) {
            times.push(millis);
        }
        let (mesh, tree) = (&loaded.scene.mesh, loaded.scene.bvh.stats());
        triangles = mesh.len();
        resident = mesh.bytes() + tree.bytes;
        peak = memory("VmHWM:").saturating_sub(before).max(peak);
    }
    let size = fs::metadata(file)?.len() as usize;
    println!(
        "{}: {} MB, {triangles} triangles",
        file.display(),
        size / 1_000_000
    );
    let labels = Stage::ALL.iter().map(|stage| stage.label());
    for (label, times) in labels.chain(["all"]).zip(&mut times) {
        times.sort_by(f64::total_cmp);
        println!("  {label:18} {:7.1} ms", times[times.len() / 2]);
    }
    let each = |bytes: usize| bytes as f64 / triangles as f64;
    println!("  mesh and tree {:.1} bytes a triangle", each(resident));
    if peak > 0 {
        let beyond = each(peak.saturating_sub(size));
        println!(
            "  peak {} MB: the file's size and {beyond:.1} bytes a triangle",
            peak / 1_000_000
        );
    }
    Ok(())
}

/// Loads a file; milliseconds of each stage and of all.
fn watched_load(file: &Path) -> (LoadedScene, [f64; Stage::ALL.len() + 1]) {
    let options = LoadOptions::default();
    let over = AtomicBool::new(false);
    let began = Instant::now();
    let millis = || began.elapsed().as_secs_f64() * 1e3;
    std::thread::scope(|threads| {
        let watcher = threads.spawn(|| starts(&options.monitor, &over, millis));
        let loaded = load_model(file, &options).expect("the file loads");
        let end = millis();
        over.store(true, Ordering::Relaxed);
        let starts = watcher.join().expect("the watcher ends");
        let mut times = [end; Stage::ALL.len() + 1];
        for (i, start) in starts.iter().enumerate() {
            times[i] = starts.get(i + 1).unwrap_or(&end) - start;
        }
        (loaded, times)
    })
}

/// When each stage was first seen.
fn starts(
    monitor: &LoadMonitor,
    over: &AtomicBool,
    millis: impl Fn() -> f64,
) -> [f64; Stage::ALL.len()] {
    let mut starts = [0.0; Stage::ALL.len()];
    let mut seen = 0;
    while !over.load(Ordering::Relaxed) {
        let stage = monitor.stage() as usize;
        starts[seen + 1..]
            .iter_mut()
            .take(stage - seen)
            .for_each(|start| *start = millis());
        seen = stage;
        std::thread::sleep(Duration::from_micros(200));
    }
    starts
}

/// Has Linux count the peak anew; elsewhere there are no figures.
fn forget_peak() {
    let _ = fs::write("/proc/self/clear_refs", "5");
}

/// Bytes; 0 where nobody tells.
fn memory(field: &str) -> usize {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix(field));
    let kib = line.and_then(|l| l.trim().trim_end_matches(" kB").parse::<usize>().ok());
    kib.unwrap_or(0) * 1024
}
