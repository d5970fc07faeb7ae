//! Generated shapes in world units, z up, each with texture coordinates and smooth normals.

mod revolution;
mod solids;
mod world_mesh;

pub use revolution::{Curve, fluted_shaft, revolve};
pub use solids::{bevelled_box, disc, quad, sphere, torus};
pub use world_mesh::{Vertex, WorldMesh};

use std::f64::consts::TAU;

use glam::{DAffine3, DVec3};

/// Sine and cosine of an angle in turns, for closed shapes: a whole turn is none, and what should be 0 is, so that
/// their ends meet to the bit.
fn sin_cos_turns(turns: f64) -> (f64, f64) {
    let turns = if turns == 1.0 { 0.0 } else { turns };
    let (sin, cos) = (turns * TAU).sin_cos();
    let exact = |x: f64| if x.abs() < 1e-15 { 0.0 } else { x };
    (exact(sin), exact(cos))
}

/// Moves a shape from the origin to `position`.
#[must_use]
pub fn at(position: DVec3) -> DAffine3 {
    DAffine3::from_translation(position)
}
