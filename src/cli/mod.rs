//! The command line: arguments → checked options → command → exit code.
//!
//! - `args`: what may be typed, for the parser; `help`: what `--help` teaches
//! - `options`: arguments after checking, as commands take them
//! - `render`, `inspect`, `probe`, `lists`: one file per command; `bench`: a room; `input`: what they share

mod args;
mod bench;
mod error;
mod help;
mod input;
mod inspect;
mod lists;
mod options;
mod output;
mod probe;
mod progress;
mod render;

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser as _;

use args::{Arguments, Command, ViewArgs};
use error::CliError;

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

/// Exit code of a run that found a wrong answer, or a measured threshold that failed.
const FAILED: u8 = 1;
/// Exit code of a run that could not do what it was asked to.
const COULD_NOT_RUN: u8 = 2;

/// Runs the command line and returns the exit code: 0 good, 1 a measured threshold failed, 2 could not run.
///
/// `open_window` shows a window until it is closed; its error is one line.
pub fn run(
    arguments: impl IntoIterator<Item = OsString>,
    open_window: impl FnOnce(ViewRequest) -> Result<(), String>,
) -> ExitCode {
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(answer) => return refuse_or_help(&answer),
    };
    match dispatch(arguments, open_window) {
        Ok(()) | Err(CliError::ReaderGone) => ExitCode::SUCCESS,
        Err(error) => {
            output::complain(&format!("error: {error}"));
            match error {
                CliError::Bench(error) if error.is_wrong_answer() => ExitCode::from(FAILED),
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

fn dispatch(
    arguments: Arguments,
    open_window: impl FnOnce(ViewRequest) -> Result<(), String>,
) -> Result<(), CliError> {
    let view = |args: ViewArgs| open_window(args.into_request()).map_err(CliError::NoWindow);
    match arguments.command {
        None => view(arguments.view),
        Some(Command::View(args)) => view(args),
        Some(Command::Render(args)) => render::run(&args.check()?),
        Some(Command::Inspect(args)) => inspect::run(&args.check()),
        Some(Command::Probe(args)) => probe::run(&args.check()),
        Some(Command::Bench(args)) => bench::run(args),
        Some(Command::Methods) => lists::methods(),
        Some(Command::Scenes) => lists::scenes(),
    }
}
