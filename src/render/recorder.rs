//! Listens to a tile's first sample and notes what it found: the very stages that make the picture tell.

use glam::{Vec2, Vec3};

use super::Frame;
use super::Snapshot;
use super::material::{amplitude, bind_height};
use super::records::{PixelRecord, Recording, UvYardstick};
use super::stages::surface::fetches_per_point;
use super::stages::{
    Column3, PLACES, Places, Rays, Run, Shadows, Stage, StageWatch, Surfaces, Walks, vec_at,
};
use super::suspect::Suspect;
use crate::geometry::{Hit, HitLanes};
use crate::scene::TextureFilter;
use crate::surface::displaced::Tracer;
use crate::surface::mapping::BoundHeight;
use crate::surface::{SurfaceInteraction, SurfaceParts, surface_at};
use crate::texture::{MapRole, Wrap};

/// What the maps of a material measure by.
#[derive(Debug, Clone, Copy)]
struct Yardstick<'a> {
    /// The height map, so that its displacement is the stored value with gain and bias.
    height: Option<BoundHeight<'a>>,
    /// From stored 0 to stored 1, internal units.
    amplitude: f32,
}

/// What a recorder must know of a snapshot.
#[derive(Debug)]
pub struct Yardsticks<'a> {
    materials: Vec<Yardstick<'a>>,
    suspect: Option<Suspect>,
}

impl<'a> Yardsticks<'a> {
    /// Finds the height maps, whether the method reads them or not.
    #[must_use]
    pub fn new(snapshot: &'a Snapshot, recording: Recording) -> Self {
        let (scene, settings) = (&*snapshot.scene, &*snapshot.settings);
        let of = |material| {
            let world = amplitude(material, &settings.mapping);
            let slot = material
                .map(MapRole::Height)
                .filter(|slot| slot.image < scene.images.len());
            let gain = slot.map_or(1.0, |slot| slot.gain_and_bias().0.abs());
            Yardstick {
                height: slot
                    .map(|slot| bind_height(slot, scene, (1.0, 0.0), TextureFilter::Bilinear)),
                amplitude: scene.normalization.internal_length(world) * gain,
            }
        };
        Self {
            materials: settings.materials.iter().map(of).collect(),
            suspect: match recording {
                Recording::Suspect(kernel, offset_rule) => Some(Suspect {
                    kernel,
                    offset_rule,
                }),
                Recording::Nothing | Recording::Pixels => None,
            },
        }
    }
}

/// How places on each material are told apart.
#[must_use]
pub fn uv_yardsticks(snapshot: &Snapshot) -> Vec<UvYardstick> {
    const ROLES: [MapRole; 4] = [
        MapRole::Height,
        MapRole::Normal,
        MapRole::Slope,
        MapRole::Albedo,
    ];
    let materials = snapshot.settings.materials.iter();
    let known = materials.map(|material| {
        let slot = ROLES.into_iter().find_map(|role| material.map(role))?;
        let image = snapshot.scene.images.get(slot.image)?;
        let [width, height] = [image.raw.width, image.raw.height];
        let pictures_per_uv = Vec2::from(slot.uv_scale);
        Some(UvYardstick {
            texels_per_uv: pictures_per_uv * Vec2::new(width as f32, height as f32),
            turns_per_uv: match slot.wrap {
                Wrap::Repeat => pictures_per_uv,
                Wrap::Clamp | Wrap::Mirror => Vec2::ZERO,
            },
        })
    });
    known
        .map(|yardstick| yardstick.unwrap_or(UvYardstick::NONE))
        .collect()
}

/// Notes what one tile's first sample finds.
#[derive(Debug)]
pub struct Recorder<'a> {
    yardsticks: &'a Yardsticks<'a>,
    records: Vec<PixelRecord>,
    /// Steps of the searches in displaced surfaces, by place.
    traced: Vec<u32>,
    /// Mapped surfaces so far: one a bounce.
    bounces: u32,
}

