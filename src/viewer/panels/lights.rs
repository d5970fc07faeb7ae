//! Lights: add, remove, switch, colour, dim, move.

use egui::Ui;
use glam::DVec3;

use super::PanelContext;
use crate::scene::Camera;
use crate::shading::{Falloff, Light, LightKind};
use crate::viewer::document::Document;
use crate::viewer::widgets::{
    Caption, Number, choice_ui, color_ui, named_button_ui, number_ui, text_ui, vector_ui,
};

pub(super) fn lights_ui(ui: &mut Ui, panel: &mut PanelContext<'_>) {
    add_ui(ui, panel.doc);
    let speed = panel.doc.extent() / 200.0;
    let originals = &panel.doc.original.lights;
    let mut removed = None;
    for (i, light) in panel.doc.settings.lights.iter_mut().enumerate() {
        ui.push_id(("light", i), |ui| {
            ui.separator();
            let original = originals.get(i).filter(|o| same_kind(o, light));
            if light_ui(ui, light, original, speed) {
                removed = Some(i);
            }
        });
    }
    if let Some(i) = removed {
        panel.doc.settings.lights.remove(i);
    }
}

fn same_kind(a: &Light, b: &Light) -> bool {
    std::mem::discriminant(&a.kind) == std::mem::discriminant(&b.kind)
}

fn add_ui(ui: &mut Ui, doc: &mut Document) {
    ui.horizontal(|ui| {
        ui.label("Add");
        let has_ambient = doc
            .settings
            .lights
            .iter()
            .any(|l| l.kind == LightKind::Ambient);
        let ambient = ui.add_enabled(!has_ambient, egui::Button::new("Ambient"));
        if ambient
            .on_disabled_hover_text("There is one already")
            .clicked()
        {
            add(doc, "ambient", |_, _| LightKind::Ambient, |_| 0.1);
        }
        if ui.button("Point").clicked() {
            add(doc, "point", new_point, |distance| {
                (distance * distance) as f32
            });
        }
        if ui.button("Directional").clicked() {
            add(doc, "sun", new_directional, |_| 1.0);
        }
    });
}

/// Puts a light where it lights what the camera sees; `intensity` gets its distance from the pivot.
fn add(
    doc: &mut Document,
    name: &str,
    kind: impl Fn(&Camera, f64) -> LightKind,
    intensity: impl Fn(f64) -> f32,
) {
    let lights = &mut doc.settings.lights;
    let taken = |name: &str| lights.iter().any(|light| light.name == name);
    let mut names = (2..).map(|n| format!("{name} {n}"));
    let name = if taken(name) {
        names.find(|n| !taken(n)).unwrap_or_default()
    } else {
        name.to_owned()
    };
    let distance = doc.settings.camera.distance() * 0.5;
    let kind = kind(&doc.settings.camera, distance);
    lights.push(Light::new(name, kind, intensity(distance)));
}

/// Above the eye's shoulder, half way to the pivot.
fn new_point(camera: &Camera, distance: f64) -> LightKind {
    let axes = camera.axes();
    let from = (axes.right * 0.35 + axes.up * 0.45 - axes.forward * 0.8).normalize_or(DVec3::Z);
    LightKind::Point {
        position: camera.target + from * distance,
        falloff: Falloff::InverseSquare,
    }
}

fn new_directional(camera: &Camera, _distance: f64) -> LightKind {
    let axes = camera.axes();
    LightKind::Directional {
        direction: (axes.forward - axes.up * 0.7 + axes.right * 0.5).normalize_or(DVec3::NEG_Z),
    }
}

/// Returns whether it is to be removed.
fn light_ui(ui: &mut Ui, light: &mut Light, original: Option<&Light>, speed: f64) -> bool {
    let name = light.name.clone();
    let label = |what: &str| format!("{name} {what}");
    let removed = ui
        .horizontal(|ui| {
            ui.name_inputs(label("on"), |ui| {
                let response = ui.checkbox(&mut light.enabled, "");
                response.widget_info(|| {
                    egui::WidgetInfo::selected(
                        egui::WidgetType::Checkbox,
                        true,
                        light.enabled,
                        label("on"),
                    )
                });
            });
            let kind = match light.kind {
                LightKind::Ambient => "ambient",
                LightKind::Point { .. } => "point",
                LightKind::Directional { .. } => "directional",
            };
            let removed = named_button_ui(ui, "×", &label("remove")).clicked();
            ui.weak(kind);
            text_ui(ui, &label("name"), "name", &mut light.name);
            removed
        })
        .inner;
    color_ui(
        ui,
        Caption::named("Colour", &label("colour")),
        &mut light.color,
        original.map(|o| &o.color),
    );
    number_ui(
        ui,
        Caption::named("Intensity", &label("intensity")),
        &Number::within(0.0..=f64::MAX, f64::from(light.intensity.max(0.01)) / 100.0),
        &mut light.intensity,
        original.map(|o| &o.intensity),
    );
    match &mut light.kind {
        LightKind::Ambient => {}
        LightKind::Point { position, falloff } => {
            vector_ui(
                ui,
                Caption::named("Position", &label("position")),
                speed,
                position,
            );
            let names = |f| match f {
                Falloff::None => "none",
                Falloff::InverseSquare => "inverse square",
            };
            let all = [Falloff::InverseSquare, Falloff::None];
            choice_ui(
                ui,
                Caption::named("Falloff", &label("falloff")),
                falloff,
                &all,
                names,
            );
        }
        LightKind::Directional { direction } => {
            let before = *direction;
            vector_ui(
                ui,
                Caption::named("Direction", &label("direction")),
                0.01,
                direction,
            );
            // A direction of length zero lights nothing and cannot be dragged back.
            if direction.length_squared() < 1e-12 || !direction.is_finite() {
                *direction = before;
            }
        }
    }
    removed
}
