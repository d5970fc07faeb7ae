//! Which way of perturbing the surface, and how strongly.

use egui::{Button, DragValue, RichText, Slider, SliderClamping, Ui, Vec2};

use super::PanelContext;
use crate::surface::mapping::{Derivative, Lookup, MappingSettings, Method, SearchSettings};
use crate::viewer::document::Document;
use crate::viewer::status::grouped;
use crate::viewer::theme;
use crate::viewer::widgets::{Caption, Number, choice_ui, number_ui, reset_ui, row_ui, slider_ui};

pub(super) fn method_ui(ui: &mut Ui, panel: &mut PanelContext<'_>) {
    buttons_ui(ui, &mut panel.doc.settings.mapping.method);
    let method = panel.doc.settings.mapping.method;
    ui.add(
        egui::Label::new(
            RichText::new(method.info().error_class.summary())
                .small()
                .color(theme::WEAK),
        )
        .wrap(),
    );
    amplitude_ui(ui, panel.doc);
    let original = panel.doc.original.mapping;
    let mapping = &mut panel.doc.settings.mapping;
    slider_ui(
        ui,
        Caption::new("Midlevel"),
        0.0..=1.0,
        &mut mapping.midlevel,
        Some(&original.midlevel),
    );
    switches_ui(ui, mapping);
    search_ui(ui, method, mapping, &original.search);
    if method == Method::Displacement {
        displacement_ui(ui, panel);
        return;
    }
    ui.add_enabled_ui(method.shifts_uv(), |ui| {
        let caption = Caption::named("Look-up", "Lookup");
        choice_ui(ui, caption, &mut mapping.lookup, &Lookup::ALL, Lookup::name);
    });
    let caption = Caption::new("Derivative");
    choice_ui(
        ui,
        caption,
        &mut mapping.derivative,
        &Derivative::ALL,
        Derivative::name,
    );
}

/// Two columns of buttons, each with its key.
fn buttons_ui(ui: &mut Ui, chosen: &mut Method) {
    let gap = ui.spacing().item_spacing.x;
    let size = Vec2::new((ui.available_width() - gap) * 0.5, 25.0);
    for pair in Method::ALL.chunks(2) {
        ui.horizontal(|ui| {
            for &method in pair {
                let info = method.info();
                let button = Button::selectable(*chosen == method, info.label)
                    .frame_when_inactive(true)
                    .min_size(size)
                    .shortcut_text(info.key.to_string());
                let response = ui.add_sized(size, button);
                response.widget_info(|| {
                    egui::WidgetInfo::selected(
                        egui::Role::Button,
                        true,
                        *chosen == method,
                        info.label,
                    )
                });
                if response.on_hover_ui(|ui| about_ui(ui, method)).clicked() {
                    *chosen = method;
                }
            }
        });
    }
}

fn about_ui(ui: &mut Ui, method: Method) {
    let info = method.info();
    ui.set_max_width(280.0);
    ui.label(info.summary);
    ui.label(RichText::new(format!("Error: {}", info.error_class.summary())).color(theme::WEAK));
    ui.label(RichText::new(format!("Source: {}", info.source)).color(theme::WEAK));
}

/// What the chosen search takes; nothing for methods that do not search.
fn search_ui(
    ui: &mut Ui,
    method: Method,
    mapping: &mut MappingSettings,
    original: &SearchSettings,
) {
    let search = &mut mapping.search;
    let count = |most: u32| Number::within(f64::from(1_u8)..=f64::from(most), 0.1);
    let layers = count(SearchSettings::MAX_LAYERS);
    match method {
        Method::Iterative => number_ui(
            ui,
            Caption::new("Iterations"),
            &count(SearchSettings::MAX_ITERATIONS),
            &mut search.iterations,
            Some(&original.iterations),
        ),
        Method::Steep | Method::Occlusion | Method::Relief | Method::RelaxedCone => {
            let name = if method == Method::RelaxedCone {
                "Cone steps"
            } else {
                "Layers"
            };
            let caption = Caption::new(name);
            number_ui(
                ui,
                caption,
                &layers,
                &mut search.layers,
                Some(&original.layers),
            );
        }
        _ => {}
    }
    if method == Method::Occlusion {
        let caption = Caption::named("Facing it", "Layers facing the surface");
        let (value, first) = (&mut search.min_layers, &original.min_layers);
        number_ui(ui, caption, &layers, value, Some(first));
    }
    if matches!(method, Method::Relief | Method::RelaxedCone) {
        let most = f64::from(SearchSettings::MAX_BISECTIONS);
        number_ui(
            ui,
            Caption::new("Bisections"),
            &Number::within(0.0..=most, 0.1),
            &mut search.bisections,
            Some(&original.bisections),
        );
    }
    if method.shifts_uv() {
        ui.checkbox(&mut mapping.cut_at_border, "Cut off at the chart's border")
            .on_hover_text(
                "Where the method looks beyond its chart there is nothing: the relief ends in a silhouette",
            );
    }
    if method.searches() {
        ui.checkbox(&mut search.self_shadow, "Relief shadows itself")
            .on_hover_text(
                "Every light is followed through the relief, exactly, by a pyramid of its extremes; \
                 light above the horizon of a place needs not be followed",
            );
    }
}

