//! Flat reliefs whose triangles lie in one plane, with texture coordinates that go on evenly from one to the next: walked
//! as one, however finely the plane is cut into triangles.
//!
//! Only what hangs together nowhere else is made a sheet: at its rim there is no neighbour from which a crack could
//! open.

use glam::{DVec2, DVec3};

use super::flat::{Axes, by_weights};
use super::{Reliefs, texels_at};
use crate::geometry::TriangleMesh;

/// How far vertices may lie off the plane and its outline, as a share of the largest coordinate: the seventh digit,
/// which is the last that files tell.
const SLACK: f64 = 1e-6;

/// How far vertices may lie off the plane at the most, as a share of the relief's own height.
const FLAT: f64 = 1e-3;

/// How far texture coordinates may lie off those of the plane, texels.
const TEXEL_SLACK: f64 = 0.01;

/// By how much areas may differ that count as the same.
const SAME_AREA: f64 = 1e-5;

/// Most sides of an outline: every ray is cut off at each.
const MOST_SIDES: usize = 8;

/// Weight of all corners from which on a place lies in no other triangle.
const CLEARLY: f64 = 1e-6;

/// Most cells of the plan along one side.
const MOST_CELLS: f64 = 4096.0;

/// Triangles in a cell of the plan in the mean, at the most: slivers lie in many cells.
const CROWDED: usize = 16;

/// Where a flat relief ends: within, `at + ways · (b1, b2)` is at least 0 for the weights of the second and third corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    pub at: f64,
    pub ways: [f64; 2],
}

/// The sides of a triangle.
pub const TRIANGLE: [Edge; 3] = [
    Edge {
        at: 0.0,
        ways: [1.0, 0.0],
    },
    Edge {
        at: 0.0,
        ways: [0.0, 1.0],
    },
    Edge {
        at: 1.0,
        ways: [-1.0, -1.0],
    },
];

/// Triangles that are walked as one flat relief.
#[derive(Debug)]
pub struct Sheet {
    /// Axes by three of its corners, wound as its triangles are.
    pub axes: Axes,
    /// Place of the first of these corners in texels, and the change of it by the weights of the others.
    pub texels: [[f64; 2]; 3],
    /// Its outline, in weights of these corners.
    pub sides: Vec<Edge>,
    plan: Plan,
}

impl Sheet {
    /// Of triangles that hang together, with this normal at all their corners. `None` if they do not lie in one plane, if
    /// their texture coordinates are not those of the plane, and unless they fill a convex outline, each place once.
    pub fn new(
        mesh: &TriangleMesh,
        reliefs: &Reliefs<'_, '_>,
        prims: &[u32],
        normal: DVec3,
    ) -> Option<Self> {
        let material = mesh.attributes[*prims.first()? as usize].material;
        let same = |&prim: &u32| mesh.attributes[prim as usize].material == material;
        if prims.len() < 2 || !prims.iter().all(same) {
            return None;
        }
        let field = reliefs.on(mesh, prims[0])?;
        let position = |vertex: u32| mesh.positions[vertex as usize].as_dvec3();
        let vertices: Vec<u32> = prims
            .iter()
            .flat_map(|&prim| mesh.indices[prim as usize])
            .collect();
        let corners = far_apart(&vertices, position, normal);
        let axes = Axes::new(corners.map(position), normal);
        let texels = |vertex: u32| texels_at(mesh, field, vertex);
        let [t0, by1, by2] = by_weights(corners.map(texels));
        let reach = vertices
            .iter()
            .map(|&v| position(v).abs().max_element())
            .fold(0.0, f64::max);
        let slack = SLACK * reach;
        let [low, high] = field.range();
        let off_plane = slack.min(FLAT * (high - low));
        let mut points = Vec::with_capacity(vertices.len());
        for &vertex in &vertices {
            let [b1, b2, z] = axes.weights(position(vertex));
            let t = texels(vertex);
            let off = [0, 1].map(|k| t0[k] + by1[k] * b1 + by2[k] * b2 - t[k]);
            // No for NaN, too.
            if !(z.abs() <= off_plane && off[0].hypot(off[1]) <= TEXEL_SLACK) {
                return None;
            }
            points.push(DVec2::new(b1, b2));
        }
        // Wound alike, or a fold would hide that another place is empty.
        let area: f64 = points
            .chunks_exact(3)
            .map(|p| (p[1] - p[0]).perp_dot(p[2] - p[0]))
            .map(|area| if area > 0.0 { area } else { f64::NAN })
            .sum();
        let share = slack / axes.height();
        let (sides, whole) = outline(&points, share)?;
        if !((area - whole).abs() <= SAME_AREA * whole) {
            return None;
        }
        Some(Self {
            axes,
            texels: [t0, by1, by2],
            sides,
            plan: Plan::new(prims, &points, share),
        })
    }

