//! A flat prism for kernels that hold many rays against it.

use super::flat::FlatPrism;
use crate::geometry::Ray;
use crate::math::rows::{MAX_LANES, Row, load};
use crate::math::simd::{Simd, SimdBase as _};

/// Rays for lanes to take on, and where they end.
pub struct RayRows {
    origin: [Row; 3],
    dir: [Row; 3],
    pub end: Row,
}

impl RayRows {
    /// Rays that end before they start.
    pub const NONE: Self = Self {
        origin: [[0.0; MAX_LANES]; 3],
        dir: [[0.0; MAX_LANES]; 3],
        end: [-1.0; MAX_LANES],
    };

    #[inline(always)]
    pub fn put(&mut self, lane: usize, ray: &Ray, end: f64) {
        for k in 0..3 {
            self.origin[k][lane] = f64::from(ray.origin[k]);
            self.dir[k][lane] = f64::from(ray.dir[k]);
        }
        self.end[lane] = end;
    }

    #[inline(always)]
    pub fn origin<S: Simd>(&self, simd: S) -> [S::f64s; 3] {
        let [x, y, z] = &self.origin;
        [load(simd, x), load(simd, y), load(simd, z)]
    }

    #[inline(always)]
    pub fn dir<S: Simd>(&self, simd: S) -> [S::f64s; 3] {
        let [x, y, z] = &self.dir;
        [load(simd, x), load(simd, y), load(simd, z)]
    }
}

/// The numbers of a prism, each in all lanes.
pub struct PrismLanes<'a, S: Simd> {
    pub prism: &'a FlatPrism<'a, 'a>,
    pub origin: [S::f64s; 3],
    pub along: [[S::f64s; 3]; 3],
    pub rows: [[S::f64s; 3]; 3],
    pub texels: [[S::f64s; 2]; 3],
}

impl<'a, S: Simd> PrismLanes<'a, S> {
    #[inline(always)]
    pub fn new(simd: S, prism: &'a FlatPrism<'a, 'a>) -> Self {
        let axes = &prism.axes;
        let zero = S::f64s::splat(simd, 0.0);
        let mut lanes = Self {
            prism,
            origin: [zero; 3],
            along: [[zero; 3]; 3],
            rows: [[zero; 3]; 3],
            texels: [[zero; 2]; 3],
        };
        for i in 0..3 {
            lanes.origin[i] = S::f64s::splat(simd, axes.origin[i]);
            for k in 0..3 {
                lanes.along[i][k] = S::f64s::splat(simd, axes.along[i][k]);
                lanes.rows[i][k] = S::f64s::splat(simd, axes.rows[i][k]);
            }
            for k in 0..2 {
                lanes.texels[i][k] = S::f64s::splat(simd, prism.texels[i][k]);
            }
        }
        lanes
    }

    /// The ways from the origin of the axes to places.
    #[inline(always)]
    pub fn way_to(&self, [x, y, z]: [S::f64s; 3]) -> [S::f64s; 3] {
        let [ox, oy, oz] = self.origin;
        [x - ox, y - oy, z - oz]
    }

    /// Places in texels at weights of the second and third corner.
    #[inline(always)]
    pub fn texels(&self, b1: S::f64s, b2: S::f64s) -> [S::f64s; 2] {
        let [t0, t1, t2] = self.texels;
        [
            t0[0] + t1[0] * b1 + t2[0] * b2,
            t0[1] + t1[1] * b1 + t2[1] * b2,
        ]
    }
}

/// In the order of additions of [`glam::DVec3::dot`].
#[inline(always)]
pub fn dot<S: Simd>([a, b, c]: [S::f64s; 3], [x, y, z]: [S::f64s; 3]) -> S::f64s {
    a * x + b * y + c * z
}

/// As [`glam::DVec3::cross`].
#[inline(always)]
pub fn cross<S: Simd>([a, b, c]: [S::f64s; 3], [x, y, z]: [S::f64s; 3]) -> [S::f64s; 3] {
    [b * z - y * c, c * x - z * a, a * y - x * b]
}
