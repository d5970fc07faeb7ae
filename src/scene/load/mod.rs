//! From files to a scene: OBJ and MTL text, pictures, and what they mean.
//!
//! ```text
//! load_model: bytes → obj (statements, line by line) → mesh (polygon, normals, vertices)
//!             → materials (library, mtl, picture) → amplitude → staging (camera, lights) → LoadedScene
//! ```
//!
//! # Why the OBJ reader is our own
//!
//! tobj is the usual OBJ parser of Rust programs, and on clean triangulated files the tests hold this
//! reader against it (`tests/integration/load_obj.rs`). It does not load the models themselves, because
//! version 4 cannot carry what files in the wild hold:
//!
//! - It reads all or nothing. One statement it does not understand (a continued line, a comment behind a
//!   face, an index out of range, a name that is not UTF-8, line ends of old Macs) fails the whole file,
//!   without a line number; a bad index of a normal or a colour with one number panics. Here the statement
//!   costs one warning with file and line.
//! - It cuts every polygon as a fan, which covers the outside of concave faces, and drops smoothing groups,
//!   without which missing normals cannot be made.
//! - Faces that mix `v`, `v/vt` and `v//vn` come back with attributes out of step.
//! - In an MTL it keeps map options inside the file name and all spellings of bump in one field, so a height
//!   map and a normal map cannot be told apart.
//!
//! A tolerant front end that rewrites files for tobj would have to parse all of this first.

mod amplitude;
mod compare;
mod grey_floats;
mod library;
mod lookup;
mod map_statement;
mod materials;
mod mesh;
mod model;
mod mtl;
mod normals;
mod obj;
mod options;
mod picture;
mod polygon;
mod recognise;
mod slots;
mod staging;

/// Bytes of a material's name; what is longer is cut, so that no message quotes a whole file.
const MAX_NAME: usize = 1024;

pub use amplitude::fill_default_amplitudes;
pub use materials::{LibraryRef, MaterialSet, load_materials};
pub use model::load_model;
pub use options::{LoadMonitor, LoadOptions, Stage};
pub use picture::{DecodedPicture, PictureError, PictureLimits, PictureStore, decode_picture};
