//! The exact walk: where a straight ray first meets the bilinear relief.

use super::axis::Axis;
use super::cell_span::{CellSpan, sure_cell};
use super::parabola::first_not_above;
use super::walk_lanes::{Stored, walk_all};
use crate::math::simd::SimdLevel;
use crate::math::{Bits, Mask as _, Real, V2};
use crate::surface::mapping::BoundHeight;
use crate::texture::{Addressing, HeightPyramid, HorizonMap, Layout, StoredHeights, Wrap};

/// A relief with the pyramid over it, made ready for walks.
#[derive(Debug, Clone, Copy)]
pub struct ReliefField<'a> {
    /// Displacement over the chart.
    pub height: BoundHeight<'a>,
    pub(super) stored: StoredHeights<'a>,
    layout: Layout,
    /// Displacement is `stored · factor + offset`.
    factor: f64,
    offset: f64,
    range: [f64; 2],
    pub(super) horizons: Option<&'a HorizonMap>,
}

/// A straight ray over a flat chart, by a parameter τ ≥ 0 of any length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReliefRay {
    /// Place in texels (whole numbers at texel centres) at τ = 0.
    pub start: [f64; 2],
    /// Texels per unit of τ.
    pub rate: [f64; 2],
    /// Displacement at τ = 0, internal units along the normal.
    pub z: f64,
    /// Its change per unit of τ.
    pub z_rate: f64,
    /// τ at which it ends, finite.
    pub end: f64,
    /// Where it comes from.
    pub side: Side,
}

/// A side of a relief.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The side that the normal points to.
    Above,
    /// The other.
    Below,
}

impl Side {
    /// What displacements are multiplied by so that the ray is above: seen from below, a relief is the
    /// same turned over.
    #[inline(always)]
    pub(super) const fn sign(self) -> f64 {
        match self {
            Self::Above => 1.0,
            Self::Below => -1.0,
        }
    }
}

impl ReliefRay {
    /// A ray from displacement `z` to `z_end`, with the way gone along z as its parameter. `per_z` are
    /// texels per unit of z.
    #[must_use]
    pub fn by_height(start: [f64; 2], per_z: [f64; 2], z: f64, z_end: f64) -> Self {
        let toward = if z_end > z { 1.0 } else { -1.0 };
        Self {
            start,
            rate: per_z.map(|rate| rate * toward),
            z,
            z_rate: toward,
            end: (z_end - z).abs(),
            side: Side::Above,
        }
    }

    /// Displacement at τ.
    #[must_use]
    pub fn z_at(&self, tau: f64) -> f64 {
        self.z + self.z_rate * tau
    }

    /// Whether it stays where cells can be told apart.
    pub(super) fn is_near(&self) -> bool {
        let reach = |k: usize| self.start[k].abs() + self.rate[k].abs() * self.end;
        reach(0) < FARTHEST && reach(1) < FARTHEST
    }
}

/// What a walk came to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Walk {
    /// τ at which the ray first is not on its side of the relief any more; `None` if it always is.
    pub at: Option<f64>,
    /// Pyramid nodes and cells looked at.
    pub steps: u32,
    /// Whether it was given up after more steps than any walk should need.
    pub capped: bool,
}

impl Walk {
    /// No step was taken.
    pub const NONE: Self = Self {
        at: None,
        steps: 0,
        capped: false,
    };
}

/// No walk takes more steps, whatever the map: some milliseconds. Seen from 89.99°, a relief ten tiles deep is left
/// after less than half of them, a step or two for each of 57,000 tiles.
pub(super) const STEP_CAP: f64 = 524_288.0;

/// Farther from the origin than this many texels nothing is looked for: cells could not be told apart.
pub(super) const FARTHEST: f64 = 1e12;

