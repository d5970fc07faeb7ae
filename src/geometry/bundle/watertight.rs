//! One triangle against all rays of a bundle.

use glam::Vec3;

use super::{Bundle, Floats, load3};
use crate::geometry::triangle::{edge, inside_in_f64, meet_plane, sheared};
use crate::math::simd::{Simd, SimdBase, SimdMask, SimdNarrow, SimdWiden, larger, smaller};

/// Rays of one group that meet a triangle, and where; other lanes hold anything.
pub(in crate::geometry) struct LaneHits<S: Simd> {
    pub(in crate::geometry) mask: S::mask32s,
    pub(in crate::geometry) t: S::f32s,
    pub(in crate::geometry) u: S::f32s,
    pub(in crate::geometry) v: S::f32s,
}

/// A triangle, copied to all lanes.
pub(in crate::geometry) struct TriangleLanes<S: Simd> {
    simd: S,
    corners: [Vec3; 3],
    /// Permuted, the dominant axis last.
    permuted: [[S::f32s; 3]; 3],
    /// What is still to be subtracted: the common origin was, before it was copied to all lanes.
    common_origin: bool,
}

impl<S: Simd> TriangleLanes<S> {
    /// Prepares a triangle for `rays`, whose common origin may be known.
    #[inline(always)]
    pub(in crate::geometry) fn new(
        simd: S,
        rays: &Bundle,
        common_origin: Option<[f32; 3]>,
        corners: [Vec3; 3],
    ) -> Self {
        let origin = Vec3::from_array(common_origin.unwrap_or_default());
        let permuted = corners.map(|corner| rays.along.last((corner - origin).to_array()));
        let splat = |x| S::f32s::splat(simd, x);
        Self {
            simd,
            corners,
            permuted: permuted.map(|[x, y, z]| [splat(x), splat(y), splat(z)]),
            common_origin: common_origin.is_some(),
        }
    }

    /// One corner, translated and sheared.
    #[inline(always)]
    fn shear(corner: [S::f32s; 3], origin: [S::f32s; 3], shear: [S::f32s; 2]) -> [S::f32s; 2] {
        let z = corner[2] - origin[2];
        [
            sheared(corner[0], origin[0], shear[0], z),
            sheared(corner[1], origin[1], shear[1], z),
        ]
    }

    /// The rays of a group that may pass inside, as bits, and those of them that do for certain.
    ///
    /// An edge function other than 0 has the sign of the exact one. So a ray that sees two of opposite
    /// signs is outside, and the scalar test, which would decide in `f64` if the third is 0, says so too.
    #[inline(always)]
    fn inside(&self, rays: &Bundle, group: usize) -> [u64; 2] {
        let simd = self.simd;
        let zero = S::f32s::splat(simd, 0.0);
        let origin = if self.common_origin {
            [zero; 3]
        } else {
            load3(simd, rays.along.last(rays.origin.each_ref()), group)
        };
        let shear = [
            rays.shear[0].load(simd, group),
            rays.shear[1].load(simd, group),
        ];
        let a = Self::shear(self.permuted[0], origin, shear);
        let b = Self::shear(self.permuted[1], origin, shear);
        let c = Self::shear(self.permuted[2], origin, shear);
        let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
        let (least, most) = (u.min(v).min(w), u.max(v).max(w));
        let maybe = (least.simd_ge(zero) | most.simd_le(zero)).to_bitmask();
        if maybe == 0 {
            return [0; 2];
        }
        let certain = least.simd_gt(zero) | most.simd_lt(zero);
        [maybe, certain.to_bitmask()]
    }

    /// The rays of a group that pass inside, on either side of their origin, as bits.
    #[inline(always)]
    pub(in crate::geometry) fn pass(&self, rays: &Bundle, group: usize, wanted: u64) -> u64 {
        let [maybe, certain] = self.inside(rays, group);
        let mut mask = maybe & wanted;
        let mut on_edge = mask & !certain;
        while on_edge != 0 {
            let lane = on_edge.trailing_zeros();
            on_edge &= on_edge - 1;
            let ray = group * S::f32s::LEN + lane as usize;
            if !self.inside_in_f64(rays, ray) {
                mask &= !(1 << lane);
            }
        }
        mask
    }

