//! The stages that a tile's rays walk through, each over flat arrays: rays → hits → mapped surfaces → light →
//! next bounce. A stage knows only its neighbours' arrays.
//!
//! A sample keeps one *place* in all arrays from the camera to the film. What a stage leaves out (places
//! that missed, other materials, points that a light cannot reach) it masks, so that nothing is moved.
//! Stages that compute are [`Kernel`](crate::math::simd::Kernel)s: loops over groups of as many places as
//! the machine has lanes, one material at a time, calling the same functions that work on one point.

pub mod bounce;
pub mod camera;
pub mod displaced;
mod facets;
pub mod film;
pub mod light;
pub mod relief;
pub mod surface;
pub mod trace;
mod walks;
mod watch;

pub use walks::Walks;
pub use watch::{Stage, StageWatch};

use glam::Vec3;

use super::known_shadows::KnownShadows;
use super::{Counters, Frame};
use crate::geometry::{CachedHit, HitLanes, RayLanes, TriangleAttributes};
use crate::math::lanes::{Lanes, PlaceSet};
use crate::math::simd::{Simd, SimdBase as _, merged};
use crate::math::wide::{Wide, WideMask};
use crate::math::{LinearRgb, V3};
use crate::surface::displaced::Tracer;
use crate::surface::{FacetKind, SmoothedPoint};

/// Places in a tile's arrays: a pixel each.
pub const PLACES: usize = 1024;

/// A number for each place.
pub type Column = Lanes<f32, PLACES>;
/// Some places.
pub type Places = PlaceSet<{ PLACES / 64 }>;
/// Three numbers for each place.
pub type Column3 = [Column; 3];

/// Whether points of this bounce send mirror rays on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mirrors {
    /// They do; the mirror's share of the colour comes from the next bounce.
    Follow,
    /// The last bounce: a mirror shows its own colour in full, as if it did not reflect.
    End,
}

impl Mirrors {
    /// Share of a point's own colour in what it shows.
    #[must_use]
    pub fn local_share(self, reflectivity: f32) -> f32 {
        match self {
            Self::Follow => 1.0 - reflectivity,
            Self::End => 1.0,
        }
    }
}

/// Rays of one bounce.
#[derive(Debug)]
pub struct Rays {
    /// Places in use, from the first on.
    pub count: usize,
    /// Places with a ray.
    pub active: Places,
    /// The rays.
    pub lanes: RayLanes<PLACES>,
    /// Share of each ray's colour in its pixel.
    pub weight: Column,
    /// Length of the way from the eye to where each ray starts. Kept only where cones are followed.
    pub travelled: Column,
}

/// Places whose surfaces are made alike.
#[derive(Debug, Clone, Copy)]
pub struct Run {
    /// What their triangles have in common.
    pub attributes: TriangleAttributes,
    /// Index of the material.
    pub material: usize,
    /// What of the triangles is read.
    pub kind: FacetKind,
    /// Whether they lie on a displaced surface, so that the hits know point and normal.
    pub displaced: bool,
    /// Whether their places on a relief are searched for, so that [`ReliefPoints`] tell of them.
    pub searches: bool,
    /// Whether light takes them as points of the smooth surface that their mesh stands for, so that
    /// [`SmoothedPoints`] tell of them.
    pub smoothed: bool,
    /// Where they are.
    pub places: Places,
}

/// What lights want to know of points that a search found on a relief. Read only in runs that
/// search; what other places hold means nothing.
#[derive(Debug)]
pub struct ReliefPoints {
    /// How far under the triangle's plane each lies, along the geometric normal.
    pub sunk: Column,
    /// Steps of the search.
    pub steps: Column,
    /// Texture coordinates found.
    pub uv: [Column; 2],
    /// Change of the texture coordinate along the view ray per unit of displacement, displacement found,
    /// and where a walk means something. Only where points are walked for together.
    pub per_z: [Column; 2],
    /// See `per_z`.
    pub z: Column,
    /// See `per_z`.
    pub usable: Places,
    /// Smooth normals before the maps, on the front side.
    pub n_smooth: Column3,
    /// Gradients of u.
    pub grad_u: Column3,
    /// Gradients of v.
    pub grad_v: Column3,
}

/// What lights want to know of points on coarse meshes that count as smooth: see
/// [`SmoothedPoint`](crate::surface::SmoothedPoint). What places of other runs hold means nothing.
#[derive(Debug)]
pub struct SmoothedPoints {
    /// Interpolated normals before the maps, towards the eye.
    pub normal: Column3,
    /// From each point to where its shadow rays start.
    pub lift: Column3,
}

