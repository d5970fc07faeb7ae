//! `measure`: what accuracy costs on a model and its map.
//!
//! - `args`, `options`: what may be typed, and what it means
//! - `run`: the sweep with its progress and Ctrl-C; `files`: records read and written; `text`: what is printed

mod args;
mod files;
mod options;
mod run;
mod text;

pub(super) use args::MeasureArgs;

use super::error::CliError;
use super::output;
use crate::measure::trade::Record;
use options::MeasureOptions;

/// Runs the command.
pub(super) fn run(args: MeasureArgs) -> Result<(), CliError> {
    // Before anything is on the disk, so that a report is never left half done.
    let stop = run::listen()?;
    match &args.check()? {
        MeasureOptions::Sweep(options) => {
            let (record, asked) = run::sweep(options, &stop)?;
            tell(&record, &options.output)?;
            if record.partial {
                return Err(partial(&record, asked));
            }
            Ok(())
        }
        MeasureOptions::Merge(options) => {
            let record = files::merged(&options.files)?;
            tell(&record, &options.output)
        }
    }
}

/// Writes and prints what was measured.
fn tell(record: &Record, output: &options::OutputOptions) -> Result<(), CliError> {
    if let Some(folder) = &output.report {
        files::write_report(folder, record)?;
    }
    if output.json {
        // A record of plain numbers always has a JSON form.
        let mut plain = record.clone();
        plain.pictures.clear();
        output::answer_json(&serde_json::to_value(&plain).unwrap_or_default())
    } else {
        output::answer(&text::summary(record))
    }
}

fn partial(record: &Record, asked: usize) -> CliError {
    let done = record.cells.len();
    CliError::Partial(format!("stopped: {done} of {asked} cells were measured"))
}
