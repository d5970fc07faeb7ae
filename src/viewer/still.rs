//! A panel that stands still is drawn as a picture of itself.
//!
//! Where the processor draws the window, the panel's hundreds of letters and boxes cost as much in every frame as
//! the picture beside it. So once they have been the same for some frames of a movement, the window's pixels are
//! read back, and the panel's part of them is drawn instead, until a shape differs. Not a pixel changes.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use egui::epaint::ClippedShape;
use egui::layers::ShapeIdx;
use egui::{
    Color32, ColorImage, Context, LayerId, Order, Pos2, Rect, Shape, TextureHandle, TextureId,
    TextureOptions, Vec2, pos2,
};

use super::viewport::around;

/// Frames that must draw the same before the pixels are asked for: reading them takes some milliseconds.
const PATIENCE: u32 = 3;

/// A layer whose shapes are replaced while they do not change.
#[derive(Default)]
pub struct Still {
    last: Drawn,
    /// Frames before the last that drew just the same.
    alike: u32,
    asked: Option<Receiver<Arc<ColorImage>>>,
    held: Option<(Drawn, TextureHandle)>,
}

/// What a frame drew in the layer.
#[derive(Default)]
struct Drawn {
    shapes: Vec<ClippedShape>,
    place: Place,
    /// Something else lies over it, or it may change without its shapes.
    unfit: bool,
}

/// Where the layer is.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
struct Place {
    /// Where it is opaque, in pixels of the window: the first column and row, and those after the last.
    inner: [[usize; 2]; 2],
    /// Columns and rows of the window.
    window: [usize; 2],
    pixels_per_point: f32,
}

impl Drawn {
    fn of(ctx: &Context, layer: LayerId, hidden: Rect) -> Self {
        let pixels_per_point = ctx.pixels_per_point();
        let screen = ctx.viewport_rect();
        let pixels = |pos: Pos2| [pos.x, pos.y].map(|v| (v * pixels_per_point).round() as usize);
        let inner = hidden.intersect(screen);
        let others: Vec<LayerId> = ctx.memory(|memory| memory.layer_ids().collect());
        ctx.graphics(|graphics| {
            let shapes: Vec<ClippedShape> = graphics
                .get(layer)
                .map(|list| list.all_entries().cloned().collect())
                .unwrap_or_default();
            let over = others
                .iter()
                .filter(|other| **other != layer && other.order != Order::Background)
                .filter_map(|other| graphics.get(*other))
                .flat_map(|list| list.all_entries());
            let is_covered = over.into_iter().any(|entry| touches(entry, inner));
            Self {
                unfit: is_covered
                    || !inner.is_positive()
                    || !shapes
                        .iter()
                        .all(|entry| is_told_by_its_shape(&entry.shape)),
                shapes,
                place: Place {
                    inner: [pixels(inner.min), pixels(inner.max)],
                    window: pixels(screen.max),
                    pixels_per_point,
                },
            }
        })
    }

    /// The opaque part, points.
    fn rect(&self) -> Rect {
        let Place {
            inner: [min, max],
            pixels_per_point,
            ..
        } = self.place;
        let points = |[x, y]: [usize; 2]| pos2(x as f32, y as f32) / pixels_per_point;
        Rect::from_min_max(points(min), points(max))
    }

    fn is_like(&self, other: &Self) -> bool {
        self.place == other.place && self.shapes == other.shapes
    }

    /// The opaque part of the window's pixels; none if they are of another window than this was drawn in.
    fn cut(&self, pixels: &ColorImage) -> Option<ColorImage> {
        let [[left, top], [right, bottom]] = self.place.inner;
        if self.unfit || pixels.size != self.place.window {
            return None;
        }
        let row = |y: usize| &pixels.pixels[y * pixels.size[0]..][left..right];
        // Windows may have transparent pixels, which the panel's are not.
        let opaque = (top..bottom)
            .flat_map(row)
            .map(|c| Color32::from_rgb(c.r(), c.g(), c.b()));
        Some(ColorImage::new(
            [right - left, bottom - top],
            opaque.collect(),
        ))
    }
}

impl Still {
    /// Called once everything of a frame is painted, with the layer and what of the window it hides wholly:
    /// replaces the layer's shapes there if their pixels are known, and may ask for them while `is_moving`.
    pub fn settle(&mut self, ctx: &Context, layer: LayerId, hidden: Rect, is_moving: bool) {
        self.take_pixels(ctx);
        let drawn = Drawn::of(ctx, layer, hidden);
        match &self.held {
            Some((held, texture)) if self.asked.is_none() && held.is_like(&drawn) => {
                replace(ctx, layer, held, texture.id());
            }
            _ => {
                self.alike = if self.last.is_like(&drawn) {
                    self.alike + 1
                } else {
                    0
                };
                if is_moving && self.alike >= PATIENCE && !drawn.unfit && self.asked.is_none() {
                    let (sender, receiver) = channel();
                    // Nobody waits for it any more if the window closes.
                    ctx.request_screenshot(move |pixels| drop(sender.send(pixels)));
                    self.asked = Some(receiver);
                }
            }
        }
        self.last = drawn;
    }

