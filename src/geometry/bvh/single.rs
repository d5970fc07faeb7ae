//! One ray at a time: closest hit and any hit.

use super::Bvh;
use super::node::{Block, Child, ChildRef, Node};
use super::stack::{Entry, Stack};
use crate::geometry::triangle::{Interest, LANES, TriangleHit, TriangleTest, Visitor, take_lowest};
use crate::geometry::{Hit, Ray, RaySlabs};
use crate::math::simd::{PLAIN, Simd};

/// Says which hits count: the door for cut-outs.
///
/// Any `Fn(prim, u, v) -> bool` will do; `u` and `v` weigh the second and third vertex. It must be a pure
/// function, because a traversal may ask for hits that turn out not to be the closest, in any order.
pub trait HitFilter {
    /// Whether it accepts everything, so that it need not be asked.
    const ACCEPTS_ALL: bool = false;
    /// Whether the surface is there.
    fn accept(&self, prim: u32, u: f32, v: f32) -> bool;
}

impl<F: Fn(u32, f32, f32) -> bool> HitFilter for F {
    #[inline(always)]
    fn accept(&self, prim: u32, u: f32, v: f32) -> bool {
        self(prim, u, v)
    }
}

/// The filter of a mesh without cut-outs; compiles to nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct AcceptAll;

impl HitFilter for AcceptAll {
    const ACCEPTS_ALL: bool = true;

    #[inline(always)]
    fn accept(&self, _prim: u32, _u: f32, _v: f32) -> bool {
        true
    }
}

impl Bvh {
    /// The closest hit with `0 < t < t_max`.
    ///
    /// Of several at the same `t` the lowest triangle index wins, whatever the shape of the tree. A ray
    /// with NaN hits nothing.
    #[must_use]
    pub fn intersect<T: TriangleTest, F: HitFilter>(
        &self,
        ray: &Ray,
        t_max: f32,
        filter: &F,
    ) -> Option<Hit> {
        let mut search = Closest::new(t_max, filter);
        self.traverse_alone::<T>(ray, &mut search);
        search.hit
    }

    /// Whether anything is hit with `0 < t < t_max`.
    #[must_use]
    pub fn occluded<T: TriangleTest, F: HitFilter>(
        &self,
        ray: &Ray,
        t_max: f32,
        filter: &F,
    ) -> bool {
        self.traverse_alone::<T>(ray, &mut Any { t_max, filter })
    }

    /// [`Self::traverse`] with a stack of its own, which a tree of one leaf does not need.
    #[inline(always)]
    fn traverse_alone<T: TriangleTest>(&self, ray: &Ray, search: &mut impl Search) -> bool {
        if ray.runs_away_from(&self.bounds) {
            false
        } else if self.nodes.is_empty() {
            let (test, slabs) = (T::new(ray), RaySlabs::new(ray, self.reach));
            self.blocks
                .first()
                .is_some_and(|block| visit_block(PLAIN, block, (&test, &slabs), search))
        } else {
            self.traverse::<_, T, _>(PLAIN, ray, &mut Stack::new(), search)
        }
    }

    /// Offers the search what it may want, roughly from front to back if it wants that; says whether it stopped early.
    #[inline(always)]
    pub(super) fn traverse<S: Simd, T: TriangleTest, Q: Search>(
        &self,
        simd: S,
        ray: &Ray,
        stack: &mut Stack,
        search: &mut Q,
    ) -> bool {
        stack.clear();
        if ray.runs_away_from(&self.bounds) {
            return false;
        }
        let (test, slabs) = (T::new(ray), RaySlabs::new(ray, self.reach));
        let mut next = self.root;
        loop {
            match next.unpack() {
                Child::Node(index) => {
                    let node = &self.nodes[index];
                    let (mask, near) = node.hit_lanes(simd, &slabs, search.limit());
                    let child = if Q::NEAREST_FIRST {
                        push_sorted(stack, node, mask, &near)
                    } else {
                        push_all(stack, node, mask, &near)
                    };
                    if let Some(child) = child {
                        next = child;
                        continue;
                    }
                }
                Child::Block(index) => {
                    // No closure: it would be compiled without the vector instructions of the caller.
                    if let Some(block) = self.blocks.get(index)
                        && visit_block(simd, block, (&test, &slabs), search)
                    {
                        return true;
                    }
                }
            }
            next = loop {
                match stack.pop() {
                    Some(entry) if entry.near <= search.limit() => break entry.child,
                    Some(_) => {}
                    None => return false,
                }
            };
        }
    }
}

/// Offers the hits on a block's triangles; says whether the search is over.
#[inline(always)]
fn visit_block<S: Simd>(
    simd: S,
    block: &Block,
    (test, slabs): (&impl TriangleTest, &RaySlabs),
    search: &mut impl Search,
) -> bool {
    let mut visitor = BlockSearch { block, search };
    test.intersect_block(simd, slabs, &block.corners, &mut visitor)
}

