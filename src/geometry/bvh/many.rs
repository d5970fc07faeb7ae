//! Many rays at once: what the stages of a tile call.
//!
//! Neighbours that run alike are traced as a bundle (`bundle`), the others one by one (`single`). The
//! answers are the same, bit for bit.

use super::query::{AnyLanes, ClosestLanes, LaneQuery};
use super::stack::Stack;
use super::{Bvh, HitFilter};
use crate::geometry::bundle::{Bundle, Floats, Hull, Lanes, RAYS, RaySet};
use crate::geometry::simd::{Kernel, Simd, SimdBase, SimdMask};
use crate::geometry::triangle::{Axis, TriangleTest};
use crate::geometry::{Hit, Ray};

/// Fewer rays than this are traced one by one.
const MIN_RAYS: u32 = 8;
/// How often 64 neighbours are cut to find some that run alike.
const MAX_CUTS: u32 = 6;

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
        let many = Many {
            bvh: self,
            rays,
            t_max,
            query: ClosestLanes::new(filter),
            answers: &mut *hits,
        };
        if !(T::HAS_BUNDLES && self.level.run(many)) {
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
        let many = Many {
            bvh: self,
            rays,
            t_max,
            query: AnyLanes::new(filter),
            answers: &mut *occluded,
        };
        if !(T::HAS_BUNDLES && self.level.run(many)) {
            for ((ray, &t_max), occluded) in rays.iter().zip(t_max).zip(occluded) {
                *occluded = self.occluded::<T, F>(ray, t_max, filter);
            }
        }
    }
}

/// The work of one call.
struct Many<'a, Q: LaneQuery> {
    bvh: &'a Bvh,
    rays: &'a [Ray],
    t_max: &'a [f32],
    query: Q,
    answers: &'a mut [Q::Answer],
}

impl<Q: LaneQuery> Kernel for Many<'_, Q> {
    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) {
        let (mut bundle, mut stack) = (Bundle::new(), Stack::new());
        let mut t_max = Lanes::splat(0.0);
        for first in (0..self.rays.len()).step_by(RAYS) {
            let end = self.rays.len().min(first + RAYS);
            bundle.load(&self.rays[first..end]);
            t_max.0[..end - first].copy_from_slice(&self.t_max[first..end]);
            let all = RaySet::MAX >> (RAYS - (end - first));
            let (mut alone, mut cuts) = (all, MAX_CUTS);
            let sets = bundle.by_axis(simd, self.bvh.reach);
            let hopeful = all & above_zero(simd, &t_max);
            for (along, set) in [Axis::X, Axis::Y, Axis::Z].into_iter().zip(sets) {
                let mut left = set & hopeful;
                while left.count_ones() >= MIN_RAYS
                    && let Some(set) = self.alike(simd, &bundle, left, &mut cuts)
                {
                    left &= !set;
                    if set.count_ones() >= MIN_RAYS {
                        alone &= !set;
                        let hull = bundle.prepare(simd, set, along, self.bvh.reach);
                        self.query.start(simd, set, &t_max);
                        self.trace(simd, first, (&bundle, &hull, set), &mut stack);
                    }
                }
            }
            self.trace_alone(first, alone, &mut stack);
        }
    }
}

impl<Q: LaneQuery> Many<'_, Q> {
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

    /// Traces the rays of `set` together, places counted from `first`.
    #[inline(always)]
    fn trace<S: Simd>(
        &mut self,
        simd: S,
        first: usize,
        (bundle, hull, set): (&Bundle, &Hull, RaySet),
        stack: &mut Stack,
    ) {
        let bvh = self.bvh;
        let done = bvh.traverse_bundle(simd, bundle, hull, stack, &mut self.query);
        let answers = &mut self.answers[first..];
        if done {
            for (lane, answer) in answers.iter_mut().take(RAYS).enumerate() {
                if set >> lane & 1 != 0 {
                    *answer = self.query.answer(lane);
                }
            }
        } else {
            for lane in lanes(set) {
                let ray = &self.rays[first + lane];
                answers[lane] = self.query.resume(bvh, stack, lane, ray);
            }
        }
    }

    /// Traces the rays of `set` one by one.
    #[inline(never)]
    fn trace_alone(&mut self, first: usize, set: RaySet, stack: &mut Stack) {
        for ray in lanes(set).map(|lane| first + lane) {
            let (t_max, at) = (self.t_max[ray], &self.rays[ray]);
            self.answers[ray] = self.query.alone(self.bvh, stack, at, t_max);
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

/// The places of the rays in a set.
fn lanes(mut set: RaySet) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = set.trailing_zeros() as usize;
        set &= set.wrapping_sub(1);
        (lane < RAYS).then_some(lane)
    })
}
