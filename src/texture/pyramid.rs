//! Smallest and largest heights over squares of a height map: what a walk may skip without looking.

use super::{HeightMap, Wrap};
use crate::math::{Bits, Real as _};

/// The extremes of a height map over squares of 2^level cells, level 1 and up, beside the heights themselves.
///
/// A *cell* (i, j) lies between the centres of texels i…i+1 and j…j+1; over it the bilinear height stays
/// between its corners. A node of level 1 holds the extremes of up to 2 × 2 cells, one of every further level
/// those of up to 2 × 2 nodes below, until one node is left. Cells need no nodes: their corners say it. With the
/// texels, 16-bit heights take 4 to 6 bytes a texel, floats twice that.
///
/// Source: max mipmaps, Tevs et al. 2008; with minima for bounds of displaced triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightPyramid {
    layout: Layout,
    numbers: Numbers,
}

/// Texels and nodes in one piece.
#[derive(Debug, Clone, PartialEq)]
enum Numbers {
    U16(Vec<u16>),
    F32(Vec<f32>),
}

/// Where texels and nodes lie among the numbers.
///
/// First the texels, each row and column followed by what lies beyond the border. Then the nodes, two numbers
/// each: level after level along the picture's longer side, all with the same steps between neighbours. With as
/// much room as a power of two would need, the place of a node follows from level and square without a table,
/// in vector lanes, too.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout {
    /// Columns and rows of the picture.
    pub size: [u32; 2],
    /// The level with a single node, at least 1.
    pub top: u32,
    /// Numbers from a node to the next to the right, and to the next below.
    pub node_steps: [usize; 2],
    /// Index of the first number after all nodes.
    pub end: usize,
    /// Twice the numbers of all nodes.
    pub twice: usize,
}

/// Where the squares of one level lie among the numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Level {
    /// Index of the first number of square (0, 0).
    pub first: usize,
    /// From there to that of the next square to the right, and of the next below.
    pub steps: [usize; 2],
    /// A square's extremes are those of its first number, the one after, and the two so many numbers further.
    pub below: usize,
}

impl Layout {
    fn new([w, h]: [u32; 2]) -> Self {
        let long = w.max(h);
        let top = long.next_power_of_two().ilog2().max(1);
        let short = w.min(h).div_ceil(2) as usize;
        let node_steps = if w > h {
            [2 * short, 2]
        } else {
            [2, 2 * short]
        };
        let nodes = (2 * short) << top;
        Self {
            size: [w, h],
            top,
            node_steps,
            end: (w as usize + 1) * (h as usize + 1) + nodes,
            twice: 2 * nodes,
        }
    }

    /// Numbers in a row of texels.
    #[must_use]
    pub const fn texel_row(&self) -> usize {
        self.size[0] as usize + 1
    }

    /// Index of texel (x, y), or of what lies beyond the border where `x` or `y` is the picture's size.
    #[inline(always)]
    #[must_use]
    pub const fn texel(&self, x: u32, y: u32) -> usize {
        y as usize * self.texel_row() + x as usize
    }

    /// The squares of 2^level cells.
    #[inline(always)]
    #[must_use]
    pub const fn level(&self, level: u32) -> Level {
        if level == 0 {
            Level {
                first: 0,
                steps: [1, self.texel_row()],
                below: self.texel_row(),
            }
        } else {
            Level {
                first: self.end - (self.twice >> level),
                steps: self.node_steps,
                below: 0,
            }
        }
    }
}

impl Level {
    /// Index of the first number of a square.
    #[inline(always)]
    #[must_use]
    pub const fn at(&self, [i, j]: [u32; 2]) -> usize {
        self.first + i as usize * self.steps[0] + j as usize * self.steps[1]
    }

    /// Extremes of four squares together, of as many fours as there are lanes, in the numbers as they are stored.
    #[inline(always)]
    #[must_use]
    pub fn extremes_of_four<T: Number, B: Bits>(
        &self,
        numbers: &[T],
        [a, b, c, d]: [B; 4],
    ) -> [B::Real; 2] {
        let ([low_a, high_a], [low_b, high_b]) = (self.look(numbers, a), self.look(numbers, b));
        let ([low_c, high_c], [low_d, high_d]) = (self.look(numbers, c), self.look(numbers, d));
        [
            low_a.smaller(low_b).smaller(low_c.smaller(low_d)),
            high_a.larger(high_b).larger(high_c.larger(high_d)),
        ]
    }

