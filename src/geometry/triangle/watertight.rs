//! The watertight test of Woop, Benthin and Wald.

use glam::Vec3;

use super::{Corners8, LANES, TriangleHit, TriangleTest};
use crate::geometry::slabs::{larger, smaller};
use crate::geometry::{Ray, RaySlabs};
use crate::math::gamma;

/// A coordinate axis. An enum rather than a number, so that indexing needs no bounds check.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Axis {
    X,
    Y,
    Z,
}

/// Watertight test: a ray through a closed mesh cannot slip between two triangles.
///
/// The corners are translated to the ray's origin and sheared so that the ray becomes an axis; three 2D
/// edge functions then say on which side of each edge it passes. Two triangles that share an edge compute
/// the same number with opposite signs, because rounding is symmetric and monotone (and
/// a fused multiply-add would break just that). Where one is exactly 0, all are computed again in
/// `f64`, where the products of `f32` are exact.
///
/// Two additions to the paper. The hit is clipped to the interval of the triangle's own box
/// ([`RaySlabs`]): a no-op for well-shaped triangles, it keeps the `t` of a needle seen edge-on, whose
/// weights are mostly rounding, near the triangle, and makes any hierarchy agree with testing every
/// triangle, bit for bit. And where the ray starts inside that box, `t` must exceed its own
/// rounding bound, without which a ray leaving a large triangle could hit it again.
///
/// Accuracy of `t`: `16ε(|O| + |tD|)` up to 85° incidence, held by `numerics::distance_error_is_bounded`.
///
/// Sources: Woop, Benthin and Wald 2013, "Watertight Ray/Triangle Intersection", JCGT 2(1);
/// bound on `t`: PBRT 4th ed., §6.8.7.
#[derive(Debug, Clone, Copy)]
pub struct Watertight {
    origin: [f32; 3],
    /// The two axes of the 2D test, then the axis of the largest direction component.
    axes: [Axis; 3],
    /// `(d_x / d_z, d_y / d_z, 1 / d_z)` on those axes.
    shear: [f32; 3],
}

/// Corners in ray space: `x` and `y` sheared, `z` translated but not scaled.
struct RaySpace {
    x: [f32; 3],
    y: [f32; 3],
    z: [f32; 3],
}

/// Weights of the three corners, and the one reciprocal needed for the bound on `t`.
struct Weights {
    b: [f32; 3],
    inv_det: f32,
    largest_edge: f32,
}

impl Watertight {
    /// Translates and shears. `get(vertex, axis)` reads a coordinate.
    #[inline(always)]
    fn ray_space(&self, get: impl Fn(usize, Axis) -> f32) -> RaySpace {
        let [kx, ky, kz] = self.axes;
        let mut corners = RaySpace {
            x: [0.0; 3],
            y: [0.0; 3],
            z: [0.0; 3],
        };
        for vertex in 0..3 {
            let z = get(vertex, kz) - self.origin[kz as usize];
            corners.x[vertex] = (get(vertex, kx) - self.origin[kx as usize]) - self.shear[0] * z;
            corners.y[vertex] = (get(vertex, ky) - self.origin[ky as usize]) - self.shear[1] * z;
            corners.z[vertex] = z;
        }
        corners
    }
}

/// Twice the signed areas that the ray's axis spans with each edge; the edge opposite vertex `i` at `i`.
#[inline(always)]
fn edges([x, y]: [&[f32; 3]; 2]) -> [f32; 3] {
    [
        x[2] * y[1] - y[2] * x[1],
        x[0] * y[2] - y[0] * x[2],
        x[1] * y[0] - y[1] * x[0],
    ]
}

/// Whether no two numbers have opposite signs. Zero has either; NaN is rejected.
#[inline(always)]
fn same_side([u, v, w]: [f32; 3]) -> bool {
    ((u >= 0.0) & (v >= 0.0) & (w >= 0.0)) | ((u <= 0.0) & (v <= 0.0) & (w <= 0.0))
}

/// Weights in `f32`; `None` where the triangle is seen exactly edge-on.
#[inline(always)]
fn weights(e: [f32; 3]) -> Option<Weights> {
    let det = (e[0] + e[1]) + e[2];
    let inv_det = 1.0 / det;
    (det != 0.0).then(|| Weights {
        b: e.map(|e| e * inv_det),
        inv_det: inv_det.abs(),
        largest_edge: e[0].abs().max(e[1].abs()).max(e[2].abs()),
    })
}