impl<'a> ReliefField<'a> {
    /// Ties a relief to the pyramid of its map; `None` for the pyramid of another.
    #[must_use]
    pub fn new(height: BoundHeight<'a>, pyramid: &'a HeightPyramid) -> Option<Self> {
        if !pyramid.fits(height.map) {
            return None;
        }
        let stored = pyramid.stored();
        let unit = match stored {
            StoredHeights::U16(..) => 1.0 / 65_535.0,
            StoredHeights::F32(..) => 1.0,
        };
        let mut field = Self {
            height,
            stored,
            layout: pyramid.layout(),
            factor: f64::from(height.scale) * unit,
            offset: f64::from(height.offset),
            range: [0.0; 2],
            horizons: None,
        };
        let top = [[0; 3]; 2];
        field.range = match stored {
            StoredHeights::U16(all) => field.with(all).extremes(field.layout.top, top),
            StoredHeights::F32(all) => field.with(all).extremes(field.layout.top, top),
        };
        Some(field)
    }

    /// The same with the horizons of its map, turned over if more height is less displacement.
    #[must_use]
    pub const fn with_horizons(self, horizons: Option<&'a HorizonMap>) -> Self {
        Self { horizons, ..self }
    }

    /// Whether a ray that rises from the relief at `uv` is known to meet nothing of it, without a walk; in each lane.
    /// `per_z` is the change of the texture coordinate per unit of displacement.
    #[inline(always)]
    #[must_use]
    pub fn is_clear<F: Real>(&self, uv: V2<F>, per_z: V2<F>) -> F::Mask {
        let Some(horizons) = self.horizons else {
            return uv.x.lt(uv.x);
        };
        let Addressing { scale, offset, .. } = self.height.addressing;
        let size = self.layout.size.map(|n| n as f32);
        let x = sure_cell(uv.x * scale.x, offset.x, size[0]);
        let y = sure_cell(uv.y * scale.y, offset.y, size[1]);
        let rate = V2::new(per_z.x * (scale.x * size[0]), per_z.y * (scale.y * size[1]));
        let slope = horizons.slope([x.0, y.0], rate);
        let [low, high] = self.range;
        let texels = (rate.x * rate.x + rate.y * rate.y).sqrt();
        let needed = slope * texels * ((high - low) as f32);
        // No for NaN.
        x.1 & y.1 & needed.le(uv.x.splat(1.0))
    }

    /// [`Self::is_clear`] for a ray that starts on the relief or above it.
    #[inline]
    #[must_use]
    pub fn is_clear_along(&self, ray: &ReliefRay) -> bool {
        let Some(horizons) = self.horizons else {
            return false;
        };
        let near = ray.start.iter().all(|place| place.abs() < FARTHEST);
        if !near || ray.side != Side::Above || !(ray.z_rate > 0.0) {
            return false;
        }
        let cell = [0, 1].map(|k| wrapped(ray.start[k].floor() as i64, self.layout.size[k]));
        let [x, y] = ray.rate;
        let [low, high] = self.range;
        let needed = horizons.slope_towards(cell, ray.rate) * (x * x + y * y).sqrt();
        needed * (high - low) <= ray.z_rate
    }

    /// Smallest and largest displacement of the whole map.
    #[must_use]
    pub const fn range(&self) -> [f64; 2] {
        self.range
    }

    /// Texels per unit of u and v.
    #[must_use]
    pub fn texels_per_uv(&self) -> [f64; 2] {
        let scale = self.height.addressing.scale;
        [
            f64::from(scale.x) * f64::from(self.layout.size[0]),
            f64::from(scale.y) * f64::from(self.layout.size[1]),
        ]
    }

    /// Place in texels of a texture coordinate.
    #[must_use]
    pub fn texels_from_uv(&self, uv: [f64; 2]) -> [f64; 2] {
        let offset = self.height.addressing.offset;
        let [x, y] = self.texels_per_uv();
        [
            uv[0] * x + f64::from(offset.x) * f64::from(self.layout.size[0]) - 0.5,
            uv[1] * y + f64::from(offset.y) * f64::from(self.layout.size[1]) - 0.5,
        ]
    }

