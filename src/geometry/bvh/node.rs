//! Memory layout of the hierarchy: eight boxes or eight triangles side by side, ready for vector lanes.

use glam::Vec3;

use crate::geometry::triangle::{Corners8, LANES, corners_of};
use crate::geometry::{Aabb, RaySlabs, TriangleMesh};
use crate::math::simd::{Simd, SimdBase as _, SimdMask as _, f32x8, larger, smaller};

/// Marks an unused lane of a [`Block`].
pub(super) const NO_PRIM: u32 = u32::MAX;

/// What a child slot points to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct ChildRef(u32);

/// A [`ChildRef`], unpacked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Child {
    /// Index of an inner node.
    Node(usize),
    /// Index of a block of triangles.
    Block(usize),
}

impl ChildRef {
    const BLOCK_BIT: u32 = 1 << 31;
    /// No child. Points to a block that never exists, so that following it by mistake finds nothing.
    pub(super) const EMPTY: Self = Self(u32::MAX);

    /// Reference to an inner node. Indices stay far below 2³¹: triangles are counted in `u32`.
    pub(super) const fn node(index: usize) -> Self {
        Self(index as u32)
    }

    /// Reference to a block of triangles.
    pub(super) const fn block(index: usize) -> Self {
        Self(index as u32 | Self::BLOCK_BIT)
    }

    /// Node or block.
    #[inline(always)]
    pub(super) const fn unpack(self) -> Child {
        if self.0 & Self::BLOCK_BIT == 0 {
            Child::Node(self.0 as usize)
        } else {
            Child::Block((self.0 & !Self::BLOCK_BIT) as usize)
        }
    }
}

/// Up to eight children and their boxes: four cache lines.
#[derive(Debug, Clone, PartialEq)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// `[axis][lower, upper][lane]`; unused lanes are empty boxes, which every ray misses.
    pub(super) planes: [[[f32; LANES]; 2]; 3],
    /// In the order of the boxes; [`ChildRef::EMPTY`] after the last.
    pub(super) children: [ChildRef; LANES],
}

impl Node {
    /// A node without children.
    pub(super) const fn empty() -> Self {
        Self {
            planes: [[[f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]]; 3],
            children: [ChildRef::EMPTY; LANES],
        }
    }

    /// Puts a child with its box into a lane.
    pub(super) fn set(&mut self, lane: usize, bounds: Aabb, child: ChildRef) {
        let (min, max) = (bounds.min.to_array(), bounds.max.to_array());
        for (axis, [lower, upper]) in self.planes.iter_mut().enumerate() {
            lower[lane] = min[axis];
            upper[lane] = max[axis];
        }
        self.children[lane] = child;
    }

    /// Box of a lane.
    pub(super) fn bounds(&self, lane: usize) -> Aabb {
        let [x, y, z] = &self.planes;
        Aabb {
            min: Vec3::new(x[0][lane], y[0][lane], z[0][lane]),
            max: Vec3::new(x[1][lane], y[1][lane], z[1][lane]),
        }
    }

    /// The used lanes: boxes and children.
    pub(super) fn children(&self) -> impl Iterator<Item = (Aabb, Child)> {
        self.children
            .iter()
            .enumerate()
            .filter(|(_, child)| **child != ChildRef::EMPTY)
            .map(|(lane, child)| (self.bounds(lane), child.unpack()))
    }

    /// Which boxes the ray meets in `[0, t_max]`, as bits, and where it enters each.
    ///
    /// The same operations as [`RaySlabs::interval`], so that intervals nest bit for bit.
    #[inline(always)]
    pub(super) fn hit_lanes<S: Simd>(
        &self,
        simd: S,
        ray: &RaySlabs,
        t_max: f32,
    ) -> (u32, [f32; LANES]) {
        let [x, y, z] = &self.planes;
        let planes = [x.each_ref(), y.each_ref(), z.each_ref()];
        hit_lanes(simd, planes, ray, t_max)
    }
}

