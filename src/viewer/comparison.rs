//! Two methods in one view: what is compared, and how it is laid out.

use egui::{Rect, Vec2};

use super::worker::{Compare, ErrorView};
use crate::measure::error_map::ErrorMetric;
use crate::surface::mapping::Method;

/// What the other method is at first: the relief as real geometry.
pub const TRUTH: Method = Method::Displacement;
/// Points between the pictures side by side.
const GAP: f32 = 2.0;

/// How the pictures A and B share the window.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Layout {
    /// A left of a line, B right of it; the line can be dragged.
    #[default]
    Wipe,
    /// A and B in halves of their own, by the same camera.
    SideBySide,
    /// A, and B as long as a key is held.
    Hold,
}

impl Layout {
    /// Every layout.
    pub const ALL: [Self; 3] = [Self::Wipe, Self::SideBySide, Self::Hold];

    /// As the list shows it.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Wipe => "wipe",
            Self::SideBySide => "side by side",
            Self::Hold => "hold B",
        }
    }
}

/// The comparison of a document. A is the document's own method. It is not part of the scene file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comparison {
    /// Render and show B.
    pub on: bool,
    /// Method of B.
    pub method: Method,
    /// Where A and B stand.
    pub layout: Layout,
    /// Place of the wipe's line, parts of the picture's width from the left.
    pub split: f32,
    /// Show in place of B how far it is from A.
    pub error: Option<ErrorMetric>,
    /// Error that gets the brightest colour, above 0.
    pub full_scale: f32,
}

/// A method's name in the list of second methods.
#[must_use]
pub const fn second_name(method: Method) -> &'static str {
    match method {
        TRUTH => "displacement (the truth)",
        other => other.name(),
    }
}

/// What the picture by a second method is called.
#[must_use]
pub const fn second_label(method: Method) -> &'static str {
    match method {
        TRUTH => "Displacement, the truth",
        other => other.info().label,
    }
}

impl Default for Comparison {
    fn default() -> Self {
        Self {
            on: false,
            method: TRUTH,
            layout: Layout::default(),
            split: 0.5,
            error: None,
            full_scale: ErrorMetric::default().usual_full_scale(),
        }
    }
}

impl Comparison {
    /// What the worker needs to know; nothing while the comparison is off.
    #[must_use]
    pub fn request(&self) -> Option<Compare> {
        let error = self.error.map(|metric| ErrorView {
            metric,
            full_scale: self.full_scale,
        });
        self.on.then_some(Compare {
            method: self.method,
            error,
        })
    }

    /// Turns it on or off beside the document's method. A method against itself says nothing: B is another then.
    pub fn turn(&mut self, on: bool, a: Method) {
        self.on = on;
        if on && self.method == a {
            self.method = if a == TRUTH { Method::default() } else { TRUTH };
        }
    }

    /// Chooses what is shown in place of B, on a scale that suits it.
    pub fn show_error(&mut self, error: Option<ErrorMetric>) {
        if let Some(metric) = error.filter(|_| error != self.error) {
            self.full_scale = metric.usual_full_scale();
        }
        self.error = error;
    }

    /// Error on, and with it the comparison; or back to picture B.
    pub fn toggle_error(&mut self, a: Method) {
        let shown = self.on && self.error.is_some();
        self.show_error((!shown).then(|| self.error.unwrap_or_default()));
        self.turn(true, a);
    }

    /// Whether A and B stand side by side.
    #[must_use]
    pub fn is_side_by_side(&self) -> bool {
        self.on && self.layout == Layout::SideBySide
    }

    /// Where A and B are drawn. Both fill the window, but side by side they share its `free` part, each with as many
    /// pixels as it shows.
    #[must_use]
    pub fn panes(&self, window: Rect, free: Rect) -> [Rect; 2] {
        if !self.is_side_by_side() {
            return [window; 2];
        }
        let size = Vec2::new(((free.width() - GAP) * 0.5).max(1.0), free.height());
        let left = Rect::from_min_size(free.min, size);
        [left, left.translate(Vec2::new(size.x + GAP, 0.0))]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    #[test]
    fn nothing_is_asked_for_while_off() {
        let mut comparison = Comparison::default();
        assert_eq!(comparison.request(), None);
        comparison.toggle_error(Method::Bump);
        let error = comparison.request().and_then(|compare| compare.error);
        assert_eq!(error.map(|e| e.metric), Some(ErrorMetric::Luma));
        comparison.toggle_error(Method::Bump);
        assert!(comparison.on && comparison.error.is_none());
    }

    #[test]
    fn turned_on_it_compares_two_methods() {
        for a in Method::ALL {
            let mut comparison = Comparison::default();
            comparison.turn(true, a);
            assert!(comparison.on && comparison.method != a);
            // What was chosen stays.
            comparison.turn(false, comparison.method);
            let b = comparison.method;
            comparison.turn(true, a);
            assert_eq!(comparison.method, b);
        }
    }

    #[test]
    fn halves_are_of_one_size_and_do_not_overlap() {
        let window = Rect::from_min_max(pos2(0.0, 0.0), pos2(1280.0, 720.0));
        let free = Rect::from_min_max(pos2(0.0, 0.0), pos2(930.0, 690.0));
        let mut comparison = Comparison {
            on: true,
            ..Comparison::default()
        };
        assert_eq!(comparison.panes(window, free), [window; 2]);
        comparison.layout = Layout::SideBySide;
        let [a, b] = comparison.panes(window, free);
        assert_eq!((a.size(), b.max), (b.size(), free.max));
        assert!(a.right() < b.left());
    }
}