/// What true displacement takes, and what was found out about the mesh.
fn displacement_ui(ui: &mut Ui, panel: &mut PanelContext<'_>) {
    let weld_seams = &mut panel.doc.settings.mapping.weld_seams;
    ui.checkbox(weld_seams, "Weld seams").on_hover_text(
        "Where texture coordinates jump, both sides take the mean height, so that no crack opens",
    );
    let Some(displacement) = panel.doc.scene.displaced.last() else {
        return;
    };
    let [flat, fine] = displacement.kinds();
    if fine > 0 {
        let original = panel.doc.original.mapping.displacement_memory;
        number_ui(
            ui,
            Caption::named("Memory, MiB", "Displacement memory"),
            &Number::within(0.0..=65_536.0, 4.0),
            &mut panel.doc.settings.mapping.displacement_memory,
            Some(&original),
        );
    }
    let seams = displacement.seams();
    let gap = panel
        .doc
        .scene
        .normalization
        .world_length(seams.largest_gap);
    let mut said = Vec::new();
    if flat > 0 {
        let triangles = format!("{} triangles walked as flat reliefs", grouped(flat as u64));
        said.push(match displacement.sheets() {
            0 => triangles,
            1 => format!("{triangles}, one plane of them as a whole"),
            n => format!("{triangles}, {n} planes of them as a whole"),
        });
    }
    if fine > 0 {
        said.push(format!(
            "{} triangles cut up where rays come",
            grouped(fine as u64)
        ));
    }
    if seams.edges > 0 {
        let edges = grouped(seams.edges as u64);
        said.push(if gap > 0.0 {
            format!("{edges} seam edges, heights up to {gap:.2e} apart")
        } else {
            format!("{edges} seam edges, heights the same on both sides")
        });
    }
    let said = RichText::new(said.join("; ")).color(theme::WEAK);
    ui.add(egui::Label::new(said).wrap());
}

/// One amplitude for all, or each material its own default.
fn amplitude_ui(ui: &mut Ui, doc: &mut Document) {
    let usual = usual_amplitude(doc);
    let original = doc.original.mapping.amplitude;
    let amplitude = &mut doc.settings.mapping.amplitude;
    let mut own = amplitude.is_none();
    row_ui(ui, Caption::new("Amplitude"), |ui| {
        ui.add_enabled_ui(!own, |ui| {
            let mut value = amplitude.unwrap_or(usual);
            let before = value;
            ui.spacing_mut().slider_width = 92.0;
            // Up to a fifth of the tile, fine near zero; a typed value may go beyond.
            let slider = Slider::new(&mut value, 0.0..=usual * 10.0)
                .logarithmic(true)
                .smallest_positive(usual * 1e-3)
                .clamping(SliderClamping::Never)
                .show_value(false);
            ui.name_inputs("Amplitude slider", |ui| ui.add(slider));
            let number = DragValue::new(&mut value)
                .range(0.0..=f64::MAX)
                .speed(usual * 0.01)
                .max_decimals(6);
            let size = [62.0, ui.spacing().interact_size.y];
            // Named before the hint: a hint would become the name of a control without one.
            ui.name_inputs("Amplitude", |ui| ui.add_sized(size, number))
                .on_hover_text("World units from stored height 0 to stored height 1");
            if value != before && value.is_finite() {
                *amplitude = Some(value.max(0.0));
            }
        });
        reset_ui(ui, "Amplitude", amplitude, &original);
    });
    if ui
        .checkbox(&mut own, "Each material its own amplitude")
        .on_hover_text("From the material file (-bm), or 2 % of the tile's width")
        .changed()
    {
        *amplitude = (!own).then_some(usual);
    }
}

/// The largest amplitude that a material with a relief map would have by itself.
pub(super) fn usual_amplitude(doc: &Document) -> f64 {
    let amplitudes = doc.settings.materials.iter().map(|m| m.default_amplitude);
    let usual = amplitudes.fold(0.0, f64::max);
    if usual > 0.0 {
        usual
    } else {
        doc.extent() * 0.02
    }
}

fn switches_ui(ui: &mut Ui, mapping: &mut MappingSettings) {
    row_ui(ui, Caption::new("Maps on"), |ui| {
        ui.checkbox(&mut mapping.use_height, "Height")
            .on_hover_text("Height maps tilt normals");
        ui.checkbox(&mut mapping.use_normal, "Normal")
            .on_hover_text("Normal and slope maps tilt normals");
        ui.checkbox(&mut mapping.use_parallax, "Parallax")
            .on_hover_text("Parallax methods move texture coordinates");
    });
}
