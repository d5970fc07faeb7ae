//! What rays meet on displaced triangles.

use std::num::NonZeroU32;

use glam::Vec3;

use super::charts::Shape;
use super::clip_lanes::clip_all;
use super::fine::{Best, FineCounters, FineRay, Meeting, MicroHit, Patch, ReadyPatch};
use super::flat::{FlatPoint, FlatPrism};
use super::hit_lanes::points_all;
use super::micro::MicroMesh;
use super::{Displacement, Reliefs};
use crate::geometry::bvh::AcceptAll;
use crate::geometry::triangle::Watertight;
use crate::geometry::{Hit, Ray, TriangleMesh};
use crate::math::simd::{Kernel, Simd, SimdLevel};
use crate::surface::SurfaceInteraction;
use crate::surface::mapping::relief::{ReliefRay, Walk};

/// Rays that are traced without asking whether anybody wants them still: a few milliseconds, at the worst.
const RAYS_BETWEEN_STOPS: usize = 16;

/// Pieces that are cut up that are kept at hand.
const PATCHES_LOG2: u32 = 7;

/// Where the thing of a number is kept, of `2^log2` places: numbers that differ by powers of two, as those of neighbours
/// in a grid do, lie apart.
const fn kept_at(number: u32, log2: u32) -> usize {
    // The golden ratio, as a share of 2³²: Fibonacci hashing.
    (number.wrapping_mul(0x9e37_79b9) >> (u32::BITS - log2)) as usize
}

/// A point of a displaced surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceHit {
    /// Distance along the ray, internal units.
    pub t: f32,
    /// Triangle of the mesh under it.
    pub prim: u32,
    /// Weights of the triangle's second and third corner.
    pub weights: [f32; 2],
    /// The point.
    pub p: Vec3,
    /// How far rounding may have taken the point off the surface, along the normal.
    pub bound: f32,
    /// Unit normal of the micro-triangle or of the bilinear patch, on the front side of the mesh.
    pub normal: Vec3,
}

impl SurfaceHit {
    /// Puts the point in the place of the one on the mesh under it. The shading normal stays.
    pub fn replace_point(&self, s: &mut SurfaceInteraction) {
        let n = self.normal.abs();
        s.p = self.p.into();
        // As the bound along the normal, spread over the axes.
        s.p_error = (n * (self.bound / n.length_squared())).into();
        s.n_geo = self.normal.into();
    }
}

/// What is asked for a ray.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Search {
    /// The nearest point.
    Closest,
    /// Any point at all.
    Any,
}

/// A ray, where it ends, and what it has met. Small: a tile has a thousand.
#[derive(Debug, Clone, Copy)]
struct Asked {
    /// Whose ray it is.
    place: u32,
    /// Distance of the nearest micro-triangle; before the first, the end of the ray.
    t: f32,
    /// Which it is: its place in the list of those that were met, counted from 1.
    micro: Option<NonZeroU32>,
    /// Whether a micro-triangle is in the way, where nobody asks which.
    blocked: bool,
    /// Piece whose flat relief was met, and the distance in doubles.
    flat: Option<(u32, f64)>,
    /// Steps of walks, and parts cut up or made.
    steps: u64,
}

/// Adds a micro-triangle to a list; its place there, counted from 1.
fn listed(micros: &mut Vec<MicroHit>, hit: MicroHit) -> Option<NonZeroU32> {
    micros.push(hit);
    NonZeroU32::new(micros.len() as u32)
}

/// A walk over a flat relief, for one of the rays.
#[derive(Debug, Clone, Copy)]
struct Job {
    asked: usize,
    piece: u32,
    material: u16,
    /// Distance along the ray at which the walk begins.
    from: f64,
    ray: ReliefRay,
}

/// Traces rays against a displaced mesh. Keeps its lists, so that the steady state allocates nothing.
#[derive(Debug, Default)]
pub struct Tracer {
    asked: Vec<Asked>,
    /// Micro-triangles that were met.
    micros: Vec<MicroHit>,
    /// The rays asked for, and where they end.
    rays: Vec<Ray>,
    ends: Vec<f32>,
    hits: Vec<Option<Hit>>,
    blocked: Vec<bool>,
    /// Pieces that are walked, and rays that may meet them.
    candidates: Vec<(u32, u32)>,
    /// Those of one piece.
    which: Vec<u32>,
    jobs: Vec<Job>,
    relief_rays: Vec<ReliefRay>,
    walks: Vec<Walk>,
    /// Rays that meet the flat relief of one piece, and where.
    met: Vec<(u32, f64)>,
    /// Points on flat reliefs, by ray.
    points: Vec<FlatPoint>,
    /// Walks that the horizon of their start spared.
    spared: u64,
}

