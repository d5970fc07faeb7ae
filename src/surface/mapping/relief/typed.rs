//! The numbers of a relief, whichever kind they are.

use super::axis::Axis;
use super::walk_lanes::Stored;
use crate::texture::{Layout, Wrap};

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
    pub(super) fn displacement(&self, [x, y]: [f64; 2]) -> f64 {
        let (x, y) = (
            Axis::new(self.layout.size[0], x, 0.0),
            Axis::new(self.layout.size[1], y, 0.0),
        );
        let [a, b, c, d] = self.corners(&x, &y);
        let (fx, fy) = (x.fraction(0.0), y.fraction(0.0));
        a + (b - a) * fx + (c - a) * fy + (a - b - c + d) * fx * fy
    }

    pub(super) fn slope(&self, [x, y]: [f64; 2]) -> [f64; 2] {
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
    pub(super) fn extremes(&self, level: u32, [columns, rows]: [[u32; 3]; 2]) -> [f64; 2] {
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

    #[inline(always)]
    fn displaced(&self, stored: T) -> f64 {
        stored.into() * self.factor + self.offset
    }

    /// The largest displacement over the square of a cell of the picture, seen from the side of `sign`.
    #[inline(always)]
    pub(super) fn high(&self, level: u32, [i, j]: [u32; 2], sign: f64) -> f64 {
        let squares = self.layout.level(level);
        let [low, high] = squares.extremes(self.numbers, squares.at([i >> level, j >> level]));
        let stored = if self.factor * sign >= 0.0 { high } else { low };
        self.displaced(stored) * sign
    }

    /// [`Self::high`] over up to four squares.
    pub(super) fn highest(&self, level: u32, columns: [u32; 2], rows: [u32; 2], sign: f64) -> f64 {
        let high = |i, j| self.high(level, [i, j], sign);
        let row = |j| high(columns[0], j).max(high(columns[1], j));
        row(rows[0]).max(row(rows[1]))
    }

    /// Displacements at the corners of a cell.
    #[inline(always)]
    pub(super) fn corners(&self, x: &Axis, y: &Axis) -> [f64; 4] {
        let ([i0, i1], [j0, j1]) = (x.texels(self.wrap), y.texels(self.wrap));
        let texel = |i, j| self.displaced(self.numbers[self.layout.texel(i, j)]);
        [texel(i0, j0), texel(i1, j0), texel(i0, j1), texel(i1, j1)]
    }
}

/// The cell of a picture of `n` that repeats; most have a power of two, where no division is needed.
#[inline(always)]
pub(super) fn wrapped(cell: i64, n: u32) -> u32 {
    let n = i64::from(n);
    if n & (n - 1) == 0 {
        (cell & (n - 1)) as u32
    } else {
        cell.rem_euclid(n) as u32
    }
}
