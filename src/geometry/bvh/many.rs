//! Many rays at once: what the stages of a tile call.
//!
//! Neighbours that run alike are traced as a bundle (`bundle`), the others one by one (`single`). The
//! answers are the same, bit for bit.

use super::query::{AnyLanes, ClosestLanes, LaneQuery};
use super::stack::Stack;
use super::{Bvh, HitFilter};
use crate::geometry::bundle::{Bundle, Floats, Hull, Lanes, RAYS, RaySet};
use crate::geometry::triangle::{Axis, TriangleTest, Watertight};
use crate::geometry::{Hit, HitLanes, NO_HIT, Ray, RayLanes};
use crate::math::lanes::ones;
use crate::math::simd::{Kernel, Simd, SimdBase, SimdMask};

/// Fewer rays than this are traced one by one.
const MIN_RAYS: u32 = 8;
/// How often 64 neighbours are cut to find some that run alike.
const MAX_CUTS: u32 = 6;
/// Bundles given up in a row double the doubt; half of it is how many blocks are traced one by one before the
/// next try. Where triangles are smaller than what lies between two rays, neighbours have little in common.
const MAX_DOUBT: u32 = 15;

impl Bvh {
    /// [`Self::intersect`] for each ray, into `hits`.
    ///
    /// Rays that start together and run alike should be neighbours, best in blocks of 8 × 8 pixels. How
    /// they are grouped never shows in the answers.
    ///
    /// # Panics
    /// If the three slices differ in length.
    pub fn intersect_many<T: TriangleTest, F: HitFilter>(
        &self,
        rays: &[Ray],
        t_max: &[f32],
        filter: &F,
        hits: &mut [Option<Hit>],
    ) {
        assert!(rays.len() == t_max.len() && rays.len() == hits.len());
        let query = ClosestLanes::new(filter);
        if !(T::HAS_BUNDLES && self.run_many((rays, t_max), query, &mut *hits)) {
            for ((ray, &t_max), hit) in rays.iter().zip(t_max).zip(hits) {
                *hit = self.intersect::<T, F>(ray, t_max, filter);
            }
        }
    }

    /// [`Self::occluded`] for each ray, into `occluded`.
    ///
    /// # Panics
    /// If the three slices differ in length.
    pub fn occluded_many<T: TriangleTest, F: HitFilter>(
        &self,
        rays: &[Ray],
        t_max: &[f32],
        filter: &F,
        occluded: &mut [bool],
    ) {
        assert!(rays.len() == t_max.len() && rays.len() == occluded.len());
        let query = AnyLanes::new(filter);
        if !(T::HAS_BUNDLES && self.run_many((rays, t_max), query, &mut *occluded)) {
            for ((ray, &t_max), occluded) in rays.iter().zip(t_max).zip(occluded) {
                *occluded = self.occluded::<T, F>(ray, t_max, filter);
            }
        }
    }

    /// [`Self::intersect`] with the watertight test for the rays in the first `count` places. `N` is a
    /// multiple of 64.
    pub fn intersect_lanes<F: HitFilter, const N: usize>(
        &self,
        rays: &RayLanes<N>,
        count: usize,
        filter: &F,
        hits: &mut HitLanes<N>,
    ) {
        if !self.run_many(
            Places { rays, count },
            ClosestLanes::new(filter),
            &mut *hits,
        ) {
            for place in 0..count.min(N) {
                let (ray, t_max) = (rays.ray(place), rays.t_max.0[place]);
                let hit = self.intersect::<Watertight, F>(&ray, t_max, filter);
                put_hit(hits, place, hit);
            }
        }
    }

    /// [`Self::occluded`] with the watertight test for the rays in the first `count` places: bit `i` of
    /// word `w` stands for place `64·w + i`. `N` is a multiple of 64.
    ///
    /// # Panics
    /// If there are fewer words than blocks of 64 rays.
    pub fn occluded_lanes<F: HitFilter, const N: usize>(
        &self,
        rays: &RayLanes<N>,
        count: usize,
        filter: &F,
        occluded: &mut [u64],
    ) {
        assert!(occluded.len() * RAYS >= count.min(N), "a bit for each ray");
        if !self.run_many(
            Places { rays, count },
            AnyLanes::new(filter),
            &mut *occluded,
        ) {
            occluded.fill(0);
            for place in 0..count.min(N) {
                let (ray, t_max) = (rays.ray(place), rays.t_max.0[place]);
                if self.occluded::<Watertight, F>(&ray, t_max, filter) {
                    occluded[place / RAYS] |= 1 << (place % RAYS);
                }
            }
        }
    }

    /// Says whether this tree's level has a kernel; if not, nothing was done.
    fn run_many<R: RaySource, Q: LaneQuery, A: Answers<Q>>(
        &self,
        rays: R,
        query: Q,
        answers: A,
    ) -> bool {
        self.level.run(Many {
            bvh: self,
            rays,
            query,
            answers,
        })
    }
}

