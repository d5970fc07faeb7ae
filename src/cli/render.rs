//! `render`: the viewer's renderer without a window.

use std::time::Instant;

use super::error::CliError;
use super::input::{load_changed, snapshot};
use super::options::{PictureFormat, RenderOptions};
use super::output;
use super::progress::Progress;
use crate::render::{Counters, PassEnd, Progressive, Snapshot};
use crate::scene::save_picture::{write_exr, write_png};

/// Runs the command.
pub(super) fn run(options: &RenderOptions) -> Result<(), CliError> {
    let mut loaded = load_changed(&options.scene)?;
    if let Some(samples) = options.samples {
        loaded.settings.samples = samples;
    }
    let exposure_ev = options.exposure_ev.unwrap_or(loaded.display.exposure_ev);
    let snapshot = snapshot(loaded);
    let size = snapshot.size;
    let began = Instant::now();
    let mut renderer = Progressive::new(options.threads).map_err(CliError::Threads)?;
    let counters = converge(&mut renderer, snapshot);
    let secs = began.elapsed().as_secs_f64();
    save(&renderer, options, exposure_ev)?;
    if counters.non_finite > 0 {
        output::complain(&format!(
            "{}: {} samples were not finite and count as black",
            options.output.display(),
            counters.non_finite
        ));
    }
    let samples = renderer.samples();
    let line = closing_line(size, samples, secs, counters.rays());
    output::answer(&format!("{}: {line}", options.output.display()))
}

/// Renders until every pixel has its samples; returns the counts of all passes.
fn converge(renderer: &mut Progressive, snapshot: Snapshot) -> Counters {
    let progress = Progress::new(snapshot.settings.samples);
    renderer.start(snapshot);
    while !renderer.is_converged() {
        if renderer.pass(&|| false) == PassEnd::Stopped {
            break;
        }
        progress.reached(u64::from(renderer.samples()));
    }
    progress.finish();
    renderer.counters()
}

fn save(renderer: &Progressive, options: &RenderOptions, exposure_ev: f32) -> Result<(), CliError> {
    let picture = renderer.picture();
    let size = [picture.width, picture.height];
    let written = match options.format {
        PictureFormat::Png => {
            let mut rgba = vec![[0; 4]; picture.pixels.len()];
            renderer.encode_into(exposure_ev, &mut rgba);
            let rgb: Vec<_> = rgba.iter().map(|&[r, g, b, _]| [r, g, b]).collect();
            write_png(&options.output, size, &rgb)
        }
        PictureFormat::Exr => {
            let linear: Vec<_> = picture.pixels.iter().map(|c| c.to_array()).collect();
            write_exr(&options.output, size, &linear)
        }
    };
    written.map_err(CliError::Picture)
}

fn closing_line([width, height]: [u32; 2], samples: u32, secs: f64, rays: u64) -> String {
    let word = if samples == 1 { "sample" } else { "samples" };
    let millions = rays as f64 / 1e6;
    format!(
        "{width}x{height}, {samples} {word} per pixel, {secs:.2} s, {millions:.2} million rays ({:.1} million per second)",
        millions / secs.max(1e-9)
    )
}
