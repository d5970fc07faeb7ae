//! Many exact walks in step, one in each vector lane: the twin of `walk`, with the same bits.
//!
//! A walk takes about ten steps and no two take the same turns, so that one after the other they mostly
//! wait for mispredicted branches. In lanes every step does what any walk may need, under masks and without a
//! branch; and two vectors of walks go by turns, so that one computes while the other waits for memory. A lane
//! whose walk is over takes the next ray from the list.

use super::lane_axis::LaneAxis;
use super::parabola::{first_not_above, is_not_above};
use super::ray::ReliefRay;
use super::typed::Typed;
use super::walk::{STEP_CAP, Walk};
use crate::math::fetch::{WHOLE, wide_pairs};
use crate::math::rows::{MAX_LANES, Row, load, store};
use crate::math::simd::{
    Bytes as _, ExtractToken as _, Kernel, Select as _, Simd, SimdBase as _, SimdFloat as _,
    SimdLevel, SimdMask as _, merged,
};
use crate::texture::Wrap;

/// Numbers that heights are stored in.
pub(super) trait Stored: Copy + PartialOrd + Into<f64> {
    /// For every lane the numbers at `first`, after it, at `second` and after it. Indices are [`WHOLE`] doubles.
    fn fours<S: Simd>(simd: S, numbers: &[Self], at: [S::f64s; 2]) -> [S::f64s; 4];
}

/// A number and the one after it.
#[inline(always)]
fn pair<T: Copy>(numbers: &[T], whole: f64) -> [T; 2] {
    let at = whole.to_bits() as u32 as usize;
    let both = &numbers[at..at + 2];
    [both[0], both[1]]
}

impl Stored for u16 {
    #[inline(always)]
    fn fours<S: Simd>(simd: S, numbers: &[Self], [first, second]: [S::f64s; 2]) -> [S::f64s; 4] {
        let upper = wide_pairs::<S>(numbers, first);
        let lower = wide_pairs::<S>(numbers, second);
        let half = S::u64s::splat(simd, 0xffff);
        [
            whole::<S>(simd, upper & half),
            whole::<S>(simd, upper >> 16),
            whole::<S>(simd, lower & half),
            whole::<S>(simd, lower >> 16),
        ]
    }
}

/// Small whole numbers as doubles.
#[inline(always)]
fn whole<S: Simd>(simd: S, x: S::u64s) -> S::f64s {
    let exponent = S::u64s::splat(simd, WHOLE.to_bits());
    (x | exponent).bitcast::<S::f64s>() - WHOLE
}

impl Stored for f32 {
    #[inline(always)]
    fn fours<S: Simd>(simd: S, numbers: &[Self], at: [S::f64s; 2]) -> [S::f64s; 4] {
        let (first, second) = (store::<S>(at[0]), store::<S>(at[1]));
        let mut rows = [[0.0; MAX_LANES]; 4];
        for lane in 0..S::f64s::LEN {
            let ([a, b], [c, d]) = (pair(numbers, first[lane]), pair(numbers, second[lane]));
            rows[0][lane] = f64::from(a);
            rows[1][lane] = f64::from(b);
            rows[2][lane] = f64::from(c);
            rows[3][lane] = f64::from(d);
        }
        let [a, b, c, d] = &rows;
        [load(simd, a), load(simd, b), load(simd, c), load(simd, d)]
    }
}

/// Walks all rays.
pub(super) fn walk_all<T: Stored>(
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

impl<T: Stored> Kernel for WalkAll<'_, T> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let relief = LaneRelief::new(simd, self.relief);
        let mut list = List {
            rays: self.rays,
            walks: self.walks,
            next: 0,
        };
        let (mut a, mut b) = (Group::idle(simd), Group::idle(simd));
        loop {
            a.refill(simd, &relief, &mut list);
            b.refill(simd, &relief, &mut list);
            if a.busy | b.busy == 0 {
                return;
            }
            a.busy = a.lanes.step(simd, &relief);
            b.busy = b.lanes.step(simd, &relief);
        }
    }
}

/// Rays still to walk, and what came of the others.
struct List<'a> {
    rays: &'a [ReliefRay],
    walks: &'a mut [Walk],
    next: usize,
}

/// As many walks as a vector has lanes.
struct Group<S: Simd> {
    lanes: Lanes<S>,
    /// The ray of each lane.
    jobs: [usize; MAX_LANES],
    /// Lanes with a ray.
    taken: u64,
    /// Those of them whose walk is not over.
    busy: u64,
}

impl<S: Simd> Group<S> {
    #[inline(always)]
    fn idle(simd: S) -> Self {
        Self {
            lanes: Lanes::idle(simd),
            jobs: [0; MAX_LANES],
            taken: 0,
            busy: 0,
        }
    }

