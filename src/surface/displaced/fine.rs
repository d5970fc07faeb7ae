//! A displaced triangle cut into micro-triangles, none of which is stored.
//!
//! A triangle of `2^k` segments falls into sixteen of `2^(k−2)`, and so on down to four segments, whose
//! sixteen micro-triangles are made on the spot. The boxes of sixteen parts are made when a ray first comes by, those
//! that it meets are narrowed to their own heights, and all are kept as long as there is room: a part with heights in
//! `[low, high]` lies in the hull of its corners at both.

use glam::{Vec2, Vec3};

use super::nodes::{Node, NodeCache, PARTS, Row};
use super::trace::SurfaceHit;
use super::{Displacement, Reliefs, seams};
use crate::geometry::triangle::{Corners8, LANES, TriangleTest as _, Watertight};
use crate::geometry::{Ray, RaySlabs, TriangleMesh};
use crate::math::lanes::ones;
use crate::math::simd::{Simd, SimdBase as _};
use crate::math::{Real as _, V2, gamma};
use crate::surface::mapping::relief::ReliefField;

/// Anchor and signed size of the sixteen parts of a triangle with four segments: corners
/// `(a, b)`, `(a + s, b)`, `(a, b + s)`. A negative size is a triangle turned by half a turn.
const CUT: [[i32; 3]; PARTS] = cut();

const fn cut() -> [[i32; 3]; PARTS] {
    let quarters = [[0, 0, 2], [2, 0, 2], [0, 2, 2], [2, 2, -2]];
    let mut parts = [[0; 3]; PARTS];
    let mut i = 0;
    while i < 4 {
        let [a, b, s] = quarters[i];
        let h = s / 2;
        parts[4 * i] = [a, b, h];
        parts[4 * i + 1] = [a + h, b, h];
        parts[4 * i + 2] = [a, b + h, h];
        parts[4 * i + 3] = [a + h, b + h, -h];
        i += 1;
    }
    parts
}

/// Vertices of a triangle with four segments.
const VERTICES: usize = 15;

/// Their places, row by row.
const GRID: [[i32; 2]; VERTICES] = grid();

const fn grid() -> [[i32; 2]; VERTICES] {
    let mut places = [[0; 2]; VERTICES];
    let (mut i, mut b) = (0, 0);
    while b <= 4 {
        let mut a = 0;
        while a <= 4 - b {
            places[i] = [a, b];
            i += 1;
            a += 1;
        }
        b += 1;
    }
    places
}

/// Index in [`GRID`].
const fn vertex(a: i32, b: i32) -> usize {
    (a + b * 5 - b * (b - 1) / 2) as usize
}

/// A displaced triangle, its corners in an order that its neighbours share.
#[derive(Debug, Clone, Copy)]
pub struct Patch<'a, 'm> {
    prim: u32,
    field: &'a ReliefField<'m>,
    /// Which corner of the triangle each is.
    order: [usize; 3],
    p: [Vec3; 3],
    n: [Vec3; 3],
    uv: [Vec2; 3],
    cut: Cut,
}

/// How a triangle is cut up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cut {
    /// Every edge falls into 2 to the power of this segments; at least 2.
    pub segments_log2: u8,
    /// Whether a corner lies on a seam.
    pub on_seam: bool,
}

/// A ray made ready for all patches.
#[derive(Debug)]
pub struct FineRay {
    test: Watertight,
    slabs: RaySlabs,
}

impl FineRay {
    pub fn new(ray: &Ray, reach: f32) -> Self {
        Self {
            test: Watertight::new(ray),
            slabs: RaySlabs::new(ray, reach),
        }
    }
}

/// A part still to be looked at.
#[derive(Debug, Clone, Copy)]
struct Part {
    a: i32,
    b: i32,
    size: i32,
    /// Displacements within; means nothing for those that are made into micro-triangles next.
    range: [f32; 2],
    /// Where the ray enters its box.
    near: f32,
}

