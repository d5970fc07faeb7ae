//! Ray–triangle tests: one watertight test for the picture, two textbook ones to run beside it.
//!
//! A test is a type parameter of the traversal, so choosing one costs nothing per triangle. Every
//! kernel that uses [`Watertight`], scalar or vector, returns the bits of its
//! [`TriangleTest::intersect`]: no fused multiply-add, one order of operations.

mod textbook;
mod watertight;
mod woop;

use glam::Vec3;

use super::{Ray, RaySlabs};
use crate::math::simd::Simd;

pub use textbook::{MollerTrumbore, ReportEdges};
pub use watertight::{Axis, Watertight};
pub(super) use watertight::{edge, inside_in_f64, meet_plane, sheared};
pub use woop::PlainWoop;

/// Number of triangles that are tested together.
pub const LANES: usize = 8;

/// Corners of eight triangles, `[vertex][axis][lane]`. Unused lanes hold NaN, which no test accepts.
pub type Corners8 = [[[f32; LANES]; 3]; 3];

/// Where a ray meets one triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TriangleHit {
    /// Distance along the unit direction, internal units; always above 0.
    pub t: f32,
    /// Barycentric weight of the second vertex, in `[0, 1]` up to rounding.
    pub u: f32,
    /// Barycentric weight of the third vertex, in `[0, 1]` up to rounding.
    pub v: f32,
}

/// A ray prepared for one kind of triangle test. Triangles are two-sided.
pub trait TriangleTest: Sized {
    /// Whether bundles of rays are tested with the vector twin of [`Watertight`].
    const HAS_BUNDLES: bool = false;

    /// Prepares a ray; done once per ray.
    fn new(ray: &Ray) -> Self;

    /// The hit with `t > 0`, if any. `slabs` must belong to the same ray.
    ///
    /// Degenerate and non-finite triangles, and rays with NaN, give `None`.
    fn intersect(&self, slabs: &RaySlabs, corners: &[Vec3; 3]) -> Option<TriangleHit>;

    /// Tells `visitor` each lane that [`Self::intersect`] hits and that it wants to know of, with the same bits, until
    /// it has enough; says whether it has.
    #[inline(always)]
    fn intersect_block<S: Simd>(
        &self,
        _simd: S,
        slabs: &RaySlabs,
        corners: &Corners8,
        visitor: &mut impl Visitor,
    ) -> bool {
        (0..LANES).any(|lane| {
            let hit = self.intersect(slabs, &corners_of(corners, lane));
            hit.is_some_and(|hit| visitor.visit(lane, hit))
        })
    }
}

/// What a block of triangles is asked for.
pub trait Visitor {
    /// What a hit would mean that lies between two distances: a test may know these before it knows the hit.
    fn expects(&self, near: f32, far: f32) -> Interest;
    /// A hit on a lane; says whether that is enough.
    fn visit(&mut self, lane: usize, hit: TriangleHit) -> bool;
}

/// What a hit is worth of which little is known yet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interest {
    /// It would change nothing.
    None,
    /// It depends on where the hit is.
    Some,
    /// That there is a hit is enough.
    Enough,
}

/// Corners of one lane.
#[inline(always)]
pub(super) fn corners_of(corners: &Corners8, lane: usize) -> [Vec3; 3] {
    let corner = |[x, y, z]: &[[f32; LANES]; 3]| Vec3::new(x[lane], y[lane], z[lane]);
    [
        corner(&corners[0]),
        corner(&corners[1]),
        corner(&corners[2]),
    ]
}

/// Clears the lowest set bit of eight and returns its position.
#[inline(always)]
pub(super) fn take_lowest(mask: &mut u32) -> usize {
    let lane = mask.trailing_zeros() as usize;
    *mask &= *mask - 1;
    // Lets the compiler see that indexing by it cannot fail.
    lane % LANES
}
