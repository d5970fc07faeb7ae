//! The watertight test of Woop, Benthin and Wald.

use std::ops::{Add, Div, Mul, Sub};

use glam::Vec3;

use super::{
    Corners8, Interest, LANES, TriangleHit, TriangleTest, Visitor, corners_of, take_lowest,
};
use crate::geometry::slabs::{larger, smaller};
use crate::geometry::{Ray, RaySlabs};
use crate::math::Real as _;
use crate::math::lanes::Lanes;
use crate::math::simd::{Simd, SimdBase as _, SimdMask as _, f32x8};
use crate::math::wide::Wide;

/// A coordinate axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// The first.
    X = 0,
    /// The second.
    Y = 1,
    /// The third.
    Z = 2,
}

/// Watertight test: a ray through a closed mesh cannot slip between two triangles.
///
/// *Inside or not* is the paper's. The corners are translated to the ray's origin and sheared so that
/// the ray becomes an axis; three 2D edge functions in `f32` say on which side of each edge it passes.
/// Two triangles that share an edge compute the same number with opposite signs, because rounding is
/// symmetric and monotone (a fused multiply-add would break just that). Where one is exactly 0, all
/// are computed again in `f64`, where the products of `f32` are exact.
///
/// *Where* is computed in `f64` from the corners themselves, for the few triangles that are met:
/// sheared `f32` weights lose `tan(incidence)` roundings of `t`, and more on slivers. So `t` is good
/// to one rounding of the result, its sign is right (a ray that leaves a triangle from a point off its
/// plane does not meet it again, without the error term of PBRT 4th ed., §6.8.7), and `u`, `v` belong
/// to the same point.
///
/// Last, `t` is clipped to the interval of the triangle's own box ([`RaySlabs`]). That changes
/// nothing unless the triangle is seen so nearly edge-on that inside is decided by rounding; then it
/// keeps the hit near the triangle. It makes any hierarchy agree with testing every triangle, bit for bit.
///
/// Source: Woop, Benthin and Wald 2013, "Watertight Ray/Triangle Intersection", JCGT 2(1); the plane
/// and the weights as Möller and Trumbore 1997. Held by `numerics`.
#[derive(Debug, Clone, Copy)]
pub struct Watertight {
    ray: Ray,
    /// The axis of the largest direction component. It becomes the last of [`Axis::last`].
    along: Axis,
    /// The ray's origin on the permuted axes.
    origin: [f32; 3],
    /// `(d_x / d_z, d_y / d_z)` on the permuted axes.
    shear: [f32; 2],
}

impl Axis {
    /// Axis of the largest component.
    #[inline(always)]
    #[must_use]
    pub fn of_largest(v: Vec3) -> Self {
        let [x, y, z] = v.abs().to_array();
        if x > y && x > z {
            Self::X
        } else if y > z {
            Self::Y
        } else {
            Self::Z
        }
    }

    /// Turns the axes round until this one is the last.
    #[inline(always)]
    pub fn last<T>(self, [x, y, z]: [T; 3]) -> [T; 3] {
        match self {
            Self::X => [y, z, x],
            Self::Y => [z, x, y],
            Self::Z => [x, y, z],
        }
    }
}

/// One sheared coordinate. This and [`edge`] are all the arithmetic that decides inside, for one ray
/// and for the lanes of many.
#[inline(always)]
pub(in crate::geometry) fn sheared<T>(p: T, origin: T, shear: T, z: T) -> T
where
    T: Mul<Output = T> + Sub<Output = T>,
{
    (p - origin) - shear * z
}

/// Twice the signed area that the origin spans with the edge from `p` to `q`.
#[inline(always)]
pub(in crate::geometry) fn edge<T>([px, py]: [T; 2], [qx, qy]: [T; 2]) -> T
where
    T: Mul<Output = T> + Sub<Output = T>,
{
    px * qy - py * qx
}

/// Whether no two numbers have opposite signs. Zero has either; NaN is rejected.
#[inline(always)]
fn same_side(e: [f64; 3]) -> bool {
    e.iter().all(|&e| e >= 0.0) || e.iter().all(|&e| e <= 0.0)
}

