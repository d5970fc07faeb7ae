//! A bundle of rays through the hierarchy: one path for all of them.

use super::Bvh;
use super::node::{Block, Child, NO_PRIM, Node};
use super::single::push_sorted;
use super::stack::Stack;
use crate::geometry::bundle::{Boxes, Bundle, Floats, Hull, LaneHits, RaySet, TriangleLanes};
use crate::geometry::triangle::{LANES, corners_of, take_lowest};
use crate::math::simd::{Simd, SimdBase, SimdMask, f32x8};

/// What a traversal is for; knows each ray's state.
pub(super) trait Query {
    /// Whether some rays may be done long before others.
    const ENDS_EARLY: bool;
    /// The distance beyond which a ray takes no interest; negative when it is done.
    fn limits(&self) -> &Floats;
    /// Rays of a group meet a triangle between two distances: which of those in `mask` must be told where. For the others
    /// that changes nothing, or is enough and noted.
    fn expect<S: Simd>(
        &mut self,
        simd: S,
        group: usize,
        between: (S::f32s, S::f32s),
        mask: S::mask32s,
    ) -> S::mask32s;
    /// Considers where the rays of a group meet a triangle.
    fn offer<S: Simd>(&mut self, simd: S, group: usize, prim: u32, hits: LaneHits<S>);
}

/// Triangles that a bundle may test for each of its rays before it is taken apart.
const PATIENCE: usize = 6;
/// The same where rays are done at their first hit, so that fewer and fewer share the cost.
const PATIENCE_FOR_ANY: usize = 3;

impl Bvh {
    /// Offers the query what it may want, roughly from front to back (from back to front for rays that
    /// converge).
    ///
    /// Says whether it got to the end. It gives up when the rays turn out to have little in common.
    #[inline(always)]
    pub(super) fn traverse_bundle<S: Simd>(
        &self,
        simd: S,
        rays: &mut Bundle,
        mut hull: Hull,
        stack: &mut Stack,
        query: &mut impl Query,
    ) -> bool {
        let mut patience = patience_of(query) * rays.count();
        let (mut limit, _) = farthest(simd, rays, query);
        let mut next = self.root;
        stack.clear();
        loop {
            match next.unpack() {
                Child::Node(index) => {
                    let node = &self.nodes[index];
                    let (mask, near) = hull.hit_lanes(simd, &boxes_of_node(simd, node), limit);
                    if let Some(child) = push_sorted(stack, node, mask, &near) {
                        next = child;
                        continue;
                    }
                }
                Child::Block(index) => {
                    if let Some(block) = self.blocks.get(index) {
                        let tested = visit_block(simd, rays, &hull, (block, limit), query);
                        let left;
                        (limit, left) = farthest(simd, rays, query);
                        if patience < tested && limit >= 0.0 {
                            return false;
                        }
                        patience -= tested.min(patience);
                        if left != 0 && 2 * left.count_ones() as usize <= rays.count() {
                            hull = rays.narrow(simd, left, self.reach);
                        }
                    }
                }
            }
            next = loop {
                match stack.pop() {
                    Some(entry) if entry.near <= limit => break entry.child,
                    Some(_) => {}
                    None => return true,
                }
            };
        }
    }
}

/// How many triangles for each ray.
#[inline(always)]
const fn patience_of<Q: Query>(_: &Q) -> usize {
    if Q::ENDS_EARLY {
        PATIENCE_FOR_ANY
    } else {
        PATIENCE
    }
}

/// Offers the hits on a block's triangles; returns how many triangles were tested.
#[inline(always)]
fn visit_block<S: Simd>(
    simd: S,
    rays: &Bundle,
    hull: &Hull,
    (block, limit): (&Block, f32),
    query: &mut impl Query,
) -> usize {
    let (mut mask, near) = hull.hit_lanes(simd, &boxes_of_block(simd, block), limit);
    let tested = mask.count_ones() as usize;
    while mask != 0 {
        let lane = take_lowest(&mut mask);
        let prim = block.prims[lane];
        if prim == NO_PRIM {
            continue;
        }
        let corners = corners_of(&block.corners, lane);
        let triangle = TriangleLanes::new(simd, rays, hull.common_origin, corners);
        let near = S::f32s::splat(simd, near[lane]);
        for group in rays.groups::<S>() {
            let limits = query.limits().load(simd, group);
            let wanted = limits.simd_ge(near).to_bitmask() & !rays.leaving(simd, group, prim);
            if wanted == 0 {
                continue;
            }
            let mask = triangle.pass(rays, group, wanted);
            if mask == 0 {
                continue;
            }
            let (between, mask) = triangle.reach(rays, group, mask);
            let mask = query.expect(simd, group, between, mask);
            if mask.any_true() {
                let hits = triangle.locate(rays, group, between, mask);
                query.offer(simd, group, prim, hits);
            }
        }
    }
    tested
}

/// The largest limit of all rays, and those that are not done where that may change.
#[inline(always)]
fn farthest<S: Simd, Q: Query>(simd: S, rays: &Bundle, query: &Q) -> (f32, RaySet) {
    let (zero, mut most) = (
        S::f32s::splat(simd, 0.0),
        S::f32s::splat(simd, f32::NEG_INFINITY),
    );
    let mut left = 0;
    for group in rays.groups::<S>() {
        let limits = query.limits().load(simd, group);
        most = most.max(limits);
        if Q::ENDS_EARLY {
            left |= limits.simd_ge(zero).to_bitmask() << (group * S::f32s::LEN);
        }
    }
    (most.reduce_max(), left)
}

#[inline(always)]
fn boxes_of_node<S: Simd>(simd: S, node: &Node) -> Boxes<S> {
    let load = |plane: &[f32; LANES]| f32x8::from_slice(simd, plane);
    let [x, y, z] = &node.planes;
    [
        [load(&x[0]), load(&y[0]), load(&z[0])],
        [load(&x[1]), load(&y[1]), load(&z[1])],
    ]
}

/// The box of each triangle.
#[inline(always)]
fn boxes_of_block<S: Simd>(simd: S, block: &Block) -> Boxes<S> {
    let [a, b, c] = &block.corners;
    let mut boxes = [[f32x8::splat(simd, 0.0); 3]; 2];
    for axis in 0..3 {
        let a = f32x8::from_slice(simd, &a[axis]);
        let b = f32x8::from_slice(simd, &b[axis]);
        let c = f32x8::from_slice(simd, &c[axis]);
        boxes[0][axis] = a.min(b).min(c);
        boxes[1][axis] = a.max(b).max(c);
    }
    boxes
}
