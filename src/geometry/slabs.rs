//! A ray prepared for box tests, with a margin that makes them agree with the triangle test.

use glam::{Vec3, Vec3A};

use super::Ray;

/// Relative widening of every box: `16·2⁻²⁴`, see [`RaySlabs`].
pub(super) const PADDING: f32 = 16.0 * (f32::EPSILON * 0.5);

/// Smallest magnitude of a direction component in box tests: `2⁻³²`.
///
/// Keeps the reciprocal finite, so that an axis-parallel ray never meets `0·∞`. The ray bends by less
/// than `2⁻³⁰` of the distance it can travel, a sixty-fourth of one rounding.
pub(super) const MIN_COMPONENT: f32 = 1.0 / 4_294_967_296.0;

/// The three slab tests of one ray: `t = plane·inv_dir − shift` on each axis.
///
/// The interval of a box is never too small. With `S = reach + max|O|`, the watertight test may accept
/// a ray that passes a triangle at up to `6uS` on an axis (three roundings of the translated, three of
/// the sheared corner; `u = 2⁻²⁴`), and the arithmetic here adds less than `4uS/|d|` to `t`. Boxes
/// are therefore widened by `16uS`, folded into `shift` at no cost per box. This contains the factor
/// `1 + 2γ₃` of Ize 2013 ("Robust BVH Ray Traversal", JCGT 2(2)), which knows only the second error,
/// and does the work of the rounded origins in §3.3 of Woop, Benthin and Wald 2013.
///
/// Every operation is monotone in the planes, also after rounding: a box inside another has an interval
/// inside the other's, bit for bit. [`Watertight`](super::triangle::Watertight) clips its hits to the
/// interval of the triangle's own box, so no box above a triangle can lose a hit that the triangle
/// test alone would report.
#[derive(Debug, Clone, Copy)]
pub struct RaySlabs {
    pub(super) inv_dir: Vec3A,
    near_shift: Vec3A,
    far_shift: Vec3A,
    /// Whether the ray runs towards smaller coordinates, so that it enters by the upper plane.
    pub(super) negative: [bool; 3],
}

impl RaySlabs {
    /// Prepares `ray` for boxes whose coordinates are all at most `reach` in magnitude.
    ///
    /// A `reach` that is too small loses watertightness; too large a one only makes boxes fatter, by
    /// a millionth of it. The intervals of a ray with NaN mean nothing.
    #[inline]
    #[must_use]
    pub fn new(ray: &Ray, reach: f32) -> Self {
        let padding = PADDING * (reach + ray.origin.abs().max_element());
        let components = ray.dir.to_array().map(|component| {
            if component.abs() < MIN_COMPONENT {
                MIN_COMPONENT.copysign(component)
            } else {
                component
            }
        });
        let inv_dir = Vec3A::ONE / Vec3A::from_array(components);
        let at_origin = Vec3A::from(ray.origin) * inv_dir;
        let margin = inv_dir.abs() * padding;
        Self {
            inv_dir,
            near_shift: at_origin + margin,
            far_shift: at_origin - margin,
            negative: components.map(|component| component < 0.0),
        }
    }

    /// `[near, far]` shift of each axis.
    #[inline(always)]
    pub(super) fn shifts(&self) -> [[f32; 2]; 3] {
        let (near, far) = (self.near_shift.to_array(), self.far_shift.to_array());
        // Not mapped by a closure, which would be a function of its own in a kernel.
        [[near[0], far[0]], [near[1], far[1]], [near[2], far[2]]]
    }

    /// Where the ray enters and leaves the widened box, as distances along it; may be negative.
    ///
    /// The box is missed where not `near <= far`. It must not be empty.
    #[inline]
    #[must_use]
    pub fn interval(&self, min: Vec3, max: Vec3) -> (f32, f32) {
        let (a, b) = (
            Vec3A::from(min) * self.inv_dir,
            Vec3A::from(max) * self.inv_dir,
        );
        let near = (a.min(b) - self.near_shift).max_element();
        let far = (a.max(b) - self.far_shift).min_element();
        (near, far)
    }
}

/// The larger number; `b` where `a` is NaN. Compiles to one instruction, unlike [`f32::max`].
#[inline(always)]
pub(super) fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller number; `b` where `a` is NaN.
#[inline(always)]
pub(super) fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slabs(origin: Vec3, dir: Vec3) -> RaySlabs {
        RaySlabs::new(&Ray { origin, dir }, 1.0)
    }

    #[test]
    fn axis_parallel_ray_in_a_face_of_the_box_hits_it() {
        for dir in [Vec3::X, -Vec3::X, Vec3::new(1.0, -0.0, 0.0)] {
            for y in [-1.0, 1.0] {
                let origin = Vec3::new(0.0, y, 0.0) - dir * 3.0;
                let (near, far) = slabs(origin, dir).interval(-Vec3::ONE, Vec3::ONE);
                assert!((near - 2.0).abs() < 1e-4 && (far - 4.0).abs() < 1e-4);
            }
        }
    }

    #[test]
    fn axis_parallel_ray_beside_the_box_misses_it() {
        let (near, far) =
            slabs(Vec3::new(-3.0, 1.001, 0.0), Vec3::X).interval(-Vec3::ONE, Vec3::ONE);
        assert!(near > far);
    }
}