/// What is traced.
#[derive(Debug, Clone, Copy)]
pub struct DisplacedMesh<'a, 'm> {
    /// The mesh under it.
    pub mesh: &'a TriangleMesh,
    /// Its reliefs: those that the displacement was made for.
    pub reliefs: Reliefs<'a, 'm>,
    /// What was made of both.
    pub displacement: &'a Displacement,
    /// All its micro-triangles, if there was memory for them; otherwise they are made on the way.
    pub micro: Option<&'a MicroMesh>,
}

impl DisplacedMesh<'_, '_> {
    /// What a single ray meets before `t_max`.
    #[must_use]
    pub fn closest(
        self,
        tracer: &mut Tracer,
        ray: &Ray,
        t_max: f32,
        level: SimdLevel,
    ) -> Option<SurfaceHit> {
        tracer.clear();
        tracer.push(*ray, t_max);
        tracer.run(self, Search::Closest, level);
        tracer.hit(self, 0)
    }

    /// Whether a single ray meets anything before `t_max`.
    #[must_use]
    pub fn blocks(self, tracer: &mut Tracer, ray: &Ray, t_max: f32, level: SimdLevel) -> bool {
        tracer.clear();
        tracer.push(*ray, t_max);
        tracer.run(self, Search::Any, level);
        tracer.is_hit(0)
    }
}

impl Tracer {
    /// Forgets all rays.
    pub fn clear(&mut self) {
        self.asked.clear();
        self.micros.clear();
        self.rays.clear();
        self.ends.clear();
        self.spared = 0;
    }

    /// Adds a ray that ends at `t_max`.
    pub fn push(&mut self, ray: Ray, t_max: f32) {
        self.push_for(0, ray, t_max);
    }

    /// Adds the ray of a place, to be told apart in [`Self::steps_by_place`].
    pub fn push_for(&mut self, place: usize, ray: Ray, t_max: f32) {
        self.rays.push(ray);
        self.ends.push(t_max);
        self.asked.push(Asked {
            place: place as u32,
            t: t_max,
            micro: None,
            blocked: false,
            flat: None,
            steps: 0,
        });
    }

