//! Rows of labelled controls. Every control has a name that screen readers and tests find it by.

use std::ops::RangeInclusive;

use egui::{
    Align, Button, Color32, ComboBox, DragValue, Layout, Pos2, Role, Sense, Slider, Stroke, Ui,
    Vec2, WidgetInfo,
};

use super::color_edit::color_edit_ui;
use super::theme;
use crate::math::LinearRgb;

/// Width of the labels in front of controls, points.
const LABEL_WIDTH: f32 = 92.0;

/// What a row shows in front and what its control is called: unique within the window.
#[derive(Debug, Clone, Copy)]
pub struct Caption<'a> {
    /// Text in front.
    pub text: &'a str,
    /// Accessible name.
    pub name: &'a str,
}

impl<'a> Caption<'a> {
    /// The text is already unique.
    #[must_use]
    pub const fn new(text: &'a str) -> Self {
        Self { text, name: text }
    }

    /// The name says whose control it is.
    #[must_use]
    pub const fn named(text: &'a str, name: &'a str) -> Self {
        Self { text, name }
    }
}

/// A row: label of fixed width, then controls that get the caption's name unless they have one.
pub fn row_ui<R>(ui: &mut Ui, caption: Caption<'_>, add: impl FnOnce(&mut Ui) -> R) -> R {
    ui.horizontal(|ui| {
        let size = Vec2::new(LABEL_WIDTH, ui.spacing().interact_size.y);
        ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
            ui.set_min_width(LABEL_WIDTH);
            ui.colored_label(theme::WEAK, caption.text);
        });
        ui.name_inputs(caption.name, add)
    })
    .inner
}

/// A button that takes a value back to where it was when the scene was opened. Keeps its place when hidden.
pub fn reset_ui<T: PartialEq + Clone>(ui: &mut Ui, name: &str, value: &mut T, original: &T) {
    let side = 14.0;
    if value == original {
        ui.add_space(side + ui.spacing().item_spacing.x);
        return;
    }
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(side), Sense::click());
    let label = format!("Reset {name}");
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
    paint_reset(
        ui,
        rect.center(),
        ui.style().interact(&response).fg_stroke.color,
    );
    if response.on_hover_text("As it was when opened").clicked() {
        *value = original.clone();
    }
}

/// An arrow that turns back; the fonts have none.
fn paint_reset(ui: &Ui, center: Pos2, color: Color32) {
    use std::f32::consts::TAU;
    let (radius, stroke) = (4.2, Stroke::new(1.4, color));
    let at = |turn: f32| center + Vec2::angled(TAU * turn) * radius;
    let arc = (0..=16).map(|i| at(-0.45 + 0.78 * i as f32 / 16.0));
    ui.painter().line(arc.collect(), stroke);
    let tip = at(-0.45);
    for barb in [Vec2::new(-0.5, -4.0), Vec2::new(4.0, -0.5)] {
        ui.painter().line_segment([tip, tip + barb], stroke);
    }
}

/// A number that is dragged or typed.
pub struct Number {
    /// Smallest and largest value.
    pub range: RangeInclusive<f64>,
    /// Change per point of dragging.
    pub speed: f64,
    /// Unit behind the number.
    pub suffix: &'static str,
}

impl Number {
    /// Any finite number.
    #[must_use]
    pub fn free(speed: f64) -> Self {
        Self {
            range: f64::MIN..=f64::MAX,
            speed,
            suffix: "",
        }
    }

    /// Between bounds.
    #[must_use]
    pub const fn within(range: RangeInclusive<f64>, speed: f64) -> Self {
        Self {
            range,
            speed,
            suffix: "",
        }
    }

    fn drag_value<'a, T: egui::emath::Numeric>(&self, value: &'a mut T) -> DragValue<'a> {
        DragValue::new(value)
            .range(self.range.clone())
            .speed(self.speed)
            .suffix(self.suffix)
            .max_decimals(if T::INTEGRAL { 0 } else { 5 })
    }
}

