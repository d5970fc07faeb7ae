//! The scene file, TOML: everything the panel can set. `docs/scene.md` explains every key.
//!
//! Reading goes in two steps. `parse` turns text into a `Document`, plain data that holds just the keys that
//! are there, with type, range and spelling checked and each fault at its line. `apply` lays that over the scene that the model brings. Writing goes the other way, and `--set` goes
//! round: the scene is written, the text changed, and read back, so that a key means the same everywhere.

mod apply;
mod apply_material;
mod document;
mod fault;
mod overrides;
mod parse;
mod parse_light;
mod parse_material;
mod paths;
mod pictures;
mod read;
mod section;
mod text;
mod write;
mod write_material;

pub use overrides::{OverrideError, apply_overrides};
pub use read::read_scene;
pub use write::{SaveError, SceneView, write_scene, write_whole};

/// Checks that a picture's columns and rows are in a sane range.
///
/// # Errors
/// What is wrong, as the end of a sentence that begins with the key's name.
pub fn check_size(size: [u32; 2]) -> Result<(), String> {
    parse::check_size(size)
}
