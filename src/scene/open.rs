//! One door for every kind of input.

use std::path::Path;

use super::load::LoadOptions;
use super::{LoadError, LoadedScene};

/// Opens an OBJ model, a scene file or a built-in scene by name.
///
/// # Errors
/// [`LoadError`] with file, line and cause.
pub fn open(input: &Path, _options: &LoadOptions) -> Result<LoadedScene, LoadError> {
    Err(LoadError::Unknown(input.display().to_string()))
}