/// Where rays come from, in blocks of 64.
trait RaySource {
    /// How many there are, holes included.
    fn count(&self) -> usize;
    /// Copies the block that starts at `first`; ends beyond the last ray are not above 0.
    fn load(&self, first: usize, bundle: &mut Bundle, t_max: &mut Floats);
    /// One ray and its end.
    fn ray(&self, place: usize) -> (Ray, f32);
}

impl RaySource for (&[Ray], &[f32]) {
    fn count(&self) -> usize {
        self.0.len()
    }

    #[inline(always)]
    fn load(&self, first: usize, bundle: &mut Bundle, t_max: &mut Floats) {
        let end = self.0.len().min(first + RAYS);
        bundle.load(&self.0[first..end]);
        let (ends, beyond) = t_max.0.split_at_mut(end - first);
        ends.copy_from_slice(&self.1[first..end]);
        beyond.fill(-1.0);
    }

    #[inline(always)]
    fn ray(&self, place: usize) -> (Ray, f32) {
        (self.0[place], self.1[place])
    }
}

/// The first places of an array of rays.
struct Places<'a, const N: usize> {
    rays: &'a RayLanes<N>,
    count: usize,
}

impl<const N: usize> RaySource for Places<'_, N> {
    fn count(&self) -> usize {
        self.count.min(N)
    }

    #[inline(always)]
    fn load(&self, first: usize, bundle: &mut Bundle, t_max: &mut Floats) {
        bundle.load_lanes(self.rays, first);
        let ends = self.rays.t_max.group(first / RAYS, RAYS);
        t_max.0.copy_from_slice(ends);
        if self.count < first + RAYS {
            t_max.0[self.count - first..].fill(-1.0);
        }
    }

    #[inline(always)]
    fn ray(&self, place: usize) -> (Ray, f32) {
        (self.rays.ray(place), self.rays.t_max.0[place])
    }
}

/// Where answers go.
trait Answers<Q: LaneQuery> {
    /// Answers "nothing" in the block of up to 64 that starts at `first`.
    fn clear(&mut self, first: usize);
    /// One answer.
    fn put(&mut self, place: usize, answer: Q::Answer);
    /// The answers of a bundle: those in `set`, places counted from `first`.
    #[inline(always)]
    fn put_bundle<S: Simd>(&mut self, _simd: S, first: usize, set: RaySet, query: &Q) {
        for lane in ones(set) {
            self.put(first + lane, query.answer(lane));
        }
    }
}

impl<F: HitFilter> Answers<ClosestLanes<'_, F>> for &mut [Option<Hit>] {
    #[inline(always)]
    fn clear(&mut self, first: usize) {
        let end = self.len().min(first + RAYS);
        self[first..end].fill(None);
    }
    #[inline(always)]
    fn put(&mut self, place: usize, hit: Option<Hit>) {
        self[place] = hit;
    }
}

impl<F: HitFilter> Answers<AnyLanes<'_, F>> for &mut [bool] {
    #[inline(always)]
    fn clear(&mut self, first: usize) {
        let end = self.len().min(first + RAYS);
        self[first..end].fill(false);
    }
    #[inline(always)]
    fn put(&mut self, place: usize, occluded: bool) {
        self[place] = occluded;
    }
}

impl<F: HitFilter, const N: usize> Answers<ClosestLanes<'_, F>> for &mut HitLanes<N> {
    #[inline(always)]
    fn clear(&mut self, first: usize) {
        self.prim.group_mut(first / RAYS, RAYS).fill(NO_HIT);
    }
    #[inline(always)]
    fn put(&mut self, place: usize, hit: Option<Hit>) {
        put_hit(self, place, hit);
    }
    #[inline(always)]
    fn put_bundle<S: Simd>(
        &mut self,
        simd: S,
        first: usize,
        set: RaySet,
        query: &ClosestLanes<'_, F>,
    ) {
        query.write_hits(simd, set, self, first);
    }
}

impl<F: HitFilter> Answers<AnyLanes<'_, F>> for &mut [u64] {
    #[inline(always)]
    fn clear(&mut self, first: usize) {
        self[first / RAYS] = 0;
    }
    #[inline(always)]
    fn put(&mut self, place: usize, occluded: bool) {
        self[place / RAYS] |= u64::from(occluded) << (place % RAYS);
    }
    #[inline(always)]
    fn put_bundle<S: Simd>(&mut self, simd: S, first: usize, set: RaySet, query: &AnyLanes<'_, F>) {
        self[first / RAYS] |= set & query.done(simd);
    }
}

/// Writes what one ray hit.
#[inline(always)]
fn put_hit<const N: usize>(hits: &mut HitLanes<N>, place: usize, hit: Option<Hit>) {
    hits.prim.0[place] = hit.map_or(NO_HIT, |hit| hit.prim);
    if let Some(hit) = hit {
        hits.u.0[place] = hit.u;
        hits.v.0[place] = hit.v;
    }
}

