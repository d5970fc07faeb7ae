//! Memory layout of the hierarchy: eight boxes or eight triangles side by side, ready for vector lanes.

use glam::Vec3;

use crate::geometry::triangle::{Corners8, LANES};
use crate::geometry::{Aabb, RaySlabs, TriangleMesh, slabs};

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
    pub(super) fn hit_lanes(&self, ray: &RaySlabs, t_max: f32) -> (u32, [f32; LANES]) {
        let (mut near, mut far) = ([0.0; LANES], [t_max; LANES]);
        for axis in 0..3 {
            let negative = ray.negative[axis];
            let first = &self.planes[axis][usize::from(negative)];
            let last = &self.planes[axis][usize::from(!negative)];
            let inv = ray.inv_dir[axis];
            let (near_shift, far_shift) = (ray.near_shift[axis], ray.far_shift[axis]);
            for lane in 0..LANES {
                near[lane] = slabs::larger(first[lane] * inv - near_shift, near[lane]);
                far[lane] = slabs::smaller(last[lane] * inv - far_shift, far[lane]);
            }
        }
        let mut mask = 0;
        for lane in 0..LANES {
            mask |= u32::from(near[lane] <= far[lane]) << lane;
        }
        (mask, near)
    }
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

    /// Corners of one lane.
    #[inline(always)]
    pub(super) fn corners(&self, lane: usize) -> [Vec3; 3] {
        self.corners
            .each_ref()
            .map(|[x, y, z]| Vec3::new(x[lane], y[lane], z[lane]))
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
            .map(|(lane, &prim)| (prim, self.corners(lane)))
    }
}

// Four and five cache lines; a field more would cost one in eight.
const _: () = assert!(size_of::<Node>() == 256 && size_of::<Block>() == 320);
