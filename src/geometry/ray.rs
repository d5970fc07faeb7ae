//! Rays, hits, and where a ray that leaves a surface starts.

use glam::Vec3;

use crate::math::{next_down, next_up};

/// A half line. `dir` has unit length, so `t` is a distance in internal units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Start.
    pub origin: Vec3,
    /// Unit direction.
    pub dir: Vec3,
}

impl Ray {
    /// The point at distance `t`.
    #[must_use]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.dir * t
    }
}

/// Compact record of a closest hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance along the unit direction, internal units.
    pub t: f32,
    /// Index of the triangle in [`TriangleMesh::indices`](super::TriangleMesh::indices).
    pub prim: u32,
    /// Index of a part of the primitive (a displaced micro-triangle); 0 for a plain triangle.
    pub sub: u32,
    /// Barycentric weight of the triangle's second vertex.
    pub u: f32,
    /// Barycentric weight of the triangle's third vertex. The first vertex has `1 − u − v`.
    pub v: f32,
}

/// How far a leaving ray starts from its surface.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum OriginRule {
    /// By the rounding bound of the hit point, then one float further on each axis.
    #[default]
    Bound,
    /// By a fixed distance along the geometric normal, as textbooks do (internal units).
    Fixed(f32),
}

/// Origin for a ray leaving `p` towards `dir`, clear of its own triangle.
///
/// Moves along `n_geo` by the rounding bound `p_error` (per axis, internal units), then one float
/// further. A fixed epsilon is too big on a small mesh and too small far from the origin. Never pass
/// a shading normal: it may point into the triangle.
///
/// Source: PBRT 4th ed., §6.8.6.
#[must_use]
pub fn offset_origin(p: Vec3, p_error: Vec3, n_geo: Vec3, dir: Vec3, rule: OriginRule) -> Vec3 {
    let outward = if dir.dot(n_geo) < 0.0 { -n_geo } else { n_geo };
    match rule {
        OriginRule::Bound => {
            let distance = n_geo.abs().dot(p_error);
            let moved = p + outward * distance;
            let step = |x: f32, side: f32| {
                if side > 0.0 {
                    next_up(x)
                } else if side < 0.0 {
                    next_down(x)
                } else {
                    x
                }
            };
            Vec3::new(
                step(moved.x, outward.x),
                step(moved.y, outward.y),
                step(moved.z, outward.z),
            )
        }
        OriginRule::Fixed(distance) => p + outward * distance,
    }
}
