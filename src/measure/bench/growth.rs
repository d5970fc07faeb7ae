//! How a frame's time grows: with the triangles of the mesh, the lights, the bounces of mirrors, the pixels.

use std::sync::Arc;

use super::grid::{grid_mesh, grid_snapshot, lamp};
use super::spread::millis;
use super::{BenchError, FrameCase, Spread, grid_scene, pool, scalar_twin};
use crate::geometry::TriangleMesh;
use crate::geometry::bvh::Bvh;
use crate::render::Snapshot;
use crate::scene::built_in::built_in;
use crate::scene::load::LoadOptions;

/// Cells along the side of the grid on which lights and pixels are counted up.
const GRID: u32 = 500;
/// Trees that are built of each mesh, at the most.
const BUILDS: usize = 3;
/// The scene of the study of mirrors.
const MIRRORS: &str = "mirrors";

/// What grows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Study {
    /// Cells along the side of a grid: 2n² triangles.
    Mesh,
    /// Point lights over a grid, all with shadows.
    Lights,
    /// Bounces between the mirrors of the built-in scene.
    Mirrors,
    /// Columns of a picture of a grid, 16:9.
    Columns,
}

impl Study {
    /// All, in the order in which they are made.
    pub const ALL: [Self; 4] = [Self::Mesh, Self::Lights, Self::Mirrors, Self::Columns];

    /// Name in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mesh => "mesh",
            Self::Lights => "lights",
            Self::Mirrors => "mirrors",
            Self::Columns => "columns",
        }
    }

    /// What `n` counts.
    #[must_use]
    pub const fn counts(self) -> &'static str {
        match self {
            Self::Mesh => "cells along the side of a grid",
            Self::Lights => "point lights over a grid of 500 x 500 cells (quick: 50 x 50)",
            Self::Mirrors => "bounces at the most in the built-in scene \"mirrors\"",
            Self::Columns => {
                "columns of a 16:9 picture of a grid of 500 x 500 cells (quick: 50 x 50)"
            }
        }
    }

    /// The steps.
    #[must_use]
    pub const fn steps(self, is_quick: bool) -> &'static [u32] {
        match (self, is_quick) {
            (Self::Mesh, false) => &[100, 500, 1000, 1500, 2000, 2500],
            (Self::Mesh, true) => &[50, 100, 200],
            (Self::Lights, false) => &[1, 2, 4, 8, 16],
            (Self::Mirrors, false) => &[0, 1, 2, 4, 8],
            (Self::Columns, false) => &[320, 640, 1280, 1920, 2560],
            (Self::Lights, true) => &[1, 4],
            (Self::Mirrors, true) => &[0, 2],
            (Self::Columns, true) => &[160, 320],
        }
    }
}

/// How the studies are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Growth {
    /// Pictures, pixels; other than in [`Study::Columns`].
    pub size: [u32; 2],
    /// Worker threads; 0 means one per core.
    pub threads: usize,
    /// Passes that are timed.
    pub rounds: usize,
    /// Smaller steps, on a smaller grid.
    pub is_quick: bool,
}

/// One step of a study.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GrowthPoint {
    /// What grows.
    pub study: Study,
    /// As far as here.
    pub n: u32,
    /// Triangles of the mesh.
    pub triangles: usize,
    /// The picture, pixels.
    pub size: [u32; 2],
    /// One sample of each pixel, nothing known before, ms.
    pub full: Spread,
    /// Rays of that pass.
    pub rays: u64,
    /// What the mesh costs, in [`Study::Mesh`].
    pub mesh: Option<MeshCost>,
}

/// What it takes to have a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshCost {
    /// Building the tree, ms.
    pub build: Spread,
    /// Bytes of corners and triangles.
    pub mesh_bytes: usize,
    /// Bytes of the tree.
    pub tree_bytes: usize,
}

impl Growth {
    /// Makes one study, and hands on each step as soon as it is done.
    ///
    /// # Errors
    /// [`BenchError`], or the first of `each`.
    pub fn run<E: From<BenchError>>(
        &self,
        study: Study,
        mut each: impl FnMut(GrowthPoint) -> Result<(), E>,
    ) -> Result<(), E> {
        let grid = || grid_scene(if self.is_quick { GRID / 10 } else { GRID }, self.size);
        let base = match study {
            Study::Mesh => None,
            Study::Lights | Study::Columns => Some(grid()),
            Study::Mirrors => mirrors(self.size),
        };
        for &n in study.steps(self.is_quick) {
            let point = match &base {
                None => self.mesh(n)?,
                Some(base) => self.frame(study, n, &grown(base, study, n), None)?,
            };
            each(point)?;
        }
        Ok(())
    }

    fn mesh(&self, n: u32) -> Result<GrowthPoint, BenchError> {
        let mesh = grid_mesh(n);
        let (bvh, build) = self.build(&mesh)?;
        let cost = MeshCost {
            build,
            mesh_bytes: mesh.bytes(),
            tree_bytes: bvh.stats().bytes,
        };
        let snapshot = grid_snapshot(mesh, bvh, self.size);
        self.frame(Study::Mesh, n, &snapshot, Some(cost))
    }

    fn build(&self, mesh: &TriangleMesh) -> Result<(Bvh, Spread), BenchError> {
        let pool = pool(self.threads)?;
        let (mut bvh, mut times) = (None, Vec::new());
        for _ in 0..self.rounds.clamp(1, BUILDS) {
            // Not two trees at once.
            bvh = None;
            times.push(millis(|| bvh = Some(pool.install(|| Bvh::build(mesh)))));
        }
        let bvh = bvh.unwrap_or_else(|| Bvh::build(mesh));
        Ok((bvh, Spread::of(times)))
    }

    fn frame(
        &self,
        study: Study,
        n: u32,
        snapshot: &Snapshot,
        mesh: Option<MeshCost>,
    ) -> Result<GrowthPoint, BenchError> {
        let case = FrameCase::new(snapshot.clone());
        case.check(&scalar_twin(&snapshot.scene))?;
        let times = case.time(self.threads, self.rounds)?;
        Ok(GrowthPoint {
            study,
            n,
            triangles: snapshot.scene.mesh.len(),
            size: snapshot.size,
            full: times.full,
            rays: times.counters.rays(),
            mesh,
        })
    }
}

/// The built-in scene.
fn mirrors(size: [u32; 2]) -> Option<Snapshot> {
    let loaded = built_in(MIRRORS, &LoadOptions::default())?;
    Some(Snapshot {
        scene: loaded.scene,
        settings: Arc::new(loaded.settings),
        size,
    })
}

/// The scene with one thing changed.
fn grown(base: &Snapshot, study: Study, n: u32) -> Snapshot {
    let mut settings = (*base.settings).clone();
    let mut size = base.size;
    match study {
        Study::Mesh => {}
        Study::Lights => settings.lights = (0..n).map(|i| lamp(i, n)).collect(),
        Study::Mirrors => settings.shading.max_bounces = n,
        Study::Columns => size = [n, n * 9 / 16],
    }
    Snapshot {
        scene: Arc::clone(&base.scene),
        settings: Arc::new(settings),
        size,
    }
}
