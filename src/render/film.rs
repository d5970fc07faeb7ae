//! The picture so far, read tile by tile.

use super::tile::{TILE_SIZE, Tile};
use crate::math::LinearRgb;

/// A view of a renderer's sums. Row 0 is on top.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Picture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Linear light, row by row.
    pub pixels: Vec<LinearRgb>,
}

impl Picture {
    /// A black picture.
    #[must_use]
    pub fn black([width, height]: [u32; 2]) -> Self {
        Self {
            width,
            height,
            pixels: vec![LinearRgb::BLACK; width as usize * height as usize],
        }
    }

    /// The pixel in column `x`, row `y`.
    ///
    /// # Panics
    /// If it is outside.
    #[must_use]
    pub fn at(&self, x: u32, y: u32) -> LinearRgb {
        self.pixels[y as usize * self.width as usize + x as usize]
    }
}

/// The tiles that cover a picture, in rows.
#[must_use]
pub fn tiles_of([width, height]: [u32; 2]) -> Vec<Tile> {
    let starts = |n: u32| (0..n).step_by(TILE_SIZE as usize);
    starts(height)
        .flat_map(|y| starts(width).map(move |x| (x, y)))
        .map(|(x, y)| Tile::new(x, y, TILE_SIZE.min(width - x), TILE_SIZE.min(height - y)))
        .collect()
}

/// Indices of the tiles, the ones nearest to the picture's centre first: what people look at is done
/// first.
#[must_use]
pub fn centre_first(tiles: &[Tile], [width, height]: [u32; 2]) -> Vec<usize> {
    let distance = |t: &Tile| {
        let dx = i64::from(2 * t.x0 + t.width) - i64::from(width);
        let dy = i64::from(2 * t.y0 + t.height) - i64::from(height);
        dx * dx + dy * dy
    };
    let mut order: Vec<usize> = (0..tiles.len()).collect();
    order.sort_by_key(|&i| distance(&tiles[i]));
    order
}

impl Tile {
    /// Writes `f` of every pixel into `rows`, a band of picture rows `width` wide that starts at the tile's
    /// first row: the mean of its samples, or before the first full sample the nearest pixel of the preview.
    pub(super) fn write_rows<T: Copy>(
        &self,
        rows: &mut [T],
        width: usize,
        f: &impl Fn(LinearRgb) -> T,
    ) {
        let row = |y: u32| y as usize * width + self.x0 as usize;
        if self.samples > 0 {
            let share = 1.0 / self.samples as f32;
            for y in 0..self.height {
                let pixels = &mut rows[row(y)..];
                for (x, pixel) in (0..self.width).zip(pixels) {
                    *pixel = f(self.sum(x, y) * share);
                }
            }
            return;
        }
        let Some(stride) = self.first_stride else {
            let black = f(LinearRgb::BLACK);
            (0..self.height).for_each(|y| rows[row(y)..][..self.width as usize].fill(black));
            return;
        };
        // Tiles start at multiples of every stride that divides their size, so every pixel's stand-in, to
        // its upper left on the preview's grid, is inside the tile.
        for y in (0..self.height).step_by(stride as usize) {
            let pixels = &mut rows[row(y)..][..self.width as usize];
            for (cell, pixels) in pixels.chunks_mut(stride as usize).enumerate() {
                pixels.fill(f(self.sum(cell as u32 * stride, y)));
            }
            for copy in y + 1..(y + stride).min(self.height) {
                rows.copy_within(row(y)..row(y) + self.width as usize, row(copy));
            }
        }
    }
}
