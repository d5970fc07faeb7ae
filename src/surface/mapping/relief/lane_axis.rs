//! [`Axis`](super::axis::Axis) in vector lanes: whole numbers are doubles, too.

use crate::math::simd::{
    ExtractToken as _, Select as _, Simd, SimdBase as _, SimdFloat as _, merged,
};

/// Where walks stand along one axis.
#[derive(Clone, Copy)]
pub(super) struct LaneAxis<S: Simd> {
    start: S::f64s,
    rate: S::f64s,
    inv_rate: S::f64s,
    base: S::f64s,
    local: S::f64s,
    forward: S::mask64s,
}

/// The squares that walks are in, along one axis.
#[derive(Clone, Copy)]
pub(super) struct LaneSpan<S: Simd> {
    /// Number of the square.
    pub square: S::f64s,
    first: S::f64s,
    end: S::f64s,
}

impl<S: Simd> LaneAxis<S> {
    /// Walks that stand still.
    #[inline(always)]
    pub fn idle(simd: S) -> Self {
        let (zero, one) = (S::f64s::splat(simd, 0.0), S::f64s::splat(simd, 1.0));
        Self {
            start: zero,
            rate: zero,
            inv_rate: one,
            base: zero,
            local: zero,
            forward: zero.simd_ge(0.0),
        }
    }

    /// Starts the lanes of `taken`, each at a place with a rate, on an axis of `n` texels.
    #[inline(always)]
    pub fn take(&mut self, n: S::f64s, taken: S::mask64s, [start, rate]: [S::f64s; 2]) {
        let simd = start.token();
        let (zero, one) = (S::f64s::splat(simd, 0.0), S::f64s::splat(simd, 1.0));
        let cell = start.floor();
        // The quotient is rounded, so that it may be a copy off; the rest is exact.
        let tile = (cell / n).floor();
        let rest = cell - tile * n;
        let (under, over) = (rest.simd_lt(zero), rest.simd_ge(n));
        let tile = under.select(tile - 1.0, over.select(tile + 1.0, tile));
        let base = tile * n;
        self.start = merged(taken, start, self.start);
        self.rate = merged(taken, rate, self.rate);
        self.inv_rate = merged(taken, one / rate.abs(), self.inv_rate);
        self.base = merged(taken, base, self.base);
        self.local = merged(taken, cell - base, self.local);
        self.forward = self.rate.simd_ge(0.0);
    }

    /// All lanes at places on an axis of `n` texels.
    #[inline(always)]
    pub fn at_rest(simd: S, n: S::f64s, place: S::f64s) -> Self {
        let zero = S::f64s::splat(simd, 0.0);
        let mut axis = Self::idle(simd);
        axis.take(n, zero.simd_eq(zero), [place, zero]);
        axis
    }

    /// The cell in the picture that each walk is in.
    #[inline(always)]
    pub const fn cell(&self) -> S::f64s {
        self.local
    }

    /// Texels per unit of the parameter.
    #[inline(always)]
    pub const fn rate(&self) -> S::f64s {
        self.rate
    }

    #[inline(always)]
    fn at(&self, tau: S::f64s) -> S::f64s {
        self.start + self.rate * tau
    }

    /// Place in the cell.
    #[inline(always)]
    pub fn fraction(&self, tau: S::f64s) -> S::f64s {
        let inside = self.at(tau) - (self.base + self.local);
        inside.max(0.0).min(1.0)
    }

    /// `size` is the side of each square, `inv` one over it; `n` texels are in the picture.
    #[inline(always)]
    pub fn span(&self, n: S::f64s, size: S::f64s, inv: S::f64s) -> LaneSpan<S> {
        let square = (self.local * inv).floor();
        let first = square * size;
        LaneSpan {
            square,
            first,
            end: (first + size).min(n),
        }
    }

    /// Parameter at which each walk leaves its span.
    #[inline(always)]
    pub fn exit(&self, span: LaneSpan<S>) -> S::f64s {
        let ahead = self.base + self.forward.select(span.end, span.first);
        let way = ahead - self.start;
        self.forward.select(way, -way) * self.inv_rate
    }

    /// Where the lanes of `mask` cross into the cell beyond the span; returns those among them whose square of
    /// the next level is another one.
    #[inline(always)]
    pub fn cross(&mut self, n: S::f64s, span: LaneSpan<S>, mask: S::mask64s) -> S::mask64s {
        let simd = self.local.token();
        let zero = S::f64s::splat(simd, 0.0);
        let forward = self.forward;
        let wraps = (forward & span.end.simd_eq(n)) | (!forward & span.first.simd_eq(zero));
        let beyond = forward.select(span.end, span.first - 1.0);
        let turned = forward.select(zero, n - 1.0);
        let moved = self.base + forward.select(n, -n);
        self.local = merged(mask, wraps.select(turned, beyond), self.local);
        self.base = merged(mask & wraps, moved, self.base);
        // Of two squares that share one of the next level, the even one is first.
        let pair = (span.square * 0.5).floor();
        let odd = !(pair + pair).simd_eq(span.square);
        let leaves = (forward & odd) | !(forward | odd);
        mask & (wraps | leaves)
    }

    /// Takes the cell of the lanes of `mask` from the place, but no other than one of the span.
    #[inline(always)]
    pub fn settle(&mut self, span: LaneSpan<S>, tau: S::f64s, mask: S::mask64s) {
        let cell = (self.at(tau) - self.base).floor();
        let cell = cell.max(span.first).min(span.end - 1.0);
        self.local = merged(mask, cell, self.local);
    }
}