/// The work of one call.
struct Many<'a, R, Q, A> {
    bvh: &'a Bvh,
    rays: R,
    query: Q,
    answers: A,
}

impl<R: RaySource, Q: LaneQuery, A: Answers<Q>> Kernel for Many<'_, R, Q, A> {
    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) {
        let (mut bundle, mut stack) = (Bundle::new(), Stack::new());
        let mut t_max = Lanes::splat(-1.0);
        let (mut doubt, mut untried) = (0, 0);
        for first in (0..self.rays.count()).step_by(RAYS) {
            self.answers.clear(first);
            self.rays.load(first, &mut bundle, &mut t_max);
            let mut hopeful = above_zero(simd, &t_max);
            if hopeful != 0 {
                hopeful &= !bundle.running_away(simd, &self.bvh.bounds);
            }
            if hopeful == 0 {
                continue;
            }
            if untried > 0 {
                untried -= 1;
                simd.vectorize(|| self.trace_alone(simd, first, hopeful, &mut stack));
                continue;
            }
            let (mut alone, mut cuts, mut all_done) = (hopeful, MAX_CUTS, true);
            let sets = bundle.by_axis(simd, self.bvh.reach);
            for (along, set) in [Axis::X, Axis::Y, Axis::Z].into_iter().zip(sets) {
                let mut left = set & hopeful;
                while left.count_ones() >= MIN_RAYS
                    && let Some(set) = self.alike(simd, &bundle, left, &mut cuts)
                {
                    left &= !set;
                    if set.count_ones() >= MIN_RAYS {
                        alone &= !set;
                        bundle.prepare(simd, set, along, self.bvh.reach);
                        if Q::ENDS_EARLY {
                            bundle.find_ends(simd, &t_max);
                        }
                        let hull = bundle.hull(simd, self.bvh.reach);
                        self.query.start(simd, set, &t_max);
                        all_done &= self.trace(simd, first, (&mut bundle, hull, set), &mut stack);
                    }
                }
            }
            doubt = if all_done {
                0
            } else {
                (2 * doubt + 1).min(MAX_DOUBT)
            };
            untried = doubt / 2;
            if alone != 0 {
                simd.vectorize(|| self.trace_alone(simd, first, alone, &mut stack));
            }
        }
    }
}

impl<R: RaySource, Q: LaneQuery, A: Answers<Q>> Many<'_, R, Q, A> {
    /// Some of the rays in `set` that run alike; `None` once `cuts` are used up.
    #[inline(always)]
    fn alike<S: Simd>(
        &self,
        simd: S,
        bundle: &Bundle,
        mut set: RaySet,
        cuts: &mut u32,
    ) -> Option<RaySet> {
        // In a single leaf there is nothing to lose.
        let has_ways = !self.bvh.nodes.is_empty();
        let size = self.bvh.bounds.extent().max_element();
        while has_ways
            && set.count_ones() >= MIN_RAYS
            && let Some(part) = bundle.cut(simd, set, size)
        {
            *cuts = cuts.checked_sub(1)?;
            set = part;
        }
        Some(set)
    }

    /// Traces the rays of `set` together, places counted from `first`; says whether they stayed so to the end.
    #[inline(always)]
    fn trace<S: Simd>(
        &mut self,
        simd: S,
        first: usize,
        (bundle, hull, set): (&mut Bundle, Hull, RaySet),
        stack: &mut Stack,
    ) -> bool {
        let bvh = self.bvh;
        let done = bvh.traverse_bundle(simd, bundle, hull, stack, &mut self.query);
        if done {
            self.answers.put_bundle(simd, first, set, &self.query);
        } else {
            for lane in ones(set) {
                let (ray, _) = self.rays.ray(first + lane);
                let answer = self.query.resume(simd, bvh, stack, (lane, &ray));
                self.answers.put(first + lane, answer);
            }
        }
        done
    }

    /// Traces the rays of `set` one by one.
    #[inline(always)]
    fn trace_alone<S: Simd>(&mut self, simd: S, first: usize, set: RaySet, stack: &mut Stack) {
        for place in ones(set).map(|lane| first + lane) {
            let (ray, t_max) = self.rays.ray(place);
            let answer = self.query.alone(simd, self.bvh, stack, (&ray, t_max));
            self.answers.put(place, answer);
        }
    }
}

/// Which numbers are above 0; not NaN.
#[inline(always)]
fn above_zero<S: Simd>(simd: S, floats: &Floats) -> RaySet {
    let zero = S::f32s::splat(simd, 0.0);
    let mut set = 0;
    for group in 0..RAYS / S::f32s::LEN {
        let above = floats.load(simd, group).simd_gt(zero).to_bitmask();
        set |= above << (group * S::f32s::LEN);
    }
    set
}
