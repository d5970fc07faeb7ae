//! Rays, hits, and where a ray that leaves a surface starts.

use glam::Vec3;

use super::Aabb;
use crate::math::lanes::{Lanes, PlaceSet};
use crate::math::{Real, V3};

/// A half line. `dir` has unit length, so `t` is a distance in internal units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Start.
    pub origin: Vec3,
    /// Unit direction.
    pub dir: Vec3,
}

impl Ray {
    /// The ray that leaves a point in the unit direction `dir`, clear of its own triangle: see
    /// [`offset_by_bound`], whose `p`, `bound` and `n_geo` are given.
    #[must_use]
    pub fn leaving((p, bound, n_geo): (Vec3, f32, Vec3), dir: Vec3) -> Self {
        Self {
            origin: offset_by_bound(p.into(), bound, n_geo.into(), dir.into()).into(),
            dir,
        }
    }

    /// The point at distance `t`.
    #[must_use]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.dir * t
    }

    /// Whether it starts beyond one face of the box and runs further away from it, so that nothing inside
    /// can be in its way. Exact: only coordinates are compared. The rays that leave an outermost surface,
    /// all rays above a flat one, need no more than this.
    #[must_use]
    #[inline(always)]
    pub fn runs_away_from(&self, bounds: &Aabb) -> bool {
        let zero = Vec3::ZERO;
        let up = self.origin.cmpgt(bounds.max) & self.dir.cmpgt(zero);
        let down = self.origin.cmplt(bounds.min) & self.dir.cmplt(zero);
        (up | down).any()
    }
}

/// Compact record of a closest hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance along the unit direction, internal units.
    pub t: f32,
    /// Index of the triangle in [`TriangleMesh::indices`](super::TriangleMesh::indices).
    pub prim: u32,
    /// Index of a part of the primitive (a displaced micro-triangle); 0 for a plain triangle.
    pub sub: u32,
    /// Barycentric weight of the triangle's second vertex.
    pub u: f32,
    /// Barycentric weight of the triangle's third vertex. The first vertex has `1 − u − v`.
    pub v: f32,
}

/// How far a leaving ray starts from its surface.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum OriginRule {
    /// By the rounding bound of the hit point, then one float further on each axis.
    #[default]
    Bound,
    /// By a fixed distance along the geometric normal, as textbooks do (internal units).
    Fixed(f32),
}

/// Origin for a ray leaving `p` towards `dir`, clear of its own triangle.
///
/// [`offset_by_bound`] or, for comparison, the textbooks' fixed step.
#[must_use]
pub fn offset_origin(p: Vec3, p_error: Vec3, n_geo: Vec3, dir: Vec3, rule: OriginRule) -> Vec3 {
    let [p, p_error, n_geo, dir] = [p, p_error, n_geo, dir].map(V3::from);
    match rule {
        OriginRule::Bound => offset_by_bound(p, n_geo.abs().dot(p_error), n_geo, dir).into(),
        OriginRule::Fixed(distance) => (p + facing(n_geo, dir) * distance).into(),
    }
}

/// Nearer to 0 no leaving ray starts: `2⁻¹⁰⁰`.
///
/// The float next to 0 is subnormal, and arithmetic with such numbers is a hundred times slower on most
/// processors. On the plane z = 0, where many scenes stand, every shadow ray would start there.
const SMALLEST_COORDINATE: f32 = 7.888_609e-31;

/// Origin for a ray leaving `p` towards `dir`, clear of its own triangle.
///
/// Moves along `n_geo` by the rounding bound `|n_geo| · p_error` (internal units), then one float further
/// on each axis. A fixed epsilon is too big on a small mesh and too small far from the origin. Never pass
/// a shading normal: it may point into the triangle.
///
/// Source: PBRT 4th ed., §6.8.6.
#[inline(always)]
#[must_use]
pub fn offset_by_bound<F: Real>(p: V3<F>, bound: F, n_geo: V3<F>, dir: V3<F>) -> V3<F> {
    let outward = facing(n_geo, dir);
    let moved = p + outward * bound;
    V3::new(
        stepped(moved.x, outward.x),
        stepped(moved.y, outward.y),
        stepped(moved.z, outward.z),
    )
}

/// One float further to the side of `outward`.
#[inline(always)]
fn stepped<F: Real>(x: F, outward: F) -> F {
    let zero = x.splat(0.0);
    x.stepped(outward.gt(zero), outward.lt(zero), SMALLEST_COORDINATE)
}