impl<'a, 'm> Patch<'a, 'm> {
    /// `None` for a triangle without a relief.
    #[inline]
    pub fn new(
        mesh: &TriangleMesh,
        reliefs: &Reliefs<'a, 'm>,
        displacement: &Displacement,
        (prim, cut): (u32, Cut),
    ) -> Option<Self> {
        let material = usize::from(mesh.attributes[prim as usize].material);
        let field = reliefs.fields.get(material)?.as_ref()?;
        let vertices = mesh.indices[prim as usize];
        let corners = mesh.corners(prim);
        let mut order = [0, 1, 2];
        // By place: both triangles at an edge weigh its ends in the same order, so that their vertices there
        // have the same bits.
        let key = |k: &usize| corners[*k].to_array();
        order.sort_by(|a, b| {
            let (a, b) = (key(a), key(b));
            a.partial_cmp(&b).unwrap_or(std::cmp::Ordering::Equal)
        });
        let p = order.map(|k| corners[k]);
        let n = order.map(|k| displacement.normals[vertices[k] as usize]);
        let uv = order.map(|k| mesh.uvs[vertices[k] as usize]);
        Some(Self {
            prim,
            field,
            order,
            p,
            n,
            uv,
            cut,
        })
    }

    /// Smallest and largest displacement in a part.
    fn range_of(&self, reliefs: &Reliefs<'_, '_>, [a, b, size]: [i32; 3]) -> [f32; 2] {
        let segments = 1 << self.cut.segments_log2;
        // On a seam's edge heights are means with what lies on its other side.
        let touches = |a: i32, b: i32, size: i32| {
            let sums = [a + b, a + b + size];
            a.min(a + size) == 0 || b.min(b + size) == 0 || sums.contains(&segments)
        };
        if self.cut.on_seam && touches(a, b, size) {
            return seams::range(reliefs).map(|d| d as f32);
        }
        let per_segment = 1.0 / f64::from(segments);
        let place = |a: i32, b: i32| {
            let [w1, w2] = [a, b].map(|i| f64::from(i) * per_segment);
            let uv = |k: usize| {
                let [t0, t1, t2] = self.uv.map(|uv| f64::from(uv.to_array()[k]));
                t0 + (t1 - t0) * w1 + (t2 - t0) * w2
            };
            self.field.texels_from_uv([uv(0), uv(1)])
        };
        let places = [place(a, b), place(a + size, b), place(a, b + size)];
        let [low, high] = self.field.range_near(places);
        // Heights are made in f32.
        let margin = (low.abs().max(high.abs()) * 1e-6) as f32;
        [low as f32 - margin, high as f32 + margin]
    }

    /// The sixteenths of a part in boxes that hold all heights of the whole part.
    #[inline(always)]
    fn node<S: Simd>(&self, simd: S, door: Door<'_, '_>, part: &Part) -> Node {
        let quarter = part.size / 4;
        let per_segment = 1.0 / (1 << self.cut.segments_log2) as f32;
        let mut places = [Row::splat(0.0); 3];
        for (i, [a, b, s]) in CUT.into_iter().enumerate() {
            places[0].0[i] = (part.a + a * quarter) as f32 * per_segment;
            places[1].0[i] = (part.b + b * quarter) as f32 * per_segment;
            places[2].0[i] = (s * quarter) as f32 * per_segment;
        }
        let margin = margin(door);
        let [low, high] = part.range;
        let mut boxes = [[Row::splat(0.0); 2]; 3];
        for group in 0..PARTS / S::f32s::LEN {
            let [a, b, s] = [0, 1, 2].map(|k| places[k].get(simd, group));
            let one = a.splat(1.0);
            for axis in 0..3 {
                let (p, n) = (self.p.map(|p| p[axis]), self.n.map(|n| n[axis]));
                let mut least = one.splat(f32::INFINITY);
                let mut most = one.splat(f32::NEG_INFINITY);
                for [w1, w2] in [[a, b], [a + s, b], [a, b + s]] {
                    let w = [one - w1 - w2, w1, w2];
                    let (p, n) = (sum(w, p), sum(w, n));
                    let (x, y) = (p + n * low, p + n * high);
                    least = least.smaller(x).smaller(y);
                    most = most.larger(x).larger(y);
                }
                boxes[axis][0].set(group, least - margin);
                boxes[axis][1].set(group, most + margin);
            }
        }
        Node {
            boxes,
            ranges: [low, high].map(Row::splat),
            refined: 0,
        }
    }

