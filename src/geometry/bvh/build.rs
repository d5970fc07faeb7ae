//! Binary tree by the binned surface area heuristic, on the current rayon pool.
//!
//! Nothing depends on the number of threads: boxes are unions, which are exact in any order, and each
//! subtree is a function of its own triangles alone.
//!
//! Each level reads the triangles twice: once into bins, once to part them. The bins hold the boxes of the
//! parts, and parting gathers the boxes of their centres, so that the next level can start at once.
//!
//! Source: Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies".

mod bins;
mod groups;
mod prim;

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use rayon::prelude::*;

use super::node::Block;
use crate::geometry::triangle::LANES;
use crate::geometry::{Aabb, TriangleMesh};
pub(super) use bins::TRIANGLE_COST;
use bins::{Grid, Plane, leaf_cost};
use prim::{Box4, PrimRef};

/// Below this many triangles a task is not worth sharing.
const PARALLEL_MIN: usize = 4096;
/// From this depth on triangles are halved, so that no input makes a deep tree. Halving 2³² triangles
/// takes at most 32 more levels.
const MAX_SAH_DEPTH: u32 = 64;

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
    Leaf(Range<usize>),
    /// Two halves.
    Inner(Box<[Tree; 2]>),
}

/// Told the share of triangles that are in place, from any thread; says whether to go on.
pub(super) type Watch<'a> = &'a (dyn Fn(f32) -> bool + Sync);

/// Builds the tree of a mesh and the blocks of its leaves, in the order of a walk from left to right.
///
/// No tree without triangles, or once the watch said stop.
pub(super) fn binary_tree(mesh: &TriangleMesh, watch: Watch<'_>) -> (Option<Tree>, Vec<Block>) {
    let count = u32::try_from(mesh.len()).unwrap_or(u32::MAX);
    let mut prims: Vec<_> = (0..count)
        .into_par_iter()
        .with_min_len(PARALLEL_MIN)
        .map(|prim| PrimRef::new(prim, mesh.corners(prim)))
        .collect();
    let Some(tree) = tree(&mut prims, LANES, watch) else {
        return (None, Vec::new());
    };
    let leaves = tree.leaves(prims.len() / (LANES / 2) + 1);
    let blocks = leaves
        .into_par_iter()
        .with_min_len(PARALLEL_MIN / LANES)
        .map(|leaf: Range<u32>| {
            let prims = &prims[leaf.start as usize..leaf.end as usize];
            Block::new(mesh, prims.iter().map(PrimRef::index))
        })
        .collect();
    (Some(tree), blocks)
}

/// Builds the tree of blocks that are there already, and their order in a walk from left to right.
///
/// No tree without blocks, or once the watch said stop.
fn block_tree(blocks: &[Block], watch: Watch<'_>) -> (Option<Tree>, Vec<u32>) {
    let mut prims: Vec<_> = blocks
        .par_iter()
        .enumerate()
        .with_min_len(PARALLEL_MIN)
        .map(|(i, block)| {
            PrimRef::new(i as u32, block.triangles().flat_map(|(_, corners)| corners))
        })
        .collect();
    let tree = tree(&mut prims, 1, watch);
    (tree, prims.iter().map(PrimRef::index).collect())
}

/// Orders boxes into a tree with up to `leaf_size` in a leaf.
fn tree(prims: &mut [PrimRef], leaf_size: usize, watch: Watch<'_>) -> Option<Tree> {
    let progress = Progress {
        watch,
        total: prims.len(),
        placed: AtomicUsize::new(0),
        stopped: AtomicBool::new(!watch(0.0)),
    };
    if prims.is_empty() {
        return None;
    }
    let root = Task {
        first: 0,
        depth: 0,
        leaf_size,
        bounds: box_of(prims, |p| p.bounds()),
        centroids: box_of(prims, |p| Box4::EMPTY.with_point(p.centroid())),
        progress: &progress,
    };
    let tree = root.build(prims);
    (!progress.is_stopped()).then_some(tree)
}

impl Tree {
    /// Ranges of all leaves from left to right, about `count`.
    fn leaves(&self, count: usize) -> Vec<Range<u32>> {
        let mut leaves = Vec::with_capacity(count);
        self.list_leaves(&mut leaves);
        leaves
    }

    fn list_leaves(&self, leaves: &mut Vec<Range<u32>>) {
        match &self.content {
            Content::Leaf(range) => leaves.push(range.start as u32..range.end as u32),
            Content::Inner(halves) => halves.iter().for_each(|half| half.list_leaves(leaves)),
        }
    }
}

/// How far the build is, and whether it shall stop.
struct Progress<'a> {
    watch: Watch<'a>,
    total: usize,
    placed: AtomicUsize,
    stopped: AtomicBool,
}

impl Progress<'_> {
    fn is_stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }

    fn add(&self, triangles: usize) {
        let placed = self.placed.fetch_add(triangles, Ordering::Relaxed) + triangles;
        if !(self.watch)(placed as f32 / self.total as f32) {
            self.stopped.store(true, Ordering::Relaxed);
        }
    }
}

