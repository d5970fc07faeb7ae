//! Small windows over the picture: keys and mouse, a pixel's story, and what can be dropped.

use egui::{Align2, Color32, FontId, Grid, Id, LayerId, Order, Rect, ScrollArea, Ui, Window};

use super::commands::{self, CommandInfo, Group};
use super::theme;

/// Room for the title and the margins of a small window, points.
const AROUND: egui::Vec2 = egui::vec2(40.0, 90.0);

/// Keys and mouse, from the command table. What a small window has no room for is scrolled to.
pub fn help_ui(ctx: &egui::Context, open: &mut bool) {
    *open &= !escaped(ctx);
    let room = ctx.content_rect().size() - AROUND;
    Window::new("Keys and mouse")
        .open(open)
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, egui::Vec2::ZERO)
        .show(ctx, |ui| {
            // As large as there is room for, whatever size the window had before.
            ScrollArea::both()
                .max_width(room.x)
                .max_height(room.y)
                .min_scrolled_width(room.x)
                .min_scrolled_height(room.y)
                .show(ui, |ui| ui.horizontal_top(columns_ui));
        });
}

/// The mouse, what keys do, and the methods that they choose, side by side.
fn columns_ui(ui: &mut Ui) {
    let spacing = [18.0, 5.0];
    let two_columns = |name| Grid::new(name).num_columns(2).spacing(spacing);
    two_columns("mouse").show(ui, |ui| {
        ui.strong("Mouse");
        ui.end_row();
        for (gesture, meaning) in commands::MOUSE {
            ui.colored_label(theme::ACCENT, gesture);
            ui.label(meaning);
            ui.end_row();
        }
    });
    let table = commands::table();
    let (methods, others): (Vec<_>, Vec<_>) = Group::ALL
        .into_iter()
        .partition(|group| *group == Group::Method);
    for (name, groups) in [("keys", others), ("methods", methods)] {
        ui.add_space(16.0);
        two_columns(name).show(ui, |ui| keys_ui(ui, &table, &groups));
    }
}

/// Whether Escape was pressed, which closes small windows.
pub fn escaped(ctx: &egui::Context) -> bool {
    ctx.input(|input| input.key_pressed(egui::Key::Escape))
}

/// The keys of groups of commands.
fn keys_ui(ui: &mut Ui, table: &[CommandInfo], groups: &[Group]) {
    for group in groups {
        ui.strong(group.label());
        ui.end_row();
        for row in table.iter().filter(|row| row.group == *group) {
            ui.colored_label(theme::ACCENT, commands::keys_text(ui.ctx(), row));
            ui.label(row.label);
            ui.end_row();
        }
    }
}

/// Tells that a file held over the window can be dropped.
pub fn drop_hint_ui(ctx: &egui::Context, window: Rect) {
    let hovered = ctx.input(|input| !input.raw.hovered_files.is_empty());
    if hovered {
        let text =
            "Drop a model or a scene to open it,\na picture to put it on the selected material";
        cover(ctx, window, text);
    }
}

/// Words in the middle of a darkened window.
fn cover(ctx: &egui::Context, window: Rect, text: &str) {
    let painter = ctx.layer_painter(LayerId::new(Order::Foreground, Id::unique("cover")));
    painter.rect_filled(window, 0.0, Color32::from_black_alpha(170));
    let font = FontId::proportional(20.0);
    let center = window.center();
    painter.text(center, Align2::CENTER_CENTER, text, font, theme::TEXT);
}
