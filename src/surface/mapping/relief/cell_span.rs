//! Which nodes of a pyramid lie under places in vector lanes.

use crate::math::{Bits, Real};
use crate::texture::Wrap;

/// Texels that a place may be off by.
const MARGIN: f32 = 0.01;

/// From here on floats do not tell texels apart.
const FAR: f32 = 2_097_152.0;

/// Texels up to which a place is rounded by less than a block of a [`HorizonMap`](crate::texture::HorizonMap) forgives.
const SURE: f32 = 65_536.0;

/// The cell of the sum of two coordinates, 0…1 across `count` texels of a picture that repeats, and whether that is sure
/// to a hundredth of a texel; in each lane.
#[inline(always)]
pub(super) fn sure_cell<F: Real>(coordinate: F, offset: f32, count: f32) -> (F::Bits, F::Mask) {
    // What cancels out was rounded all the same. No for NaN, too.
    let sure = ((coordinate.abs() + offset.abs()) * count).lt(coordinate.splat(SURE));
    let place = (coordinate + offset) * count - 0.5;
    let cell = F::select(sure, place, place.splat(0.0)).floor();
    (turned(cell, count).to_index(), sure)
}

/// The first and last cell under a few places along one axis of a picture, in each lane.
pub(super) struct CellSpan<F: Real> {
    first: F,
    last: F,
    /// Whether both are inside the picture or can be wrapped into it.
    known: F::Mask,
    size: u32,
    wrap: Wrap,
}

impl<F: Real> CellSpan<F> {
    /// Of coordinates 0…1 across `size` texels.
    #[inline(always)]
    pub(super) fn new(places: [F; 3], size: u32, wrap: Wrap) -> Self {
        let count = size as f32;
        let [a, b, c] = places;
        let (a, b, c) = (a * count - 0.5, b * count - 0.5, c * count - 0.5);
        let (low, high) = (a.smaller(b).smaller(c), a.larger(b).larger(c));
        let reach = a.abs().larger(b.abs()).larger(c.abs());
        let margin = reach * 2e-6 + MARGIN;
        let (first, last) = ((low - margin).floor(), (high + margin).floor());
        let is_whole = (first + count).le(last);
        // No for NaN, too.
        let numbers = a.is_finite() & b.is_finite() & c.is_finite();
        let near = numbers & reach.lt(a.splat(FAR)) & !is_whole;
        let (zero, end) = (a.splat(0.0), a.splat(count - 1.0));
        let inside = near & first.ge(zero) & last.le(end);
        let (turned, known) = match wrap {
            Wrap::Repeat => ([turned(first, count), turned(last, count)], near),
            // Beyond its border a clamped picture is its border.
            Wrap::Clamp => ([first, last], near),
            Wrap::Mirror => ([first, last], inside),
        };
        let [first, last] = turned;
        Self {
            first: F::select(known, first, zero).larger(zero).smaller(end),
            last: F::select(known, last, zero).larger(zero).smaller(end),
            known,
            size,
            wrap,
        }
    }

    /// Cells from the first to the last, across the border if that is between them.
    #[inline(always)]
    fn count(&self) -> F {
        let count = self.last - self.first + 1.0;
        let across = count + self.size as f32;
        F::select(self.first.le(self.last), count, across)
    }

    /// Whether they may lie in more than two nodes of a level.
    #[inline(always)]
    pub(super) fn is_wider(&self, level: u32) -> F::Mask {
        let count = self.count();
        // A node and one cell more begin in at most two nodes, wherever they begin.
        self.known & count.splat(((1_u32 << level) + 1) as f32).lt(count)
    }

    /// The nodes of a level that the first and the last cell lie in, and whether there are no others between: across
    /// the border there may be, if that cuts a node off.
    #[inline(always)]
    pub(super) fn nodes(&self, level: u32) -> ([F::Bits; 2], F::Mask) {
        let ends = [self.first.to_index(), self.last.to_index()];
        let ends = [ends[0].shr(level), ends[1].shr(level)];
        let is_even = self.wrap == Wrap::Repeat && self.size.is_multiple_of(1 << level);
        let known = if is_even {
            self.known
        } else {
            self.known & self.first.le(self.last)
        };
        (ends, known & !self.is_wider(level))
    }
}

/// A whole number modulo another.
#[inline(always)]
fn turned<F: Real>(cell: F, count: f32) -> F {
    let (zero, count_each) = (cell.splat(0.0), cell.splat(count));
    let turned = cell - (cell * (1.0 / count)).floor() * count;
    // The reciprocal is rounded, so that it may be a turn off.
    let turned = F::select(turned.lt(zero), turned + count, turned);
    F::select(turned.ge(count_each), turned - count, turned)
}
