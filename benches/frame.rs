//! Milliseconds of what the window does while a person works: start, first pass, re-shading,
//! moving a light, encoding.
//!
//! `cargo bench --bench frame` prints medians and the span between the fastest and the slowest of 15 rounds, or of 3
//! or more where they take long, at 1280×720 on two threads. Without `--bench` (as `cargo test` runs it) it only checks, at a small size.

#![expect(clippy::print_stdout, reason = "a benchmark's figures are its output")]

use std::path::{Path, PathBuf};
use std::sync::Arc;

use reliefscope::measure::bench::{FrameCase, FrameTimes, Spread, scalar_twin};
use reliefscope::render::Snapshot;
use reliefscope::scene::load::LoadOptions;
use reliefscope::scene::open;
use reliefscope::surface::mapping::Method;

const ROUNDS: usize = 15;
const THREADS: usize = 2;

fn main() {
    let timed = std::env::args().any(|arg| arg == "--bench");
    let size = if timed { [1280, 720] } else { [160, 90] };
    let reference = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/reference");
    for (name, input) in [
        ("reference plane", reference.join("bump.toml")),
        ("reference torus", reference.join("torus.toml")),
        ("wall", PathBuf::from("wall")),
    ] {
        let loaded = open(&input, &LoadOptions::default()).expect("the input opens");
        let twin = scalar_twin(&loaded.scene);
        for method in Method::ALL {
            let mut settings = loaded.settings.clone();
            settings.mapping.method = method;
            let case = FrameCase::new(Snapshot {
                scene: Arc::clone(&loaded.scene),
                settings: Arc::new(settings),
                size,
            });
            case.check(&twin).expect("answers are right");
            if timed {
                let times = case.time(THREADS, ROUNDS).expect("two threads");
                println!("{name:16} {:17} {}", method.name(), line(&times));
            }
        }
    }
    if !timed {
        println!("frames agree; times with: cargo bench --bench frame");
    }
}

fn line(times: &FrameTimes) -> String {
    let columns = [
        ("preview 1/4", times.preview),
        ("start", times.start),
        ("full", times.full),
        ("encode", times.encode),
        ("re-shade", times.reshade),
        ("re-light", times.relight),
    ];
    let column =
        |(name, Spread { median, min, max })| format!("{name} {median:.1} ms ({min:.1}–{max:.1})");
    let (stages, counters) = (&times.stages, &times.counters);
    let parts = [
        ("trace", stages.trace),
        ("perturb", stages.perturb),
        ("shade", stages.shade),
        ("resolve", stages.resolve),
    ];
    let part = |(name, spread): (&str, Spread)| format!("{name} {:.1}", spread.median);
    format!(
        "{}  thread-ms: {} ({:.0} % of two threads); {:.2} M rays, {:.2} M fetches",
        columns.map(column).join("  "),
        parts.map(part).join(" "),
        1e2 * stages.share.median,
        counters.rays() as f64 / 1e6,
        counters.texture_fetches as f64 / 1e6,
    )
}
