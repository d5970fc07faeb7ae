//! What the rays of a bundle have found: the vector twins of the searches in `single`.

use super::bundle::Query;
use super::single::{Any, Closest};
use super::stack::Stack;
use super::{Bvh, HitFilter};
use crate::geometry::bundle::{Floats, LaneHits, Lanes, RAYS, RaySet, lanes_of};
use crate::geometry::triangle::Watertight;
use crate::geometry::{Hit, HitLanes, Ray};
use crate::math::simd::{Select, Simd, SimdBase, SimdMask, merged};

/// The limit of a lane without a ray, and of a ray that is done.
const DONE: f32 = -1.0;

/// A [`Query`] that can be asked for each ray.
pub(super) trait LaneQuery: Query {
    /// What is asked.
    type Answer: Copy;
    /// Forgets all rays and takes those in `set`, which end at `t_max`.
    fn start<S: Simd>(&mut self, simd: S, set: RaySet, t_max: &Floats);
    /// What came of a ray.
    fn answer(&self, lane: usize) -> Self::Answer;
    /// What comes of the ray of a lane whose bundle was given up on the way.
    fn resume<S: Simd>(
        &self,
        simd: S,
        bvh: &Bvh,
        stack: &mut Stack,
        ray: (usize, &Ray),
    ) -> Self::Answer;
    /// What comes of a ray in no bundle, and its end.
    fn alone<S: Simd>(
        &self,
        simd: S,
        bvh: &Bvh,
        stack: &mut Stack,
        ray: (&Ray, f32),
    ) -> Self::Answer;
}

/// Any hit.
pub(super) struct AnyLanes<'a, F> {
    limits: Floats,
    filter: &'a F,
}

impl<'a, F: HitFilter> AnyLanes<'a, F> {
    pub(super) const fn new(filter: &'a F) -> Self {
        Self {
            limits: Lanes::splat(DONE),
            filter,
        }
    }

    /// The rays that are done: those that hit something, and places without a ray.
    #[inline(always)]
    pub(super) fn done<S: Simd>(&self, simd: S) -> RaySet {
        let zero = S::f32s::splat(simd, 0.0);
        let mut done = 0;
        for group in 0..RAYS / S::f32s::LEN {
            let below = self.limits.load(simd, group).simd_lt(zero);
            done |= below.to_bitmask() << (group * S::f32s::LEN);
        }
        done
    }
}

impl<F: HitFilter> Query for AnyLanes<'_, F> {
    const ENDS_EARLY: bool = true;

    #[inline(always)]
    fn limits(&self) -> &Floats {
        &self.limits
    }

    #[inline(always)]
    fn expect<S: Simd>(
        &mut self,
        simd: S,
        group: usize,
        (near, far): (S::f32s, S::f32s),
        mask: S::mask32s,
    ) -> S::mask32s {
        let limits = self.limits.load(simd, group);
        let mask = mask & near.simd_lt(limits);
        if !F::ACCEPTS_ALL {
            return mask;
        }
        let enough = mask & near.simd_gt(S::f32s::splat(simd, 0.0)) & far.simd_lt(limits);
        let limits = merged(enough, S::f32s::splat(simd, DONE), limits);
        self.limits.store::<S>(group, limits);
        mask & !enough
    }

    #[inline(always)]
    fn offer<S: Simd>(&mut self, simd: S, group: usize, prim: u32, hits: LaneHits<S>) {
        let limits = self.limits.load(simd, group);
        let counts = hits.mask & hits.t.simd_lt(limits);
        let counts = accepted(simd, self.filter, prim, counts, &hits);
        let limits = merged(counts, S::f32s::splat(simd, DONE), limits);
        self.limits.store::<S>(group, limits);
    }
}

impl<F: HitFilter> LaneQuery for AnyLanes<'_, F> {
    type Answer = bool;

    #[inline(always)]
    fn start<S: Simd>(&mut self, simd: S, set: RaySet, t_max: &Floats) {
        start(simd, set, t_max, &mut self.limits);
    }

    #[inline(always)]
    fn answer(&self, lane: usize) -> bool {
        self.limits.0[lane] == DONE
    }

    #[inline(always)]
    fn resume<S: Simd>(
        &self,
        simd: S,
        bvh: &Bvh,
        stack: &mut Stack,
        (lane, ray): (usize, &Ray),
    ) -> bool {
        self.answer(lane) || self.alone(simd, bvh, stack, (ray, self.limits.0[lane]))
    }

    #[inline(always)]
    fn alone<S: Simd>(
        &self,
        simd: S,
        bvh: &Bvh,
        stack: &mut Stack,
        (ray, t_max): (&Ray, f32),
    ) -> bool {
        let filter = self.filter;
        bvh.traverse::<_, Watertight, _>(simd, ray, stack, &mut Any { t_max, filter })
    }
}

/// The closest hits.
pub(super) struct ClosestLanes<'a, F> {
    limits: Floats,
    u: Floats,
    v: Floats,
    /// 0 before the first hit, so that nothing wins a tie against the end of the ray.
    prims: Lanes<u32>,
    /// Bit `lane`: there was a hit, and the limit is its distance.
    found: u64,
    filter: &'a F,
}

impl<'a, F: HitFilter> ClosestLanes<'a, F> {
    pub(super) const fn new(filter: &'a F) -> Self {
        Self {
            limits: Lanes::splat(DONE),
            u: Lanes::splat(0.0),
            v: Lanes::splat(0.0),
            prims: Lanes::splat(0),
            found: 0,
            filter,
        }
    }