/// Inside or not where an edge function is 0 in `f32`: decided again, exactly.
///
/// A triangle without area seen from the ray is outside: its neighbours cover the place.
#[cold]
pub(in crate::geometry) fn inside_in_f64(corners: [[f32; 2]; 3]) -> bool {
    let [a, b, c] = corners.map(|corner| corner.map(f64::from));
    let e = [edge(c, b), edge(a, c), edge(b, a)];
    same_side(e) && e != [0.0; 3]
}

/// `t`, `u`, `v` where a ray meets the plane of a triangle, given as its first corner and the two edges
/// from there; NaN or infinite if it is parallel. For one ray or for the lanes of many.
#[inline(always)]
pub(in crate::geometry) fn meet_plane<T>(
    [ox, oy, oz]: [T; 3],
    dir: [T; 3],
    [[ax, ay, az], ab, ac]: [[T; 3]; 3],
    one: T,
) -> [T; 3]
where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<Output = T> + Div<Output = T>,
{
    let from_a = [ox - ax, oy - ay, oz - az];
    let p = cross(dir, ac);
    let q = cross(from_a, ab);
    let inv_det = one / dot(ab, p);
    [
        dot(ac, q) * inv_det,
        dot(from_a, p) * inv_det,
        dot(dir, q) * inv_det,
    ]
}

#[inline(always)]
fn dot<T>([ax, ay, az]: [T; 3], [bx, by, bz]: [T; 3]) -> T
where
    T: Add<Output = T> + Mul<Output = T>,
{
    ax * bx + ay * by + az * bz
}

#[inline(always)]
fn cross<T>([ax, ay, az]: [T; 3], [bx, by, bz]: [T; 3]) -> [T; 3]
where
    T: Copy + Sub<Output = T> + Mul<Output = T>,
{
    [ay * bz - by * az, az * bx - bz * ax, ax * by - bx * ay]
}

impl Watertight {
    /// Whether the ray passes inside the triangle, on either side of its origin.
    #[inline]
    fn inside(&self, corners: &[Vec3; 3]) -> bool {
        let [ox, oy, oz] = self.origin;
        let [a, b, c] = corners.map(|corner| {
            let [x, y, z] = self.along.last(corner.to_array());
            let z = z - oz;
            [
                sheared(x, ox, self.shear[0], z),
                sheared(y, oy, self.shear[1], z),
            ]
        });
        let e = [edge(c, b), edge(a, c), edge(b, a)];
        if e.contains(&0.0) {
            return inside_in_f64([a, b, c]);
        }
        same_side(e.map(f64::from))
    }

    /// One corner of eight triangles, translated and sheared.
    #[inline(always)]
    fn shear8<S: Simd>(&self, simd: S, p: &[[f32; LANES]; 3]) -> [f32x8<S>; 2] {
        let [x, y, z] = self.along.last(p.each_ref());
        let [ox, oy, oz] = self.origin;
        let (x, y, z) = (
            f32x8::from_slice(simd, x),
            f32x8::from_slice(simd, y),
            f32x8::from_slice(simd, z),
        );
        let splat = |x| f32x8::splat(simd, x);
        let z = z - splat(oz);
        [
            sheared(x, splat(ox), splat(self.shear[0]), z),
            sheared(y, splat(oy), splat(self.shear[1]), z),
        ]
    }

    /// [`Self::inside`] for each lane, as bits: inside for certain, and to be decided in `f64`.
    #[inline(always)]
    fn inside_block<S: Simd>(&self, simd: S, [a, b, c]: &Corners8) -> [u32; 2] {
        let (a, b, c) = (
            self.shear8(simd, a),
            self.shear8(simd, b),
            self.shear8(simd, c),
        );
        let zero = f32x8::splat(simd, 0.0);
        let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
        let above = u.simd_gt(zero) & v.simd_gt(zero) & w.simd_gt(zero);
        let below = u.simd_lt(zero) & v.simd_lt(zero) & w.simd_lt(zero);
        let on_edge = u.simd_eq(zero) | v.simd_eq(zero) | w.simd_eq(zero);
        [
            (above | below).to_bitmask() as u32,
            on_edge.to_bitmask() as u32,
        ]
    }

