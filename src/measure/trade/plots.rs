//! What a record says, as charts.

use super::chart::{Axis, Chart, Scale, Series};
use super::{Cell, Record};
use crate::measure::drawing::Drawing;
use crate::surface::mapping::Method;

/// Points of paper of a chart.
const PAPER: [f32; 2] = [620.0, 360.0];
/// Colour of what belongs to no method.
const FRONT: [u8; 3] = [120, 126, 138];

/// Which error a chart shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlotMetric {
    /// 95th percentile of the texture coordinate's error, texels.
    Texels,
    /// 95th percentile of the normal's error, degrees.
    Normal,
    /// Mean FLIP of the picture.
    Flip,
}

impl PlotMetric {
    /// Every metric.
    pub const ALL: [Self; 3] = [Self::Texels, Self::Normal, Self::Flip];

    /// The error of a cell.
    #[must_use]
    pub const fn of(self, cell: &Cell) -> f64 {
        match self {
            Self::Texels => cell.geometry.uv_texels.p95,
            Self::Normal => cell.geometry.normal_deg.p95,
            Self::Flip => cell.picture.flip,
        }
    }

    /// For axes.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Texels => "uv error, p95, texels",
            Self::Normal => "normal error, p95, degrees",
            Self::Flip => "mean FLIP",
        }
    }

    /// For titles.
    const fn title(self) -> &'static str {
        match self {
            Self::Texels => "Error of uv",
            Self::Normal => "Error of the normal",
            Self::Flip => "FLIP",
        }
    }

    /// What is smaller is drawn at this place.
    #[must_use]
    pub const fn least(self) -> f64 {
        match self {
            Self::Texels | Self::Normal => 1e-2,
            Self::Flip => 1e-3,
        }
    }

    fn axis(self) -> Axis {
        Axis {
            name: self.name().to_owned(),
            scale: Scale::Log,
            least: self.least(),
        }
    }
}

/// Error against cost of every variant in the view nearest to an angle, with the front of those that no other beats
/// in both.
#[must_use]
pub fn error_by_cost(record: &Record, angle_deg: f64, metric: PlotMetric) -> Drawing {
    let cells = usual_cells(record);
    let Some(angle) = nearest_angle(&cells, angle_deg) else {
        return empty("error against cost");
    };
    let cells: Vec<_> = cells.into_iter().filter(|c| c.angle_deg == angle).collect();
    let place = |c: &Cell| [c.cost.ns_per_sample.median, metric.of(c)];
    let front = front(&cells.iter().map(|c| place(c)).collect::<Vec<_>>());
    let mut series = vec![Series {
        name: "not beaten in both".to_owned(),
        color: FRONT,
        points: front
            .iter()
            .map(|&i| (place(cells[i]), String::new()))
            .collect(),
        joined: true,
        dotted: false,
        dashed: true,
    }];
    for method in methods(&cells) {
        let own = (0..)
            .zip(&cells)
            .filter(|(_, c)| c.variant.method == method);
        let point = |(i, c): (usize, &&Cell)| {
            let label = if front.contains(&i) {
                c.variant.label()
            } else {
                String::new()
            };
            (place(c), label)
        };
        series.push(dots(method, own.map(point).collect()));
    }
    let chart = Chart {
        title: format!("{} against cost at {angle:.0}°", metric.title()),
        x: log_axis("ns per sample on the model"),
        y: metric.axis(),
        series,
    };
    chart.drawing(PAPER)
}

/// Error against the angle of the view, each method once.
#[must_use]
pub fn error_by_angle(record: &Record, metric: PlotMetric) -> Drawing {
    let cells = usual_cells(record);
    let lines = each_method(&cells, |c| [c.angle_deg, metric.of(c)]);
    let chart = Chart {
        title: format!("{} against the angle of the view", metric.title()),
        x: Axis {
            name: "degrees from the normal".to_owned(),
            scale: Scale::Linear,
            least: 0.0,
        },
        y: metric.axis(),
        series: lines,
    };
    chart.drawing(PAPER)
}

/// Error against the amplitude in the views nearest to an angle, each method once.
#[must_use]
pub fn error_by_amplitude(record: &Record, angle_deg: f64, metric: PlotMetric) -> Drawing {
    let bits = record.subject.map_bits;
    let all: Vec<&Cell> = record.cells.iter().filter(|c| c.bits == bits).collect();
    let Some(angle) = nearest_angle(&all, angle_deg) else {
        return empty("error against amplitude");
    };
    let cells: Vec<_> = all.into_iter().filter(|c| c.angle_deg == angle).collect();
    let chart = Chart {
        title: format!("{} against amplitude at {angle:.0}°", metric.title()),
        x: Axis {
            name: "factor on the material's amplitude".to_owned(),
            scale: Scale::Linear,
            least: 0.0,
        },
        y: metric.axis(),
        series: each_method(&cells, |c| [c.amplitude, metric.of(c)]),
    };
    chart.drawing(PAPER)
}

