//! Hierarchies of triangles that come in groups.

use glam::Vec3;
use rayon::prelude::*;

use super::super::collapse::collapse;
use super::super::node::{Block, Node};
use super::super::{Bvh, watched};
use super::block_tree;
use crate::geometry::Aabb;
use crate::geometry::triangle::{Corners8, LANES, corners_of};
use crate::math::simd::simd_level;

impl Bvh {
    /// Builds the hierarchy of triangles that come in groups of eight neighbours, each of which becomes a leaf: much
    /// sooner done than for triangles one by one. Group `g` has the triangles `8·g … 8·g + 7`. No coordinate is larger
    /// than `reach`; `watch` as in [`Self::build_watched`].
    ///
    /// # Errors
    /// Stops soon after the first error that `watch` returns, and returns it.
    pub fn of_groups<E: Send + Sync>(
        groups: impl IndexedParallelIterator<Item = Corners8>,
        reach: f32,
        watch: &(dyn Fn(f32) -> Result<(), E> + Sync),
    ) -> Result<Self, E> {
        let blocks: Vec<Block> = groups
            .enumerate()
            .map(|(i, corners)| Block {
                corners,
                prims: std::array::from_fn(|lane| (i * LANES + lane) as u32),
            })
            .collect();
        let (tree, order) = watched(watch, |go_on| block_tree(&blocks, go_on))?;
        let (nodes, root) = collapse(tree.as_ref(), blocks.len(), &|leaf| order[leaf] as usize);
        Ok(Self {
            nodes,
            root,
            bounds: tree.map_or(Aabb::EMPTY, |tree| tree.bounds),
            reach,
            triangles: blocks.len() * LANES,
            level: simd_level(),
            blocks,
        })
    }

    /// Corners of a triangle of a hierarchy [of groups](Self::of_groups).
    ///
    /// # Panics
    /// If there is no such triangle.
    #[must_use]
    pub fn group_corners(&self, prim: u32) -> [Vec3; 3] {
        let block = &self.blocks[prim as usize / LANES];
        corners_of(&block.corners, prim as usize % LANES)
    }

    /// Heap bytes of a hierarchy of so many groups, about.
    #[must_use]
    pub const fn bytes_of_groups(groups: usize) -> usize {
        groups * (size_of::<Block>() + size_of::<Node>() / 3)
    }
}
