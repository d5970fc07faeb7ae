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
        let ambient = ambient.on_disabled_hover_text("There is one already");
        if ambient.clicked() {
            add(doc, "ambient", LightKind::Ambient);
        }
        if ui.button("Point").clicked() {
            let kind = new_point(&doc.settings.camera);
            add(doc, "point", kind);
        }
        if ui.button("Directional").clicked() {
            let kind = new_directional(&doc.settings.camera);
            add(doc, "sun", kind);
        }
    });
}

/// Adds a light under a free name, as bright as it takes to see it at the pivot.
fn add(doc: &mut Document, name: &str, kind: LightKind) {
    let intensity = match kind {
        LightKind::Ambient => 0.1,
        LightKind::Directional { .. } => 1.0,
        LightKind::Point { position, .. } => {
            position.distance_squared(doc.settings.camera.target) as f32
        }
    };
    let lights = &mut doc.settings.lights;
    let taken = |name: &str| lights.iter().any(|light| light.name == name);
    let mut names = (2..).map(|n| format!("{name} {n}"));
    let name = if taken(name) {
        names.find(|n| !taken(n)).unwrap_or_default()
    } else {
        name.to_owned()
    };
    lights.push(Light::new(name, kind, intensity));
}

/// Between eye and pivot, in the upper half of the picture, where its marker can be seen.
fn new_point(camera: &Camera) -> LightKind {
    let axes = camera.axes();
    let depth = camera.distance() * 0.7;
    let height = 2.0 * depth * (camera.vfov * 0.5).tan();
    let aside = axes.up * 0.25 - axes.right * 0.1;
    LightKind::Point {
        position: camera.eye + axes.forward * depth + aside * height,
        falloff: Falloff::InverseSquare,
    }
}

/// Over the viewer's left shoulder.
fn new_directional(camera: &Camera) -> LightKind {
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
                        egui::Role::CheckBox,
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
            // A direction of length zero lights nothing and cannot be dragged back, nor can one without a length.
            if !(1e-12..=f64::MAX).contains(&direction.length_squared()) {
                *direction = before;
            }
        }
    }
    removed
}
