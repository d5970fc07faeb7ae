//! Exact walks of a tile's points, gathered so that many go in step.

use crate::math::simd::SimdLevel;
use crate::surface::mapping::relief::{ReliefField, ReliefRay, Walk};

/// Walks over one relief, each for a place. Kept from tile to tile, so that the steady state allocates
/// nothing.
#[derive(Debug, Default)]
pub struct Walks {
    places: Vec<usize>,
    rays: Vec<ReliefRay>,
    walks: Vec<Walk>,
}

impl Walks {
    /// Forgets all.
    pub fn clear(&mut self) {
        self.places.clear();
        self.rays.clear();
    }

    /// Adds a walk for a place.
    pub fn push(&mut self, place: usize, ray: ReliefRay) {
        self.places.push(place);
        self.rays.push(ray);
    }

    /// Walks all; returns the steps taken.
    pub fn run(&mut self, field: &ReliefField<'_>, level: SimdLevel) -> u64 {
        self.walks.clear();
        self.walks.resize(self.rays.len(), Walk::NONE);
        field.walk_all(level, &self.rays, &mut self.walks);
        self.walks.iter().map(|walk| u64::from(walk.steps)).sum()
    }

    /// Places, rays and what came of them.
    pub fn iter(&self) -> impl Iterator<Item = (usize, &ReliefRay, &Walk)> {
        let walked = self.rays.iter().zip(&self.walks);
        self.places
            .iter()
            .copied()
            .zip(walked)
            .map(|(place, (ray, walk))| (place, ray, walk))
    }
}
