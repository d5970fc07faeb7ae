//! Damaged files: whatever bytes come, the answer is a scene or an error, never a panic or a hang.
//!
//! A case is a file of the corpus changed by a seeded mutator. By default there are a few thousand;
//! `RELIEFSCOPE_FUZZ_CASES=1000000 cargo test --release --test integration fuzz` runs as many as wanted on all
//! cores, `RELIEFSCOPE_FUZZ_SEED` chooses others, and `RELIEFSCOPE_FUZZ_FROM` the first of them. Each failure leaves
//! its file under `target/fuzz-failures`.

mod corpus;
mod crashes;
mod mutate;

use std::env::var;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use reliefscope::measure::stability::Random;
use reliefscope::render::{Progressive, Snapshot};
use reliefscope::scene::load::{LoadOptions, PictureLimits, decode_picture};
use reliefscope::scene::{LoadError, LoadedScene, open};

use corpus::{Entry, Format, corpus};
use mutate::mutate;

/// Cases of an ordinary test run.
const CASES: usize = 4_000;
/// A hang, on a machine however busy.
const HANG: Duration = Duration::from_secs(20);
/// What takes longer is told, and kept and timed again alone where the number of cases was asked for. It is
/// for a reader to judge: no test of ours fails for how busy or old a machine is.
const SLOW: Duration = Duration::from_secs(2);
/// Small, so that a case that is let through stays quick.
const LIMITS: PictureLimits = PictureLimits {
    max_side: 2048,
    max_bytes: 16 << 20,
};

fn setting(name: &str, default: usize) -> usize {
    var(name)
        .ok()
        .and_then(|text| text.parse().ok())
        .unwrap_or(default)
}

/// A folder of one worker, with everything that cases refer to.
pub struct Bench {
    folder: tempfile::TempDir,
    renderer: Progressive,
}

/// What came of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answer {
    /// A scene or picture.
    Read,
    /// An error.
    Refused,
    /// An error that caught a decoder's panic.
    DecoderCrashed,
}

impl Bench {
    pub fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        corpus::furnish(folder.path());
        Self {
            folder,
            renderer: Progressive::new(1).expect("threads"),
        }
    }

    /// Reads bytes as a file of that format, and renders what comes of it.
    pub fn read(&mut self, format: Format, bytes: &[u8]) -> Answer {
        let path = self.folder.path().join(format.file());
        fs::write(&path, bytes).expect("written");
        match format {
            Format::Picture(_) => match decode_picture(&path, &LIMITS) {
                Ok(decoded) => {
                    let side = decoded.image.width.max(decoded.image.height);
                    assert!(side <= LIMITS.max_side, "larger than allowed");
                    Answer::Read
                }
                Err(error) if error.to_string().contains("crashed") => Answer::DecoderCrashed,
                Err(_) => Answer::Refused,
            },
            Format::Obj => self.render(open(&path, &LoadOptions::default())),
            Format::Mtl => {
                let model = self.folder.path().join("model.obj");
                self.render(open(&model, &LoadOptions::default()))
            }
            Format::Toml => self.render(open(&path, &LoadOptions::default())),
        }
    }

    fn render(&mut self, loaded: Result<LoadedScene, LoadError>) -> Answer {
        let Ok(loaded) = loaded else {
            return Answer::Refused;
        };
        let mut settings = loaded.settings;
        // Deep mirrors and searches are slow by wish, not by fault.
        settings.shading.max_bounces = settings.shading.max_bounces.min(4);
        settings.mapping.search.layers = settings.mapping.search.layers.min(64);
        self.renderer.start(Snapshot {
            scene: loaded.scene,
            settings: settings.into(),
            size: [8, 8],
        });
        self.renderer.pass(&|| false);
        assert_eq!(self.renderer.counters().non_finite, 0, "non-finite pixels");
        Answer::Read
    }
}

/// What all cases came to.
#[derive(Default)]
struct Tally {
    read: usize,
    refused: usize,
    crashed: usize,
    /// With the case's number.
    slowest: (Duration, usize),
    /// Cases beyond [`SLOW`], by number.
    slow: Vec<usize>,
    failures: Vec<String>,
}

