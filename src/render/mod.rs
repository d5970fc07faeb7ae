//! From a scene and settings to a picture.

mod counters;
mod film;
mod probe;
mod progressive;

pub use counters::Counters;
pub use film::Film;
pub use probe::{PixelStory, probe};
pub use progressive::{PassEnd, PassReport, Progressive, Snapshot};
