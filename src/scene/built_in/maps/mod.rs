//! Generated materials: heights with exact derivatives, and the colours that belong to them.
//!
//! Every pattern is a function of the tile coordinates that repeats after one tile. It uses only operations
//! that IEEE 754 fixes to the bit and integer hashes, so the pictures are the same on every machine.

mod bake;
mod cells;
mod dual;
mod exact;
mod masonry;
mod metal;
mod noise;
mod paint;
mod soft;

pub use bake::{MapSet, bake};
pub use dual::Dual;
pub use paint::Paint;

/// One place of a material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Texel {
    /// Height in `[0, 1]` with its derivatives by u and v, per tile.
    pub height: Dual,
    /// Surface colour.
    pub paint: Paint,
}

/// A material as a function of the tile coordinates: repeats after one tile in either direction.
pub trait Pattern: Sync {
    /// Height and colour at (u, v), v up.
    fn texel(&self, u: Dual, v: Dual) -> Texel;
}

/// The materials that the program can generate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Relief {
    /// Brick wall in running bond.
    Bricks,
    /// Rounded stones with earth between them.
    Cobble,
    /// Chequered floor tiles.
    Tiles,
    /// Smooth swell.
    Waves,
    /// Rings around the middle.
    Ripple,
    /// Dented metal.
    Hammered,
    /// Basket work.
    Weave,
    /// Mountains.
    Terrain,
    /// Dimpled lacquer or plaster.
    OrangePeel,
    /// Riveted plates.
    Rivets,
    /// Tread plate.
    Tread,
    /// A struck medal in the middle of the tile.
    Medallion,
}

impl Relief {
    /// Every material.
    pub const ALL: [Self; 12] = [
        Self::Bricks,
        Self::Cobble,
        Self::Tiles,
        Self::Waves,
        Self::Ripple,
        Self::Hammered,
        Self::Weave,
        Self::Terrain,
        Self::OrangePeel,
        Self::Rivets,
        Self::Tread,
        Self::Medallion,
    ];

    /// Name of the material and stem of its pictures' names.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bricks => "bricks",
            Self::Cobble => "cobble",
            Self::Tiles => "tiles",
            Self::Waves => "waves",
            Self::Ripple => "ripple",
            Self::Hammered => "hammered",
            Self::Weave => "weave",
            Self::Terrain => "terrain",
            Self::OrangePeel => "orange-peel",
            Self::Rivets => "rivets",
            Self::Tread => "tread",
            Self::Medallion => "medallion",
        }
    }

    /// Natural depth from stored 0 to stored 1, as a fraction of the tile; the one its normal map is
    /// baked for.
    #[must_use]
    pub const fn amplitude(self) -> f64 {
        match self {
            Self::Bricks => 0.020,
            Self::Cobble => 0.040,
            Self::Tiles => 0.012,
            Self::Waves => 0.040,
            Self::Ripple => 0.030,
            Self::Hammered => 0.022,
            Self::Weave => 0.022,
            Self::Terrain => 0.080,
            Self::OrangePeel => 0.010,
            Self::Rivets => 0.025,
            Self::Tread => 0.020,
            Self::Medallion => 0.040,
        }
    }

    /// Texels a side that show its finest detail.
    #[must_use]
    pub const fn resolution(self) -> u32 {
        match self {
            Self::Bricks => 1024,
            _ => 512,
        }
    }

    /// The function behind it, with its noise prepared.
    #[must_use]
    pub fn pattern(self) -> Box<dyn Pattern> {
        match self {
            Self::Bricks => Box::new(masonry::Bricks::new()),
            Self::Cobble => Box::new(masonry::Cobble::new()),
            Self::Tiles => Box::new(masonry::Tiles::new()),
            Self::Waves => Box::new(soft::Waves::new()),
            Self::Ripple => Box::new(soft::Ripple),
            Self::Hammered => Box::new(metal::Hammered::new()),
            Self::Weave => Box::new(soft::Weave::new()),
            Self::Terrain => Box::new(soft::Terrain::new()),
            Self::OrangePeel => Box::new(soft::OrangePeel::new()),
            Self::Rivets => Box::new(metal::Rivets::new()),
            Self::Tread => Box::new(metal::Tread::new()),
            Self::Medallion => Box::new(metal::Medallion::new()),
        }
    }

    /// Its pictures, `size` texels a side.
    ///
    /// # Panics
    /// If `size` is 0.
    #[must_use]
    pub fn bake(self, size: u32) -> MapSet {
        bake(self.pattern().as_ref(), size, self.amplitude())
    }
}
