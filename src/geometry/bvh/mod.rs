//! Bounding volume hierarchy: eight-wide nodes over blocks of eight triangles.
//!
//! - `build`: a binary tree by the surface area heuristic, in parallel, the same for any thread count
//! - `collapse`: from two children per node to eight
//! - `node`: what lies in memory
//! - `boxes`: the same nodes over boxes of any content
//! - `single`: one ray at a time, closest hit and any hit
//! - `many`: a tile's worth of rays; what runs alike goes as a bundle
//! - `bundle`, `query`: a bundle's path through the tree, and what its rays have found
//! - `validate`, `stats`: is the tree right, is it good
//!
//! A tree never changes an answer: whatever its shape, it reports the triangle, `t`, `u` and `v` that
//! testing every triangle would, bit for bit (see [`RaySlabs`](super::RaySlabs)).

mod boxes;
mod build;
mod bundle;
mod collapse;
mod many;
mod node;
mod query;
mod single;
mod stack;
mod stats;
mod validate;

use std::convert::Infallible;
use std::sync::OnceLock;

use super::{Aabb, TriangleMesh};
use crate::math::simd::{SimdLevel, UnsupportedLevel, simd_level};
use node::{Block, ChildRef, Node};

pub use boxes::{BoxTree, BoxesAlong};
pub use single::{AcceptAll, HitFilter};
pub use stats::BvhStats;

/// A hierarchy over the triangles of one mesh. Holds its own copy of the corners.
///
/// Never changes after it is built, so threads share it freely.
#[derive(Debug, Clone)]
pub struct Bvh {
    nodes: Vec<Node>,
    blocks: Vec<Block>,
    root: ChildRef,
    bounds: Aabb,
    /// Largest magnitude of a coordinate; see [`RaySlabs::new`](super::RaySlabs::new).
    reach: f32,
    triangles: usize,
    level: SimdLevel,
}

impl Bvh {
    /// Builds the hierarchy of a mesh on the current rayon pool; the same tree for any pool size.
    ///
    /// Any mesh will do: empty, coincident triangles, triangles without area. Depth stays below 100.
    #[must_use]
    pub fn build(mesh: &TriangleMesh) -> Self {
        let Ok(bvh) = Self::build_watched(mesh, &|_| Ok::<_, Infallible>(()));
        bvh
    }

    /// As [`Self::build`], for meshes that take their time: every few thousand triangles, `watch` is told
    /// the share that is in place (0…1), from any thread of the pool.
    ///
    /// # Errors
    /// Stops soon after the first error that `watch` returns, and returns it.
    pub fn build_watched<E: Send + Sync>(
        mesh: &TriangleMesh,
        watch: &(dyn Fn(f32) -> Result<(), E> + Sync),
    ) -> Result<Self, E> {
        let (tree, blocks) = watched(watch, |go_on| build::binary_tree(mesh, go_on))?;
        let (nodes, root) = collapse::collapse(tree.as_ref(), blocks.len(), &|leaf| leaf);
        let bounds = tree.map_or(Aabb::EMPTY, |tree| tree.bounds);
        let reach = if bounds.is_empty() {
            0.0
        } else {
            bounds.min.abs().max(bounds.max.abs()).max_element()
        };
        Ok(Self {
            nodes,
            blocks,
            root,
            bounds,
            reach,
            triangles: mesh.len(),
            level: simd_level(),
        })
    }

    /// Has bundles traced with the instructions of `level`. Changes no answer.
    ///
    /// # Errors
    /// If this machine lacks them.
    pub fn with_level(mut self, level: SimdLevel) -> Result<Self, UnsupportedLevel> {
        if !level.is_available() {
            return Err(UnsupportedLevel(level));
        }
        self.level = level;
        Ok(self)
    }

    /// The instructions that bundles are traced with.
    #[must_use]
    pub const fn level(&self) -> SimdLevel {
        self.level
    }

    /// Box around all triangles; empty for an empty mesh.
    #[must_use]
    pub const fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Largest magnitude of a coordinate, as [`RaySlabs::new`](super::RaySlabs::new) wants it.
    #[must_use]
    pub const fn reach(&self) -> f32 {
        self.reach
    }

    /// Number of triangles.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.triangles
    }

    /// Whether there is nothing to hit.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.triangles == 0
    }

    /// Heap bytes of nodes and leaves.
    #[must_use]
    pub const fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.blocks.as_slice())
    }

    /// Whether both have the same nodes and leaves in the same order.
    #[must_use]
    pub fn same_tree(&self, other: &Self) -> bool {
        let same_blocks = |a: &[Block], b: &[Block]| {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.same_triangles(b))
        };
        self.root == other.root
            && self.nodes == other.nodes
            && same_blocks(&self.blocks, &other.blocks)
    }
}

/// Calls `build` with a watch that says whether to go on, and returns the first error of `watch` instead of what was
/// built.
fn watched<T, E: Send + Sync>(
    watch: &(dyn Fn(f32) -> Result<(), E> + Sync),
    build: impl FnOnce(&(dyn Fn(f32) -> bool + Sync)) -> T,
) -> Result<T, E> {
    let stopped = OnceLock::new();
    let built = build(&|share| match watch(share) {
        Ok(()) => true,
        Err(error) => {
            // Only the first is returned.
            let _ = stopped.set(error);
            false
        }
    });
    stopped.into_inner().map_or(Ok(built), Err)
}
