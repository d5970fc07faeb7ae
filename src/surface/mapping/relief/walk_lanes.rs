//! Many exact walks in step, one in each vector lane: the twin of `walk`, with the same bits.
//!
//! A walk takes about ten steps and no two take the same turns, so that one after the other they mostly
//! wait for mispredicted branches. In lanes every step does what any walk may need, under masks. A lane
//! whose walk is over takes the next ray from the list.

use super::axis::Axis;
use super::walk::{ReliefRay, Typed, Walk, start_level};
use crate::math::simd::{
    ExtractToken as _, Kernel, Select as _, Simd, SimdBase as _, SimdFloat as _, SimdLevel,
    SimdMask as _,
};
use crate::texture::Wrap;

/// Most doubles that a vector of any machine has.
const MAX_LANES: usize = 8;

/// A double for each lane, in memory.
type Row = [f64; MAX_LANES];

/// Walks all rays.
pub(super) fn walk_all<T: Copy + Into<f64>>(
    relief: &Typed<'_, T>,
    level: SimdLevel,
    rays: &[ReliefRay],
    walks: &mut [Walk],
) {
    // Other wraps ask for up to four nodes a step, and are rare.
    if level == SimdLevel::Scalar || relief.wrap != Wrap::Repeat {
        for (ray, walk) in rays.iter().zip(walks) {
            *walk = if ray.is_near() {
                relief.walk(ray)
            } else {
                Walk::NONE
            };
        }
        return;
    }
    level.run_or_plain(WalkAll {
        relief,
        rays,
        walks,
    });
}

struct WalkAll<'a, T> {
    relief: &'a Typed<'a, T>,
    rays: &'a [ReliefRay],
    walks: &'a mut [Walk],
}

impl<T: Copy + Into<f64>> Kernel for WalkAll<'_, T> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let width = S::f64s::LEN;
        let all = u64::MAX >> (64 - width);
        let mut lanes = Lanes::idle(simd);
        let mut jobs = [0_usize; MAX_LANES];
        let (mut next, mut busy) = (0, 0_u64);
        loop {
            // Taking rays on costs as much as a step: not for every single lane.
            let free = (all & !busy).count_ones() as usize;
            if next < self.rays.len() && 4 * free >= width {
                let mut seeds = Seeds::NONE;
                let mut taken = 0;
                for (lane, job) in jobs.iter_mut().enumerate().take(width) {
                    if busy >> lane & 1 != 0 {
                        continue;
                    }
                    while let Some(ray) = self.rays.get(next) {
                        next += 1;
                        if ray.is_near() {
                            seeds.put(lane, self.relief, ray);
                            *job = next - 1;
                            taken |= 1 << lane;
                            break;
                        }
                        self.walks[next - 1] = Walk::NONE;
                    }
                }
                lanes.take(simd, taken, &seeds);
                busy |= taken;
            }
            if busy == 0 {
                return;
            }
            let done = lanes.step(simd, self.relief, busy);
            let mut ended = done.ended & busy;
            busy &= !ended;
            while ended != 0 {
                let lane = ended.trailing_zeros() as usize % MAX_LANES;
                ended &= ended - 1;
                self.walks[jobs[lane]] = Walk {
                    at: (done.found >> lane & 1 != 0).then(|| done.at[lane]),
                    steps: done.steps[lane] as u32,
                    capped: done.capped >> lane & 1 != 0,
                };
            }
        }
    }
}

/// What lanes that take rays on start with.
struct Seeds {
    axes: [[Row; 5]; 2],
    line: [Row; 2],
    inv_sinking: Row,
    sign: Row,
    end: Row,
    size: Row,
    cap: Row,
}

impl Seeds {
    const NONE: Self = Self {
        axes: [[[0.0; MAX_LANES]; 5]; 2],
        line: [[0.0; MAX_LANES]; 2],
        inv_sinking: [1.0; MAX_LANES],
        sign: [1.0; MAX_LANES],
        end: [0.0; MAX_LANES],
        size: [1.0; MAX_LANES],
        cap: [0.0; MAX_LANES],
    };

    #[inline(always)]
    fn put<T: Copy + Into<f64>>(&mut self, lane: usize, relief: &Typed<'_, T>, ray: &ReliefRay) {
        for k in 0..2 {
            let parts = Axis::new(relief.size[k], ray.start[k], ray.rate[k]).parts();
            for (row, part) in self.axes[k].iter_mut().zip(parts) {
                row[lane] = part;
            }
        }
        self.sign[lane] = ray.side.sign();
        self.line[0][lane] = ray.z * ray.side.sign();
        self.line[1][lane] = ray.z_rate * ray.side.sign();
        self.inv_sinking[lane] = 1.0 / -self.line[1][lane];
        self.end[lane] = ray.end;
        self.size[lane] = f64::from(1 << start_level(ray, relief.top()));
        self.cap[lane] = f64::from(relief.step_cap(ray));
    }
}

