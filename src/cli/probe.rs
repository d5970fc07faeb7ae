//! `probe`: the whole story of one pixel, in words or as a drawing.

use std::path::Path;

use super::error::CliError;
use super::input::{load_changed, snapshot};
use super::options::ProbeOptions;
use super::output;
use crate::measure::profile_drawing::draw_profile;
use crate::render::{NoProfile, Snapshot, probe, profile};

/// Points of a drawing in a file.
const DRAWING: [f32; 2] = [1200.0, 560.0];

/// Runs the command.
pub(super) fn run(options: &ProbeOptions) -> Result<(), CliError> {
    let snapshot = snapshot(load_changed(&options.scene)?);
    let outside = || CliError::OutsidePicture {
        pixel: options.pixel,
        size: snapshot.size,
    };
    if let Some(path) = &options.svg {
        return match draw(&snapshot, options.pixel, path) {
            Err(CliError::NoProfile(NoProfile::Outside)) => Err(outside()),
            done => done,
        };
    }
    let story = probe(&snapshot, options.pixel).ok_or_else(outside)?;
    if options.json {
        // A record of plain numbers always has a JSON form.
        let value = serde_json::to_value(&story).unwrap_or_default();
        output::answer_json(&value)
    } else {
        output::answer(&story.to_string())
    }
}

fn draw(snapshot: &Snapshot, pixel: [u32; 2], path: &Path) -> Result<(), CliError> {
    let profile = profile(snapshot, pixel)?;
    let svg = draw_profile(&profile, DRAWING).to_svg();
    crate::scene::file::write_whole(path, svg.as_bytes()).map_err(|source| CliError::NoPlace {
        path: path.to_owned(),
        message: source.to_string(),
    })
}
