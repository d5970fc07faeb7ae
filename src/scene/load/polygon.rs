//! Cuts polygons into triangles: `n − 2` of them, inside the polygon, with its corners only.

mod stitch;

use std::collections::HashSet;

use earcut::Earcut;
use glam::DVec3;

use stitch::restore_left_out;

/// Corners beyond which ear clipping's 32-bit bookkeeping would not fit.
const MAX_CORNERS: usize = 10_000_000;

/// A polygon with more corners than this is looked at for corners that come again and again.
const MANY_CORNERS: usize = 64;

/// A sine below which two edges in a row count as one straight line when a polygon is tested for being
/// convex; such polygons go through ear clipping, which knows what to do with straight corners.
const STRAIGHT: f64 = 1e-9;

/// A polygon's triangles.
#[derive(Debug)]
pub(super) struct Triangulated<'a> {
    /// Corner numbers within the polygon, in the polygon's sense of rotation. Fewer than `n − 2` only
    /// where the rest has no area.
    pub triangles: &'a [[u32; 3]],
    /// Half the sum of the cross products (Newell 1972): normal times area, exact for planar polygons,
    /// whatever their shape, and independent of the triangulation. World units.
    pub area_vector: DVec3,
    /// Whether the triangles overlap or turn over because the polygon crosses itself.
    pub crossed: bool,
}

/// Triangulates polygons one after the other with the same memory.
#[derive(Default)]
pub(super) struct Triangulator {
    earcut: Earcut<f64>,
    flat: Vec<[f64; 2]>,
    indices: Vec<u32>,
    triangles: Vec<[u32; 3]>,
}

impl Triangulator {
    /// Triangulates a polygon with at least three corners; fewer give no triangles.
    ///
    /// Quads are cut along the shorter diagonal that stays inside. Polygons with more corners are seen
    /// along the axis nearest to their normal; convex ones become a fan, others go through ear clipping.
    /// Corners that are not finite, no area at all, or no result give a fan.
    pub fn triangulate(&mut self, corners: &[DVec3]) -> Triangulated<'_> {
        self.triangles.clear();
        let area_vector = area_vector(corners);
        let mut crossed = false;
        match *corners {
            [_, _, _] => self.triangles.push([0, 1, 2]),
            [a, b, c, d] => {
                let (cut, inside) = split_quad([a, b, c, d], area_vector);
                self.triangles.extend(cut);
                crossed = !inside && doubled_area(corners, cut) > 2.02 * area_vector.length();
            }
            _ if corners.len() < 3 => {}
            _ => crossed = !self.clip(corners, area_vector),
        }
        Triangulated {
            triangles: &self.triangles,
            area_vector,
            crossed,
        }
    }

    /// Fills `triangles` for a polygon with five or more corners; whether they cover it exactly once.
    fn clip(&mut self, corners: &[DVec3], area_vector: DVec3) -> bool {
        let finite = corners.iter().all(|p| p.is_finite()) && area_vector.is_finite();
        if !finite || area_vector == DVec3::ZERO || corners.len() > MAX_CORNERS {
            self.fan(corners.len());
            // What is not finite is dropped later and noted there.
            return !finite || corners.iter().all(|p| *p == corners[0]);
        }
        if winds(corners) {
            self.fan(corners.len());
            return false;
        }
        self.flatten(corners, area_vector);
        if is_convex(&self.flat) {
            self.fan(corners.len());
            return true;
        }
        self.earcut.earcut_slice(&self.flat, &[], &mut self.indices);
        self.triangles
            .extend(self.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]));
        self.turn_to_polygon();
        if self.triangles.len() < corners.len() - 2 {
            restore_left_out(&mut self.triangles, &self.flat);
        }
        if self.triangles.is_empty() {
            self.fan(corners.len());
            return false;
        }
        self.covers_once()
    }

    fn fan(&mut self, corners: usize) {
        self.triangles.clear();
        self.triangles
            .extend((2..corners as u32).map(|i| [0, i - 1, i]));
    }

    /// Drops the axis nearest to the normal, so that the polygon turns counter-clockwise. No rounding:
    /// what is straight in space stays exactly straight.
    fn flatten(&mut self, corners: &[DVec3], normal: DVec3) {
        let size = normal.abs();
        let (x, y, along) = if size.z >= size.x && size.z >= size.y {
            (0, 1, normal.z)
        } else if size.x >= size.y {
            (1, 2, normal.x)
        } else {
            (2, 0, normal.y)
        };
        let (x, y) = if along < 0.0 { (y, x) } else { (x, y) };
        self.flat.clear();
        self.flat.extend(corners.iter().map(|p| [p[x], p[y]]));
    }

    /// Ear clipping has a sense of rotation of its own.
    fn turn_to_polygon(&mut self) {
        let sum: f64 = self.triangles.iter().map(|t| area2(&self.flat, *t)).sum();
        if sum < 0.0 {
            self.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
    }

    /// Whether the triangles' areas add up to the polygon's.
    fn covers_once(&self) -> bool {
        let sum: f64 = self
            .triangles
            .iter()
            .map(|t| area2(&self.flat, *t).abs())
            .sum();
        let corners = self.flat.len() as u32;
        let polygon: f64 = (2..corners).map(|i| area2(&self.flat, [0, i - 1, i])).sum();
        (sum - polygon).abs() <= 1e-6 * polygon.abs()
    }
}