impl Default for SmoothedPoints {
    fn default() -> Self {
        Self {
            normal: [Column::splat(0.0); 3],
            lift: [Column::splat(0.0); 3],
        }
    }
}

impl SmoothedPoints {
    /// The points of a group.
    #[inline(always)]
    fn get<S: Simd>(&self, simd: S, group: usize) -> SmoothedPoint<Wide<S>> {
        SmoothedPoint {
            normal: get3(simd, &self.normal, group),
            lift: get3(simd, &self.lift, group),
        }
    }
}

/// Surface points of one bounce.
#[derive(Debug)]
pub struct Surfaces {
    /// All places with a surface, cut up by material.
    pub runs: Vec<Run>,
    /// The points.
    pub p: Column3,
    /// How far rounding may have taken each off its plane.
    pub bound: Column,
    /// Geometric normals towards the eye.
    pub n_geo: Column3,
    /// Perturbed normals towards the eye.
    pub n_shade: Column3,
    /// Variance of slopes under each. Kept only for materials whose highlights widen by it.
    pub slope_variance: Column,
    /// Diffuse colours: `k_d` times the albedo map.
    pub diffuse: Column3,
    /// Reflected light.
    pub reflected: Column3,
    /// Points on reliefs.
    pub relief: ReliefPoints,
    /// Points on coarse meshes that count as smooth; `None` until there are any.
    pub smoothed: Option<Box<SmoothedPoints>>,
}

/// Shadow rays of one light.
#[derive(Debug)]
pub struct Shadows {
    /// From each point that can see the light if nothing is between, to it.
    pub rays: RayLanes<PLACES>,
    /// Places with a ray.
    pub lit: Places,
    /// Irradiance on a facing surface as a share of the light's.
    pub falloff: Column,
    /// Places where something is between.
    pub occluded: Places,
    /// What is known from before, and what is found out for later; `None` where that serves nothing.
    pub known: Option<KnownShadows>,
}

/// Arrays that a worker uses for one tile after another, so that the steady state allocates nothing.
#[derive(Debug)]
pub struct Scratch {
    /// What the rays of this bounce hit.
    pub hits: Box<HitLanes<PLACES>>,
    /// Hits that need not be found, by place.
    pub known: Vec<(usize, CachedHit)>,
    /// Everything else.
    pub work: Box<Work>,
}

/// What the stages read and write.
#[derive(Debug)]
pub struct Work {
    /// Rays of this bounce.
    pub rays: Rays,
    /// The surfaces that they hit.
    pub surfaces: Surfaces,
    /// One light at a time.
    pub shadows: Shadows,
    /// Rays against displaced surfaces.
    pub tracer: Tracer,
    /// Walks over one relief at a time.
    pub walks: Walks,
    /// Sum of each sample.
    pub radiance: Column3,
}

impl Default for Scratch {
    fn default() -> Self {
        const ZEROS: Column3 = [Column::splat(0.0); 3];
        Self {
            hits: Box::new(HitLanes::none()),
            known: Vec::new(),
            work: Box::new(Work {
                rays: Rays {
                    count: 0,
                    active: Places::EMPTY,
                    lanes: RayLanes::none(),
                    weight: Column::splat(0.0),
                    travelled: Column::splat(0.0),
                },
                surfaces: Surfaces {
                    runs: Vec::new(),
                    p: ZEROS,
                    bound: Column::splat(0.0),
                    n_geo: ZEROS,
                    n_shade: ZEROS,
                    slope_variance: Column::splat(0.0),
                    diffuse: ZEROS,
                    reflected: ZEROS,
                    relief: ReliefPoints {
                        sunk: Column::splat(0.0),
                        steps: Column::splat(0.0),
                        uv: [Column::splat(0.0); 2],
                        per_z: [Column::splat(0.0); 2],
                        z: Column::splat(0.0),
                        usable: Places::EMPTY,
                        n_smooth: ZEROS,
                        grad_u: ZEROS,
                        grad_v: ZEROS,
                    },
                    smoothed: None,
                },
                shadows: Shadows {
                    rays: RayLanes::none(),
                    lit: Places::EMPTY,
                    falloff: Column::splat(0.0),
                    occluded: Places::EMPTY,
                    known: None,
                },
                tracer: Tracer::default(),
                walks: Walks::default(),
                radiance: ZEROS,
            }),
        }
    }
}

