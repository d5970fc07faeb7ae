//! Dark, quiet looks: the picture is the bright thing in the window.

use egui::{Color32, CornerRadius, FontFamily, FontId, Margin, Stroke, TextStyle, Vec2, Visuals};

/// Marks what is chosen or needs the eye: warm light on relief.
pub const ACCENT: Color32 = Color32::from_rgb(226, 168, 92);
/// Something went wrong.
pub const ERROR: Color32 = Color32::from_rgb(232, 106, 92);
/// Something is done or complete.
pub const GOOD: Color32 = Color32::from_rgb(126, 190, 130);
/// Ordinary text.
pub const TEXT: Color32 = Color32::from_rgb(208, 210, 214);
/// Secondary text; 5.5:1 on the panel.
pub const WEAK: Color32 = Color32::from_rgb(146, 150, 158);
/// Behind the picture and while none is there.
pub const BACKDROP: Color32 = Color32::from_rgb(13, 14, 16);

const RADIUS: CornerRadius = CornerRadius::same(4);

/// Behind status line and messages: the picture shimmers through.
pub fn glass() -> egui::Frame {
    sheet().fill(Color32::from_rgba_unmultiplied(20, 21, 24, 236))
}

/// Behind the panel, whose rows are read against it: opaque, so that it is the same over any picture.
pub fn sheet() -> egui::Frame {
    egui::Frame::new()
        .fill(Color32::from_rgb(20, 21, 24))
        .stroke(Stroke::new(1.0, Color32::from_rgb(46, 48, 54)))
        .corner_radius(CornerRadius::same(6))
        .inner_margin(Margin::same(10))
}

/// Sets fonts sizes, spacing and colours of a context.
pub fn apply(ctx: &egui::Context) {
    ctx.set_theme(egui::Theme::Dark);
    ctx.all_styles_mut(|style| {
        style.text_styles = [
            (TextStyle::Small, 11.5, FontFamily::Proportional),
            (TextStyle::Body, 13.5, FontFamily::Proportional),
            (TextStyle::Button, 13.5, FontFamily::Proportional),
            (TextStyle::Heading, 16.0, FontFamily::Proportional),
            (TextStyle::Monospace, 12.5, FontFamily::Monospace),
        ]
        .into_iter()
        .map(|(text, size, family)| (text, FontId::new(size, family)))
        .collect();
        style.spacing.item_spacing = Vec2::new(7.0, 5.0);
        style.spacing.button_padding = Vec2::new(7.0, 3.0);
        style.spacing.interact_size = Vec2::new(34.0, 21.0);
        style.spacing.combo_width = 110.0;
        style.spacing.slider_rail_height = 4.0;
        style.spacing.indent = 12.0;
        // Room for the floating scroll bar beside what is scrolled.
        style.spacing.scroll.floating_allocated_width = 7.0;
        style.animation_time = 0.08;
        style.interaction.selectable_labels = false;
        style.visuals = visuals();
    });
}

fn visuals() -> Visuals {
    let mut v = Visuals::dark();
    v.panel_fill = BACKDROP;
    v.window_fill = Color32::from_rgb(24, 25, 29);
    v.window_stroke = Stroke::new(1.0, Color32::from_rgb(54, 56, 63));
    v.window_corner_radius = CornerRadius::same(6);
    v.menu_corner_radius = CornerRadius::same(5);
    v.extreme_bg_color = Color32::from_rgb(12, 13, 15);
    v.faint_bg_color = Color32::from_rgb(30, 31, 36);
    v.selection.bg_fill = Color32::from_rgb(104, 73, 35);
    v.selection.stroke = Stroke::new(1.0, Color32::from_rgb(255, 226, 184));
    v.hyperlink_color = ACCENT;
    v.warn_fg_color = ACCENT;
    v.error_fg_color = ERROR;
    v.weak_text_color = Some(WEAK);
    v.slider_trailing_fill = true;
    v.indent_has_left_vline = false;
    let line = |gray: u8| Stroke::new(1.0, Color32::from_gray(gray));
    for (widget, fill, text) in [
        (&mut v.widgets.noninteractive, 24, TEXT),
        (&mut v.widgets.inactive, 44, TEXT),
        (&mut v.widgets.hovered, 58, Color32::WHITE),
        (&mut v.widgets.active, 70, Color32::WHITE),
        (&mut v.widgets.open, 50, Color32::WHITE),
    ] {
        widget.bg_fill = Color32::from_rgb(fill, fill + 1, fill + 5);
        widget.weak_bg_fill = widget.bg_fill;
        widget.fg_stroke = Stroke::new(1.0, text);
        widget.corner_radius = RADIUS;
        widget.expansion = 0.0;
    }
    v.widgets.noninteractive.bg_stroke = line(44);
    v.widgets.inactive.bg_stroke = Stroke::NONE;
    v.widgets.hovered.bg_stroke = line(84);
    v
}
