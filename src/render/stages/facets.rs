//! The triangles under a group of points, each prepared once.

use super::super::Frame;
use super::{PLACES, Rays, Run, get3};
use crate::geometry::HitLanes;
use crate::math::simd::{Simd, SimdBase as _};
use crate::math::wide::{Wide, WideBits, WideMask};
use crate::math::{Bits as _, Mask as _, Real as _, V3};
use crate::surface::{Facet, FacetKind, SmoothedPoint, SurfaceInteraction, surface_on};

/// The triangles under a run's points. On large triangles all lanes share one; it is prepared once and
/// kept for the groups that follow.
pub(super) struct Facets<'a> {
    frame: &'a Frame<'a>,
    kind: FacetKind,
    last: Option<(u32, Facet)>,
}

impl<'a> Facets<'a> {
    #[inline(always)]
    pub(super) const fn new(frame: &'a Frame<'a>, kind: FacetKind) -> Self {
        Self {
            frame,
            kind,
            last: None,
        }
    }

    /// The surfaces of a group before any map.
    #[inline(always)]
    pub(super) fn surface<S: Simd>(
        &mut self,
        simd: S,
        (run, group): (&Run, usize),
        rays: &Rays,
        hits: &HitLanes<PLACES>,
    ) -> SurfaceInteraction<Wide<S>> {
        let lane = run.places.bits::<S>(group).trailing_zeros() as usize;
        let mask = run.places.mask(simd, group);
        let facet = self.facet(hits.prim.get(simd, group), (mask, lane));
        let barycentrics = (hits.u.get(simd, group), hits.v.get(simd, group));
        let wo = -get3(simd, &rays.lanes.dir, group);
        surface_on(&facet, barycentrics, wo, self.kind)
    }

    /// The points of a group, as [`Self::surface`] made them, as points of the smooth surface that their mesh stands
    /// for.
    #[inline(always)]
    pub(super) fn smoothed<S: Simd>(
        &mut self,
        simd: S,
        (run, group): (&Run, usize),
        hits: &HitLanes<PLACES>,
        s: &SurfaceInteraction<Wide<S>>,
    ) -> SmoothedPoint<Wide<S>> {
        let lane = run.places.bits::<S>(group).trailing_zeros() as usize;
        let mask = run.places.mask(simd, group);
        let facet = self.facet(hits.prim.get(simd, group), (mask, lane));
        let barycentrics = (hits.u.get(simd, group), hits.v.get(simd, group));
        let from_behind = s.wo.dot(s.n_geo).lt(Wide::new(simd, 0.0));
        let [normal, n_geo] = [s.n_smooth, s.n_geo].map(|n| V3::select(from_behind, -n, n));
        SmoothedPoint::new(&facet, barycentrics, s.p, (normal, n_geo, from_behind))
    }

    /// The triangle of each lane. `lane` is one in the mask.
    #[inline(always)]
    fn facet<S: Simd>(
        &mut self,
        prims: WideBits<S>,
        (mask, lane): (WideMask<S>, usize),
    ) -> Facet<Wide<S>> {
        let (mesh, kind) = (self.frame.mesh, self.kind);
        let prim = prims.0.as_slice()[lane];
        if !(prims.equals(prim) | !mask).all() {
            // Lanes outside the mask hold no triangle: they take part with any.
            let prims = WideBits::select(mask, prims, prims.splat(prim));
            return Facet::fetch(mesh, prims, kind);
        }
        let facet = match self.last {
            Some((cached, facet)) if cached == prim => facet,
            _ => Facet::fetch(mesh, prim, kind),
        };
        self.last = Some((prim, facet));
        Facet::splat(prims.to_real(), &facet)
    }
}
