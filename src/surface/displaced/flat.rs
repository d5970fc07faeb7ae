//! A displaced triangle, or a sheet of them, whose displacement normal is constant: the exact walk between its sides.

use glam::{DVec3, Vec3};

use super::charts::Shape;
use super::pieces::Piece;
use super::sheets::{Edge, PlanTriangle, Sheet, TRIANGLE};
use super::trace::SurfaceHit;
use super::{Displacement, Reliefs, texels_at};
use crate::geometry::{Ray, TriangleMesh};
use crate::surface::mapping::relief::{ReliefField, ReliefRay, Side};

/// Share of a chart's width by which it reaches over its edges, so that no ray slips between neighbours.
/// A thousandth of what a float can tell.
pub(super) const OVERLAP: f64 = 1e-10;

/// More than what a dozen operations in doubles round by, as a share of the largest number among them.
pub(super) const ROUNDING: f64 = 1e-14;

/// The axes of a flat chart: weights of the second and third of three corners, and the displacement along a normal that
/// need not be upright.
#[derive(Debug, Clone, Copy)]
pub struct Axes {
    pub(super) origin: DVec3,
    /// First edges and normal.
    pub(super) along: [DVec3; 3],
    /// Rows of the inverse of the axes.
    pub(super) rows: [DVec3; 3],
    /// Volume that the axes span; negative where the corners wind clockwise around the normal.
    pub(super) det: f64,
}

impl Axes {
    pub fn new([p0, p1, p2]: [DVec3; 3], normal: DVec3) -> Self {
        let (e1, e2, n) = (p1 - p0, p2 - p0, normal);
        let area = e1.cross(e2);
        let det = area.dot(n);
        Self {
            origin: p0,
            along: [e1, e2, n],
            rows: [e2.cross(n) / det, n.cross(e1) / det, area / det],
            det,
        }
    }

    /// Weights of the second and third corner, and the displacement.
    #[inline(always)]
    pub fn weights(&self, p: DVec3) -> [f64; 3] {
        self.rates(p - self.origin)
    }

    /// Their changes along a way.
    #[inline(always)]
    fn rates(&self, way: DVec3) -> [f64; 3] {
        self.rows.map(|row| row.dot(way))
    }

    /// What the displacement of a place is rounded by, at the most.
    fn rounding(&self, p: DVec3) -> f64 {
        self.rows[2].abs().dot((p - self.origin).abs()) * ROUNDING
    }

    /// Smallest height of the corners' triangle.
    pub fn height(&self) -> f64 {
        let [e1, e2, _] = self.along;
        let longest = e1.length().max(e2.length()).max((e2 - e1).length());
        e1.cross(e2).length() / longest
    }
}

/// The first of three places, and the change of it by the weights of the second and third.
pub fn by_weights([t0, t1, t2]: [[f64; 2]; 3]) -> [[f64; 2]; 3] {
    let way = |t: [f64; 2]| [t[0] - t0[0], t[1] - t0[1]];
    [t0, way(t1), way(t2)]
}

/// One relief over a flat chart: a triangle, or a sheet of many.
#[derive(Debug, Clone, Copy)]
pub struct FlatPrism<'a, 'm> {
    pub field: &'a ReliefField<'m>,
    /// A triangle: of many the one that was met last.
    prim: u32,
    /// All triangles, if there are more than that.
    sheet: Option<&'a Sheet>,
    /// Where the triangle of a sheet is that was met last.
    near: Option<PlanTriangle>,
    pub(super) sides: &'a [Edge],
    pub(super) axes: Axes,
    /// Place of the first corner in texels, and the change of it by both weights.
    pub(super) texels: [[f64; 2]; 3],
}

impl<'a, 'm> FlatPrism<'a, 'm> {
    /// `None` for a piece without a relief, and for one that is cut up.
    #[inline]
    pub fn new(
        mesh: &TriangleMesh,
        reliefs: &Reliefs<'a, 'm>,
        displacement: &'a Displacement,
        piece: u32,
    ) -> Option<Self> {
        let Piece { prim, shape, .. } = displacement.pieces[piece as usize];
        let material = usize::from(mesh.attributes[prim as usize].material);
        let field = reliefs.fields.get(material)?.as_ref()?;
        Some(match shape {
            Shape::Fine(_) => return None,
            Shape::Sheet(sheet) => {
                let sheet = &displacement.sheets[sheet as usize];
                Self {
                    field,
                    prim,
                    sheet: Some(sheet),
                    near: None,
                    sides: &sheet.sides,
                    axes: sheet.axes,
                    texels: sheet.texels,
                }
            }
            Shape::Flat => {
                let vertices = mesh.indices[prim as usize];
                let normal = displacement.normals[vertices[0] as usize].as_dvec3();
                Self {
                    field,
                    prim,
                    sheet: None,
                    near: None,
                    sides: &TRIANGLE,
                    axes: Axes::new(mesh.corners(prim).map(|p| p.as_dvec3()), normal),
                    texels: by_weights(vertices.map(|i| texels_at(mesh, field, i))),
                }
            }
        })
    }

