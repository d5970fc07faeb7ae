//! Scenes that the program generates.

use super::load::LoadOptions;
use super::{LoadError, LoadedScene};

/// What menus and lists say about a scene.
#[derive(Debug, Clone, Copy)]
pub struct SceneInfo {
    /// The name the command line takes.
    pub name: &'static str,
    /// One line.
    pub summary: &'static str,
}

/// Every scene.
pub const SCENES: [SceneInfo; 0] = [];

/// Generates a scene.
///
/// # Errors
/// [`LoadError::Unknown`].
pub fn built_in(name: &str, _options: &LoadOptions) -> Result<LoadedScene, LoadError> {
    Err(LoadError::Unknown(name.to_owned()))
}
