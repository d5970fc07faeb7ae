//! Where numbers run out: the scene put elsewhere, and what textbooks would make of it.

use std::ops::RangeInclusive;

use egui::{RichText, Slider, SliderClamping, Ui};

use super::method::usual_amplitude;
use super::{Action, PanelContext};
use crate::geometry::{Kernel, Normalization, OffsetRule};
use crate::scene::View;
use crate::scene::built_in::Placement;
use crate::viewer::document::Document;
use crate::viewer::theme;
use crate::viewer::widgets::{Caption, choice_ui, row_ui};

/// Smallest and largest power of ten on the usual amplitude.
const AMPLITUDES: RangeInclusive<f64> = -6.0..=2.0;

/// A built-in scene and where it is to be.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    /// What opens it: [`Placement::name`].
    pub name: String,
    /// Whether it is centred and scaled before it is traced.
    pub normalize: bool,
}

pub(super) fn extremes_ui(ui: &mut Ui, panel: &mut PanelContext<'_>) {
    place_ui(ui, panel);
    angle_ui(ui, panel.doc);
    amplitude_ui(ui, panel.doc);
    suspect_ui(ui, panel);
}

/// Scale and offset of a built-in scene.
fn place_ui(ui: &mut Ui, panel: &mut PanelContext<'_>) {
    let scene = &panel.doc.scene;
    let Some((name, shown)) = Placement::of(&scene.source) else {
        ui.weak(
            "Only built-in scenes can be put elsewhere; \u{201c}Extremes\u{201d} is made for it.",
        );
        return;
    };
    // What is on its way goes before what is shown, or the sliders would jump back until it is there.
    let coming = panel.state.place.as_ref();
    let placement = coming.and_then(|place| Placement::split(&place.name));
    let mut placement = placement.map_or(shown, |(_, placement)| placement);
    let is_normalized = scene.normalization != Normalization::IDENTITY;
    let mut normalize = coming.map_or(is_normalized, |place| place.normalize);
    let before = (placement, normalize);

    let mut scale = placement.scale.log10().round() as i32;
    let most = Placement::MOST_SCALE;
    exponent_ui(ui, "Scale 10^", &mut scale, -most..=most);
    // 0 is no offset at all: one radius is no extreme.
    let mut offset = placement.offset.max(1.0).log10().round() as i32;
    exponent_ui(
        ui,
        "Radii away 10^",
        &mut offset,
        0..=Placement::MOST_OFFSET,
    );
    ui.checkbox(&mut normalize, "Centred and scaled before tracing")
        .on_hover_text(
            "What the program does with everything it opens; --no-normalize turns it off",
        );
    if scale != before.0.scale.log10().round() as i32 {
        placement.scale = 10_f64.powi(scale);
    }
    if offset != before.0.offset.max(1.0).log10().round() as i32 {
        placement.offset = if offset == 0 {
            0.0
        } else {
            10_f64.powi(offset)
        };
    }
    if (placement, normalize) != before {
        panel.actions.push(Action::Place(Place {
            name: placement.name(name),
            normalize,
        }));
    }
}

fn exponent_ui(ui: &mut Ui, name: &str, value: &mut i32, range: RangeInclusive<i32>) {
    row_ui(ui, Caption::new(name), |ui| {
        ui.add(Slider::new(value, range));
    });
}

/// The view's angle to the vertical.
fn angle_ui(ui: &mut Ui, doc: &mut Document) {
    let camera = &mut doc.settings.camera;
    let up = camera.up.normalize_or(glam::DVec3::Z);
    let to_eye = (camera.eye - camera.target).normalize_or(up);
    let shown = to_eye.dot(up).clamp(-1.0, 1.0).acos().to_degrees();
    let mut angle = shown;
    let moved = row_ui(ui, Caption::new("View angle"), |ui| {
        // A camera below the horizon stays there until somebody moves the slider.
        let slider = Slider::new(&mut angle, 0.6..=89.99)
            .clamping(SliderClamping::Edits)
            .suffix("\u{b0}")
            .max_decimals(2);
        ui.add(slider).changed()
    });
    // A slider rounds what it shows; only a change that was meant turns the camera.
    if moved && (angle - shown).abs() > 0.02 {
        camera.orbit(0.0, (shown - angle).to_radians());
    }
}

/// The amplitude over the usual one, as a power of ten.
fn amplitude_ui(ui: &mut Ui, doc: &mut Document) {
    let usual = usual_amplitude(doc);
    let amplitude = &mut doc.settings.mapping.amplitude;
    let shown = (amplitude.unwrap_or(usual) / usual).log10();
    let shown = shown.clamp(*AMPLITUDES.start(), *AMPLITUDES.end());
    let mut exponent = shown;
    let moved = row_ui(ui, Caption::new("Amplitude 10^"), |ui| {
        let slider = Slider::new(&mut exponent, AMPLITUDES).max_decimals(2);
        // Named before the hint: a hint would become the name of a control without one.
        ui.name_inputs("Amplitude 10^", |ui| ui.add(slider))
            .on_hover_text("Of the largest amplitude that a material has by itself")
            .changed()
    });
    if moved && (exponent - shown).abs() > 0.005 {
        *amplitude = Some(usual * 10_f64.powf(exponent));
    }
}

/// Whose mistakes are shown, and how many there are.
fn suspect_ui(ui: &mut Ui, panel: &mut PanelContext<'_>) {
    const OVERLAYS: [View; 6] = [
        View::Picture,
        View::Leaks,
        View::FalseShadows,
        View::InvalidNormals,
        View::NonFinite,
        View::StepsAtTheCap,
    ];
    let display = &mut panel.doc.display;
    let caption = Caption::named("Triangle test", "Kernel");
    choice_ui(ui, caption, &mut display.kernel, &Kernel::ALL, Kernel::name);
    let caption = Caption::new("Offset rule");
    let rule = &mut display.offset_rule;
    choice_ui(ui, caption, rule, &OffsetRule::ALL, OffsetRule::name);
    let caption = Caption::new("Overlay");
    choice_ui(ui, caption, &mut display.view, &OVERLAYS, View::name);
    let legend = panel.state.stats.legend;
    if let Some(legend) = legend.filter(|legend| legend.view == display.view) {
        let text = format!("{} pixels: {}", legend.marked, legend.view.meaning());
        ui.add(egui::Label::new(RichText::new(text).color(theme::ACCENT)).wrap());
    }
    ui.weak("The picture is always the program's own. An overlay traces it once more by this kernel and offset.");
}
