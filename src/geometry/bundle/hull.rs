//! An interval around all rays of a bundle.

use super::{Bundle, lanes_of};
use crate::geometry::slabs::PADDING;
use crate::geometry::triangle::LANES;
use crate::math::simd::{Select, Simd, SimdBase, SimdMask, f32x8};

/// Lower and upper planes of eight boxes, `[lower, upper][axis]`.
pub(in crate::geometry) type Boxes<S> = [[f32x8<S>; 3]; 2];

/// How the rays run along one axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Course {
    /// All towards larger coordinates: they enter by the lower plane.
    Forward,
    /// All towards smaller coordinates.
    Backward,
    /// Some each way. Then where they leave is not bounded.
    Mixed,
}

/// The slab tests of all rays of a bundle at once, in interval arithmetic: on each axis
/// `t = (plane − shift)·inv`, with whichever origin and reciprocal direction makes it extreme.
///
/// For each ray and box, the interval contains the part above 0 of
/// [`RaySlabs::interval`](crate::geometry::RaySlabs::interval), with its rounding: that is off from
/// the exact interval of the padded box by less than `4uS/|d|`, and the arithmetic here by less than
/// `5uS/|d|`. Twice the padding, `32uS` instead of `16uS`, is more than the sum.
///
/// Rays that converge are taken from their ends, backwards: the hull of origins and directions would grow
/// where they come together. Distances then count from the end. An end is off its ray by less than `4uS`, `S`
/// counted from the farther of origin and end, which the padding has room for, too.
#[derive(Debug, Clone, Copy)]
pub(in crate::geometry) struct Hull {
    /// For the lower and the upper plane of each axis.
    shift: [[f32; 3]; 2],
    inv: [[f32; 3]; 2],
    course: [Course; 3],
    /// The one origin of all rays, if they have one.
    pub(in crate::geometry) common_origin: Option<[f32; 3]>,
}

impl Hull {
    /// Which of eight boxes any ray may meet in `[0, limit]`, as bits, and the first distance at which.
    #[expect(clippy::needless_range_loop, reason = "five arrays share the index")]
    #[inline(always)]
    pub(in crate::geometry) fn hit_lanes<S: Simd>(
        &self,
        simd: S,
        boxes: &Boxes<S>,
        limit: f32,
    ) -> (u32, [f32; LANES]) {
        let mut near = f32x8::splat(simd, 0.0);
        let mut far = f32x8::splat(simd, limit);
        for axis in 0..3 {
            let lower = (boxes[0][axis] - self.shift[0][axis]) * self.inv[0][axis];
            let upper = (boxes[1][axis] - self.shift[1][axis]) * self.inv[1][axis];
            match self.course[axis] {
                Course::Forward => {
                    near = near.max(lower);
                    far = far.min(upper);
                }
                Course::Backward => {
                    near = near.max(upper);
                    far = far.min(lower);
                }
                Course::Mixed => near = near.max(lower).max(upper),
            }
        }
        (near.simd_le(far).to_bitmask() as u32, near.to_array())
    }
}

/// Smallest and largest origin and reciprocal direction so far, lane by lane.
pub(super) struct Extremes<S: Simd> {
    origin: [[S::f32s; 3]; 2],
    inv_dir: [[S::f32s; 3]; 2],
    /// Largest magnitude of other coordinates.
    farthest: S::f32s,
}

impl<S: Simd> Extremes<S> {
    #[inline(always)]
    pub(super) fn new(simd: S) -> Self {
        let least = [S::f32s::splat(simd, f32::INFINITY); 3];
        let most = [S::f32s::splat(simd, f32::NEG_INFINITY); 3];
        Self {
            origin: [least, most],
            inv_dir: [least, most],
            farthest: S::f32s::splat(simd, 0.0),
        }
    }

    /// Lets the padding reach as far as the points in `lanes`.
    #[inline(always)]
    pub(super) fn reach(&mut self, lanes: S::mask32s, [x, y, z]: [S::f32s; 3]) {
        let far = self.farthest.max(x.abs()).max(y.abs()).max(z.abs());
        self.farthest = lanes.select(far, self.farthest);
    }

    /// Adds those rays of a group that are in `lanes`.
    #[inline(always)]
    pub(super) fn add(&mut self, lanes: S::mask32s, origin: [S::f32s; 3], inv_dir: [S::f32s; 3]) {
        for (extremes, x) in [(&mut self.origin, origin), (&mut self.inv_dir, inv_dir)] {
            for axis in 0..3 {
                let [least, most] = [extremes[0][axis], extremes[1][axis]];
                extremes[0][axis] = lanes.select(least.min(x[axis]), least);
                extremes[1][axis] = lanes.select(most.max(x[axis]), most);
            }
        }
    }

    /// The hull of all rays added, which are the active ones of `bundle`.
    #[inline(always)]
    pub(super) fn hull(&self, simd: S, bundle: &Bundle, reach: f32) -> Hull {
        let [least, most] = least_and_most::<S>(&self.origin);
        let [mut inv_least, mut inv_most] = least_and_most::<S>(&self.inv_dir);
        let farthest = self.farthest.reduce_max();
        let farthest = (0..3).fold(farthest, |far, i| far.max(-least[i]).max(most[i]));
        let padding = 2.0 * PADDING * (reach + farthest);
        let mut course = [Course::Mixed; 3];
        for axis in 0..3 {
            course[axis] = if inv_least[axis] > 0.0 {
                Course::Forward
            } else if inv_most[axis] < 0.0 {
                Course::Backward
            } else {
                // Only those that run away from the box matter to where it is entered.
                (inv_most[axis], inv_least[axis]) = closest_to_zero(simd, bundle, axis);
                Course::Mixed
            };
        }
        Hull {
            shift: [most.map(|o| o + padding), least.map(|o| o - padding)],
            inv: [inv_least, inv_most],
            course,
            common_origin: (least == most && !bundle.converge).then_some(least),
        }
    }
}

/// Smallest and largest lane on each axis.
#[inline(always)]
fn least_and_most<S: Simd>([least, most]: &[[S::f32s; 3]; 2]) -> [[f32; 3]; 2] {
    [
        [
            least[0].reduce_min(),
            least[1].reduce_min(),
            least[2].reduce_min(),
        ],
        [
            most[0].reduce_max(),
            most[1].reduce_max(),
            most[2].reduce_max(),
        ],
    ]
}

/// The largest of the negative and the smallest of the positive reciprocals on an axis.
#[inline(always)]
fn closest_to_zero<S: Simd>(simd: S, bundle: &Bundle, axis: usize) -> (f32, f32) {
    let zero = S::f32s::splat(simd, 0.0);
    let lowest = S::f32s::splat(simd, f32::MIN);
    let (mut below, mut above) = (lowest, -lowest);
    for group in bundle.groups::<S>() {
        let inv = bundle.inv_dir[axis].load(simd, group);
        let inv = if bundle.converge { -inv } else { inv };
        let lanes = lanes_of(simd, bundle.active, group);
        below = (lanes & inv.simd_lt(zero)).select(below.max(inv), below);
        above = (lanes & inv.simd_gt(zero)).select(above.min(inv), above);
    }
    (below.reduce_max(), above.reduce_min())
}
