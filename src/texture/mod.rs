//! Pictures that lie on a surface: raw decoded images, typed maps, and how they are addressed.

mod addressing;
mod color_map;
mod cone_map;
mod destair;
mod grid;
mod height_map;
mod heights;
mod horizon_map;
mod image_store;
mod levels;
mod mips;
mod normal_axes;
mod normal_map;
mod pyramid;
mod raw_image;
mod slope_moments;
mod slot;
mod wrap;

pub use addressing::Addressing;
pub use color_map::ColorMap;
pub use cone_map::ConeMap;
pub use destair::destaired;
pub use grid::{BilinearCell, Grid};
pub use height_map::{HeightMap, HeightSlope};
pub use heights::Heights;
pub use horizon_map::HorizonMap;
pub use image_store::MapImage;
pub use levels::Levels;
pub use mips::{Look, Mips};
pub use normal_axes::{FileAxis, NormalAxes};
pub use normal_map::NormalMap;
pub use pyramid::{HeightPyramid, Layout, StoredHeights};
pub use raw_image::{RawImage, Samples};
pub use slope_moments::SlopeMoments;
pub use slot::{Channel, MapRole, MapSlot, NormalSpace};
pub use wrap::Wrap;
