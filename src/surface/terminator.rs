//! Coarse meshes with smooth normals: the surface that they stand for, as far as light is concerned, so that facets
//! do not show as steps where light ends.

use super::Facet;
use crate::math::{Real, V3, gamma};

/// A point of a coarse mesh as a point of the smooth surface that the mesh stands for; with vector lanes, one for
/// each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SmoothedPoint<F = f32> {
    /// Unit normal of that surface, towards the eye: the interpolated one, before any map.
    pub normal: V3<F>,
    /// From the point on the facet to where its shadow rays start, internal units. Zero where the surface is hollow.
    pub lift: V3<F>,
}

impl<F: Real> SmoothedPoint<F> {
    /// The point `p` at barycentrics `(b1, b2)` of a facet with normals at its corners.
    ///
    /// The point is put onto the plane through each corner that is perpendicular to the normal there, unless it is
    /// over that plane already, and these three places are weighed like the corners:
    /// `q_i = p − min(0, (p − p_i)·n_i) n_i`, `q = Σ b_i q_i`. `normal` and `n_geo` point to the eye; an eye
    /// behind the mesh sees the other side of the same surface, hollow where the front bulges.
    ///
    /// Source: Hanika 2021, "Hacking the Shadow Terminator", Ray Tracing Gems II, chapter 4.
    #[inline(always)]
    #[must_use]
    pub fn new(
        facet: &Facet<F>,
        (b1, b2): (F, F),
        p: V3<F>,
        (normal, n_geo, from_behind): (V3<F>, V3<F>, F::Mask),
    ) -> Self {
        let zero = b1.splat(0.0);
        let one = b1.splat(1.0);
        let [p0, p1, p2] = facet.p;
        let [n0, n1, n2] = facet.n;
        let lift = |(corner, n, weight): (V3<F>, V3<F>, F)| {
            let n = V3::select(from_behind, -n, n);
            n * ((p - corner).dot(n).smaller(zero) * -weight)
        };
        let lift = lift((p0, n0, one - b1 - b2)) + lift((p1, n1, b1)) + lift((p2, n2, b2));
        // Normals that point through the facet would put it on the far side.
        let outward = lift.dot(n_geo);
        let usable = outward.gt(zero) & outward.is_finite();
        let none = V3::new(zero, zero, zero);
        Self {
            normal,
            lift: V3::select(usable, lift, none),
        }
    }

    /// Whether light from the unit direction `wi` may come: from outside of the smooth surface, and on a facet that
    /// faces away from it only if shadow rays start clear of the facet by more than rounding, `bound` (along `n_geo`,
    /// internal units).
    #[inline(always)]
    pub fn faces(&self, wi: V3<F>, n_geo: V3<F>, bound: F) -> F::Mask {
        let zero = bound.splat(0.0);
        let is_clear = self.lift.dot(n_geo).gt(bound);
        self.normal.dot(wi).gt(zero) & (n_geo.dot(wi).gt(zero) | is_clear)
    }

    /// How far rounding may take `p + lift` under the facet, along `n_geo`, beyond what it may take `p`.
    #[inline(always)]
    #[must_use]
    pub fn rounding(&self, p: V3<F>, n_geo: V3<F>) -> F {
        let [lift, sum] = [8, 2].map(|operations| n_geo.x.splat(gamma(operations)));
        let n = n_geo.abs();
        n.dot(self.lift.abs()) * lift + n.dot(p.abs()) * sum
    }
}
