//! A ray in the coordinates of a piece: shares of the ways to its corners, and the displacement.
//!
//! With the piece's corners `P0`, `P1`, `P2` and its middle displacement normal `N`, the point `S = p + d·n` is
//! `P0 + a·(P1 − P0) + b·(P2 − P0) + z·N` with `z` next to `d` and `(a, b)` next to its place in the piece: they differ
//! by `d` times what `n` differs from `N` by, which is linear over the piece. So a part with displacements in
//! `[low, high]` has bounds that are as thin as its relief, however the piece lies in space, and the ray is straight
//! here, too.

use glam::{DMat3, DVec3};

use super::fine::FineRay;
use crate::math::Real;

/// Half of what a float rounds by.
const HALF_ULP: f64 = 0.5 * f32::EPSILON as f64;

/// Coordinates that a ray is tested in: `a`, `b`, `a + b` and `z`.
const AXES: usize = 4;

/// Beyond this nothing can be said about a piece: its normals lie in its plane, or it has no area.
const FAR: f64 = 1e12;

/// The coordinates of a piece.
#[derive(Debug, Clone, Copy)]
pub struct LocalFrame {
    /// The piece's first corner.
    p0: DVec3,
    /// What each coordinate changes by along the axes of space, and the sum of the magnitudes.
    rows: [DVec3; AXES],
    sizes: [f64; AXES],
    /// What displacement moves a point by in each axis, per unit: at the piece's first corner, and its change to the
    /// others. In the last axis it is displacement itself and a little.
    lean: [[f32; 3]; AXES],
    /// The most that displacement moves points of the piece by.
    moved: [f64; AXES],
}

impl LocalFrame {
    /// `p` and `n` are the piece's corners and the displacement normals there, `most` is the largest magnitude of its
    /// displacements.
    pub fn new([p0, p1, p2]: [DVec3; 3], [n0, n1, n2]: [DVec3; 3], most: f32) -> Self {
        let middle = (n0 + n1 + n2) / 3.0;
        let to_local = DMat3::from_cols(p1 - p0, p2 - p0, middle).inverse();
        let (a, b, z) = (to_local.row(0), to_local.row(1), to_local.row(2));
        let rows = [a, b, a + b, z];
        // Next to nothing along the piece, next to 1 along its normal.
        let mut frame = Self {
            p0,
            rows,
            sizes: [0.0; AXES],
            lean: [[0.0; 3]; AXES],
            moved: [0.0; AXES],
        };
        for (axis, row) in rows.into_iter().enumerate() {
            let all = if axis == AXES - 1 { 1.0 } else { 0.0 };
            let l0 = row.dot(n0 - middle) + all;
            let l1 = row.dot(n1 - middle) + all;
            let l2 = row.dot(n2 - middle) + all;
            frame.sizes[axis] = row.abs().element_sum();
            frame.lean[axis] = [l0 as f32, (l1 - l0) as f32, (l2 - l0) as f32];
            frame.moved[axis] = (l0.abs() + l1.abs() + l2.abs()) * f64::from(most);
        }
        frame
    }
}

/// A ray over one piece. Distances are those in space.
#[derive(Debug, Clone, Copy)]
pub struct LocalRay {
    /// Distance at which it starts here, near the piece.
    t0: f32,
    /// Where it is then, and the inverse of its change per distance. NaN in axes of which nothing is known.
    from: [f32; AXES],
    inv_rate: [f32; AXES],
    /// What rounding may move a point by, here and where micro-triangles are made and tested.
    margin: [f32; AXES],
    /// See [`LocalFrame`].
    lean: [[f32; 3]; AXES],
}

impl LocalRay {
    /// The ray in the coordinates of a piece.
    pub fn new(ray: &FineRay, frame: &LocalFrame) -> Self {
        let (origin, dir) = (ray.ray.origin.as_dvec3(), ray.ray.dir.as_dvec3());
        let t0 = ((frame.p0 - origin).dot(dir) as f32).max(0.0);
        let start = origin + dir * f64::from(t0) - frame.p0;
        let reach = f64::from(ray.reach);
        let mut local = Self {
            t0,
            from: [f32::NAN; AXES],
            inv_rate: [f32::NAN; AXES],
            margin: [0.0; AXES],
            lean: [[0.0; 3]; AXES],
        };
        for axis in 0..AXES {
            let row = frame.rows[axis];
            let (from, rate) = (row.dot(start), row.dot(dir));
            let size = frame.sizes[axis] * reach;
            // Not for NaN either.
            if !(size < FAR && from.abs() < FAR) {
                continue;
            }
            // As in `RaySlabs`; what is rounded here is small beside it.
            let largest = size + from.abs() + frame.moved[axis] + 1.0;
            local.margin[axis] = (32.0 * HALF_ULP * largest) as f32;
            local.from[axis] = from as f32;
            // A little off where the ray does not change: it goes by in no distance that can be. A share of what the
            // rate can be at all, or large pieces, along which everything changes slowly, would be taken for such.
            let least = 1e-9 * frame.sizes[axis];
            let rate = if rate.abs() < least {
                least.copysign(rate)
            } else {
                rate
            };
            local.inv_rate[axis] = (1.0 / rate) as f32;
            local.lean[axis] = frame.lean[axis];
        }
        local
    }

    /// Where the ray enters the bounds of parts with displacements in a range, and whether it misses them before
    /// `t_max`. Parts are given by anchor and signed size as shares of the piece's edges; `size` is the magnitude of
    /// all of these.
    #[inline(always)]
    pub fn meets<F: Real>(
        &self,
        ([a, b, s], size): ([F; 3], f32),
        [low, high]: [F; 2],
        t_max: f32,
    ) -> (F, F::Mask) {
        let zero = a.splat(0.0);
        let mut first = zero.splat(-self.t0);
        let mut last = zero.splat(t_max - self.t0);
        // Displacements by their middle, and by how far they are from it and from 0 at the most.
        let middle = (low + high) * 0.5;
        let spread = (high - low) * 0.5;
        let most = middle.abs() + spread;
        let half = s * 0.5;
        let (a_middle, b_middle) = (a + half, b + half);
        let sum_middle = a_middle + b;
        for axis in 0..AXES {
            let (place, half_size) = match axis {
                0 => (a_middle, 0.5 * size),
                1 => (b_middle, 0.5 * size),
                2 => (sum_middle, 0.5 * size),
                _ => (zero, 0.0),
            };
            let [l0, l1, l2] = self.lean[axis];
            let lean = a * l1 + b * l2 + l0;
            let lean_spread = size * l1.abs().max(l2.abs());
            let centre = lean * middle + (place - self.from[axis]);
            let reach =
                lean.abs() * spread + (most * lean_spread + (half_size + self.margin[axis]));
            let to_centre = centre * self.inv_rate[axis];
            let across = reach * self.inv_rate[axis].abs();
            // NaN changes nothing: `larger` and `smaller` give the second then.
            first = (to_centre - across).larger(first);
            last = (to_centre + across).smaller(last);
        }
        (first + self.t0, first.gt(last))
    }
}
