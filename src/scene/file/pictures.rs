//! Pictures that a scene file names: those the model already has, and new ones.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::document::Placed;
use super::fault::{Fault, Read};
use super::paths::settled;
use crate::texture::MapImage;

/// Finds pictures by the words of a scene file and decodes each new one once.
pub(super) struct Pictures<'a> {
    base: &'a Path,
    /// Names of generated pictures.
    generated: HashMap<&'a str, usize>,
    /// Settled paths of all others.
    files: HashMap<PathBuf, usize>,
    /// Index of the first new picture.
    first_new: usize,
    added: Vec<MapImage>,
}

impl<'a> Pictures<'a> {
    /// Knows the scene's pictures; paths are relative to `base`.
    pub fn new(base: &'a Path, images: &'a [MapImage]) -> Self {
        let mut generated = HashMap::new();
        let mut files = HashMap::new();
        for (i, image) in images.iter().enumerate() {
            match &image.path {
                Some(path) => files.entry(settled(path)).or_insert(i),
                None => generated.entry(image.name.as_str()).or_insert(i),
            };
        }
        Self {
            base,
            generated,
            files,
            first_new: images.len(),
            added: Vec::new(),
        }
    }

    /// Index of a picture: a generated one by name, or a file, decoded now if it is new.
    pub fn index(&mut self, word: &Placed<String>) -> Read<usize> {
        if let Some(&index) = self.generated.get(word.value.as_str()) {
            return Ok(index);
        }
        if word.value.is_empty() {
            return Err(Fault::new(
                word.at,
                format!("`{}` must not be empty", word.key),
            ));
        }
        let path = self.base.join(&word.value);
        let key = settled(&path);
        if let Some(&index) = self.files.get(&key) {
            return Ok(index);
        }
        let image =
            decode(&path).map_err(|why| Fault::new(word.at, format!("`{}`: {why}", word.key)))?;
        let index = self.first_new + self.added.len();
        self.added.push(image);
        self.files.insert(key, index);
        Ok(index)
    }

    /// The new pictures, to be put behind the old ones.
    pub fn into_added(self) -> Vec<MapImage> {
        self.added
    }
}

fn decode(path: &Path) -> Result<MapImage, String> {
    Err(format!("{}: cannot decode", path.display()))
}