    /// Writes what those rays in `set` hit that hit something, places counted from `first`.
    #[inline(always)]
    pub(super) fn write_hits<S: Simd, const N: usize>(
        &self,
        simd: S,
        set: RaySet,
        hits: &mut HitLanes<N>,
        first: usize,
    ) {
        let width = S::f32s::LEN;
        for group in 0..RAYS / width {
            let found = lanes_of(simd, set & self.found, group);
            let place = first / width + group;
            let u = merged(found, self.u.load(simd, group), hits.u.load(simd, place));
            hits.u.store::<S>(place, u);
            let v = merged(found, self.v.load(simd, group), hits.v.load(simd, place));
            hits.v.store::<S>(place, v);
            let prims = merged(
                found,
                self.prims.get(simd, group).0,
                hits.prim.get(simd, place).0,
            );
            prims.store_slice(hits.prim.group_mut(place, width));
        }
    }
}

impl<F: HitFilter> Query for ClosestLanes<'_, F> {
    const ENDS_EARLY: bool = false;

    #[inline(always)]
    fn limits(&self) -> &Floats {
        &self.limits
    }

    #[inline(always)]
    fn expect<S: Simd>(
        &mut self,
        simd: S,
        group: usize,
        (near, _far): (S::f32s, S::f32s),
        mask: S::mask32s,
    ) -> S::mask32s {
        mask & near.simd_le(self.limits.load(simd, group))
    }

    #[inline(always)]
    fn offer<S: Simd>(&mut self, simd: S, group: usize, prim: u32, hits: LaneHits<S>) {
        let width = S::f32s::LEN;
        let limits = self.limits.load(simd, group);
        let prims = S::u32s::from_slice(simd, self.prims.group(group, width));
        let this = S::u32s::splat(simd, prim);
        let wins_tie = hits.t.simd_eq(limits) & this.simd_lt(prims);
        let wins = hits.mask & (hits.t.simd_lt(limits) | wins_tie);
        let wins = accepted(simd, self.filter, prim, wins, &hits);
        self.limits.store::<S>(group, merged(wins, hits.t, limits));
        let u = self.u.load(simd, group);
        self.u.store::<S>(group, merged(wins, hits.u, u));
        let v = self.v.load(simd, group);
        self.v.store::<S>(group, merged(wins, hits.v, v));
        merged(wins, this, prims).store_slice(self.prims.group_mut(group, width));
        self.found |= wins.to_bitmask() << (group * width);
    }
}

impl<F: HitFilter> LaneQuery for ClosestLanes<'_, F> {
    type Answer = Option<Hit>;

    #[inline(always)]
    fn start<S: Simd>(&mut self, simd: S, set: RaySet, t_max: &Floats) {
        start(simd, set, t_max, &mut self.limits);
        self.prims = Lanes::splat(0);
        self.found = 0;
    }

    #[inline(always)]
    fn answer(&self, lane: usize) -> Option<Hit> {
        (self.found >> lane & 1 != 0).then(|| Hit {
            t: self.limits.0[lane],
            prim: self.prims.0[lane],
            sub: 0,
            u: self.u.0[lane],
            v: self.v.0[lane],
        })
    }

    #[inline(always)]
    fn resume<S: Simd>(
        &self,
        simd: S,
        bvh: &Bvh,
        stack: &mut Stack,
        (lane, ray): (usize, &Ray),
    ) -> Option<Hit> {
        let mut search = Closest {
            limit: self.limits.0[lane],
            hit: self.answer(lane),
            filter: self.filter,
        };
        bvh.traverse::<_, Watertight, _>(simd, ray, stack, &mut search);
        search.hit
    }

    #[inline(always)]
    fn alone<S: Simd>(
        &self,
        simd: S,
        bvh: &Bvh,
        stack: &mut Stack,
        (ray, t_max): (&Ray, f32),
    ) -> Option<Hit> {
        let mut search = Closest::new(t_max, self.filter);
        bvh.traverse::<_, Watertight, _>(simd, ray, stack, &mut search);
        search.hit
    }
}

/// Sets the limits of the rays in `set`; the others are done.
#[inline(always)]
fn start<S: Simd>(simd: S, set: RaySet, t_max: &Floats, limits: &mut Floats) {
    let done = S::f32s::splat(simd, DONE);
    for group in 0..RAYS / S::f32s::LEN {
        let limit = lanes_of(simd, set, group).select(t_max.load(simd, group), done);
        limits.store::<S>(group, limit);
    }
}

/// Those of the candidates that the filter accepts.
#[inline(always)]
fn accepted<S: Simd, F: HitFilter>(
    simd: S,
    filter: &F,
    prim: u32,
    candidates: S::mask32s,
    hits: &LaneHits<S>,
) -> S::mask32s {
    if F::ACCEPTS_ALL {
        return candidates;
    }
    let (u, v) = (hits.u.as_slice(), hits.v.as_slice());
    let mut mask = candidates.to_bitmask();
    let mut left = mask;
    while left != 0 {
        let lane = left.trailing_zeros() as usize;
        left &= left - 1;
        if !filter.accept(prim, u[lane], v[lane]) {
            mask &= !(1 << lane);
        }
    }
    S::mask32s::from_bitmask(simd, mask)
}
