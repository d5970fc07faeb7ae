//! A folder with a model's name, libraries and pictures, and what loading them gives.

use std::path::{Path, PathBuf};

use reliefscope::scene::load::{LibraryRef, LoadOptions, MaterialSet, load_materials};
use tempfile::TempDir;

/// A folder that vanishes with the test.
pub struct Fixture {
    folder: TempDir,
}

impl Fixture {
    /// With `m.mtl` of this text.
    pub fn with_library(text: &str) -> Self {
        let fixture = Self {
            folder: tempfile::tempdir().expect("a temporary folder"),
        };
        fixture.write("m.mtl", text.as_bytes());
        fixture
    }

    /// A path in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a file, folders included.
    pub fn write(&self, name: &str, bytes: &[u8]) -> &Self {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().unwrap_or(Path::new("/"))).expect("a folder");
        std::fs::write(path, bytes).expect("a file");
        self
    }

    /// Writes a grey 8-bit picture whose values grow to the right.
    pub fn grey(&self, name: &str) -> &Self {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().unwrap_or(Path::new("/"))).expect("a folder");
        let picture = image::GrayImage::from_fn(8, 4, |x, _| image::Luma([x as u8 * 32]));
        picture.save(path).expect("a picture");
        self
    }

    /// Writes an RGB picture.
    pub fn rgb(&self, name: &str, pixel: impl Fn(u32, u32) -> [u8; 3]) -> &Self {
        let picture = image::RgbImage::from_fn(32, 32, |x, y| image::Rgb(pixel(x, y)));
        picture.save(self.path(name)).expect("a picture");
        self
    }

    /// Loads materials with these names, first used in lines 10, 11, …
    pub fn load(&self, names: &[&str]) -> MaterialSet {
        self.load_from(&["m.mtl"], names)
    }

    /// The same from other libraries, named in lines 1, 2, …
    pub fn load_from(&self, libraries: &[&str], names: &[&str]) -> MaterialSet {
        let libraries: Vec<_> = libraries
            .iter()
            .zip(1..)
            .map(|(name, line)| LibraryRef {
                name: name.as_bytes().to_vec(),
                model: self.path("model.obj"),
                line,
            })
            .collect();
        let used: Vec<_> = names
            .iter()
            .zip(10..)
            .map(|(name, line)| (name.as_bytes().to_vec(), line))
            .collect();
        load_materials(&libraries, &used, &LoadOptions::default()).expect("not cancelled")
    }
}

/// Warnings as `file:line message` with the file's name only.
pub fn warnings(set: &MaterialSet) -> Vec<String> {
    set.warnings
        .iter()
        .map(|w| {
            let file = w.file.file_name().unwrap_or_default().to_string_lossy();
            format!("{file}:{} {}", w.line.unwrap_or(0), w.message)
        })
        .collect()
}

/// Asserts that there is exactly one warning and that it holds these parts.
pub fn assert_one_warning(set: &MaterialSet, parts: &[&str]) {
    let warnings = warnings(set);
    assert_eq!(warnings.len(), 1, "{warnings:#?}");
    for part in parts {
        assert!(warnings[0].contains(part), "{part:?} not in {warnings:?}");
    }
}
