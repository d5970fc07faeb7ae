//! One axis of a walk over texels: an exact cell index beside an inexact place.

use crate::texture::Wrap;

/// Where a walk stands along one axis of a picture that goes on for ever.
///
/// Places are counted in texels, whole numbers at texel centres. Cells are counted in copies of the
/// picture (`base`, a whole multiple of the picture's size) and within one (`local`), so that rounding of
/// the place can never put the walk into a cell twice or past one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axis {
    n: u32,
    local: u32,
    forward: bool,
    /// Place at parameter 0.
    start: f64,
    /// Texels per unit of the parameter.
    rate: f64,
    inv_rate: f64,
    base: f64,
}

/// Cells `[first, end)` of the copy that the walk is in.
#[derive(Debug, Clone, Copy)]
pub(super) struct Span {
    first: u32,
    end: u32,
}

impl Axis {
    /// A walk that starts at `start` on an axis of `n` texels.
    #[inline(always)]
    pub fn new(n: u32, start: f64, rate: f64) -> Self {
        let whole = start as i64;
        let cell = whole - i64::from(start < whole as f64);
        let size = i64::from(n);
        let tile = if (0..size).contains(&cell) {
            0
        } else {
            cell.div_euclid(size)
        };
        Self {
            n,
            local: (cell - tile * size) as u32,
            // An axis without motion is left towards the far end, at infinity.
            forward: rate >= 0.0,
            start,
            rate,
            inv_rate: 1.0 / rate.abs(),
            base: (tile * size) as f64,
        }
    }

    /// Place at a parameter.
    #[inline(always)]
    pub fn at(&self, tau: f64) -> f64 {
        self.start + self.rate * tau
    }

    /// Place in the cell that the walk is in, `[0, 1]`.
    #[inline(always)]
    pub fn fraction(&self, tau: f64) -> f64 {
        let inside = self.at(tau) - (self.base + f64::from(self.local));
        inside.clamp(0.0, 1.0)
    }

    /// Texels per unit of the parameter.
    #[inline(always)]
    pub const fn rate(&self) -> f64 {
        self.rate
    }

    /// The square of this level that the walk is in.
    #[inline(always)]
    pub fn span(&self, level: u32) -> Span {
        let first = self.local >> level << level;
        Span {
            first,
            end: (first + (1 << level)).min(self.n),
        }
    }

    /// The parameter at which the walk leaves a span; infinite if it never does.
    #[inline(always)]
    pub fn exit(&self, span: Span) -> f64 {
        let way = if self.forward {
            self.base + f64::from(span.end) - self.start
        } else {
            self.start - (self.base + f64::from(span.first))
        };
        way * self.inv_rate
    }

    /// Goes on to the cell beyond the span; says whether its square of the next level is another one.
    #[inline(always)]
    pub fn cross(&mut self, span: Span, level: u32) -> bool {
        let before = self.local >> (level + 1);
        if self.forward {
            self.local = span.end;
            if span.end == self.n {
                self.local = 0;
                self.base += f64::from(self.n);
                return true;
            }
        } else if span.first == 0 {
            self.local = self.n - 1;
            self.base -= f64::from(self.n);
            return true;
        } else {
            self.local = span.first - 1;
        }
        self.local >> (level + 1) != before
    }

    /// Takes the cell from the place, but no other than one of the span.
    #[inline(always)]
    pub fn settle(&mut self, span: Span, tau: f64) {
        // Below 0 becomes 0.
        let cell = (self.at(tau) - self.base) as u32;
        self.local = cell.max(span.first).min(span.end - 1);
    }

    /// The cell in the picture.
    #[inline(always)]
    pub const fn local(&self) -> u32 {
        self.local
    }

    /// The picture's two cells whose squares cover a span; mostly twice the same.
    #[inline(always)]
    pub fn cells(&self, span: Span, wrap: Wrap) -> [u32; 2] {
        let is_mirrored = || (self.base / f64::from(self.n)) as i64 & 1 != 0;
        match wrap {
            Wrap::Repeat => [self.local; 2],
            Wrap::Clamp if self.base < 0.0 => [0; 2],
            Wrap::Clamp if self.base > 0.0 => [self.n - 1; 2],
            // Backwards, cell i lies between texels n−1−i and n−2−i: the picture's cell n−2−i.
            Wrap::Mirror if is_mirrored() => {
                let backwards = |i: u32| (self.n - 1).saturating_sub(i + 1);
                [backwards(span.end - 1), backwards(span.first)]
            }
            Wrap::Clamp | Wrap::Mirror => [self.local; 2],
        }
    }

    /// Texels on both sides of the cell.
    #[inline(always)]
    pub fn texels(&self, wrap: Wrap) -> [u32; 2] {
        if wrap == Wrap::Repeat {
            let next = self.local + 1;
            return [self.local, if next == self.n { 0 } else { next }];
        }
        let i = self.base as i64 + i64::from(self.local);
        [wrap.index(i, self.n), wrap.index(i + 1, self.n)]
    }
}
