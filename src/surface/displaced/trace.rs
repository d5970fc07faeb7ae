//! What rays meet on displaced triangles.

use glam::Vec3;

use super::charts::Shape;
use super::fine::{Best, Cut, FineCounters, FineRay, Meeting, Patch};
use super::flat::FlatPrism;
use super::nodes::NodeCache;
use super::{Displacement, Reliefs, seams};
use crate::geometry::{Ray, TriangleMesh};
use crate::math::simd::{Kernel, Simd, SimdLevel};
use crate::surface::SurfaceInteraction;
use crate::surface::mapping::relief::{ReliefRay, Walk};

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

/// A ray, where it ends, and what it has met.
#[derive(Debug, Clone, Copy)]
struct Asked {
    /// Whose ray it is.
    place: usize,
    ray: Ray,
    best: Best,
    /// Triangle of the micro-triangle that was met.
    fine: Option<(u32, Cut)>,
    /// Triangle of the flat relief that was met, and the distance in doubles.
    flat: Option<(u32, f64)>,
    /// Steps of walks, and parts cut up or made.
    steps: u64,
}

/// A walk over the flat relief of a triangle, for one of the rays.
#[derive(Debug, Clone, Copy)]
struct Job {
    asked: usize,
    prim: u32,
    material: u16,
    /// Distance along the ray at which the walk begins.
    from: f64,
    ray: ReliefRay,
}

/// Traces rays against a displaced mesh. Keeps its lists, so that the steady state allocates nothing.
#[derive(Debug)]
pub struct Tracer {
    asked: Vec<Asked>,
    jobs: Vec<Job>,
    rays: Vec<ReliefRay>,
    walks: Vec<Walk>,
    nodes: NodeCache,
    /// Bytes that the boxes kept may take.
    budget: usize,
}

impl Default for Tracer {
    fn default() -> Self {
        Self {
            asked: Vec::new(),
            jobs: Vec::new(),
            rays: Vec::new(),
            walks: Vec::new(),
            nodes: NodeCache::default(),
            budget: USUAL_BUDGET,
        }
    }
}

/// Bytes that a tracer keeps boxes in unless told otherwise.
const USUAL_BUDGET: usize = 64 << 20;

/// What is traced.
#[derive(Debug, Clone, Copy)]
pub struct DisplacedMesh<'a, 'm> {
    /// The mesh under it.
    pub mesh: &'a TriangleMesh,
    /// Its reliefs: those that the displacement was made for.
    pub reliefs: Reliefs<'a, 'm>,
    /// What was made of both.
    pub displacement: &'a Displacement,
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
    /// Sets how many bytes the boxes of parts may take that are kept for later rays. Less makes tracing slower and
    /// changes nothing else.
    pub const fn keep(&mut self, budget: usize) {
        self.budget = budget;
    }

    /// Heap bytes of the boxes that are kept.
    #[must_use]
    pub const fn kept(&self) -> usize {
        self.nodes.bytes()
    }

    /// Gives back what is kept for later rays.
    pub fn forget(&mut self) {
        self.nodes = NodeCache::default();
    }

    /// Forgets all rays.
    pub fn clear(&mut self) {
        self.asked.clear();
    }

    /// Adds a ray that ends at `t_max`.
    pub fn push(&mut self, ray: Ray, t_max: f32) {
        self.push_for(0, ray, t_max);
    }

    /// Adds the ray of a place, to be told apart in [`Self::steps_by_place`].
    pub fn push_for(&mut self, place: usize, ray: Ray, t_max: f32) {
        self.asked.push(Asked {
            place,
            ray,
            best: Best {
                t: t_max,
                hit: None,
            },
            fine: None,
            flat: None,
            steps: 0,
        });
    }

