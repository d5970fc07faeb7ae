//! Heights of one picture and what is made of them on demand.

use std::sync::OnceLock;

use super::{ConeMap, HeightMap, HeightPyramid, HorizonMap, Levels, SlopeMoments, Wrap};

/// A height map with everything that methods derive from it. Each part is made when it is first asked for,
/// then kept.
#[derive(Debug, Clone)]
pub struct Heights {
    map: HeightMap,
    extremes: OnceLock<[f32; 2]>,
    levels: OnceLock<Levels>,
    halvings: OnceLock<Vec<HeightMap>>,
    moments: [OnceLock<Vec<SlopeMoments>>; Wrap::ALL.len()],
    pyramids: [OnceLock<HeightPyramid>; Wrap::ALL.len()],
    cones: [[OnceLock<ConeMap>; 2]; Wrap::ALL.len()],
    horizons: [OnceLock<HorizonMap>; 2],
}

impl Heights {
    /// Nothing but the map.
    #[must_use]
    pub fn new(map: HeightMap) -> Self {
        Self {
            map,
            extremes: OnceLock::new(),
            levels: OnceLock::new(),
            halvings: OnceLock::new(),
            moments: Default::default(),
            pyramids: Default::default(),
            cones: Default::default(),
            horizons: Default::default(),
        }
    }

    /// The map.
    #[must_use]
    pub const fn map(&self) -> &HeightMap {
        &self.map
    }

    /// Smallest and largest stored height.
    #[must_use]
    pub fn extremes(&self) -> [f32; 2] {
        *self.extremes.get_or_init(|| self.map.extremes())
    }

    /// How many different heights there are.
    #[must_use]
    pub fn levels(&self) -> Levels {
        *self.levels.get_or_init(|| Levels::of(&self.map))
    }

    /// The map halved again and again.
    #[must_use]
    pub fn halvings(&self) -> &[HeightMap] {
        self.halvings.get_or_init(|| self.map.halvings())
    }

    /// Moments of the slopes from half the size on, for a slot that goes on by `wrap`.
    #[must_use]
    pub fn moments(&self, wrap: Wrap) -> &[SlopeMoments] {
        self.moments[wrap as usize].get_or_init(|| SlopeMoments::of_heights(&self.map, wrap))
    }

    /// Heap bytes of halvings and moments, if they were made.
    #[must_use]
    pub fn filter_bytes(&self) -> usize {
        let halved = self.halvings.get().into_iter().flatten();
        let moments = self.moments.iter().filter_map(OnceLock::get).flatten();
        halved.map(HeightMap::bytes).sum::<usize>()
            + moments.map(SlopeMoments::bytes).sum::<usize>()
    }

    /// The extremes of the heights over squares of all sizes, for a slot that goes on by `wrap`.
    #[must_use]
    pub fn pyramid(&self, wrap: Wrap) -> &HeightPyramid {
        self.pyramids[wrap as usize].get_or_init(|| HeightPyramid::new(&self.map, wrap))
    }

    /// The cones over the heights, or over the heights turned over.
    #[must_use]
    pub fn cones(&self, wrap: Wrap, inverted: bool) -> &ConeMap {
        self.cones[wrap as usize][usize::from(inverted)]
            .get_or_init(|| ConeMap::new(&self.map, wrap, inverted))
    }

    /// How steeply rays must leave the heights, or the heights turned over, to be in nobody's shadow; `None` for a slot
    /// that does not repeat.
    #[must_use]
    pub fn horizons(&self, wrap: Wrap, inverted: bool) -> Option<&HorizonMap> {
        let horizons = &self.horizons[usize::from(inverted)];
        (wrap == Wrap::Repeat)
            .then(|| horizons.get_or_init(|| HorizonMap::new(&self.map, inverted)))
    }

    /// Heap bytes of pyramids, cones and horizons made so far.
    #[must_use]
    pub fn search_bytes(&self) -> usize {
        let pyramids = self.pyramids.iter().filter_map(OnceLock::get);
        let cones = self.cones.iter().flatten().filter_map(OnceLock::get);
        let horizons = self.horizons.iter().filter_map(OnceLock::get);
        pyramids.map(HeightPyramid::bytes).sum::<usize>()
            + cones.map(ConeMap::bytes).sum::<usize>()
            + horizons.map(HorizonMap::bytes).sum::<usize>()
    }
}
