//! A rectangle of texels and the address arithmetic of bilinear look-ups.

use super::Wrap;
use crate::math::{Bits, Real, V2, Words};

/// `width · height` texels, row 0 on top.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid<T> {
    width: u32,
    height: u32,
    texels: Vec<T>,
}

/// How `N` channels are read from the `B` words of a texel.
///
/// A trait, because a function that is handed on as a value is compiled without the vector instructions of its caller.
pub(super) trait Decode<const B: usize, const N: usize>: Copy {
    /// The channels.
    fn decode<F: Real>(self, words: [F::Bits; B]) -> [F; N];
}

/// Channels that are stored as floats.
#[derive(Clone, Copy)]
pub(super) struct Floats;

impl<const N: usize> Decode<N, N> for Floats {
    #[inline(always)]
    fn decode<F: Real>(self, words: [F::Bits; N]) -> [F; N] {
        let mut floats = [words[0].to_real(); N];
        for n in 1..N {
            floats[n] = words[n].to_real();
        }
        floats
    }
}

/// Four texel indices around a point and its place between them; with vector lanes, for each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BilinearCell<F: Real = f32> {
    /// Indices of the texels at (column, row) = (i, j), (i+1, j), (i, j+1), (i+1, j+1).
    pub texels: [F::Bits; 4],
    /// Fraction towards column i+1, in `[0, 1)`.
    pub fx: F,
    /// Fraction towards row j+1, in `[0, 1)`.
    pub fy: F,
}

impl<T: Copy> Grid<T> {
    /// Wraps texels in rows from the top.
    ///
    /// # Panics
    /// If the count is not `width · height`, or either is 0.
    #[must_use]
    pub fn new(width: u32, height: u32, texels: Vec<T>) -> Self {
        assert!(width > 0 && height > 0, "a grid has at least one texel");
        assert_eq!(
            texels.len(),
            width as usize * height as usize,
            "a grid has width times height texels"
        );
        Self {
            width,
            height,
            texels,
        }
    }

    /// Columns.
    #[must_use]
    pub const fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    #[must_use]
    pub const fn height(&self) -> u32 {
        self.height
    }

    /// All texels in rows from the top.
    #[must_use]
    pub fn texels(&self) -> &[T] {
        &self.texels
    }

    /// The texel in column `x`, row `y`.
    ///
    /// # Panics
    /// If it is outside.
    #[must_use]
    pub fn at(&self, x: u32, y: u32) -> T {
        self.texels[y as usize * self.width as usize + x as usize]
    }

    /// Where `st` falls: s to the right and t downwards, both 0…1 across the picture, texel centres at
    /// `(i + ½) / size`. Non-finite coordinates count as 0.
    #[must_use]
    #[inline(always)]
    pub fn cell<F: Real>(&self, st: V2<F>, wrap: Wrap) -> BilinearCell<F> {
        let (i0, i1, fx) = wrap.neighbours(st.x, self.width);
        let (j0, j1, fy) = wrap.neighbours(st.y, self.height);
        let (row0, row1) = (j0.times(self.width), j1.times(self.width));
        BilinearCell {
            texels: [
                row0.plus_each(i0),
                row0.plus_each(i1),
                row1.plus_each(i0),
                row1.plus_each(i1),
            ],
            fx,
            fy,
        }
    }

    /// Has memory bring what will be looked up around `st` soon: the lower texels, beside which the upper ones were
    /// looked up just before where neighbours go down the picture.
    #[inline(always)]
    pub(super) fn prefetch<F: Real>(&self, st: V2<F>, wrap: Wrap) {
        let (column, _, _) = wrap.neighbours(st.x, self.width);
        let (_, row, _) = wrap.neighbours(st.y, self.height);
        row.times(self.width)
            .plus_each(column)
            .prefetch(&self.texels);
    }

    /// Bilinear means of `N` channels.
    #[inline(always)]
    pub(super) fn mix<F: Real, const N: usize, const B: usize>(
        &self,
        cell: &BilinearCell<F>,
        how: impl Decode<B, N>,
    ) -> [F; N]
    where
        T: Words<B>,
    {
        let [a, b, c, d] = self.corners(cell, how);
        let mut mixed = a;
        for n in 0..N {
            mixed[n] = cell.mix([a[n], b[n], c[n], d[n]]);
        }
        mixed
    }

    /// The channels of the four corners.
    #[inline(always)]
    pub(super) fn corners<F: Real, const N: usize, const B: usize>(
        &self,
        cell: &BilinearCell<F>,
        how: impl Decode<B, N>,
    ) -> [[F; N]; 4]
    where
        T: Words<B>,
    {
        let [a, b, c, d] = cell.texels;
        let texels = &*self.texels;
        [
            how.decode(a.fetch(texels)),
            how.decode(b.fetch(texels)),
            how.decode(c.fetch(texels)),
            how.decode(d.fetch(texels)),
        ]
    }
}

impl Wrap {
    /// The two texels around coordinate `c` (0…1 across `n` texels) and the fraction between them.
    ///
    /// Worked out in whole floats, which are exact up to 2²⁴ texels a line.
    #[inline(always)]
    pub(super) fn neighbours<F: Real>(self, c: F, n: u32) -> (F::Bits, F::Bits, F) {
        let zero = c.splat(0.0);
        let c = F::select(c.is_finite(), c, zero);
        let (count, last) = (n as f32, (n - 1) as f32);
        let turned = match self {
            // Taking off whole turns first is exact and keeps the fraction's precision.
            Self::Repeat => c - c.floor(),
            Self::Clamp => c.larger(c.splat(-1.0)).smaller(c.splat(2.0)),
            Self::Mirror => c - (c * 0.5).floor() * 2.0,
        };
        let x = turned * count - 0.5;
        let below = x.floor();
        let above = below + 1.0;
        let (count, last) = (c.splat(count), c.splat(last));
        let within = |i: F| i.larger(zero).smaller(last);
        let (first, second) = match self {
            Self::Repeat => (
                F::select(below.lt(zero), last, below.smaller(last)),
                F::select(above.lt(count), above, zero),
            ),
            Self::Clamp => (within(below), within(above)),
            // Between 0 and 2n; the second copy runs backwards.
            Self::Mirror => {
                let mirrored = |i: F| F::select(i.lt(count), i, count + count - i - 1.0);
                (within(mirrored(below)), within(mirrored(above)))
            }
        };
        (first.to_index(), second.to_index(), x - below)
    }
}

impl<F: Real> BilinearCell<F> {
    /// The bilinear mean of four corner values in the order of `texels`.
    #[must_use]
    #[inline(always)]
    pub fn mix(&self, [a, b, c, d]: [F; 4]) -> F {
        let top = a + (b - a) * self.fx;
        let bottom = c + (d - c) * self.fx;
        top + (bottom - top) * self.fy
    }

    /// Derivatives of [`mix`](Self::mix) per texel, to the right and downwards.
    #[must_use]
    #[inline(always)]
    pub fn slope_per_texel(&self, [a, b, c, d]: [F; 4]) -> V2<F> {
        let right = (b - a) + ((d - c) - (b - a)) * self.fy;
        let down = (c - a) + ((d - b) - (c - a)) * self.fx;
        V2::new(right, down)
    }
}