    /// Between which distances the ray meets a triangle, if it does: those at which it is in the triangle's own box.
    #[inline(always)]
    fn interval(slabs: &RaySlabs, [p0, p1, p2]: &[Vec3; 3]) -> (f32, f32) {
        slabs.interval(p0.min(*p1).min(*p2), p0.max(*p1).max(*p2))
    }

    /// Where the ray meets a triangle that it passes inside of, between two distances; `None` if that is not ahead.
    #[inline(always)]
    fn locate(&self, (near, far): (f32, f32), corners: &[Vec3; 3]) -> Option<TriangleHit> {
        let [a, b, c] = corners.map(|p| p.as_dvec3());
        let triangle = [a, b - a, c - a].map(|p| p.to_array());
        let origin = self.ray.origin.as_dvec3().to_array();
        let dir = self.ray.dir.as_dvec3().to_array();
        let [t, u, v] = meet_plane(origin, dir, triangle, 1.0).map(|x| x as f32);
        // NaN, of a parallel ray, becomes the near end and weights of 0.
        let t = smaller(larger(t, near), far);
        let u = smaller(larger(u, 0.0), 1.0);
        let v = smaller(larger(v, 0.0), 1.0 - u);
        (near <= far && t > 0.0).then_some(TriangleHit { t, u, v })
    }

    /// Which of sixteen triangles the ray may pass inside of, on either side of its origin, as bits: all that it does,
    /// and those that [`TriangleTest::intersect`] must look at twice. Corners are given by their places among
    /// `points`.
    #[inline(always)]
    pub(crate) fn may_pass<S: Simd>(
        &self,
        simd: S,
        points: &[Lanes<f32, 16>; 3],
        corners: &[[usize; 16]; 3],
    ) -> u64 {
        let [x, y, z] = self.along.last(points.each_ref());
        let wide = |value: f32| Wide::new(simd, value);
        let [ox, oy, oz] = self.origin;
        let (ox, oy) = (wide(ox), wide(oy));
        let (shear_x, shear_y) = (wide(self.shear[0]), wide(self.shear[1]));
        let mut flat: [Lanes<f32, 16>; 2] = [Lanes::splat(0.0); 2];
        for group in 0..16 / S::f32s::LEN {
            let z = z.get(simd, group) - oz;
            flat[0].set(group, sheared(x.get(simd, group), ox, shear_x, z));
            flat[1].set(group, sheared(y.get(simd, group), oy, shear_y, z));
        }
        let mut placed: [[Lanes<f32, 16>; 2]; 3] = [[Lanes::splat(0.0); 2]; 3];
        for k in 0..3 {
            for axis in 0..2 {
                for (i, corner) in corners[k].iter().enumerate() {
                    placed[k][axis].0[i] = flat[axis].0[corner % 16];
                }
            }
        }
        let mut bits = 0;
        for group in 0..16 / S::f32s::LEN {
            let [[ax, ay], [bx, by], [cx, cy]] = &placed;
            let a = [ax.get(simd, group), ay.get(simd, group)];
            let b = [bx.get(simd, group), by.get(simd, group)];
            let c = [cx.get(simd, group), cy.get(simd, group)];
            let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
            let zero = Wide::new(simd, 0.0);
            let above = u.ge(zero) & v.ge(zero) & w.ge(zero);
            let below = u.le(zero) & v.le(zero) & w.le(zero);
            let on_edge = u.eq(zero) | v.eq(zero) | w.eq(zero);
            bits |= (above | below | on_edge).0.to_bitmask() << (group * S::f32s::LEN);
        }
        bits
    }
}

impl TriangleTest for Watertight {
    const HAS_BUNDLES: bool = true;

    #[inline]
    fn new(ray: &Ray) -> Self {
        let along = Axis::of_largest(ray.dir);
        let [dx, dy, dz] = along.last(ray.dir.to_array());
        Self {
            ray: *ray,
            along,
            origin: along.last(ray.origin.to_array()),
            shear: [dx / dz, dy / dz],
        }
    }