/// Error against steps in the view nearest to an angle, for methods that take steps.
#[must_use]
pub fn error_by_steps(record: &Record, angle_deg: f64, metric: PlotMetric) -> Drawing {
    let cells = usual_cells(record);
    let Some(angle) = nearest_angle(&cells, angle_deg) else {
        return empty("error against steps");
    };
    let is_one =
        |c: &&Cell| c.angle_deg == angle && c.variant.steps.is_some() && !c.variant.is_bare();
    let cells: Vec<_> = cells.into_iter().filter(is_one).collect();
    let place = |c: &Cell| [f64::from(c.variant.steps.unwrap_or(0)), metric.of(c)];
    let lines = methods(&cells).into_iter().map(|method| {
        let own = cells.iter().filter(|c| c.variant.method == method);
        line(method, own.map(|c| place(c)).collect())
    });
    let chart = Chart {
        title: format!("{} against steps at {angle:.0}°", metric.title()),
        x: log_axis("layers, cone steps or iterations asked for"),
        y: metric.axis(),
        series: lines.collect(),
    };
    chart.drawing(PAPER)
}

/// Mean FLIP against time while samples come in, in the view nearest to an angle, each method once.
#[must_use]
pub fn quality_by_time(record: &Record, angle_deg: f64) -> Drawing {
    let cells = usual_cells(record);
    let Some(angle) = nearest_angle(&cells, angle_deg) else {
        return empty("time to quality");
    };
    let is_one = |c: &&Cell| c.angle_deg == angle && c.variant.is_usual();
    let lines = cells.iter().copied().filter(is_one).map(|cell| {
        let samples = |i: usize| f64::from(record.plan.samples.min(1 << i.min(31)));
        let points = cell.flip_by_samples.iter().enumerate();
        let place = |(i, &flip): (usize, &f64)| [cell.cost.full_hd_ms * samples(i), flip];
        line(cell.variant.method, points.map(place).collect())
    });
    let chart = Chart {
        title: format!("Time to quality at {angle:.0}°: samples come in"),
        x: log_axis("ms for a frame of 1920×1080"),
        y: PlotMetric::Flip.axis(),
        series: lines.collect(),
    };
    chart.drawing(PAPER)
}

/// The cells of the amplitude nearest to the material's own and of all bits of its map.
pub fn usual_cells(record: &Record) -> Vec<&Cell> {
    let (usual, bits) = (record.usual_amplitude(), record.subject.map_bits);
    // A method that reads no heights is measured once, whatever the bits.
    let is_usual = |c: &&Cell| c.amplitude == usual && c.bits == bits;
    record.cells.iter().filter(is_usual).collect()
}

/// The measured angle that is nearest to one.
pub fn nearest_angle(cells: &[&Cell], wanted: f64) -> Option<f64> {
    let angles = cells.iter().map(|c| c.angle_deg);
    let distance = |a: &f64| (a - wanted).abs();
    angles.min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// Indices of the points that no other beats in both coordinates, by growing first coordinate.
#[must_use]
pub fn front(points: &[[f64; 2]]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| {
        let [a, b] = [points[a], points[b]];
        a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
    });
    let mut best = f64::INFINITY;
    order.retain(|&i| {
        let is_better = points[i][1] < best;
        best = best.min(points[i][1]);
        is_better
    });
    order
}

fn each_method(cells: &[&Cell], place: impl Fn(&Cell) -> [f64; 2]) -> Vec<Series> {
    let own = |method: Method| {
        let cells = cells
            .iter()
            .filter(|c| c.variant.method == method && c.variant.is_usual());
        line(method, cells.map(|c| place(c)).collect())
    };
    methods(cells).into_iter().map(own).collect()
}

/// The methods of cells, in the order of the list of methods.
fn methods(cells: &[&Cell]) -> Vec<Method> {
    let has = |m: &Method| cells.iter().any(|c| c.variant.method == *m);
    Method::ALL.into_iter().filter(has).collect()
}

fn line(method: Method, mut points: Vec<[f64; 2]>) -> Series {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    Series {
        joined: true,
        ..dots(
            method,
            points.into_iter().map(|p| (p, String::new())).collect(),
        )
    }
}

fn dots(method: Method, points: Vec<([f64; 2], String)>) -> Series {
    Series {
        name: method.name().to_owned(),
        color: color(method),
        points,
        joined: false,
        dotted: true,
        dashed: false,
    }
}

fn log_axis(name: &str) -> Axis {
    Axis {
        name: name.to_owned(),
        scale: Scale::Log,
        least: 1e-3,
    }
}

fn empty(what: &str) -> Drawing {
    let axis = log_axis("");
    let chart = Chart {
        title: format!("{what}: nothing was measured"),
        x: axis.clone(),
        y: axis,
        series: Vec::new(),
    };
    chart.drawing(PAPER)
}

/// Colours of the methods in the order of their list: families share a hue.
const COLORS: [[u8; 3]; 13] = [
    [70, 74, 82],
    [166, 118, 29],
    [205, 160, 70],
    [120, 84, 30],
    [214, 39, 40],
    [240, 128, 128],
    [199, 84, 178],
    [120, 190, 235],
    [52, 140, 205],
    [20, 80, 160],
    [23, 150, 130],
    [44, 150, 40],
    [148, 103, 189],
];

/// The colour of a method in every chart.
#[must_use]
pub fn color(method: Method) -> [u8; 3] {
    let place = Method::ALL.iter().position(|m| *m == method);
    COLORS[place.unwrap_or(0) % COLORS.len()]
}

#[cfg(test)]
mod tests {
    use super::front;

    #[test]
    fn the_front_leaves_out_what_is_beaten_in_both() {
        let points = [[3.0, 1.0], [1.0, 5.0], [2.0, 6.0], [2.0, 2.0], [4.0, 1.0]];
        assert_eq!(front(&points), [1, 3, 0]);
        assert!(front(&[]).is_empty());
    }
}
