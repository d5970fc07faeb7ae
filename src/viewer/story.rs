//! A pixel's story in a window: the cut through its relief, drawn, and every number under it.

use egui::{
    Align2, Color32, FontId, Pos2, RichText, ScrollArea, Shape as Paint, Stroke, Ui, Vec2, Window,
};

use crate::measure::drawing::{Anchor, Drawing, Shape};
use crate::measure::profile_drawing::draw_profile;
use crate::render::{ReliefProfile, Snapshot, probe, profile};

/// What is told about one pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct Story {
    /// Every step from the first ray to the colour.
    pub text: String,
    /// The cut through the relief; why there is none, if there is none.
    pub cut: Result<ReliefProfile, String>,
}

impl Story {
    /// The story of a pixel; `None` outside the picture.
    pub fn of(snapshot: &Snapshot, pixel: [u32; 2]) -> Option<Self> {
        let text = probe(snapshot, pixel)?.to_string();
        let cut = profile(snapshot, pixel).map_err(|why| why.to_string());
        Some(Self { text, cut })
    }
}

/// The window; closing it forgets the story.
pub fn story_ui(ctx: &egui::Context, story: &mut Option<Story>) {
    let Some(Story { text, cut }) = story else {
        return;
    };
    let mut open = !super::windows::escaped(ctx);
    let width = if cut.is_ok() { 860.0 } else { 520.0 };
    Window::new("Pixel's story")
        .open(&mut open)
        .default_size([width, 620.0])
        .default_pos([20.0, 20.0])
        .vscroll(false)
        .show(ctx, |ui| {
            match cut {
                Ok(cut) => {
                    let size = [ui.available_width(), 380.0];
                    drawing_ui(ui, &draw_profile(cut, size));
                }
                Err(why) => {
                    ui.label(format!("No cut: {why}."));
                }
            }
            ui.horizontal(|ui| {
                if ui.button("Copy").clicked() {
                    ctx.copy_text(text.clone());
                }
                if let Ok(cut) = cut
                    && ui
                        .button("Copy drawing")
                        .on_hover_text(
                            "As the text of an SVG file; `reliefscope probe --svg` writes the same",
                        )
                        .clicked()
                {
                    ctx.copy_text(draw_profile(cut, [1200.0, 560.0]).to_svg());
                }
            });
            ScrollArea::both()
                .auto_shrink([false, false])
                .show(ui, |ui| {
                    let label = RichText::new(text.as_str()).monospace();
                    ui.add(egui::Label::new(label).extend().selectable(true));
                });
        });
    if !open {
        *story = None;
    }
}

/// Paints a drawing where the next widget would be.
fn drawing_ui(ui: &mut Ui, drawing: &Drawing) {
    let (response, painter) = ui.allocate_painter(Vec2::from(drawing.size), egui::Sense::hover());
    response.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::Image, true, "Cut through the relief")
    });
    let origin = response.rect.min;
    let place = |p: [f32; 2]| origin + Vec2::from(p);
    painter.rect_filled(response.rect, 3.0, rgb(drawing.paper));
    for shape in &drawing.shapes {
        match shape {
            Shape::Line {
                points,
                width,
                color,
                dashed,
            } => {
                let points: Vec<Pos2> = points.iter().copied().map(place).collect();
                let stroke = Stroke::new(*width, rgb(*color));
                if *dashed {
                    painter.extend(Paint::dashed_line(&points, stroke, 5.0, 4.0));
                } else {
                    painter.add(Paint::line(points, stroke));
                }
            }
            Shape::Area { points, color } => fill_below(&painter, points, rgb(*color), place),
            Shape::Dot { at, radius, color } => {
                painter.circle_filled(place(*at), *radius, rgb(*color));
            }
            Shape::Text {
                at,
                anchor,
                size,
                color,
                text,
            } => {
                let align = match anchor {
                    Anchor::Start => Align2::LEFT_BOTTOM,
                    Anchor::Middle => Align2::CENTER_BOTTOM,
                    Anchor::End => Align2::RIGHT_BOTTOM,
                };
                let font = FontId::proportional(*size);
                let galley = painter.layout_no_wrap(text.clone(), font, rgb(*color));
                // Drawings say where letters stand, not where the line below them ends.
                let glyph = galley.rows.first().and_then(|row| row.glyphs.first());
                let below = glyph.map_or(0.0, |glyph| glyph.font_height - glyph.font_ascent);
                let foot = place(*at) + Vec2::new(0.0, below);
                let rect = align.anchor_size(foot, galley.size());
                painter.galley(rect.min, galley, rgb(*color));
            }
        }
    }
}

/// Fills the area under a line that runs from left to right and is closed by the two last corners below it:
/// egui fills only convex shapes, so it goes strip by strip.
fn fill_below(
    painter: &egui::Painter,
    points: &[[f32; 2]],
    color: Color32,
    place: impl Fn([f32; 2]) -> Pos2,
) {
    let Some((line, [[_, bottom], _])) = points.split_last_chunk::<2>() else {
        return;
    };
    let mut mesh = egui::Mesh::default();
    for (i, &[x, y]) in (0_u32..).zip(line) {
        mesh.colored_vertex(place([x, y]), color);
        mesh.colored_vertex(place([x, *bottom]), color);
        if i > 0 {
            let k = 2 * i;
            mesh.add_triangle(k - 2, k - 1, k);
            mesh.add_triangle(k - 1, k, k + 1);
        }
    }
    painter.add(mesh);
}

const fn rgb([r, g, b]: [u8; 3]) -> Color32 {
    Color32::from_rgb(r, g, b)
}
