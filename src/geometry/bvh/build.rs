//! Binary tree by the binned surface area heuristic. The one place here that knows rayon.
//!
//! Nothing depends on the number of threads: boxes are unions, which are exact in any order, and each
//! subtree is a function of its own triangles alone.
//!
//! Source: Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies".

use glam::Vec3;
use rayon::prelude::*;

use crate::geometry::triangle::LANES;
use crate::geometry::{Aabb, TriangleMesh};

/// Cost of one triangle in units of one node visit.
///
/// Low, because eight are tested at once: it makes full leaves, which measured up to 1.9 times faster
/// than thin ones.
pub(super) const TRIANGLE_COST: f32 = 0.2;
/// Bins per axis.
const BINS: usize = 16;
/// Below this many triangles a task is not worth sharing.
const PARALLEL_MIN: usize = 4096;
/// From this depth on triangles are halved, so that no input makes a deep tree. Halving 2³² triangles
/// takes at most 32 more levels.
const MAX_SAH_DEPTH: u32 = 64;

/// A triangle while the tree is built.
#[derive(Debug, Clone, Copy)]
pub(super) struct PrimRef {
    bounds: Aabb,
    /// Index in the mesh.
    pub(super) prim: u32,
}

impl PrimRef {
    fn new(mesh: &TriangleMesh, prim: u32) -> Self {
        Self {
            bounds: Aabb::from_points(mesh.corners(prim)),
            prim,
        }
    }

    /// Twice the centre of the box: halving it would change no comparison.
    fn centroid(&self) -> Vec3 {
        self.bounds.min + self.bounds.max
    }
}

/// A binary tree over a reordered list of triangles.
#[derive(Debug)]
pub(super) struct Tree {
    pub(super) bounds: Aabb,
    pub(super) content: Content,
}

/// What a [`Tree`] holds.
#[derive(Debug)]
pub(super) enum Content {
    /// Up to [`LANES`] triangles: a range of the list.
    Leaf(std::ops::Range<usize>),
    /// Two halves.
    Inner(Box<[Tree; 2]>),
}

/// Builds the tree of a mesh; `None` if it has no triangles.
///
/// The list holds every triangle once, in the order in which leaves refer to it.
pub(super) fn binary_tree(mesh: &TriangleMesh) -> (Vec<PrimRef>, Option<Tree>) {
    let count = u32::try_from(mesh.len()).unwrap_or(u32::MAX);
    let mut prims: Vec<_> = (0..count)
        .into_par_iter()
        .with_min_len(PARALLEL_MIN)
        .map(|prim| PrimRef::new(mesh, prim))
        .collect();
    if prims.is_empty() {
        return (prims, None);
    }
    let bounds = bounds_of(&prims, |p| p.bounds);
    let root = Task {
        first: 0,
        depth: 0,
        bounds,
    };
    let tree = root.build(&mut prims);
    (prims, Some(tree))
}

/// A part of the list that is to become a subtree.
struct Task {
    /// Where the part begins in the whole list.
    first: usize,
    depth: u32,
    bounds: Aabb,
}

impl Task {
    fn build(self, prims: &mut [PrimRef]) -> Tree {
        let Some(middle) = self.split(prims) else {
            return Tree {
                bounds: self.bounds,
                content: Content::Leaf(self.first..self.first + prims.len()),
            };
        };
        let parallel = prims.len() >= PARALLEL_MIN;
        let (left, right) = prims.split_at_mut(middle);
        let child = |prims: &[PrimRef], first| Self {
            first,
            depth: self.depth + 1,
            bounds: bounds_of(prims, |p| p.bounds),
        };
        let (l, r) = (child(left, self.first), child(right, self.first + middle));
        let children = if parallel {
            rayon::join(|| l.build(left), || r.build(right)).into()
        } else {
            [l.build(left), r.build(right)]
        };
        Tree {
            bounds: self.bounds,
            content: Content::Inner(Box::new(children)),
        }
    }

    /// Reorders `prims` into two non-empty parts and says where the second begins; `None` for a leaf.
    fn split(&self, prims: &mut [PrimRef]) -> Option<usize> {
        if prims.len() == 1 {
            return None;
        }
        let grid = Grid::new(bounds_of(prims, |p| Aabb::EMPTY.with_point(p.centroid())));
        let plane = (self.depth < MAX_SAH_DEPTH)
            .then(|| grid.best_plane(&grid.fill(prims)))
            .flatten();
        if prims.len() <= LANES {
            let leaf_cost = leaf_cost(prims.len(), self.bounds.half_area());
            let split_cost = plane.map_or(f32::INFINITY, |p| self.bounds.half_area() + p.cost);
            if leaf_cost <= split_cost || split_cost.is_nan() {
                return None;
            }
        }
        let middle = plane.map_or(0, |p| {
            partition(prims, |prim| grid.bin(prim)[p.axis] < p.first_right)
        });
        // No plane, or none that parts them: coincident centres, overflowing areas.
        Some(if middle == 0 || middle == prims.len() {
            halve(prims, grid.longest_axis())
        } else {
            middle
        })
    }
}

