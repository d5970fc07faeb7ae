//! A displaced triangle whose displacement normal is constant: the exact walk between its three sides.

use glam::{DVec3, Vec3};

use super::trace::SurfaceHit;
use super::{Displacement, Reliefs};
use crate::geometry::{Ray, TriangleMesh};
use crate::surface::mapping::relief::{ReliefField, ReliefRay, Side};

/// Share of a triangle's width by which it reaches over its edges, so that no ray slips between neighbours.
/// A thousandth of what a float can tell.
const OVERLAP: f64 = 1e-10;

/// More than what a dozen operations in doubles round by, as a share of the largest number among them.
const ROUNDING: f64 = 1e-14;

/// One relief over a flat chart, with the axes of its own: weights of the second and third corner, and the
/// displacement along the normal.
#[derive(Debug, Clone, Copy)]
pub struct FlatPrism<'a, 'm> {
    pub field: &'a ReliefField<'m>,
    prim: u32,
    origin: DVec3,
    /// First edges and normal.
    axes: [DVec3; 3],
    /// Rows of the inverse of the axes.
    rows: [DVec3; 3],
    /// Place of the first corner in texels, and the change of it by both weights.
    texels: [[f64; 2]; 3],
    /// Which side of the triangle's own winding the normal is on.
    front: f64,
}

impl<'a, 'm> FlatPrism<'a, 'm> {
    /// `None` for a triangle without a relief.
    #[inline]
    pub fn new(
        mesh: &TriangleMesh,
        reliefs: &Reliefs<'a, 'm>,
        displacement: &Displacement,
        prim: u32,
    ) -> Option<Self> {
        let material = usize::from(mesh.attributes[prim as usize].material);
        let field = reliefs.fields.get(material)?.as_ref()?;
        let vertices = mesh.indices[prim as usize];
        let [p0, p1, p2] = mesh.corners(prim).map(|p| p.as_dvec3());
        let n = displacement.normals[vertices[0] as usize].as_dvec3();
        let (e1, e2) = (p1 - p0, p2 - p0);
        let area = e1.cross(e2);
        let det = area.dot(n);
        let rows = [e2.cross(n) / det, n.cross(e1) / det, area / det];
        let [t0, t1, t2] =
            vertices.map(|i| field.texels_from_uv(mesh.uvs[i as usize].to_array().map(f64::from)));
        Some(Self {
            field,
            prim,
            origin: p0,
            axes: [e1, e2, n],
            rows,
            texels: [
                t0,
                [t1[0] - t0[0], t1[1] - t0[1]],
                [t2[0] - t0[0], t2[1] - t0[1]],
            ],
            front: det.signum(),
        })
    }

    /// Place in texels at weights of the second and third corner.
    #[inline(always)]
    fn texels(&self, b1: f64, b2: f64) -> [f64; 2] {
        let [t0, t1, t2] = self.texels;
        [0, 1].map(|k| t0[k] + t1[k] * b1 + t2[k] * b2)
    }

    /// The part of the ray between the triangle's sides and between the extremes of the relief, before
    /// `t_max`, and the distance at which it begins.
    #[inline]
    pub fn clip(&self, ray: &Ray, t_max: f64) -> Option<(ReliefRay, f64)> {
        let o = ray.origin.as_dvec3() - self.origin;
        let d = ray.dir.as_dvec3();
        let [b1, b2, z] = self.rows.map(|row| row.dot(o));
        let [r1, r2, rz] = self.rows.map(|row| row.dot(d));
        let [low, high] = self.field.range();
        // And more than the displacement of a place is rounded by: a relief without any would be passed.
        let rounding = self.rows[2].abs().dot(o.abs()) * ROUNDING;
        let margin = (high - low) * 1e-6 + (high.abs() + low.abs()) * 1e-12 + rounding;
        let inside = [
            (b1 + OVERLAP, r1),
            (b2 + OVERLAP, r2),
            (1.0 + OVERLAP - b1 - b2, -r1 - r2),
            (high + margin - z, -rz),
            (z - low + margin, rz),
        ];
        let (mut from, mut to) = (0.0_f64, t_max);
        for (value, rate) in inside {
            let at = -value / rate;
            if rate > 0.0 {
                from = from.max(at);
            } else if rate < 0.0 {
                to = to.min(at);
            } else if !(value >= 0.0) {
                return None;
            }
        }
        if !(from <= to && to < f64::INFINITY) {
            return None;
        }
        let z = z + rz * from;
        let start = self.texels(b1 + r1 * from, b2 + r2 * from);
        let above = z >= high || (z > low && z >= self.field.displacement(start));
        let [_, t1, t2] = self.texels;
        Some((
            ReliefRay {
                start,
                rate: [0, 1].map(|k| t1[k] * r1 + t2[k] * r2),
                z,
                z_rate: rz,
                end: to - from,
                side: if above { Side::Above } else { Side::Below },
            },
            from,
        ))
    }

    /// Everything about the point that the ray meets at distance `t`.
    pub fn hit(&self, ray: &Ray, t: f64) -> SurfaceHit {
        let way = ray.dir.as_dvec3() * t;
        let p = ray.origin.as_dvec3() + way;
        // What the walk and this rounded. Next to a plane through the origin floats tell more than that.
        let rounding = (ray.origin.as_dvec3().abs() + way.abs()) * ROUNDING;
        let o = p - self.origin;
        let (b1, b2) = (self.rows[0].dot(o), self.rows[1].dot(o));
        let [slope_x, slope_y] = self.field.slope(self.texels(b1, b2));
        let [_, t1, t2] = self.texels;
        let [e1, e2, n] = self.axes;
        let along1 = e1 + n * (slope_x * t1[0] + slope_y * t1[1]);
        let along2 = e2 + n * (slope_x * t2[0] + slope_y * t2[1]);
        let normal = along1.cross(along2).normalize_or(n) * self.front;
        let normal: Vec3 = normal.as_vec3();
        let p = p.as_vec3();
        SurfaceHit {
            t: t as f32,
            prim: self.prim,
            weights: [b1 as f32, b2 as f32],
            p,
            // And the point once more.
            bound: (p.abs() * f32::EPSILON + rounding.as_vec3()).dot(normal.abs()),
            normal,
        }
    }
}