    /// Steps that all rays of the list took.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.asked.iter().map(|asked| asked.steps).sum()
    }

    /// Walks of these rays that a horizon spared.
    #[must_use]
    pub const fn walks_spared(&self) -> u64 {
        self.spared
    }

    /// The rays' places, and the steps that each took.
    pub fn steps_by_place(&self) -> impl Iterator<Item = (usize, u64)> {
        let of = |asked: &Asked| (asked.place as usize, asked.steps);
        self.asked.iter().map(of)
    }

    /// Finds what all rays meet.
    pub fn run(&mut self, mesh: DisplacedMesh<'_, '_>, search: Search, level: SimdLevel) {
        self.run_until(mesh, search, level, &|| false);
    }

    /// The same, but leaves off soon after `stop` says so; what was found then means nothing.
    pub fn run_until(
        &mut self,
        mesh: DisplacedMesh<'_, '_>,
        search: Search,
        level: SimdLevel,
        stop: &dyn Fn() -> bool,
    ) {
        self.jobs.clear();
        self.points.clear();
        if let Some(micro) = mesh.micro {
            self.meet_all(micro, search);
        }
        self.candidates.clear();
        let few = mesh.displacement.few_flat();
        let [flat, fine] = mesh.displacement.kinds();
        if (mesh.micro.is_none() && fine > 0) || (few.is_empty() && flat > 0) {
            level.run_or_plain(Visit {
                mesh,
                search,
                tracer: self,
                stop,
            });
        }
        let rays = 0..self.rays.len() as u32;
        for &piece in few {
            self.candidates.extend(rays.clone().map(|ray| (piece, ray)));
        }
        self.clip(mesh, search, level, stop);
        if stop() {
            return;
        }
        self.walk(mesh, level);
        if search == Search::Closest {
            self.find_points(mesh, level, stop);
        }
    }

    /// Lists the walks of all candidates.
    fn clip(
        &mut self,
        mesh: DisplacedMesh<'_, '_>,
        search: Search,
        level: SimdLevel,
        stop: &dyn Fn() -> bool,
    ) {
        self.ends.clear();
        self.ends.extend(self.asked.iter().map(|asked| {
            let done = asked.blocked || (search == Search::Any && asked.micro.is_some());
            if done { -1.0 } else { asked.t }
        }));
        self.for_each_piece(mesh, stop, |tracer, prism, piece, which| {
            let mut jobs = Jobs {
                piece,
                material: prism.material(mesh.mesh),
                jobs: &mut tracer.jobs,
                spared: &mut tracer.spared,
            };
            clip_all(level, prism, (&tracer.rays, &tracer.ends), which, &mut jobs);
        });
    }

    /// The points that rays meet on flat reliefs.
    fn find_points(
        &mut self,
        mesh: DisplacedMesh<'_, '_>,
        level: SimdLevel,
        stop: &dyn Fn() -> bool,
    ) {
        let met = |(asked, ray): (&Asked, u32)| asked.flat.map(|(piece, _)| (piece, ray));
        self.candidates.clear();
        self.candidates
            .extend(self.asked.iter().zip(0..).filter_map(met));
        self.points.resize(self.asked.len(), FlatPoint::NONE);
        self.for_each_piece(mesh, stop, |tracer, prism, _, which| {
            let asked = &tracer.asked;
            let t = |ray: u32| asked[ray as usize].flat.map_or(0.0, |(_, t)| t);
            tracer.met.clear();
            tracer.met.extend(which.iter().map(|&ray| (ray, t(ray))));
            points_all(level, prism, &tracer.rays, &tracer.met, &mut tracer.points);
        });
    }

    /// Calls `hold` with each piece that there are candidates for and with the numbers of their rays.
    fn for_each_piece(
        &mut self,
        mesh: DisplacedMesh<'_, '_>,
        stop: &dyn Fn() -> bool,
        hold: impl Fn(&mut Self, &FlatPrism<'_, '_>, u32, &[u32]),
    ) {
        let mut candidates = std::mem::take(&mut self.candidates);
        let mut which = std::mem::take(&mut self.which);
        candidates.sort_unstable();
        for run in candidates.chunk_by(|a, b| a.0 == b.0) {
            if stop() {
                break;
            }
            let (piece, _) = run[0];
            which.clear();
            which.extend(run.iter().map(|&(_, ray)| ray));
            let prism = FlatPrism::new(mesh.mesh, &mesh.reliefs, mesh.displacement, piece);
            if let Some(prism) = prism {
                hold(self, &prism, piece, &which);
            }
        }
        (self.candidates, self.which) = (candidates, which);
    }

    /// What the rays meet of micro-triangles that are all there.
    fn meet_all(&mut self, micro: &MicroMesh, search: Search) {
        let (bvh, count) = (micro.bvh(), self.rays.len());
        match search {
            Search::Closest => {
                self.hits.clear();
                self.hits.resize(count, None);
                let hits = &mut self.hits;
                bvh.intersect_many::<Watertight, _>(&self.rays, &self.ends, &AcceptAll, hits);
                for (asked, hit) in self.asked.iter_mut().zip(hits) {
                    if let Some(hit) = hit {
                        asked.t = hit.t;
                        asked.micro = listed(&mut self.micros, micro.micro(hit));
                    }
                }
            }
            Search::Any => {
                self.blocked.clear();
                self.blocked.resize(count, false);
                let blocked = &mut self.blocked;
                bvh.occluded_many::<Watertight, _>(&self.rays, &self.ends, &AcceptAll, blocked);
                for (asked, blocked) in self.asked.iter_mut().zip(blocked) {
                    asked.blocked = *blocked;
                }
            }
        }
    }

    /// Walks over the flat reliefs, one map after the other.
    fn walk(&mut self, mesh: DisplacedMesh<'_, '_>, level: SimdLevel) {
        for (material, field) in mesh.reliefs.fields.iter().enumerate() {
            let Some(field) = field else { continue };
            let this = |job: &&Job| usize::from(job.material) == material;
            let rays = &mut self.relief_rays;
            rays.clear();
            rays.extend(self.jobs.iter().filter(this).map(|job| job.ray));
            if rays.is_empty() {
                continue;
            }
            self.walks.clear();
            self.walks.resize(rays.len(), Walk::NONE);
            field.walk_all(level, rays, &mut self.walks);
            for (job, walk) in self.jobs.iter().filter(this).zip(&self.walks) {
                let asked = &mut self.asked[job.asked];
                asked.steps += u64::from(walk.steps);
                let Some(at) = walk.at else { continue };
                let t = job.from + at;
                let nearer = match asked.flat {
                    Some((piece, known)) => t < known || (t == known && job.piece < piece),
                    None => (t as f32) < asked.t,
                };
                if nearer {
                    asked.flat = Some((job.piece, t));
                }
            }
        }
    }

    /// Whether the ray in a place of the list met anything.
    #[must_use]
    pub fn is_hit(&self, index: usize) -> bool {
        let asked = &self.asked[index];
        asked.blocked || asked.flat.is_some() || asked.micro.is_some()
    }

    /// What the ray in a place of the list met.
    #[must_use]
    pub fn hit(&self, mesh: DisplacedMesh<'_, '_>, index: usize) -> Option<SurfaceHit> {
        self.hits(mesh).at(index)
    }

    /// What the rays met, in the order of the list.
    #[must_use]
    pub const fn hits<'t, 'a, 'm>(&'t self, mesh: DisplacedMesh<'a, 'm>) -> Hits<'t, 'a, 'm> {
        Hits {
            tracer: self,
            mesh,
            prism: None,
            next: 0,
        }
    }
}