/// The normal on the side of `dir`.
#[inline(always)]
fn facing<F: Real>(n: V3<F>, dir: V3<F>) -> V3<F> {
    let cos = dir.dot(n);
    V3::select(cos.lt(cos.splat(0.0)), -n, n)
}

/// Up to `N` rays side by side.
#[derive(Debug, Clone, PartialEq)]
pub struct RayLanes<const N: usize> {
    /// Starts.
    pub origin: [Lanes<f32, N>; 3],
    /// Unit directions.
    pub dir: [Lanes<f32, N>; 3],
    /// Where each ray ends; a place whose number is not above 0 holds no ray.
    pub t_max: Lanes<f32, N>,
    /// The triangle that each ray leaves, or [`NO_HIT`]. A ray from [`offset_by_bound`] cannot meet it
    /// again; bundles that know it need not work that out.
    pub leaving: Lanes<u32, N>,
}

/// What `N` rays side by side hit.
#[derive(Debug, Clone, PartialEq)]
pub struct HitLanes<const N: usize> {
    /// Triangle, or [`NO_HIT`].
    pub prim: Lanes<u32, N>,
    /// Barycentric weight of its second vertex.
    pub u: Lanes<f32, N>,
    /// Barycentric weight of its third vertex.
    pub v: Lanes<f32, N>,
    /// Hits that do not lie on the triangle itself; `None` until there are any.
    pub displaced: Option<Box<DisplacedLanes<N>>>,
}

/// Places in sets of `N`: a bit each.
const WORDS: usize = 16;

/// Points of displaced surfaces, side by side; what other places hold means nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct DisplacedLanes<const N: usize> {
    /// Places with such a point.
    pub places: PlaceSet<WORDS>,
    /// The points.
    pub p: [Lanes<f32, N>; 3],
    /// Unit normals on the front side.
    pub normal: [Lanes<f32, N>; 3],
    /// How far rounding may have taken each point off its surface, along the normal.
    pub bound: Lanes<f32, N>,
    /// Triangle of the mesh under each.
    pub prim: Lanes<u32, N>,
    /// Weights of its second and third vertex.
    pub weights: [Lanes<f32, N>; 2],
}

impl<const N: usize> Default for DisplacedLanes<N> {
    fn default() -> Self {
        Self {
            places: PlaceSet::EMPTY,
            p: [Lanes::splat(0.0); 3],
            normal: [Lanes::splat(0.0); 3],
            bound: Lanes::splat(0.0),
            prim: Lanes::splat(NO_HIT),
            weights: [Lanes::splat(0.0); 2],
        }
    }
}

impl<const N: usize> DisplacedLanes<N> {
    /// Puts a point into a place.
    pub fn put(&mut self, place: usize, p: Vec3, normal: Vec3, bound: f32) {
        for axis in 0..3 {
            self.p[axis].0[place] = p[axis];
            self.normal[axis].0[place] = normal[axis];
        }
        self.bound.0[place] = bound;
        self.places.insert(place);
    }
}

/// No triangle.
pub const NO_HIT: u32 = u32::MAX;

impl<const N: usize> RayLanes<N> {
    /// No rays.
    #[must_use]
    pub const fn none() -> Self {
        Self {
            origin: [Lanes::splat(0.0); 3],
            dir: [Lanes::splat(0.0); 3],
            t_max: Lanes::splat(-1.0),
            leaving: Lanes::splat(NO_HIT),
        }
    }

    /// The ray in a place.
    #[must_use]
    pub fn ray(&self, place: usize) -> Ray {
        let at = |columns: &[Lanes<f32, N>; 3]| {
            Vec3::new(
                columns[0].0[place],
                columns[1].0[place],
                columns[2].0[place],
            )
        };
        Ray {
            origin: at(&self.origin),
            dir: at(&self.dir),
        }
    }
}

/// What one of [`HitLanes`] hit: triangle or [`NO_HIT`], and the weights of its second and third vertex.
pub type CachedHit = (u32, f32, f32);

impl<const N: usize> HitLanes<N> {
    /// What the ray in a place hit.
    #[must_use]
    pub const fn get(&self, place: usize) -> CachedHit {
        (self.prim.0[place], self.u.0[place], self.v.0[place])
    }

    /// Sets what the ray in a place hit.
    pub const fn put(&mut self, place: usize, (prim, u, v): CachedHit) {
        self.prim.0[place] = prim;
        self.u.0[place] = u;
        self.v.0[place] = v;
    }

    /// No hits.
    #[must_use]
    pub const fn none() -> Self {
        Self {
            prim: Lanes::splat(NO_HIT),
            u: Lanes::splat(0.0),
            v: Lanes::splat(0.0),
            displaced: None,
        }
    }
}