    /// Its triangles, some of them more than once.
    pub fn prims(&self) -> &[u32] {
        &self.plan.prims
    }

    /// The triangle at a place in the sheet's axes, and the weights of the triangle's second and third corner there. It
    /// may be `near`, another of its triangles, which is looked at first.
    pub fn triangle_at(
        &self,
        mesh: &TriangleMesh,
        place: [f64; 2],
        near: PlanTriangle,
    ) -> (PlanTriangle, [f64; 2]) {
        let place = DVec2::from(place);
        let (inside, weights) = near.weights(place);
        // On its edge another may come first in the plan, whatever was near.
        if inside > CLEARLY {
            return (near, weights);
        }
        let mut best = (f64::NEG_INFINITY, (near, weights));
        for &prim in self.plan.cell(place) {
            let triangle = self.triangle(mesh, prim);
            let (inside, weights) = triangle.weights(place);
            if inside > best.0 {
                best = (inside, (triangle, weights));
            }
            if inside >= 0.0 {
                break;
            }
        }
        best.1
    }

    /// A triangle in the sheet's axes.
    pub fn triangle(&self, mesh: &TriangleMesh, prim: u32) -> PlanTriangle {
        let [p0, p1, p2] = mesh.corners(prim).map(|p| {
            let [b1, b2, _] = self.axes.weights(p.as_dvec3());
            DVec2::new(b1, b2)
        });
        let edges = [p1 - p0, p2 - p0];
        PlanTriangle {
            prim,
            first: p0,
            edges,
            area: edges[0].perp_dot(edges[1]),
        }
    }

    /// Heap bytes.
    pub const fn bytes(&self) -> usize {
        size_of_val(self.sides.as_slice())
            + size_of_val(self.plan.starts.as_slice())
            + size_of_val(self.plan.prims.as_slice())
    }
}

/// A triangle in a sheet's axes.
#[derive(Debug, Clone, Copy)]
pub struct PlanTriangle {
    prim: u32,
    first: DVec2,
    edges: [DVec2; 2],
    /// Twice that.
    area: f64,
}

impl PlanTriangle {
    pub const fn prim(&self) -> u32 {
        self.prim
    }

    /// The smallest of the weights of its corners at a place, and those of the second and third.
    fn weights(&self, place: DVec2) -> (f64, [f64; 2]) {
        let [e1, e2] = self.edges;
        let way = place - self.first;
        let [w1, w2] = [way.perp_dot(e2), e1.perp_dot(way)].map(|w| w / self.area);
        (w1.min(w2).min(1.0 - w1 - w2), [w1, w2])
    }
}

