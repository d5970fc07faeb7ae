//! Every `stride`-th pixel of a picture, in tiles.

use std::sync::{Mutex, MutexGuard, PoisonError};

use rayon::prelude::*;

use super::sites::{BLOCK_SIZE, place_of};
use super::stages::camera::Pixels;
use super::tile::{TILE_SIZE, Tile};
use super::{Counters, PixelRecord};
use crate::geometry::CachedHit;
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

/// The samples of every `stride`-th pixel of a picture in both directions.
#[derive(Debug)]
pub struct Film {
    /// Pixels of the picture from one of the film's to the next.
    pub stride: u32,
    /// Columns and rows of the film.
    pub size: [u32; 2],
    /// In rows.
    pub tiles: Vec<Mutex<Tile>>,
    /// Indices of the tiles in the order of work, those nearest to the middle first: what people look at is
    /// done first.
    pub order: Vec<usize>,
}

impl Film {
    /// An empty film of a picture of this size.
    #[must_use]
    pub fn new(picture: [u32; 2], stride: u32) -> Self {
        let size = picture.map(|n| n.div_ceil(stride));
        let starts = |n: u32| (0..n).step_by(TILE_SIZE as usize);
        let corners = starts(size[1]).flat_map(|y| starts(size[0]).map(move |x| [x, y]));
        let tiles: Vec<Tile> = corners
            .map(|[x, y]| {
                let rest = [size[0] - x, size[1] - y];
                Tile::new([x, y], rest.map(|n| n.min(TILE_SIZE)), stride)
            })
            .collect();
        Self {
            stride,
            size,
            order: centre_first(&tiles, size),
            tiles: tiles.into_iter().map(Mutex::new).collect(),
        }
    }

    /// Forgets the picture; and the hits too, unless they are still true.
    pub fn reset(&mut self, keep_hits: bool) {
        for tile in &mut self.tiles {
            tile.get_mut()
                .unwrap_or_else(PoisonError::into_inner)
                .reset(keep_hits);
        }
    }

    /// Adds to `known` what is known of the first hits of a tile of a finer film of the same picture, by the
    /// tile's places.
    ///
    /// Every `r`-th pixel of the finer film is one of this, and a tile's are all in one tile here.
    pub fn hits_for(&self, finer: &Pixels, known: &mut Vec<(usize, CachedHit)>) {
        let ratio = self.stride / finer.stride;
        let [x0, y0] = finer.corner.map(|n| n / ratio);
        let [column, row] = [x0, y0].map(|n| n / TILE_SIZE);
        let tile = row * self.size[0].div_ceil(TILE_SIZE) + column;
        let Some(tile) = self.tiles.get(tile as usize) else {
            return;
        };
        let tile = lock(tile);
        let [x0, y0] = [x0 - column * TILE_SIZE, y0 - row * TILE_SIZE];
        let side = TILE_SIZE / ratio;
        let pixels = (0..side).flat_map(|y| (0..side).map(move |x| [x, y]));
        let places = pixels.map(|[x, y]| (place_of(x * ratio, y * ratio), [x0 + x, y0 + y]));
        let wanted = places.filter(|&(place, _)| finer.active.contains(place));
        known.extend(wanted.map(|(place, [x, y])| (place, tile.hits.get(place_of(x, y)))));
    }

    /// Samples that every pixel has.
    #[must_use]
    pub fn samples(&self) -> u32 {
        let samples = self.tiles.iter().map(|tile| lock(tile).samples);
        samples.min().unwrap_or(0)
    }

    /// Exact counts since the last reset.
    #[must_use]
    pub fn counters(&self) -> Counters {
        let mut sum = Counters::ZERO;
        for tile in &self.tiles {
            sum += lock(tile).counters;
        }
        sum
    }

    /// What the first samples found, one entry for each pixel of the film in rows; nothing unless every pixel has it.
    #[must_use]
    pub fn records(&self) -> Vec<PixelRecord> {
        let [width, height] = self.size.map(|n| n as usize);
        let mut records = vec![PixelRecord::NOTHING; width * height];
        for tile in &self.tiles {
            let tile = lock(tile);
            if tile.records.is_empty() {
                return Vec::new();
            }
            let [x0, y0] = tile.pixels.corner;
            let pixels = (0..tile.size[1]).flat_map(|y| (0..tile.size[0]).map(move |x| [x, y]));
            for [x, y] in pixels {
                records[(y0 + y) as usize * width + (x0 + x) as usize] = PixelRecord {
                    samples: tile.samples,
                    ..tile.records[place_of(x, y)]
                };
            }
        }
        records
    }

    /// Fills `out`, one entry for each pixel of the film in rows, with what `f` makes of the means of their
    /// samples; black where there are none. Runs on the current pool.
    pub fn map_into<T: Copy + Send>(&self, out: &mut [T], f: &(impl Fn(LinearRgb) -> T + Sync)) {
        let width = self.size[0] as usize;
        let bands = out.par_chunks_mut(width * TILE_SIZE as usize);
        let tiles = self.tiles.par_chunks(width.div_ceil(TILE_SIZE as usize));
        bands.zip(tiles).for_each(|(rows, tiles)| {
            for tile in tiles {
                lock(tile).write_rows(rows, width, f);
            }
        });
    }
}

/// A tile, for its worker. Two never want the same at once.
pub fn lock(tile: &Mutex<Tile>) -> MutexGuard<'_, Tile> {
    // A panic in a worker leaves at worst a tile with a wrong colour, which the next start resets.
    tile.lock().unwrap_or_else(PoisonError::into_inner)
}

fn centre_first(tiles: &[Tile], [width, height]: [u32; 2]) -> Vec<usize> {
    let distance = |tile: &Tile| {
        let [x0, y0] = tile.pixels.corner;
        let dx = i64::from(2 * x0 + tile.size[0]) - i64::from(width);
        let dy = i64::from(2 * y0 + tile.size[1]) - i64::from(height);
        dx * dx + dy * dy
    };
    let mut order: Vec<usize> = (0..tiles.len()).collect();
    order.sort_by_key(|&i| distance(&tiles[i]));
    order
}

impl Tile {
    /// Writes `f` of every pixel's mean into `rows`, a band of rows `width` wide that starts at the tile's first row.
    fn write_rows<T: Copy>(&self, rows: &mut [T], width: usize, f: &impl Fn(LinearRgb) -> T) {
        let [columns, height] = self.size;
        let share = if self.samples == 0 {
            0.0
        } else {
            1.0 / self.samples as f32
        };
        let [r, g, b] = &*self.sums;
        for y in 0..height {
            let start = y as usize * width + self.pixels.corner[0] as usize;
            let row = &mut rows[start..start + columns as usize];
            // Neighbours in a block are neighbours in the arrays.
            for (block, pixels) in (0..).zip(row.chunks_mut(BLOCK_SIZE as usize)) {
                let first = place_of(block * BLOCK_SIZE, y);
                for (place, pixel) in (first..).zip(pixels) {
                    let sum = LinearRgb::new(r.0[place], g.0[place], b.0[place]);
                    *pixel = if self.samples == 0 {
                        f(LinearRgb::BLACK)
                    } else {
                        f(sum * share)
                    };
                }
            }
        }
    }
}
