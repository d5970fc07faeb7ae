//! What the colours of views and errors mean, in the corner above the status line.

use egui::{
    Align2, Area, Color32, FontId, Id, Order, Rect, Role, Sense, Ui, Vec2, WidgetInfo, pos2, vec2,
};

use super::comparison::Comparison;
use super::status;
use super::theme;
use super::worker::FrameStats;
use crate::math::false_color;
use crate::render::{Legend, MARK};
use crate::scene::{View, ViewKind};

/// Distance from the window's edge, points.
const MARGIN: f32 = 10.0;
/// Columns and rows of a bar, points.
const BAR: Vec2 = vec2(220.0, 12.0);
/// Side of a square that shows one colour, points.
const SQUARE: f32 = 12.0;

/// Draws what the shown frame needs explained; nothing for a plain picture.
pub fn legend_ui(ctx: &egui::Context, stats: &FrameStats, comparison: &Comparison) {
    let metric = comparison.error.filter(|_| comparison.on);
    if metric.is_none() && stats.legend.is_none() {
        return;
    }
    let offset = vec2(MARGIN, -status::HEIGHT - MARGIN);
    Area::new(Id::unique("legend"))
        .anchor(Align2::LEFT_BOTTOM, offset)
        .order(Order::Middle)
        .show(ctx, |ui| {
            theme::glass().show(ui, |ui| {
                if let Some(legend) = &stats.legend {
                    view_ui(ui, legend);
                }
                let Some(metric) = metric else { return };
                ui.label(format!("Error: {}", metric.label()));
                bar_ui(ui, [0.0, comparison.full_scale], metric.unit());
                if let Some(lone @ 1..) = stats.error.map(|error| error.lone) {
                    let text = format!("{} only in A or only in B", pixels_text(lone));
                    square_ui(ui, MARK, &text);
                }
            });
        });
}

fn view_ui(ui: &mut Ui, legend: &Legend) {
    let view = legend.view;
    ui.label(format!("View {}: {}", view.name(), view.meaning()));
    match view.kind() {
        ViewKind::Picture => {}
        ViewKind::Scale => {
            let beyond = if legend.marked > 0 { " or more" } else { "" };
            bar_ui(ui, legend.range, beyond);
        }
        ViewKind::Marks => square_ui(ui, MARK, &pixels_text(legend.marked)),
        ViewKind::Channels => {
            let names: &[&str] = match view {
                View::Uv => &["u, 0 to 1", "v, 0 to 1"],
                _ => &["x, -1 to 1", "y, -1 to 1", "z, -1 to 1"],
            };
            let colors = [[255, 0, 0], [0, 255, 0], [0, 90, 255]];
            ui.horizontal(|ui| {
                for (color, name) in colors.into_iter().zip(names) {
                    square_ui(ui, color, name);
                }
            });
        }
    }
}

/// "1 234 pixels".
fn pixels_text(count: u64) -> String {
    let word = if count == 1 { "pixel" } else { "pixels" };
    format!("{} {word}", status::grouped(count))
}

/// A colour and what it stands for.
fn square_ui(ui: &mut Ui, [r, g, b]: [u8; 3], text: &str) {
    ui.horizontal(|ui| {
        let (rect, _) = ui.allocate_exact_size(Vec2::splat(SQUARE), Sense::hover());
        let color = Color32::from_rgb(r, g, b);
        ui.painter().rect_filled(rect, 2.0, color);
        ui.label(text);
    });
}

/// The bar of false colours with its numbers.
fn bar_ui(ui: &mut Ui, [low, high]: [f32; 2], unit: &str) {
    let (rect, response) = ui.allocate_exact_size(BAR + vec2(0.0, 18.0), Sense::hover());
    let numbers = [0.0, 0.5, 1.0].map(|t| scale_text(low + t * (high - low)));
    let name = format!("Colours from {} to {}{unit}", numbers[0], numbers[2]);
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &name));
    let painter = ui.painter();
    let columns = BAR.x as usize;
    for i in 0..columns {
        let corner = rect.min + vec2(i as f32, 0.0);
        let [r, g, b] = false_color((i as f32 + 0.5) / columns as f32);
        let column = Rect::from_min_size(corner, vec2(1.0, BAR.y));
        painter.rect_filled(column, 0.0, Color32::from_rgb(r, g, b));
    }
    let y = rect.top() + BAR.y + 4.0;
    let places = [
        (rect.left(), Align2::LEFT_TOP),
        (rect.center().x, Align2::CENTER_TOP),
        (rect.right(), Align2::RIGHT_TOP),
    ];
    let [first, middle, last] = numbers;
    let texts = [first, middle, format!("{last}{unit}")];
    for ((x, align), text) in places.into_iter().zip(texts) {
        let font = FontId::monospace(11.5);
        painter.text(pos2(x, y), align, text, font, theme::TEXT);
    }
}

/// Up to four decimals, without zeros at the end: "0.125", "1".
fn scale_text(value: f32) -> String {
    let text = format!("{value:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::{pixels_text, scale_text};

    #[test]
    fn numbers_of_the_scale_are_short() {
        let texts = [0.0, 0.125, 0.5, 1.0, 20.0].map(scale_text);
        assert_eq!(texts, ["0", "0.125", "0.5", "1", "20"]);
        assert_eq!(pixels_text(1), "1 pixel");
        assert_eq!(pixels_text(12_345), "12 345 pixels");
    }
}
