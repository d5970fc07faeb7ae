//! The watertight test as its paper's short form has it, in single precision alone, for comparison.

use glam::Vec3;

use super::{TriangleHit, TriangleTest};
use crate::geometry::{Ray, RaySlabs};

/// Woop's test without the second look in `f64` where an edge function is 0, and with `t` and the weights
/// from the sheared `f32` coordinates.
///
/// It leaks only where products of small coordinates vanish, but its distances lose `tan(incidence)` roundings.
/// Source: Woop, Benthin and Wald 2013, "Watertight Ray/Triangle Intersection", JCGT 2(1), §3.
#[derive(Debug, Clone, Copy)]
pub struct PlainWoop {
    origin: Vec3,
    /// The axes, that of the largest direction component last.
    axes: [usize; 3],
    /// `(d_x / d_z, d_y / d_z, 1 / d_z)` on those axes.
    shear: Vec3,
}

impl TriangleTest for PlainWoop {
    #[inline]
    fn new(ray: &Ray) -> Self {
        let z = ray.dir.abs().max_position();
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        let [dx, dy, dz] = axes.map(|axis| ray.dir[axis]);
        Self {
            origin: ray.origin,
            axes,
            shear: Vec3::new(dx / dz, dy / dz, 1.0 / dz),
        }
    }

    #[inline]
    fn intersect(&self, _slabs: &RaySlabs, corners: &[Vec3; 3]) -> Option<TriangleHit> {
        let [a, b, c] = corners.map(|corner| {
            let [x, y, z] = self.axes.map(|axis| corner[axis] - self.origin[axis]);
            let Vec3 {
                x: sx,
                y: sy,
                z: sz,
            } = self.shear;
            Vec3::new(x - sx * z, y - sy * z, sz * z)
        });
        let edge = |p: Vec3, q: Vec3| p.x * q.y - p.y * q.x;
        let [u, v, w] = [edge(c, b), edge(a, c), edge(b, a)];
        let below = u < 0.0 || v < 0.0 || w < 0.0;
        let above = u > 0.0 || v > 0.0 || w > 0.0;
        let sum = u + v + w;
        if below && above || sum == 0.0 {
            return None;
        }
        let t = (u * a.z + v * b.z + w * c.z) / sum;
        (t > 0.0 && t.is_finite()).then(|| TriangleHit {
            t,
            u: v / sum,
            v: w / sum,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meets_a_triangle_where_it_is() {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
        for side in [1.0, -1.0] {
            let ray = Ray {
                origin: Vec3::new(0.25, 0.5, 2.0 * side),
                dir: Vec3::Z * -side,
            };
            let hit = PlainWoop::new(&ray).intersect(&RaySlabs::new(&ray, 1.0), &corners);
            let expected = TriangleHit {
                t: 2.0,
                u: 0.25,
                v: 0.5,
            };
            assert_eq!(hit, Some(expected));
        }
    }
}
