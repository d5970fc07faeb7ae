//! What [`ReliefField`] says of one place, for a place in each vector lane: the same bits.

use super::field::ReliefField;
use super::lane_axis::LaneAxis;
use super::ray::FARTHEST;
use super::walk_lanes::{LaneRelief, Stored};
use crate::math::simd::{Select as _, Simd, SimdBase as _, SimdFloat as _};
use crate::texture::{StoredHeights, Wrap};

/// Displacements at the corners of cells, and where in them places are.
struct Patches<S: Simd> {
    corners: [S::f64s; 4],
    fx: S::f64s,
    fy: S::f64s,
}

impl<S: Simd> Patches<S> {
    /// Around places of a map that repeats.
    #[inline(always)]
    fn around<T: Stored>(simd: S, relief: &LaneRelief<'_, S, T>, [x, y]: [S::f64s; 2]) -> Self {
        let (x, y) = (
            LaneAxis::at_rest(simd, relief.n[0], x),
            LaneAxis::at_rest(simd, relief.n[1], y),
        );
        let (zero, one) = (S::f64s::splat(simd, 0.0), S::f64s::splat(simd, 1.0));
        Self {
            corners: relief.displacements(simd, one, [x.cell(), y.cell()]),
            fx: x.fraction(zero),
            fy: y.fraction(zero),
        }
    }
}

impl ReliefField<'_> {
    /// The patches around places in texels; `None` where the map does not repeat.
    #[inline(always)]
    fn patches<S: Simd>(&self, simd: S, places: [S::f64s; 2]) -> Option<Patches<S>> {
        if self.height.addressing.wrap != Wrap::Repeat {
            return None;
        }
        Some(match self.stored {
            StoredHeights::U16(all) => {
                let relief = LaneRelief::new(simd, &self.with(all));
                Patches::around(simd, &relief, places)
            }
            StoredHeights::F32(all) => {
                let relief = LaneRelief::new(simd, &self.with(all));
                Patches::around(simd, &relief, places)
            }
        })
    }

    /// [`Self::displacement`] in each lane.
    #[inline(always)]
    #[must_use]
    pub fn displacements<S: Simd>(&self, simd: S, places: [S::f64s; 2]) -> S::f64s {
        let zero = S::f64s::splat(simd, 0.0);
        let (near, places) = near(simd, places);
        let found = match self.patches(simd, places) {
            Some(Patches { corners, fx, fy }) => {
                let [a, b, c, d] = corners;
                a + (b - a) * fx + (c - a) * fy + (a - b - c + d) * fx * fy
            }
            None => {
                let mut found = zero;
                for lane in 0..S::f64s::LEN {
                    found[lane] = self.displacement([places[0][lane], places[1][lane]]);
                }
                found
            }
        };
        near.select(found, zero)
    }

    /// [`Self::slope`] in each lane.
    #[inline(always)]
    #[must_use]
    pub fn slopes<S: Simd>(&self, simd: S, places: [S::f64s; 2]) -> [S::f64s; 2] {
        let zero = S::f64s::splat(simd, 0.0);
        let (near, places) = near(simd, places);
        let [x, y] = match self.patches(simd, places) {
            Some(Patches { corners, fx, fy }) => {
                let [a, b, c, d] = corners;
                let twist = a - b - c + d;
                [b - a + twist * fy, c - a + twist * fx]
            }
            None => {
                let mut found = [zero; 2];
                for lane in 0..S::f64s::LEN {
                    let slope = self.slope([places[0][lane], places[1][lane]]);
                    (found[0][lane], found[1][lane]) = (slope[0], slope[1]);
                }
                found
            }
        };
        [near.select(x, zero), near.select(y, zero)]
    }

    /// [`Self::is_clear_along`] in each lane, for rays that start above the relief: `rate` and `z_rate` are the changes
    /// of place and displacement along each.
    #[inline(always)]
    #[must_use]
    pub fn are_clear<S: Simd>(
        &self,
        simd: S,
        start: [S::f64s; 2],
        rate: [S::f64s; 2],
        z_rate: S::f64s,
    ) -> S::mask64s {
        let zero = S::f64s::splat(simd, 0.0);
        let Some(horizons) = self.horizons else {
            return zero.simd_lt(zero);
        };
        let (near, start) = near(simd, start);
        let n = self.size().map(|n| S::f64s::splat(simd, f64::from(n)));
        let (x, y) = (
            LaneAxis::at_rest(simd, n[0], start[0]),
            LaneAxis::at_rest(simd, n[1], start[1]),
        );
        let slope = horizons.slopes(simd, [x.cell(), y.cell()], rate);
        let [rx, ry] = rate;
        let [low, high] = self.range();
        let needed = slope * (rx * rx + ry * ry).sqrt() * (high - low);
        near & z_rate.simd_gt(zero) & needed.simd_le(z_rate)
    }
}

/// Where cells can be told apart, and the places there; 0 elsewhere.
#[inline(always)]
fn near<S: Simd>(simd: S, [x, y]: [S::f64s; 2]) -> (S::mask64s, [S::f64s; 2]) {
    let zero = S::f64s::splat(simd, 0.0);
    let near = x.abs().simd_lt(FARTHEST) & y.abs().simd_lt(FARTHEST);
    (near, [near.select(x, zero), near.select(y, zero)])
}
