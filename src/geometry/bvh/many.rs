//! Many rays at once: what the stages of a tile call.

use super::{Bvh, HitFilter};
use crate::geometry::triangle::TriangleTest;
use crate::geometry::{Hit, Ray};

impl Bvh {
    /// [`Self::intersect`] for each ray, into `hits`.
    ///
    /// Rays that start together and run alike should be neighbours. How they are grouped never shows in
    /// the answers.
    ///
    /// # Panics
    /// If the three slices differ in length.
    pub fn intersect_many<T: TriangleTest, F: HitFilter>(
        &self,
        rays: &[Ray],
        t_max: &[f32],
        filter: &F,
        hits: &mut [Option<Hit>],
    ) {
        assert!(rays.len() == t_max.len() && rays.len() == hits.len());
        for ((ray, &t_max), hit) in rays.iter().zip(t_max).zip(hits) {
            *hit = self.intersect::<T, F>(ray, t_max, filter);
        }
    }

    /// [`Self::occluded`] for each ray, into `occluded`.
    ///
    /// # Panics
    /// If the three slices differ in length.
    pub fn occluded_many<T: TriangleTest, F: HitFilter>(
        &self,
        rays: &[Ray],
        t_max: &[f32],
        filter: &F,
        occluded: &mut [bool],
    ) {
        assert!(rays.len() == t_max.len() && rays.len() == occluded.len());
        for ((ray, &t_max), occluded) in rays.iter().zip(t_max).zip(occluded) {
            *occluded = self.occluded::<T, F>(ray, t_max, filter);
        }
    }
}
