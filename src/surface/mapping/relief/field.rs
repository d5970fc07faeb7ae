//! A relief, and what is known of its displacements.

use super::cell_span::{CellSpan, sure_cell};
use super::ray::{FARTHEST, ReliefRay, Side};
use super::typed::{Typed, wrapped};
use crate::math::{Bits, Mask as _, Real, V2};
use crate::surface::mapping::BoundHeight;
use crate::texture::{Addressing, HeightPyramid, HorizonMap, Layout, StoredHeights, Wrap};

/// A relief with the pyramid over it, made ready for walks.
#[derive(Debug, Clone, Copy)]
pub struct ReliefField<'a> {
    /// Displacement over the chart.
    pub height: BoundHeight<'a>,
    pub(super) stored: StoredHeights<'a>,
    pub(super) layout: Layout,
    /// Displacement is `stored · factor + offset`.
    factor: f64,
    offset: f64,
    range: [f64; 2],
    pub(super) horizons: Option<&'a HorizonMap>,
}

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