    /// Extremes of the squares whose numbers begin at these indices.
    #[inline(always)]
    fn look<T: Number, B: Bits>(&self, numbers: &[T], at: B) -> [B::Real; 2] {
        let [a, b] = T::pairs(numbers, at);
        if self.below == 0 {
            return [a, b];
        }
        let [c, d] = T::pairs(numbers, at.plus(self.below as u32));
        [
            a.smaller(b).smaller(c.smaller(d)),
            a.larger(b).larger(c.larger(d)),
        ]
    }

    /// Extremes of the square whose numbers begin at an index.
    ///
    /// # Panics
    /// If it is no index of these numbers.
    #[inline(always)]
    #[must_use]
    pub fn extremes<T: Copy + PartialOrd>(&self, numbers: &[T], at: usize) -> [T; 2] {
        let pair = |at: usize| {
            let pair = &numbers[at..at + 2];
            [pair[0], pair[1]]
        };
        let [low, high] = pair(at);
        if self.below == 0 {
            return [low, high];
        }
        let [c, d] = pair(at + self.below);
        extremes([[low; 2], [high; 2], [c; 2], [d; 2]].into_iter())
    }
}

/// Numbers that heights are stored in.
pub trait Number: Sized {
    /// The numbers at indices, and those after them; both must be there.
    fn pairs<B: Bits>(numbers: &[Self], at: B) -> [B::Real; 2];
}

impl Number for u16 {
    #[inline(always)]
    fn pairs<B: Bits>(numbers: &[Self], at: B) -> [B::Real; 2] {
        let both = at.fetch_pair(numbers);
        [
            both.and(0xffff).signed_to_real(),
            both.shr(16).signed_to_real(),
        ]
    }
}

impl Number for f32 {
    #[inline(always)]
    fn pairs<B: Bits>(numbers: &[Self], at: B) -> [B::Real; 2] {
        let ([a], [b]) = (at.fetch(numbers), at.plus(1).fetch(numbers));
        [a.to_real(), b.to_real()]
    }
}

/// The numbers of a pyramid, in the form that its map stores.
#[derive(Debug, Clone, Copy)]
pub enum StoredHeights<'a> {
    /// Fractions of 65535.
    U16(&'a [u16]),
    /// Floats.
    F32(&'a [f32]),
}

impl HeightPyramid {
    /// The pyramid of a map that goes on beyond its border by `wrap`.
    #[must_use]
    pub fn new(map: &HeightMap, wrap: Wrap) -> Self {
        let layout = Layout::new([map.width(), map.height()]);
        let numbers = match map {
            HeightMap::U16(grid) => Numbers::U16(build(&layout, wrap, 0, |x, y| grid.at(x, y))),
            HeightMap::F32(grid) => Numbers::F32(build(&layout, wrap, 0.0, |x, y| grid.at(x, y))),
        };
        Self { layout, numbers }
    }

    /// Texels and nodes.
    #[must_use]
    pub fn stored(&self) -> StoredHeights<'_> {
        match &self.numbers {
            Numbers::U16(numbers) => StoredHeights::U16(numbers),
            Numbers::F32(numbers) => StoredHeights::F32(numbers),
        }
    }

    /// Where they lie.
    #[must_use]
    pub const fn layout(&self) -> Layout {
        self.layout
    }

    /// Whether it may be the pyramid of a map: one of its size, in the same numbers.
    #[must_use]
    pub fn fits(&self, map: &HeightMap) -> bool {
        let same_numbers = matches!(
            (map, &self.numbers),
            (HeightMap::U16(_), Numbers::U16(_)) | (HeightMap::F32(_), Numbers::F32(_))
        );
        same_numbers && self.layout.size == [map.width(), map.height()]
    }

    /// Smallest and largest stored height over the square of level `level` that cell (i, j) of the picture
    /// lies in.
    ///
    /// # Panics
    /// If the cell is outside the picture or the level above the top.
    #[must_use]
    pub fn extremes(&self, level: u32, [i, j]: [u32; 2]) -> [f32; 2] {
        let squares = self.layout.level(level);
        let at = squares.at([i >> level, j >> level]);
        match &self.numbers {
            Numbers::U16(all) => squares.extremes(all, at).map(super::height_map::fraction),
            Numbers::F32(all) => squares.extremes(all, at),
        }
    }

    /// Smallest and largest stored height of the whole map.
    #[must_use]
    pub fn range(&self) -> [f32; 2] {
        self.extremes(self.layout.top, [0, 0])
    }

    /// Heap bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        match &self.numbers {
            Numbers::U16(numbers) => size_of_val(numbers.as_slice()),
            Numbers::F32(numbers) => size_of_val(numbers.as_slice()),
        }
    }
}