/// Whether the outline comes back to its places more than twice on average, as no outline with holes does.
/// Ear clipping would look for diagonals of such a tangle with the cube of its corners.
fn winds(corners: &[DVec3]) -> bool {
    if corners.len() <= MANY_CORNERS {
        return false;
    }
    let places: HashSet<_> = corners
        .iter()
        .map(|p| p.to_array().map(f64::to_bits))
        .collect();
    corners.len() > 2 * places.len()
}

/// Normal times area of a polygon. Relative to its first corner, so that distance from the origin costs
/// no digits.
pub(super) fn area_vector(corners: &[DVec3]) -> DVec3 {
    let Some(&first) = corners.first() else {
        return DVec3::ZERO;
    };
    let doubled: DVec3 = corners
        .windows(2)
        .map(|edge| (edge[0] - first).cross(edge[1] - first))
        .sum();
    doubled * 0.5
}

/// Two triangles of a quad, warped ones too, and whether one of the diagonals lies inside.
fn split_quad(q: [DVec3; 4], normal: DVec3) -> ([[u32; 3]; 2], bool) {
    let along = |[i, j, k]: [u32; 3]| {
        let [a, b, c] = [i, j, k].map(|i| q[i as usize]);
        (b - a).cross(c - a).dot(normal)
    };
    let cuts = [[[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]]];
    let smaller = cuts.map(|[s, t]| along(s).min(along(t)));
    // A cut that leaves next to nothing on one side runs along an edge.
    let least = 1e-4 * normal.length_squared();
    let inside = smaller.map(|area| area > least);
    let first = match inside {
        [true, false] => true,
        [false, true] => false,
        [false, false] => smaller[0] >= smaller[1],
        // The bias makes grids of rectangles look alike in spite of rounding.
        [true, true] => {
            (q[2] - q[0]).length_squared() <= (q[3] - q[1]).length_squared() * (1.0 + 1e-9)
        }
    };
    (cuts[usize::from(!first)], inside.contains(&true))
}

/// Twice the area of two triangles in space.
fn doubled_area(corners: &[DVec3], triangles: [[u32; 3]; 2]) -> f64 {
    let area = |t: [u32; 3]| {
        let [a, b, c] = t.map(|i| corners[i as usize]);
        (b - a).cross(c - a).length()
    };
    triangles.into_iter().map(area).sum()
}

/// Twice the signed area of a triangle of flat points.
fn area2(flat: &[[f64; 2]], triangle: [u32; 3]) -> f64 {
    let [a, b, c] = triangle.map(|i| flat[i as usize]);
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Whether a fan around the first corner covers the counter-clockwise polygon, without straight corners:
/// every corner turns left, and every triangle of the fan as well (or a pentagram would pass).
fn is_convex(flat: &[[f64; 2]]) -> bool {
    let n = flat.len();
    let turns_left = |i: usize| {
        let [a, b, c] = [flat[i], flat[(i + 1) % n], flat[(i + 2) % n]];
        let (e, f) = ([b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]);
        let lengths = e[0].hypot(e[1]) * f[0].hypot(f[1]);
        e[0] * f[1] - e[1] * f[0] > STRAIGHT * lengths
    };
    (0..n).all(turns_left) && (2..n as u32).all(|i| area2(flat, [0, i - 1, i]) > 0.0)
}

#[cfg(test)]
mod tests;