    /// Change of the displacement per texel to the right and downwards at a place in texels.
    #[must_use]
    pub fn slope(&self, place: [f64; 2]) -> [f64; 2] {
        if !place.iter().all(|c| c.abs() < FARTHEST) {
            return [0.0; 2];
        }
        match self.stored {
            StoredHeights::U16(all) => self.with(all).slope(place),
            StoredHeights::F32(all) => self.with(all).slope(place),
        }
    }

    /// Smallest and largest displacement over a triangle of places in texels, or somewhat more: never less,
    /// also if the places are off by a hundredth of a texel.
    #[must_use]
    pub fn range_near(&self, places: [[f64; 2]; 3]) -> [f64; 2] {
        let mut nodes = [[0_u32; 3]; 2];
        let mut cells = [[0_u32; 2]; 2];
        let mut widest = 1;
        for k in 0..2 {
            let [a, b, c] = places.map(|place| place[k]);
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            let margin = 0.01 + low.abs().max(high.abs()) * 1e-6;
            let n = self.layout.size[k];
            let known = low.abs().max(high.abs()) < FARTHEST;
            if !known || self.height.addressing.wrap != Wrap::Repeat {
                return self.range;
            }
            let (first, last) = (
                (low - margin).floor() as i64,
                (high + margin).floor() as i64,
            );
            if last - first + 1 >= i64::from(n) {
                return self.range;
            }
            widest = widest.max((last - first + 1) as u32);
            cells[k] = [first, last].map(|cell| wrapped(cell, n));
        }
        let level = widest.next_power_of_two().ilog2();
        for k in 0..2 {
            let [first, last] = cells[k];
            let end = self.layout.size[k] - 1;
            // As many cells as a node has lie in at most two nodes; across the border of the picture, in
            // at most three.
            nodes[k] = if first <= last {
                [first, last, last]
            } else {
                [first, end, last]
            };
        }
        match self.stored {
            StoredHeights::U16(all) => self.with(all).extremes(level, nodes),
            StoredHeights::F32(all) => self.with(all).extremes(level, nodes),
        }
    }

    /// [`Self::range_near`] for triangles of texture coordinates, one in each lane: never less, perhaps somewhat
    /// more.
    #[inline(always)]
    #[must_use]
    pub fn ranges_near<F: Real>(&self, corners: [V2<F>; 3]) -> [F; 2] {
        let height = &self.height;
        let [a, b, c] = corners;
        let (a, b, c) = (
            height.addressing.st(a),
            height.addressing.st(b),
            height.addressing.st(c),
        );
        let like = a.x;
        let x = CellSpan::new([a.x, b.x, c.x], self.layout.size[0], height.addressing.wrap);
        let y = CellSpan::new([a.y, b.y, c.y], self.layout.size[1], height.addressing.wrap);
        let top = self.layout.top;
        let mut level = 0;
        while level < top && (x.is_wider(level) | y.is_wider(level)).any() {
            level += 1;
        }
        let (i, x_known) = x.nodes(level);
        let (j, y_known) = y.nodes(level);
        let [low, high] = self.ranges_in(level, i, j);
        let [all_low, all_high] = self.range;
        let known = x_known & y_known;
        let margin = self.range_margin();
        [
            F::select(known, low, like.splat(all_low as f32 - margin)),
            F::select(known, high, like.splat(all_high as f32 + margin)),
        ]
    }

