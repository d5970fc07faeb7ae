//! The picture fills the window; the mouse moves the camera in it.

use egui::{
    ColorImage, Event, Mesh, Modifiers, MouseWheelUnit, Painter, PointerButton, Pos2, Rect,
    Response, Role, Sense, TextureHandle, TextureOptions, Ui, Vec2, WidgetInfo, layers::ShapeIdx,
    pos2,
};
use std::sync::Arc;

use super::picking::Projection;
use super::worker::{Frame, FrameStats, RenderWorker};
use crate::scene::{Camera, Scene};

/// Distance that one notch of the wheel leaves over.
const ZOOM_PER_NOTCH: f64 = 0.86;
/// Points of smooth scrolling that count as one notch.
const POINTS_PER_NOTCH: f32 = 50.0;
/// Radians of orbit for a drag over the picture's height.
const ORBIT_PER_HEIGHT: f64 = std::f64::consts::PI;

/// Which picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The document's method.
    A,
    /// What stands beside it.
    B,
}

/// A picture on the graphics card.
#[derive(Default)]
struct Layer {
    texture: Option<TextureHandle>,
    /// Shared with the uploader until the frame is painted.
    shown: Option<Arc<ColorImage>>,
    retired: Vec<Arc<ColorImage>>,
}

impl Layer {
    /// Uploads a picture and hands buffers that are free again back to the worker.
    fn show(
        &mut self,
        ctx: &egui::Context,
        (name, options): (&str, TextureOptions),
        image: ColorImage,
        worker: &RenderWorker,
    ) {
        let image = Arc::new(image);
        match &mut self.texture {
            // A partial update of everything keeps the allocation.
            Some(texture) if texture.size() == image.size => {
                texture.set_partial([0, 0], Arc::clone(&image), options);
            }
            Some(texture) => texture.set(Arc::clone(&image), options),
            None => {
                let texture = ctx.load_texture(name, Arc::clone(&image), options);
                self.texture = Some(texture);
            }
        }
        self.retired.extend(self.shown.replace(image));
        for old in std::mem::take(&mut self.retired) {
            match Arc::try_unwrap(old) {
                Ok(image) => worker.recycle(image.pixels),
                Err(still_uploading) => self.retired.push(still_uploading),
            }
        }
    }
}

/// The framebuffer as the window shows it.
#[derive(Default)]
pub struct Framebuffer {
    first: Layer,
    /// Only while two methods are compared.
    other: Option<Layer>,
    stats: FrameStats,
    frames: u64,
}

impl Framebuffer {
    /// What is known about the shown frame.
    #[must_use]
    pub const fn stats(&self) -> &FrameStats {
        &self.stats
    }

    /// Frames shown so far.
    #[must_use]
    pub const fn frames(&self) -> u64 {
        self.frames
    }

    /// Whether there is a second picture.
    #[must_use]
    pub const fn has_other(&self) -> bool {
        self.other.is_some()
    }

    /// The shown pixels of a side.
    #[must_use]
    pub fn image(&self, side: Side) -> Option<&ColorImage> {
        self.layer(side)?.shown.as_deref()
    }

    const fn layer(&self, side: Side) -> Option<&Layer> {
        match side {
            Side::A => Some(&self.first),
            Side::B => self.other.as_ref(),
        }
    }

    /// Uploads a frame, to be drawn with these options.
    pub fn show(
        &mut self,
        ctx: &egui::Context,
        frame: Frame,
        worker: &RenderWorker,
        options: TextureOptions,
    ) {
        self.first
            .show(ctx, ("framebuffer", options), frame.image, worker);
        match frame.other {
            Some(image) => {
                let other = self.other.get_or_insert_default();
                other.show(ctx, ("second framebuffer", options), image, worker);
            }
            None => self.other = None,
        }
        self.stats = frame.stats;
        self.frames += 1;
    }

    /// Paints a side of the last frame over the rectangle, stretched while the next size is on its way.
    pub fn paint(&self, painter: &Painter, rect: Rect, side: Side) {
        let Some(layer) = self.layer(side) else {
            return;
        };
        if let (Some(texture), Some(image)) = (&layer.texture, &layer.shown) {
            painter.image(texture.id(), rect, self.uv(image), egui::Color32::WHITE);
        }
    }

    /// Paints the first picture over the rectangle, in the place kept for it, but for what is `hidden`: where the
    /// processor draws the window, every pixel counts.
    pub fn paint_in(&self, ui: &Ui, place: ShapeIdx, rect: Rect, hidden: Option<Rect>) {
        if let (Some(texture), Some(image)) = (&self.first.texture, &self.first.shown) {
            let uv = self.uv(image);
            let mut mesh = Mesh::with_texture(texture.id());
            for part in around(rect, hidden.unwrap_or(Rect::NOTHING)) {
                let corner = |at: Pos2| uv.lerp_inside((at - rect.min) / rect.size());
                let part_uv = Rect::from_min_max(corner(part.min), corner(part.max));
                mesh.add_rect_with_uv(part, part_uv, egui::Color32::WHITE);
            }
            ui.painter().set(place, mesh);
        }
    }

