//! A displaced triangle cut into micro-triangles, none of which is stored.
//!
//! A triangle of `2^k` segments falls into sixteen of `2^(k−2)`, and so on down to four segments, whose
//! sixteen micro-triangles are made on the spot. What is between has no boxes either: a part with heights
//! in `[low, high]` lies in the hull of its corners at both, and a ray sees from its own axes whether it
//! passes that.

use glam::{Vec2, Vec3};

use super::ranges::{RangeCache, Ranges};
use super::trace::SurfaceHit;
use super::{Displacement, Reliefs, seams};
use crate::geometry::triangle::{Corners8, LANES, TriangleTest as _, Watertight};
use crate::geometry::{Ray, RaySlabs, TriangleMesh};
use crate::math::lanes::{Lanes, ones};
use crate::math::simd::{Simd, SimdBase as _, SimdMask as _};
use crate::math::wide::Wide;
use crate::math::{Real as _, V2, gamma};
use crate::surface::mapping::relief::ReliefField;

/// Parts that a part falls into.
const PARTS: usize = 16;

/// A number for each part or each vertex of a leaf.
type Row = Lanes<f32, PARTS>;

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
    segments_log2: u8,
    on_seam: bool,
    /// The side of the micro-triangles' winding that is the front.
    front: f32,
    range: [f32; 2],
}

/// A ray made ready for all patches.
#[derive(Debug)]
pub struct FineRay {
    pub ray: Ray,
    test: Watertight,
    slabs: RaySlabs,
    /// Axes with that of the largest direction last, and the shear that lays the ray along it.
    axes: [usize; 3],
    shear: [f32; 2],
    inv_along: f32,
    /// What rounding may move a point across the ray.
    margin: f32,
}

impl FineRay {
    pub fn new(ray: &Ray, reach: f32) -> Self {
        let dir = ray.dir.to_array();
        let size = ray.dir.abs().to_array();
        let along = if size[0] > size[1] && size[0] > size[2] {
            0
        } else if size[1] > size[2] {
            1
        } else {
            2
        };
        let axes = [(along + 1) % 3, (along + 2) % 3, along];
        let inv_along = 1.0 / dir[along];
        // Corners, their translation, the shear, three weighed sums and the displacement: each rounds
        // numbers of at most twice this size.
        let size = reach + ray.origin.abs().max_element();
        Self {
            ray: *ray,
            test: Watertight::new(ray),
            slabs: RaySlabs::new(ray, reach),
            axes,
            shear: [dir[axes[0]] * inv_along, dir[axes[1]] * inv_along],
            inv_along,
            margin: size * (64.0 * f32::EPSILON),
        }
    }

    /// A direction on the ray's own axes; the last counts along the ray, in distances.
    #[inline(always)]
    fn turned(&self, v: Vec3) -> [f32; 3] {
        let v = v.to_array();
        let z = v[self.axes[2]];
        [
            v[self.axes[0]] - self.shear[0] * z,
            v[self.axes[1]] - self.shear[1] * z,
            z * self.inv_along,
        ]
    }
}

/// A patch as a ray sees it: corners and normals on the ray's axes.
struct Seen {
    p: [[f32; 3]; 3],
    n: [[f32; 3]; 3],
}

/// A part still to be looked at.
#[derive(Debug, Clone, Copy)]
struct Part {
    a: i32,
    b: i32,
    size: i32,
    /// Displacements within.
    range: [f32; 2],
    /// Where the ray may first meet it.
    near: f32,
}

impl<'a, 'm> Patch<'a, 'm> {
    /// `None` for a triangle without a relief.
    #[inline]
    pub fn new(
        mesh: &TriangleMesh,
        reliefs: &Reliefs<'a, 'm>,
        displacement: &Displacement,
        (prim, segments_log2): (u32, u8),
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
        let winding = (p[1] - p[0]).cross(p[2] - p[0]);
        let front = if winding.dot(n[0] + n[1] + n[2]) < 0.0 {
            -1.0
        } else {
            1.0
        };
        let on_seam = displacement.seams.touches(prim);
        let mut patch = Self {
            prim,
            field,
            order,
            p,
            n,
            uv,
            segments_log2,
            on_seam,
            front,
            range: seams::range(reliefs).map(|d| d as f32),
        };
        if !on_seam {
            let segments = 1 << segments_log2;
            patch.range = patch.range_of([0, 0, segments]);
        }
        Some(patch)
    }