    /// Smallest and largest displacements, or somewhat more, in squares of 2^level cells: the four that two columns and
    /// two rows share. No square may begin outside the picture.
    #[inline(always)]
    #[must_use]
    pub fn ranges_in<B: Bits>(
        &self,
        level: u32,
        [i0, i1]: [B; 2],
        [j0, j1]: [B; 2],
    ) -> [B::Real; 2] {
        let height = &self.height;
        let squares = self.layout.level(level);
        // No map has 2³² texels.
        let [right, down] = squares.steps.map(|step| step as u32);
        let (i0, i1) = (i0.times(right), i1.times(right));
        let row0 = j0.times(down).plus(squares.first as u32);
        let row1 = j1.times(down).plus(squares.first as u32);
        let nodes = [
            row0.plus_each(i0),
            row0.plus_each(i1),
            row1.plus_each(i0),
            row1.plus_each(i1),
        ];
        let [low, high] = match self.stored {
            StoredHeights::U16(all) => {
                let unit = 1.0 / 65_535.0;
                let [low, high] = squares.extremes_of_four(all, nodes);
                [low * unit, high * unit]
            }
            StoredHeights::F32(all) => squares.extremes_of_four(all, nodes),
        };
        let at_low = low * height.scale + height.offset;
        let at_high = high * height.scale + height.offset;
        let margin = self.range_margin();
        [
            at_low.smaller(at_high) - margin,
            at_low.larger(at_high) + margin,
        ]
    }

    /// What roundings of ranges and of the heights themselves may come to.
    fn range_margin(&self) -> f32 {
        let [low, high] = self.range;
        let largest = low.abs().max(high.abs()) as f32;
        (largest + self.height.offset.abs()) * 2e-6
    }

    /// Columns and rows of the map.
    #[must_use]
    pub const fn size(&self) -> [u32; 2] {
        self.layout.size
    }

    /// Displacement at a place in texels; 0 farther away than anything can be.
    #[must_use]
    pub fn displacement(&self, place: [f64; 2]) -> f64 {
        if !place.iter().all(|c| c.abs() < FARTHEST) {
            return 0.0;
        }
        match self.stored {
            StoredHeights::U16(all) => self.with(all).displacement(place),
            StoredHeights::F32(all) => self.with(all).displacement(place),
        }
    }

    /// Where the ray first meets the bilinear relief.
    ///
    /// Never misses and never stops early, at any angle: cells are counted in integers, parameters are
    /// doubles, and squares are skipped only where the ray passes clear of all of their corners. A sinking
    /// ray from above that ends at or below the lowest displacement always hits. Rays that reach farther
    /// than 10¹² texels are not walked.
    ///
    /// Source: max mipmaps, Tevs et al. 2008.
    #[must_use]
    pub fn walk(&self, ray: &ReliefRay) -> Walk {
        if !ray.is_near() {
            return Walk::NONE;
        }
        match self.stored {
            StoredHeights::U16(all) => self.with(all).walk(ray),
            StoredHeights::F32(all) => self.with(all).walk(ray),
        }
    }

    /// Steps after which the walk of a ray is given up.
    #[must_use]
    pub fn step_cap(&self, ray: &ReliefRay) -> u32 {
        step_cap(self.layout.size, ray)
    }

    /// [`Self::walk`] for many rays, with the instructions of `level`: the same bits.
    ///
    /// # Panics
    /// If there are not as many places for what came of them as rays.
    pub fn walk_all(&self, level: SimdLevel, rays: &[ReliefRay], walks: &mut [Walk]) {
        assert_eq!(rays.len(), walks.len(), "one place for each ray");
        match self.stored {
            StoredHeights::U16(all) => walk_all(&self.with(all), level, rays, walks),
            StoredHeights::F32(all) => walk_all(&self.with(all), level, rays, walks),
        }
    }

    pub(super) const fn with<T>(&self, numbers: &'a [T]) -> Typed<'a, T> {
        Typed {
            numbers,
            layout: self.layout,
            wrap: self.height.addressing.wrap,
            factor: self.factor,
            offset: self.offset,
        }
    }
}

/// A relief whose kind of number is known.
pub(super) struct Typed<'a, T> {
    /// Texels and nodes.
    pub(super) numbers: &'a [T],
    pub(super) layout: Layout,
    pub(super) wrap: Wrap,
    pub(super) factor: f64,
    pub(super) offset: f64,
}

