//! Milliseconds of what the window does while a person works: start, first pass, re-shading, encoding.
//!
//! `cargo bench --bench frame` prints medians and the span between the fastest and the slowest of 15 rounds
//! at 1280×720 on two threads. Without `--bench` (as `cargo test` runs it) it only checks, at a small size.

#![expect(clippy::print_stdout, reason = "a benchmark's figures are its output")]

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use reliefscope::render::{PassEnd, Picture, Progressive, Snapshot};
use reliefscope::scene::load::LoadOptions;
use reliefscope::scene::{LoadedScene, open};
use reliefscope::surface::mapping::Method;

const ROUNDS: u32 = 15;

fn main() {
    let timed = std::env::args().any(|arg| arg == "--bench");
    let size = if timed { [1280, 720] } else { [160, 90] };
    let rounds = if timed { ROUNDS } else { 1 };
    let reference = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/reference/bump.toml");
    for (name, input) in [
        ("reference plane", reference.as_path()),
        ("wall", Path::new("wall")),
    ] {
        let loaded = open(input, &LoadOptions::default()).expect("the input opens");
        for method in Method::ALL {
            let case = Case {
                loaded: &loaded,
                method,
                size,
            };
            case.check();
            let line = case.time(rounds);
            if timed {
                println!("{name:16} {:17} {line}", method.name());
            }
        }
    }
    if !timed {
        println!("frames agree; times with: cargo bench --bench frame");
    }
}

struct Case<'a> {
    loaded: &'a LoadedScene,
    method: Method,
    size: [u32; 2],
}

impl Case<'_> {
    /// A camera turned a little and the first light changed a little in every round.
    fn snapshot(&self, turn: u32, light: u32) -> Snapshot {
        let mut settings = self.loaded.settings.clone();
        settings.mapping.method = self.method;
        settings.camera.orbit(0.01 * f64::from(turn), 0.0);
        settings.lights[0].intensity *= 1.0 + 0.01 * light as f32;
        Snapshot {
            scene: Arc::clone(&self.loaded.scene),
            settings: Arc::new(settings),
            size: self.size,
        }
    }

    /// Re-shading cached hits gives the bits of rendering afresh; otherwise no time means anything.
    fn check(&self) {
        let first_sample = |snapshots: &[Snapshot]| -> Picture {
            let mut renderer = renderer();
            for snapshot in snapshots {
                renderer.start(snapshot.clone());
                renderer.pass(&|| false);
            }
            renderer.picture()
        };
        let (before, after) = (self.snapshot(1, 0), self.snapshot(1, 1));
        assert!(
            first_sample(&[before, after.clone()]) == first_sample(&[after]),
            "re-shading changes the picture"
        );
    }

    fn time(&self, rounds: u32) -> String {
        let mut renderer = renderer();
        let mut rgba = vec![[0; 4]; self.size[0] as usize * self.size[1] as usize];
        let mut millis: [Vec<f64>; 5] = Default::default();
        for round in 0..rounds {
            let mut clock = |slot: usize, work: &mut dyn FnMut()| {
                let began = Instant::now();
                work();
                millis[slot].push(began.elapsed().as_secs_f64() * 1e3);
            };
            renderer.start(self.snapshot(2 * round, 0));
            clock(0, &mut || {
                assert_eq!(renderer.preview(4, &|| false), PassEnd::Complete)
            });
            clock(1, &mut || renderer.start(self.snapshot(2 * round + 1, 0)));
            clock(2, &mut || {
                assert_eq!(renderer.pass(&|| false), PassEnd::Complete)
            });
            clock(3, &mut || renderer.encode_into(0.0, &mut rgba));
            renderer.start(self.snapshot(2 * round + 1, 1));
            clock(4, &mut || {
                assert_eq!(renderer.pass(&|| false), PassEnd::Complete)
            });
        }
        let names = ["preview 1/4", "start", "full", "encode", "re-shade"];
        let columns = names
            .iter()
            .zip(&mut millis)
            .map(|(name, times)| format!("{name} {}", spread(times)));
        columns.collect::<Vec<_>>().join("  ")
    }
}

fn renderer() -> Progressive {
    Progressive::new(2).expect("two threads")
}

/// Median and span.
fn spread(millis: &mut [f64]) -> String {
    millis.sort_by(f64::total_cmp);
    let median = millis[millis.len() / 2];
    format!(
        "{median:.1} ms ({:.1}–{:.1})",
        millis[0],
        millis[millis.len() - 1]
    )
}