/// What rays met, one after the other: the next often meets the same triangle.
#[derive(Debug)]
pub struct Hits<'t, 'a, 'm> {
    tracer: &'t Tracer,
    mesh: DisplacedMesh<'a, 'm>,
    /// Flat relief that was met last, and which piece it is.
    prism: Option<(u32, FlatPrism<'a, 'm>)>,
    next: usize,
}

impl Hits<'_, '_, '_> {
    fn at(&mut self, index: usize) -> Option<SurfaceHit> {
        let DisplacedMesh {
            mesh,
            reliefs,
            displacement,
            ..
        } = self.mesh;
        let asked = &self.tracer.asked[index];
        if let Some((piece, t)) = asked.flat {
            if self.prism.is_none_or(|(known, _)| known != piece) {
                let prism = FlatPrism::new(mesh, &reliefs, displacement, piece)?;
                self.prism = Some((piece, prism));
            }
            let (_, prism) = self.prism.as_mut()?;
            let point = self.tracer.points.get(index)?;
            return Some(prism.hit(mesh, t, *point));
        }
        let micro = self.tracer.micros[asked.micro?.get() as usize - 1];
        let patch = Patch::new(mesh, (&reliefs, displacement), micro.leaf.0)?;
        Some(patch.hit(asked.t, &micro))
    }
}

impl Iterator for Hits<'_, '_, '_> {
    type Item = Option<SurfaceHit>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.next == self.tracer.asked.len() {
            return None;
        }
        self.next += 1;
        Some(self.at(self.next - 1))
    }
}

/// Where walks over a flat relief are listed.
pub struct Jobs<'a> {
    piece: u32,
    material: u16,
    jobs: &'a mut Vec<Job>,
    spared: &'a mut u64,
}

impl Jobs<'_> {
    /// The part of a ray within the relief, and the distance at which it begins.
    #[inline(always)]
    pub fn take(&mut self, index: usize, part: ReliefRay, from: f64) {
        self.jobs.push(Job {
            asked: index,
            piece: self.piece,
            material: self.material,
            from,
            ray: part,
        });
    }

    /// So many rays have such a part, but horizons tell that nothing lies in its way.
    #[inline(always)]
    pub fn spare(&mut self, count: u32) {
        *self.spared += u64::from(count);
    }
}

struct Visit<'a, 't, 'm> {
    mesh: DisplacedMesh<'a, 'm>,
    search: Search,
    tracer: &'t mut Tracer,
    stop: &'t dyn Fn() -> bool,
}

impl Kernel for Visit<'_, '_, '_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let any = self.search == Search::Any;
        let DisplacedMesh {
            mesh,
            reliefs,
            displacement,
            micro,
        } = self.mesh;
        // Rays nearby meet the same few pieces by turns.
        let mut patches: [Option<ReadyPatch<'_, '_>>; 1 << PATCHES_LOG2] =
            [None; 1 << PATCHES_LOG2];
        let Tracer {
            asked,
            micros,
            rays,
            candidates,
            ..
        } = self.tracer;
        let door = (&reliefs, displacement);
        let mut meeting = Meeting::new(&reliefs);
        let few = !displacement.few_flat().is_empty();
        for (index, (asked, &ray)) in asked.iter_mut().zip(&*rays).enumerate() {
            if index % RAYS_BETWEEN_STOPS == 0 && (self.stop)() {
                break;
            }
            if asked.blocked {
                continue;
            }
            let mut best = Best {
                t: asked.t,
                hit: None,
            };
            let mut fine_ray = None;
            let mut boxes = displacement.tree.along(&ray);
            while let Some(i) = boxes.next(simd, best.t) {
                match displacement.pieces[i as usize].shape {
                    Shape::Flat | Shape::Sheet(_) if few => {}
                    Shape::Flat | Shape::Sheet(_) => candidates.push((i, index as u32)),
                    // Met already.
                    Shape::Fine(_) if micro.is_some() => {}
                    Shape::Fine(_) => {
                        let ray = fine_ray
                            .get_or_insert_with(|| FineRay::new(&ray, displacement.reach()));
                        let kept = &mut patches[kept_at(i, PATCHES_LOG2)];
                        if kept.is_none_or(|patch| patch.piece() != i) {
                            *kept = Patch::new(mesh, door, i).map(ReadyPatch::new);
                        }
                        if let Some(patch) = kept {
                            best = meeting.meet(simd, patch, ray, (best, any));
                        }
                    }
                }
                if any && best.hit.is_some() {
                    break;
                }
            }
            if let Some(hit) = best.hit {
                asked.t = best.t;
                asked.micro = listed(micros, hit);
            }
            let FineCounters { parts, leaves } = std::mem::take(&mut meeting.counters);
            asked.steps += parts + leaves;
        }
    }
}