impl<'a> Recorder<'a> {
    /// Nothing noted yet.
    #[must_use]
    pub fn new(yardsticks: &'a Yardsticks<'a>) -> Self {
        Self {
            yardsticks,
            records: vec![PixelRecord::NOTHING; PLACES],
            traced: vec![0; PLACES],
            bounces: 0,
        }
    }

    /// The records by place, once the sample is done; `radiance` is what it came to.
    #[must_use]
    pub fn finish(mut self, radiance: &Column3) -> Vec<PixelRecord> {
        for (place, record) in self.records.iter_mut().enumerate() {
            record.non_finite = radiance.iter().any(|c| !c.0[place].is_finite());
        }
        self.records
    }

    fn add_cost(&mut self, place: usize, work: u64) {
        let cost = &mut self.records[place].cost;
        *cost = cost.saturating_add(u32::try_from(work).unwrap_or(u32::MAX));
    }

    fn add_rays(&mut self, rays: &Places, tracer: &Tracer) {
        for place in rays.iter() {
            self.add_cost(place, 1);
        }
        for (place, steps) in tracer.steps_by_place() {
            self.add_cost(place, steps);
        }
    }

    /// Asks the suspect about all camera rays but those that hit displaced surfaces.
    fn look_for_leaks(
        &mut self,
        frame: &Frame<'_>,
        (rays, hits): (&Rays, &HitLanes<PLACES>),
        surfaces: &Surfaces,
    ) {
        let Some(suspect) = self.yardsticks.suspect else {
            return;
        };
        let mut missed = rays.active;
        for run in &surfaces.runs {
            missed = missed & !run.places;
            for place in run.places.iter().filter(|_| !run.displaced) {
                let ray = rays.lanes.ray(place);
                let base = base_point(frame, rays, hits, (run, place));
                let t = (Vec3::from(base.p) - ray.origin).dot(ray.dir);
                self.records[place].leak = suspect.leaks(frame, &ray, Some(t));
            }
        }
        for place in missed.iter() {
            let ray = rays.lanes.ray(place);
            self.records[place].leak = suspect.leaks(frame, &ray, None);
        }
    }

    /// What is seen in a place of a run.
    fn seen(
        &self,
        frame: &Frame<'_>,
        (rays, hits): (&Rays, &HitLanes<PLACES>),
        surfaces: &Surfaces,
        (run, place): (&Run, usize),
    ) -> PixelRecord {
        let material = &frame.materials[run.material];
        let yardstick = &self.yardsticks.materials[run.material];
        let base = base_point(frame, rays, hits, (run, place));
        let (normal, n_geo) = (
            vec_at(&surfaces.n_shade, place),
            vec_at(&surfaces.n_geo, place),
        );
        let wo = Vec3::from(base.wo);
        let n_front = match &hits.displaced {
            Some(points) if run.displaced => vec_at(&points.normal, place),
            _ => base.n_geo.into(),
        };
        let smooth_front = Vec3::from(base.n_shade);
        let sunk = if run.searches {
            surfaces.relief.sunk.0[place]
        } else {
            0.0
        };
        let z = if run.displaced {
            (vec_at(&surfaces.p, place) - Vec3::from(base.p)).dot(smooth_front)
        } else if sunk == 0.0 {
            0.0
        } else {
            // The place lies `sunk` under the triangle's plane; along the view that is so far along the normal.
            -sunk * wo.dot(smooth_front) / wo.dot(n_front)
        };
        let (steps, at_the_cap) = if run.searches {
            let steps = surfaces.relief.steps.0[place];
            let most = material.mapping.most_steps(&base);
            (
                steps as u32,
                steps > 0.0 && most.is_some_and(|most| steps >= most),
            )
        } else {
            (self.traced[place], false)
        };
        let uv = run.attributes.has_uv.then(|| {
            if run.searches {
                let [u, v] = &surfaces.relief.uv;
                return Vec2::new(u.0[place], v.0[place]);
            }
            let mut moved = base;
            if run.kind.parts == SurfaceParts::Gradients {
                material.mapping.apply_to_point(&mut moved);
            }
            Vec2::new(moved.uv.x, moved.uv.y)
        });
        let from_behind = wo.dot(n_front) < 0.0;
        let is_valid = normal.dot(wo) > 0.0 && normal.dot(n_geo) > 0.0;
        PixelRecord {
            material: u16::try_from(run.material).ok(),
            normal,
            smooth_normal: if from_behind {
                -smooth_front
            } else {
                smooth_front
            },
            uv,
            height: uv.and_then(|uv| Some(yardstick.height?.displacement(uv.into()))),
            depth: if yardstick.amplitude > 0.0 {
                -z / yardstick.amplitude
            } else {
                0.0
            },
            steps,
            invalid_normal: !is_valid,
            at_the_cap,
            ..self.records[place]
        }
    }
}

