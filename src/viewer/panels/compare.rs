//! Two methods in one view, and how far they are apart.

use egui::Ui;

use super::PanelContext;
use crate::measure::error_map::ErrorMetric;
use crate::surface::mapping::Method;
use crate::viewer::comparison::{Layout, second_name};
use crate::viewer::widgets::{Caption, Number, choice_ui, number_ui, slider_ui};

pub(super) fn compare_ui(ui: &mut Ui, panel: &mut PanelContext<'_>) {
    let a = panel.doc.settings.mapping.method;
    let comparison = &mut panel.doc.comparison;
    let mut on = comparison.on;
    let toggled = ui
        .checkbox(&mut on, "Compare two methods")
        .on_hover_text(
            "A is the method above. B is rendered beside it, with the same camera and samples",
        )
        .changed();
    if toggled {
        comparison.turn(on, a);
    }
    ui.add_enabled_ui(comparison.on, |ui| {
        let caption = Caption::named("Method B", "Other method");
        choice_ui(
            ui,
            caption,
            &mut comparison.method,
            &Method::ALL,
            second_name,
        );
        let caption = Caption::new("Layout");
        choice_ui(
            ui,
            caption,
            &mut comparison.layout,
            &Layout::ALL,
            Layout::label,
        );
        ui.add_enabled_ui(comparison.layout == Layout::Wipe, |ui| {
            let caption = Caption::new("Wipe");
            slider_ui(ui, caption, 0.0..=1.0, &mut comparison.split, Some(&0.5));
        });
        let mut error = comparison.error;
        let mut errors = vec![None];
        errors.extend(ErrorMetric::ALL.map(Some));
        let label = |error: Option<ErrorMetric>| error.map_or("picture B", ErrorMetric::label);
        choice_ui(
            ui,
            Caption::named("Show", "Shown of B"),
            &mut error,
            &errors,
            label,
        );
        comparison.show_error(error);
        if let Some(metric) = error {
            let most = f64::from(metric.most_full_scale());
            number_ui(
                ui,
                Caption::new("Full scale"),
                &Number::within(0.001..=most, most * 0.002),
                &mut comparison.full_scale,
                Some(&metric.usual_full_scale()),
            );
        }
    });
    ui.weak("B held shows B over the whole window.");
}
