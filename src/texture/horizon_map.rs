//! How steeply a ray must leave a height map to meet nothing of it any more: what spares shadows their walks.

use rayon::prelude::*;

use super::HeightMap;
use crate::math::fetch::{WHOLE, wide_pairs};
use crate::math::simd::{Bytes as _, Select as _, Simd, SimdBase as _, SimdFloat as _};
use crate::math::{Bits, Real, V2};

/// Cells along a side of a block.
const BLOCK: i32 = 2;

/// Eighths of the compass that a block tells apart; see [`sector`].
const SECTORS: usize = 8;

/// How far beyond the cells of a block, in cells, its horizon follows from how steep the map is there.
const STEEP: i32 = 1;

/// Squares seen from a block get twice as wide with each doubling of their distance: this many cells away they are
/// still single cells.
const FINE: i32 = 8;

/// As many texels away every horizon ends; what is farther may be as high as the highest texel.
const REACH: i32 = 128;

/// Blocks around the map that its blocks see.
const PAD: usize = (REACH / BLOCK) as usize + 1;

/// Texels that a place may be off by and still belong to a block.
const MARGIN: f32 = 1.0 / 64.0;

/// Heights are rounded by less, as a share of the map's range.
const ROUNDING: f32 = 1e-6;

/// By so much slopes are raised for what their own roundings and those of directions come to.
const SLACK: (f32, f32) = (1.001, 1e-5);

/// What a code 0 stands for: 2⁻¹⁴. Four bits of a code are the mantissa.
const LEAST_BITS: u32 = (127 - 14) << 23;
const CODE_SHIFT: u32 = 19;

/// For every block of 2 × 2 cells of a map that repeats, and every eighth of the compass, a slope: a ray that leaves from
/// anywhere on or over the block and rises at least so much is above the relief for ever. Slopes are shares of the map's
/// range per texel, rounded up. Two bytes a texel.
///
/// A bound, not the horizon itself: a ray that is no steeper may still be in nobody's way.
///
/// Source: horizon mapping, Max 1988, which takes such angles for the shadow itself.
#[derive(Debug, Clone, PartialEq)]
pub struct HorizonMap {
    columns: u32,
    /// Four numbers a block, one code in each byte; rows from the top.
    codes: Vec<u16>,
}

impl HorizonMap {
    /// The horizons of a map; `inverted` turns the heights over first. A tenth of a second for a million texels on one
    /// thread; runs on the current rayon pool.
    #[must_use]
    pub fn new(map: &HeightMap, inverted: bool) -> Self {
        let [columns, rows] = [map.width(), map.height()].map(|n| n.div_ceil(BLOCK as u32));
        let heights = Heights::new(map, inverted);
        let levels = heights.levels([columns as usize, rows as usize]);
        let near = Square::around(1, (-STEEP, BLOCK + STEEP), FINE);
        let mut codes = vec![0; SECTORS / 2 * columns as usize * rows as usize];
        codes
            .par_chunks_mut(SECTORS / 2 * columns as usize)
            .enumerate()
            .for_each(|(row, codes)| {
                let slopes = heights.slopes(columns as usize, row, &near, &levels);
                for (i, pairs) in codes.chunks_exact_mut(SECTORS / 2).enumerate() {
                    for (s, slopes) in slopes.iter().enumerate() {
                        pairs[s / 2] |= code(slopes[i]) << (8 * (s % 2));
                    }
                }
            });
        Self { columns, codes }
    }

    /// The slope for rays from a cell of the picture, in a direction that counts in texels.
    #[inline(always)]
    #[must_use]
    pub fn slope<F: Real>(&self, [i, j]: [F::Bits; 2], toward: V2<F>) -> F {
        let zero = toward.x.splat(0.0);
        let block = j.shr(1).times(self.columns).plus_each(i.shr(1));
        let (left, up) = (toward.x.lt(zero), toward.y.lt(zero));
        let steep = toward.x.abs().lt(toward.y.abs());
        let half = F::Bits::select(up, block.splat(2), block.splat(0));
        let word = block.times(4).plus_each(half).fetch_pair(&self.codes);
        let word = F::Bits::select(left, word.shr(16), word);
        let word = F::Bits::select(steep, word.shr(8), word);
        word.and(0xff).shl(CODE_SHIFT).plus(LEAST_BITS).to_real()
    }

    /// [`Self::slope`] for a direction in doubles.
    #[inline]
    #[must_use]
    pub fn slope_towards(&self, [i, j]: [u32; 2], [x, y]: [f64; 2]) -> f64 {
        let block =
            (j / BLOCK as u32) as usize * self.columns as usize + (i / BLOCK as u32) as usize;
        let (left, up, steep) = (x < 0.0, y < 0.0, x.abs() < y.abs());
        let pair = self.codes[4 * block + 2 * usize::from(up) + usize::from(left)];
        let code = u32::from(pair >> (8 * u32::from(steep)) & 0xff);
        f64::from(f32::from_bits(LEAST_BITS + (code << CODE_SHIFT)))
    }

