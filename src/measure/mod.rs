//! How far a picture or a number is from the truth: the report's equations, and distances of pictures.

pub mod metrics;
mod picture;
pub mod report_equations;

pub use picture::{picture_from_image, read_picture};