    /// The scalar test's decision where an edge function is 0.
    #[cold]
    #[inline(never)]
    fn inside_in_f64(&self, rays: &Bundle, ray: usize) -> bool {
        let of_ray = |floats: &Floats| floats.0[ray];
        let [ox, oy, oz] = rays.along.last(rays.origin.each_ref().map(of_ray));
        let [sx, sy] = rays.shear.each_ref().map(of_ray);
        inside_in_f64(self.corners.map(|corner| {
            let [x, y, z] = rays.along.last(corner.to_array());
            let z = z - oz;
            [sheared(x, ox, sx, z), sheared(y, oy, sy, z)]
        }))
    }

    /// Between which distances the rays in `mask` meet the triangle that they pass inside of; drops those that do not
    /// ahead.
    #[inline(always)]
    pub(in crate::geometry) fn reach(
        &self,
        rays: &Bundle,
        group: usize,
        mask: u64,
    ) -> ((S::f32s, S::f32s), S::mask32s) {
        let simd = self.simd;
        let (near, far) = self.interval(rays, group);
        let ahead = far.simd_gt(S::f32s::splat(simd, 0.0)) & near.simd_le(far);
        let mask = S::mask32s::from_bitmask(simd, mask);
        ((near, far), mask & ahead)
    }

    /// Where the rays in `mask` meet the triangle between two distances; drops those that do not ahead.
    #[inline(always)]
    pub(in crate::geometry) fn locate(
        &self,
        rays: &Bundle,
        group: usize,
        (near, far): (S::f32s, S::f32s),
        mask: S::mask32s,
    ) -> LaneHits<S> {
        let simd = self.simd;
        let splat = |x| S::f32s::splat(simd, x);
        let [t, u, v] = self.meet_plane(rays, group, mask.to_bitmask());
        let (zero, one) = (splat(0.0), splat(1.0));
        let t = smaller(larger(t, near), far);
        let u = smaller(larger(u, zero), one);
        let v = smaller(larger(v, zero), one - u);
        let mask = mask & t.simd_gt(zero);
        LaneHits { mask, t, u, v }
    }

    /// [`RaySlabs::interval`](crate::geometry::RaySlabs::interval) of the triangle's box.
    #[inline(always)]
    fn interval(&self, rays: &Bundle, group: usize) -> (S::f32s, S::f32s) {
        let simd = self.simd;
        let [p0, p1, p2] = self.corners;
        let (min, max) = (p0.min(p1).min(p2), p0.max(p1).max(p2));
        let mut near = S::f32s::splat(simd, f32::NEG_INFINITY);
        let mut far = S::f32s::splat(simd, f32::INFINITY);
        for axis in 0..3 {
            let inv = rays.inv_dir[axis].load(simd, group);
            let (a, b) = (inv * min[axis], inv * max[axis]);
            near = near.max(a.min(b) - rays.near_shift[axis].load(simd, group));
            far = far.min(a.max(b) - rays.far_shift[axis].load(simd, group));
        }
        (near, far)
    }

    /// `t`, `u`, `v` by the scalar test's own [`meet_plane`], rounded, for the rays in `mask`.
    #[inline(always)]
    fn meet_plane(&self, rays: &Bundle, group: usize, mask: u64) -> [S::f32s; 3] {
        let simd = self.simd;
        let splat = |x| S::f64s::splat(simd, x);
        let [a, b, c] = self.corners.map(|p| p.as_dvec3());
        let splat3 = |[x, y, z]: [f64; 3]| [splat(x), splat(y), splat(z)];
        let triangle = [a, b - a, c - a].map(|p| splat3(p.to_array()));
        let [ox, oy, oz] = load3(simd, rays.origin.each_ref(), group);
        let [dx, dy, dz] = load3(simd, rays.dir.each_ref(), group);
        let (ox, oy, oz) = (ox.widen(), oy.widen(), oz.widen());
        let (dx, dy, dz) = (dx.widen(), dy.widen(), dz.widen());
        let one = splat(1.0);
        let (mut low, mut high) = ([one; 3], [one; 3]);
        let half = S::f64s::LEN;
        if mask & ((1 << half) - 1) != 0 {
            low = meet_plane([ox.0, oy.0, oz.0], [dx.0, dy.0, dz.0], triangle, one);
        }
        if mask >> half != 0 {
            high = meet_plane([ox.1, oy.1, oz.1], [dx.1, dy.1, dz.1], triangle, one);
        }
        [
            low[0].narrow(high[0]),
            low[1].narrow(high[1]),
            low[2].narrow(high[2]),
        ]
    }
}
