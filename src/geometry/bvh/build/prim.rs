//! A triangle while the tree is built: a box and an index in two vector registers.

use glam::{Vec3, Vec4};

use crate::geometry::Aabb;

/// A box whose corners fill a vector register each; what their w holds does not count.
#[derive(Debug, Clone, Copy)]
pub(super) struct Box4 {
    pub(super) lower: Vec4,
    pub(super) upper: Vec4,
}

impl Box4 {
    /// The box that contains nothing.
    pub(super) const EMPTY: Self = Self {
        lower: Vec4::INFINITY,
        upper: Vec4::NEG_INFINITY,
    };

    #[inline(always)]
    pub(super) fn union(self, other: Self) -> Self {
        Self {
            lower: self.lower.min(other.lower),
            upper: self.upper.max(other.upper),
        }
    }

    #[inline(always)]
    pub(super) fn with_point(self, point: Vec4) -> Self {
        self.union(Self {
            lower: point,
            upper: point,
        })
    }

    pub(super) fn extent(&self) -> Vec3 {
        (self.upper - self.lower).truncate()
    }

    /// Half of the surface area of a box that is not empty.
    #[inline(always)]
    pub(super) fn half_area(&self) -> f32 {
        let e = self.extent();
        e.x * e.y + e.y * e.z + e.z * e.x
    }

    pub(super) fn aabb(&self) -> Aabb {
        Aabb {
            min: self.lower.truncate(),
            max: self.upper.truncate(),
        }
    }
}

/// The box and index of a triangle or a block: 32 bytes, two to a cache line.
#[derive(Debug, Clone, Copy)]
pub(in crate::geometry::bvh) struct PrimRef {
    /// The bits of `lower.w` are the index, so that both halves load as they are.
    bounds: Box4,
}

impl PrimRef {
    /// Something with an index and these corners.
    pub(super) fn new(prim: u32, corners: impl IntoIterator<Item = Vec3>) -> Self {
        let bounds = Aabb::from_points(corners);
        Self {
            bounds: Box4 {
                lower: bounds.min.extend(f32::from_bits(prim)),
                upper: bounds.max.extend(0.0),
            },
        }
    }

    /// Its index.
    pub(in crate::geometry::bvh) fn index(&self) -> u32 {
        self.bounds.lower.w.to_bits()
    }

    #[inline(always)]
    pub(super) fn bounds(&self) -> Box4 {
        self.bounds
    }

    /// Twice the centre of the box: halving it would change no comparison. w is 0.
    #[inline(always)]
    pub(super) fn centroid(&self) -> Vec4 {
        // An index is a tiny number; arithmetic on those is slow on some machines.
        self.bounds.lower.with_w(0.0) + self.bounds.upper
    }
}
