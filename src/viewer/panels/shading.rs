//! How light is gathered, and what lies behind everything.

use egui::Ui;

use super::PanelContext;
use crate::scene::{BentNormals, ShadingModel, TextureFilter};
use crate::viewer::widgets::{Caption, Number, choice_ui, color_ui, number_ui};

pub(super) fn shading_ui(ui: &mut Ui, panel: &mut PanelContext<'_>) {
    let original = panel.doc.original.shading;
    let shading = &mut panel.doc.settings.shading;
    let caption = Caption::named("Model", "Shading model");
    choice_ui(
        ui,
        caption,
        &mut shading.model,
        &ShadingModel::ALL,
        ShadingModel::name,
    );
    let caption = Caption::named("Bent", "Bent normals");
    choice_ui(
        ui,
        caption,
        &mut shading.bent_normals,
        &BentNormals::ALL,
        BentNormals::name,
    );
    let caption = Caption::named("Maps", "Texture filter");
    choice_ui(
        ui,
        caption,
        &mut shading.filter,
        &TextureFilter::ALL,
        TextureFilter::name,
    );
    ui.add_enabled_ui(shading.filter == TextureFilter::Mip, |ui| {
        ui.checkbox(&mut shading.specular_antialiasing, "Specular antialiasing")
            .on_hover_text(
                "Highlights widen where a pixel covers slopes that differ; needs mip maps",
            );
    });
    ui.checkbox(&mut shading.shadows, "Shadows");
    ui.checkbox(&mut shading.smooth_terminator, "Smooth terminator")
        .on_hover_text(
            "On coarse meshes light ends where smooth normals say, not in steps along the facets",
        );
    number_ui(
        ui,
        Caption::new("Mirror bounces"),
        &Number::within(0.0..=32.0, 0.05),
        &mut shading.max_bounces,
        Some(&original.max_bounces),
    );
    let (background, first) = (&mut shading.background, &original.background);
    let top = Caption::named("Sky top", "Background top");
    color_ui(ui, top, &mut background.top, Some(&first.top));
    let bottom = Caption::named("Sky bottom", "Background bottom");
    color_ui(ui, bottom, &mut background.bottom, Some(&first.bottom));
}
