//! A tree over boxes of any content: for things that know themselves what a ray meets inside.

use super::Bvh;
use super::node::{Block, Child};
use super::single::push_sorted;
use super::stack::{Entry, Stack};
use crate::geometry::triangle::LANES;
use crate::geometry::{Aabb, Ray, RaySlabs, TriangleMesh};
use crate::math::lanes::ones;
use crate::math::simd::Simd;

/// A hierarchy over boxes, by their index.
///
/// The nodes are those of a [`Bvh`]: a box is stored as the flat triangle that it bounds.
#[derive(Debug, Clone)]
pub struct BoxTree {
    bvh: Bvh,
}

impl BoxTree {
    /// Builds the tree on the current rayon pool; the same for any pool size. Boxes must not be empty.
    #[must_use]
    pub fn build(boxes: &[Aabb]) -> Self {
        let corner = |i: usize| i as u32;
        let mesh = TriangleMesh {
            positions: boxes.iter().flat_map(|b| [b.min, b.max]).collect(),
            indices: (0..boxes.len())
                .map(|i| [corner(2 * i), corner(2 * i + 1), corner(2 * i)])
                .collect(),
            ..TriangleMesh::default()
        };
        Self {
            bvh: Bvh::build(&mesh),
        }
    }

    /// Largest magnitude of a coordinate.
    #[must_use]
    pub const fn reach(&self) -> f32 {
        self.bvh.reach()
    }

    /// Heap bytes.
    #[must_use]
    pub const fn bytes(&self) -> usize {
        self.bvh.bytes()
    }

    /// The boxes that a ray meets, roughly from front to back.
    #[inline]
    #[must_use]
    pub fn along(&self, ray: &Ray) -> BoxesAlong<'_> {
        let mut stack = Stack::new();
        if !ray.runs_away_from(&self.bvh.bounds) {
            stack.push(Entry {
                near: f32::NEG_INFINITY,
                child: self.bvh.root,
            });
        }
        BoxesAlong {
            bvh: &self.bvh,
            slabs: RaySlabs::new(ray, self.bvh.reach),
            stack,
            met: [(0.0, 0); LANES],
            left: 0,
        }
    }
}

/// A walk through a [`BoxTree`].
pub struct BoxesAlong<'a> {
    bvh: &'a Bvh,
    slabs: RaySlabs,
    stack: Stack,
    /// Boxes of the block that was last come to, the nearest last.
    met: [(f32, u32); LANES],
    left: usize,
}

impl BoxesAlong<'_> {
    /// The next box that the ray enters at `limit` or before.
    #[inline(always)]
    pub fn next<S: Simd>(&mut self, simd: S, limit: f32) -> Option<u32> {
        loop {
            while self.left > 0 {
                self.left -= 1;
                let (near, index) = self.met[self.left];
                if near <= limit {
                    return Some(index);
                }
            }
            // A function of its own: within the loop over pieces it would take that loop's registers.
            simd.vectorize(
                #[inline(always)]
                || self.next_block(simd, limit),
            )?;
        }
    }

    /// Goes on to a block and lists its boxes.
    #[inline(always)]
    fn next_block<S: Simd>(&mut self, simd: S, limit: f32) -> Option<()> {
        loop {
            let mut next = loop {
                let Entry { near, child } = self.stack.pop()?;
                if near <= limit {
                    break child;
                }
            };
            loop {
                match next.unpack() {
                    Child::Node(index) => {
                        let node = &self.bvh.nodes[index];
                        let (mask, near) = node.hit_lanes(simd, &self.slabs, limit);
                        match push_sorted(&mut self.stack, node, mask, &near) {
                            Some(child) => next = child,
                            None => break,
                        }
                    }
                    Child::Block(index) => {
                        if let Some(block) = self.bvh.blocks.get(index) {
                            self.list(simd, block, limit);
                            return Some(());
                        }
                        break;
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn list<S: Simd>(&mut self, simd: S, block: &Block, limit: f32) {
        self.left = 0;
        let (mask, near) = block.hit_boxes(simd, &self.slabs, limit);
        for lane in ones(u64::from(mask)) {
            let lane = lane % LANES;
            let mut at = self.left;
            while at > 0 && self.met[at - 1].0 < near[lane] {
                self.met[at] = self.met[at - 1];
                at -= 1;
            }
            self.met[at] = (near[lane], block.prims[lane]);
            self.left += 1;
        }
    }
}