    /// What part of the texture covers the rectangle. A texel of a preview belongs on the first pixel of the
    /// `stride` pixels that it stands for, so that nothing jumps when the whole picture follows.
    fn uv(&self, image: &ColorImage) -> Rect {
        let stride = self.stats.stride.max(1) as f32;
        let place = |pixel: u32, texels: usize| {
            ((pixel as f32 - 0.5) / stride + 0.5) / texels.max(1) as f32
        };
        let ([w, h], [columns, rows]) = (self.stats.size, image.size);
        let corner = |x: u32, y: u32| pos2(place(x, columns), place(y, rows));
        Rect::from_min_max(corner(0, 0), corner(w, h))
    }
}

/// Size of the framebuffer for a rectangle in points, within what the graphics card takes.
#[must_use]
pub fn framebuffer_size(ctx: &egui::Context, rect: Rect) -> [u32; 2] {
    let most = ctx.input(|i| i.max_texture_side).max(1) as f32;
    let size = (rect.size() * ctx.pixels_per_point()).round();
    let fit = (most / size.x.max(size.y).max(1.0)).min(1.0);
    [size.x, size.y].map(|n| ((n * fit) as u32).max(1))
}

/// What of a rectangle is outside another one: at most four rectangles.
pub fn around(rect: Rect, hidden: Rect) -> impl Iterator<Item = Rect> {
    let hole = rect.intersect(hidden);
    let parts = if hole.is_positive() {
        let (left, right) = (pos2(rect.min.x, hole.min.y), pos2(hole.max.x, hole.min.y));
        [
            Rect::from_min_max(rect.min, pos2(rect.max.x, hole.min.y)),
            Rect::from_min_max(left, pos2(hole.min.x, hole.max.y)),
            Rect::from_min_max(right, pos2(rect.max.x, hole.max.y)),
            Rect::from_min_max(pos2(rect.min.x, hole.max.y), rect.max),
        ]
    } else {
        [rect, Rect::NOTHING, Rect::NOTHING, Rect::NOTHING]
    };
    parts.into_iter().filter(Rect::is_positive)
}

/// What clicks in the picture asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ViewportClick {
    /// Tell the story of the pixel at this place.
    Probe(egui::Pos2),
}

/// Senses the whole rectangle. Drawn first, so that whatever lies over it goes first.
pub fn sense_ui(ui: &Ui, rect: Rect) -> Response {
    let response = ui.interact(rect, egui::Id::unique("viewport"), Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, "viewport"));
    response
}

/// Orbit, pan, zoom and pivot in the pane that the pointer is over; returns a click that means something else.
pub fn navigate(
    ui: &Ui,
    response: &Response,
    pane: Rect,
    scene: &Scene,
    camera: &mut Camera,
) -> Option<ViewportClick> {
    let modifiers = ui.input(|i| i.modifiers);
    drag(response, pane, modifiers, camera);
    if response.contains_pointer() {
        zoom(ui, response, pane, scene, camera);
    }
    let pos = response.interact_pointer_pos()?;
    if response.double_clicked_by(PointerButton::Primary) {
        if let Some(hit) = Projection::new(camera, pane).pick(scene, pos) {
            set_pivot(camera, hit);
        }
        return None;
    }
    (response.clicked() && modifiers.alt).then_some(ViewportClick::Probe(pos))
}

fn drag(response: &Response, pane: Rect, modifiers: Modifiers, camera: &mut Camera) {
    let delta = response.drag_delta() / pane.height().max(1.0);
    if delta == Vec2::ZERO {
        return;
    }
    let (x, y) = (f64::from(delta.x), f64::from(delta.y));
    let primary = response.dragged_by(PointerButton::Primary);
    if response.dragged_by(PointerButton::Middle)
        || response.dragged_by(PointerButton::Secondary)
        || (primary && modifiers.shift)
    {
        camera.pan(-x, y);
    } else if primary {
        camera.orbit(-x * ORBIT_PER_HEIGHT, y * ORBIT_PER_HEIGHT);
    }
}

/// Takes raw wheel events: egui spreads a notch over ten frames, which would be ten restarts.
fn zoom(ui: &Ui, response: &Response, pane: Rect, scene: &Scene, camera: &mut Camera) {
    let notches: f32 = ui.input(|input| {
        let notches = input.events.iter().map(|event| match event {
            Event::MouseWheel { unit, delta, .. } => match unit {
                MouseWheelUnit::Point => delta.y / POINTS_PER_NOTCH,
                MouseWheelUnit::Line => delta.y,
                MouseWheelUnit::Page => delta.y * 4.0,
            },
            Event::Zoom(factor) => factor.max(0.01).ln() * 4.0,
            _ => 0.0,
        });
        notches.sum()
    });
    let pos = response.hover_pos();
    if let Some(pos) = pos.filter(|_| notches != 0.0 && notches.is_finite()) {
        let fixed = Projection::new(camera, pane).anchor(scene, pos);
        let factor = ZOOM_PER_NOTCH.powf(f64::from(notches.clamp(-20.0, 20.0)));
        camera.zoom_towards(fixed, factor);
    }
}

/// Moves the pivot to a point and the camera sideways with it, so that the view does not turn.
fn set_pivot(camera: &mut Camera, pivot: glam::DVec3) {
    let forward = camera.axes().forward;
    let shift = pivot - camera.target;
    camera.eye += shift - forward * shift.dot(forward);
    camera.target = pivot;
}
