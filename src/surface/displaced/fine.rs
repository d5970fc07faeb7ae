//! A piece of a displaced triangle cut into micro-triangles, none of which is stored.
//!
//! A piece of `2^k` segments falls into sixteen parts of `2^(k−2)`, and so on down to four segments, whose
//! sixteen micro-triangles are made on the spot. So are the bounds of sixteen parts, all at once in vector lanes, in
//! coordinates of the piece's own (`local`). Keeping bounds was tried: they come back from memory no sooner than they
//! are made again, because neighbouring pixels see other parts of a fine map.

use glam::{DVec3, Vec2, Vec3};

use super::cells::PieceCells;
use super::charts::Shape;
use super::local::{LocalFrame, LocalRay};
use super::parts::{CUT, CUTS, Cut, GRID_ROWS, PARTS, Row, TRIANGLES, VERTICES};
use super::pieces::{Piece, WHOLE};
use super::seams::SeamsAround;
use super::trace::SurfaceHit;
use super::{Displacement, Reliefs, seams};
use crate::geometry::triangle::{Corners8, LANES, TriangleTest as _, Watertight};
use crate::geometry::{Ray, RaySlabs, TriangleMesh};
use crate::math::lanes::ones;
use crate::math::simd::{Simd, SimdBase as _, SimdMask as _};
use crate::math::{Real, V2, gamma};
use crate::surface::mapping::relief::ReliefField;

/// Which part of which piece: anchor and signed size in segments.
pub type PartKey = (u32, [i32; 3]);

/// A piece of a displaced triangle, the triangle's corners in an order that its neighbours share.
#[derive(Debug, Clone, Copy)]
pub struct Patch<'a, 'm> {
    /// Index of the piece.
    piece: u32,
    prim: u32,
    field: &'a ReliefField<'m>,
    /// Which corner of the triangle each is.
    order: [usize; 3],
    p: [Vec3; 3],
    n: [Vec3; 3],
    uv: [Vec2; 3],
    /// Weights of the triangle's second and third corner at the piece's first, and their changes to its others.
    frame: [[f32; 2]; 3],
    cut: Cut,
    /// The seams that it may reach.
    seams: Option<SeamsAround<'a>>,
    /// Smallest and largest displacement of the piece.
    range: [f32; 2],
}

/// A ray made ready for all pieces.
#[derive(Debug)]
pub struct FineRay {
    pub ray: Ray,
    /// Larger than any coordinate of the surface and of the ray's origin.
    pub reach: f32,
    test: Watertight,
    slabs: RaySlabs,
}