impl<T: Stored> Typed<'_, T> {
    fn displacement(&self, [x, y]: [f64; 2]) -> f64 {
        let (x, y) = (
            Axis::new(self.layout.size[0], x, 0.0),
            Axis::new(self.layout.size[1], y, 0.0),
        );
        let [a, b, c, d] = self.corners(&x, &y);
        let (fx, fy) = (x.fraction(0.0), y.fraction(0.0));
        a + (b - a) * fx + (c - a) * fy + (a - b - c + d) * fx * fy
    }

    fn slope(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (x, y) = (
            Axis::new(self.layout.size[0], x, 0.0),
            Axis::new(self.layout.size[1], y, 0.0),
        );
        let [a, b, c, d] = self.corners(&x, &y);
        let twist = a - b - c + d;
        [
            b - a + twist * y.fraction(0.0),
            c - a + twist * x.fraction(0.0),
        ]
    }

    /// Smallest and largest displacement over the nodes that hold some cells of the picture.
    fn extremes(&self, level: u32, [columns, rows]: [[u32; 3]; 2]) -> [f64; 2] {
        let squares = self.layout.level(level);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for (at, j) in rows.into_iter().enumerate() {
            if at > 0 && j >> level == rows[at - 1] >> level {
                continue;
            }
            for (at, i) in columns.into_iter().enumerate() {
                if at > 0 && i >> level == columns[at - 1] >> level {
                    continue;
                }
                let at = squares.at([i >> level, j >> level]);
                let [a, b] = squares.extremes(self.numbers, at);
                let [a, b] = [self.displaced(a), self.displaced(b)];
                low = low.min(a.min(b));
                high = high.max(a.max(b));
            }
        }
        [low, high]
    }

    pub(super) fn walk(&self, ray: &ReliefRay) -> Walk {
        let sign = ray.side.sign();
        let line = [ray.z * sign, ray.z_rate * sign];
        let inv_sinking = 1.0 / -line[1];
        let end = ray.end;
        let mut x = Axis::new(self.layout.size[0], ray.start[0], ray.rate[0]);
        let mut y = Axis::new(self.layout.size[1], ray.start[1], ray.rate[1]);
        let cap = self.step_cap(ray);
        let top = self.layout.top;
        let mut level = start_level(ray, top);
        let mut tau = 0.0_f64;
        let mut steps = 0;
        let found = loop {
            steps += 1;
            if steps > cap {
                break None;
            }
            let (span_x, span_y) = (x.span(level), y.span(level));
            let (exit_x, exit_y) = (x.exit(span_x), y.exit(span_y));
            let exit = larger(smaller(exit_x, exit_y), tau);
            let leave = smaller(exit, end);
            let lowest = line[0] + line[1] * if line[1] > 0.0 { tau } else { leave };
            let high = if self.wrap == Wrap::Repeat {
                self.high(level, [x.local(), y.local()], sign)
            } else {
                let columns = x.cells(span_x, self.wrap);
                self.highest(level, columns, y.cells(span_y, self.wrap), sign)
            };
            if lowest <= high {
                if level > 0 {
                    level -= 1;
                    if line[1] < 0.0 {
                        // Down to the highest point nothing is in the way.
                        let down = (line[0] - high) * inv_sinking;
                        tau = larger(tau, smaller(down, leave));
                    }
                    x.settle(span_x, tau);
                    y.settle(span_y, tau);
                    continue;
                }
                let line = [line[0] + line[1] * tau, line[1]];
                if let Some(after) = self.meet_cell((&x, &y), tau, leave - tau, line, sign) {
                    break Some(tau + after);
                }
            }
            if exit >= end {
                break None;
            }
            tau = exit;
            let leaves_square = if exit_x <= exit_y {
                y.settle(span_y, tau);
                x.cross(span_x, level)
            } else {
                x.settle(span_x, tau);
                y.cross(span_y, level)
            };
            if leaves_square && level < top {
                level += 1;
            }
        };
        Walk {
            at: found,
            steps,
            capped: steps > cap,
        }
    }

    #[inline(always)]
    fn displaced(&self, stored: T) -> f64 {
        stored.into() * self.factor + self.offset
    }

    /// The largest displacement over the square of a cell of the picture, seen from the side of `sign`.
    #[inline(always)]
    fn high(&self, level: u32, [i, j]: [u32; 2], sign: f64) -> f64 {
        let squares = self.layout.level(level);
        let [low, high] = squares.extremes(self.numbers, squares.at([i >> level, j >> level]));
        let stored = if self.factor * sign >= 0.0 { high } else { low };
        self.displaced(stored) * sign
    }

    /// [`Self::high`] over up to four squares.
    fn highest(&self, level: u32, columns: [u32; 2], rows: [u32; 2], sign: f64) -> f64 {
        let high = |i, j| self.high(level, [i, j], sign);
        let row = |j| high(columns[0], j).max(high(columns[1], j));
        row(rows[0]).max(row(rows[1]))
    }

    /// Displacements at the corners of a cell.
    #[inline(always)]
    fn corners(&self, x: &Axis, y: &Axis) -> [f64; 4] {
        let ([i0, i1], [j0, j1]) = (x.texels(self.wrap), y.texels(self.wrap));
        let texel = |i, j| self.displaced(self.numbers[self.layout.texel(i, j)]);
        [texel(i0, j0), texel(i1, j0), texel(i0, j1), texel(i1, j1)]
    }

    /// How far after `tau`, but not beyond `len`, the ray meets the bilinear patch of its cell. `line` is
    /// its displacement there and the change per unit of τ, seen from the side of `sign`.
    #[inline(always)]
    fn meet_cell(
        &self,
        (x, y): (&Axis, &Axis),
        tau: f64,
        len: f64,
        line: [f64; 2],
        sign: f64,
    ) -> Option<f64> {
        let [h00, h10, h01, h11] = self.corners(x, y).map(|h| h * sign);
        let (fx, fy) = (x.fraction(tau), y.fraction(tau));
        let (dx, dy) = (x.rate(), y.rate());
        let (hx, hy, twist) = (h10 - h00, h01 - h00, h00 - h10 - h01 + h11);
        // Ray minus patch: a σ² + b σ + c.
        let a = -twist * dx * dy;
        let b = line[1] - (hx * dx + hy * dy + twist * (fx * dy + fy * dx));
        let c = line[0] - (h00 + hx * fx + hy * fy + twist * fx * fy);
        first_not_above(a, b, c, len)
    }

    /// Twice what the finest possible walk could take, ups and downs included.
    fn step_cap(&self, ray: &ReliefRay) -> u32 {
        step_cap(self.layout.size, ray)
    }
}

