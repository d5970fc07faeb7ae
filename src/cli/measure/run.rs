//! The sweep with its progress, and Ctrl-C.

use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::options::SweepOptions;
use crate::cli::error::CliError;
use crate::cli::input::{load_changed, snapshot};
use crate::cli::output;
use crate::cli::progress::Progress;
use crate::measure::trade::{Record, Subject, Truth, Watch, measure};

/// Measures until `stop` becomes true; also says how many cells were asked for.
pub(super) fn sweep(
    options: &SweepOptions,
    stop: &AtomicBool,
) -> Result<(Record, usize), CliError> {
    let snapshot = snapshot(load_changed(&options.scene)?);
    let failed = |source| CliError::Trade {
        path: options.scene.input.clone(),
        source,
    };
    let truth = Truth::suiting(&snapshot);
    let mut subject = Subject::new(snapshot, truth).map_err(failed)?;
    let progress = Progress::counting(1, "cells");
    let asked = Cell::new(0);
    let watch = Watch {
        stop: &|| stop.load(Ordering::Relaxed),
        reached: &|done, all| {
            asked.set(all);
            progress.of(all as u64);
            progress.reached(done as u64);
        },
    };
    let input = options.scene.input.display().to_string();
    let parts = (&options.plan, options.shard);
    let measured = measure(&mut subject, &input, parts, options.threads, &watch);
    progress.finish();
    let mut record = measured.map_err(failed)?;
    record.command.clone_from(&options.command);
    Ok((record, asked.get()))
}

/// Becomes true when somebody presses Ctrl-C. Whoever presses it twice does not want to wait.
pub(super) fn listen() -> Result<Arc<AtomicBool>, CliError> {
    let stop = Arc::new(AtomicBool::new(false));
    let pressed = Arc::clone(&stop);
    ctrlc::set_handler(move || {
        if pressed.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(crate::cli::COULD_NOT_RUN));
        }
        output::complain("stopping after the cell at hand; Ctrl-C again stops at once");
    })?;
    Ok(stop)
}
