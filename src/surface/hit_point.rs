//! From a compact hit to the full surface record.

use glam::{Vec2, Vec3};

use super::SurfaceInteraction;
use crate::geometry::{Hit, Ray, TriangleMesh};
use crate::math::{gamma, normalize_or};

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

/// The surface at `hit`: attributes by barycentrics (report 2.19–2.25 corrected: `u` weighs the second
/// vertex, `v` the third, the rest the first), normals oriented to the front.
///
/// The front is the side that vertex normals point to, or the counter-clockwise side of a flat triangle.
/// What `parts` leaves out is zero. `parts` beyond [`SurfaceParts::Plain`] need texture coordinates.
#[must_use]
pub fn surface_at(
    mesh: &TriangleMesh,
    hit: &Hit,
    ray: &Ray,
    parts: SurfaceParts,
) -> SurfaceInteraction {
    let corners = mesh.indices[hit.prim as usize];
    let [p0, p1, p2] = corners.map(|i| mesh.positions[i as usize]);
    let (b1, b2) = (hit.u, hit.v);
    let b0 = 1.0 - b1 - b2;
    let (e1, e2) = (p1 - p0, p2 - p0);
    let area_normal = e1.cross(e2);
    let n_winding = normalize_or(area_normal, -ray.dir);
    let mut s = SurfaceInteraction {
        p: p0 * b0 + p1 * b1 + p2 * b2,
        // Bound of three products and two sums, one weight itself rounded twice: PBRT 4th ed., §6.8.5.
        p_error: ((p0 * b0).abs() + (p1 * b1).abs() + (p2 * b2).abs()) * gamma(7),
        n_geo: n_winding,
        n_shade: n_winding,
        wo: -ray.dir,
        uv: Vec2::ZERO,
        grad_u: Vec3::ZERO,
        grad_v: Vec3::ZERO,
        dp_du: Vec3::ZERO,
        handedness: 0.0,
    };
    if mesh.attributes[hit.prim as usize].smooth {
        let [n0, n1, n2] = corners.map(|i| mesh.normals[i as usize]);
        s.n_shade = normalize_or(n0 * b0 + n1 * b1 + n2 * b2, n_winding);
        if s.n_shade.dot(n_winding) < 0.0 {
            s.n_geo = -n_winding;
        }
    }
    if parts >= SurfaceParts::Uv {
        let [t0, t1, t2] = corners.map(|i| mesh.uvs[i as usize]);
        s.uv = t0 * b0 + t1 * b1 + t2 * b2;
        if parts == SurfaceParts::Gradients {
            add_gradients(&mut s, [e1, e2], area_normal, [t1 - t0, t2 - t0]);
        }
    }
    s
}

/// Texture coordinate of a hit, for cut-out decisions that need nothing else.
#[must_use]
pub fn uv_at(mesh: &TriangleMesh, prim: u32, u: f32, v: f32) -> Vec2 {
    let [t0, t1, t2] = mesh.indices[prim as usize].map(|i| mesh.uvs[i as usize]);
    t0 * (1.0 - u - v) + t1 * u + t2 * v
}

/// `∇f = [(f₁−f₀)(e₂×N) + (f₂−f₀)(N×e₁)] / 2a`, projected on the plane of the smooth normal.
///
/// Never inverts the texture matrix: a chart without area gives zero or collinear gradients.
fn add_gradients(
    s: &mut SurfaceInteraction,
    [e1, e2]: [Vec3; 2],
    area_normal: Vec3,
    [d1, d2]: [Vec2; 2],
) {
    let area2 = area_normal.length_squared();
    if !(area2 > 0.0) {
        return;
    }
    // area_normal is 2a·N, so dividing by its square leaves N / 2a.
    let (toward1, toward2) = (e2.cross(area_normal) / area2, area_normal.cross(e1) / area2);
    let grad_u = toward1 * d1.x + toward2 * d2.x;
    let grad_v = toward1 * d1.y + toward2 * d2.y;
    if !(grad_u.is_finite() && grad_v.is_finite()) {
        return;
    }
    let turn = grad_u.cross(grad_v).dot(s.n_geo);
    if turn != 0.0 {
        s.handedness = 1.0_f32.copysign(turn);
        s.dp_du = grad_v.cross(s.n_geo) * s.handedness;
    }
    let n = s.n_shade;
    s.grad_u = grad_u - n * n.dot(grad_u);
    s.grad_v = grad_v - n * n.dot(grad_v);
}
