//! What was asked of `bench`, after checking.

use std::path::PathBuf;

use super::BenchArgs;
use crate::cli::error::CliError;
use crate::cli::input::DEFAULT_SIZE;
use crate::cli::options::{SceneOptions, check_place};
use crate::geometry::simd::force_level;
use crate::render::RayKind;
use crate::scene::built_in_names;

/// Scenes of a quick table: one with many maps, one that is all triangles.
const QUICK_SCENES: [&str; 2] = ["wall", "torus-study"];
/// Passes that are timed.
const PASSES: u16 = 7;
/// The same in a quick table.
const QUICK_PASSES: u16 = 3;

/// Scenes to drag in: one of many maps, one that is all triangles.
const FEEL_SCENES: [&str; 2] = QUICK_SCENES;

/// One of four things.
#[derive(Debug)]
pub(super) enum BenchOptions {
    /// The whole table.
    Table(TableOptions),
    /// A file of rays from a scene.
    Dump(DumpOptions),
    /// The speed of the rays in a file.
    Race(RaceOptions),
    /// How the window feels.
    Feel(FeelOptions),
}

/// The whole table.
#[derive(Debug)]
pub(super) struct TableOptions {
    /// The scenes, with what is changed about them; at least one.
    pub scenes: Vec<SceneOptions>,
    /// Picture size, pixels.
    pub size: [u32; 2],
    /// Numbers of threads, growing; at least one.
    pub threads: Vec<usize>,
    /// Passes that are timed.
    pub passes: usize,
    /// Smaller steps of growth.
    pub is_quick: bool,
    /// JSON instead of text.
    pub json: bool,
}

/// A file of rays from a scene.
#[derive(Debug)]
pub(super) struct DumpOptions {
    /// The scene, with what is changed about it.
    pub scene: SceneOptions,
    /// Which rays.
    pub kind: RayKind,
    /// Where to.
    pub output: PathBuf,
}

/// The speed of the rays in a file.
#[derive(Debug)]
pub(super) struct RaceOptions {
    /// The file.
    pub rays: PathBuf,
    /// Where to write what they hit.
    pub hits: Option<PathBuf>,
    /// Numbers of threads, growing; at least one.
    pub threads: Vec<usize>,
    /// Passes that are timed.
    pub passes: usize,
    /// JSON instead of text.
    pub json: bool,
}

/// How the window feels.
#[derive(Debug)]
pub(super) struct FeelOptions {
    /// The scenes, with what is changed about them; at least one.
    pub scenes: Vec<SceneOptions>,
    /// Worker threads; 0 means one per core.
    pub threads: usize,
    /// Size of the window.
    pub size: [u32; 2],
    /// Length of a drag.
    pub seconds: u16,
    /// JSON instead of text.
    pub json: bool,
}

impl BenchArgs {
    /// Refuses what does not go together, levels that this machine lacks, and outputs that could not be
    /// written. Chooses the level for the whole process.
    pub(super) fn check(self) -> Result<BenchOptions, CliError> {
        if let Some(level) = self.level {
            force_level(level)?;
        }
        let passes = if self.quick { QUICK_PASSES } else { PASSES };
        let passes = usize::from(self.passes.unwrap_or(passes));
        let asked_threads = self.threads.iter().copied().max();
        let threads = threads(&self.threads);
        let size = self.size.unwrap_or(DEFAULT_SIZE);
        if let Some(rays) = self.rays {
            return Ok(BenchOptions::Race(RaceOptions {
                rays,
                hits: self.hits.map(check_place).transpose()?,
                threads,
                passes,
                json: self.json,
            }));
        }
        let load = self.load.check();
        let scene = |input| SceneOptions {
            input,
            load: load.clone(),
            // A scene's own size would make its times incomparable.
            size: Some(size),
            method: None,
            overrides: self.set.clone(),
        };
        if let (Some(kind), Some(output)) = (self.kind, self.dump_rays) {
            let [input] = <[PathBuf; 1]>::try_from(self.inputs)
                .map_err(|_| CliError::Arguments("--dump-rays takes the rays of one INPUT"))?;
            return Ok(BenchOptions::Dump(DumpOptions {
                scene: scene(input),
                kind,
                output: check_place(output)?,
            }));
        }
        let inputs = if !self.inputs.is_empty() {
            self.inputs
        } else if self.feel {
            FEEL_SCENES.map(PathBuf::from).into()
        } else if self.quick {
            QUICK_SCENES.map(PathBuf::from).into()
        } else {
            built_in_names().into_iter().map(PathBuf::from).collect()
        };
        let scenes = inputs.into_iter().map(scene).collect();
        if self.feel {
            return Ok(BenchOptions::Feel(FeelOptions {
                scenes,
                threads: usize::from(asked_threads.unwrap_or(0)),
                size,
                seconds: self.seconds,
                json: self.json,
            }));
        }
        Ok(BenchOptions::Table(TableOptions {
            scenes,
            size,
            threads,
            passes,
            is_quick: self.quick,
            json: self.json,
        }))
    }
}

/// What was typed in growing order, each once; 1 and one per core if nothing was.
fn threads(typed: &[u16]) -> Vec<usize> {
    let mut threads: Vec<_> = typed.iter().map(|&n| usize::from(n)).collect();
    if threads.is_empty() {
        threads = vec![
            1,
            std::thread::available_parallelism().map_or(1, usize::from),
        ];
    }
    threads.sort_unstable();
    threads.dedup();
    threads
}
