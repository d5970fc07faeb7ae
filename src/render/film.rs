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
        if self.samples > 0 {
            let share = 1.0 / self.samples as f32;
            for (y, sums) in self.sums.chunks_exact(self.width as usize).enumerate() {
                let start = y * width + self.x0 as usize;
                for (pixel, &sum) in rows[start..].iter_mut().zip(sums) {
                    *pixel = f(sum * share);
                }
            }
            return;
        }
        // Tiles start at multiples of every stride that divides their size, so every pixel's stand-in, to
        // its upper left on the preview's grid, is inside the tile.
        let stride = self.first_stride.unwrap_or(TILE_SIZE) as usize;
        let (tile_width, tile_height) = (self.width as usize, self.height as usize);
        for y in (0..tile_height).step_by(stride) {
            let start = y * width + self.x0 as usize;
            for (cell, pixels) in rows[start..start + tile_width]
                .chunks_mut(stride)
                .enumerate()
            {
                pixels.fill(f(self.sums[y * tile_width + cell * stride]));
            }
            for copy in 1..stride.min(tile_height - y) {
                rows.copy_within(start..start + tile_width, start + copy * width);
            }
        }
    }
}
