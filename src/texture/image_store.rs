//! A loaded picture and the typed maps made from it on demand.

use std::path::PathBuf;
use std::sync::OnceLock;

use super::{Channel, ColorMap, ConeMap, HeightMap, HeightPyramid, NormalMap, RawImage, Wrap};

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
    /// What searches read beside heights, boxed because few pictures have any.
    searched: Box<[Searched; Channel::ALL.len()]>,
    normals: OnceLock<NormalMap>,
    colors: OnceLock<ColorMap>,
}

/// What is made of a channel's heights for methods that search it.
#[derive(Debug, Clone, Default)]
struct Searched {
    extremes: OnceLock<[f32; 2]>,
    pyramids: [OnceLock<HeightPyramid>; Wrap::ALL.len()],
    cones: [[OnceLock<ConeMap>; 2]; Wrap::ALL.len()],
}

impl Searched {
    fn bytes(&self) -> usize {
        let pyramids = self.pyramids.iter().filter_map(OnceLock::get);
        let cones = self.cones.iter().flatten().filter_map(OnceLock::get);
        pyramids.map(HeightPyramid::bytes).sum::<usize>() + cones.map(ConeMap::bytes).sum::<usize>()
    }
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
            searched: Box::default(),
            normals: OnceLock::new(),
            colors: OnceLock::new(),
        }
    }

    /// The picture as heights (or opacity).
    #[must_use]
    pub fn height(&self, channel: Channel) -> &HeightMap {
        self.heights[channel as usize].get_or_init(|| HeightMap::from_image(&self.raw, channel))
    }

    /// Smallest and largest stored height.
    #[must_use]
    pub fn height_extremes(&self, channel: Channel) -> [f32; 2] {
        *self.searched[channel as usize]
            .extremes
            .get_or_init(|| self.height(channel).extremes())
    }

    /// The extremes of the heights over squares of all sizes, for a slot that goes on by `wrap`.
    #[must_use]
    pub fn pyramid(&self, channel: Channel, wrap: Wrap) -> &HeightPyramid {
        self.searched[channel as usize].pyramids[wrap as usize]
            .get_or_init(|| HeightPyramid::new(self.height(channel), wrap))
    }

    /// The cones over the heights, or over the heights turned over.
    #[must_use]
    pub fn cones(&self, channel: Channel, wrap: Wrap, inverted: bool) -> &ConeMap {
        self.searched[channel as usize].cones[wrap as usize][usize::from(inverted)]
            .get_or_init(|| ConeMap::new(self.height(channel), wrap, inverted))
    }

    /// Heap bytes of what was made for searches so far.
    #[must_use]
    pub fn search_bytes(&self) -> usize {
        self.searched.iter().map(Searched::bytes).sum()
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
            + self.search_bytes()
            + self.normals.get().map_or(0, NormalMap::bytes)
            + self.colors.get().map_or(0, ColorMap::bytes)
    }
}
