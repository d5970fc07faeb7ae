//! The command line: arguments → checked options → command → exit code.
//!
//! - `args`: what may be typed, for the parser; `help`: what `--help` teaches
//! - `options`: arguments after checking, as commands take them
//! - `render`, `inspect`, `probe`, `stability`, `lists`: one file per command; `bench`, `measure`: rooms; `input`:
//!   what they share

mod args;
mod bench;
mod error;
mod help;
mod input;
mod inspect;
mod lists;
mod measure;
mod options;
mod output;
mod probe;
mod progress;
mod render;
mod stability;

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser as _;

use args::{Arguments, Command, ViewArgs};
use error::CliError;

use crate::measure::feel::Feel;
use crate::scene::LoadedScene;

/// What the window is to show.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ViewRequest {
    /// Model, scene file or built-in scene; `None` for the built-in scene that opens first.
    pub input: Option<PathBuf>,
    /// Worker threads; 0 means one per core.
    pub threads: usize,
    /// Whether models are centred and scaled while they are read.
    pub normalize: bool,
}

/// What a scripted hand is to drag in.
#[derive(Debug, Clone)]
pub struct FeelRequest {
    /// Scenes, in this order.
    pub scenes: Vec<LoadedScene>,
    /// Worker threads; 0 means one per core.
    pub threads: usize,
    /// Size of the window, points.
    pub size: [u32; 2],
    /// Length of a drag, seconds.
    pub seconds: f64,
}

/// How one scene felt.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeltScene {
    /// The drag and the rest after it.
    pub feel: Feel,
    /// Columns and rows of the picture.
    pub size: [u32; 2],
    /// Time that drawing the window takes once its picture is there, median, ms.
    pub draw_p50_ms: f64,
}

/// What the program can do with a window. Errors are one line.
pub trait Windows {
    /// Shows a window until it is closed.
    ///
    /// # Errors
    /// Where no window can be shown.
    fn show(&self, request: ViewRequest) -> Result<(), String>;

    /// Drags in scenes and says how each felt, in order.
    ///
    /// # Errors
    /// Where no window can be shown, or if somebody closes it.
    fn feel(&self, request: FeelRequest) -> Result<Vec<FeltScene>, String>;
}

/// Exit code of a run that found a wrong answer, or a measured threshold that failed.
const FAILED: u8 = 1;
/// Exit code of a run that could not do what it was asked to.
const COULD_NOT_RUN: u8 = 2;

/// Runs the command line and returns the exit code: 0 good, 1 a measured threshold failed, 2 could not run.
pub fn run(arguments: impl IntoIterator<Item = OsString>, windows: &dyn Windows) -> ExitCode {
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(answer) => return refuse_or_help(&answer),
    };
    match dispatch(arguments, windows) {
        Ok(()) | Err(CliError::ReaderGone) => ExitCode::SUCCESS,
        Err(error) => {
            output::complain(&format!("error: {error}"));
            match error {
                CliError::Bench(error) if error.is_wrong_answer() => ExitCode::from(FAILED),
                CliError::FellShort(_) => ExitCode::from(FAILED),
                _ => ExitCode::from(COULD_NOT_RUN),
            }
        }
    }
}

/// Help and version are answers, everything else is a refusal; both are the parser's own words.
fn refuse_or_help(answer: &clap::Error) -> ExitCode {
    // A closed pipe must not turn into a panic.
    let _ = answer.print();
    if answer.use_stderr() {
        ExitCode::from(COULD_NOT_RUN)
    } else {
        ExitCode::SUCCESS
    }
}

fn dispatch(arguments: Arguments, windows: &dyn Windows) -> Result<(), CliError> {
    let view = |args: ViewArgs| {
        let shown = windows.show(args.into_request());
        shown.map_err(CliError::NoWindow)
    };
    match arguments.command {
        None => view(arguments.view),
        Some(Command::View(args)) => view(args),
        Some(Command::Render(args)) => render::run(&args.check()?),
        Some(Command::Inspect(args)) => inspect::run(&args.check()),
        Some(Command::Probe(args)) => probe::run(&args.check()),
        Some(Command::Bench(args)) => bench::run(args, windows),
        Some(Command::Stability(args)) => stability::run_matrix(&args),
        Some(Command::Measure(args)) => measure::run(args),
        Some(Command::Methods) => lists::methods(),
        Some(Command::Scenes) => lists::scenes(),
    }
}
