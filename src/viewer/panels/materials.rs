//! Materials: numbers, and the list of map slots.

use egui::{ScrollArea, Ui};

use super::PanelContext;
use super::map_slot::slots_ui;
use crate::shading::Material;
use crate::viewer::widgets::{Caption, Number, color_ui, number_ui, row_ui, slider_ui};

pub(super) fn materials_ui(ui: &mut Ui, panel: &mut PanelContext<'_>) {
    let materials = &panel.doc.settings.materials;
    if materials.is_empty() {
        ui.weak("The model has no materials.");
        return;
    }
    panel.state.material = panel.state.material.min(materials.len() - 1);
    list_ui(ui, materials, &mut panel.state.material);
    let index = panel.state.material;
    let mapping = panel.doc.settings.mapping;
    let original = panel.doc.original.materials.get(index).cloned();
    if let Some(material) = panel.doc.settings.materials.get_mut(index) {
        ui.separator();
        numbers_ui(ui, material, original.as_ref());
        own_relief_ui(ui, material, &mapping);
    }
    ui.separator();
    slots_ui(ui, panel, index);
}

fn list_ui(ui: &mut Ui, materials: &[Material], selected: &mut usize) {
    ScrollArea::vertical()
        .id_salt("materials")
        .max_height(136.0)
        .auto_shrink([false, true])
        .show(ui, |ui| {
            for (i, material) in materials.iter().enumerate() {
                let maps = material.maps.len();
                let maps = match maps {
                    0 => String::new(),
                    1 => "1 map".into(),
                    n => format!("{n} maps"),
                };
                let size = egui::vec2(ui.available_width(), 0.0);
                let button = egui::Button::selectable(*selected == i, material.name.as_str())
                    .right_text(egui::RichText::new(maps).weak())
                    .min_size(size);
                let response = ui.add(button);
                let name = format!("Material {}", material.name);
                response.widget_info(|| {
                    egui::WidgetInfo::selected(egui::Role::Button, true, *selected == i, &name)
                });
                if response.clicked() {
                    *selected = i;
                }
            }
        });
}

fn numbers_ui(ui: &mut Ui, material: &mut Material, original: Option<&Material>) {
    color_ui(
        ui,
        Caption::named("Diffuse kd", "kd"),
        &mut material.kd,
        original.map(|o| &o.kd),
    );
    color_ui(
        ui,
        Caption::named("Specular ks", "ks"),
        &mut material.ks,
        original.map(|o| &o.ks),
    );
    let speed = f64::from(material.shininess.max(1.0)) / 50.0;
    number_ui(
        ui,
        Caption::new("Shininess"),
        &Number::within(0.0..=1e5, speed),
        &mut material.shininess,
        original.map(|o| &o.shininess),
    );
    slider_ui(
        ui,
        Caption::new("Reflectivity"),
        0.0..=1.0,
        &mut material.reflectivity,
        original.map(|o| &o.reflectivity),
    );
}

/// Amplitude and midlevel that go before those of the method section.
fn own_relief_ui(
    ui: &mut Ui,
    material: &mut Material,
    mapping: &crate::surface::mapping::MappingSettings,
) {
    let common = mapping.amplitude.unwrap_or(material.default_amplitude);
    row_ui(ui, Caption::new("Own relief"), |ui| {
        let mut own = material.amplitude.is_some();
        if ui.checkbox(&mut own, "Own amplitude").changed() {
            material.amplitude = own.then_some(common);
        }
    });
    if let Some(amplitude) = &mut material.amplitude {
        let speed = material.default_amplitude.max(1e-4) / 50.0;
        let number = Number::within(0.0..=f64::MAX, speed);
        number_ui(
            ui,
            Caption::named("Amplitude", "Material amplitude"),
            &number,
            amplitude,
            None,
        );
    }
    row_ui(ui, Caption::named("", "Own midlevel"), |ui| {
        let mut own = material.midlevel.is_some();
        if ui.checkbox(&mut own, "Own midlevel").changed() {
            material.midlevel = own.then_some(mapping.midlevel);
        }
    });
    if let Some(midlevel) = &mut material.midlevel {
        slider_ui(
            ui,
            Caption::named("Midlevel", "Material midlevel"),
            0.0..=1.0,
            midlevel,
            None,
        );
    }
}
