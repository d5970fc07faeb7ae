//! Records in files.

use std::path::{Path, PathBuf};

use crate::cli::error::CliError;
use crate::measure::trade::{FORMAT, Record, csv_table, merge, page};
use crate::scene::file::write_whole;

/// Largest file that is read as a record, bytes.
const LARGEST: u64 = 1 << 30;

/// Writes the three files of a report, each whole or not at all.
pub(super) fn write_report(folder: &Path, record: &Record) -> Result<(), CliError> {
    // A record of plain numbers always has a JSON form.
    let json = serde_json::to_string(record).unwrap_or_default();
    for (name, text) in [
        ("measure.json", json),
        ("measure.csv", csv_table(record)),
        ("index.html", page(record)),
    ] {
        let path = folder.join(name);
        write_whole(&path, text.as_bytes()).map_err(|source| CliError::NoPlace {
            message: source.to_string(),
            path,
        })?;
    }
    Ok(())
}

/// Reads records and joins them.
pub(super) fn merged(files: &[PathBuf]) -> Result<Record, CliError> {
    let parts = files.iter().map(|file| read(file));
    Ok(merge(parts.collect::<Result<_, _>>()?)?)
}

fn read(path: &Path) -> Result<Record, CliError> {
    let wrong = |message: String| CliError::Record {
        path: path.to_owned(),
        message,
    };
    let facts = std::fs::metadata(path).map_err(|e| wrong(e.to_string()))?;
    if facts.len() > LARGEST {
        return Err(wrong("too large for a record of measurements".to_owned()));
    }
    let text = std::fs::read_to_string(path).map_err(|e| wrong(e.to_string()))?;
    let value: serde_json::Value = serde_json::from_str(&text)
        .map_err(|e| wrong(format!("not a record of measurements: {e}")))?;
    match value.get("format").and_then(serde_json::Value::as_u64) {
        Some(format) if format == u64::from(FORMAT) => {}
        Some(format) => {
            let message = format!("written in format {format}; this program reads {FORMAT}");
            return Err(wrong(message));
        }
        None => {
            return Err(wrong(
                "not a record of measurements: it names no format".to_owned(),
            ));
        }
    }
    serde_json::from_value(value).map_err(|e| wrong(format!("not a record of measurements: {e}")))
}
