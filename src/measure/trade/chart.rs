//! Charts as drawings: axes, points, lines, names.

use crate::measure::drawing::{Anchor, Drawing, Shape};

/// Points of paper around the axes: left, top, right, bottom.
const MARGINS: [f32; 4] = [58.0, 30.0, 16.0, 40.0];
/// Colours of the paper's furniture.
const INK: [u8; 3] = [40, 44, 52];
const FAINT: [u8; 3] = [222, 225, 230];
/// Size of the words, points.
const SMALL: f32 = 10.5;

/// How numbers lie along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// By their logarithm; numbers at 0 lie at the lower end.
    Log,
}

/// One axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Quantity and unit.
    pub name: String,
    /// Evenly or by logarithm.
    pub scale: Scale,
    /// On logarithmic axes: what is smaller lies here.
    pub least: f64,
}

/// Points of one colour.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// For the legend; empty for none.
    pub name: String,
    /// Colour.
    pub color: [u8; 3],
    /// Places, and what is written beside each; empty for nothing.
    pub points: Vec<([f64; 2], String)>,
    /// Whether the points are joined.
    pub joined: bool,
    /// Whether they are dots.
    pub dotted: bool,
    /// Whether the line is broken into dashes.
    pub dashed: bool,
}

/// A chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// Over the axes.
    pub title: String,
    /// To the right.
    pub x: Axis,
    /// Upwards.
    pub y: Axis,
    /// What is drawn, the first at the bottom.
    pub series: Vec<Series>,
}

/// An axis laid out along the paper.
struct Ruler {
    scale: Scale,
    least: f64,
    /// Ends, logarithms on logarithmic axes.
    range: [f64; 2],
    /// Their places on the paper.
    place: [f32; 2],
}

impl Ruler {
    fn new(axis: &Axis, values: impl Iterator<Item = f64>, place: [f32; 2]) -> Self {
        let mut ruler = Self {
            scale: axis.scale,
            least: axis.least,
            range: [f64::INFINITY, f64::NEG_INFINITY],
            place,
        };
        for value in values.filter(|v| v.is_finite()) {
            let value = ruler.along(value);
            ruler.range = [ruler.range[0].min(value), ruler.range[1].max(value)];
        }
        let [low, high] = ruler.range;
        ruler.range = match axis.scale {
            _ if low > high => [0.0, 1.0],
            // What is smaller than the least lies on the axis itself.
            Scale::Log => {
                let least = axis.least.log10().round();
                let low = (low - 0.05).floor().max(least);
                [low, (high + 0.05).ceil().max(low + 1.0)]
            }
            Scale::Linear => [
                low.min(0.0),
                if high > low.min(0.0) { high } else { low + 1.0 },
            ],
        };
        ruler
    }

    fn along(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => value,
            Scale::Log => value.max(self.least).log10(),
        }
    }

    fn at(&self, value: f64) -> f32 {
        let [low, high] = self.range;
        let part = ((self.along(value) - low) / (high - low)).clamp(0.0, 1.0);
        self.place[0] + (self.place[1] - self.place[0]) * part as f32
    }

    /// What is written at a tick.
    fn label(&self, tick: f64) -> String {
        let sign = match self.scale {
            Scale::Log if tick < self.least * 1.5 => "≤ ",
            _ => "",
        };
        format!("{sign}{}", short(tick))
    }

    /// Numbers to write along the axis.
    fn ticks(&self) -> Vec<f64> {
        let [low, high] = self.range;
        match self.scale {
            Scale::Log => (low as i32..=high as i32)
                .map(|e| 10.0_f64.powi(e))
                .collect(),
            Scale::Linear => {
                let step = nice_step((high - low) / 6.0);
                let count = ((high - low) / step + 1e-9).floor() as i32;
                let first = (low / step).ceil() * step;
                (0..=count).map(|i| first + f64::from(i) * step).collect()
            }
        }
    }
}

/// 1, 2 or 5 times a power of ten, or 15 for angles; not below `least`.
fn nice_step(least: f64) -> f64 {
    if (10.0..=15.0).contains(&least) {
        return 15.0;
    }
    let power = 10.0_f64.powf(least.max(1e-12).log10().floor());
    let nice = [1.0, 2.0, 5.0, 10.0].map(|m| m * power);
    nice.into_iter()
        .find(|&s| s >= least * 0.999)
        .unwrap_or(least)
}

/// A number in few characters.
#[must_use]
pub fn short(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        "0".to_owned()
    } else if !(9.995e-4..9.995e4).contains(&size) {
        format!("{value:.0e}")
    } else if size >= 99.95 {
        format!("{value:.0}")
    } else if size >= 9.995 {
        trimmed(format!("{value:.1}"))
    } else if size >= 0.9995 {
        trimmed(format!("{value:.2}"))
    } else {
        trimmed(format!("{value:.3}"))
    }
}

