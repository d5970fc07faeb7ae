//! A loaded picture and the typed maps made from it on demand.

use std::path::PathBuf;
use std::sync::OnceLock;

use super::{Channel, ColorMap, HeightMap, NormalMap, RawImage};

/// One picture of a scene. Typed maps are made when a material first asks for the role, then kept: a
/// scene that never uses a picture as normals never pays for it. What is made never changes a pixel.
#[derive(Debug, Clone)]
pub struct MapImage {
    /// Short name for lists: the file name, or what generated it.
    pub name: String,
    /// Where it was loaded from; `None` if generated.
    pub path: Option<PathBuf>,
    /// The samples as stored.
    pub raw: RawImage,
    heights: [OnceLock<HeightMap>; Channel::ALL.len()],
    normals: OnceLock<NormalMap>,
    colors: OnceLock<ColorMap>,
}

impl MapImage {
    /// Wraps a decoded picture.
    #[must_use]
    pub fn new(name: impl Into<String>, path: Option<PathBuf>, raw: RawImage) -> Self {
        Self {
            name: name.into(),
            path,
            raw,
            heights: Default::default(),
            normals: OnceLock::new(),
            colors: OnceLock::new(),
        }
    }

    /// The picture as heights (or opacity).
    #[must_use]
    pub fn height(&self, channel: Channel) -> &HeightMap {
        self.heights[channel as usize].get_or_init(|| HeightMap::from_image(&self.raw, channel))
    }

    /// The picture as tangent-space normals or slopes.
    #[must_use]
    pub fn normal(&self) -> &NormalMap {
        self.normals
            .get_or_init(|| NormalMap::from_image(&self.raw))
    }

    /// The picture as surface colour.
    #[must_use]
    pub fn color(&self) -> &ColorMap {
        self.colors.get_or_init(|| ColorMap::from_image(&self.raw))
    }

    /// Heap bytes of the samples and of every map made so far.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let raw = match &self.raw.samples {
            super::Samples::U8(s) => s.len(),
            super::Samples::U16(s) => s.len() * 2,
            super::Samples::F32(s) => s.len() * 4,
        };
        let heights: usize = self
            .heights
            .iter()
            .filter_map(OnceLock::get)
            .map(HeightMap::bytes)
            .sum();
        raw + heights
            + self.normals.get().map_or(0, NormalMap::bytes)
            + self.colors.get().map_or(0, ColorMap::bytes)
    }
}
