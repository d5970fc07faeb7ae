//! `probe`: the whole story of one pixel.

use super::error::CliError;
use super::input::{load_changed, snapshot};
use super::options::ProbeOptions;
use super::output;
use crate::render::probe;

/// Runs the command.
pub(super) fn run(options: &ProbeOptions) -> Result<(), CliError> {
    let snapshot = snapshot(load_changed(&options.scene)?);
    let story = probe(&snapshot, options.pixel).ok_or(CliError::OutsidePicture {
        pixel: options.pixel,
        size: snapshot.size,
    })?;
    if options.json {
        // A record of plain numbers always has a JSON form.
        let value = serde_json::to_value(&story).unwrap_or_default();
        output::answer_json(&value)
    } else {
        output::answer(&story.to_string())
    }
}
