//! A hit point in full, and what the maps do to it.

mod baked_frame;
pub mod displaced;
mod facet;
mod hit_point;
mod interaction;
pub mod mapping;
mod terminator;

pub use baked_frame::BakedFrame;
pub use facet::{Facet, FacetKind};
pub use hit_point::{SurfaceParts, footprint, surface_at, surface_on, uv_at};
pub use interaction::SurfaceInteraction;
pub use terminator::SmoothedPoint;
