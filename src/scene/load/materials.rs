//! From material libraries to materials and pictures.

use std::path::PathBuf;

use super::super::LoadWarning;
use super::LoadOptions;
use crate::scene::LoadError;
use crate::shading::Material;
use crate::texture::MapImage;

/// A library as a model names it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LibraryRef {
    /// The name as written, without quotes trimmed or slashes changed. Not UTF-8 in old files.
    pub name: Vec<u8>,
    /// The model's file.
    pub model: PathBuf,
    /// Line of the statement in the model.
    pub line: usize,
}

/// Materials in the order of the names asked for, the pictures they use, and notes.
#[derive(Debug, Default)]
pub struct MaterialSet {
    /// One per name asked for.
    pub materials: Vec<Material>,
    /// Pictures that the materials' slots index.
    pub images: Vec<MapImage>,
    /// Doubtful input.
    pub warnings: Vec<LoadWarning>,
}

/// Reads the libraries and finds a material for every used name (bytes as written in `usemtl`).
///
/// # Errors
/// Only [`LoadError::Cancelled`]; anything else becomes a warning and a default material.
pub fn load_materials(
    _libraries: &[LibraryRef],
    _used: &[(Vec<u8>, usize)],
    _options: &LoadOptions,
) -> Result<MaterialSet, LoadError> {
    Ok(MaterialSet::default())
}