fn build<T: Copy + PartialOrd>(
    layout: &Layout,
    wrap: Wrap,
    zero: T,
    texel: impl Fn(u32, u32) -> T,
) -> Vec<T> {
    let [w, h] = layout.size;
    let mut numbers = Vec::with_capacity(layout.end);
    let beyond = |i: u32, n| wrap.index(i64::from(i), n);
    for y in 0..=h {
        numbers.extend((0..=w).map(|x| texel(beyond(x, w), beyond(y, h))));
    }
    numbers.resize(layout.end, zero);
    for level in 1..=layout.top {
        let (fine, coarse) = (layout.level(level - 1), layout.level(level));
        let (columns, rows) = (w.div_ceil(1 << (level - 1)), h.div_ceil(1 << (level - 1)));
        for j in 0..rows.div_ceil(2) {
            for i in 0..columns.div_ceil(2) {
                let children = (2 * j..(2 * j + 2).min(rows))
                    .flat_map(|y| (2 * i..(2 * i + 2).min(columns)).map(move |x| fine.at([x, y])));
                let [low, high] = extremes(children.map(|at| fine.extremes(&numbers, at)));
                let at = coarse.at([i, j]);
                numbers[at] = low;
                numbers[at + 1] = high;
            }
        }
    }
    numbers
}

/// The extremes of at least one pair of extremes.
#[inline(always)]
fn extremes<T: Copy + PartialOrd>(mut pairs: impl Iterator<Item = [T; 2]>) -> [T; 2] {
    // Every square has a corner; the maps hold no NaN.
    let [mut low, mut high] = pairs.next().unwrap_or_else(|| unreachable!());
    for [a, b] in pairs {
        low = if a < low { a } else { low };
        high = if b > high { b } else { high };
    }
    [low, high]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::Grid;

    #[test]
    fn every_node_holds_the_extremes_of_its_cells() {
        for (w, h) in [(1, 1), (2, 2), (5, 3), (8, 8), (7, 1), (1, 9), (3, 17)] {
            let value = |x: u32, y: u32| ((x * 7919 + y * 104_729) % 1000) as u16;
            let texels = (0..h).flat_map(|y| (0..w).map(move |x| value(x, y)));
            let map = HeightMap::U16(Grid::new(w, h, texels.collect()));
            for wrap in Wrap::ALL {
                let pyramid = HeightPyramid::new(&map, wrap);
                for level in 0..=pyramid.layout().top {
                    check_level(&map, wrap, &pyramid, level);
                }
                let top = pyramid.layout().top;
                assert_eq!(pyramid.range(), pyramid.extremes(top, [w - 1, h - 1]));
            }
        }
    }

    fn check_level(map: &HeightMap, wrap: Wrap, pyramid: &HeightPyramid, level: u32) {
        let (w, h) = (map.width(), map.height());
        for (i, j) in (0..h).flat_map(|j| (0..w).map(move |i| (i, j))) {
            let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
            let span =
                |k: u32, n| (k >> level << level)..((k >> level << level) + (1 << level)).min(n);
            for (x, y) in span(j, h).flat_map(|y| span(i, w).map(move |x| (x, y))) {
                for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    let column = wrap.index(i64::from(x) + dx, w);
                    let texel = map.texel(column, wrap.index(i64::from(y) + dy, h));
                    (low, high) = (low.min(texel), high.max(texel));
                }
            }
            assert_eq!(
                pyramid.extremes(level, [i, j]),
                [low, high],
                "{wrap:?} {level}"
            );
        }
    }
}