    /// [`Self::slope_towards`] in vector lanes; cells are whole numbers.
    #[inline(always)]
    #[must_use]
    pub fn slopes<S: Simd>(&self, simd: S, [i, j]: [S::f64s; 2], [x, y]: [S::f64s; 2]) -> S::f64s {
        let zero = S::f64s::splat(simd, 0.0);
        let (left, up) = (x.simd_lt(zero), y.simd_lt(zero));
        let steep = x.abs().simd_lt(y.abs());
        let block = (j * 0.5).floor() * f64::from(self.columns) + (i * 0.5).floor();
        let half = up.select(S::f64s::splat(simd, 2.0), zero);
        let word = wide_pairs::<S>(&self.codes, block * 4.0 + half + WHOLE);
        let word = moved_where::<S>(left, word, 16);
        let word = moved_where::<S>(steep, word, 8) & S::u64s::splat(simd, 0xff);
        let least = u64::from((LEAST_BITS >> 23) + 1023 - 127) << 52;
        ((word << (52 - 23 + CODE_SHIFT)) + S::u64s::splat(simd, least)).bitcast()
    }

    /// Heap bytes.
    #[must_use]
    pub const fn bytes(&self) -> usize {
        size_of_val(self.codes.as_slice())
    }
}

/// Numbers moved down by so many bits where a mask holds.
#[inline(always)]
fn moved_where<S: Simd>(mask: S::mask64s, word: S::u64s, by: u32) -> S::u64s {
    // Blended as doubles, bit by bit.
    let moved = (word >> by).bitcast::<S::f64s>();
    mask.select(moved, word.bitcast()).bitcast()
}

/// The signs of the directions of a sector, and whether they are nearer to the y axis.
const fn sector(s: usize) -> ([f32; 2], bool) {
    let left = if s & 2 == 0 { 1.0 } else { -1.0 };
    let up = if s & 4 == 0 { 1.0 } else { -1.0 };
    ([left, up], s & 1 != 0)
}

/// The code of the next larger slope that has one.
fn code(slope: f32) -> u16 {
    let raised = slope.max(0.0) * SLACK.0 + SLACK.1;
    let above = raised.to_bits().saturating_sub(LEAST_BITS);
    // No height over a cell rises by more than √2 of the range.
    above.div_ceil(1 << CODE_SHIFT).min(0xff) as u16
}

/// A square of cells as a block at (0, 0) sees it.
#[derive(Debug, Clone, Copy)]
struct Square {
    /// Its first cell.
    at: [i32; 2],
    /// One over the distance to it.
    per_distance: f32,
    /// Sectors in which some way from the block leads to it.
    sectors: [bool; SECTORS],
}

impl Square {
    /// Squares of `side` cells up to `reach` cells around the block, without those between `inner` on both axes.
    fn around(side: i32, inner: (i32, i32), reach: i32) -> Vec<Self> {
        let ends = || (-reach..BLOCK + reach).step_by(side as usize);
        let within = |at: i32| inner.0 <= at && at + side <= inner.1;
        ends()
            .flat_map(|y| ends().map(move |x| [x, y]))
            .filter(|&[x, y]| !(within(x) && within(y)))
            .map(|at| Self::new(at, side))
            .collect()
    }

    fn new(at: [i32; 2], side: i32) -> Self {
        let gap = at.map(|at| (at - BLOCK).max(-(at + side)).max(0) as f32);
        // Ways from anywhere in the block to anywhere in the square.
        let ways = at.map(|at| [(at - BLOCK) as f32, (at + side) as f32]);
        let leads = |s: usize| {
            let (signs, steep) = sector(s);
            let [a, b] = [0, 1].map(|k| {
                let [low, high] = ways[k].map(|way| way * signs[k]);
                [low.min(high), low.max(high)]
            });
            let (far, near) = if steep { (b, a) } else { (a, b) };
            near[1] > 0.0 && far[1] > near[0].max(0.0)
        };
        Self {
            at,
            per_distance: 1.0 / (gap[0].hypot(gap[1]) - MARGIN),
            sectors: std::array::from_fn(leads),
        }
    }
}

/// Largest heights over squares of one size, wherever they begin at whole blocks.
struct Level {
    squares: Vec<Square>,
    /// Numbers in a row, which begins [`PAD`] blocks before the first of the map.
    row: usize,
    highest: Vec<f32>,
}

