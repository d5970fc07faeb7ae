//! Textbook tests, kept to be measured against the watertight one. Both leak at edges.

use glam::Vec3;

use super::{TriangleHit, TriangleTest};
use crate::geometry::{Ray, RaySlabs};

/// The common test: solves for `t`, `u`, `v` by Cramer's rule, two-sided, without an epsilon.
///
/// Two triangles that share an edge take different differences, so rounding can put a ray outside of
/// both. Source: Möller and Trumbore 1997, "Fast, Minimum Storage Ray/Triangle Intersection".
#[derive(Debug, Clone, Copy)]
pub struct MollerTrumbore(Ray);

impl TriangleTest for MollerTrumbore {
    #[inline]
    fn new(ray: &Ray) -> Self {
        Self(*ray)
    }

    #[inline]
    fn intersect(&self, _slabs: &RaySlabs, &[a, b, c]: &[Vec3; 3]) -> Option<TriangleHit> {
        let Ray { origin, dir } = self.0;
        let (ab, ac) = (b - a, c - a);
        let p = dir.cross(ac);
        let inv_det = 1.0 / ab.dot(p);
        let from_a = origin - a;
        let u = from_a.dot(p) * inv_det;
        let q = from_a.cross(ab);
        let v = dir.dot(q) * inv_det;
        let t = ac.dot(q) * inv_det;
        let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
        (inside && t > 0.0 && t.is_finite()).then_some(TriangleHit { t, u, v })
    }
}

/// The report's test: meet the plane, then ask for each edge on which side the point lies.
///
/// Equations 2.4–2.8, with 2.8 corrected: printed as a repetition of 2.7, it must be
/// `D_P = N_edge · N`. `P_L` runs to a corner of the face, `N` is the face's own normal, and `N·D = 0`
/// is a miss. The point of 2.5 is rounded before the edges are asked, so neighbours disagree.
#[derive(Debug, Clone, Copy)]
pub struct ReportEdges(Ray);

impl TriangleTest for ReportEdges {
    #[inline]
    fn new(ray: &Ray) -> Self {
        Self(*ray)
    }

    #[inline]
    fn intersect(&self, _slabs: &RaySlabs, &[a, b, c]: &[Vec3; 3]) -> Option<TriangleHit> {
        let Ray { origin, dir } = self.0;
        let n = (b - a).cross(c - a);
        let t = n.dot(a - origin) / n.dot(dir);
        if !(t > 0.0 && t.is_finite()) {
            return None;
        }
        let p = origin + dir * t;
        let side = |from: Vec3, to: Vec3| (from - p).cross(to - p).dot(n);
        let [of_c, of_a, of_b] = [side(a, b), side(b, c), side(c, a)];
        let sum = (of_a + of_b) + of_c;
        let inside = of_a >= 0.0 && of_b >= 0.0 && of_c >= 0.0 && sum > 0.0;
        inside.then(|| TriangleHit {
            t,
            u: of_b / sum,
            v: of_c / sum,
        })
    }
}