/// Three vertices far from each other, the ways from the first to the others as upright on each other as can be, wound
/// counter-clockwise around the normal if the first triangle is.
fn far_apart(vertices: &[u32], position: impl Fn(u32) -> DVec3, normal: DVec3) -> [u32; 3] {
    let [v0, v1, v2] = [0, 1, 2].map(|k| vertices[k]);
    let farthest = |score: &dyn Fn(DVec3) -> f64| {
        let key = |vertex: u32| score(position(vertex));
        let mut best = v0;
        for &vertex in vertices {
            if key(vertex) > key(best) {
                best = vertex;
            }
        }
        best
    };
    let area = |a: DVec3, b: DVec3, c: DVec3| (b - a).cross(c - a).dot(normal);
    let a = farthest(&|p| p.distance_squared(position(v0)));
    let b = farthest(&|p| p.distance_squared(position(a)));
    let c = farthest(&|p| area(position(a), position(b), p).abs());
    let slant = |&[a, b, c]: &[u32; 3]| {
        let [to_b, to_c] = [b, c].map(|v| (position(v) - position(a)).normalize_or_zero());
        to_b.dot(to_c).abs()
    };
    let turned = [[a, b, c], [b, c, a], [c, a, b]];
    let least = |i: &[u32; 3], j: &[u32; 3]| slant(i).total_cmp(&slant(j));
    let [a, b, c] = turned.into_iter().min_by(least).unwrap_or(turned[0]);
    let turns = |[a, b, c]: [u32; 3]| area(position(a), position(b), position(c)) < 0.0;
    if turns([a, b, c]) == turns([v0, v1, v2]) {
        [a, b, c]
    } else {
        [a, c, b]
    }
}

/// The convex outline of points and twice its area. Corners that lie off the line between their neighbours by less than
/// `slack` are left out, and the sides there moved out so far that all points are within. `None` for an outline of too
/// many sides.
fn outline(points: &[DVec2], slack: f64) -> Option<(Vec<Edge>, f64)> {
    let mut points = points.to_vec();
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    let hull = hull(&points);
    let area = hull
        .iter()
        .zip(hull.iter().cycle().skip(1))
        .map(|(a, b)| a.perp_dot(*b))
        .sum();
    let mut corners = hull.clone();
    let mut i = 0;
    let mut kept = 0;
    // Round and round, until none has gone for a whole turn.
    while kept < corners.len() && corners.len() > 3 {
        let n = corners.len();
        let (before, here, after) = (
            corners[(i + n - 1) % n],
            corners[i % n],
            corners[(i + 1) % n],
        );
        let way = after - before;
        if way.perp_dot(before - here).abs() <= slack * way.length() {
            corners.remove(i % n);
            i = (i % n).saturating_sub(1);
            kept = 0;
        } else {
            i = (i + 1) % n;
            kept += 1;
        }
    }
    if corners.len() < 3 || corners.len() > MOST_SIDES {
        return None;
    }
    let side = |k: usize| {
        let from = corners[k];
        let way = (corners[(k + 1) % corners.len()] - from).normalize();
        let inwards = way.perp();
        let beyond = hull.iter().map(|p| inwards.dot(*p - from));
        Edge {
            at: -inwards.dot(from) - beyond.fold(0.0, f64::min),
            ways: inwards.to_array(),
        }
    };
    Some(((0..corners.len()).map(side).collect(), area))
}

/// The convex hull of points in growing order, counter-clockwise, without points on its sides.
///
/// Source: Andrew 1979, "Another efficient algorithm for convex hulls in two dimensions".
fn hull(points: &[DVec2]) -> Vec<DVec2> {
    let mut hull: Vec<DVec2> = Vec::new();
    let there = points.iter();
    let back = points.iter().rev().skip(1);
    let mut half = 0;
    for (pass, &p) in there.map(|p| (0, p)).chain(back.map(|p| (1, p))) {
        if pass == 1 && half == 0 {
            half = hull.len() - 1;
        }
        while hull.len() >= half + 2 {
            let [a, b] = [hull[hull.len() - 2], hull[hull.len() - 1]];
            if (b - a).perp_dot(p - b) > 0.0 {
                break;
            }
            hull.pop();
        }
        hull.push(p);
    }
    // The first is the last, too.
    hull.pop();
    hull
}

/// Which triangles of a sheet lie around a place: lists by the cells of a grid over it.
#[derive(Debug)]
struct Plan {
    low: DVec2,
    /// Cells per unit of weight.
    per_weight: DVec2,
    /// Cells along each side.
    count: usize,
    /// Where the list of each cell begins, row by row, and where the last ends.
    starts: Vec<u32>,
    prims: Vec<u32>,
}