/// Heights between 0 and 1, the map's own range.
struct Heights {
    size: [i32; 2],
    values: Vec<f32>,
}

impl Heights {
    fn new(map: &HeightMap, inverted: bool) -> Self {
        /// Shares of the range; differences of stored numbers, which lose nothing of a small range.
        fn shares<T: Copy + PartialOrd + Into<f64>>(texels: &[T]) -> Vec<f32> {
            let numbers = || texels.iter().map(|&t| t.into());
            let low = numbers().fold(f64::INFINITY, f64::min);
            let high = numbers().fold(f64::NEG_INFINITY, f64::max);
            let range = if high > low { high - low } else { 1.0 };
            numbers().map(|h| ((h - low) / range) as f32).collect()
        }
        let mut values = match map {
            HeightMap::U16(grid) => shares(grid.texels()),
            HeightMap::F32(grid) => shares(grid.texels()),
        };
        if inverted {
            for value in &mut values {
                *value = 1.0 - *value;
            }
        }
        Self {
            size: [map.width() as i32, map.height() as i32],
            values,
        }
    }

    /// Heights of a row of texels from column `first` on, wherever they are.
    fn row(&self, y: i32, first: i32, count: usize) -> Vec<f32> {
        let [w, h] = self.size.map(|n| n as usize);
        let from = y.rem_euclid(h as i32) as usize * w;
        let row = &self.values[from..from + w];
        let mut at = first.rem_euclid(w as i32) as usize;
        let mut heights = Vec::with_capacity(count);
        while heights.len() < count {
            let end = w.min(at + count - heights.len());
            heights.extend_from_slice(&row[at..end]);
            at = 0;
        }
        heights
    }

    /// Largest height of each cell of a row.
    fn cells(&self, y: i32, first: i32, count: usize) -> Vec<f32> {
        let upper = self.row(y, first, count + 1);
        let lower = self.row(y + 1, first, count + 1);
        let columns: Vec<f32> = upper.iter().zip(&lower).map(|(a, b)| a.max(*b)).collect();
        columns
            .windows(2)
            .map(|pair| pair[0].max(pair[1]))
            .collect()
    }

    /// What blocks see from [`FINE`] cells on.
    fn levels(&self, count: [usize; 2]) -> Vec<Level> {
        // As many blocks beyond the last, and the width of the widest square.
        let [w, h] = count.map(|n| n + 3 * PAD);
        let start = -(PAD as i32) * BLOCK;
        let blocks: Vec<f32> = (0..h as i32)
            .into_par_iter()
            .flat_map_iter(|j| {
                let y = start + j * BLOCK;
                let rows = [0, 1].map(|dy| self.cells(y + dy, start, w * BLOCK as usize));
                let [upper, lower] = rows;
                let pairs = upper.into_iter().zip(lower).map(|(a, b)| a.max(b));
                let pairs: Vec<f32> = pairs.collect();
                let blocks = pairs.chunks_exact(2).map(|pair| pair[0].max(pair[1]));
                blocks.collect::<Vec<_>>()
            })
            .collect();
        let level = |side: i32, reach: i32, highest| Level {
            squares: Square::around(side, (-reach, BLOCK + reach), 2 * reach),
            row: w,
            highest,
        };
        let (mut side, mut reach) = (BLOCK, FINE);
        let mut levels = vec![level(side, reach, blocks)];
        while 2 * reach < REACH {
            let finer = &levels[levels.len() - 1].highest;
            let highest = widened(finer, [w, h], (side / BLOCK) as usize);
            (side, reach) = (2 * side, 2 * reach);
            levels.push(level(side, reach, highest));
        }
        levels
    }

    /// The slopes of a row of blocks, for each sector.
    fn slopes(
        &self,
        count: usize,
        row: usize,
        near: &[Square],
        levels: &[Level],
    ) -> [Vec<f32>; SECTORS] {
        let y = row as i32 * BLOCK;
        let mut slopes = self.steepest(count, y);
        let lows = self.lows(count, y, &slopes);
        let cells = count * BLOCK as usize + 2 * FINE as usize;
        let rows: Vec<[Vec<f32>; 2]> = (-FINE..BLOCK + FINE)
            .map(|dy| {
                let cells = self.cells(y + dy, -FINE, cells);
                [0, 1].map(|odd| cells.iter().copied().skip(odd).step_by(2).collect())
            })
            .collect();
        for square in near {
            let [x, y] = square.at.map(|at| (at + FINE) as usize);
            let seen = &rows[y][x % 2][x / 2..];
            raise(&mut slopes, seen, &lows, square);
        }
        for level in levels {
            for square in &level.squares {
                let [x, y] = square.at.map(|at| at / BLOCK + PAD as i32);
                let from = (row + y as usize) * level.row + x as usize;
                raise(&mut slopes, &level.highest[from..], &lows, square);
            }
        }
        for slopes in &mut slopes {
            for (slope, low) in slopes.iter_mut().zip(&lows) {
                *slope = slope.max((1.0 - low) / (REACH as f32 - MARGIN));
            }
        }
        slopes
    }