    /// Gives one of the sixteenths of a part the box of its own heights.
    #[inline(always)]
    fn refine<S: Simd>(&self, simd: S, door: Door<'_, '_>, part: &Part, i: usize, node: &mut Node) {
        let quarter = part.size / 4;
        let [a, b, s] = CUT[i].map(|x| x * quarter);
        let [a, b, s] = [part.a + a, part.b + b, s];
        if s.abs() == 4 {
            let points = self.leaf_points(simd, door, [a, b, s]);
            for (axis, row) in points.iter().enumerate() {
                let [low, high] = extremes(&row.0);
                node.boxes[axis][0].0[i] = low;
                node.boxes[axis][1].0[i] = high;
            }
            return;
        }
        let [low, high] = self.range_of(door.0, [a, b, s]);
        // Within those of the whole, so that what is met does not depend on what was refined before.
        let range = [low.max(part.range[0]), high.min(part.range[1])];
        for (row, d) in node.ranges.iter_mut().zip(range) {
            row.0[i] = d;
        }
        let per_segment = 1.0 / (1 << self.cut.segments_log2) as f32;
        let margin = margin(door);
        for axis in 0..3 {
            let (p, n) = (self.p.map(|p| p[axis]), self.n.map(|n| n[axis]));
            let (mut least, mut most) = (f32::INFINITY, f32::NEG_INFINITY);
            for [a, b] in [[a, b], [a + s, b], [a, b + s]] {
                let (w1, w2) = (a as f32 * per_segment, b as f32 * per_segment);
                let w = [1.0 - w1 - w2, w1, w2];
                let (p, n) = (sum(w, p), sum(w, n));
                for d in range {
                    least = least.min(p + n * d);
                    most = most.max(p + n * d);
                }
            }
            node.boxes[axis][0].0[i] = least - margin;
            node.boxes[axis][1].0[i] = most + margin;
        }
    }

    /// Makes the sixteen micro-triangles of a part with four segments and tests them.
    #[inline(always)]
    fn meet_leaf<S: Simd>(
        &self,
        simd: S,
        door: Door<'_, '_>,
        ray: &FineRay,
        part: &Part,
        best: &mut Best,
    ) {
        let quarter = part.size / 4;
        let points = self.leaf_points(simd, door, [part.a, part.b, part.size]);
        let mut corners: [Corners8; 2] = [[[[0.0; LANES]; 3]; 3]; 2];
        for (i, [a, b, s]) in CUT.into_iter().enumerate() {
            let triangle = [vertex(a, b), vertex(a + s, b), vertex(a, b + s)];
            for (k, index) in triangle.into_iter().enumerate() {
                for axis in 0..3 {
                    corners[i / LANES][k][axis][i % LANES] = points[axis].0[index];
                }
            }
        }
        for (block, corners) in corners.iter().enumerate() {
            ray.test.intersect_block(&ray.slabs, corners, |lane, hit| {
                let [a, b, s] = CUT[(block * LANES + lane) % PARTS].map(|x| x * quarter);
                let key = (self.prim, [part.a + a, part.b + b, s]);
                let wins_tie = hit.t == best.t && best.hit.is_some_and(|known| key < known.key);
                if hit.t < best.t || wins_tie {
                    let corner = |k: usize| {
                        let [x, y, z] = corners[k].map(|axis| axis[lane]);
                        Vec3::new(x, y, z)
                    };
                    best.t = hit.t;
                    best.hit = Some(MicroHit {
                        key,
                        corners: [corner(0), corner(1), corner(2)],
                        weights: [hit.u, hit.v],
                    });
                }
                false
            });
        }
    }

    /// Positions of the vertices of a part with four segments.
    #[inline(always)]
    fn leaf_points<S: Simd>(&self, simd: S, door: Door<'_, '_>, [a0, b0, s]: [i32; 3]) -> [Row; 3] {
        let quarter = s / 4;
        let per_segment = 1.0 / (1 << self.cut.segments_log2) as f32;
        let mut weights = [Row::splat(0.0); 2];
        for (i, [a, b]) in GRID.into_iter().enumerate() {
            weights[0].0[i] = (a0 + a * quarter) as f32 * per_segment;
            weights[1].0[i] = (b0 + b * quarter) as f32 * per_segment;
        }
        // The place that is left over repeats the last vertex.
        for row in &mut weights {
            row.0[VERTICES] = row.0[VERTICES - 1];
        }
        let mut points = [Row::splat(0.0); 3];
        for group in 0..PARTS / S::f32s::LEN {
            let (w1, w2) = (weights[0].get(simd, group), weights[1].get(simd, group));
            let w0 = w1.splat(1.0) - w1 - w2;
            let uv = V2::new(
                sum([w0, w1, w2], self.uv.map(|uv| uv.x)),
                sum([w0, w1, w2], self.uv.map(|uv| uv.y)),
            );
            let d = self.field.height.displacement(uv);
            for (axis, row) in points.iter_mut().enumerate() {
                let p = sum([w0, w1, w2], self.p.map(|p| p[axis]));
                let n = sum([w0, w1, w2], self.n.map(|n| n[axis]));
                row.set(group, p + n * d);
            }
        }
        if self.cut.on_seam {
            self.mend(door, &weights, &mut points);
        }
        points
    }