/// The bytes of a case: a function of seed and number alone.
fn case(corpus: &[Entry], seed: usize, number: usize) -> (Format, Vec<u8>) {
    let mut random = Random::new((seed as u64) << 32 ^ number as u64);
    let entry = &corpus[random.below(corpus.len())];
    (entry.format, mutate(entry, corpus, &mut random))
}

fn keep(format: Format, number: usize, bytes: &[u8]) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/fuzz-failures");
    fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join(format!("{number}-{}", format.file()));
    fs::write(&path, bytes).expect("written");
    path
}

fn work(corpus: &[Entry], seed: usize, end: usize, next: &AtomicUsize, tally: &Mutex<Tally>) {
    let mut bench = Bench::new();
    loop {
        let number = next.fetch_add(1, Ordering::Relaxed);
        if number >= end {
            return;
        }
        let (format, bytes) = case(corpus, seed, number);
        let began = Instant::now();
        let answer = catch_unwind(AssertUnwindSafe(|| bench.read(format, &bytes)));
        let spent = began.elapsed();
        let mut tally = tally.lock().expect("nobody panics with it");
        tally.slowest = tally.slowest.max((spent, number));
        match answer {
            Ok(Answer::Read) => tally.read += 1,
            Ok(Answer::Refused) => tally.refused += 1,
            Ok(Answer::DecoderCrashed) => {
                tally.crashed += 1;
                let kept = keep(format, number, &bytes);
                eprintln!("a decoder crashed and was caught: {}", kept.display());
            }
            Err(_) => {
                bench = Bench::new();
                let kept = keep(format, number, &bytes);
                tally.failures.push(format!("panic: {}", kept.display()));
            }
        }
        if spent > SLOW {
            tally.slow.push(number);
            eprintln!("case {number}, {format:?}, took {spent:?}");
        }
        if spent > HANG {
            let kept = keep(format, number, &bytes);
            tally
                .failures
                .push(format!("{spent:?}: {}", kept.display()));
        }
    }
}

/// Keeps a case and tells how long it takes with nothing beside it, at the best of three.
fn alone(corpus: &[Entry], seed: usize, number: usize) {
    let (format, bytes) = case(corpus, seed, number);
    let mut bench = Bench::new();
    let times = (0..3).map(|_| {
        let began = Instant::now();
        bench.read(format, &bytes);
        began.elapsed()
    });
    let least = times.min().unwrap_or_default();
    let kept = keep(format, number, &bytes);
    eprintln!("case {number} alone: {least:?}, {}", kept.display());
}

#[test]
fn mutated_files_are_read_or_refused() {
    let cases = setting("RELIEFSCOPE_FUZZ_CASES", CASES);
    let seed = setting("RELIEFSCOPE_FUZZ_SEED", 1);
    let from = setting("RELIEFSCOPE_FUZZ_FROM", 0);
    let (corpus, next, tally) = (
        corpus(),
        AtomicUsize::new(from),
        Mutex::new(Tally::default()),
    );
    let workers = match cases {
        CASES => 1,
        _ => std::thread::available_parallelism().map_or(1, usize::from),
    };
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| work(&corpus, seed, from + cases, &next, &tally));
        }
    });
    let tally = tally.into_inner().expect("nobody panics with it");
    eprintln!(
        "seed {seed}: {cases} cases, {} read, {} refused, {} decoder crashes caught, slowest {:?} (case {})",
        tally.read, tally.refused, tally.crashed, tally.slowest.0, tally.slowest.1
    );
    if cases != CASES {
        for number in tally.slow {
            alone(&corpus, seed, number);
        }
    }
    assert!(
        tally.failures.is_empty(),
        "seed {seed}: {:#?}",
        tally.failures
    );
    // A mutator that breaks everything, or nothing, tests nothing.
    let some = cases.saturating_sub(100) / 20;
    assert!(tally.read >= some && tally.refused >= some);
}
