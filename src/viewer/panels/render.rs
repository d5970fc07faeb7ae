//! Samples, preview, pause, threads.

use egui::Ui;

use super::PanelContext;
use crate::viewer::widgets::{Caption, Number, number_ui};

/// More samples than anybody waits for.
const MOST_SAMPLES: f64 = 65_536.0;

pub(super) fn render_ui(ui: &mut Ui, panel: &mut PanelContext<'_>) {
    number_ui(
        ui,
        Caption::new("Samples"),
        &Number::within(1.0..=MOST_SAMPLES, 0.2),
        &mut panel.doc.settings.samples,
        Some(&panel.doc.original.samples),
    );
    let mut full = !panel.preferences.preview;
    ui.checkbox(&mut full, "Full resolution while moving")
        .on_hover_text("Never show a coarser picture, even if the window gets slower");
    panel.preferences.preview = !full;
    ui.checkbox(&mut panel.state.paused, "Pause refining")
        .on_hover_text("Edits still show; the picture stays as it is after its first sample");
    number_ui(
        ui,
        Caption::new("Threads"),
        &Number::within(0.0..=256.0, 0.05),
        &mut panel.state.threads,
        Some(&0),
    );
    if panel.state.threads == 0 {
        ui.weak("0 threads: one per core");
    }
    ui.checkbox(&mut panel.state.probe, "Probe pixels")
        .on_hover_text("A click in the picture tells its pixel's story");
}
