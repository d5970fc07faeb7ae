//! What is the same at every point of a triangle.

use super::SurfaceParts;
use crate::geometry::TriangleMesh;
use crate::math::{Bits, Real, V2, V3};

/// A triangle made ready for the points on it; with vector lanes, one for each.
///
/// What its [`FacetKind`] leaves out is zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facet<F = f32> {
    /// Corners.
    pub p: [V3<F>; 3],
    /// Normals at the corners.
    pub n: [V3<F>; 3],
    /// Texture coordinates at the corners.
    pub uv: [V2<F>; 3],
    /// Unit normal on the counter-clockwise side; zero for a triangle without area.
    pub n_winding: V3<F>,
    /// Gradient of u in the triangle's plane: texture units per internal unit.
    pub grad_u: V3<F>,
    /// Gradient of v.
    pub grad_v: V3<F>,
    /// Direction of growing u, up to a positive factor.
    pub dp_du: V3<F>,
    /// `+1`, or `−1` where the texture is mirrored seen from the counter-clockwise side, or 0 where it has
    /// no area.
    pub handedness: F,
}

/// Which parts of a triangle are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FacetKind {
    /// Whether normals are interpolated.
    pub smooth: bool,
    /// How much more is needed.
    pub parts: SurfaceParts,
}

impl<F: Real> Facet<F> {
    /// Reads triangles of one kind from their mesh.
    #[inline(always)]
    #[must_use]
    pub fn fetch(mesh: &TriangleMesh, prims: F::Bits, kind: FacetKind) -> Self {
        let [a, b, c] = prims.fetch(&mesh.indices);
        let at = &*mesh.positions;
        let p: [V3<F>; 3] = [v3(a.fetch(at)), v3(b.fetch(at)), v3(c.fetch(at))];
        let zero = p[0].x.splat(0.0);
        let none = V3::new(zero, zero, zero);
        let mut facet = Self {
            p,
            n: [none; 3],
            uv: [V2::new(zero, zero); 3],
            n_winding: none,
            grad_u: none,
            grad_v: none,
            dp_du: none,
            handedness: zero,
        };
        if kind.smooth {
            let at = &*mesh.normals;
            facet.n = [v3(a.fetch(at)), v3(b.fetch(at)), v3(c.fetch(at))];
        }
        if kind.parts >= SurfaceParts::Uv {
            let at = &*mesh.uvs;
            facet.uv = [v2(a.fetch(at)), v2(b.fetch(at)), v2(c.fetch(at))];
        }
        facet.derive(kind.parts);
        facet
    }

    /// The same triangle in as many lanes as `like` has.
    #[inline(always)]
    #[must_use]
    pub fn splat(like: F, facet: &Facet) -> Self {
        let (p, n, uv) = (&facet.p, &facet.n, &facet.uv);
        Self {
            p: [
                V3::splat(like, p[0]),
                V3::splat(like, p[1]),
                V3::splat(like, p[2]),
            ],
            n: [
                V3::splat(like, n[0]),
                V3::splat(like, n[1]),
                V3::splat(like, n[2]),
            ],
            uv: [
                V2::splat(like, uv[0]),
                V2::splat(like, uv[1]),
                V2::splat(like, uv[2]),
            ],
            n_winding: V3::splat(like, facet.n_winding),
            grad_u: V3::splat(like, facet.grad_u),
            grad_v: V3::splat(like, facet.grad_v),
            dp_du: V3::splat(like, facet.dp_du),
            handedness: like.splat(facet.handedness),
        }
    }

    /// Works out the normal, and the gradients where they are needed.
    #[inline(always)]
    fn derive(&mut self, parts: SurfaceParts) {
        let [p0, p1, p2] = self.p;
        let (e1, e2) = (p1 - p0, p2 - p0);
        let area_normal = e1.cross(e2);
        self.n_winding = area_normal.normalize_or(self.n_winding);
        if parts == SurfaceParts::Gradients {
            let [t0, t1, t2] = self.uv;
            self.add_gradients([e1, e2], area_normal, [t1 - t0, t2 - t0]);
        }
    }

    /// `∇f = [(f₁−f₀)(e₂×N) + (f₂−f₀)(N×e₁)] / 2a`.
    ///
    /// Never inverts the texture matrix: a chart without area gives zero or collinear gradients.
    #[inline(always)]
    fn add_gradients(&mut self, [e1, e2]: [V3<F>; 2], area_normal: V3<F>, [d1, d2]: [V2<F>; 2]) {
        let area2 = area_normal.dot(area_normal);
        // area_normal is 2a·N, so dividing by its square leaves N / 2a.
        let toward1 = e2.cross(area_normal) / area2;
        let toward2 = area_normal.cross(e1) / area2;
        let grad_u = toward1 * d1.x + toward2 * d2.x;
        let grad_v = toward1 * d1.y + toward2 * d2.y;
        let zero = area2.splat(0.0);
        let none = self.grad_u;
        let is_plane = area2.gt(zero) & grad_u.is_finite() & grad_v.is_finite();
        self.grad_u = V3::select(is_plane, grad_u, none);
        self.grad_v = V3::select(is_plane, grad_v, none);
        let turn = self.grad_u.cross(self.grad_v).dot(self.n_winding);
        let has_area = !turn.eq(zero);
        self.handedness = F::select(has_area, zero.splat(1.0).copysign(turn), zero);
        self.dp_du = self.grad_v.cross(self.n_winding) * self.handedness;
    }
}

/// A vector whose numbers were fetched.
#[inline(always)]
pub(super) fn v3<F: Real>([x, y, z]: [F::Bits; 3]) -> V3<F> {
    V3::new(x.to_real(), y.to_real(), z.to_real())
}

#[inline(always)]
fn v2<F: Real>([x, y]: [F::Bits; 2]) -> V2<F> {
    V2::new(x.to_real(), y.to_real())
}
