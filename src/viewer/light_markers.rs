//! Lights as markers in the picture, to be dragged.

use egui::{
    Color32, CursorIcon, Painter, Pos2, Rect, Response, Role, Sense, Stroke, Ui, Vec2, WidgetInfo,
    vec2,
};
use glam::{DQuat, DVec3};

use super::picking::Projection;
use super::theme;
use crate::math::srgb8_from_linear;
use crate::scene::Camera;
use crate::shading::{Light, LightKind};

/// Radius of the part that can be grabbed, points.
const GRAB: f32 = 13.0;
/// Radius of the disc, points.
const DISC: f32 = 6.0;
/// Distance of a directional light's marker from the pivot, parts of the picture's shorter side.
const ARROW_PART: f64 = 0.27;
/// Change of distance per point of a drag with Ctrl or Shift.
const DEPTH_PER_POINT: f64 = 0.006;

/// Draws and moves the markers of all lights that have a place or a direction.
pub fn markers_ui(ui: &Ui, rect: Rect, camera: &Camera, lights: &mut [Light]) {
    let projection = Projection::new(camera, rect);
    for (i, light) in lights.iter_mut().enumerate() {
        let place = match light.kind {
            LightKind::Ambient => None,
            LightKind::Point { position, .. } => Some(position),
            LightKind::Directional { direction } => {
                let travel = direction.normalize_or(-camera.up);
                Some(camera.target - travel * arrow_length(&projection, camera, rect))
            }
        };
        let Some((place, pos)) = place.and_then(|p| Some((p, projection.project(p)?))) else {
            continue;
        };
        if !rect.contains(pos) {
            continue;
        }
        let response = sense(ui, pos, i, light);
        if response.drag_started() {
            let near = projection.depth(place) <= projection.depth(camera.target);
            ui.data_mut(|data| data.insert_temp(response.id, near));
        }
        if response.dragged() {
            move_light(&projection, camera, light, &Motion::of(ui, &response, rect));
        }
        draw(ui.painter(), &projection, camera, pos, light, &response);
        response
            .on_hover_cursor(CursorIcon::Grab)
            .on_hover_text(&light.name);
    }
}

fn sense(ui: &Ui, pos: Pos2, i: usize, light: &Light) -> Response {
    let area = Rect::from_center_size(pos, Vec2::splat(2.0 * GRAB));
    let id = egui::Id::unique(("light marker", i));
    let response = ui.interact(area, id, Sense::click_and_drag());
    let name = format!("Marker of {}", light.name);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
    response
}

/// World units between the pivot and a directional light's marker.
fn arrow_length(projection: &Projection, camera: &Camera, rect: Rect) -> f64 {
    projection.units_per_point(camera.distance()) * arrow_points(rect)
}

/// The same in points, as long as the arrow lies across the view.
fn arrow_points(rect: Rect) -> f64 {
    (f64::from(rect.width().min(rect.height())) * ARROW_PART).max(1.0)
}

/// A step of a drag.
struct Motion {
    delta: Vec2,
    /// Along the view instead of across it.
    along: bool,
    /// Radius of the circle that a directional light's marker turns on, points.
    radius: f64,
    /// Whether the drag began on the side of the pivot that faces the eye.
    near_side: bool,
}

impl Motion {
    fn of(ui: &Ui, response: &Response, rect: Rect) -> Self {
        Self {
            delta: response.drag_delta(),
            along: ui.input(|input| input.modifiers.command || input.modifiers.shift),
            radius: arrow_points(rect),
            near_side: ui.data(|data| data.get_temp(response.id)).unwrap_or(true),
        }
    }
}

fn move_light(projection: &Projection, camera: &Camera, light: &mut Light, motion: &Motion) {
    let (dx, dy) = (f64::from(motion.delta.x), f64::from(motion.delta.y));
    let before = light.kind;
    match &mut light.kind {
        LightKind::Ambient => {}
        LightKind::Point { position, .. } if motion.along => {
            let factor = (-dy * DEPTH_PER_POINT).exp();
            *position = camera.eye + (*position - camera.eye) * factor;
        }
        LightKind::Point { position, .. } => {
            let depth = projection.depth(*position);
            if let Some(pos) = projection.project(*position) {
                *position = projection.unproject(pos + motion.delta, depth);
            }
        }
        LightKind::Directional { direction } => {
            let axes = projection.axes();
            // Along the view the marker turns past the rim, which a drag across it cannot reach.
            let side = if motion.near_side { 1.0 } else { -1.0 };
            let (yaw, pitch) = (side * dx / motion.radius, side * dy / motion.radius);
            let turn = if motion.along {
                DQuat::from_axis_angle(axes.right, pitch)
            } else {
                DQuat::from_axis_angle(axes.up, yaw) * DQuat::from_axis_angle(axes.right, pitch)
            };
            *direction = (turn * *direction).normalize_or(DVec3::NEG_Z) * direction.length();
        }
    }
    // So far away that it cannot be dragged any farther.
    let is_somewhere = match light.kind {
        LightKind::Ambient => true,
        LightKind::Point { position, .. } => position.is_finite(),
        LightKind::Directional { direction } => direction.is_finite(),
    };
    if !is_somewhere {
        light.kind = before;
    }
}

fn draw(
    painter: &Painter,
    projection: &Projection,
    camera: &Camera,
    pos: Pos2,
    light: &Light,
    response: &Response,
) {
    let [r, g, b] = srgb8_from_linear(light.color * (1.0 / light.color.max_channel().max(1e-6)));
    let fill = if light.enabled {
        Color32::from_rgb(r, g, b)
    } else {
        Color32::from_gray(70)
    };
    let lit = response.hovered() || response.dragged();
    let rim = if lit {
        theme::ACCENT
    } else {
        Color32::from_black_alpha(200)
    };
    let line = Stroke::new(if lit { 2.2 } else { 1.6 }, fill);
    // A dark line under a light one shows on any picture.
    let under = Stroke::new(line.width + 2.0, Color32::from_black_alpha(130));
    for stroke in [under, line] {
        match (light.kind, projection.project(camera.target)) {
            (LightKind::Directional { .. }, Some(pivot)) => arrow(painter, pos, pivot, stroke),
            _ => rays(painter, pos, stroke),
        }
    }
    painter.circle(pos, DISC, fill, Stroke::new(2.0, rim));
}

fn rays(painter: &Painter, pos: Pos2, stroke: Stroke) {
    for k in 0..8 {
        let direction = Vec2::angled(std::f32::consts::TAU * k as f32 / 8.0);
        let ends = [DISC + 3.0, DISC + 7.0].map(|radius| pos + direction * radius);
        painter.line_segment(ends, stroke);
    }
}

/// From the marker half of the way to the pivot: the way the light travels.
fn arrow(painter: &Painter, from: Pos2, pivot: Pos2, line: Stroke) {
    let way = pivot - from;
    let length = way.length();
    if length < 3.0 * DISC {
        return;
    }
    let unit = way / length;
    let start = from + unit * (DISC + 3.0);
    let tip = from + way * 0.55;
    painter.line_segment([start, tip], line);
    let across = vec2(-unit.y, unit.x) * 4.0;
    for side in [1.0, -1.0] {
        painter.line_segment([tip, tip - unit * 8.0 + across * side], line);
    }
}