    /// Puts the vertices on seams where both sides agree.
    #[inline(never)]
    fn mend(
        &self,
        (reliefs, displacement): Door<'_, '_>,
        weights: &[Row; 2],
        points: &mut [Row; 3],
    ) {
        for i in 0..VERTICES {
            let (w1, w2) = (weights[0].0[i], weights[1].0[i]);
            let w = [1.0 - w1 - w2, w1, w2];
            if !w.contains(&0.0) {
                continue;
            }
            let mut by_corner = [0.0; 3];
            for k in 0..3 {
                by_corner[self.order[k]] = w[k];
            }
            if let Some(d) = displacement
                .seams
                .displacement(reliefs, self.prim, by_corner)
            {
                for (axis, row) in points.iter_mut().enumerate() {
                    let p = sum(w, self.p.map(|p| p[axis]));
                    let n = sum(w, self.n.map(|n| n[axis]));
                    row.0[i] = p + n * d;
                }
            }
        }
    }

    /// Everything about a hit on this patch.
    pub fn hit(&self, t: f32, micro: &MicroHit) -> SurfaceHit {
        let [v0, v1, v2] = micro.corners;
        let [u, v] = micro.weights;
        let parts = [v0 * (1.0 - u - v), v1 * u, v2 * v];
        let p = parts[0] + parts[1] + parts[2];
        let error = (parts[0].abs() + parts[1].abs() + parts[2].abs()) * gamma(7);
        let normal = (v1 - v0).as_dvec3().cross((v2 - v0).as_dvec3());
        // The side of the winding that is the front.
        let winding = (self.p[1] - self.p[0]).cross(self.p[2] - self.p[0]);
        let front = if winding.dot(self.n[0] + self.n[1] + self.n[2]) < 0.0 {
            -1.0
        } else {
            1.0
        };
        let normal = (normal.normalize_or_zero() * front).as_vec3();
        let [a, b, size] = micro.key.1.map(|i| i as f32);
        let per_segment = 1.0 / (1 << self.cut.segments_log2) as f32;
        let (w1, w2) = ((a + size * u) * per_segment, (b + size * v) * per_segment);
        let mut weights = [0.0; 3];
        for (k, w) in [1.0 - w1 - w2, w1, w2].into_iter().enumerate() {
            weights[self.order[k]] = w;
        }
        SurfaceHit {
            t,
            prim: self.prim,
            weights: [weights[1], weights[2]],
            p,
            bound: error.dot(normal.abs()),
            normal,
        }
    }
}

/// Parts on the way: sixteen for each of the seven levels at the most, and those that wait.
const STACK: usize = 16 * 8;

/// The nearest hit so far.
#[derive(Debug, Clone, Copy)]
pub struct Best {
    /// Its distance; before the first, the end of the ray.
    pub t: f32,
    /// What was hit.
    pub hit: Option<MicroHit>,
}

/// A micro-triangle that was hit.
#[derive(Debug, Clone, Copy)]
pub struct MicroHit {
    /// Triangle, and anchor and size of the micro-triangle in it: of two at the same distance the lower
    /// wins.
    pub key: (u32, [i32; 3]),
    corners: [Vec3; 3],
    weights: [f32; 2],
}

/// What tracing cost.
#[derive(Debug, Clone, Copy, Default)]
pub struct FineCounters {
    /// Boxes of sixteen parts looked at.
    pub parts: u64,
    /// Parts whose micro-triangles were made.
    pub leaves: u64,
}

/// Everything around a patch.
pub type Door<'a, 'm> = (&'a Reliefs<'a, 'm>, &'a Displacement);

/// Meets patches one after the other.
pub struct Meeting<'a, 'm, 'c> {
    /// What they are parts of.
    pub mesh: &'a TriangleMesh,
    /// What is laid on it.
    pub door: Door<'a, 'm>,
    /// Displacements that no patch leaves.
    pub range: [f32; 2],
    /// Boxes seen so far.
    pub nodes: &'c mut NodeCache,
    /// Bytes that they may take.
    pub budget: usize,
    /// What it cost.
    pub counters: FineCounters,
}