    /// Steps that all rays of the list took.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.asked.iter().map(|asked| asked.steps).sum()
    }

    /// The rays' places, and the steps that each took.
    pub fn steps_by_place(&self) -> impl Iterator<Item = (usize, u64)> {
        self.asked.iter().map(|asked| (asked.place, asked.steps))
    }

    /// Finds what all rays meet.
    pub fn run(&mut self, mesh: DisplacedMesh<'_, '_>, search: Search, level: SimdLevel) {
        self.jobs.clear();
        self.nodes.prepare(mesh.displacement.number, self.budget);
        level.run_or_plain(Visit {
            mesh,
            search,
            tracer: self,
        });
        self.walk(mesh, level);
    }

    /// Walks over the flat reliefs, one map after the other.
    fn walk(&mut self, mesh: DisplacedMesh<'_, '_>, level: SimdLevel) {
        for (material, field) in mesh.reliefs.fields.iter().enumerate() {
            let Some(field) = field else { continue };
            let this = |job: &&Job| usize::from(job.material) == material;
            self.rays.clear();
            self.rays
                .extend(self.jobs.iter().filter(this).map(|job| job.ray));
            if self.rays.is_empty() {
                continue;
            }
            self.walks.clear();
            self.walks.resize(self.rays.len(), Walk::NONE);
            field.walk_all(level, &self.rays, &mut self.walks);
            for (job, walk) in self.jobs.iter().filter(this).zip(&self.walks) {
                let asked = &mut self.asked[job.asked];
                asked.steps += u64::from(walk.steps);
                let Some(at) = walk.at else { continue };
                let t = job.from + at;
                let nearer = match asked.flat {
                    Some((prim, known)) => t < known || (t == known && job.prim < prim),
                    None => (t as f32) < asked.best.t,
                };
                if nearer {
                    asked.flat = Some((job.prim, t));
                }
            }
        }
    }

    /// Whether the ray in a place of the list met anything.
    #[must_use]
    pub fn is_hit(&self, index: usize) -> bool {
        let asked = &self.asked[index];
        asked.flat.is_some() || asked.best.hit.is_some()
    }

    /// What the ray in a place of the list met.
    #[must_use]
    pub fn hit(&self, mesh: DisplacedMesh<'_, '_>, index: usize) -> Option<SurfaceHit> {
        let DisplacedMesh {
            mesh,
            reliefs,
            displacement,
        } = mesh;
        let asked = &self.asked[index];
        if let Some((prim, t)) = asked.flat {
            let prism = FlatPrism::new(mesh, &reliefs, displacement, prim)?;
            return Some(prism.hit(&asked.ray, t));
        }
        let patch = Patch::new(mesh, &reliefs, displacement, asked.fine?)?;
        Some(patch.hit(asked.best.t, &asked.best.hit?))
    }
}

struct Visit<'a, 't, 'm> {
    mesh: DisplacedMesh<'a, 'm>,
    search: Search,
    tracer: &'t mut Tracer,
}

impl Kernel for Visit<'_, '_, '_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let any = self.search == Search::Any;
        let DisplacedMesh {
            mesh,
            reliefs,
            displacement,
        } = self.mesh;
        let mut last_prism: Option<(u32, FlatPrism<'_, '_>)> = None;
        let Tracer {
            asked,
            jobs,
            nodes,
            budget,
            ..
        } = self.tracer;
        let mut meeting = Meeting {
            mesh,
            door: (&reliefs, displacement),
            range: seams::range(&reliefs).map(|d| d as f32),
            nodes,
            budget: *budget,
            counters: FineCounters::default(),
        };
        for (index, asked) in asked.iter_mut().enumerate() {
            let mut fine_ray = None;
            let ray = asked.ray;
            let mut boxes = displacement.tree.along(&ray);
            while let Some(i) = boxes.next(asked.best.t) {
                let prim = displacement.prims[i as usize];
                match displacement.shapes[i as usize] {
                    Shape::Flat => {
                        let prism = match last_prism {
                            Some((known, prism)) if known == prim => prism,
                            _ => {
                                let Some(prism) =
                                    FlatPrism::new(mesh, &reliefs, displacement, prim)
                                else {
                                    continue;
                                };
                                last_prism = Some((prim, prism));
                                prism
                            }
                        };
                        if let Some((ray, from)) = prism.clip(&ray, f64::from(asked.best.t)) {
                            jobs.push(Job {
                                asked: index,
                                prim,
                                material: mesh.attributes[prim as usize].material,
                                from,
                                ray,
                            });
                        }
                    }
                    Shape::Fine(cut) => {
                        let ray = fine_ray
                            .get_or_insert_with(|| FineRay::new(&ray, displacement.tree.reach()));
                        let known = asked.best.hit.map(|hit| hit.key);
                        asked.best = meeting.meet(simd, (prim, cut), ray, (asked.best, any));
                        if asked.best.hit.map(|hit| hit.key) != known {
                            asked.fine = Some((prim, cut));
                        }
                    }
                }
                if any && asked.best.hit.is_some() {
                    break;
                }
            }
            let FineCounters { parts, leaves } = std::mem::take(&mut meeting.counters);
            asked.steps += parts + leaves;
        }
    }
}
