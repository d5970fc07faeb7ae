//! Models.

use std::path::Path;

use super::LoadOptions;
use crate::scene::{LoadError, LoadedScene};

/// Loads a model.
///
/// # Errors
/// [`LoadError`].
pub fn load_model(path: &Path, _options: &LoadOptions) -> Result<LoadedScene, LoadError> {
    Err(LoadError::Unknown(path.display().to_string()))
}