    #[inline]
    fn intersect(&self, slabs: &RaySlabs, corners: &[Vec3; 3]) -> Option<TriangleHit> {
        self.inside(corners)
            .then(|| self.locate(Self::interval(slabs, corners), corners))
            .flatten()
    }

    #[inline(always)]
    fn intersect_block<S: Simd>(
        &self,
        simd: S,
        slabs: &RaySlabs,
        corners: &Corners8,
        visitor: &mut impl Visitor,
    ) -> bool {
        let [certain, on_edge] = self.inside_block(simd, corners);
        let mut mask = certain | on_edge;
        while mask != 0 {
            let lane = take_lowest(&mut mask);
            let triangle = corners_of(corners, lane);
            // A hit is clipped to these, so what they say needs no look at the hit.
            let (near, far) = Self::interval(slabs, &triangle);
            let interest = if near <= far && far > 0.0 {
                visitor.expects(near, far)
            } else {
                Interest::None
            };
            if interest == Interest::None || (on_edge >> lane) & 1 != 0 && !self.inside(&triangle) {
                continue;
            }
            if interest == Interest::Enough {
                return true;
            }
            if let Some(hit) = self.locate((near, far), &triangle)
                && visitor.visit(lane, hit)
            {
                return true;
            }
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hit(origin: Vec3, dir: Vec3, corners: [Vec3; 3]) -> Option<TriangleHit> {
        let ray = Ray { origin, dir };
        let slabs = RaySlabs::new(&ray, 10.0);
        Watertight::new(&ray).intersect(&slabs, &corners)
    }

    const TRIANGLE: [Vec3; 3] = [Vec3::ZERO, Vec3::X, Vec3::Y];

    #[test]
    fn reports_distance_and_weights_on_both_sides() {
        for side in [1.0, -1.0] {
            let at = hit(Vec3::new(0.25, 0.5, 2.0 * side), Vec3::Z * -side, TRIANGLE);
            let expected = TriangleHit {
                t: 2.0,
                u: 0.25,
                v: 0.5,
            };
            assert_eq!(at, Some(expected));
        }
        assert_eq!(hit(Vec3::new(0.25, 0.5, 2.0), Vec3::Z, TRIANGLE), None);
        assert_eq!(hit(Vec3::new(0.25, 0.5, 0.0), Vec3::Z, TRIANGLE), None);
        assert_eq!(hit(Vec3::new(0.7, 0.7, 2.0), -Vec3::Z, TRIANGLE), None);
    }

    #[test]
    fn edges_and_corners_belong_to_the_triangle() {
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.5, 0.5), (0.5, 0.0)] {
            let at = hit(Vec3::new(x, y, 1.0), -Vec3::Z, TRIANGLE);
            assert_eq!(at.map(|h| [h.t, h.u, h.v]), Some([1.0, x, y]));
        }
    }

    #[test]
    fn a_ray_in_the_plane_and_triangles_without_area_are_missed() {
        let into_the_edge = Vec3::new(1.0, 0.5, 0.0).normalize_or_zero();
        assert_eq!(hit(Vec3::new(-1.0, 0.25, 0.0), Vec3::X, TRIANGLE), None);
        assert_eq!(
            hit(Vec3::new(-1.0, 0.0, 0.0), into_the_edge, TRIANGLE),
            None
        );
        assert_eq!(hit(-Vec3::Z, Vec3::Z, [Vec3::ZERO; 3]), None);
        assert_eq!(
            hit(-Vec3::Z, Vec3::Z, [Vec3::ZERO, Vec3::X, Vec3::X * 2.0]),
            None
        );
    }

    #[test]
    fn edge_functions_that_underflow_are_decided_in_f64() {
        // Products of these lengths are below the smallest f32.
        let corners = TRIANGLE.map(|c| c * 1e-25);
        let from = |x: f32, y: f32| hit(Vec3::new(x, y, 1.0) * 1e-25, -Vec3::Z, corners);
        assert!(from(0.25, 0.25).is_some_and(|h| (h.u - 0.25).abs() < 1e-6));
        assert_eq!(from(0.7, 0.7), None);
        assert_eq!(from(-0.1, 0.3), None);
    }
}
