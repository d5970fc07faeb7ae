//! Where a view ray meets the relief over a surface point: searches that sample, and the exact walk.
//!
//! - `shell`: the view ray through the layer that the relief fills
//! - `march`: fixed numbers of samples, and their refinements
//! - `cones`: steps as wide as a map of cones allows
//! - `field`, `typed`, `cell_span`: the relief and its extremes, as a map stores them
//! - `ray`, `walk`, `axis`, `parabola`: cell by cell through a pyramid of extremes, exact
//! - `walk_lanes`, `lane_axis`: many walks in step
//! - `field_lanes`: the relief at many places
//! - `exact`: the walk for surface points, for the eye and for lights

mod axis;
mod cell_span;
mod cones;
mod exact;
mod field;
mod field_lanes;
mod lane_axis;
mod march;
mod parabola;
mod ray;
mod shell;
mod typed;
mod walk;
mod walk_lanes;

use crate::math::V2;

pub use cones::cone_steps;
pub use exact::{
    LIFT, exact, found, is_shadowed, landed, light_ray, most_steps, rising_ray, sinking_ray,
    view_ray,
};
pub use field::ReliefField;
pub use march::{Layers, Refinement, iterate, march};
pub use ray::{ReliefRay, Side};
pub use walk::Walk;

/// What a search came to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found<F = f32> {
    /// Texture coordinate seen.
    pub uv: V2<F>,
    /// Displacement along the normal of the place on the view ray, internal units.
    pub z: F,
    /// Height samples taken, or nodes walked.
    pub steps: F,
}