    /// Hands back what ended and takes new rays on. Both cost as much as a step: not for every single lane.
    #[inline(always)]
    fn refill<T: Stored>(&mut self, simd: S, relief: &LaneRelief<'_, S, T>, list: &mut List<'_>) {
        let width = S::f64s::LEN;
        let free = width - self.busy.count_ones() as usize;
        let waiting = list.next < list.rays.len();
        if (waiting && 8 * free >= 3 * width) || (self.busy == 0 && self.taken != 0) {
            self.hand_back(list.walks);
            self.take_on(simd, relief, list);
        }
    }

    #[inline(always)]
    fn hand_back(&mut self, walks: &mut [Walk]) {
        let mut ended = self.taken & !self.busy;
        self.taken &= !ended;
        if ended == 0 {
            return;
        }
        let results = &self.lanes.results;
        let (found, capped) = (results.found.to_bitmask(), results.capped.to_bitmask());
        let (steps, tau, len) = (
            store::<S>(results.steps),
            store::<S>(results.tau),
            store::<S>(results.len),
        );
        let [a, b, c] = results.parabola;
        let (a, b, c) = (store::<S>(a), store::<S>(b), store::<S>(c));
        while ended != 0 {
            let lane = ended.trailing_zeros() as usize % MAX_LANES;
            ended &= ended - 1;
            let at = if found >> lane & 1 != 0 {
                first_not_above(a[lane], b[lane], c[lane], len[lane]).map(|after| tau[lane] + after)
            } else {
                None
            };
            walks[self.jobs[lane]] = Walk {
                at,
                steps: steps[lane] as u32,
                capped: capped >> lane & 1 != 0,
            };
        }
    }

    #[inline(always)]
    fn take_on<T: Stored>(&mut self, simd: S, relief: &LaneRelief<'_, S, T>, list: &mut List<'_>) {
        let mut seeds = Seeds::NONE;
        let mut free = !self.taken & (u64::MAX >> (64 - S::f64s::LEN));
        let mut taken = 0;
        while free != 0 {
            let Some(ray) = list.rays.get(list.next) else {
                break;
            };
            let lane = free.trailing_zeros() as usize % MAX_LANES;
            if ray.is_near() {
                seeds.put(lane, ray);
                self.jobs[lane] = list.next;
                taken |= free & free.wrapping_neg();
                free &= free - 1;
            } else {
                list.walks[list.next] = Walk::NONE;
            }
            list.next += 1;
        }
        self.lanes.take(simd, relief, taken, &seeds);
        self.taken |= taken;
        self.busy |= taken;
    }
}

/// Rays for lanes to take on.
struct Seeds {
    start: [Row; 2],
    rate: [Row; 2],
    line: [Row; 2],
    sign: Row,
    end: Row,
}

impl Seeds {
    const NONE: Self = Self {
        start: [[0.0; MAX_LANES]; 2],
        rate: [[0.0; MAX_LANES]; 2],
        line: [[0.0; MAX_LANES]; 2],
        sign: [1.0; MAX_LANES],
        end: [0.0; MAX_LANES],
    };

    #[inline(always)]
    fn put(&mut self, lane: usize, ray: &ReliefRay) {
        for k in 0..2 {
            self.start[k][lane] = ray.start[k];
            self.rate[k][lane] = ray.rate[k];
        }
        self.line[0][lane] = ray.z;
        self.line[1][lane] = ray.z_rate;
        self.sign[lane] = ray.side.sign();
        self.end[lane] = ray.end;
    }
}

/// What all walks over a relief ask for.
pub(super) struct LaneRelief<'a, S: Simd, T> {
    numbers: &'a [T],
    pub(super) n: [S::f64s; 2],
    factor: S::f64s,
    offset: S::f64s,
    /// Side of the square of the top level.
    top: S::f64s,
    texel_row: S::f64s,
    node_steps: [S::f64s; 2],
    end: S::f64s,
    twice: S::f64s,
}

impl<'a, S: Simd, T: Stored> LaneRelief<'a, S, T> {
    #[inline(always)]
    pub(super) fn new(simd: S, relief: &Typed<'a, T>) -> Self {
        let layout = &relief.layout;
        Self {
            numbers: relief.numbers,
            n: [
                S::f64s::splat(simd, f64::from(layout.size[0])),
                S::f64s::splat(simd, f64::from(layout.size[1])),
            ],
            factor: S::f64s::splat(simd, relief.factor),
            offset: S::f64s::splat(simd, relief.offset),
            top: S::f64s::splat(simd, f64::from(1_u32 << layout.top)),
            texel_row: S::f64s::splat(simd, layout.texel_row() as f64),
            node_steps: [
                S::f64s::splat(simd, layout.node_steps[0] as f64),
                S::f64s::splat(simd, layout.node_steps[1] as f64),
            ],
            end: S::f64s::splat(simd, layout.end as f64),
            twice: S::f64s::splat(simd, layout.twice as f64),
        }
    }