    /// Place in texels at weights of the second and third corner.
    #[inline(always)]
    fn texels(&self, b1: f64, b2: f64) -> [f64; 2] {
        let [t0, t1, t2] = self.texels;
        [0, 1].map(|k| t0[k] + t1[k] * b1 + t2[k] * b2)
    }

    /// The material whose relief it is.
    pub fn material(&self, mesh: &TriangleMesh) -> u16 {
        mesh.attributes[self.prim as usize].material
    }

    /// The part of the ray between the sides and between the extremes of the relief, before `t_max`, and the distance
    /// at which it begins.
    #[inline]
    pub fn clip(&self, ray: &Ray, t_max: f64) -> Option<(ReliefRay, f64)> {
        let o = ray.origin.as_dvec3();
        let [b1, b2, z] = self.axes.weights(o);
        let [r1, r2, rz] = self.axes.rates(ray.dir.as_dvec3());
        let [low, high] = self.field.range();
        // And more than the displacement of a place is rounded by: a relief without any would be passed.
        let rounding = self.axes.rounding(o);
        let margin = (high - low) * 1e-6 + (high.abs() + low.abs()) * 1e-12 + rounding;
        let sides = self.sides.iter().map(|side| {
            let [x, y] = side.ways;
            (side.at + OVERLAP + x * b1 + y * b2, x * r1 + y * r2)
        });
        let ends = [(high + margin - z, -rz), (z - low + margin, rz)];
        let (mut from, mut to) = (0.0_f64, t_max);
        for (value, rate) in sides.chain(ends) {
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
        let start = self.texels(b1 + r1 * from, b2 + r2 * from);
        let [_, t1, t2] = self.texels;
        let rate = [0, 1].map(|k| t1[k] * r1 + t2[k] * r2);
        let z = z + rz * from;
        let above = z >= high || (z > low && z >= self.field.displacement(start));
        Some((
            ReliefRay {
                start,
                rate,
                z,
                z_rate: rz,
                end: to - from,
                side: if above { Side::Above } else { Side::Below },
            },
            from,
        ))
    }

    /// The point that the ray meets at distance `t`.
    pub fn point(&self, ray: &Ray, t: f64) -> FlatPoint {
        let way = ray.dir.as_dvec3() * t;
        let p = ray.origin.as_dvec3() + way;
        // What the walk and this rounded. Next to a plane through the origin floats tell more than that.
        let rounding = (ray.origin.as_dvec3().abs() + way.abs()) * ROUNDING;
        let [b1, b2, _] = self.axes.weights(p);
        let [slope_x, slope_y] = self.field.slope(self.texels(b1, b2));
        let [_, t1, t2] = self.texels;
        let [e1, e2, n] = self.axes.along;
        let along1 = e1 + n * (slope_x * t1[0] + slope_y * t1[1]);
        let along2 = e2 + n * (slope_x * t2[0] + slope_y * t2[1]);
        // Towards the side of the triangles' own winding that the normal is on.
        let normal = along1.cross(along2).normalize_or(n) * self.axes.det.signum();
        FlatPoint::new(p, rounding, normal, [b1, b2])
    }

    /// Everything about a point at distance `t`.
    pub fn hit(&mut self, mesh: &TriangleMesh, t: f64, point: FlatPoint) -> SurfaceHit {
        let weights = match self.sheet {
            None => point.place,
            Some(sheet) => {
                let near = self.near;
                let near = near.unwrap_or_else(|| sheet.triangle(mesh, self.prim));
                let (found, weights) = sheet.triangle_at(mesh, point.place, near);
                self.prim = found.prim();
                self.near = Some(found);
                weights
            }
        };
        SurfaceHit {
            t: t as f32,
            prim: self.prim,
            weights: weights.map(|w| w as f32),
            p: point.p,
            bound: point.bound,
            normal: point.normal,
        }
    }
}

/// A point on a flat relief.
#[derive(Debug, Clone, Copy)]
pub struct FlatPoint {
    p: Vec3,
    /// How far rounding may have taken it off the surface.
    bound: f32,
    normal: Vec3,
    /// Weights of the second and third corner of the prism's axes.
    place: [f64; 2],
}

impl FlatPoint {
    /// No point.
    pub const NONE: Self = Self {
        p: Vec3::ZERO,
        bound: 0.0,
        normal: Vec3::ZERO,
        place: [0.0; 2],
    };

    /// A point that is rounded by no more than this so far.
    #[inline(always)]
    pub fn new(p: DVec3, rounding: DVec3, normal: DVec3, place: [f64; 2]) -> Self {
        let (p, normal) = (p.as_vec3(), normal.as_vec3());
        Self {
            p,
            // And the point once more.
            bound: (p.abs() * f32::EPSILON + rounding.as_vec3()).dot(normal.abs()),
            normal,
            place,
        }
    }
}