    /// Smallest and largest displacement in a part.
    #[inline]
    fn range_of(&self, [a, b, size]: [i32; 3]) -> [f32; 2] {
        let segments = 1 << self.segments_log2;
        // On a seam's edge heights are means with what lies on its other side.
        let touches = |a: i32, b: i32, size: i32| {
            let sums = [a + b, a + b + size];
            a.min(a + size) == 0 || b.min(b + size) == 0 || sums.contains(&segments)
        };
        if self.on_seam && touches(a, b, size) {
            return self.range;
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

    /// The hit before `best`, if it is nearer; with `any`, whatever comes first.
    #[inline(always)]
    pub fn meet<S: Simd>(
        &self,
        simd: S,
        (reliefs, displacement): (&Reliefs<'_, '_>, &Displacement),
        ray: &FineRay,
        (mut best, any): (Best, bool),
        (ranges, counters): (&mut RangeCache, &mut FineCounters),
    ) -> Best {
        let origin = ray.ray.origin;
        let seen = Seen {
            p: [
                ray.turned(self.p[0] - origin),
                ray.turned(self.p[1] - origin),
                ray.turned(self.p[2] - origin),
            ],
            n: [
                ray.turned(self.n[0]),
                ray.turned(self.n[1]),
                ray.turned(self.n[2]),
            ],
        };
        let mut stack = [Part {
            a: 0,
            b: 0,
            size: 0,
            range: [0.0; 2],
            near: 0.0,
        }; STACK];
        let mut depth = self.start(&mut stack);
        while depth > 0 {
            depth -= 1;
            let part = stack[depth];
            if part.near > best.t {
                continue;
            }
            if part.size.abs() == 4 {
                counters.leaves += 1;
                self.meet_leaf(simd, (reliefs, displacement), ray, &part, &mut best);
                if any && best.hit.is_some() {
                    return best;
                }
                continue;
            }
            counters.parts += 1;
            let known = ranges.entry((self.prim, [part.a, part.b, part.size]));
            let seen = (&seen, &part, known);
            depth = self.open(simd, ray, seen, best.t, (&mut stack, depth));
        }
        best
    }

    /// Puts the whole triangle on the stack, or its quarters if it would not fall into sixteenths down to
    /// four segments; returns the stack's depth.
    #[inline(always)]
    fn start(&self, stack: &mut [Part; STACK]) -> usize {
        let size = 1 << self.segments_log2;
        let part = |[a, b, size]: [i32; 3]| Part {
            a,
            b,
            size,
            range: self.range,
            near: f32::NEG_INFINITY,
        };
        if self.segments_log2.is_multiple_of(2) {
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

    /// Puts those sixteenths of a part that the ray may meet on the stack, the nearest on top; returns its
    /// new depth.
    #[inline(always)]
    fn open<S: Simd>(
        &self,
        simd: S,
        ray: &FineRay,
        (seen, part, known): (&Seen, &Part, &mut Ranges),
        t_max: f32,
        (stack, mut depth): (&mut [Part; STACK], usize),
    ) -> usize {
        let quarter = part.size / 4;
        let per_segment = 1.0 / (1 << self.segments_log2) as f32;
        let (mut low, mut high) = (Row::splat(part.range[0]), Row::splat(part.range[1]));
        let mut places = [Row::splat(0.0); 3];
        for (i, [a, b, s]) in CUT.into_iter().enumerate() {
            places[0].0[i] = (part.a + a * quarter) as f32 * per_segment;
            places[1].0[i] = (part.b + b * quarter) as f32 * per_segment;
            places[2].0[i] = (s * quarter) as f32 * per_segment;
        }
        let mut near = Row::splat(0.0);
        let coarse = meets(simd, ray, seen, &places, [&low, &high], t_max, &mut near);
        if coarse == 0 {
            return depth;
        }
        for i in ones(coarse) {
            let i = i % PARTS;
            if known[i][0].is_nan() {
                let [a, b, s] = CUT[i].map(|x| x * quarter);
                known[i] = self.range_of([part.a + a, part.b + b, s]);
            }
            [low.0[i], high.0[i]] = known[i];
        }
        let met = coarse & meets(simd, ray, seen, &places, [&low, &high], t_max, &mut near);
        let first = depth;
        for i in ones(met) {
            let i = i % PARTS;
            let [a, b, s] = CUT[i].map(|x| x * quarter);
            let child = Part {
                a: part.a + a,
                b: part.b + b,
                size: s,
                range: [low.0[i], high.0[i]],
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
        depth
    }

    /// Makes the sixteen micro-triangles of a part with four segments and tests them.
    #[inline(always)]
    fn meet_leaf<S: Simd>(
        &self,
        simd: S,
        (reliefs, displacement): (&Reliefs<'_, '_>, &Displacement),
        ray: &FineRay,
        part: &Part,
        best: &mut Best,
    ) {
        let quarter = part.size / 4;
        let points = self.leaf_points(simd, (reliefs, displacement), part);
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
    fn leaf_points<S: Simd>(
        &self,
        simd: S,
        (reliefs, displacement): (&Reliefs<'_, '_>, &Displacement),
        part: &Part,
    ) -> [Row; 3] {
        let quarter = part.size / 4;
        let per_segment = 1.0 / (1 << self.segments_log2) as f32;
        let mut weights = [Row::splat(0.0); 2];
        for (i, [a, b]) in GRID.into_iter().enumerate() {
            weights[0].0[i] = (part.a + a * quarter) as f32 * per_segment;
            weights[1].0[i] = (part.b + b * quarter) as f32 * per_segment;
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
        if self.on_seam {
            self.mend(reliefs, displacement, &weights, &mut points);
        }
        points
    }

    /// Puts the vertices on seams where both sides agree.
    #[inline(never)]
    fn mend(
        &self,
        reliefs: &Reliefs<'_, '_>,
        displacement: &Displacement,
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
        let normal = (normal.normalize_or_zero() * f64::from(self.front)).as_vec3();
        let [a, b, size] = micro.key.1.map(|i| i as f32);
        let per_segment = 1.0 / (1 << self.segments_log2) as f32;
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
    /// Parts cut up.
    pub parts: u64,
    /// Parts whose micro-triangles were made.
    pub leaves: u64,
}

/// `w0·x0 + w1·x1 + w2·x2`, in this order.
#[inline(always)]
fn sum<F: crate::math::Real>([w0, w1, w2]: [F; 3], [x0, x1, x2]: [f32; 3]) -> F {
    w0 * x0 + w1 * x1 + w2 * x2
}

/// Which of sixteen parts the ray may meet before `t_max`, as bits, and from where on.
#[inline(always)]
fn meets<S: Simd>(
    simd: S,
    ray: &FineRay,
    seen: &Seen,
    [a, b, size]: &[Row; 3],
    [low, high]: [&Row; 2],
    t_max: f32,
    near: &mut Row,
) -> u64 {
    let mut bits = 0;
    for group in 0..PARTS / S::f32s::LEN {
        let (a, b, s) = (
            a.get(simd, group),
            b.get(simd, group),
            size.get(simd, group),
        );
        let (low, high) = (low.get(simd, group), high.get(simd, group));
        let one = a.splat(1.0);
        let corners = [[a, b], [a + s, b], [a, b + s]];
        let mut least = [one.splat(f32::INFINITY); 3];
        let mut most = [one.splat(f32::NEG_INFINITY); 3];
        for [w1, w2] in corners {
            let w = [one - w1 - w2, w1, w2];
            for axis in 0..3 {
                let [p0, p1, p2] = seen.p;
                let [n0, n1, n2] = seen.n;
                let p = sum(w, [p0[axis], p1[axis], p2[axis]]);
                let n = sum(w, [n0[axis], n1[axis], n2[axis]]);
                let (x, y) = (p + n * low, p + n * high);
                least[axis] = least[axis].smaller(x).smaller(y);
                most[axis] = most[axis].larger(x).larger(y);
            }
        }
        let margin: Wide<S> = one.splat(ray.margin);
        let zero = one.splat(0.0);
        let across =
            least[0].le(margin) & most[0].ge(-margin) & least[1].le(margin) & most[1].ge(-margin);
        let along = margin * ray.inv_along.abs();
        let first = least[2] - along;
        let met = across & first.le(one.splat(t_max)) & (most[2] + along).ge(zero);
        near.set(group, first);
        bits |= met.0.to_bitmask() << (group * S::f32s::LEN);
    }
    bits
}
