//! Reliefscope.
pub mod geometry;
pub mod math;