impl Meeting<'_, '_, '_> {
    /// The hit on a triangle before `best`, if it is nearer; with `any`, whatever comes first.
    #[inline(always)]
    pub fn meet<S: Simd>(
        &mut self,
        simd: S,
        (prim, cut): (u32, Cut),
        ray: &FineRay,
        (mut best, any): (Best, bool),
    ) -> Best {
        let (reliefs, displacement) = self.door;
        let make = || Patch::new(self.mesh, reliefs, displacement, (prim, cut));
        let mut patch = None;
        let mut stack = [Part::NONE; STACK];
        let mut depth = start(cut, self.range, &mut stack);
        while depth > 0 {
            depth -= 1;
            let part = stack[depth];
            if part.near > best.t {
                continue;
            }
            if part.size.abs() == 4 {
                self.counters.leaves += 1;
                if patch.is_none() {
                    patch = make();
                }
                let Some(patch) = &patch else { return best };
                patch.meet_leaf(simd, self.door, ray, &part, &mut best);
                if any && best.hit.is_some() {
                    return best;
                }
                continue;
            }
            self.counters.parts += 1;
            let key = (prim, [part.a, part.b, part.size]);
            let door = self.door;
            let index = if let Some(index) = self.nodes.find(key) {
                index
            } else {
                if patch.is_none() {
                    patch = make();
                }
                let Some(patch) = &patch else { return best };
                let node = patch.node(simd, door, &part);
                self.nodes.put(key, &node, self.budget)
            };
            let node = self.nodes.at(index);
            let mut near = Row::splat(0.0);
            let mut met = ray.slabs.meets(simd, &node.boxes, best.t, &mut near);
            let rough = met & !node.refined;
            if rough != 0 {
                if patch.is_none() {
                    patch = make();
                }
                let Some(patch) = &patch else { return best };
                for i in ones(rough) {
                    patch.refine(simd, door, &part, i % PARTS, node);
                }
                node.refined |= rough;
                met &= ray.slabs.meets(simd, &node.boxes, best.t, &mut near);
            }
            let first = depth;
            let quarter = part.size / 4;
            for i in ones(met) {
                let i = i % PARTS;
                let [a, b, s] = CUT[i].map(|x| x * quarter);
                let child = Part {
                    a: part.a + a,
                    b: part.b + b,
                    size: s,
                    range: [node.ranges[0].0[i], node.ranges[1].0[i]],
                    near: near.0[i],
                };
                let mut at = depth;
                while at > first && stack[at - 1].near < child.near {
                    stack[at] = stack[at - 1];
                    at -= 1;
                }
                stack[at] = child;
                depth += 1;
            }
        }
        best
    }
}

impl Part {
    const NONE: Self = Self {
        a: 0,
        b: 0,
        size: 0,
        range: [0.0; 2],
        near: f32::NEG_INFINITY,
    };
}

/// Puts the whole triangle on the stack, or its quarters if it would not fall into sixteenths down to four segments;
/// returns the stack's depth.
#[inline(always)]
fn start(cut: Cut, range: [f32; 2], stack: &mut [Part; STACK]) -> usize {
    let size = 1 << cut.segments_log2;
    let part = |[a, b, size]: [i32; 3]| Part {
        a,
        b,
        size,
        range,
        ..Part::NONE
    };
    if cut.segments_log2.is_multiple_of(2) {
        stack[0] = part([0, 0, size]);
        return 1;
    }
    let h = size / 2;
    stack[0] = part([0, 0, h]);
    stack[1] = part([h, 0, h]);
    stack[2] = part([0, h, h]);
    stack[3] = part([h, h, -h]);
    4
}

/// What rounding may do to a corner of a box, here and where vertices are made: sums of numbers of at most this size.
#[inline(always)]
fn margin((_, displacement): Door<'_, '_>) -> f32 {
    displacement.tree.reach() * (16.0 * f32::EPSILON)
}

/// The smallest and the largest of numbers that are not NaN, by halves, as vectors do it.
#[inline(always)]
fn extremes(row: &[f32; PARTS]) -> [f32; 2] {
    let (mut low, mut high) = (*row, *row);
    let mut half = PARTS / 2;
    while half > 0 {
        for i in 0..half {
            let (a, b) = (low[i + half], high[i + half]);
            low[i] = if a < low[i] { a } else { low[i] };
            high[i] = if b > high[i] { b } else { high[i] };
        }
        half /= 2;
    }
    [low[0], high[0]]
}

/// `w0·x0 + w1·x1 + w2·x2`, in this order.
#[inline(always)]
fn sum<F: crate::math::Real>([w0, w1, w2]: [F; 3], [x0, x1, x2]: [f32; 3]) -> F {
    w0 * x0 + w1 * x1 + w2 * x2
}
