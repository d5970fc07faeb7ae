//! A triangle in double precision: where a ray meets its plane, and the chart there.

use glam::{DVec2, DVec3};

use crate::geometry::{Ray, TriangleMesh};

/// The surface where a ray meets a triangle; internal units, the normal on the front side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facet {
    /// Point on the triangle's plane.
    pub p: DVec3,
    /// Smooth unit normal.
    pub normal: DVec3,
    /// Unit normal of the triangle, on the same side.
    pub n_geo: DVec3,
    /// Texture coordinate, v up.
    pub uv: DVec2,
    /// Surface gradients of u and v across the smooth normal, per internal unit.
    pub gradients: [DVec3; 2],
    /// Unit direction to the eye.
    pub wo: DVec3,
}

impl Facet {
    /// Where the ray meets the plane of triangle `prim`, which must have texture coordinates. `None` for a
    /// triangle without area or a ray in its plane.
    #[must_use]
    pub fn on(mesh: &TriangleMesh, prim: u32, ray: &Ray) -> Option<Self> {
        let corners = mesh.indices[prim as usize].map(|i| i as usize);
        let [p0, p1, p2] = corners.map(|i| mesh.positions[i].as_dvec3());
        let [t0, t1, t2] = corners.map(|i| mesh.uvs[i].as_dvec2());
        let (origin, dir) = (ray.origin.as_dvec3(), ray.dir.as_dvec3().try_normalize()?);
        let (e1, e2) = (p1 - p0, p2 - p0);
        let area = e1.cross(e2);
        let winding = area.try_normalize()?;
        let t = (p0 - origin).dot(winding) / dir.dot(winding);
        let p = origin + dir * t;
        let part = |a: DVec3, b: DVec3| a.cross(b).dot(winding) / area.dot(winding);
        let (b1, b2) = (part(p - p0, e2), part(e1, p - p0));
        let mut normal = winding;
        if mesh.attributes[prim as usize].smooth {
            let [n0, n1, n2] = corners.map(|i| mesh.normals[i].as_dvec3());
            normal = (n0 * (1.0 - b1 - b2) + n1 * b1 + n2 * b2).normalize_or(winding);
        }
        let side = if normal.dot(winding) < 0.0 { -1.0 } else { 1.0 };
        let gradient = |d1: f64, d2: f64| {
            let g = (e2.cross(winding) * d1 + winding.cross(e1) * d2) / area.dot(winding);
            g - normal * normal.dot(g)
        };
        let (d1, d2) = (t1 - t0, t2 - t0);
        let facet = Self {
            p,
            normal,
            n_geo: winding * side,
            uv: t0 + d1 * b1 + d2 * b2,
            gradients: [gradient(d1.x, d2.x), gradient(d1.y, d2.y)],
            wo: -dir,
        };
        (facet.p.is_finite() && facet.uv.is_finite()).then_some(facet)
    }

    /// Cosine between the smooth normal and the view.
    #[must_use]
    pub fn cos(&self) -> f64 {
        self.wo.dot(self.normal)
    }
}
