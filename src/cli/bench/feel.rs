//! How the window feels while a scripted hand drags the camera.

use serde_json::json;

use super::options::FeelOptions;
use super::report::Report;
use crate::cli::error::CliError;
use crate::cli::input::load_changed;
use crate::cli::{FeelRequest, FeltScene, Windows};

/// Over the lines of the part.
const HEADING: &str = "views shown a second while dragging; ms from input to picture; coarsest picture; ms from rest to every pixel; ms to draw the window";

/// Runs the command.
pub(super) fn run(options: &FeelOptions, windows: &dyn Windows) -> Result<(), CliError> {
    let scenes = options.scenes.iter().map(load_changed);
    let request = FeelRequest {
        scenes: scenes.collect::<Result<_, _>>()?,
        threads: options.threads,
        size: options.size,
        seconds: f64::from(options.seconds),
    };
    let felt = windows.feel(request).map_err(CliError::NoWindow)?;
    let mut report = Report::new(options.json);
    report.machine(json!({ "threads": options.threads, "seconds": options.seconds }))?;
    report.part("feel", HEADING)?;
    for (scene, felt) in options.scenes.iter().zip(&felt) {
        report.line("feel", row(&scene.input.display().to_string(), felt))?;
    }
    report.finish()
}

fn row(scene: &str, felt: &FeltScene) -> super::report::Row {
    let feel = &felt.feel;
    let [width, height] = felt.size;
    let rest = feel.rest_to_full_ms.map_or_else(
        || "no full picture".to_owned(),
        |millis| format!("full after {millis:.0}"),
    );
    let text = format!(
        "{scene:14} {width}x{height} {:5.1} views/s  wait {:.1}, p95 {:.1}, max {:.1}  scale 1/{} (mostly 1/{})  {rest}  draw {:.1}",
        feel.shown_per_sec,
        feel.wait_p50_ms,
        feel.wait_p95_ms,
        feel.wait_max_ms,
        feel.coarsest,
        feel.median_stride,
        felt.draw_p50_ms,
    );
    let value = json!({
        "scene": scene,
        "size": felt.size,
        "seconds": feel.seconds,
        "asked": feel.asked,
        "shown": feel.shown,
        "shown_per_s": feel.shown_per_sec,
        "input_to_frame_ms": feel.wait_p50_ms,
        "input_to_frame_ms_p95": feel.wait_p95_ms,
        "input_to_frame_ms_max": feel.wait_max_ms,
        "coarsest_stride": feel.coarsest,
        "median_stride": feel.median_stride,
        "rest_to_full_ms": feel.rest_to_full_ms,
        "draw_ms": felt.draw_p50_ms,
    });
    (text, value)
}
