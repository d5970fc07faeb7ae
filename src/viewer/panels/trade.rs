//! What accuracy costs on this model from here: every method as a point, and advice.

use std::sync::Arc;

use egui::{Color32, Pos2, RichText, Ui};
use egui_plot::{
    GridInput, GridMark, HoverPosition, Line, MarkerShape, Plot, PlotPoint, PlotUi, Points,
};

use super::PanelContext;
use crate::measure::trade::{Glance, GlancePoint, PlotMetric, Variant, method_color};
use crate::render::Snapshot;
use crate::surface::mapping::{MappingSettings, Method};
use crate::viewer::theme;

/// Points of a plot, downwards.
const HEIGHT: f32 = 210.0;
/// More powers of ten than any figure here spans.
const MOST_DECADES: f64 = 50.0;
/// A click may miss its point by so many points.
const REACH: f32 = 12.0;

pub(super) fn trade_ui(ui: &mut Ui, panel: &mut PanelContext<'_>) {
    let window = ui.ctx().content_rect().size();
    let snapshot = Snapshot {
        scene: Arc::clone(&panel.doc.scene),
        settings: Arc::new(panel.doc.settings.clone()),
        // Only its shape matters.
        size: [window.x, window.y].map(|n| n.max(1.0) as u32),
    };
    let now = ui.input(|input| input.time);
    let meter = &mut panel.state.trade;
    let found = meter.look(ui.ctx(), &snapshot, (panel.state.threads, now));
    let found = found.cloned();
    if meter.is_running() {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.weak("measuring");
        });
    }
    let mapping = &mut panel.doc.settings.mapping;
    match found {
        None => {
            ui.weak("Measured once nothing moves.");
        }
        Some(Err(why)) => {
            ui.colored_label(theme::WEAK, why);
        }
        Some(Ok(glance)) => {
            advice_ui(ui, &glance, mapping);
            cost_ui(ui, &glance, mapping);
            angle_ui(ui, &glance, mapping);
            let note = "Times share the machine with the picture, and pictures are small; `reliefscope measure` takes its time.";
            ui.add(egui::Label::new(RichText::new(note).small().color(theme::WEAK)).wrap());
        }
    }
}

/// The cheapest that are good enough, each with a button that shows it.
fn advice_ui(ui: &mut Ui, glance: &Glance, mapping: &mut MappingSettings) {
    for advice in &glance.advice {
        ui.add(egui::Label::new(advice.line.as_str()).wrap());
        if let Some(variant) = advice.variant {
            let text = format!("Show {}", variant.label());
            if ui.small_button(text).clicked() {
                variant.choose(mapping);
            }
        }
    }
}

/// Error against cost in this view. A click on a point shows its method.
fn cost_ui(ui: &mut Ui, glance: &Glance, mapping: &mut MappingSettings) {
    let points: Vec<&GlancePoint> = glance.points.iter().filter(|p| p.is_own).collect();
    let place = |p: &GlancePoint| [p.ns.max(1e-3).log10(), log_error(p)];
    let chosen = Variant::current(mapping.method, mapping);
    let labels: Vec<(String, [f64; 2])> = points.iter().map(|p| (told(p), place(p))).collect();
    ui.label("Error against cost, from here");
    let plot = log_plot("cost", true)
        .x_axis_label("ns per sample")
        .label_formatter(move |hover| nearest_label(&labels, hover));
    let shown = plot.show(ui, |plot| {
        for point in &points {
            let is_chosen = point.variant == chosen;
            plot.points(dot(point.variant, vec![place(point)], is_chosen));
        }
    });
    let response = shown
        .response
        .on_hover_cursor(egui::CursorIcon::PointingHand);
    response
        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Error against cost"));
    if let Some(pointer) = response
        .interact_pointer_pos()
        .filter(|_| response.clicked())
    {
        let on_screen = |p: &GlancePoint| {
            let [x, y] = place(p);
            shown.transform.position_from_point(&PlotPoint::new(x, y))
        };
        if let Some(variant) = clicked(&points, pointer, on_screen) {
            variant.choose(mapping);
        }
    }
}

/// The variant whose point was meant, if any.
fn clicked(
    points: &[&GlancePoint],
    pointer: Pos2,
    on_screen: impl Fn(&GlancePoint) -> Pos2,
) -> Option<Variant> {
    let distances = points
        .iter()
        .map(|p| (on_screen(p).distance(pointer), p.variant));
    let nearest = distances.min_by(|a, b| a.0.total_cmp(&b.0))?;
    (nearest.0 <= REACH).then_some(nearest.1)
}