/// What a step came to: bits for lanes.
struct Done {
    ended: u64,
    found: u64,
    capped: u64,
    at: Row,
    steps: Row,
}

/// [`Axis`] in lanes; cells are whole numbers in doubles.
#[derive(Clone, Copy)]
struct LaneAxis<S: Simd> {
    n: S::f64s,
    start: S::f64s,
    rate: S::f64s,
    inv_rate: S::f64s,
    base: S::f64s,
    local: S::f64s,
}

/// The square along one axis: first cell and the one after the last.
#[derive(Clone, Copy)]
struct LaneSpan<S: Simd> {
    /// Number of the square.
    square: S::f64s,
    first: S::f64s,
    end: S::f64s,
}

impl<S: Simd> LaneAxis<S> {
    #[inline(always)]
    fn take(&mut self, simd: S, taken: S::mask64s, parts: &[Row; 5]) {
        self.start = taken.select(load(simd, &parts[0]), self.start);
        self.rate = taken.select(load(simd, &parts[1]), self.rate);
        self.inv_rate = taken.select(load(simd, &parts[2]), self.inv_rate);
        self.base = taken.select(load(simd, &parts[3]), self.base);
        self.local = taken.select(load(simd, &parts[4]), self.local);
    }

    #[inline(always)]
    fn forward(&self) -> S::mask64s {
        self.rate.simd_ge(0.0)
    }

    #[inline(always)]
    fn at(&self, tau: S::f64s) -> S::f64s {
        self.start + self.rate * tau
    }

    #[inline(always)]
    fn fraction(&self, tau: S::f64s) -> S::f64s {
        let inside = self.at(tau) - (self.base + self.local);
        inside.max(0.0).min(1.0)
    }

    /// `size` is the side of a square, `inv` one over it.
    #[inline(always)]
    fn span(&self, size: S::f64s, inv: S::f64s) -> LaneSpan<S> {
        let square = (self.local * inv).floor();
        let first = square * size;
        LaneSpan {
            square,
            first,
            end: (first + size).min(self.n),
        }
    }

    #[inline(always)]
    fn exit(&self, span: LaneSpan<S>) -> S::f64s {
        let forward = self.base + span.end - self.start;
        let backward = self.start - (self.base + span.first);
        self.forward().select(forward, backward) * self.inv_rate
    }

    /// Where the lanes of `mask` cross into the cell beyond the span; returns those among them whose
    /// square of the next level is another one.
    #[inline(always)]
    fn cross(&mut self, span: LaneSpan<S>, inv: S::f64s, mask: S::mask64s) -> S::mask64s {
        let simd = self.local.token();
        let zero = S::f64s::splat(simd, 0.0);
        let half = inv * 0.5;
        let before = (self.local * half).floor();
        let forward = self.forward();
        let wraps = forward.select(
            (span.end - self.n)
                .simd_eq(0.0)
                .select(S::f64s::splat(simd, 1.0), zero),
            span.first
                .simd_eq(0.0)
                .select(S::f64s::splat(simd, 1.0), zero),
        );
        let wraps = wraps.simd_gt(0.0);
        let stays = forward.select(span.end, span.first - 1.0);
        let wrapped = forward.select(zero, self.n - 1.0);
        let local = wraps.select(wrapped, stays);
        let moved = forward.select(self.base + self.n, self.base - self.n);
        let base = wraps.select(moved, self.base);
        let other = !(local * half).floor().simd_eq(before);
        self.local = mask.select(local, self.local);
        self.base = mask.select(base, self.base);
        mask & (wraps | other)
    }

    /// Takes the cell of the lanes of `mask` from the place, but no other than one of the span.
    #[inline(always)]
    fn settle(&mut self, span: LaneSpan<S>, tau: S::f64s, mask: S::mask64s) {
        let cell = (self.at(tau) - self.base).floor();
        let cell = cell.max(span.first).min(span.end - 1.0);
        self.local = mask.select(cell, self.local);
    }
}

/// Walks in step.
struct Lanes<S: Simd> {
    x: LaneAxis<S>,
    y: LaneAxis<S>,
    /// Displacement at τ = 0 and its change, seen from the side of `sign`.
    line: [S::f64s; 2],
    inv_sinking: S::f64s,
    sign: S::f64s,
    end: S::f64s,
    tau: S::f64s,
    /// Side of the squares of the level, a power of two, and one over it.
    size: S::f64s,
    inv_size: S::f64s,
    steps: S::f64s,
    cap: S::f64s,
}

