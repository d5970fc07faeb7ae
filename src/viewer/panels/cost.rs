//! What this scene pays for: only what it uses has a figure above 0.

use egui::{Grid, RichText, Ui};

use super::PanelContext;
use crate::viewer::theme;

pub(super) fn cost_ui(ui: &mut Ui, panel: &mut PanelContext<'_>) {
    let (stats, scene) = (&panel.state.stats, &panel.doc.scene);
    let counters = &stats.counters;
    let count = |n: u64| match n {
        0 => "0".to_owned(),
        1..10_000 => n.to_string(),
        10_000..10_000_000 => format!("{:.1} k", n as f64 * 1e-3),
        _ => format!("{:.1} M", n as f64 * 1e-6),
    };
    let counts = [
        ("Camera rays", counters.camera_rays),
        ("Shadow rays", counters.shadow_rays),
        ("Mirror rays", counters.mirror_rays),
        ("Map look-ups", counters.texture_fetches),
        ("Perturbed points", counters.perturbations),
        ("Relief steps", counters.relief_steps),
        ("Relief shadow walks", counters.relief_shadow_walks),
        ("Walks spared by horizons", counters.walks_spared),
        ("Cut-out tests", counters.cutout_tests),
        ("Highlight powers", counters.power_calls),
    ];
    let heading = format!("Work since the last change, {} samples", stats.samples);
    rows_ui(
        ui,
        &heading,
        &counts.map(|(name, n)| (name, n > 0, count(n))),
    );
    let stages = ["Tracing", "Perturbing", "Shading", "Film"];
    let millis = stats.stage_millis;
    let rows = [0, 1, 2, 3].map(|i| (stages[i], millis[i] > 0.0, format!("{:.1} ms", millis[i])));
    rows_ui(ui, "Thread time of the last full pass", &rows);
    let displaced = scene.displaced.last();
    let bytes = [
        ("Mesh", scene.mesh.bytes()),
        ("Tangents", scene.tangents.bytes()),
        ("Charts", scene.uv_charts.bytes()),
        ("Tree", scene.bvh.bytes()),
        (
            "Pictures and maps",
            scene
                .images
                .iter()
                .map(|i| i.bytes() - i.search_bytes() - i.filter_bytes())
                .sum(),
        ),
        (
            "Pyramids and cones",
            scene.images.iter().map(|i| i.search_bytes()).sum(),
        ),
        (
            "Mip maps",
            scene.images.iter().map(|i| i.filter_bytes()).sum(),
        ),
        ("Displacement", displaced.map_or(0, |d| d.bytes())),
        ("Parts of it kept", stats.kept_bytes),
    ];
    let mebibytes = |n: usize| format!("{:.2} MiB", n as f64 / f64::from(1 << 20));
    rows_ui(
        ui,
        "Memory",
        &bytes.map(|(name, n)| (name, n > 0, mebibytes(n))),
    );
}

/// A small table; what is not used is dimmed.
fn rows_ui(ui: &mut Ui, heading: &str, rows: &[(&str, bool, String)]) {
    ui.label(RichText::new(heading).color(theme::WEAK));
    Grid::new(heading)
        .num_columns(2)
        .striped(true)
        .show(ui, |ui| {
            for (name, used, figure) in rows {
                let text = |text: &str| {
                    let text = RichText::new(text);
                    if *used { text } else { text.color(theme::WEAK) }
                };
                ui.label(text(name));
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    ui.label(text(figure).monospace());
                });
                ui.end_row();
            }
        });
    ui.add_space(4.0);
}
