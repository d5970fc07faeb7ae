//! What changes the screen but not the picture.

use egui::Ui;

use super::PanelContext;
use crate::scene::View;
use crate::viewer::widgets::{Caption, choice_ui, slider_ui};

/// Stops that the slider reaches.
pub(in crate::viewer) const MOST_STOPS: f32 = 10.0;

pub(super) fn display_ui(ui: &mut Ui, panel: &mut PanelContext<'_>) {
    slider_ui(
        ui,
        Caption::new("Exposure"),
        -MOST_STOPS..=MOST_STOPS,
        &mut panel.doc.display.exposure_ev,
        Some(&0.0),
    );
    ui.weak("Stops. Nothing is rendered again.");
    let view = &mut panel.doc.display.view;
    choice_ui(ui, Caption::new("View"), view, &View::ALL, View::name);
    ui.weak(view.meaning());
}
