//! A swatch that opens a picker: hue, saturation and brightness by eye, linear channels by number.

use egui::epaint::Hsva;
use egui::{
    Color32, DragValue, Mesh, Pos2, Rect, Response, Role, Sense, Shape, Stroke, Ui, Vec2,
    WidgetInfo, pos2,
};

use crate::math::{LinearRgb, srgb8_from_linear};

/// Steps of a track's gradient.
const STEPS: u32 = 24;
/// Brightest channel that the tracks reach; typed values may be brighter.
const BRIGHTEST: f32 = 1.0;

/// Hue, saturation and value, each 0…1, with the colour that they stood for. Grey has no hue of its own, so
/// the picker keeps the last one as long as the colour does not change elsewhere.
#[derive(Clone, Copy)]
struct Picked {
    hsv: [f32; 3],
    color: LinearRgb,
}

/// A button in the colour; its popup changes it.
pub fn color_edit_ui(ui: &mut Ui, name: &str, color: &mut LinearRgb) -> Response {
    let size = Vec2::new(40.0, ui.spacing().interact_size.y - 3.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::ColorWell, true, name));
    let stroke = ui.style().interact(&response).fg_stroke;
    let rim = Stroke::new(1.0, stroke.color.gamma_multiply(0.4));
    let fill = screen(*color);
    ui.painter()
        .rect(rect, 3.0, fill, rim, egui::StrokeKind::Inside);
    egui::Popup::from_toggle_button_response(&response)
        .close_behavior(egui::PopupCloseBehavior::CloseOnClickOutside)
        .show(|ui| picker_ui(ui, name, color));
    response
}

/// Hue, saturation and brightness along a slider.
type Track<'a> = &'a dyn Fn(f32) -> [f32; 3];

fn picker_ui(ui: &mut Ui, name: &str, color: &mut LinearRgb) {
    let id = egui::Id::unique(("colour", name));
    let known = ui.data(|data| data.get_temp::<Picked>(id));
    let known = known.filter(|picked| picked.color == *color);
    let mut hsv = known.map_or_else(|| hsv_of(*color), |picked| picked.hsv);
    let [h, s, v] = hsv;
    let tracks: [(&str, Track<'_>); 3] = [
        ("hue", &|t| [t, 1.0, 1.0]),
        ("saturation", &|t| [h, t, v.max(0.15)]),
        ("brightness", &|t| [h, s, t]),
    ];
    let mut changed = false;
    for ((what, at), value) in tracks.into_iter().zip(&mut hsv) {
        let label = format!("{name} {what}");
        changed |= track_ui(ui, &label, value, &|t| screen(rgb_of(at(t)))).changed();
    }
    if changed {
        *color = rgb_of(hsv);
    }
    channels_ui(ui, name, color);
    let picked = Picked {
        hsv: if changed {
            hsv
        } else {
            known.map_or_else(|| hsv_of(*color), |p| p.hsv)
        },
        color: *color,
    };
    ui.data_mut(|data| data.insert_temp(id, picked));
}

/// The linear channels, which scene files hold.
fn channels_ui(ui: &mut Ui, name: &str, color: &mut LinearRgb) {
    ui.horizontal(|ui| {
        let channels = [
            ("red", &mut color.r),
            ("green", &mut color.g),
            ("blue", &mut color.b),
        ];
        for (what, value) in channels {
            let number = DragValue::new(value)
                .range(0.0..=1e6)
                .speed(0.005)
                .max_decimals(4);
            ui.name_inputs(format!("{name} {what}"), |ui| {
                ui.add_sized([58.0, ui.spacing().interact_size.y], number)
            });
        }
    });
}

/// A slider on a gradient.
fn track_ui(
    ui: &mut Ui,
    label: &str,
    value: &mut f32,
    color_at: &dyn Fn(f32) -> Color32,
) -> Response {
    let (rect, mut response) =
        ui.allocate_exact_size(Vec2::new(190.0, 16.0), Sense::click_and_drag());
    let track = rect.shrink2(Vec2::new(5.0, 2.0));
    if let Some(pos) = response.interact_pointer_pos() {
        *value = ((pos.x - track.left()) / track.width()).clamp(0.0, 1.0);
        response.mark_changed();
    }
    let shown = f64::from(*value);
    response.widget_info(|| WidgetInfo::slider(true, shown, label));
    ui.painter().add(gradient(track, color_at));
    let x = track.left() + *value * track.width();
    let handle = Rect::from_center_size(pos2(x, rect.center().y), Vec2::new(7.0, 16.0));
    let rim = Stroke::new(1.5, Color32::WHITE);
    let fill = color_at(*value);
    ui.painter()
        .rect(handle, 2.0, fill, rim, egui::StrokeKind::Inside);
    response
}

fn gradient(track: Rect, color_at: &dyn Fn(f32) -> Color32) -> Shape {
    let mut mesh = Mesh::default();
    for i in 0..=STEPS {
        let part = i as f32 / STEPS as f32;
        let x = track.left() + part * track.width();
        for y in [track.top(), track.bottom()] {
            mesh.colored_vertex(Pos2::new(x, y), color_at(part));
        }
        if i > 0 {
            let k = 2 * i;
            mesh.add_triangle(k - 2, k - 1, k);
            mesh.add_triangle(k - 1, k + 1, k);
        }
    }
    mesh.into()
}

fn hsv_of(color: LinearRgb) -> [f32; 3] {
    let srgb = srgb8_from_linear(color);
    let hsva = Hsva::from_srgb(srgb);
    // Brightness as the eye sees it: linear values would crowd at the dark end.
    [
        hsva.h,
        hsva.s,
        hsva.v.max(0.0).powf(1.0 / 2.2).min(BRIGHTEST),
    ]
}

fn rgb_of([h, s, v]: [f32; 3]) -> LinearRgb {
    Hsva::new(h, s, v.powf(2.2), 1.0).to_rgb().into()
}

fn screen(color: LinearRgb) -> Color32 {
    let [r, g, b] = srgb8_from_linear(color);
    Color32::from_rgb(r, g, b)
}

#[cfg(test)]
mod tests {
    use super::{hsv_of, rgb_of};
    use crate::math::LinearRgb;

    #[test]
    fn a_colour_survives_hue_and_back() {
        for color in [[1.0, 0.0, 0.0], [0.2, 0.4, 0.1], [0.5, 0.5, 0.5], [0.0; 3]] {
            let back = rgb_of(hsv_of(color.into())).to_array();
            for (a, b) in color.iter().zip(back) {
                // The way goes through bytes.
                assert!((a - b).abs() < 0.01, "{color:?} {back:?}");
            }
        }
        let white = rgb_of([0.3, 0.0, 1.0]);
        assert!((white.g - LinearRgb::WHITE.g).abs() < 1e-6);
    }
}