fn trimmed(text: String) -> String {
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

impl Chart {
    /// Laid out on paper of this size, with a legend to the right where series have names.
    #[must_use]
    pub fn drawing(&self, size: [f32; 2]) -> Drawing {
        let named = self.series.iter().any(|s| !s.name.is_empty());
        let legend = if named { 128.0 } else { 0.0 };
        let [left, top, right, bottom] = MARGINS;
        let (x_end, y_end) = (size[0] - right - legend, size[1] - bottom);
        let places = || {
            self.series
                .iter()
                .flat_map(|s| s.points.iter().map(|(p, _)| *p))
        };
        let x = Ruler::new(&self.x, places().map(|p| p[0]), [left, x_end]);
        let y = Ruler::new(&self.y, places().map(|p| p[1]), [y_end, top]);
        let mut shapes = vec![words(
            [left, top - 11.0],
            13.0,
            INK,
            Anchor::Start,
            &self.title,
        )];
        grid(&mut shapes, &x, &y);
        let below = size[1] - 6.0;
        shapes.push(words([x_end, below], SMALL, INK, Anchor::End, &self.x.name));
        shapes.push(words(
            [left, below],
            SMALL,
            INK,
            Anchor::Start,
            &format!("↑ {}", self.y.name),
        ));
        for series in &self.series {
            draw_series(&mut shapes, series, &x, &y);
        }
        labels(&mut shapes, &self.series, &x, &y);
        let names = self.series.iter().filter(|s| !s.name.is_empty());
        for (i, series) in names.enumerate() {
            let at = [x_end + 14.0, top + 8.0 + 16.0 * i as f32];
            shapes.push(Shape::Dot {
                at: [at[0], at[1] - 3.5],
                radius: 4.0,
                color: series.color,
            });
            shapes.push(words(
                [at[0] + 9.0, at[1]],
                SMALL,
                INK,
                Anchor::Start,
                &series.name,
            ));
        }
        Drawing {
            size,
            paper: [255; 3],
            shapes,
        }
    }
}

fn grid(shapes: &mut Vec<Shape>, x: &Ruler, y: &Ruler) {
    let line = |points, color| Shape::Line {
        points,
        width: 1.0,
        color,
        dashed: false,
    };
    for tick in x.ticks() {
        let (at, label) = (x.at(tick), x.label(tick));
        shapes.push(line(vec![[at, y.place[0]], [at, y.place[1]]], FAINT));
        shapes.push(words(
            [at, y.place[0] + 14.0],
            SMALL,
            INK,
            Anchor::Middle,
            &label,
        ));
    }
    for tick in y.ticks() {
        let (at, label) = (y.at(tick), y.label(tick));
        shapes.push(line(vec![[x.place[0], at], [x.place[1], at]], FAINT));
        shapes.push(words(
            [x.place[0] - 5.0, at + 3.5],
            SMALL,
            INK,
            Anchor::End,
            &label,
        ));
    }
    let corner = vec![
        [x.place[0], y.place[1]],
        [x.place[0], y.place[0]],
        [x.place[1], y.place[0]],
    ];
    shapes.push(line(corner, INK));
}

fn draw_series(shapes: &mut Vec<Shape>, series: &Series, x: &Ruler, y: &Ruler) {
    let place = |[a, b]: [f64; 2]| [x.at(a), y.at(b)];
    let finite = series
        .points
        .iter()
        .filter(|(p, _)| p.iter().all(|c| c.is_finite()));
    if series.joined {
        shapes.push(Shape::Line {
            points: finite.clone().map(|(p, _)| place(*p)).collect(),
            width: 1.6,
            color: series.color,
            dashed: series.dashed,
        });
    }
    for (point, _) in finite {
        let at = place(*point);
        if series.dotted {
            shapes.push(Shape::Dot {
                at,
                radius: 3.4,
                color: series.color,
            });
        }
    }
}

/// Size of what is written beside points.
const LABEL: f32 = 9.5;

/// Writes beside the points what has room: no label over another, nor over a point, nor off the paper.
fn labels(shapes: &mut Vec<Shape>, series: &[Series], x: &Ruler, y: &Ruler) {
    let points = || {
        series
            .iter()
            .flat_map(|s| s.points.iter().map(move |p| (s, p)))
    };
    let place = |[a, b]: [f64; 2]| [x.at(a), y.at(b)];
    let is_finite = |p: &[f64; 2]| p.iter().all(|c| c.is_finite());
    let dots = points().filter(|(s, (p, _))| s.dotted && is_finite(p));
    let mut taken: Vec<[f32; 4]> = dots
        .map(|(_, (p, _))| {
            let [a, b] = place(*p);
            [a - 3.0, b - 3.0, a + 3.0, b + 3.0]
        })
        .collect();
    for (series, (point, label)) in points() {
        if label.is_empty() || !is_finite(point) {
            continue;
        }
        let at = place(*point);
        // Letters are about half as wide as high.
        let width = 0.52 * LABEL * label.chars().count() as f32;
        let rows = [-4.0, 11.0, -15.0, 22.0, -26.0, 33.0];
        let places = rows
            .into_iter()
            .flat_map(|dy| [6.0, -6.0 - width].map(|dx| [dx, dy]));
        let mut boxes = places.map(|[dx, dy]| {
            let [left, base] = [at[0] + dx, at[1] + dy];
            [left, base - 0.8 * LABEL, left + width, base + 0.2 * LABEL]
        });
        let fits = |[left, top, right, bottom]: &[f32; 4]| {
            let is_inside = *left >= x.place[0]
                && *right <= x.place[1] + 10.0
                && *top >= y.place[1] - 10.0
                && *bottom <= y.place[0];
            let is_free = |[l, t, r, b]: &[f32; 4]| right < l || left > r || bottom < t || top > b;
            is_inside && taken.iter().all(is_free)
        };
        if let Some(free) = boxes.find(fits) {
            let base = [free[0], free[3] - 0.2 * LABEL];
            shapes.push(words(base, LABEL, series.color, Anchor::Start, label));
            taken.push(free);
        }
    }
}

fn words(at: [f32; 2], size: f32, color: [u8; 3], anchor: Anchor, text: &str) -> Shape {
    Shape::Text {
        at,
        anchor,
        size,
        color,
        text: text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(scale: Scale) -> Axis {
        Axis {
            name: "n".to_owned(),
            scale,
            least: 1e-3,
        }
    }

    #[test]
    fn numbers_are_short() {
        let texts = [0.0, 0.05, 1.0, 2.345, 45.25, 123.4, 1.5e6, 1e-5].map(short);
        assert_eq!(
            texts,
            ["0", "0.05", "1", "2.35", "45.2", "123", "2e6", "1e-5"]
        );
    }

    #[test]
    fn logarithms_take_the_ends_to_powers_of_ten() {
        let ruler = Ruler::new(&axis(Scale::Log), [0.02, 3.0].into_iter(), [0.0, 90.0]);
        assert_eq!(ruler.ticks().len(), 4);
        assert!((ruler.at(0.01) - 0.0).abs() < 1e-4 && (ruler.at(10.0) - 90.0).abs() < 1e-4);
        assert!((ruler.at(0.1) - 30.0).abs() < 1e-4);
        assert_eq!(ruler.at(0.0), 0.0, "zero lies at the end");
    }

    #[test]
    fn what_is_too_small_lies_on_the_axis() {
        let ruler = Ruler::new(&axis(Scale::Log), [1e-9, 0.02].into_iter(), [0.0, 90.0]);
        let ticks = ruler.ticks();
        assert_eq!(ticks.len(), 3, "{ticks:?}");
        assert_eq!(ruler.label(ticks[0]), "≤ 0.001");
        assert_eq!(ruler.label(ticks[1]), "0.01");
        assert_eq!(ruler.at(1e-9), 0.0);
    }

    #[test]
    fn labels_that_would_cover_one_another_move_or_go() {
        let crowd = (0..20).map(|i| ([1.0 + 1e-6 * f64::from(i), 1.0], format!("method {i}")));
        let chart = Chart {
            title: String::new(),
            x: axis(Scale::Log),
            y: axis(Scale::Log),
            series: vec![Series {
                name: String::new(),
                color: [0; 3],
                points: crowd.collect(),
                joined: false,
                dotted: true,
                dashed: false,
            }],
        };
        let shapes = chart.drawing([400.0, 300.0]).shapes;
        let mut places: Vec<[f32; 2]> = Vec::new();
        for shape in &shapes {
            if let Shape::Text { at, text, .. } = shape
                && text.starts_with("method")
            {
                let is_clear =
                    |p: &[f32; 2]| (p[1] - at[1]).abs() > LABEL || (p[0] - at[0]).abs() > 40.0;
                assert!(places.iter().all(is_clear), "{text}");
                places.push(*at);
            }
        }
        assert!((2..20).contains(&places.len()), "{}", places.len());
    }

    #[test]
    fn angles_are_ticked_by_fifteen() {
        let ruler = Ruler::new(&axis(Scale::Linear), [0.0, 89.0].into_iter(), [0.0, 89.0]);
        assert_eq!(ruler.ticks(), [0.0, 15.0, 30.0, 45.0, 60.0, 75.0]);
        assert_eq!(ruler.at(45.0), 45.0);
    }

    #[test]
    fn nothing_to_draw_is_drawn() {
        let chart = Chart {
            title: "t".to_owned(),
            x: axis(Scale::Log),
            y: axis(Scale::Linear),
            series: Vec::new(),
        };
        assert!(chart.drawing([300.0, 200.0]).to_svg().contains(">t</text>"));
    }
}
