//! View rays, what they hit, and which of them show a relief.

use super::facet::Facet;
use super::truth::MIN_COS;
use crate::geometry::triangle::Watertight;
use crate::geometry::{Hit, Ray};
use crate::math::{hash, unit_interval};
use crate::render::{Frame, Passage};
use crate::surface::{SurfaceInteraction, SurfaceParts, surface_at};

/// A view ray that shows a relief from its front.
#[derive(Debug, Clone, Copy)]
pub struct Sight {
    /// Index of the material.
    pub material: usize,
    /// Where the ray meets the mesh.
    pub hit: Hit,
    /// The surface as the renderer has it, before any map changes it.
    pub surface: SurfaceInteraction,
    /// The same in double precision.
    pub facet: Facet,
}

impl Sight {
    /// Angle between the view and the smooth normal, degrees.
    #[must_use]
    pub fn angle_deg(&self) -> f64 {
        self.facet.cos().clamp(-1.0, 1.0).acos().to_degrees()
    }
}

/// View rays of one camera. The frame must have been made with the truth's settings.
pub struct Pinhole<'a> {
    frame: &'a Frame<'a>,
}

/// What the view rays of one view see.
pub struct Sights {
    /// Those that show a relief from its front.
    pub relief: Vec<Sight>,
    /// For each ray, whether it hits anything: the outline.
    pub outline: Vec<bool>,
}

impl Sights {
    /// Share of all rays that hit anything, 0…1.
    #[must_use]
    pub fn covered(&self) -> f64 {
        let hits = self.outline.iter().filter(|hit| **hit).count();
        hits as f64 / self.outline.len().max(1) as f64
    }
}

impl<'a> Pinhole<'a> {
    /// The camera of a frame.
    #[must_use]
    pub const fn of(frame: &'a Frame<'a>) -> Self {
        Self { frame }
    }

    /// What the ray through a place of the picture (pixels from its top left corner) sees; `None` unless it is a
    /// relief from its front.
    #[must_use]
    pub fn sight(&self, place: [f32; 2]) -> Option<Sight> {
        self.look(place)?
    }

    fn ray(&self, [x, y]: [f32; 2]) -> Ray {
        let camera = &self.frame.camera;
        Ray {
            origin: camera.origin,
            dir: camera.direction(x, y).into(),
        }
    }

    /// Whether the ray through a place of the picture hits anything, of a displaced surface where there is one.
    fn is_covered(&self, place: [f32; 2], passage: &mut Passage) -> bool {
        let (frame, ray) = (self.frame, self.ray(place));
        let displaced = passage.is_blocked(frame, &ray, f32::INFINITY);
        let stays = |prim: u32, u: f32, v: f32| {
            !frame.displaces(frame.mesh.attributes[prim as usize]) && frame.is_solid(prim, u, v)
        };
        let plain = || {
            let bvh = frame.bvh;
            bvh.occluded::<Watertight, _>(&ray, f32::INFINITY, &stays)
        };
        displaced || plain()
    }

    /// `None` if the ray misses the mesh; `Some(None)` if it hits something without a relief.
    fn look(&self, place: [f32; 2]) -> Option<Option<Sight>> {
        let (frame, ray) = (self.frame, self.ray(place));
        let solid = |prim: u32, u: f32, v: f32| frame.is_solid(prim, u, v);
        let hit = frame
            .bvh
            .intersect::<Watertight, _>(&ray, f32::INFINITY, &solid)?;
        let attributes = frame.mesh.attributes[hit.prim as usize];
        let material = usize::from(attributes.material);
        if !attributes.has_uv || frame.materials[material].field().is_none() {
            return Some(None);
        }
        let surface = surface_at(frame.mesh, &hit, &ray, SurfaceParts::Gradients);
        let Some(facet) = Facet::on(frame.mesh, hit.prim, &ray) else {
            return Some(None);
        };
        let has_chart = facet.gradients[0].cross(facet.gradients[1]).length() > 0.0;
        let seen = facet.cos() > MIN_COS && has_chart && surface.handedness != 0.0;
        Some(seen.then_some(Sight {
            material,
            hit,
            surface,
            facet,
        }))
    }

    /// About `count` rays, one in each cell of a grid over the picture, at a place that `seed` decides.
    #[must_use]
    pub fn sights(&self, count: u32, seed: u32) -> Sights {
        let [width, height] = self.frame.camera.half.map(|half| half * 2.0);
        let columns = ((count as f32 * width / height).sqrt().round() as u32).max(1);
        let rows = (count / columns).max(1);
        let mut relief = Vec::new();
        let mut outline = Vec::new();
        let (frame, mut passage) = (self.frame, Passage::default());
        for cell in 0..columns * rows {
            let random = |k: u32| unit_interval(hash(hash(seed.wrapping_add(k)) ^ cell));
            let x = ((cell % columns) as f32 + random(0)) / columns as f32 * width;
            let y = ((cell / columns) as f32 + random(0x9e37_79b9)) / rows as f32 * height;
            let seen = self.look([x, y]);
            outline.push(match frame.displaced {
                Some(_) => self.is_covered([x, y], &mut passage),
                None => seen.is_some(),
            });
            relief.extend(seen.flatten());
        }
        Sights { relief, outline }
    }
}