/// Which of eight boxes the ray meets in `[0, t_max]`, as bits, and where it enters each: `[axis][least, most][box]`.
#[inline(always)]
fn hit_lanes<S: Simd>(
    simd: S,
    planes: [[&[f32; LANES]; 2]; 3],
    ray: &RaySlabs,
    t_max: f32,
) -> (u32, [f32; LANES]) {
    let splat = |x| f32x8::splat(simd, x);
    let (mut near, mut far) = (splat(0.0), splat(t_max));
    let (inv_dir, shifts) = (ray.inv_dir.to_array(), ray.shifts());
    for axis in 0..3 {
        let negative = ray.negative[axis];
        let first = f32x8::from_slice(simd, planes[axis][usize::from(negative)]);
        let last = f32x8::from_slice(simd, planes[axis][usize::from(!negative)]);
        let [near_shift, far_shift] = shifts[axis];
        // What is NaN counts for nothing.
        near = larger(first * inv_dir[axis] - near_shift, near);
        far = smaller(last * inv_dir[axis] - far_shift, far);
    }
    let mask = near.simd_le(far).to_bitmask() as u32;
    (mask, near.into())
}

/// Up to eight triangles: five cache lines.
#[derive(Debug, Clone)]
#[repr(C, align(64))]
pub(super) struct Block {
    /// Corner coordinates; NaN in unused lanes.
    pub(super) corners: Corners8,
    /// Index of each triangle in the mesh; [`NO_PRIM`] in unused lanes.
    pub(super) prims: [u32; LANES],
}

impl Block {
    /// Copies the corners of up to eight triangles; further ones are left out.
    pub(super) fn new(mesh: &TriangleMesh, prims: impl Iterator<Item = u32>) -> Self {
        let mut block = Self {
            corners: [[[f32::NAN; LANES]; 3]; 3],
            prims: [NO_PRIM; LANES],
        };
        for (lane, prim) in prims.take(LANES).enumerate() {
            block.prims[lane] = prim;
            for (vertex, corner) in mesh.corners(prim).into_iter().enumerate() {
                for (axis, coordinate) in corner.to_array().into_iter().enumerate() {
                    block.corners[vertex][axis][lane] = coordinate;
                }
            }
        }
        block
    }

    /// [`Node::hit_lanes`] for boxes in place of the triangles: those between their first two corners.
    #[inline(always)]
    pub(super) fn hit_boxes<S: Simd>(
        &self,
        simd: S,
        ray: &RaySlabs,
        t_max: f32,
    ) -> (u32, [f32; LANES]) {
        let [least, most, _] = &self.corners;
        let planes = [
            [&least[0], &most[0]],
            [&least[1], &most[1]],
            [&least[2], &most[2]],
        ];
        let (mask, near) = hit_lanes(simd, planes, ray, t_max);
        let mut used = 0;
        for (lane, &prim) in self.prims.iter().enumerate() {
            used |= u32::from(prim != NO_PRIM) << lane;
        }
        (mask & used, near)
    }

    /// Whether the same triangles are in the same lanes.
    pub(super) fn same_triangles(&self, other: &Self) -> bool {
        // Not `==`: unused lanes hold NaN.
        self.prims == other.prims && self.triangles().eq(other.triangles())
    }

    /// The used lanes: triangle indices and corners.
    pub(super) fn triangles(&self) -> impl Iterator<Item = (u32, [Vec3; 3])> {
        self.prims
            .iter()
            .enumerate()
            .filter(|(_, prim)| **prim != NO_PRIM)
            .map(|(lane, &prim)| (prim, corners_of(&self.corners, lane)))
    }
}

// Four and five cache lines; a field more would cost one in eight.
const _: () = assert!(size_of::<Node>() == 256 && size_of::<Block>() == 320);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Ray;
    use crate::math::simd::PLAIN;

    #[test]
    fn unused_lanes_are_missed_and_used_ones_agree_with_the_scalar_test() {
        let mut node = Node::empty();
        let bounds = Aabb {
            min: Vec3::new(-1.0, 0.0, 2.0),
            max: Vec3::new(1.0, 0.0, 3.0),
        };
        node.set(5, bounds, ChildRef::block(0));
        for dir in [Vec3::X, -Vec3::X, -Vec3::Z, Vec3::new(0.6, -0.8, 0.0)] {
            for origin in [
                Vec3::new(0.0, 0.0, 2.5),
                Vec3::new(-1.2, 1.6, 2.0),
                Vec3::ONE,
            ] {
                let ray = RaySlabs::new(&Ray { origin, dir }, 3.0);
                let (near, far) = ray.interval(bounds.min, bounds.max);
                let (mask, entry) = node.hit_lanes(PLAIN, &ray, f32::INFINITY);
                let hit = near <= far && far >= 0.0;
                assert_eq!(mask, u32::from(hit) << 5, "{origin} {dir}");
                assert!(!hit || entry[5] == near.max(0.0));
            }
        }
    }
}