impl Work {
    /// Everything that follows once the hits of the rays are known: their samples get what they saw, and
    /// the rays become the mirror rays of the bounce after.
    pub fn shade_hits(
        &mut self,
        frame: &Frame<'_>,
        hits: &HitLanes<PLACES>,
        mirrors: Mirrors,
        counters: &mut Counters,
        watch: &mut impl StageWatch,
    ) {
        let (rays, surfaces, walks) = (&mut self.rays, &mut self.surfaces, &mut self.walks);
        surface::mapped_surfaces(frame, (rays, hits), surfaces, walks, counters);
        watch.mapped(frame, (rays, hits), surfaces);
        watch.done(Stage::Perturb);
        let lists = (walks, &mut self.tracer);
        let (shadows, hit) = ((&mut self.shadows, lists), (&*rays, hits));
        light::reflected_light(frame, mirrors, hit, surfaces, shadows, counters, watch);
        bounce::gather(frame, mirrors, rays, surfaces, &mut self.radiance);
        rays.active = match mirrors {
            Mirrors::Follow => bounce::turn_to_mirror_rays(frame, rays, hits, surfaces),
            Mirrors::End => Places::EMPTY,
        };
        watch.done(Stage::Shade);
    }
}

impl Scratch {
    /// Follows the mirror rays through all bounces after the first: no recursion.
    pub fn follow_mirrors(
        &mut self,
        frame: &Frame<'_>,
        counters: &mut Counters,
        watch: &mut impl StageWatch,
    ) {
        let Self { hits, work, .. } = self;
        for bounce in 1..=frame.max_bounces {
            if work.rays.active.is_empty() {
                break;
            }
            counters.mirror_rays += work.rays.active.count();
            trace::closest_hits(frame, &mut work.rays, hits, &mut work.tracer, counters);
            watch.traced(&work.rays.active, &work.tracer);
            watch.done(Stage::Trace);
            work.shade_hits(frame, hits, mirrors_at(frame, bounce), counters, watch);
        }
    }
}

/// What mirrors do at a bounce.
#[must_use]
pub fn mirrors_at(frame: &Frame<'_>, bounce: u32) -> Mirrors {
    if bounce == frame.max_bounces {
        Mirrors::End
    } else {
        Mirrors::Follow
    }
}

/// How many groups hold the first `count` places.
#[inline(always)]
const fn groups<S: Simd>(count: usize) -> usize {
    count.div_ceil(S::f32s::LEN)
}

/// The vector in a place.
#[must_use]
pub fn vec_at([x, y, z]: &Column3, place: usize) -> Vec3 {
    Vec3::new(x.0[place], y.0[place], z.0[place])
}

/// One vector per lane of a group.
#[inline(always)]
fn get3<S: Simd>(simd: S, columns: &Column3, group: usize) -> V3<Wide<S>> {
    let [x, y, z] = columns;
    V3::new(x.get(simd, group), y.get(simd, group), z.get(simd, group))
}

/// Writes the lanes of a group that are in the mask; the others keep what they held.
#[inline(always)]
fn set3<S: Simd>(columns: &mut Column3, group: usize, mask: WideMask<S>, v: V3<Wide<S>>) {
    let [x, y, z] = columns;
    set(x, group, mask, v.x);
    set(y, group, mask, v.y);
    set(z, group, mask, v.z);
}

/// [`set3`] for one number.
#[inline(always)]
fn set<S: Simd>(column: &mut Column, group: usize, mask: WideMask<S>, x: Wide<S>) {
    use crate::math::simd::ExtractToken as _;
    let old = column.get(x.0.token(), group);
    column.set(group, Wide::<S>(merged(mask.0, x.0, old.0)));
}

/// One colour per lane of a group.
#[inline(always)]
fn get_rgb<S: Simd>(simd: S, columns: &Column3, group: usize) -> LinearRgb<Wide<S>> {
    let V3 { x, y, z } = get3(simd, columns, group);
    LinearRgb { r: x, g: y, b: z }
}

/// [`set3`] for colours.
#[inline(always)]
fn set_rgb<S: Simd>(
    columns: &mut Column3,
    group: usize,
    mask: WideMask<S>,
    LinearRgb { r, g, b }: LinearRgb<Wide<S>>,
) {
    set3(columns, group, mask, V3::new(r, g, b));
}