impl FineRay {
    pub fn new(ray: &Ray, reach: f32) -> Self {
        Self {
            ray: *ray,
            reach: reach + ray.origin.abs().max_element(),
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
    /// Where the ray enters its box.
    near: f32,
}

impl<'a, 'm> Patch<'a, 'm> {
    /// `None` for a piece without a relief, and for one that is flat.
    #[inline]
    pub fn new(
        mesh: &TriangleMesh,
        (reliefs, displacement): Door<'a, 'm>,
        piece: u32,
    ) -> Option<Self> {
        let Piece {
            prim,
            shape,
            order,
            corners,
        } = displacement.pieces[piece as usize];
        let Shape::Fine(cut) = shape else {
            return None;
        };
        let material = usize::from(mesh.attributes[prim as usize].material);
        let field = reliefs.fields.get(material)?.as_ref()?;
        let vertices = mesh.indices[prim as usize];
        let order = order.map(usize::from);
        let p = mesh.corners(prim);
        let [c0, c1, c2] = corners.map(|w| w.map(|w| f32::from(w) / f32::from(WHOLE)));
        let way = |c: [f32; 2]| [c[0] - c0[0], c[1] - c0[1]];
        Some(Self {
            piece,
            prim,
            field,
            order,
            p: order.map(|k| p[k]),
            n: order.map(|k| displacement.normals[vertices[k] as usize]),
            uv: order.map(|k| mesh.uvs[vertices[k] as usize]),
            frame: [c0, way(c1), way(c2)],
            seams: if cut.on_seam {
                displacement.seams.around(prim)
            } else {
                None
            },
            cut,
            range: displacement.ranges[piece as usize],
        })
    }

    /// Weights of the triangle's corners at a place in the piece, given as shares of the ways to its second and third
    /// corner. Nothing is rounded: all are multiples of 2⁻²⁴.
    #[inline(always)]
    fn weights<F: Real>(&self, [a, b]: [F; 2]) -> [F; 3] {
        let [[w1, w2], [to1, to2], [on1, on2]] = self.frame;
        let w1 = a * to1 + b * on1 + w1;
        let w2 = a * to2 + b * on2 + w2;
        [a.splat(1.0) - w1 - w2, w1, w2]
    }

    /// Length of a segment as a share of the piece's edges.
    #[inline(always)]
    fn per_segment(&self) -> f32 {
        1.0 / (1 << self.cut.segments_log2) as f32
    }

    /// Smallest and largest displacements in the sixteen parts of a part, given by anchors and sizes as shares of the
    /// piece's edges; those on seams lie in `seam_range`.
    #[inline(always)]
    fn ranges<F: Real>(&self, seam_range: [f32; 2], [a, b, s]: [F; 3]) -> [F; 2] {
        let corners = [
            self.weights([a, b]),
            self.weights([a + s, b]),
            self.weights([a, b + s]),
        ];
        let [x, y, z] = corners;
        let [mut low, mut high] =
            self.field
                .ranges_near([self.uv_at(x), self.uv_at(y), self.uv_at(z)]);
        if self.cut.on_seam {
            // On a seam's edge heights are means with what lies on its other side.
            let zero = low.splat(0.0);
            let [all_low, all_high] = seam_range;
            for w in corners.into_iter().flatten() {
                low = F::select(w.eq(zero), zero.splat(all_low), low);
                high = F::select(w.eq(zero), zero.splat(all_high), high);
            }
        }
        [low, high]
    }

    /// What belongs to the triangle's corners, at the piece's, in doubles.
    fn at_corners(&self, [c0, c1, c2]: [Vec3; 3]) -> [DVec3; 3] {
        [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|place: [f32; 2]| {
            let [w0, w1, w2] = self.weights(place).map(f64::from);
            c0.as_dvec3() * w0 + c1.as_dvec3() * w1 + c2.as_dvec3() * w2
        })
    }

    /// Texture coordinate at weights of the triangle's corners.
    #[inline(always)]
    fn uv_at<F: Real>(&self, w: [F; 3]) -> V2<F> {
        V2::new(
            sum(w, [self.uv[0].x, self.uv[1].x, self.uv[2].x]),
            sum(w, [self.uv[0].y, self.uv[1].y, self.uv[2].y]),
        )
    }

    /// Makes the sixteen micro-triangles of a part with four segments and tests them.
    #[inline(always)]
    fn meet_leaf<S: Simd>(
        &self,
        simd: S,
        reliefs: &Reliefs<'_, '_>,
        ray: &FineRay,
        part: &Part,
        best: &mut Best,
    ) {
        let leaf = [part.a, part.b, part.size];
        let points = self.leaf_points(simd, reliefs, leaf);
        for i in ones(ray.test.may_pass(simd, &points, &TRIANGLES)) {
            let [a, b, c] = &TRIANGLES;
            let i = i % PARTS;
            let corners = [
                point(&points, a[i]),
                point(&points, b[i]),
                point(&points, c[i]),
            ];
            let Some(hit) = ray.test.intersect(&ray.slabs, &corners) else {
                continue;
            };
            let micro = MicroHit {
                leaf: (self.piece, leaf),
                part: i as u8,
                corners,
                weights: [hit.u, hit.v],
            };
            let wins_tie =
                hit.t == best.t && best.hit.is_some_and(|known| micro.key() < known.key());
            if hit.t < best.t || wins_tie {
                best.t = hit.t;
                best.hit = Some(micro);
            }
        }
    }

    /// The sixteen micro-triangles of a part with four segments.
    #[inline(always)]
    pub fn leaf_corners<S: Simd>(
        &self,
        simd: S,
        reliefs: &Reliefs<'_, '_>,
        leaf: [i32; 3],
    ) -> [Corners8; 2] {
        let points = self.leaf_points(simd, reliefs, leaf);
        let mut corners: [Corners8; 2] = [[[[0.0; LANES]; 3]; 3]; 2];
        for (k, vertices) in TRIANGLES.into_iter().enumerate() {
            for (i, vertex) in vertices.into_iter().enumerate() {
                for axis in 0..3 {
                    corners[i / LANES][k][axis][i % LANES] = points[axis].0[vertex];
                }
            }
        }
        corners
    }

    /// Positions of the vertices of a part with four segments.
    #[inline(always)]
    fn leaf_points<S: Simd>(
        &self,
        simd: S,
        reliefs: &Reliefs<'_, '_>,
        [a0, b0, s]: [i32; 3],
    ) -> [Row; 3] {
        // Whole numbers below 2²⁴ and powers of two: nothing is rounded.
        let per_segment = self.per_segment();
        let quarter = (s / 4) as f32 * per_segment;
        let (a0, b0) = (a0 as f32 * per_segment, b0 as f32 * per_segment);
        let mut places = [Row::splat(0.0); 2];
        let mut points = [Row::splat(0.0); 3];
        for group in 0..PARTS / S::f32s::LEN {
            let [a, b] = &GRID_ROWS;
            let place = [
                a.get(simd, group) * quarter + a0,
                b.get(simd, group) * quarter + b0,
            ];
            places[0].set(group, place[0]);
            places[1].set(group, place[1]);
            let w = self.weights(place);
            let d = self.field.height.displacement(self.uv_at(w));
            for (axis, row) in points.iter_mut().enumerate() {
                let p = sum(w, along(&self.p, axis));
                let n = sum(w, along(&self.n, axis));
                row.set(group, p + n * d);
            }
        }
        if let Some(seams) = &self.seams {
            self.mend((seams, reliefs), &places, &mut points);
        }
        points
    }

    /// Puts the vertices on seams where both sides agree.
    #[inline(never)]
    fn mend(
        &self,
        (seams, reliefs): (&SeamsAround<'_>, &Reliefs<'_, '_>),
        places: &[Row; 2],
        points: &mut [Row; 3],
    ) {
        for i in 0..VERTICES {
            let w = self.weights([places[0].0[i], places[1].0[i]]);
            if !w.contains(&0.0) {
                continue;
            }
            let mut by_corner = [0.0; 3];
            for k in 0..3 {
                by_corner[self.order[k]] = w[k];
            }
            if let Some(d) = seams.displacement(reliefs, by_corner) {
                for (axis, row) in points.iter_mut().enumerate() {
                    let p = sum(w, along(&self.p, axis));
                    let n = sum(w, along(&self.n, axis));
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
        let [a, b, size] = micro.place().map(|i| i as f32);
        let per_segment = self.per_segment();
        let place = [a + size * u, b + size * v].map(|x| x * per_segment);
        let mut weights = [0.0; 3];
        for (k, w) in self.weights(place).into_iter().enumerate() {
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

/// A coordinate of three points.
#[inline(always)]
fn along([a, b, c]: &[Vec3; 3], axis: usize) -> [f32; 3] {
    [a[axis], b[axis], c[axis]]
}

/// A vertex of a part with four segments.
#[inline(always)]
fn point([x, y, z]: &[Row; 3], vertex: usize) -> Vec3 {
    let vertex = vertex % PARTS;
    Vec3::new(x.0[vertex], y.0[vertex], z.0[vertex])
}

/// A patch made ready for rays: hits and micro-triangles alone need none of this.
#[derive(Debug, Clone, Copy)]
pub struct ReadyPatch<'a, 'm> {
    patch: Patch<'a, 'm>,
    frame: LocalFrame,
    /// Where it lies on the map, if within; seams are left to the places themselves.
    cells: Option<PieceCells>,
}

impl<'a, 'm> ReadyPatch<'a, 'm> {
    pub fn new(patch: Patch<'a, 'm>) -> Self {
        let [low, high] = patch.range;
        let (p, n) = (patch.at_corners(patch.p), patch.at_corners(patch.n));
        let on_map = || {
            let uv = patch.at_corners(patch.uv.map(|uv| uv.extend(0.0)));
            PieceCells::new(patch.field, uv.map(|uv| [uv.x, uv.y]))
        };
        Self {
            frame: LocalFrame::new(p, n, low.abs().max(high.abs())),
            cells: if patch.cut.on_seam { None } else { on_map() },
            patch,
        }
    }

    /// Index of the piece.
    pub const fn piece(&self) -> u32 {
        self.patch.piece
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
    /// The part of four segments: piece, anchor and signed size.
    pub leaf: PartKey,
    /// Which of its sixteen micro-triangles.
    pub part: u8,
    /// Corners of the micro-triangle.
    pub corners: [Vec3; 3],
    /// Weights of its second and third corner.
    pub weights: [f32; 2],
}

impl MicroHit {
    /// Of two at the same distance the lower wins.
    const fn key(&self) -> (PartKey, u8) {
        (self.leaf, self.part)
    }

    /// Anchor and signed size of the micro-triangle in its piece, in segments.
    const fn place(&self) -> [i32; 3] {
        let (_, [a, b, size]) = self.leaf;
        let [x, y, s] = CUT[self.part as usize % PARTS];
        let quarter = size / 4;
        [a + x * quarter, b + y * quarter, s * quarter]
    }
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

/// Meets pieces one after the other.
pub struct Meeting<'a, 'm> {
    reliefs: &'a Reliefs<'a, 'm>,
    /// Displacements that none on a seam leaves.
    seam_range: [f32; 2],
    /// Kept from one to the next only so that it need not be made anew.
    stack: [Part; STACK],
    /// What it cost.
    pub counters: FineCounters,
}

impl<'a, 'm> Meeting<'a, 'm> {
    pub fn new(reliefs: &'a Reliefs<'a, 'm>) -> Self {
        Self {
            reliefs,
            seam_range: seams::range(reliefs).map(|d| d as f32),
            stack: [Part::NONE; STACK],
            counters: FineCounters::default(),
        }
    }

    /// The hit on a piece before `best`, if it is nearer; with `any`, whatever comes first.
    #[inline(always)]
    pub fn meet<S: Simd>(
        &mut self,
        simd: S,
        ReadyPatch {
            patch,
            frame,
            cells,
        }: &ReadyPatch<'_, '_>,
        ray: &FineRay,
        (mut best, any): (Best, bool),
    ) -> Best {
        let (reliefs, stack) = (self.reliefs, &mut self.stack);
        let local = LocalRay::new(ray, frame);
        // Boxes lie along the axes of space: many pieces whose boxes are met are flown over.
        let whole = ([0.0, 0.0, 1.0], 1.0);
        if local.meets(whole, patch.range, best.t).1 {
            return best;
        }
        let mut depth = start(patch.cut, stack);
        while depth > 0 {
            depth -= 1;
            let part = stack[depth];
            if part.near > best.t {
                continue;
            }
            if part.size.abs() == 4 {
                self.counters.leaves += 1;
                patch.meet_leaf(simd, reliefs, ray, &part, &mut best);
                if any && best.hit.is_some() {
                    return best;
                }
                continue;
            }
            self.counters.parts += 1;
            let mut near = Row::splat(0.0);
            let mut met = 0;
            let per_quarter = (part.size / 4) as f32 * patch.per_segment();
            let a0 = part.a as f32 * patch.per_segment();
            let b0 = part.b as f32 * patch.per_segment();
            for group in 0..PARTS / S::f32s::LEN {
                let [a, b, s] = &CUTS;
                let places = [
                    a.get(simd, group) * per_quarter + a0,
                    b.get(simd, group) * per_quarter + b0,
                    s.get(simd, group) * per_quarter,
                ];
                let size = per_quarter.abs();
                let range = match cells {
                    Some(cells) => cells.ranges(patch.field, places, size),
                    None => patch.ranges(self.seam_range, places),
                };
                let (entry, misses) = local.meets((places, size), range, best.t);
                near.set(group, entry);
                met |= (!misses).0.to_bitmask() << (group * S::f32s::LEN);
            }
            let first = depth;
            let quarter = part.size / 4;
            for i in ones(met) {
                let i = i % PARTS;
                let [a, b, s] = CUT[i];
                let [a, b, s] = [a * quarter, b * quarter, s * quarter];
                let child = Part {
                    a: part.a + a,
                    b: part.b + b,
                    size: s,
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
        near: f32::NEG_INFINITY,
    };
}

/// Puts the whole piece on the stack, or its quarters if it would not fall into sixteenths down to four segments;
/// returns the stack's depth.
#[inline(always)]
fn start(cut: Cut, stack: &mut [Part; STACK]) -> usize {
    let size = 1 << cut.segments_log2;
    let part = |[a, b, size]: [i32; 3]| Part {
        a,
        b,
        size,
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

/// `w0·x0 + w1·x1 + w2·x2`, in this order.
#[inline(always)]
fn sum<F: Real>([w0, w1, w2]: [F; 3], [x0, x1, x2]: [f32; 3]) -> F {
    w0 * x0 + w1 * x1 + w2 * x2
}
