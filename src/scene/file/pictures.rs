//! Pictures that a scene file names: those the model already has, and new ones.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::document::Placed;
use super::fault::{Fault, Read};
use crate::scene::load::PictureStore;
use crate::texture::MapImage;

/// Finds pictures by the words of a scene file and decodes each new one once.
pub(super) struct Pictures {
    base: PathBuf,
    /// Generated pictures by name.
    generated: HashMap<String, usize>,
    store: PictureStore,
    /// What was doubtful about new pictures.
    remarks: Vec<Fault>,
}

impl Pictures {
    /// Takes the scene's pictures; paths are relative to `base`.
    pub fn new(base: &Path, images: Vec<MapImage>) -> Self {
        let mut generated = HashMap::new();
        for (i, image) in images.iter().enumerate() {
            if image.path.is_none() {
                generated.entry(image.name.clone()).or_insert(i);
            }
        }
        Self {
            base: base.to_owned(),
            generated,
            store: PictureStore::with_images(images),
            remarks: Vec::new(),
        }
    }

    /// Index of a picture: a generated one by name, or a file, decoded now if it is new.
    pub fn index(&mut self, word: &Placed<String>) -> Read<usize> {
        let fault = |why: String| Fault::new(word.at, format!("`{}` {why}", word.key));
        if let Some(&index) = self.generated.get(&word.value) {
            return Ok(index);
        }
        if word.value.is_empty() {
            return Err(fault("must not be empty".to_owned()));
        }
        let path = self.base.join(&word.value);
        let (index, remark) = self
            .store
            .load(&path)
            .map_err(|why| fault(format!("cannot use {}: {why}", path.display())))?;
        self.remarks
            .extend(remark.map(|why| fault(format!("({}): {why}", path.display()))));
        Ok(index)
    }

    /// All pictures, the scene's first and the new ones behind; and what was doubtful about the new ones.
    pub fn into_images(self) -> (Vec<MapImage>, Vec<Fault>) {
        (self.store.images, self.remarks)
    }
}
