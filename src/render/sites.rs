//! Which pixel of a tile lies in which place of its arrays.

use std::sync::LazyLock;

use super::stages::{PLACES, Places};
use super::tile::TILE_SIZE;
use crate::math::lanes::Lanes;

/// Side of the blocks that pixels are listed in, so that 64 places in a row are neighbours.
pub const BLOCK_SIZE: u32 = 8;

/// Column and row in the tile of every place, block by block.
#[derive(Debug)]
pub struct Sites {
    /// Columns.
    pub column: Lanes<u32, PLACES>,
    /// Rows.
    pub row: Lanes<u32, PLACES>,
}

static SITES: LazyLock<Sites> = LazyLock::new(Sites::new);

impl Sites {
    /// The one table.
    #[must_use]
    pub fn get() -> &'static Self {
        &SITES
    }

    fn new() -> Self {
        let mut sites = Self {
            column: Lanes::splat(0),
            row: Lanes::splat(0),
        };
        for (y, x) in (0..TILE_SIZE).flat_map(|y| (0..TILE_SIZE).map(move |x| (y, x))) {
            let place = place_of(x, y);
            sites.column.0[place] = x;
            sites.row.0[place] = y;
        }
        sites
    }

    /// The places of the pixels in the upper left `width` × `height` of a tile.
    #[must_use]
    pub fn within(&self, width: u32, height: u32) -> Places {
        let mut places = Places::EMPTY;
        for place in 0..PLACES {
            if self.column.0[place] < width && self.row.0[place] < height {
                places.insert(place);
            }
        }
        places
    }
}

/// Place of the pixel in column `x` and row `y` of a tile.
#[must_use]
pub const fn place_of(x: u32, y: u32) -> usize {
    let blocks = TILE_SIZE / BLOCK_SIZE;
    let block = y / BLOCK_SIZE * blocks + x / BLOCK_SIZE;
    ((block * BLOCK_SIZE + y % BLOCK_SIZE) * BLOCK_SIZE + x % BLOCK_SIZE) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pixel_has_a_place_of_its_own() {
        let sites = Sites::get();
        for place in 0..PLACES {
            assert_eq!(place_of(sites.column.0[place], sites.row.0[place]), place);
        }
        assert_eq!(sites.within(TILE_SIZE, TILE_SIZE).count(), PLACES as u64);
        assert_eq!(sites.within(5, 17).count(), 5 * 17);
    }
}