/// Error against the angle of the view, each method by its present parameters.
fn angle_ui(ui: &mut Ui, glance: &Glance, mapping: &MappingSettings) {
    ui.label("Error against the angle of the view");
    let own = glance.own_angle_deg;
    let shown = log_plot("angle", false)
        .x_axis_label("degrees from the normal")
        .include_x(0.0)
        .include_x(90.0)
        .x_grid_spacer(egui_plot::uniform_grid_spacer(|_| [15.0, 30.0, 90.0]))
        .label_formatter(|hover| match hover {
            HoverPosition::NearDataPoint {
                plot_name,
                position,
                ..
            } if !plot_name.is_empty() => Some(format!(
                "{plot_name}, {:.0}°: {:.3} texels",
                position.x,
                10.0_f64.powf(position.y)
            )),
            _ => None,
        })
        .show(ui, |plot| {
            for method in Method::ALL {
                line_of(plot, glance, Variant::current(method, mapping), mapping);
            }
            plot.vline(egui_plot::VLine::new("", own).color(theme::WEAK).width(1.0));
        });
    shown.response.widget_info(|| {
        egui::WidgetInfo::labeled(
            egui::Role::Image,
            true,
            "Error against the angle of the view",
        )
    });
}

fn line_of(plot: &mut PlotUi<'_>, glance: &Glance, variant: Variant, mapping: &MappingSettings) {
    let own = glance.points.iter().filter(|p| p.variant == variant);
    let mut places: Vec<[f64; 2]> = own.map(|p| [p.angle_deg, log_error(p)]).collect();
    if places.is_empty() {
        return;
    }
    places.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let is_chosen = variant.method == mapping.method;
    let line = Line::new(variant.label(), places.clone())
        .color(bright(variant))
        .width(if is_chosen { 3.0 } else { 1.2 });
    plot.line(line);
    plot.points(dot(variant, places, is_chosen));
}

/// A plot whose error axis (and cost axis, if asked) holds logarithms.
fn log_plot<'a>(name: &str, log_x: bool) -> Plot<'a> {
    let power = |mark: GridMark| crate::measure::trade::short(10.0_f64.powf(mark.value));
    let plot = Plot::new(name)
        .height(HEIGHT)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .y_axis_label(PlotMetric::Texels.name())
        .y_grid_spacer(decades)
        .y_axis_formatter(move |mark, _| power(mark));
    if log_x {
        plot.x_grid_spacer(decades)
            .x_axis_formatter(move |mark, _| power(mark))
    } else {
        plot
    }
}

/// Marks at the powers of ten in sight; at 2 and 5 times these, too, where few are.
fn decades(input: GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    if !(high - low < MOST_DECADES) {
        return Vec::new();
    }
    let digits: &[f64] = if high - low < 2.0 {
        &[1.0, 2.0, 5.0]
    } else {
        &[1.0]
    };
    let powers = low.floor() as i32..=high.ceil() as i32;
    let marks = powers.flat_map(|power| {
        digits.iter().map(move |digit| GridMark {
            value: f64::from(power) + digit.log10(),
            // All are worth a label.
            step_size: 1.0,
        })
    });
    marks.filter(|m| (low..=high).contains(&m.value)).collect()
}

fn log_error(point: &GlancePoint) -> f64 {
    point
        .errors
        .uv_texels
        .p95
        .max(PlotMetric::Texels.least())
        .log10()
}

fn dot<'a>(variant: Variant, places: Vec<[f64; 2]>, is_chosen: bool) -> Points<'a> {
    Points::new(variant.label(), places)
        .color(bright(variant))
        .shape(if is_chosen {
            MarkerShape::Diamond
        } else {
            MarkerShape::Circle
        })
        .radius(if is_chosen { 6.5 } else { 3.5 })
}

/// The method's colour in reports, light enough for a dark panel.
fn bright(variant: Variant) -> Color32 {
    let [r, g, b] = method_color(variant.method).map(|c| 70 + (u16::from(c) * 185 / 255) as u8);
    Color32::from_rgb(r, g, b)
}

fn told(point: &GlancePoint) -> String {
    let errors = &point.errors;
    let flip = point
        .flip
        .map_or_else(String::new, |flip| format!("\nFLIP {flip:.3}"));
    format!(
        "{}\n{:.0} ns per sample\nuv {:.3} texels (p95)\nnormal {:.1}° (p95){flip}",
        point.variant.label(),
        point.ns,
        errors.uv_texels.p95,
        errors.normal_deg.p95
    )
}

/// What is said over a point.
fn nearest_label(labels: &[(String, [f64; 2])], hover: &HoverPosition<'_>) -> Option<String> {
    let HoverPosition::NearDataPoint { position, .. } = hover else {
        return None;
    };
    let is_there = |at: &[f64; 2]| at[0] == position.x && at[1] == position.y;
    labels
        .iter()
        .find(|(_, at)| is_there(at))
        .map(|(label, _)| label.clone())
}
