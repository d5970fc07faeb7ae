//! The card that tells how far a load is, and lets go of it.

use egui::{Align2, Area, Id, Order, ProgressBar, RichText, Ui, Vec2};

use super::{status, theme};
use crate::scene::load::Stage;

/// Points.
const WIDTH: f32 = 300.0;
/// In which the card appears, so that short loads do not flicker.
const FADE_SECS: f32 = 0.3;

/// What is loading.
#[derive(Debug, Clone, PartialEq)]
pub struct Loading {
    /// Name of the file or scene.
    pub name: String,
    /// What the load is busy with and its share done (0…1); `None` where nobody can tell, as for a picture.
    pub progress: Option<(Stage, f32)>,
}

/// Draws the card: above the status line, or in the middle of a window that has nothing else to show.
/// Returns whether the load is to be cancelled.
pub fn loading_ui(ctx: &egui::Context, loading: Option<&Loading>, is_window_empty: bool) -> bool {
    let id = Id::unique("loading");
    let opacity = ctx.animate_bool_with_time(id, loading.is_some(), FADE_SECS);
    let Some(loading) = loading else {
        return false;
    };
    let (anchor, offset) = if is_window_empty {
        (Align2::CENTER_CENTER, 0.0)
    } else {
        (Align2::CENTER_BOTTOM, -status::HEIGHT - 10.0)
    };
    Area::new(id)
        .anchor(anchor, Vec2::new(0.0, offset))
        .order(Order::Foreground)
        .show(ctx, |ui| {
            ui.set_opacity(opacity);
            let frame = theme::glass().inner_margin(egui::Margin::symmetric(14, 10));
            frame.show(ui, |ui| card_ui(ui, loading)).inner
        })
        .inner
}

fn card_ui(ui: &mut Ui, loading: &Loading) -> bool {
    ui.set_width(WIDTH);
    let title = RichText::new(format!("Loading {}", loading.name)).strong();
    ui.add(egui::Label::new(title).truncate());
    let Some((stage, share)) = loading.progress else {
        ui.spinner();
        return false;
    };
    ui.horizontal(|ui| {
        let cancel = ui.button("Cancel loading").clicked();
        let bar = ProgressBar::new(share).desired_width(ui.available_width());
        let text = format!("{} · {:.0} %", stage.label(), share * 100.0);
        ui.add(bar.text(text));
        cancel
    })
    .inner
}
