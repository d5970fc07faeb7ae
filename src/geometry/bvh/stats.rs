//! How large and how good a tree is.

use serde::Serialize;

use super::Bvh;
use super::build::TRIANGLE_COST;
use super::node::{Child, ChildRef};
use crate::geometry::Aabb;
use crate::geometry::triangle::LANES;

/// Size and quality of a [`Bvh`].
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct BvhStats {
    /// Inner nodes.
    pub nodes: usize,
    /// Leaves: blocks of up to eight triangles.
    pub leaves: usize,
    /// Triangles.
    pub triangles: usize,
    /// Heap bytes of nodes and leaves.
    pub bytes: usize,
    /// Nodes and leaf on the longest way down; 1 if the root is a leaf, 0 if there is nothing.
    pub max_depth: usize,
    /// Triangles per place in a leaf, in `(0, 1]`; 0 if there is nothing.
    pub leaf_fill: f64,
    /// Expected cost of a long random ray that hits the root's box, in node visits: a triangle costs
    /// 0.2. The surface area heuristic (Goldsmith and Salmon 1987); NaN if the box has no area.
    pub sah_cost: f64,
}

impl Bvh {
    /// Walks the tree.
    #[must_use]
    pub fn stats(&self) -> BvhStats {
        let leaves = self.blocks.len();
        let mut stats = BvhStats {
            nodes: self.nodes.len(),
            leaves,
            triangles: self.triangles,
            bytes: size_of_val(&*self.nodes) + size_of_val(&*self.blocks),
            max_depth: 0,
            leaf_fill: if leaves == 0 {
                0.0
            } else {
                self.triangles as f64 / (leaves * LANES) as f64
            },
            sah_cost: 0.0,
        };
        if self.root != ChildRef::EMPTY {
            self.add_subtree(&mut stats, (self.bounds, self.root.unpack()), 1);
            stats.sah_cost /= f64::from(self.bounds.half_area());
        }
        stats
    }

    fn add_subtree(&self, stats: &mut BvhStats, (bounds, child): (Aabb, Child), depth: usize) {
        stats.max_depth = stats.max_depth.max(depth);
        let area = f64::from(bounds.half_area());
        match child {
            Child::Node(index) => {
                stats.sah_cost += area;
                for child in self.nodes[index].children() {
                    self.add_subtree(stats, child, depth + 1);
                }
            }
            Child::Block(index) => {
                let count = self.blocks[index].triangles().count();
                stats.sah_cost += area * f64::from(TRIANGLE_COST) * count as f64;
            }
        }
    }
}
