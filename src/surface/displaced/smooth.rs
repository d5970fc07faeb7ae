//! The displaced surface itself, in double precision and not cut up: what every method is measured against.

use glam::{DMat3, DVec2, DVec3};

use super::trace::{DisplacedMesh, SurfaceHit};
use crate::geometry::Ray;

/// Steps towards the surface; each squares the distance.
const STEPS: usize = 6;
/// Farther than so many texels from the micro-triangle it is another place that was found.
const FAR_TEXELS: f64 = 1.0;
/// Weights this far outside of the triangle are on its neighbour.
const BEYOND: f64 = 1e-3;

/// A point of the surface `S = p + d(uv)·n` of a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmoothPoint {
    /// The point, internal units.
    pub p: DVec3,
    /// Change of it by the weights of the second and third corner.
    pub along: [DVec3; 2],
    /// Texture coordinate, v up.
    pub uv: DVec2,
}

/// Where a ray meets the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmoothHit {
    /// The point.
    pub point: SmoothPoint,
    /// Unit normal, on the front side of the mesh.
    pub normal: DVec3,
    /// How far the point on the micro-triangle was from it, texels.
    pub moved_texels: f64,
    /// The last step towards it, texels: what it may still be off by.
    pub doubt_texels: f64,
}

impl DisplacedMesh<'_, '_> {
    /// The surface of a displaced triangle at weights of its second and third corner; heights at seams are the
    /// triangle's own. `None` if it has no relief.
    #[must_use]
    pub fn smooth_point(&self, prim: u32, [b1, b2]: [f64; 2]) -> Option<SmoothPoint> {
        let field = self.reliefs.on(self.mesh, prim)?;
        let vertices = self.mesh.indices[prim as usize].map(|i| i as usize);
        let [p0, p1, p2] = vertices.map(|i| self.mesh.positions[i].as_dvec3());
        let [n0, n1, n2] = vertices.map(|i| self.displacement.normals[i].as_dvec3());
        let [t0, t1, t2] = vertices.map(|i| self.mesh.uvs[i].as_dvec2());
        let (n, uv) = (
            n0 + (n1 - n0) * b1 + (n2 - n0) * b2,
            t0 + (t1 - t0) * b1 + (t2 - t0) * b2,
        );
        let place = field.texels_from_uv(uv.to_array());
        let d = field.displacement(place);
        let slope = DVec2::from(field.slope(place)) * DVec2::from(field.texels_per_uv());
        let along =
            |p: DVec3, n1: DVec3, t: DVec2| (p - p0) + (n1 - n0) * d + n * slope.dot(t - t0);
        Some(SmoothPoint {
            p: p0 + (p1 - p0) * b1 + (p2 - p0) * b2 + n * d,
            along: [along(p1, n1, t1), along(p2, n2, t2)],
            uv,
        })
    }

    /// Where a ray meets the surface near the point of it that was traced. `None` where it does not: beside seams,
    /// and where micro-triangles cut off an edge that the ray passes by.
    #[must_use]
    pub fn smooth_hit(&self, ray: &Ray, hit: &SurfaceHit) -> Option<SmoothHit> {
        let (origin, dir) = (ray.origin.as_dvec3(), ray.dir.as_dvec3());
        let traced = hit.weights.map(f64::from);
        let texels = |point: &SmoothPoint| {
            let field = self.reliefs.on(self.mesh, hit.prim);
            let uv = point.uv.to_array();
            DVec2::from(field.map_or([0.0; 2], |field| field.texels_from_uv(uv)))
        };
        let start = self.smooth_point(hit.prim, traced)?;
        let mut weights = traced;
        let mut t = f64::from(hit.t);
        let mut found = start;
        let mut last_step = 0.0;
        for _ in 0..STEPS {
            let gap = found.p - (origin + dir * t);
            let step = DMat3::from_cols(found.along[0], found.along[1], -dir).inverse() * gap;
            weights = [weights[0] - step.x, weights[1] - step.y];
            t -= step.z;
            let next = self.smooth_point(hit.prim, weights)?;
            last_step = texels(&next).distance(texels(&found));
            found = next;
        }
        let gap = found.p.distance(origin + dir * t);
        let moved_texels = texels(&found).distance(texels(&start));
        let inside = weights[0]
            .min(weights[1])
            .min(1.0 - weights[0] - weights[1])
            > -BEYOND;
        let met = gap < 1e-9 * (1.0 + found.p.length()) && moved_texels < FAR_TEXELS && inside;
        let traced_normal = hit.normal.as_dvec3();
        let normal = found.along[0]
            .cross(found.along[1])
            .normalize_or(traced_normal);
        met.then_some(SmoothHit {
            point: found,
            normal: normal * normal.dot(traced_normal).signum(),
            moved_texels,
            doubt_texels: last_step,
        })
    }
}
