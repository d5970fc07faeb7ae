//! Reliefscope.
pub mod cli;
pub mod geometry;
pub mod math;
pub mod measure;
pub mod render;
pub mod scene;
pub mod shading;
pub mod surface;
pub mod texture;
#[cfg(feature = "viewer")]
pub mod viewer;
