//! Standard output and standard error, without panics when nobody reads them.

use std::io::{ErrorKind, Write as _};

use super::error::CliError;
use crate::scene::LoadWarning;

/// Writes an answer, ended by a line break, to standard output.
pub(super) fn answer(text: &str) -> Result<(), CliError> {
    let mut stdout = std::io::stdout().lock();
    let end = if text.ends_with('\n') { "" } else { "\n" };
    write!(stdout, "{text}{end}")
        .and_then(|()| stdout.flush())
        .map_err(|error| match error.kind() {
            ErrorKind::BrokenPipe => CliError::ReaderGone,
            _ => CliError::Stdout(error),
        })
}

/// Writes a JSON value to standard output.
pub(super) fn answer_json(value: &serde_json::Value) -> Result<(), CliError> {
    answer(&format!("{value:#}"))
}

/// Writes a line to standard error.
pub(super) fn complain(line: &str) {
    // If standard error is closed there is nobody left to tell.
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

/// Writes warnings to standard error, a line each.
pub(super) fn warn(warnings: &[LoadWarning]) {
    for warning in warnings {
        complain(&warning.to_string());
    }
}
