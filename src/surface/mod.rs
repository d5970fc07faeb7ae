//! A hit point in full, and what the maps do to it.

mod hit_point;
mod interaction;
pub mod mapping;

pub use hit_point::{SurfaceParts, surface_at, uv_at};
pub use interaction::SurfaceInteraction;