    /// Side of the squares that walks start with: see [`start_level`](super::walk::start_level).
    #[inline(always)]
    fn start_size(&self, rate: [S::f64s; 2], end: S::f64s, rises: S::mask64s) -> S::f64s {
        let simd = end.token();
        let texels = rate[0].abs().max(rate[1].abs()) * end;
        // A power of two is all exponent.
        let exponent = S::u64s::splat(simd, 0x7ff0_0000_0000_0000);
        let size = (texels.max(1.0).bitcast::<S::u64s>() & exponent).bitcast::<S::f64s>();
        let size = (size * 0.25).max(1.0).min(self.top);
        rises.select(S::f64s::splat(simd, 1.0), size)
    }

    /// See [`Typed::step_cap`].
    #[inline(always)]
    fn step_cap(&self, rate: [S::f64s; 2], end: S::f64s) -> S::f64s {
        let [w, h] = self.n;
        let tiles = (rate[0] * end / w).abs() + 2.0 + (rate[1] * end / h).abs();
        let cap = (w + h) * 4.0 * tiles + 64.0;
        cap.min(STEP_CAP).floor()
    }

    /// Displacements at the corners of cells, or the extremes of coarser squares, as they are stored: see
    /// [`Layout::level`](crate::texture::Layout::level). All are whole numbers, exactly.
    #[inline(always)]
    fn fours(&self, simd: S, inv: S::f64s, [column, row]: [S::f64s; 2]) -> [S::f64s; 4] {
        let (zero, one) = (S::f64s::splat(simd, 0.0), S::f64s::splat(simd, 1.0));
        let is_cell = inv.simd_eq(one);
        let first = is_cell.select(zero, self.end - self.twice * inv);
        let right = is_cell.select(one, self.node_steps[0]);
        let down = is_cell.select(self.texel_row, self.node_steps[1]);
        let below = is_cell.select(self.texel_row, zero);
        let at = (first + column * right) + (row * down + WHOLE);
        T::fours(simd, self.numbers, [at, at + below])
    }

    /// The same as displacements.
    #[inline(always)]
    pub(super) fn displacements(
        &self,
        simd: S,
        inv: S::f64s,
        square: [S::f64s; 2],
    ) -> [S::f64s; 4] {
        let [a, b, c, d] = self.fours(simd, inv, square);
        [
            a * self.factor + self.offset,
            b * self.factor + self.offset,
            c * self.factor + self.offset,
            d * self.factor + self.offset,
        ]
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
    busy: S::mask64s,
    results: Results<S>,
}

/// What came of walks that are over.
struct Results<S: Simd> {
    steps: S::f64s,
    capped: S::mask64s,
    found: S::mask64s,
    /// Where something was found: the parameter at which the cell begins, what is solved for there, and how far
    /// the cell reaches.
    tau: S::f64s,
    parabola: [S::f64s; 3],
    len: S::f64s,
}

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    fn idle(simd: S) -> Self {
        let zero = S::f64s::splat(simd, 0.0);
        let one = S::f64s::splat(simd, 1.0);
        Self {
            x: LaneAxis::idle(simd),
            y: LaneAxis::idle(simd),
            line: [zero; 2],
            inv_sinking: one,
            sign: one,
            end: zero,
            tau: zero,
            size: one,
            inv_size: one,
            steps: zero,
            cap: zero,
            busy: S::mask64s::from_bitmask(simd, 0),
            results: Results {
                steps: zero,
                capped: S::mask64s::from_bitmask(simd, 0),
                found: S::mask64s::from_bitmask(simd, 0),
                tau: zero,
                parabola: [zero; 3],
                len: zero,
            },
        }
    }

    /// Starts the lanes of `taken` as [`Typed::walk`] starts.
    #[inline(always)]
    fn take<T: Stored>(
        &mut self,
        simd: S,
        relief: &LaneRelief<'_, S, T>,
        taken: u64,
        seeds: &Seeds,
    ) {
        let taken = S::mask64s::from_bitmask(simd, taken);
        let (zero, one) = (S::f64s::splat(simd, 0.0), S::f64s::splat(simd, 1.0));
        let rate = [load(simd, &seeds.rate[0]), load(simd, &seeds.rate[1])];
        let (x, y) = (load(simd, &seeds.start[0]), load(simd, &seeds.start[1]));
        self.x.take(relief.n[0], taken, [x, rate[0]]);
        self.y.take(relief.n[1], taken, [y, rate[1]]);
        let (sign, end) = (load(simd, &seeds.sign), load(simd, &seeds.end));
        let z = load(simd, &seeds.line[0]) * sign;
        let z_rate = load(simd, &seeds.line[1]) * sign;
        let (size, cap) = (
            relief.start_size(rate, end, z_rate.simd_gt(0.0)),
            relief.step_cap(rate, end),
        );
        self.line[0] = merged(taken, z, self.line[0]);
        self.line[1] = merged(taken, z_rate, self.line[1]);
        self.inv_sinking = merged(taken, one / -z_rate, self.inv_sinking);
        self.sign = merged(taken, sign, self.sign);
        self.end = merged(taken, end, self.end);
        self.tau = merged(taken, zero, self.tau);
        self.size = merged(taken, size, self.size);
        self.inv_size = merged(taken, one / size, self.inv_size);
        self.steps = merged(taken, zero, self.steps);
        self.cap = merged(taken, cap, self.cap);
        self.busy |= taken;
    }

