//! Where a body is put, and what becomes of it on the way to the tracer.

use glam::{DVec3, Vec3};

use super::bodies::Body;
use crate::geometry::Normalization;
use crate::scene::built_in::assemble;
use crate::scene::built_in::meshes::WorldMesh;
use crate::scene::load::LoadOptions;
use crate::scene::{Scene, SceneSource};

/// The way to an offset: no two coordinates alike.
const ASIDE: DVec3 = DVec3::new(1.0, -0.75, 0.5);

/// A scale and an offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Placement {
    /// World units per radius.
    pub scale: f64,
    /// Distance from the world's origin on its longest axis, radii.
    pub offset: f64,
    /// Whether the program centres and scales what it reads.
    pub normalize: bool,
}

impl Placement {
    /// In the middle, at its own size.
    pub const PLAIN: Self = Self {
        scale: 1.0,
        offset: 0.0,
        normalize: true,
    };

    /// Normalised: scales 10⁻¹⁵…10¹⁵ and offsets of 10¹…10⁶ radii. Not normalised: 10⁻¹²…10¹² and
    /// 10¹…10⁴ radii.
    pub fn all() -> Vec<Self> {
        let scale = |normalize| {
            move |k: i32| Self {
                scale: 10.0_f64.powi(k),
                offset: 0.0,
                normalize,
            }
        };
        let offset = |normalize| {
            move |k: i32| Self {
                scale: 1.0,
                offset: 10.0_f64.powi(k),
                normalize,
            }
        };
        let mut all: Vec<_> = (-15..=15).map(scale(true)).collect();
        all.extend((1..=6).map(offset(true)));
        all.extend([-12, -9, -6, -3, 0, 3, 6, 9, 12].map(scale(false)));
        all.extend((1..=4).map(offset(false)));
        all
    }

    /// Some of [`Self::all`]: the extremes and the middle.
    pub fn extremes() -> Vec<Self> {
        let is_extreme = |p: &Self| {
            let far = [1e-15, 1.0, 1e15].contains(&p.scale) && [0.0, 1e6].contains(&p.offset);
            let raw = [1e-12, 1.0, 1e12].contains(&p.scale) && [0.0, 1e4].contains(&p.offset);
            if p.normalize { far } else { raw }
        };
        Self::all().into_iter().filter(is_extreme).collect()
    }

    /// A point of the body in world units.
    pub fn world(&self, p: DVec3) -> DVec3 {
        (p + ASIDE * self.offset) * self.scale
    }

    /// The body through the program's own door: normalised, rounded, with a tree. Flat-shaded unless `smooth`.
    pub fn scene(&self, body: &Body, smooth: bool) -> Scene {
        self.place(body.mesh(smooth), body.name)
    }

    /// The same of a mesh.
    pub fn place(&self, mut mesh: WorldMesh, name: &str) -> Scene {
        for vertex in &mut mesh.vertices {
            vertex.position = self.world(vertex.position);
        }
        let options = LoadOptions {
            normalize: self.normalize,
            ..LoadOptions::default()
        };
        let source = SceneSource::BuiltIn(name.to_owned());
        assemble(name, source, &mesh, Vec::new(), &options)
    }

    /// A point of the body as the tracer sees it.
    pub fn internal(&self, normalization: &Normalization, p: DVec3) -> Vec3 {
        normalization.internal_from_world(self.world(p))
    }

    /// Name in tables.
    pub fn name(&self) -> String {
        let place = match (self.scale, self.offset) {
            (1.0, 0.0) => "as it is".to_owned(),
            (scale, 0.0) => format!("x {scale:e}"),
            (_, offset) => format!("{offset:e} radii away"),
        };
        if self.normalize {
            place
        } else {
            format!("{place}, not normalised")
        }
    }
}
