//! How far a picture or a number is from the truth, and how long it took: the report's equations, distances
//! of pictures, benchmarks.

pub mod bench;
pub mod error_map;
pub mod flip;
pub mod metrics;
mod picture;
pub mod report_equations;

pub use picture::{picture_from_image, read_picture};
