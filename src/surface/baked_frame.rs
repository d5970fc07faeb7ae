//! The frame that bakers of normal maps interpolate over a triangle.

use super::SurfaceInteraction;
use crate::geometry::{Tangents, TriangleMesh};
use crate::math::{Bits, Real, V3};

/// Tangents and normals at the corners of a triangle; with vector lanes, one for each.
#[derive(Debug, Clone, Copy)]
pub struct BakedFrame<F = f32> {
    tangents: [V3<F>; 3],
    /// `None` where the triangle is flat: its normal is a unit vector everywhere.
    normals: Option<[V3<F>; 3]>,
    sign: F,
}

impl<F: Real> BakedFrame<F> {
    /// Reads triangles that are all smooth or all flat.
    #[inline(always)]
    #[must_use]
    pub fn fetch(
        (mesh, tangents): (&TriangleMesh, &Tangents),
        prims: F::Bits,
        smooth: bool,
    ) -> Self {
        let corner = |k: usize| {
            let fetch = |prim: u32| tangents.of(prim)[k].map(f32::to_bits);
            let [[x, y, z, sign]] = F::Bits::gather([prims], fetch);
            (
                V3::new(x.to_real(), y.to_real(), z.to_real()),
                sign.to_real(),
            )
        };
        let ((t0, sign), (t1, _), (t2, _)) = (corner(0), corner(1), corner(2));
        let normals = smooth.then(|| {
            let [corners] = F::Bits::gather([prims], |prim| mesh.indices[prim as usize]);
            let normal = |i: u32| mesh.normals[i as usize].to_array().map(f32::to_bits);
            let to_real = |[x, y, z]: [F::Bits; 3]| V3::new(x.to_real(), y.to_real(), z.to_real());
            let [a, b, c] = F::Bits::gather(corners, normal);
            [to_real(a), to_real(b), to_real(c)]
        });
        Self {
            tangents: [t0, t1, t2],
            normals,
            sign,
        }
    }

    /// Puts the frame at barycentrics `(b1, b2)` in place of the surface's own: `dp_du` becomes the
    /// interpolated tangent and `handedness` the sign of the bitangent, both over the length of the
    /// interpolated normal, which is not normalised either. 0 where there is no frame.
    ///
    /// `m_x t + m_y s (n × t) + m_z n` with `n`, `t` as interpolated is then, up to a factor that the last
    /// step takes off, `m_x dp_du + m_y handedness (N × dp_du) + m_z N` with the unit normal N.
    #[inline(always)]
    pub fn place(&self, (b1, b2): (F, F), s: &mut SurfaceInteraction<F>) {
        let one = b1.splat(1.0);
        let b0 = one - b1 - b2;
        let mean = |[a, b, c]: [V3<F>; 3]| a * b0 + b * b1 + c * b2;
        let length = self.normals.map_or(one, |normals| mean(normals).length());
        let tangent = mean(self.tangents) / length;
        let sign = self.sign * length;
        let zero = one.splat(0.0);
        let usable = tangent.is_finite() & tangent.dot(tangent).gt(zero) & sign.abs().gt(zero);
        s.dp_du = V3::select(usable, tangent, V3::new(zero, zero, zero));
        s.handedness = F::select(usable, sign, zero);
    }
}
