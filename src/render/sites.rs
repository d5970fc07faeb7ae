//! Which pixels of a tile a pass renders, and in which places.

use std::sync::LazyLock;

use super::stages::{PLACES, Places};
use super::tile::TILE_SIZE;
use crate::math::lanes::Lanes;

/// Side of the blocks that pixels are listed in, so that 64 places in a row are neighbours.
const BLOCK_SIZE: u32 = 8;

/// The pixels whose column and row in the tile are multiples of a stride, block by block.
#[derive(Debug)]
pub struct Sites {
    /// How many.
    pub count: usize,
    /// Column in the tile of each.
    pub column: Lanes<u32, PLACES>,
    /// Row in the tile of each.
    pub row: Lanes<u32, PLACES>,
    /// The place that each has in a full pass, and so in the film.
    pub film_place: Lanes<u32, PLACES>,
}

static SITES: LazyLock<[Sites; 4]> = LazyLock::new(|| [1, 2, 4, 8].map(Sites::new));

impl Sites {
    /// The pixels of a pass with this stride, which is 1, 2, 4 or 8.
    #[must_use]
    pub fn of_stride(stride: u32) -> &'static Self {
        &SITES[stride.trailing_zeros() as usize % SITES.len()]
    }

    /// The pixels of a full pass: their places are those of the film.
    #[must_use]
    pub fn all() -> &'static Self {
        Self::of_stride(1)
    }

    fn new(stride: u32) -> Self {
        let zeros = Lanes::splat(0);
        let mut sites = Self {
            count: 0,
            column: zeros,
            row: zeros,
            film_place: zeros,
        };
        let block = BLOCK_SIZE * stride;
        let starts = || (0..TILE_SIZE).step_by(block as usize);
        for (y0, x0) in starts().flat_map(|y| starts().map(move |x| (y, x))) {
            let line = |from: u32| (from..TILE_SIZE.min(from + block)).step_by(stride as usize);
            for (y, x) in line(y0).flat_map(|y| line(x0).map(move |x| (y, x))) {
                sites.column.0[sites.count] = x;
                sites.row.0[sites.count] = y;
                sites.film_place.0[sites.count] = film_place(x, y);
                sites.count += 1;
            }
        }
        sites
    }

    /// The places whose pixels `wanted` accepts by column and row in the tile.
    pub fn places(&self, wanted: impl Fn(u32, u32) -> bool) -> Places {
        let mut places = Places::EMPTY;
        for place in 0..self.count {
            if wanted(self.column.0[place], self.row.0[place]) {
                places.insert(place);
            }
        }
        places
    }
}

/// Place in the film of the pixel in column `x` and row `y` of a tile.
#[must_use]
pub const fn film_place(x: u32, y: u32) -> u32 {
    let blocks = TILE_SIZE / BLOCK_SIZE;
    let block = y / BLOCK_SIZE * blocks + x / BLOCK_SIZE;
    (block * BLOCK_SIZE + y % BLOCK_SIZE) * BLOCK_SIZE + x % BLOCK_SIZE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pixel_has_one_place_and_coarse_sites_are_among_the_fine() {
        let all = Sites::all();
        assert_eq!(all.count, PLACES);
        for place in 0..PLACES {
            assert_eq!(all.film_place.0[place] as usize, place);
        }
        for stride in [2, 4, 8] {
            let sites = Sites::of_stride(stride);
            assert_eq!(sites.count, PLACES / (stride * stride) as usize);
            for i in 0..sites.count {
                let place = sites.film_place.0[i] as usize;
                assert_eq!(all.column.0[place], sites.column.0[i]);
                assert_eq!(all.row.0[place], sites.row.0[i]);
                assert!(sites.column.0[i] % stride == 0 && sites.row.0[i] % stride == 0);
            }
        }
    }
}