/// A part of the list that is to become a subtree.
struct Task<'a> {
    /// Where the part begins in the whole list.
    first: usize,
    depth: u32,
    /// Most triangles in a leaf.
    leaf_size: usize,
    bounds: Box4,
    centroids: Box4,
    progress: &'a Progress<'a>,
}

/// Where a list was parted, and the boxes of both parts.
struct Parts {
    middle: usize,
    bounds: [Box4; 2],
    centroids: [Box4; 2],
}

impl<'a> Task<'a> {
    fn build(self, prims: &mut [PrimRef]) -> Tree {
        let shared = prims.len() >= PARALLEL_MIN;
        // A build that is to stop ends in leaves of any size, and nobody sees the tree.
        if shared && self.progress.is_stopped() {
            return self.leaf(prims.len());
        }
        let Some(parts) = self.split(prims) else {
            return self.leaf(prims.len());
        };
        let (left, right) = prims.split_at_mut(parts.middle);
        let child = |first, side| Task {
            first,
            depth: self.depth + 1,
            leaf_size: self.leaf_size,
            bounds: parts.bounds[side],
            centroids: parts.centroids[side],
            progress: self.progress,
        };
        let (l, r) = (child(self.first, 0), child(self.first + parts.middle, 1));
        let halves = if shared {
            let build = |task: Task<'a>, prims: &mut [PrimRef]| {
                let tree = task.build(prims);
                if prims.len() < PARALLEL_MIN {
                    self.progress.add(prims.len());
                }
                tree
            };
            rayon::join(|| build(l, left), || build(r, right)).into()
        } else {
            [l.build(left), r.build(right)]
        };
        Tree {
            bounds: self.bounds.aabb(),
            content: Content::Inner(Box::new(halves)),
        }
    }

    fn leaf(&self, count: usize) -> Tree {
        Tree {
            bounds: self.bounds.aabb(),
            content: Content::Leaf(self.first..self.first + count),
        }
    }

    /// Reorders `prims` into two non-empty parts; `None` for a leaf.
    fn split(&self, prims: &mut [PrimRef]) -> Option<Parts> {
        if prims.len() == 1 {
            return None;
        }
        let grid = Grid::new(self.centroids, prims.len());
        let plane = (self.depth < MAX_SAH_DEPTH)
            .then(|| grid.best_plane(prims))
            .flatten();
        if prims.len() <= self.leaf_size {
            let area = self.bounds.half_area();
            let split_cost = plane.map_or(f32::INFINITY, |p| area + p.cost);
            if leaf_cost(prims.len() as u32, area) <= split_cost || split_cost.is_nan() {
                return None;
            }
        }
        // Without a plane: coincident centres, overflowing areas.
        Some(match plane {
            Some(plane) => partition(prims, &grid, &plane),
            None => halve(prims, grid.longest_axis()),
        })
    }
}

/// Union of what `part` says of each triangle.
fn box_of(prims: &[PrimRef], part: impl Fn(&PrimRef) -> Box4 + Sync) -> Box4 {
    let of_chunk = |chunk: &[PrimRef]| chunk.iter().map(&part).fold(Box4::EMPTY, Box4::union);
    if prims.len() < 2 * PARALLEL_MIN {
        return of_chunk(prims);
    }
    let chunks = prims.par_chunks(PARALLEL_MIN).map(of_chunk);
    chunks.reduce(|| Box4::EMPTY, Box4::union)
}

/// Moves what is left of the plane to the front. Lomuto's scheme without a branch: which side a triangle
/// is on cannot be predicted.
fn partition(prims: &mut [PrimRef], grid: &Grid, plane: &Plane) -> Parts {
    let mut middle = 0;
    let mut centroids = [Box4::EMPTY; 2];
    for i in 0..prims.len() {
        let prim = prims[i];
        let centroid = prim.centroid();
        let is_right = grid.bin(centroid)[plane.axis] >= plane.first_right;
        let side = &mut centroids[usize::from(is_right)];
        *side = side.with_point(centroid);
        prims[i] = prims[middle];
        prims[middle] = prim;
        middle += usize::from(!is_right);
    }
    Parts {
        middle,
        bounds: plane.sides,
        centroids,
    }
}

/// Parts the triangles in the middle of their order along an axis; equal centres go by index.
///
/// The first part is a whole number of blocks.
fn halve(prims: &mut [PrimRef], axis: usize) -> Parts {
    let middle = if prims.len() > LANES {
        (prims.len() / 2).next_multiple_of(LANES)
    } else {
        prims.len() / 2
    };
    prims.select_nth_unstable_by(middle, |a, b| {
        let along = f32::total_cmp(&a.centroid()[axis], &b.centroid()[axis]);
        along.then(a.index().cmp(&b.index()))
    });
    let (left, right) = prims.split_at(middle);
    Parts {
        middle,
        bounds: [left, right].map(|side| box_of(side, |p| p.bounds())),
        centroids: [left, right].map(|s| box_of(s, |p| Box4::EMPTY.with_point(p.centroid()))),
    }
}
