//! From files to a scene: OBJ and MTL text, pictures, and what they mean.

mod materials;
mod model;
mod options;

pub use materials::{LibraryRef, MaterialSet, load_materials};
pub use model::load_model;
pub use options::{LoadMonitor, LoadOptions};
