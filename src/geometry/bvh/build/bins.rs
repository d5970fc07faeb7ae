//! The binned surface area heuristic: where to part a list of triangles.

use glam::{Vec3, Vec4};
use rayon::prelude::*;

use super::PARALLEL_MIN;
use super::prim::{Box4, PrimRef};
use crate::geometry::triangle::LANES;

/// Cost of one triangle in units of one node visit.
///
/// Low, because eight are tested at once: it makes full leaves, which measured up to 1.9 times faster
/// than thin ones.
pub(in crate::geometry::bvh) const TRIANGLE_COST: f32 = 0.2;

/// Bins per axis, at most. A power of two.
const BINS: usize = 16;
/// Triangles up to which `FEW_BINS` bins find the same planes but for rounding.
const FEW: usize = 4 * LANES;
/// Bins per axis for a few triangles: filling and sweeping more would cost more than the triangles do.
const FEW_BINS: usize = 8;

/// Cost of testing `count` triangles in a box of the given half area.
pub(super) fn leaf_cost(count: u32, half_area: f32) -> f32 {
    // A block costs the same with one triangle as with eight.
    TRIANGLE_COST * count.next_multiple_of(LANES as u32) as f32 * half_area
}

/// Triangles that fell into one bin.
#[derive(Debug, Clone, Copy)]
struct Bin {
    bounds: Box4,
    count: u32,
}

impl Bin {
    const EMPTY: Self = Self {
        bounds: Box4::EMPTY,
        count: 0,
    };

    #[inline(always)]
    fn merged(self, other: Self) -> Self {
        Self {
            bounds: self.bounds.union(other.bounds),
            count: self.count + other.count,
        }
    }

    /// Infinite without triangles: there is nothing to part.
    #[inline(always)]
    fn cost(&self) -> f32 {
        if self.count == 0 {
            f32::INFINITY
        } else {
            leaf_cost(self.count, self.bounds.half_area())
        }
    }
}

/// `[axis][bin]`.
type Bins = [[Bin; BINS]; 3];

/// Where to split: bins below `first_right` on `axis` go left.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane {
    pub(super) axis: usize,
    pub(super) first_right: u32,
    /// Sum over both sides of triangle cost times half area.
    pub(super) cost: f32,
    /// Boxes around the triangles on both sides.
    pub(super) sides: [Box4; 2],
}

/// Maps centroids to bins.
pub(super) struct Grid {
    origin: Vec4,
    bins_per_unit: Vec4,
    extent: Vec3,
    bins: usize,
}

impl Grid {
    /// A grid over the box of the centroids of so many triangles.
    pub(super) fn new(centroids: Box4, triangles: usize) -> Self {
        let extent = centroids.extent();
        let bins = if triangles <= FEW { FEW_BINS } else { BINS };
        Self {
            origin: centroids.lower,
            // Infinite on an axis without extent, where 0·∞ = NaN becomes bin 0.
            bins_per_unit: (Vec3::splat(bins as f32) / extent).extend(0.0),
            extent,
            bins,
        }
    }

    pub(super) fn longest_axis(&self) -> usize {
        self.extent.max_position()
    }

    /// Bin of a centroid on each axis.
    #[inline(always)]
    pub(super) fn bin(&self, centroid: Vec4) -> [u32; 3] {
        let at = (centroid - self.origin) * self.bins_per_unit - Vec4::splat(0.5);
        // Beside 2²³ the spacing of floats is 1: adding it rounds, and leaves the integer in the low bits.
        let integer = at.max(Vec4::ZERO).min(Vec4::splat((self.bins - 1) as f32)) + SHIFTER;
        let [x, y, z, _] = integer.to_array();
        [x, y, z].map(|i| i.to_bits() & (BINS as u32 - 1))
    }

    /// The cheapest plane that leaves triangles on both sides and has a finite cost.
    pub(super) fn best_plane(&self, prims: &[PrimRef]) -> Option<Plane> {
        let bins = self.fill(prims);
        let mut best: Option<Plane> = None;
        for (axis, bins) in bins.iter().enumerate() {
            let bins = &bins[..self.bins];
            let mut right = [Bin::EMPTY; BINS];
            for i in (1..bins.len()).rev() {
                right[i - 1] = right[i].merged(bins[i]);
            }
            let mut left = Bin::EMPTY;
            for (i, bin) in bins.iter().enumerate() {
                left = left.merged(*bin);
                let cost = left.cost() + right[i].cost();
                if cost < best.map_or(f32::INFINITY, |b| b.cost) {
                    best = Some(Plane {
                        axis,
                        first_right: i as u32 + 1,
                        cost,
                        sides: [left.bounds, right[i].bounds],
                    });
                }
            }
        }
        best
    }

    fn fill(&self, prims: &[PrimRef]) -> Bins {
        let of_chunk = |chunk: &[PrimRef]| {
            let mut bins = [[Bin::EMPTY; BINS]; 3];
            for prim in chunk {
                for (bins, at) in bins.iter_mut().zip(self.bin(prim.centroid())) {
                    let bin = &mut bins[at as usize % BINS];
                    bin.bounds = bin.bounds.union(prim.bounds());
                    bin.count += 1;
                }
            }
            bins
        };
        if prims.len() < 2 * PARALLEL_MIN {
            return of_chunk(prims);
        }
        let merge = |mut a: Bins, b: Bins| {
            for (a, b) in a.as_flattened_mut().iter_mut().zip(b.as_flattened()) {
                *a = a.merged(*b);
            }
            a
        };
        let chunks = prims.par_chunks(PARALLEL_MIN).map(of_chunk);
        chunks.reduce(|| [[Bin::EMPTY; BINS]; 3], merge)
    }
}

/// 2²³ in each lane.
const SHIFTER: Vec4 = Vec4::splat(8_388_608.0);
