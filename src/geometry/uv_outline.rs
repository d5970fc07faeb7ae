//! The outline of a chart that does not fill the rectangle around it.

use std::collections::HashSet;

use glam::{DVec2, Vec2};

use super::UvBox;

/// Most rows that triangles and edges are kept by.
const MOST_ROWS: usize = 1024;

/// Part of the chart's size that a ray is followed over an edge to see whether the chart goes on there.
const BEYOND: f64 = 1e-9;

/// On the average a triangle reaches into so many rows at the most, and one more.
const ROWS_EACH: f64 = 4.0;

/// The triangles of a chart on the texture, and the edges that only one of them has.
#[derive(Debug)]
pub struct UvOutline {
    scale: RowScale,
    triangles: Rows<[DVec2; 3]>,
    edges: Rows<[DVec2; 2]>,
}

impl UvOutline {
    /// Of triangles given by numbers of corners, which the same corner shares, and their texture coordinates. `None`
    /// if they fill the rectangle around them, each place once.
    #[must_use]
    pub fn new(around: &UvBox, triangles: &[([u32; 3], [Vec2; 3])]) -> Option<Self> {
        let of = |uv: &[Vec2; 3]| uv.map(|uv| uv.as_dvec2());
        let areas = || triangles.iter().map(|(_, uv)| area(of(uv)));
        let size = (around.high - around.low).as_dvec2();
        let sum = areas().sum::<f64>().abs();
        let turned = areas().map(f64::abs).sum::<f64>();
        let whole = size.x * size.y;
        let is_near = |area: f64| (area - whole).abs() <= 1e-6 * whole;
        // Nothing to tell apart in what is no number, either.
        if !whole.is_finite() || (is_near(sum) && is_near(turned)) {
            return None;
        }
        let known: HashSet<[u32; 2]> = triangles
            .iter()
            .flat_map(|(corners, _)| sides(*corners))
            .collect();
        let open = |&([a, b], _): &([u32; 2], [DVec2; 2])| !known.contains(&[b, a]);
        let edges = triangles
            .iter()
            .flat_map(|(corners, uv)| sides(*corners).into_iter().zip(sides(of(uv))))
            .filter(open)
            .map(|(_, edge)| edge);
        let heights = triangles.iter().map(|(_, uv)| {
            let [a, b, c] = uv.map(|uv| f64::from(uv.y));
            a.max(b).max(c) - a.min(b).min(c)
        });
        let scale = RowScale::new(around, triangles.len(), heights.sum());
        Some(Self {
            scale,
            triangles: Rows::new(scale, triangles.iter().map(|(_, uv)| of(uv))),
            edges: Rows::new(scale, edges),
        })
    }

    /// Whether a texture coordinate is in one of the triangles, its border included. NaN is not.
    #[must_use]
    pub fn contains(&self, uv: DVec2) -> bool {
        let triangles = self.triangles.row(self.scale.row(uv.y));
        triangles.iter().any(|&triangle| is_inside(triangle, uv))
    }

    /// How far a ray that starts at `from` and changes by `rate` stays on the triangles, at most `end`.
    #[must_use]
    pub fn exit(&self, from: DVec2, rate: DVec2, end: f64) -> f64 {
        if !end.is_finite() {
            return end;
        }
        let ends = [from.y, from.y + rate.y * end].map(|v| self.scale.row(v));
        let rows = ends[0].min(ends[1])..=ends[0].max(ends[1]);
        let step = BEYOND / (rate.length() * self.scale.rows_per_v.max(f64::MIN_POSITIVE));
        // From edge to edge; few lie on the way.
        let mut gone = f64::NEG_INFINITY;
        loop {
            let edges = rows.clone().flat_map(|row| self.edges.row(row));
            let next = edges
                .filter_map(|edge| crossing(from, rate, *edge))
                .filter(|&t| t >= 0.0 && t > gone && t < end)
                .fold(end, f64::min);
            if next >= end || !self.contains(from + rate * (next + step)) {
                return next;
            }
            gone = next;
        }
    }

    /// Heap bytes.
    #[must_use]
    pub const fn bytes(&self) -> usize {
        self.triangles.bytes() + self.edges.bytes()
    }
}

/// Rows of equal height over a chart.
#[derive(Debug, Clone, Copy)]
struct RowScale {
    low: f64,
    rows_per_v: f64,
    count: usize,
}

impl RowScale {
    /// For so many triangles, whose heights add up to `heights`. Where these are tall there are few rows, or each
    /// would be in hundreds of them.
    fn new(around: &UvBox, triangles: usize, heights: f64) -> Self {
        let height = f64::from(around.high.y) - f64::from(around.low.y);
        let each = ROWS_EACH * triangles as f64 * height / heights;
        let count = (each as usize).clamp(1, triangles.clamp(1, MOST_ROWS));
        Self {
            low: f64::from(around.low.y),
            rows_per_v: if height > 0.0 {
                count as f64 / height
            } else {
                0.0
            },
            count,
        }
    }

    /// The row of a v; beyond the chart the nearest.
    fn row(self, v: f64) -> usize {
        let last = (self.count - 1) as f64;
        ((v - self.low) * self.rows_per_v).clamp(0.0, last) as usize
    }
}

/// Things by the rows that they reach into.
#[derive(Debug)]
struct Rows<T> {
    /// Where each row's things begin, and where the last's end.
    starts: Vec<u32>,
    things: Vec<T>,
}

