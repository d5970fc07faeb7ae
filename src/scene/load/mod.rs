//! From files to a scene: OBJ and MTL text, pictures, and what they mean.

mod amplitude;
mod library;
mod lookup;
mod map_statement;
mod materials;
mod model;
mod mtl;
mod options;
mod picture;
mod recognise;
mod slots;

pub use amplitude::fill_default_amplitudes;
pub use materials::{LibraryRef, MaterialSet, load_materials};
pub use model::load_model;
pub use options::{LoadMonitor, LoadOptions};
pub use picture::{DecodedPicture, PictureError, PictureLimits, PictureStore, decode_picture};