    /// How steeply the map rises around the blocks of a row: ways that stay there rise no more.
    fn steepest(&self, count: usize, y: i32) -> [Vec<f32>; SECTORS] {
        let cells = count * BLOCK as usize + 2 * STEEP as usize;
        let mut slopes: [Vec<f32>; SECTORS] = std::array::from_fn(|_| vec![0.0; count]);
        let mut columns = vec![[0.0_f32; SECTORS]; cells];
        for dy in -STEEP..BLOCK + STEEP {
            let upper = self.row(y + dy, -STEEP, cells + 1);
            let lower = self.row(y + dy + 1, -STEEP, cells + 1);
            for (x, column) in columns.iter_mut().enumerate() {
                let corners = [upper[x], upper[x + 1], lower[x], lower[x + 1]];
                let rises = rises(corners);
                for s in 0..SECTORS {
                    column[s] = column[s].max(rises[s]);
                }
            }
        }
        let wide = (BLOCK + 2 * STEEP) as usize;
        for (s, slopes) in slopes.iter_mut().enumerate() {
            for (i, slope) in slopes.iter_mut().enumerate() {
                let around = &columns[i * BLOCK as usize..][..wide];
                *slope = around.iter().map(|column| column[s]).fold(0.0, f32::max);
            }
        }
        slopes
    }

    /// Lower than all of each block of a row, and than all that is [`MARGIN`] beyond.
    fn lows(&self, count: usize, y: i32, steepest: &[Vec<f32>; SECTORS]) -> Vec<f32> {
        let texels = count * BLOCK as usize + 1;
        let mut columns = vec![1.0_f32; texels];
        for dy in 0..=BLOCK {
            for (column, height) in columns.iter_mut().zip(self.row(y + dy, 0, texels)) {
                *column = column.min(height);
            }
        }
        let low = |i: usize| {
            let around = &columns[i * BLOCK as usize..=(i + 1) * BLOCK as usize];
            let low = around.iter().copied().fold(1.0, f32::min);
            let steepest = steepest.iter().map(|slopes| slopes[i]).fold(0.0, f32::max);
            low - steepest * MARGIN - ROUNDING
        };
        (0..count).map(low).collect()
    }
}

/// How steeply a cell with these corners rises at the most, for each sector.
fn rises([a, b, c, d]: [f32; 4]) -> [f32; SECTORS] {
    let (right, down) = ([b - a, d - c], [c - a, d - b]);
    let extremes = |pair: [f32; 2]| [pair[0].max(pair[1]), -pair[0].min(pair[1])];
    let (right, down) = (extremes(right), extremes(down));
    std::array::from_fn(|s| {
        // Over the cell the change along each axis lies between those of its sides.
        let (x, y) = (right[s >> 1 & 1], down[s >> 2]);
        let (main, other) = if s & 1 == 0 { (x, y) } else { (y, x) };
        if other >= 0.0 && main >= other {
            (main * main + other * other).sqrt()
        } else {
            main.max((main + other) * std::f32::consts::FRAC_1_SQRT_2)
        }
    })
}

/// Raises the slopes of a row of blocks to see over a square each.
fn raise(slopes: &mut [Vec<f32>; SECTORS], seen: &[f32], lows: &[f32], square: &Square) {
    for (slopes, leads) in slopes.iter_mut().zip(square.sectors) {
        if !leads {
            continue;
        }
        for ((slope, &high), &low) in slopes.iter_mut().zip(seen).zip(lows) {
            let needed = (high - low) * square.per_distance;
            *slope = if needed > *slope { needed } else { *slope };
        }
    }
}

/// The largest of four numbers `by` columns and rows apart; where there are none, of those that are there.
fn widened(numbers: &[f32], [w, h]: [usize; 2], by: usize) -> Vec<f32> {
    (0..h)
        .into_par_iter()
        .flat_map_iter(|y| {
            let row = |y: usize| &numbers[y * w..(y + 1) * w];
            let (upper, lower) = (row(y), row((y + by).min(h - 1)));
            let both: Vec<f32> = upper.iter().zip(lower).map(|(a, b)| a.max(*b)).collect();
            let wide = (0..w).map(|x| both[x].max(both[(x + by).min(w - 1)]));
            wide.collect::<Vec<_>>()
        })
        .collect()
}