/// A search through one block.
struct BlockSearch<'a, Q> {
    block: &'a Block,
    search: &'a mut Q,
}

impl<Q: Search> Visitor for BlockSearch<'_, Q> {
    #[inline(always)]
    fn expects(&self, near: f32, far: f32) -> Interest {
        self.search.expects(near, far)
    }

    #[inline(always)]
    fn visit(&mut self, lane: usize, hit: TriangleHit) -> bool {
        self.search.offer(self.block.prims[lane], hit)
    }
}

/// What a traversal is for.
pub(super) trait Search {
    /// Whether what is found early spares what lies behind it.
    const NEAREST_FIRST: bool;
    /// Boxes that begin beyond this distance are of no interest.
    fn limit(&self) -> f32;
    /// What a hit would mean that lies between two distances, the second above 0.
    fn expects(&self, near: f32, far: f32) -> Interest;
    /// Considers a hit; `true` ends the search.
    fn offer(&mut self, prim: u32, hit: TriangleHit) -> bool;
}

/// Stops at the first hit that counts.
pub(super) struct Any<'a, F> {
    pub(super) t_max: f32,
    pub(super) filter: &'a F,
}

impl<F: HitFilter> Search for Any<'_, F> {
    // In Sponza's shadows sorting takes longer than it spares.
    const NEAREST_FIRST: bool = false;

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.t_max
    }

    #[inline(always)]
    fn expects(&self, near: f32, far: f32) -> Interest {
        if near >= self.t_max {
            Interest::None
        } else if F::ACCEPTS_ALL && near > 0.0 && far < self.t_max {
            Interest::Enough
        } else {
            Interest::Some
        }
    }

    #[inline(always)]
    fn offer(&mut self, prim: u32, hit: TriangleHit) -> bool {
        hit.t < self.t_max && self.filter.accept(prim, hit.u, hit.v)
    }
}

/// Keeps the closest hit that counts.
pub(super) struct Closest<'a, F> {
    /// Its distance; before the first hit, the end of the search.
    pub(super) limit: f32,
    pub(super) hit: Option<Hit>,
    pub(super) filter: &'a F,
}

impl<'a, F> Closest<'a, F> {
    #[inline(always)]
    pub(super) const fn new(t_max: f32, filter: &'a F) -> Self {
        Self {
            limit: t_max,
            hit: None,
            filter,
        }
    }
}

impl<F: HitFilter> Search for Closest<'_, F> {
    const NEAREST_FIRST: bool = true;

    #[inline(always)]
    fn limit(&self) -> f32 {
        self.limit
    }

    #[inline(always)]
    fn expects(&self, near: f32, _far: f32) -> Interest {
        if near > self.limit {
            Interest::None
        } else {
            Interest::Some
        }
    }

    #[inline(always)]
    fn offer(&mut self, prim: u32, TriangleHit { t, u, v }: TriangleHit) -> bool {
        let wins_tie = || t == self.limit && self.hit.is_some_and(|best| prim < best.prim);
        if (t < self.limit || wins_tie()) && self.filter.accept(prim, u, v) {
            self.limit = t;
            self.hit = Some(Hit {
                t,
                prim,
                sub: 0,
                u,
                v,
            });
        }
        false
    }
}

impl Entry {
    #[inline(always)]
    fn of(node: &Node, lane: usize, near: &[f32; LANES]) -> Self {
        Self {
            near: near[lane],
            child: node.children[lane],
        }
    }
}

/// Returns the nearest of the hit children and pushes the others, the farthest first.
#[inline(always)]
pub(super) fn push_sorted(
    stack: &mut Stack,
    node: &Node,
    mut mask: u32,
    near: &[f32; LANES],
) -> Option<ChildRef> {
    if mask == 0 {
        return None;
    }
    let mut nearest = Entry::of(node, take_lowest(&mut mask), near);
    let first = stack.len();
    while mask != 0 {
        let mut entry = Entry::of(node, take_lowest(&mut mask), near);
        if entry.near < nearest.near {
            std::mem::swap(&mut entry, &mut nearest);
        }
        stack.insert_sorted(first, entry);
    }
    Some(nearest.child)
}

/// Returns one of the hit children and pushes the others.
#[inline(always)]
fn push_all(
    stack: &mut Stack,
    node: &Node,
    mut mask: u32,
    near: &[f32; LANES],
) -> Option<ChildRef> {
    if mask == 0 {
        return None;
    }
    let first = take_lowest(&mut mask);
    while mask != 0 {
        stack.push(Entry::of(node, take_lowest(&mut mask), near));
    }
    Some(node.children[first])
}
