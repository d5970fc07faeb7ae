//! The full record of a surface point.

use crate::math::{V2, V3};

/// A hit point with what its material needs, in internal units; with vector lanes, one for each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceInteraction<F = f32> {
    /// The point, from barycentrics.
    pub p: V3<F>,
    /// Bound on the rounding of `p`, per axis.
    pub p_error: V3<F>,
    /// The triangle's unit normal, on the side of the smooth normal (the front).
    pub n_geo: V3<F>,
    /// Unit shading normal on the front side: interpolated, then perturbed by the mapping.
    pub n_shade: V3<F>,
    /// The smooth normal before any map tilts it, on the front side.
    pub n_smooth: V3<F>,
    /// Unit direction to the eye.
    pub wo: V3<F>,
    /// Texture coordinate, v up; moved by parallax methods.
    pub uv: V2<F>,
    /// Surface gradient of u, perpendicular to the smooth normal: texture units per internal unit.
    pub grad_u: V3<F>,
    /// Surface gradient of v.
    pub grad_v: V3<F>,
    /// Direction of growing u on the triangle (derivative of position by u up to a positive factor).
    pub dp_du: V3<F>,
    /// `+1`, or `−1` where the texture is mirrored, or 0 where it has no area.
    pub handedness: F,
    /// Side of the square that the ray's cone covers, in units of texture coordinates; 0 where maps are read at
    /// points.
    pub footprint: F,
    /// How far the place that a search found lies under the triangle's plane, along `n_geo`; negative over
    /// it, 0 without a search. `p` is that place.
    pub sunk: F,
    /// Samples or nodes that the search took.
    pub steps: F,
}
