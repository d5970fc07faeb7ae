//! The pictures A and B in the window: the wipe's line and their names.

use egui::{
    Align2, Color32, CursorIcon, FontId, Id, Key, Painter, PointerButton, Rect, Role, Sense, Shape,
    Stroke, Ui, WidgetInfo, pos2, vec2,
};

use super::comparison::{Comparison, Layout, second_label};
use super::viewport::{Framebuffer, Side};

/// Half the width of what can be grabbed around the line, points.
const GRAB: f32 = 7.0;
/// Distance of names from the line and the window's edge, points.
const MARGIN: f32 = 10.0;
/// The key that shows B.
const HOLD: Key = Key::B;

/// Paints both pictures while two methods are compared, and says so; then the line between them can be
/// dragged. A single picture it leaves to the caller. Names stand in the part of the window that is `free`.
pub fn pictures_ui(
    ui: &Ui,
    ([left, right], free): ([Rect; 2], Rect),
    framebuffer: &Framebuffer,
    comparison: &mut Comparison,
    name: &str,
) -> bool {
    if !comparison.on || !framebuffer.has_other() {
        return false;
    }
    let names = [format!("A · {name}"), other_name(comparison)];
    if comparison.is_side_by_side() {
        for (pane, side, name) in [(left, Side::A, &names[0]), (right, Side::B, &names[1])] {
            framebuffer.paint(ui.painter(), pane, side);
            name_ui(ui, (pane, free), Align2::LEFT_TOP, name);
        }
        return true;
    }
    let held = !ui.ctx().text_edit_focused() && ui.input(|input| input.key_down(HOLD));
    if held || comparison.layout == Layout::Hold {
        let (side, name) = if held { (Side::B, 1) } else { (Side::A, 0) };
        framebuffer.paint(ui.painter(), left, side);
        name_ui(ui, (left, free), Align2::LEFT_TOP, &names[name]);
        return true;
    }
    let line = drag_line(ui, left, &mut comparison.split);
    let (mut a, mut b) = (left, left);
    (a.max.x, b.min.x) = (line, line);
    for (part, side) in [(a, Side::A), (b, Side::B)] {
        let painter = ui.painter().with_clip_rect(part);
        framebuffer.paint(&painter, left, side);
    }
    draw_line(ui.painter(), left, line);
    name_ui(ui, (a, free), Align2::RIGHT_TOP, &names[0]);
    name_ui(ui, (b, free), Align2::LEFT_TOP, &names[1]);
    true
}

fn other_name(comparison: &Comparison) -> String {
    let method = second_label(comparison.method);
    match comparison.error {
        Some(_) => format!("A against {method}"),
        None => format!("B · {method}"),
    }
}

/// Senses a drag of the line; returns its place.
fn drag_line(ui: &Ui, rect: Rect, split: &mut f32) -> f32 {
    let place = |split: f32| rect.left() + rect.width() * split;
    let area = Rect::from_x_y_ranges(place(*split) - GRAB..=place(*split) + GRAB, rect.y_range());
    let response = ui.interact(area, Id::unique("wipe"), Sense::drag());
    response.widget_info(|| WidgetInfo::labeled(Role::Splitter, true, "Wipe line"));
    if let Some(pos) = response
        .interact_pointer_pos()
        .filter(|_| response.dragged_by(PointerButton::Primary))
    {
        *split = ((pos.x - rect.left()) / rect.width().max(1.0)).clamp(0.0, 1.0);
    }
    response.on_hover_and_drag_cursor(CursorIcon::ResizeHorizontal);
    place(*split)
}

/// A bright line with a dark rim, to be seen on any picture, and a grip.
fn draw_line(painter: &Painter, rect: Rect, x: f32) {
    let dark = Color32::from_black_alpha(150);
    painter.vline(x, rect.y_range(), Stroke::new(3.5, dark));
    painter.vline(x, rect.y_range(), Stroke::new(1.5, Color32::WHITE));
    let center = pos2(x, rect.center().y);
    painter.circle(center, 11.0, dark, Stroke::new(1.5, Color32::WHITE));
    for side in [-1.0, 1.0] {
        let corner = |dx: f32, dy: f32| center + vec2(side * dx, dy);
        let arrow = vec![corner(7.0, 0.0), corner(2.5, -4.0), corner(2.5, 4.0)];
        painter.add(Shape::convex_polygon(arrow, Color32::WHITE, Stroke::NONE));
    }
}

/// A picture's name at its top, where its part is free if there is room, unless all of the part is too narrow.
fn name_ui(ui: &Ui, (part, free): (Rect, Rect), align: Align2, name: &str) {
    let font = FontId::proportional(13.5);
    let galley = ui
        .painter()
        .layout_no_wrap(name.to_owned(), font, Color32::WHITE);
    let size = galley.size() + vec2(14.0, 6.0);
    let has_room = |part: &Rect| size.x + MARGIN <= part.width();
    let Some(part) = [part.intersect(free), part].into_iter().find(has_room) else {
        return;
    };
    let rect = align.align_size_within_rect(size, part.shrink(MARGIN));
    let painter = ui.painter();
    painter.rect_filled(rect, 4.0, Color32::from_black_alpha(170));
    painter.galley(rect.min + vec2(7.0, 3.0), galley, Color32::WHITE);
    let id = Id::unique("picture name").with(name);
    let response = ui.interact(rect, id, Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, name));
}