#[inline(always)]
fn load<S: Simd>(simd: S, row: &Row) -> S::f64s {
    S::f64s::from_slice(simd, &row[..S::f64s::LEN])
}

#[inline(always)]
fn store<S: Simd>(x: S::f64s) -> Row {
    let mut row = [0.0; MAX_LANES];
    x.store_slice(&mut row[..S::f64s::LEN]);
    row
}

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    fn idle(simd: S) -> Self {
        let zero = S::f64s::splat(simd, 0.0);
        let one = S::f64s::splat(simd, 1.0);
        let axis = LaneAxis {
            n: one,
            start: zero,
            rate: zero,
            inv_rate: one,
            base: zero,
            local: zero,
        };
        Self {
            x: axis,
            y: axis,
            line: [zero; 2],
            inv_sinking: one,
            sign: one,
            end: zero,
            tau: zero,
            size: one,
            inv_size: one,
            steps: zero,
            cap: zero,
        }
    }

    #[inline(always)]
    fn take(&mut self, simd: S, taken: u64, seeds: &Seeds) {
        let taken = S::mask64s::from_bitmask(simd, taken);
        self.x.take(simd, taken, &seeds.axes[0]);
        self.y.take(simd, taken, &seeds.axes[1]);
        for k in 0..2 {
            self.line[k] = taken.select(load(simd, &seeds.line[k]), self.line[k]);
        }
        let zero = S::f64s::splat(simd, 0.0);
        self.inv_sinking = taken.select(load(simd, &seeds.inv_sinking), self.inv_sinking);
        self.sign = taken.select(load(simd, &seeds.sign), self.sign);
        self.end = taken.select(load(simd, &seeds.end), self.end);
        self.tau = taken.select(zero, self.tau);
        self.size = taken.select(load(simd, &seeds.size), self.size);
        self.inv_size = S::f64s::splat(simd, 1.0) / self.size;
        self.steps = taken.select(zero, self.steps);
        self.cap = taken.select(load(simd, &seeds.cap), self.cap);
    }

    /// One step of every busy walk: see [`Typed::walk`], whose every operation this repeats.
    #[inline(always)]
    fn step<T: Copy + Into<f64>>(&mut self, simd: S, relief: &Typed<'_, T>, busy: u64) -> Done {
        let zero = S::f64s::splat(simd, 0.0);
        self.x.n = S::f64s::splat(simd, f64::from(relief.size[0]));
        self.y.n = S::f64s::splat(simd, f64::from(relief.size[1]));
        self.steps += 1.0;
        let capped = self.steps.simd_gt(self.cap);
        let inv = self.inv_size;
        let (span_x, span_y) = (self.x.span(self.size, inv), self.y.span(self.size, inv));
        let (exit_x, exit_y) = (self.x.exit(span_x), self.y.exit(span_y));
        let exit = exit_x.min(exit_y).max(self.tau);
        let leave = exit.min(self.end);
        let [z, z_rate] = self.line;
        let lowest = z + z_rate * z_rate.simd_gt(0.0).select(self.tau, leave);
        let high = self.high(simd, relief, (span_x, span_y));

        let enters = lowest.simd_le(high) & !capped;
        let coarse = self.size.simd_gt(1.0);
        let descends = enters & coarse;
        let tests = enters & !coarse;
        let down = (z - high) * self.inv_sinking;
        let sunk = self.tau.max(down.min(leave));
        let tau_before = self.tau;

        // At the finest level: the patch of the cell.
        let mut found = tests;
        let mut at = zero;
        let tests_bits = tests.to_bitmask() & busy;
        if tests_bits != 0 {
            let (meets, after) = self.meet_cell(simd, relief, leave - self.tau, tests_bits);
            found = tests & meets;
            at = self.tau + after;
        } else {
            found = found & !found;
        }

        // Down one level, or on to the next square.
        let advances = !descends;
        let tau = descends.select(z_rate.simd_lt(0.0).select(sunk, tau_before), exit);
        let past_end = advances & exit.simd_ge(self.end);
        self.tau = tau;
        let crosses_x = exit_x.simd_le(exit_y);
        self.x.settle(span_x, tau, descends | !crosses_x);
        self.y.settle(span_y, tau, descends | crosses_x);
        let leaves_x = self.x.cross(span_x, inv, advances & crosses_x);
        let leaves_y = self.y.cross(span_y, inv, advances & !crosses_x);
        let top = S::f64s::splat(simd, f64::from(1_u32 << relief.top()));
        let climbs = (leaves_x | leaves_y) & self.size.simd_lt(top);
        let size = climbs.select(self.size * 2.0, self.size);
        self.size = descends.select(self.size * 0.5, size);
        let inv_size = climbs.select(inv * 0.5, inv);
        self.inv_size = descends.select(inv * 2.0, inv_size);

        let ended = capped | found | past_end;
        Done {
            ended: ended.to_bitmask(),
            found: found.to_bitmask(),
            capped: capped.to_bitmask(),
            at: store::<S>(at),
            steps: store::<S>(self.steps),
        }
    }

    /// The largest displacement over the squares of the lanes.
    #[inline(always)]
    fn high<T: Copy + Into<f64>>(
        &self,
        simd: S,
        relief: &Typed<'_, T>,
        (span_x, span_y): (LaneSpan<S>, LaneSpan<S>),
    ) -> S::f64s {
        let (columns, rows) = (store::<S>(span_x.square), store::<S>(span_y.square));
        let (sizes, signs) = (store::<S>(self.size), store::<S>(self.sign));
        let mut stored = [0.0; MAX_LANES];
        // Idle lanes, too: their last square is as good as any, and a branch for each lane costs more.
        for lane in 0..S::f64s::LEN {
            // The exponent of a power of two.
            let level = (sizes[lane].to_bits() >> 52) as u32 - 1023;
            let node = [columns[lane] as u32, rows[lane] as u32];
            stored[lane] = relief.farthest(level, node, signs[lane]).into();
        }
        self.displaced(simd, relief, &stored)
    }

    /// Displacements of stored heights, seen from the sides of the walks.
    #[inline(always)]
    fn displaced<T>(&self, simd: S, relief: &Typed<'_, T>, stored: &Row) -> S::f64s {
        (load(simd, stored) * relief.factor + relief.offset) * self.sign
    }

    /// Which of the lanes `tests` meet the bilinear patch of their cell within `len`, and how far on.
    #[inline(always)]
    fn meet_cell<T: Copy + Into<f64>>(
        &self,
        simd: S,
        relief: &Typed<'_, T>,
        len: S::f64s,
        tests: u64,
    ) -> (S::mask64s, S::f64s) {
        let (columns, rows) = (store::<S>(self.x.local), store::<S>(self.y.local));
        let mut corners = [[0.0; MAX_LANES]; 4];
        let [width, height] = relief.size;
        let mut tests = tests;
        while tests != 0 {
            let lane = tests.trailing_zeros() as usize % MAX_LANES;
            tests &= tests - 1;
            let (i, j) = (columns[lane] as u32, rows[lane] as u32);
            let after = |i: u32, n| if i + 1 == n { 0 } else { i + 1 };
            let (i1, j1) = (after(i, width), after(j, height));
            let texel = |i: u32, j: u32| relief.texels[j as usize * width as usize + i as usize];
            corners[0][lane] = texel(i, j).into();
            corners[1][lane] = texel(i1, j).into();
            corners[2][lane] = texel(i, j1).into();
            corners[3][lane] = texel(i1, j1).into();
        }
        let h00 = self.displaced(simd, relief, &corners[0]);
        let h10 = self.displaced(simd, relief, &corners[1]);
        let h01 = self.displaced(simd, relief, &corners[2]);
        let h11 = self.displaced(simd, relief, &corners[3]);
        let (fx, fy) = (self.x.fraction(self.tau), self.y.fraction(self.tau));
        let (dx, dy) = (self.x.rate, self.y.rate);
        let (hx, hy, twist) = (h10 - h00, h01 - h00, h00 - h10 - h01 + h11);
        let a = -twist * dx * dy;
        let b = self.line[1] - (hx * dx + hy * dy + twist * (fx * dy + fy * dx));
        let c =
            (self.line[0] + self.line[1] * self.tau) - (h00 + hx * fx + hy * fy + twist * fx * fy);
        first_not_above(simd, [a, b, c], len)
    }
}

/// In which lanes `a σ² + b σ + c` is not above 0 somewhere in `[0, len]`, and the first such σ.
#[inline(always)]
fn first_not_above<S: Simd>(
    simd: S,
    [a, b, c]: [S::f64s; 3],
    len: S::f64s,
) -> (S::mask64s, S::f64s) {
    let zero = S::f64s::splat(simd, 0.0);
    let starts = c.simd_le(0.0);
    let at_end = (a * len + b) * len + c;
    let square = b * b;
    let dips =
        a.simd_gt(0.0) & b.simd_lt(0.0) & (-b).simd_lt(a * 2.0 * len) & square.simd_ge(a * 4.0 * c);
    let meets = starts | at_end.simd_le(0.0) | dips;
    let root = (square - a * 4.0 * c).max(0.0).sqrt();
    let falling = c * 2.0 / (root - b);
    let rising = -(b + root) / (a * 2.0);
    let first = b.simd_lt(0.0).select(falling, rising);
    let finite = first.abs().simd_lt(f64::INFINITY);
    let first = finite.select(first.max(0.0).min(len), len);
    (meets, starts.select(zero, first))
}