    /// The pixels are those of the last frame, since each frame looks.
    fn take_pixels(&mut self, ctx: &Context) {
        let Some(asked) = &self.asked else { return };
        match asked.try_recv() {
            Ok(pixels) => {
                if let Some(image) = self.last.cut(&pixels) {
                    let texture = ctx.load_texture("still panel", image, TextureOptions::NEAREST);
                    self.held = Some((std::mem::take(&mut self.last), texture));
                }
                self.asked = None;
            }
            Err(TryRecvError::Disconnected) => self.asked = None,
            Err(TryRecvError::Empty) => {}
        }
    }
}

/// Puts a texture in the place of a layer's shapes, which stay at its edge.
fn replace(ctx: &Context, layer: LayerId, held: &Drawn, texture: TextureId) {
    let inner = held.rect();
    let uv = Rect::from_min_size(Pos2::ZERO, Vec2::splat(1.0));
    ctx.graphics_mut(|graphics| {
        let Some(list) = graphics.get_mut(layer) else {
            return;
        };
        for index in 0..list.next_idx().0 {
            list.reset_shape(ShapeIdx(index));
        }
        list.add(inner, Shape::image(texture, inner, uv, Color32::WHITE));
        for edge in around(Rect::EVERYTHING, inner) {
            for entry in held.shapes.iter().filter(|entry| touches(entry, edge)) {
                list.add(entry.clip_rect.intersect(edge), entry.shape.clone());
            }
        }
    });
}

fn touches(entry: &ClippedShape, rect: Rect) -> bool {
    let visible = entry.clip_rect.intersect(rect);
    visible.is_positive()
        && entry
            .shape
            .visual_bounding_rect()
            .expand(1.0)
            .intersects(visible)
}

