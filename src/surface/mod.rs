//! A hit point in full, and what the maps do to it.

pub mod mapping;

mod interaction;

pub use interaction::SurfaceInteraction;