    /// One step of every walk: see [`Typed::walk`], whose every operation this repeats. Walks that are over go on
    /// as they like. Returns the lanes with others.
    #[inline(always)]
    fn step<T: Stored>(&mut self, simd: S, relief: &LaneRelief<'_, S, T>) -> u64 {
        self.steps += 1.0;
        let capped = self.steps.simd_gt(self.cap);
        let inv = self.inv_size;
        let span_x = self.x.span(relief.n[0], self.size, inv);
        let span_y = self.y.span(relief.n[1], self.size, inv);
        let (exit_x, exit_y) = (self.x.exit(span_x), self.y.exit(span_y));
        let exit = exit_x.min(exit_y).max(self.tau);
        let leave = exit.min(self.end);
        let [z, z_rate] = self.line;
        let lowest = z + z_rate * z_rate.simd_gt(0.0).select(self.tau, leave);
        let [a, b, c, d] = relief.displacements(simd, inv, [span_x.square, span_y.square]);
        let (h00, h10) = (a * self.sign, b * self.sign);
        let (h01, h11) = (c * self.sign, d * self.sign);
        let high = h00.max(h10).max(h01.max(h11));

        let enters = lowest.simd_le(high) & !capped;
        let coarse = self.size.simd_gt(1.0);
        let descends = enters & coarse;

        // At the finest level: the patch of the cell.
        let len = leave - self.tau;
        let parabola = self.over_patch([h00, h10, h01, h11]);
        let found = enters & !coarse & is_not_above::<S>(parabola, len);
        let tau = self.tau;

        // Down one level, or on to the next square.
        let advances = !descends;
        let down = (z - high) * self.inv_sinking;
        let sunk = self.tau.max(down.min(leave));
        let sunk = z_rate.simd_lt(0.0).select(sunk, self.tau);
        self.tau = descends.select(sunk, exit);
        let past_end = advances & exit.simd_ge(self.end);
        let crosses_x = exit_x.simd_le(exit_y);
        self.x.settle(span_x, self.tau, descends | !crosses_x);
        self.y.settle(span_y, self.tau, descends | crosses_x);
        let leaves_x = self.x.cross(relief.n[0], span_x, advances & crosses_x);
        let leaves_y = self.y.cross(relief.n[1], span_y, advances & !crosses_x);
        let climbs = (leaves_x | leaves_y) & self.size.simd_lt(relief.top);
        let size = climbs.select(self.size * 2.0, self.size);
        self.size = descends.select(self.size * 0.5, size);
        let inv_size = climbs.select(inv * 0.5, inv);
        self.inv_size = descends.select(inv * 2.0, inv_size);

        let ended = self.busy & (capped | found | past_end);
        self.busy &= !ended;
        let results = &mut self.results;
        results.steps = merged(ended, self.steps, results.steps);
        results.capped = ended.select(capped, results.capped);
        results.found = ended.select(found, results.found);
        results.tau = merged(ended, tau, results.tau);
        let ([a, b, c], [x, y, z]) = (parabola, results.parabola);
        results.parabola = [
            merged(ended, a, x),
            merged(ended, b, y),
            merged(ended, c, z),
        ];
        results.len = merged(ended, len, results.len);
        self.busy.to_bitmask()
    }

    /// Ray minus patch from τ on: `a σ² + b σ + c`.
    #[inline(always)]
    fn over_patch(&self, [h00, h10, h01, h11]: [S::f64s; 4]) -> [S::f64s; 3] {
        let (fx, fy) = (self.x.fraction(self.tau), self.y.fraction(self.tau));
        let (dx, dy) = (self.x.rate(), self.y.rate());
        let (hx, hy, twist) = (h10 - h00, h01 - h00, h00 - h10 - h01 + h11);
        let a = -twist * dx * dy;
        let b = self.line[1] - (hx * dx + hy * dy + twist * (fx * dy + fy * dx));
        let z = self.line[0] + self.line[1] * self.tau;
        let c = z - (h00 + hx * fx + hy * fy + twist * fx * fy);
        [a, b, c]
    }
}
