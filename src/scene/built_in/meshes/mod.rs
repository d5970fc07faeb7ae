//! Generated shapes in world units, z up, each with texture coordinates and smooth normals.

mod revolution;
mod solids;
mod world_mesh;

pub use revolution::{Curve, fluted_shaft, revolve};
pub use solids::{bevelled_box, disc, quad, sphere, torus};
pub use world_mesh::{Vertex, WorldMesh};

use glam::{DAffine3, DVec3};

/// Moves a shape from the origin to `position`.
#[must_use]
pub fn at(position: DVec3) -> DAffine3 {
    DAffine3::from_translation(position)
}
