//! How far a picture or a number is from the truth, and how long it took: the report's equations, distances
//! of pictures, what accuracy costs, benchmarks, the matrix of extremes, and how a window feels.

pub mod bench;
pub mod drawing;
pub mod error_map;
pub mod feel;
pub mod flip;
pub mod metrics;
mod picture;
pub mod profile_drawing;
pub mod report_equations;
pub mod stability;
pub mod stage_clock;
pub mod trade;

pub use picture::{picture_from_image, read_picture};
