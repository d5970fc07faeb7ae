//! `bench`: how long the parts of a picture take on this machine.
//!
//! - `args`, `options`: what may be typed, and what it means
//! - `table`: the whole table; `rows`: its lines, as text and as JSON
//! - `dump`, `race`: files of rays
//! - `feel`: the window while a scripted hand drags

mod args;
mod dump;
mod feel;
mod options;
mod race;
mod report;
mod rows;
mod table;

pub(super) use args::BenchArgs;

use super::Windows;
use super::error::CliError;
use options::BenchOptions;

/// Runs the command.
pub(super) fn run(args: BenchArgs, windows: &dyn Windows) -> Result<(), CliError> {
    match &args.check()? {
        BenchOptions::Table(options) => table::run(options),
        BenchOptions::Dump(options) => dump::run(options),
        BenchOptions::Race(options) => race::run(options),
        BenchOptions::Feel(options) => feel::run(options, windows),
    }
}
