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
    /// What `n` differs from `N` by in each axis: at the piece's first corner, and its change to the others.
    lean: [[f32; 3]; AXES],
}

impl LocalFrame {
    /// `p` and `n` are the piece's corners and the displacement normals there.
    pub fn new([p0, p1, p2]: [DVec3; 3], [n0, n1, n2]: [DVec3; 3]) -> Self {
        let middle = (n0 + n1 + n2) / 3.0;
        let to_local = DMat3::from_cols(p1 - p0, p2 - p0, middle).inverse();
        let (a, b, z) = (to_local.row(0), to_local.row(1), to_local.row(2));
        let rows = [a, b, a + b, z];
        let lean = |row: DVec3| {
            let (l0, l1, l2) = (
                row.dot(n0 - middle),
                row.dot(n1 - middle),
                row.dot(n2 - middle),
            );
            [l0 as f32, (l1 - l0) as f32, (l2 - l0) as f32]
        };
        let size = |row: DVec3| row.abs().element_sum();
        Self {
            p0,
            sizes: [size(a), size(b), size(a + b), size(z)],
            lean: [lean(a), lean(b), lean(a + b), lean(z)],
            rows,
        }
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
            local.margin[axis] = (32.0 * HALF_ULP * (size + from.abs() + 1.0)) as f32;
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
    /// `t_max`. Parts are given by anchor and signed size as shares of the piece's edges.
    #[inline(always)]
    pub fn meets<F: Real>(
        &self,
        [a, b, s]: [F; 3],
        [low, high]: [F; 2],
        t_max: f32,
    ) -> (F, F::Mask) {
        let zero = a.splat(0.0);
        let mut first = zero.splat(-self.t0);
        let mut last = zero.splat(t_max - self.t0);
        let sum = a + b;
        for axis in 0..AXES {
            let anchor = match axis {
                0 => a,
                1 => b,
                2 => sum,
                _ => zero,
            };
            let [l0, l1, l2] = self.lean[axis];
            let lean = a * l1 + b * l2 + l0;
            let (x, y) = (s * l1, s * l2);
            let least = lean + x.smaller(y).smaller(zero);
            let most = lean + x.larger(y).larger(zero);
            // In the last axis displacement itself comes to that.
            let (least, most, size) = if axis == 3 {
                (least + 1.0, most + 1.0, zero)
            } else {
                (least, most, s)
            };
            let (p, q) = (low * least, low * most);
            let (r, t) = (high * least, high * most);
            let down = p.smaller(q).smaller(r.smaller(t)) + size.smaller(zero);
            let up = p.larger(q).larger(r.larger(t)) + size.larger(zero);
            let (from, margin) = (self.from[axis], self.margin[axis]);
            let down = (anchor + down - margin - from) * self.inv_rate[axis];
            let up = (anchor + up + margin - from) * self.inv_rate[axis];
            // NaN changes nothing: `larger` and `smaller` give the second then.
            first = down.smaller(up).larger(first);
            last = down.larger(up).smaller(last);
        }
        (first + self.t0, first.gt(last))
    }
}