impl<T: Copy + AsRef<[DVec2]>> Rows<T> {
    fn new(scale: RowScale, things: impl Iterator<Item = T>) -> Self {
        let mut rows = vec![Vec::new(); scale.count];
        for thing in things {
            let reached = thing.as_ref().iter().map(|corner| scale.row(corner.y));
            let (first, last) = reached.fold((scale.count - 1, 0), |(low, high), row| {
                (low.min(row), high.max(row))
            });
            for row in &mut rows[first..=last] {
                row.push(thing);
            }
        }
        let mut starts = vec![0];
        let mut all = Vec::new();
        for row in rows {
            all.extend(row);
            starts.push(all.len() as u32);
        }
        Self {
            starts,
            things: all,
        }
    }

    fn row(&self, row: usize) -> &[T] {
        &self.things[self.starts[row] as usize..self.starts[row + 1] as usize]
    }
}

impl<T> Rows<T> {
    const fn bytes(&self) -> usize {
        size_of_val(self.starts.as_slice()) + size_of_val(self.things.as_slice())
    }
}

/// Sides of a triangle, each from corner to corner.
const fn sides<T: Copy>([a, b, c]: [T; 3]) -> [[T; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// Signed.
fn area([a, b, c]: [DVec2; 3]) -> f64 {
    (b - a).perp_dot(c - a) * 0.5
}

fn is_inside(triangle: [DVec2; 3], uv: DVec2) -> bool {
    let winding = area(triangle);
    let inner = |[a, b]: [DVec2; 2]| (b - a).perp_dot(uv - a) * winding >= 0.0;
    winding != 0.0 && sides(triangle).into_iter().all(inner)
}

/// Where a ray crosses an edge; parallels do not cross.
fn crossing(from: DVec2, rate: DVec2, [a, b]: [DVec2; 2]) -> Option<f64> {
    let along = b - a;
    let across = rate.perp_dot(along);
    let share = (a - from).perp_dot(rate) / across;
    (across != 0.0 && (0.0..=1.0).contains(&share)).then(|| (a - from).perp_dot(along) / across)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The unit square without its upper right quarter, as three squares of two triangles.
    fn l_shape() -> UvOutline {
        let corner = |i: u32| Vec2::new((i % 3) as f32, (i / 3) as f32) * 0.5;
        let triangles: Vec<_> = [0_u32, 1, 3]
            .into_iter()
            .flat_map(|i| [[i, i + 1, i + 4], [i, i + 4, i + 3]])
            .map(|corners| (corners, corners.map(corner)))
            .collect();
        let around = UvBox {
            low: Vec2::ZERO,
            high: Vec2::ONE,
        };
        UvOutline::new(&around, &triangles).expect("no rectangle")
    }

    fn is_in_l(uv: DVec2) -> bool {
        uv.min_element() >= 0.0 && uv.max_element() <= 1.0 && uv.min_element() <= 0.5
    }

    fn places() -> impl Iterator<Item = DVec2> {
        (0..41 * 41).map(|i| DVec2::new(f64::from(i % 41), f64::from(i / 41)) * 0.0305 - 0.11)
    }

    #[test]
    fn places_are_inside_where_triangles_are() {
        let outline = l_shape();
        for uv in places() {
            assert_eq!(outline.contains(uv), is_in_l(uv), "{uv}");
        }
        assert!(!outline.contains(DVec2::NAN));
    }

    #[test]
    fn rays_stay_up_to_where_they_leave() {
        let outline = l_shape();
        let mut inner = 0;
        for from in places().filter(|uv| is_in_l(*uv)) {
            for turn in 0..16 {
                let rate = DVec2::from_angle(f64::from(turn) * 0.39 + 0.01) * 0.7;
                // Where the rectangle ends.
                let sides = [0, 1].map(|k| f64::from(u8::from(rate[k] > 0.0)) - from[k]);
                let end = (sides[0] / rate.x).min(sides[1] / rate.y);
                let found = outline.exit(from, rate, end);
                let stays = |t: f64| is_in_l(from + rate * t);
                let on_the_way = (1..1000).map(|i| found * f64::from(i) * 1e-3);
                assert!(on_the_way.into_iter().all(stays), "{from} {rate}: {found}");
                assert!(!stays(found + 1e-7), "{from} {rate}: {found}");
                inner += usize::from(found < end);
            }
        }
        assert!(inner > 100, "{inner}");
    }

    #[test]
    fn tall_triangles_are_not_kept_in_every_row() {
        let corner = |i: u32| Vec2::new((i / 2) as f32, (i % 2) as f32);
        let strip = |i| [i, i + 1, i + 2];
        // Every other one is left out, so that they fill no rectangle.
        let triangles: Vec<_> = (0..2000)
            .map(|i| strip(2 * i))
            .map(|corners| (corners, corners.map(corner)))
            .collect();
        let around = UvBox {
            low: Vec2::ZERO,
            high: Vec2::new(2000.0, 1.0),
        };
        let outline = UvOutline::new(&around, &triangles).expect("half is missing");
        assert!(outline.triangles.things.len() <= 5 * triangles.len());
        assert!(outline.contains(DVec2::new(0.4, 0.4)));
        assert!(!outline.contains(DVec2::new(0.6, 0.9)));
    }

    #[test]
    fn a_rectangle_needs_no_outline() {
        let around = UvBox {
            low: Vec2::ZERO,
            high: Vec2::new(2.0, 1.0),
        };
        let uv = [
            Vec2::ZERO,
            Vec2::new(2.0, 0.0),
            Vec2::new(2.0, 1.0),
            Vec2::Y,
        ];
        let corners = |i: [u32; 3]| (i, i.map(|i| uv[i as usize]));
        let both = [corners([0, 1, 2]), corners([0, 2, 3])];
        assert!(UvOutline::new(&around, &both).is_none());
        assert!(UvOutline::new(&around, &both[..1]).is_some());
        // Twice the same half is as large.
        let folded = [corners([0, 1, 2]), corners([2, 1, 0])];
        assert!(UvOutline::new(&around, &folded).is_some());
    }
}