/// Whether the same shape always looks the same: pictures may change behind their names.
fn is_told_by_its_shape(shape: &Shape) -> bool {
    match shape {
        Shape::Vec(shapes) => shapes.iter().all(is_told_by_its_shape),
        Shape::Callback(_) => false,
        shape => shape.texture_id() == TextureId::default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::epaint::image::ImageData;
    use egui::{Area, FullOutput, Id, RawInput, ScreenshotCallback, ViewportCommand, ViewportId};

    const WINDOW: Vec2 = Vec2::new(400.0, 300.0);

    /// A window with a panel, and perhaps something over it.
    struct Window {
        ctx: Context,
        still: Still,
        pixels_per_point: f32,
    }

    impl Window {
        fn new(pixels_per_point: f32) -> Self {
            let (ctx, still) = Default::default();
            Self {
                ctx,
                still,
                pixels_per_point,
            }
        }

        fn frame(&mut self, text: &str, is_covered: bool, is_moving: bool) -> FullOutput {
            let mut input = RawInput {
                screen_rect: Some(Rect::from_min_size(Pos2::ZERO, WINDOW)),
                ..RawInput::default()
            };
            let viewport = input.viewports.entry(ViewportId::ROOT).or_default();
            viewport.native_pixels_per_point = Some(self.pixels_per_point);
            let still = &mut self.still;
            self.ctx.run_ui(input, |ui| {
                let ctx = ui.ctx();
                let panel = Area::new(Id::unique("panel"))
                    .fixed_pos(pos2(251.0, 11.0))
                    .order(Order::Middle)
                    .show(ctx, |ui| {
                        egui::Frame::new()
                            .fill(Color32::DARK_BLUE)
                            .inner_margin(12)
                            .corner_radius(6)
                            .show(ui, |ui| {
                                ui.set_width(100.0);
                                ui.label(text);
                            });
                    });
                if is_covered {
                    Area::new(Id::unique("message"))
                        .fixed_pos(pos2(260.0, 20.0))
                        .order(Order::Foreground)
                        .show(ctx, |ui| ui.label("over it"));
                }
                let hidden = panel.response.rect.shrink(8.0);
                still.settle(ctx, panel.response.layer_id, hidden, is_moving);
            })
        }

        /// Puts something over the panel; the frame in which it is new only measures it.
        fn cover(&mut self, text: &str) {
            for _ in 0..2 {
                self.frame(text, true, false);
            }
        }

        /// Frames until the pixels are asked for.
        fn ask(&mut self) -> Option<ScreenshotCallback> {
            (0..20).find_map(|_| asked(&self.frame("still", false, true)))
        }

        /// Every pixel tells where it is.
        fn pixels(&self) -> Arc<ColorImage> {
            let size = (WINDOW * self.pixels_per_point).round();
            let (columns, rows) = (size.x as usize, size.y as usize);
            let pixels = (0..rows)
                .flat_map(|y| (0..columns).map(move |x| place_color([x, y])))
                .collect();
            Arc::new(ColorImage::new([columns, rows], pixels))
        }
    }

    fn place_color([x, y]: [usize; 2]) -> Color32 {
        Color32::from_rgb(
            (x % 256) as u8,
            (y % 256) as u8,
            (x / 256 + 16 * (y / 256)) as u8,
        )
    }

    fn asked(output: &FullOutput) -> Option<ScreenshotCallback> {
        let commands = &output.viewport_output[&ViewportId::ROOT].commands;
        commands.iter().find_map(|command| match command {
            ViewportCommand::Screenshot(callback) => Some(callback.clone()),
            _ => None,
        })
    }

    /// The texts of a frame, and the rectangle that a picture is drawn over.
    fn drawn(output: &FullOutput) -> (Vec<String>, Option<Rect>) {
        let texts = output.shapes.iter().filter_map(|entry| match &entry.shape {
            Shape::Text(text) => Some(text.galley.text().to_owned()),
            _ => None,
        });
        let pictures = output.shapes.iter().filter_map(|entry| match &entry.shape {
            Shape::Mesh(mesh) if mesh.texture_id != TextureId::default() => {
                Some(mesh.calc_bounds())
            }
            _ => None,
        });
        let pictures: Vec<Rect> = pictures.collect();
        assert!(pictures.len() <= 1);
        (texts.collect(), pictures.first().copied())
    }

    #[test]
    fn a_still_panel_becomes_the_picture_of_itself() {
        for pixels_per_point in [1.0, 1.25, 2.0] {
            let mut window = Window::new(pixels_per_point);
            let callback = window.ask().expect("its pixels are asked for");
            let output = window.frame("still", false, true);
            assert!(asked(&output).is_none(), "asked for twice");
            assert_eq!(drawn(&output), (vec!["still".to_owned()], None));
            callback.complete(window.pixels());

            let output = window.frame("still", false, true);
            let (texts, picture) = drawn(&output);
            let rect = picture.expect("its picture is drawn");
            assert!(texts.is_empty(), "{texts:?}");
            // Each texel on the pixel that it was.
            let [left, top] = [rect.min.x, rect.min.y].map(|v| v * pixels_per_point);
            assert!((left - left.round()).abs() < 1e-3 && (top - top.round()).abs() < 1e-3);
            let [left, top] = [left, top].map(|v| v.round() as usize);
            let mut deltas = output.textures_delta.set.values().flatten();
            let ImageData::Color(image) = &deltas.next().expect("a new texture").image;
            let size = rect.size() * pixels_per_point;
            assert_eq!(image.size, [size.x, size.y].map(|v| v.round() as usize));
            for [x, y] in [[0, 0], [image.size[0] - 1, 0], [5, image.size[1] - 1]] {
                let color = image.pixels[y * image.size[0] + x];
                assert_eq!(color, place_color([left + x, top + y]));
            }
            // Its round corners are drawn as before.
            let frames = |output: &FullOutput| {
                let is_frame = |s: &ClippedShape| matches!(s.shape, Shape::Rect(_));
                output.shapes.iter().filter(|s| is_frame(s)).count()
            };
            assert_eq!(frames(&output), 4);

            let output = window.frame("changed", false, true);
            assert_eq!(drawn(&output), (vec!["changed".to_owned()], None));
            assert_eq!(frames(&output), 1);
            window.cover("still");
            let output = window.frame("still", true, false);
            let (texts, picture) = drawn(&output);
            assert_eq!(texts, ["over it"], "what lies over it is drawn");
            assert!(picture.is_some(), "the same again");
        }
    }

    #[test]
    fn nothing_is_asked_for_at_rest() {
        let mut window = Window::new(1.0);
        let rest = (0..20).find_map(|_| asked(&window.frame("still", false, false)));
        assert!(rest.is_none());
        let mut texts = (0..20).map(|i| i.to_string());
        let changing = texts.find_map(|text| asked(&window.frame(&text, false, true)));
        assert!(changing.is_none(), "it changes");
        let covered = (0..20).find_map(|_| asked(&window.frame("still", true, true)));
        assert!(covered.is_none(), "something lies over it");
    }

    #[test]
    fn pixels_of_another_frame_or_window_are_not_taken() {
        // What was painted when the pixels were read is what they show.
        let mut window = Window::new(1.0);
        let callback = window.ask().expect("asked");
        window.frame("changed", false, true);
        callback.complete(window.pixels());
        let output = window.frame("still", false, true);
        assert_eq!(drawn(&output), (vec!["still".to_owned()], None));
        assert!(drawn(&window.frame("changed", false, true)).1.is_some());

        let mut window = Window::new(1.0);
        let callback = window.ask().expect("asked");
        window.cover("still");
        callback.complete(window.pixels());
        assert_eq!(
            drawn(&window.frame("still", false, true)).1,
            None,
            "covered"
        );

        let mut window = Window::new(1.0);
        let callback = window.ask().expect("asked");
        window.frame("still", false, true);
        callback.complete(Window::new(1.5).pixels());
        assert_eq!(
            drawn(&window.frame("still", false, true)).1,
            None,
            "resized"
        );

        // A window that closes or is hidden answers nobody; then it is asked again.
        let mut window = Window::new(1.0);
        drop(window.ask().expect("asked"));
        assert!(window.ask().is_some());
    }
}