/// Cost of testing `count` triangles in a box of the given half area.
fn leaf_cost(count: usize, half_area: f32) -> f32 {
    // A block costs the same with one triangle as with eight.
    TRIANGLE_COST * count.next_multiple_of(LANES) as f32 * half_area
}

/// Union of what `bounds` says of each triangle.
fn bounds_of(prims: &[PrimRef], bounds: impl Fn(&PrimRef) -> Aabb + Sync) -> Aabb {
    let of_chunk = |chunk: &[PrimRef]| {
        let boxes = chunk.iter().map(&bounds);
        boxes.fold(Aabb::EMPTY, Aabb::union)
    };
    if prims.len() < 2 * PARALLEL_MIN {
        return of_chunk(prims);
    }
    let chunks = prims.par_chunks(PARALLEL_MIN).map(of_chunk);
    chunks.reduce(|| Aabb::EMPTY, Aabb::union)
}

/// Moves what is `left` to the front; returns how many.
fn partition(prims: &mut [PrimRef], left: impl Fn(&PrimRef) -> bool) -> usize {
    let (mut begin, mut end) = (0, prims.len());
    while begin < end {
        if left(&prims[begin]) {
            begin += 1;
        } else {
            end -= 1;
            prims.swap(begin, end);
        }
    }
    begin
}

/// Parts the triangles in the middle of their order along an axis; equal centres go by index.
///
/// The first part is a whole number of blocks.
fn halve(prims: &mut [PrimRef], axis: usize) -> usize {
    let middle = if prims.len() > LANES {
        (prims.len() / 2).next_multiple_of(LANES)
    } else {
        prims.len() / 2
    };
    prims.select_nth_unstable_by(middle, |a, b| {
        let along = f32::total_cmp(&a.centroid()[axis], &b.centroid()[axis]);
        along.then(a.prim.cmp(&b.prim))
    });
    middle
}

/// Triangles that fell into one bin.
#[derive(Debug, Clone, Copy)]
struct Bin {
    bounds: Aabb,
    count: usize,
}

impl Bin {
    const EMPTY: Self = Self {
        bounds: Aabb::EMPTY,
        count: 0,
    };

    fn merged(self, other: Self) -> Self {
        Self {
            bounds: self.bounds.union(other.bounds),
            count: self.count + other.count,
        }
    }

    fn cost(&self) -> f32 {
        leaf_cost(self.count, self.bounds.half_area())
    }
}

/// `[axis][bin]`.
type Bins = [[Bin; BINS]; 3];

/// Where to split: bins below `first_right` on `axis` go left.
#[derive(Debug, Clone, Copy)]
struct Plane {
    axis: usize,
    first_right: usize,
    /// Sum over both sides of triangle cost times half area.
    cost: f32,
}

/// Maps centroids to bins.
struct Grid {
    origin: Vec3,
    bins_per_unit: Vec3,
    extent: Vec3,
}

impl Grid {
    fn new(centroids: Aabb) -> Self {
        let extent = centroids.extent();
        Self {
            origin: centroids.min,
            // Infinite on an axis without extent, where 0·∞ = NaN becomes bin 0.
            bins_per_unit: Vec3::splat(BINS as f32) / extent,
            extent,
        }
    }

    fn longest_axis(&self) -> usize {
        self.extent.max_position()
    }

    /// Bin of a triangle on each axis. Casts saturate, and NaN becomes 0.
    #[inline(always)]
    fn bin(&self, prim: &PrimRef) -> [usize; 3] {
        let at = (prim.centroid() - self.origin) * self.bins_per_unit;
        at.to_array().map(|x| (x as usize).min(BINS - 1))
    }

    fn fill(&self, prims: &[PrimRef]) -> Bins {
        let of_chunk = |chunk: &[PrimRef]| {
            let mut bins = [[Bin::EMPTY; BINS]; 3];
            for prim in chunk {
                for (bins, at) in bins.iter_mut().zip(self.bin(prim)) {
                    bins[at].bounds = bins[at].bounds.union(prim.bounds);
                    bins[at].count += 1;
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

    /// The cheapest plane that leaves triangles on both sides and has a finite cost.
    fn best_plane(&self, bins: &Bins) -> Option<Plane> {
        let mut best: Option<Plane> = None;
        for (axis, bins) in bins.iter().enumerate() {
            let mut right_cost = [0.0; BINS];
            let mut right = Bin::EMPTY;
            for i in (1..BINS).rev() {
                right = right.merged(bins[i]);
                right_cost[i] = if right.count == 0 {
                    f32::INFINITY
                } else {
                    right.cost()
                };
            }
            let mut left = Bin::EMPTY;
            for first_right in 1..BINS {
                left = left.merged(bins[first_right - 1]);
                let cost = left.cost() + right_cost[first_right];
                if left.count > 0 && cost < best.map_or(f32::INFINITY, |b| b.cost) {
                    best = Some(Plane {
                        axis,
                        first_right,
                        cost,
                    });
                }
            }
        }
        best
    }
}
