//! From a scene and settings to a picture.

mod counters;

pub use counters::Counters;
