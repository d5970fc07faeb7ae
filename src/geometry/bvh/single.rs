//! One ray at a time: closest hit and any hit.

use super::Bvh;
use super::node::{Child, ChildRef, Node};
use super::stack::{Entry, Stack};
use crate::geometry::triangle::{LANES, TriangleHit, TriangleTest, take_lowest};
use crate::geometry::{Hit, Ray, RaySlabs};

/// Says which hits count: the door for cut-outs.
///
/// Any `Fn(prim, u, v) -> bool` will do; `u` and `v` weigh the second and third vertex. It must be a pure
/// function, because a traversal may ask for hits that turn out not to be the closest, in any order.
pub trait HitFilter {
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
        let (test, slabs) = (T::new(ray), RaySlabs::new(ray, self.reach));
        let mut closest = Closest {
            t: t_max,
            hit: None,
        };
        let mut stack = Stack::new();
        let mut next = self.root;
        loop {
            match next.unpack() {
                Child::Node(index) => {
                    let node = &self.nodes[index];
                    let (mask, near) = node.hit_lanes(&slabs, closest.t);
                    if let Some(child) = push_sorted(&mut stack, node, mask, &near) {
                        next = child;
                        continue;
                    }
                }
                Child::Block(index) => {
                    if let Some(block) = self.blocks.get(index) {
                        test.intersect_block(&slabs, &block.corners, |lane, hit| {
                            closest.offer(block.prims[lane], hit, filter);
                            false
                        });
                    }
                }
            }
            next = loop {
                match stack.pop() {
                    Some(entry) if entry.near <= closest.t => break entry.child,
                    Some(_) => {}
                    None => return closest.hit,
                }
            };
        }
    }

    /// Whether anything is hit with `0 < t < t_max`.
    #[must_use]
    pub fn occluded<T: TriangleTest, F: HitFilter>(
        &self,
        ray: &Ray,
        t_max: f32,
        filter: &F,
    ) -> bool {
        let (test, slabs) = (T::new(ray), RaySlabs::new(ray, self.reach));
        let mut stack = Stack::new();
        let mut next = self.root;
        loop {
            match next.unpack() {
                Child::Node(index) => {
                    let node = &self.nodes[index];
                    let (mut mask, near) = node.hit_lanes(&slabs, t_max);
                    while mask != 0 {
                        let lane = take_lowest(&mut mask);
                        stack.push(Entry::of(node, lane, &near));
                    }
                }
                Child::Block(index) => {
                    let found = self.blocks.get(index).is_some_and(|block| {
                        test.intersect_block(&slabs, &block.corners, |lane, hit| {
                            hit.t < t_max && filter.accept(block.prims[lane], hit.u, hit.v)
                        })
                    });
                    if found {
                        return true;
                    }
                }
            }
            let Some(entry) = stack.pop() else {
                return false;
            };
            next = entry.child;
        }
    }
}

/// The best hit so far.
struct Closest {
    /// Its distance; before the first hit, the end of the search.
    t: f32,
    hit: Option<Hit>,
}

impl Closest {
    /// Takes the hit if it is closer, or as close with a lower index, and the filter lets it count.
    #[inline(always)]
    fn offer<F: HitFilter>(&mut self, prim: u32, hit: TriangleHit, filter: &F) {
        let TriangleHit { t, u, v } = hit;
        let wins_tie = || t == self.t && self.hit.is_some_and(|best| prim < best.prim);
        if (t < self.t || wins_tie()) && filter.accept(prim, u, v) {
            self.t = t;
            self.hit = Some(Hit {
                t,
                prim,
                sub: 0,
                u,
                v,
            });
        }
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
fn push_sorted(
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