impl StageWatch for Recorder<'_> {
    fn begin(&mut self) {}

    fn done(&mut self, _: Stage) {}

    fn wants_every_ray(&self) -> bool {
        true
    }

    fn traced(&mut self, rays: &Places, tracer: &Tracer) {
        self.add_rays(rays, tracer);
        if self.bounces == 0 {
            for (place, steps) in tracer.steps_by_place() {
                self.traced[place] = u32::try_from(steps).unwrap_or(u32::MAX);
            }
        }
    }

    fn mapped(
        &mut self,
        frame: &Frame<'_>,
        (rays, hits): (&Rays, &HitLanes<PLACES>),
        surfaces: &Surfaces,
    ) {
        for run in &surfaces.runs {
            let material = &frame.materials[run.material];
            let fetches = fetches_per_point(material, run);
            for place in run.places.iter() {
                let steps = if run.searches {
                    surfaces.relief.steps.0[place] as u64
                } else {
                    0
                };
                self.add_cost(place, fetches + steps);
                if self.bounces == 0 {
                    let seen = self.seen(frame, (rays, hits), surfaces, (run, place));
                    self.records[place] = seen;
                }
            }
        }
        if self.bounces == 0 {
            self.look_for_leaks(frame, (rays, hits), surfaces);
        }
        self.bounces += 1;
    }

    fn walked(&mut self, walks: &Walks) {
        for (place, _, walk) in walks.iter() {
            self.add_cost(place, u64::from(walk.steps));
        }
    }

    fn shadowed(
        &mut self,
        frame: &Frame<'_>,
        points: (&Rays, &Surfaces),
        (shadows, tracer): (&Shadows, &Tracer),
    ) {
        self.add_rays(&shadows.lit, tracer);
        // Displaced surfaces, too, stop shadow rays; no suspect knows of them.
        let suspect = self
            .yardsticks
            .suspect
            .filter(|_| frame.displaced.is_none());
        let Some(suspect) = suspect.filter(|_| self.bounces == 1) else {
            return;
        };
        for run in &points.1.runs {
            for place in (run.places & shadows.lit).iter() {
                let is_wrong = suspect.shadows_wrongly(frame, points, shadows, (run, place));
                self.records[place].false_shadow |= is_wrong;
            }
        }
    }
}

/// The surface under a place before any map changes it: the one-point twin of what the stage started from.
fn base_point(
    frame: &Frame<'_>,
    rays: &Rays,
    hits: &HitLanes<PLACES>,
    (run, place): (&Run, usize),
) -> SurfaceInteraction {
    let (prim, u, v) = hits.get(place);
    let hit = Hit {
        t: 0.0,
        prim,
        sub: 0,
        u,
        v,
    };
    let parts = if run.attributes.has_uv {
        run.kind.parts.max(SurfaceParts::Uv)
    } else {
        run.kind.parts
    };
    surface_at(frame.mesh, &hit, &rays.lanes.ray(place), parts)
}
