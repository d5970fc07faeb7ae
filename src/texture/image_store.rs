//! A loaded picture and the typed maps made from it on demand.

use std::path::PathBuf;
use std::sync::OnceLock;

use super::{
    Channel, ColorMap, HeightMap, Heights, MapRole, MapSlot, NormalMap, RawImage, SlopeMoments,
    Wrap, destaired,
};

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
    /// By channel.
    heights: [OnceLock<Box<Heights>>; Channel::ALL.len()],
    /// The same with smoothed steps, by what goes on beyond the border, boxed because few pictures have any.
    destaired: Box<[[OnceLock<Box<Heights>>; Wrap::ALL.len()]; Channel::ALL.len()]>,
    normals: OnceLock<NormalMap>,
    colors: OnceLock<ColorMap>,
    /// Halvings, boxed because few pictures have any.
    filtered: Box<Filtered>,
}

/// Colours, normals and slopes, halved again and again.
#[derive(Debug, Clone, Default)]
struct Filtered {
    colors: OnceLock<Vec<ColorMap>>,
    normals: OnceLock<Vec<NormalMap>>,
    slopes: OnceLock<Vec<NormalMap>>,
    moments: OnceLock<Vec<SlopeMoments>>,
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
            destaired: Box::default(),
            normals: OnceLock::new(),
            colors: OnceLock::new(),
            filtered: Box::default(),
        }
    }

    /// The picture as heights (or opacity), as they are stored.
    #[must_use]
    pub fn heights(&self, channel: Channel) -> &Heights {
        self.heights[channel as usize]
            .get_or_init(|| Box::new(Heights::new(HeightMap::from_image(&self.raw, channel))))
    }

    /// The map in [`Self::heights`].
    #[must_use]
    pub fn height(&self, channel: Channel) -> &HeightMap {
        self.heights(channel).map()
    }

    /// The heights that a slot reads: with smoothed steps where it asks for that.
    #[must_use]
    pub fn heights_of(&self, slot: &MapSlot) -> &Heights {
        if !slot.destair {
            return self.heights(slot.channel);
        }
        self.destaired[slot.channel as usize][slot.wrap as usize].get_or_init(|| {
            let stored = self.heights(slot.channel);
            let map = destaired(stored.map(), stored.levels().step, slot.wrap);
            Box::new(Heights::new(map))
        })
    }

    /// Heap bytes of what was made for searches so far.
    #[must_use]
    pub fn search_bytes(&self) -> usize {
        self.made_heights().map(Heights::search_bytes).sum()
    }

    fn made_heights(&self) -> impl Iterator<Item = &Heights> {
        let all = self.heights.iter().chain(self.destaired.iter().flatten());
        all.filter_map(|heights| heights.get().map(|h| &**h))
    }

    /// The picture as normals or slopes.
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

    /// The normals (or slopes, by the role) halved again and again.
    #[must_use]
    pub fn normal_halvings(&self, role: MapRole) -> &[NormalMap] {
        let made = match role {
            MapRole::Slope => &self.filtered.slopes,
            _ => &self.filtered.normals,
        };
        made.get_or_init(|| self.normal().halvings(role))
    }

    /// Moments of the picture's slopes from half the size on.
    #[must_use]
    pub fn slope_moments(&self) -> &[SlopeMoments] {
        self.filtered
            .moments
            .get_or_init(|| SlopeMoments::of_slopes(self.normal()))
    }

    /// The surface colours halved again and again.
    #[must_use]
    pub fn color_halvings(&self) -> &[ColorMap] {
        self.filtered.colors.get_or_init(|| self.color().halvings())
    }

    /// Heap bytes of all halvings made so far.
    #[must_use]
    pub fn filter_bytes(&self) -> usize {
        let Filtered {
            colors,
            normals,
            slopes,
            moments,
        } = &*self.filtered;
        let vectors = [normals, slopes].into_iter().filter_map(OnceLock::get);
        let heights: usize = self.made_heights().map(Heights::filter_bytes).sum();
        heights
            + moments
                .get()
                .into_iter()
                .flatten()
                .map(SlopeMoments::bytes)
                .sum::<usize>()
            + vectors.flatten().map(NormalMap::bytes).sum::<usize>()
            + colors
                .get()
                .into_iter()
                .flatten()
                .map(ColorMap::bytes)
                .sum::<usize>()
    }

    /// Heap bytes of the samples and of every map made so far.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let raw = match &self.raw.samples {
            super::Samples::U8(s) => s.len(),
            super::Samples::U16(s) => s.len() * 2,
            super::Samples::F32(s) => s.len() * 4,
        };
        let heights: usize = self.made_heights().map(|h| h.map().bytes()).sum();
        raw + heights
            + self.search_bytes()
            + self.filter_bytes()
            + self.normals.get().map_or(0, NormalMap::bytes)
            + self.colors.get().map_or(0, ColorMap::bytes)
    }
}