/// Weights where an edge function is 0 in `f32`: signs are decided again, exactly.
#[cold]
fn weights_in_f64(corners: &RaySpace) -> Option<Weights> {
    let x = corners.x.map(f64::from);
    let y = corners.y.map(f64::from);
    let e = [
        x[2] * y[1] - y[2] * x[1],
        x[0] * y[2] - y[0] * x[2],
        x[1] * y[0] - y[1] * x[0],
    ];
    let inside = e.iter().all(|&e| e >= 0.0) || e.iter().all(|&e| e <= 0.0);
    let det = (e[0] + e[1]) + e[2];
    (inside && det != 0.0).then(|| Weights {
        b: e.map(|e| (e / det) as f32),
        inv_det: (1.0 / det).abs() as f32,
        largest_edge: e[0].abs().max(e[1].abs()).max(e[2].abs()) as f32,
    })
}

/// Bound on the rounding error of `t` (PBRT 4th ed., §6.8.7). `sz` is the magnitude of `1 / d_z`.
#[cold]
fn distance_error(corners: &RaySpace, weights: &Weights, sz: f32) -> f32 {
    let largest = |c: &[f32; 3]| c[0].abs().max(c[1].abs()).max(c[2].abs());
    let (max_x, max_y) = (largest(&corners.x), largest(&corners.y));
    let max_z = largest(&corners.z) * sz;
    let delta_x = gamma(5) * (max_x + max_z);
    let delta_y = gamma(5) * (max_y + max_z);
    let delta_z = gamma(3) * max_z;
    let delta_e = 2.0 * (gamma(2) * max_x * max_y + delta_y * max_x + delta_x * max_y);
    let max_e = weights.largest_edge;
    3.0 * (gamma(3) * max_e * max_z + delta_e * max_z + delta_z * max_e) * weights.inv_det
}

impl TriangleTest for Watertight {
    #[inline]
    fn new(ray: &Ray) -> Self {
        let dir = ray.dir.to_array();
        let [x, y, z] = dir.map(f32::abs);
        let axes = if x > y && x > z {
            [Axis::Y, Axis::Z, Axis::X]
        } else if y > z {
            [Axis::Z, Axis::X, Axis::Y]
        } else {
            [Axis::X, Axis::Y, Axis::Z]
        };
        let [kx, ky, kz] = axes.map(|axis| dir[axis as usize]);
        Self {
            origin: ray.origin.to_array(),
            axes,
            shear: [kx / kz, ky / kz, 1.0 / kz],
        }
    }

    #[inline]
    fn intersect(&self, slabs: &RaySlabs, corners: &[Vec3; 3]) -> Option<TriangleHit> {
        let arrays = corners.map(|c| c.to_array());
        let space = self.ray_space(|vertex, axis| arrays[vertex][axis as usize]);
        let e = edges([&space.x, &space.y]);
        if !same_side(e) {
            return None;
        }
        let weights = if e[0] == 0.0 || e[1] == 0.0 || e[2] == 0.0 {
            weights_in_f64(&space)?
        } else {
            weights(e)?
        };
        let (b, z, sz) = (weights.b, space.z, self.shear[2]);
        let t = ((b[0] * z[0] + b[1] * z[1]) + b[2] * z[2]) * sz;

        let [p0, p1, p2] = *corners;
        let (near, far) = slabs.interval(p0.min(p1).min(p2), p0.max(p1).max(p2));
        let clipped = smaller(larger(t, near), far);
        let lost_in_rounding = near <= 0.0 && clipped <= distance_error(&space, &weights, sz.abs());
        let hit = t.is_finite() && near <= far && clipped > 0.0 && !lost_in_rounding;
        hit.then_some(TriangleHit {
            t: clipped,
            u: b[1],
            v: b[2],
        })
    }

    #[inline]
    fn candidates(&self, corners: &Corners8) -> u32 {
        let mut inside = [false; LANES];
        for (lane, inside) in inside.iter_mut().enumerate() {
            let space = self.ray_space(|vertex, axis| corners[vertex][axis as usize][lane]);
            *inside = same_side(edges([&space.x, &space.y]));
        }
        let mut mask = 0;
        for (lane, &inside) in inside.iter().enumerate() {
            mask |= u32::from(inside) << lane;
        }
        mask
    }
}