impl Plan {
    /// Of triangles and the places of their corners. What lies `slack` beyond a triangle still counts as near it.
    fn new(prims: &[u32], points: &[DVec2], slack: f64) -> Self {
        let bounds = |points: &[DVec2]| {
            let low = points.iter().copied().fold(DVec2::INFINITY, DVec2::min);
            let high = points.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
            (low, high)
        };
        let (low, high) = bounds(points);
        let mut count = (prims.len() as f64).sqrt().ceil().min(MOST_CELLS) as usize;
        loop {
            let mut plan = Self {
                low,
                per_weight: DVec2::splat(count as f64) / (high - low),
                count,
                starts: vec![0; count * count + 1],
                prims: Vec::new(),
            };
            let cells = |triangle: &[DVec2]| {
                let (low, high) = bounds(triangle);
                let [x0, y0] = plan.place(low - slack);
                let [x1, y1] = plan.place(high + slack);
                (y0..=y1).flat_map(move |y| (x0..=x1).map(move |x| y * count + x))
            };
            let mut ends = vec![0_u32; count * count];
            for cell in points.chunks_exact(3).flat_map(cells) {
                ends[cell] += 1;
            }
            let mut sum = 0;
            for end in &mut ends {
                sum += std::mem::replace(end, sum);
            }
            if count > 1 && sum as usize > CROWDED * prims.len() {
                count /= 2;
                continue;
            }
            let mut lists = vec![0; sum as usize];
            let mut starts = ends.clone();
            starts.push(sum);
            for (&prim, triangle) in prims.iter().zip(points.chunks_exact(3)) {
                for cell in cells(triangle) {
                    lists[ends[cell] as usize] = prim;
                    ends[cell] += 1;
                }
            }
            plan.starts = starts;
            plan.prims = lists;
            return plan;
        }
    }

    /// Column and row of the cell of a place, or of the nearest.
    fn place(&self, p: DVec2) -> [usize; 2] {
        let last = self.count - 1;
        ((p - self.low) * self.per_weight)
            .to_array()
            .map(|x| (x.max(0.0) as usize).min(last))
    }

    /// The triangles around a place.
    fn cell(&self, p: DVec2) -> &[u32] {
        let [x, y] = self.place(p);
        let cell = y * self.count + x;
        let [from, to] = [0, 1].map(|k| self.starts[cell + k] as usize);
        &self.prims[from..to]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_outline_of_a_grid_is_that_of_its_corners() {
        let grid = |turn: f64| {
            let (sin, cos) = turn.sin_cos();
            let at = move |i: u32, j: u32| {
                let (x, y) = (f64::from(i) / 9.0, f64::from(j) / 5.0);
                // As stored.
                DVec2::new(
                    (x * cos - y * sin) as f32 as f64,
                    (x * sin + y * cos) as f32 as f64,
                )
            };
            (0..=9)
                .flat_map(move |i| (0..=5).map(move |j| at(i, j)))
                .collect()
        };
        for turn in [0.0, 0.7, 2.0] {
            let points: Vec<DVec2> = grid(turn);
            let (sides, area) = outline(&points, 1e-6).expect("few sides");
            assert_eq!(sides.len(), 4, "{turn}");
            assert!((area - 2.0).abs() < 1e-6, "{turn}: {area}");
            for side in sides {
                let beyond = |p: &DVec2| side.at + DVec2::from(side.ways).dot(*p);
                let least = points.iter().map(beyond).fold(f64::INFINITY, f64::min);
                assert!(least > -1e-12 && least < 2e-6, "{turn}: {least}");
            }
        }
    }

    #[test]
    fn an_outline_of_many_sides_is_none() {
        let turn = |i: u32| DVec2::from_angle(f64::from(i) * 0.1);
        let points: Vec<DVec2> = (0..62).map(turn).collect();
        assert!(outline(&points, 1e-6).is_none());
    }
}