/// The cell of a picture of `n` that repeats; most have a power of two, where no division is needed.
#[inline(always)]
fn wrapped(cell: i64, n: u32) -> u32 {
    let n = i64::from(n);
    if n & (n - 1) == 0 {
        (cell & (n - 1)) as u32
    } else {
        cell.rem_euclid(n) as u32
    }
}

/// Steps after which a walk over a map of that size is given up.
fn step_cap(size: [u32; 2], ray: &ReliefRay) -> u32 {
    let [w, h] = size.map(f64::from);
    let tiles = 2.0 + (ray.rate[0] * ray.end / w).abs() + (ray.rate[1] * ray.end / h).abs();
    let cap = 64.0 + 4.0 * (w + h) * tiles;
    cap.min(STEP_CAP) as u32
}

/// The smaller of two numbers that are not NaN, in one instruction.
#[inline(always)]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The larger.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The level whose squares are about a quarter as wide as the way to go: finer ones would be climbed, coarser ones
/// descended, for nothing.
#[inline(always)]
fn start_level(ray: &ReliefRay, top: u32) -> u32 {
    // Close to the relief that it leaves, a ray passes no square of more than one cell.
    if ray.z_rate * ray.side.sign() > 0.0 {
        return 0;
    }
    let texels = ray.rate[0].abs().max(ray.rate[1].abs()) * ray.end;
    let level = (texels.min(1e9) as u32).max(1).ilog2();
    level.saturating_sub(2).min(top)
}
