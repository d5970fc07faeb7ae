//! [`FlatPrism::clip`] for many rays, one in each vector lane: the same bits.

use super::flat::{FlatPrism, OVERLAP, ROUNDING};
use super::prism_lanes::{PrismLanes, RayRows, dot};
use super::trace::Jobs;
use crate::geometry::Ray;
use crate::math::rows::{MAX_LANES, Row, load, store};
use crate::math::simd::{Kernel, Select as _, Simd, SimdBase as _, SimdLevel, SimdMask as _};
use crate::surface::mapping::relief::{ReliefRay, Side};

/// The parts within a flat relief of those of `rays` whose numbers are in `which`, each ray before its end, that must be
/// walked; those that end before they start have none.
pub fn clip_all(
    level: SimdLevel,
    prism: &FlatPrism<'_, '_>,
    (rays, ends): (&[Ray], &[f32]),
    which: &[u32],
    jobs: &mut Jobs<'_>,
) {
    if level == SimdLevel::Scalar {
        for &i in which {
            let i = i as usize;
            match prism.clip(&rays[i], f64::from(ends[i])) {
                None => {}
                Some((part, _)) if prism.field.is_clear_along(&part) => jobs.spare(1),
                Some((part, from)) => jobs.take(i, part, from),
            }
        }
        return;
    }
    level.run_or_plain(ClipAll {
        prism,
        rays,
        ends,
        which,
        jobs,
    });
}

struct ClipAll<'a, 'j> {
    prism: &'a FlatPrism<'a, 'a>,
    rays: &'a [Ray],
    ends: &'a [f32],
    which: &'a [u32],
    jobs: &'a mut Jobs<'j>,
}

impl Kernel for ClipAll<'_, '_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let prism = PrismLanes::<S>::new(simd, self.prism);
        for which in self.which.chunks(S::f64s::LEN) {
            let mut rays = RayRows::NONE;
            for (lane, &i) in which.iter().enumerate() {
                let i = i as usize;
                rays.put(lane, &self.rays[i], f64::from(self.ends[i]));
            }
            let mut parts = prism.clip(simd, &rays);
            self.jobs.spare(parts.clear.count_ones());
            while parts.within != 0 {
                let lane = parts.within.trailing_zeros() as usize % MAX_LANES;
                parts.within &= parts.within - 1;
                let part = ReliefRay {
                    start: [parts.start[0][lane], parts.start[1][lane]],
                    rate: [parts.rate[0][lane], parts.rate[1][lane]],
                    z: parts.z[0][lane],
                    z_rate: parts.z[1][lane],
                    end: parts.len[lane],
                    side: if parts.above >> lane & 1 != 0 {
                        Side::Above
                    } else {
                        Side::Below
                    },
                };
                self.jobs.take(which[lane] as usize, part, parts.from[lane]);
            }
        }
    }
}

/// The parts of rays within a relief.
struct Parts {
    /// Lanes with such a part, as bits.
    within: u64,
    /// Lanes whose part a horizon clears.
    clear: u64,
    /// Lanes where it begins above the relief.
    above: u64,
    from: Row,
    len: Row,
    start: [Row; 2],
    rate: [Row; 2],
    /// Displacement where it begins, and its change.
    z: [Row; 2],
}

impl<S: Simd> PrismLanes<'_, S> {
    /// Every operation of [`FlatPrism::clip`].
    #[inline(always)]
    fn clip(&self, simd: S, rays: &RayRows) -> Parts {
        let zero = S::f64s::splat(simd, 0.0);
        let (way, dir) = (self.way_to(rays.origin(simd)), rays.dir(simd));
        let rounding = {
            let ([x, y, z], [rx, ry, rz]) = (way, self.rows[2]);
            dot::<S>([rx.abs(), ry.abs(), rz.abs()], [x.abs(), y.abs(), z.abs()]) * ROUNDING
        };
        let [row1, row2, row3] = self.rows;
        let (b1, b2, z) = (
            dot::<S>(row1, way),
            dot::<S>(row2, way),
            dot::<S>(row3, way),
        );
        let (r1, r2, rz) = (
            dot::<S>(row1, dir),
            dot::<S>(row2, dir),
            dot::<S>(row3, dir),
        );
        let [low, high] = self.prism.field.range();
        let flat_margin = (high - low) * 1e-6 + (high.abs() + low.abs()) * 1e-12;
        let margin = rounding + flat_margin;
        let mut cut = Cut::<S> {
            from: zero,
            to: load(simd, &rays.end),
            within: zero.simd_eq(zero),
        };
        for side in self.prism.sides {
            let [x, y] = side.ways;
            let value = b1 * x + (side.at + OVERLAP) + b2 * y;
            cut.at(simd, value, r1 * x + r2 * y);
        }
        cut.at(simd, (margin + high) - z, -rz);
        cut.at(simd, z - low + margin, rz);
        let Cut { from, to, within } = cut;
        let within = within & from.simd_le(to) & to.simd_lt(f64::INFINITY);
        let start = self.texels(b1 + r1 * from, b2 + r2 * from);
        let [_, t1, t2] = self.texels;
        let rate = [t1[0] * r1 + t2[0] * r2, t1[1] * r1 + t2[1] * r2];
        let z = z + rz * from;
        let mut above = z.simd_ge(high);
        let inside = z.simd_gt(low) & !above;
        if (inside & within).any_true() {
            let relief = self.prism.field.displacements(simd, start);
            above |= inside & z.simd_ge(relief);
        }
        let mut clear = within & above & rz.simd_gt(0.0);
        if clear.any_true() {
            clear &= self.prism.field.are_clear(simd, start, rate, rz);
        }
        Parts {
            within: (within & !clear).to_bitmask(),
            clear: clear.to_bitmask(),
            above: above.to_bitmask(),
            from: store::<S>(from),
            len: store::<S>(to - from),
            start: [store::<S>(start[0]), store::<S>(start[1])],
            rate: [store::<S>(rate[0]), store::<S>(rate[1])],
            z: [store::<S>(z), store::<S>(rz)],
        }
    }
}

/// What is left of rays.
struct Cut<S: Simd> {
    from: S::f64s,
    to: S::f64s,
    within: S::mask64s,
}

impl<S: Simd> Cut<S> {
    /// Cuts off what lies where a value that grows at this rate is less than 0.
    #[inline(always)]
    fn at(&mut self, simd: S, value: S::f64s, rate: S::f64s) {
        let zero = S::f64s::splat(simd, 0.0);
        let at = -value / rate;
        let (grows, shrinks) = (rate.simd_gt(zero), rate.simd_lt(zero));
        self.from = (grows & at.simd_gt(self.from)).select(at, self.from);
        self.to = (shrinks & at.simd_lt(self.to)).select(at, self.to);
        self.within &= grows | shrinks | value.simd_ge(zero);
    }
}
