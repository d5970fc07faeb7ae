//! One door for every kind of input.

use std::path::Path;

use super::built_in::{SCENES, built_in};
use super::load::{LoadOptions, load_model};
use super::{LoadError, LoadedScene, file};

/// Opens a scene file (by its ending, `.toml`), a built-in scene (by name, unless a file is called so) or a
/// model (anything else; its content decides).
///
/// # Errors
/// [`LoadError`] with file, line and cause; [`LoadError::Unknown`] lists the built-in scenes.
pub fn open(input: &Path, options: &LoadOptions) -> Result<LoadedScene, LoadError> {
    // A folder is nothing to open: beside one that is called `wall` the scene is meant.
    let is_file = input.exists() && !input.is_dir();
    let name = input.to_str();
    let generated = name
        .filter(|_| !is_file)
        .and_then(|name| built_in(name, options));
    if let Some(loaded) = generated {
        return Ok(loaded);
    }
    // Something with an ending is meant as a file: that it is missing says more than a list of scenes.
    if !is_file && input.extension().is_none() {
        return Err(LoadError::Unknown(format!(
            "{} is neither a file nor a built-in scene; those are {}",
            input.display(),
            built_in_names().join(", ")
        )));
    }
    let is_scene_file = input
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
    if is_scene_file {
        file::read_scene(input, options)
    } else {
        load_model(input, options)
    }
}

/// Names of the built-in scenes, as the command line takes them.
#[must_use]
pub fn built_in_names() -> Vec<&'static str> {
    SCENES.iter().map(|scene| scene.name).collect()
}
