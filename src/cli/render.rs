//! `render`: the viewer's renderer without a window.

use std::time::Instant;

use super::error::CliError;
use super::input::{load_changed, snapshot};
use super::options::{PictureFormat, RenderOptions};
use super::output;
use super::progress::Progress;
use crate::render::{Counters, Legend, PassEnd, Progressive, Recording, Snapshot};
use crate::scene::save_picture::{write_exr, write_png};
use crate::scene::{DisplaySettings, View, ViewKind};

/// Runs the command.
pub(super) fn run(options: &RenderOptions) -> Result<(), CliError> {
    let mut loaded = load_changed(&options.scene)?;
    if let Some(samples) = options.samples {
        loaded.settings.samples = samples;
    }
    let display = DisplaySettings {
        exposure_ev: options.exposure_ev.unwrap_or(loaded.display.exposure_ev),
        view: match options.format {
            PictureFormat::Png => options.view.unwrap_or(loaded.display.view),
            // Linear light is the picture's.
            PictureFormat::Exr => View::Picture,
        },
        ..loaded.display
    };
    if display.view.covers_picture() && display.view != View::Samples {
        // Records are of first samples.
        loaded.settings.samples = 1;
    }
    let snapshot = snapshot(loaded);
    let size = snapshot.size;
    let began = Instant::now();
    let mut renderer = Progressive::new(options.threads).map_err(CliError::Threads)?;
    renderer.record(Recording::for_view(&display));
    let counters = converge(&mut renderer, snapshot);
    let secs = began.elapsed().as_secs_f64();
    let legend = save(&renderer, options, display)?;
    if counters.non_finite > 0 {
        output::complain(&format!(
            "{}: {} samples were not finite and count as black",
            options.output.display(),
            counters.non_finite
        ));
    }
    let samples = renderer.samples();
    let line = closing_line(size, samples, secs, counters.rays());
    let legend = legend.map_or_else(String::new, |legend| legend_line(&legend));
    output::answer(&format!("{}: {line}{legend}", options.output.display()))
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

/// Writes the picture; returns what a view's colours mean.
fn save(
    renderer: &Progressive,
    options: &RenderOptions,
    display: DisplaySettings,
) -> Result<Option<Legend>, CliError> {
    let records = renderer.records();
    let legend = records
        .as_ref()
        .and_then(|records| Legend::of(display.view, &[records]));
    let picture = renderer.picture();
    let size = [picture.width, picture.height];
    let written = match options.format {
        PictureFormat::Png => {
            let mut rgba = vec![[0; 4]; picture.pixels.len()];
            renderer.encode_into(display.exposure_ev, &mut rgba);
            if let Some((legend, records)) = legend.as_ref().zip(records.as_ref()) {
                legend.paint(records, &mut rgba);
            }
            let rgb: Vec<_> = rgba.iter().map(|&[r, g, b, _]| [r, g, b]).collect();
            write_png(&options.output, size, &rgb)
        }
        PictureFormat::Exr => {
            let linear: Vec<_> = picture.pixels.iter().map(|c| c.to_array()).collect();
            write_exr(&options.output, size, &linear)
        }
    };
    written.map_err(CliError::Picture)?;
    Ok(legend)
}

/// What the colours of a view mean, for the end of the closing line.
fn legend_line(legend: &Legend) -> String {
    let view = legend.view;
    let [low, high] = legend.range;
    let colors = match view.kind() {
        ViewKind::Picture => return String::new(),
        ViewKind::Channels => String::new(),
        ViewKind::Scale if legend.marked > 0 => format!(", from {low} to {high} or more"),
        ViewKind::Scale => format!(", from {low} to {high}"),
        ViewKind::Marks => format!(", {} pixels", legend.marked),
    };
    format!("\n{}: {}{colors}", view.name(), view.meaning())
}

fn closing_line([width, height]: [u32; 2], samples: u32, secs: f64, rays: u64) -> String {
    let word = if samples == 1 { "sample" } else { "samples" };
    let millions = rays as f64 / 1e6;
    format!(
        "{width}x{height}, {samples} {word} per pixel, {secs:.2} s, {millions:.2} million rays ({:.1} million per second)",
        millions / secs.max(1e-9)
    )
}