/// A row with one number and its reset.
pub fn number_ui<T>(
    ui: &mut Ui,
    caption: Caption<'_>,
    number: &Number,
    value: &mut T,
    original: Option<&T>,
) where
    T: egui::emath::Numeric,
{
    row_ui(ui, caption, |ui| {
        ui.add_sized(
            [76.0, ui.spacing().interact_size.y],
            number.drag_value(value),
        );
        if let Some(original) = original {
            reset_ui(ui, caption.name, value, original);
        }
    });
}

/// A row with a slider, its typed value and its reset.
pub fn slider_ui(
    ui: &mut Ui,
    caption: Caption<'_>,
    range: RangeInclusive<f32>,
    value: &mut f32,
    original: Option<&f32>,
) {
    row_ui(ui, caption, |ui| {
        let rail = format!("{} slider", caption.name);
        ui.spacing_mut().slider_width = 92.0;
        ui.name_inputs(rail, |ui| {
            ui.add(Slider::new(value, range.clone()).show_value(false))
        });
        let speed = f64::from(range.end() - range.start()) / 200.0;
        let number = Number::within(f64::from(*range.start())..=f64::from(*range.end()), speed);
        ui.add_sized(
            [54.0, ui.spacing().interact_size.y],
            number.drag_value(value),
        );
        if let Some(original) = original {
            reset_ui(ui, caption.name, value, original);
        }
    });
}

/// A row with three numbers, named "… x", "… y", "… z".
pub fn vector_ui(ui: &mut Ui, caption: Caption<'_>, speed: f64, value: &mut glam::DVec3) {
    row_ui(ui, caption, |ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        for (axis, number) in ["x", "y", "z"].into_iter().zip(value.as_mut()) {
            ui.name_inputs(format!("{} {axis}", caption.name), |ui| {
                let drag = Number::free(speed).drag_value(number).max_decimals(3);
                ui.add_sized([57.0, ui.spacing().interact_size.y], drag);
            });
        }
    });
}

/// A row with two numbers, named "… u", "… v".
pub fn pair_ui(ui: &mut Ui, caption: Caption<'_>, speed: f64, value: &mut [f32; 2]) {
    row_ui(ui, caption, |ui| {
        for (axis, number) in ["u", "v"].into_iter().zip(value) {
            ui.name_inputs(format!("{} {axis}", caption.name), |ui| {
                let drag = Number::free(speed).drag_value(number);
                ui.add_sized([62.0, ui.spacing().interact_size.y], drag);
            });
        }
    });
}

/// A row with a colour button (linear values) and its reset.
pub fn color_ui(
    ui: &mut Ui,
    caption: Caption<'_>,
    color: &mut LinearRgb,
    original: Option<&LinearRgb>,
) {
    row_ui(ui, caption, |ui| {
        color_edit_ui(ui, caption.name, color);
        let [r, g, b] = color.to_array().map(|c| format!("{c:.2}"));
        ui.label(
            egui::RichText::new(format!("{r} {g} {b}"))
                .monospace()
                .color(theme::WEAK),
        );
        if let Some(original) = original {
            reset_ui(ui, caption.name, color, original);
        }
    });
}

/// A row with a list to choose from.
pub fn choice_ui<T: PartialEq + Copy>(
    ui: &mut Ui,
    caption: Caption<'_>,
    value: &mut T,
    all: &[T],
    label: impl Fn(T) -> &'static str,
) {
    row_ui(ui, caption, |ui| {
        let before = *value;
        ComboBox::from_id_salt(caption.name)
            .selected_text(label(before))
            .show_ui(ui, |ui| {
                for &item in all {
                    ui.selectable_value(value, item, label(item));
                }
            });
    });
}

/// A text field of the remaining width, with an accessible name.
pub fn text_ui(ui: &mut Ui, name: &str, hint: &str, text: &mut String) -> egui::Response {
    ui.name_inputs(name, |ui| {
        let edit = egui::TextEdit::singleline(text)
            .hint_text(hint)
            .desired_width(f32::INFINITY);
        let response = ui.add(edit);
        response.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, name));
        response
    })
}

/// A small button whose name says more than its face.
pub fn named_button_ui(ui: &mut Ui, face: &str, name: &str) -> egui::Response {
    let response = ui.add(Button::new(face).small());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
    response.on_hover_text(name)
}
