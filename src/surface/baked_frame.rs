//! The frame that bakers of normal maps interpolate over a triangle.

use super::SurfaceInteraction;
use super::facet::v3;
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
        let (t0, sign) = tangent(tangents, prims, 0);
        let ((t1, _), (t2, _)) = (tangent(tangents, prims, 1), tangent(tangents, prims, 2));
        let normals = if smooth {
            let [a, b, c] = prims.fetch(&mesh.indices);
            let at = &*mesh.normals;
            Some([v3(a.fetch(at)), v3(b.fetch(at)), v3(c.fetch(at))])
        } else {
            None
        };
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

/// The tangent at a corner, and the sign of the bitangent.
#[inline(always)]
fn tangent<F: Real>(tangents: &Tangents, prims: F::Bits, corner: u32) -> (V3<F>, F) {
    let [x, y, z, sign] = prims.times(3).plus(corner).fetch(tangents.corners());
    (v3([x, y, z]), sign.to_real())
}
