//! From a compact hit to the full surface record.

use glam::Vec2;

use super::{Facet, FacetKind, SurfaceInteraction};
use crate::geometry::{Hit, Ray, TriangleMesh};
use crate::math::{Real, V2, V3, gamma};

/// A surface seen at a smaller cosine counts as seen at this one: cones are not longer than a thousand widths.
const MIN_COS: f32 = 1e-3;

/// How much of the record a material needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum SurfaceParts {
    /// Point and normals.
    Plain,
    /// Texture coordinates, too.
    Uv,
    /// Their gradients, too.
    Gradients,
}

/// The surface at `hit`, see [`surface_on`].
///
/// What `parts` leaves out is zero. `parts` beyond [`SurfaceParts::Plain`] need texture coordinates.
#[must_use]
pub fn surface_at(
    mesh: &TriangleMesh,
    hit: &Hit,
    ray: &Ray,
    parts: SurfaceParts,
) -> SurfaceInteraction {
    let smooth = mesh.attributes[hit.prim as usize].smooth;
    let kind = FacetKind { smooth, parts };
    let facet = Facet::fetch(mesh, hit.prim, kind);
    surface_on(&facet, (hit.u, hit.v), V3::from(-ray.dir), kind)
}

/// The surface at barycentrics `(u, v)`: attributes weighed (report 2.19–2.25 corrected: `u` weighs the
/// second vertex, `v` the third, the rest the first), normals oriented to the front.
///
/// The front is the side that vertex normals point to, or the counter-clockwise side of a flat triangle.
/// `wo` is the unit direction to the eye.
#[inline(always)]
#[must_use]
pub fn surface_on<F: Real>(
    facet: &Facet<F>,
    (b1, b2): (F, F),
    wo: V3<F>,
    kind: FacetKind,
) -> SurfaceInteraction<F> {
    let (zero, one) = (b1.splat(0.0), b1.splat(1.0));
    let b0 = one - b1 - b2;
    let [p0, p1, p2] = facet.p;
    let (q0, q1, q2) = (p0 * b0, p1 * b1, p2 * b2);
    let has_plane = facet.n_winding.dot(facet.n_winding).gt(zero);
    let n_winding = V3::select(has_plane, facet.n_winding, wo);
    let mut s = SurfaceInteraction {
        p: q0 + q1 + q2,
        // Bound of three products and two sums, one weight itself rounded twice: PBRT 4th ed., §6.8.5.
        p_error: (q0.abs() + q1.abs() + q2.abs()) * one.splat(gamma(7)),
        n_geo: n_winding,
        n_shade: n_winding,
        n_smooth: n_winding,
        wo,
        uv: V2::new(zero, zero),
        grad_u: facet.grad_u,
        grad_v: facet.grad_v,
        dp_du: facet.dp_du,
        handedness: facet.handedness,
        footprint: zero,
        sunk: zero,
        steps: zero,
    };
    if kind.smooth {
        let [n0, n1, n2] = facet.n;
        s.n_shade = (n0 * b0 + n1 * b1 + n2 * b2).normalize_or(n_winding);
        let on_back = s.n_shade.dot(n_winding).lt(zero);
        s.n_geo = V3::select(on_back, -n_winding, n_winding);
        s.handedness = F::select(on_back, -s.handedness, s.handedness);
    }
    s.n_smooth = s.n_shade;
    if kind.parts >= SurfaceParts::Uv {
        let [t0, t1, t2] = facet.uv;
        s.uv = t0 * b0 + t1 * b1 + t2 * b2;
    }
    if kind.parts == SurfaceParts::Gradients {
        // Projected on the plane of the smooth normal.
        let n = s.n_shade;
        s.grad_u = s.grad_u - n * n.dot(s.grad_u);
        s.grad_v = s.grad_v - n * n.dot(s.grad_v);
    }
    s
}

/// Side of the square of texture coordinates that a cone of this width (internal units) covers around a point:
/// the width seen at a slant, times the square root of the chart's area per area.
///
/// Source: Akenine-Möller et al. 2019, "Texture Level of Detail Strategies for Real-Time Ray Tracing".
#[inline(always)]
#[must_use]
pub fn footprint<F: Real>(width: F, s: &SurfaceInteraction<F>) -> F {
    let cos = s.wo.dot(s.n_geo).abs().larger(width.splat(MIN_COS));
    let area = s.grad_u.cross(s.grad_v).length();
    let side = width * area.sqrt() / cos;
    F::select(side.is_finite(), side, width.splat(0.0))
}

/// Texture coordinate of a hit, for cut-out decisions that need nothing else.
#[must_use]
pub fn uv_at(mesh: &TriangleMesh, prim: u32, u: f32, v: f32) -> Vec2 {
    let [t0, t1, t2] = mesh.indices[prim as usize].map(|i| mesh.uvs[i as usize]);
    t0 * (1.0 - u - v) + t1 * u + t2 * v
}
