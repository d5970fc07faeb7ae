//! The full record of a surface point.

use glam::{Vec2, Vec3};

/// A hit point with what its material needs, in internal units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceInteraction {
    /// The point, from barycentrics.
    pub p: Vec3,
    /// Bound on the rounding of `p`, per axis.
    pub p_error: Vec3,
    /// The triangle's unit normal, on the side of the smooth normal (the front).
    pub n_geo: Vec3,
    /// Unit shading normal on the front side: interpolated, then perturbed by the mapping.
    pub n_shade: Vec3,
    /// Unit direction to the eye.
    pub wo: Vec3,
    /// Texture coordinate, v up; moved by parallax methods.
    pub uv: Vec2,
    /// Surface gradient of u, perpendicular to the smooth normal: texture units per internal unit.
    pub grad_u: Vec3,
    /// Surface gradient of v.
    pub grad_v: Vec3,
    /// Direction of growing u on the triangle (derivative of position by u up to a positive factor).
    pub dp_du: Vec3,
    /// `+1`, or `−1` where the texture is mirrored, or 0 where it has no area.
    pub handedness: f32,
}
