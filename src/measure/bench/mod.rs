//! How long the parts of a picture take, and how that grows. Nothing is timed before it is checked.
//!
//! - `frame`: a frame's parts, as the window meets them; `stages`: where its passes spend their time
//! - `trace`: rays of one kind, alone
//! - `growth`: frames against the size of the mesh (`grid`), lights, mirrors and pixels
//! - `ray_file`: rays and triangles in a file, so that another tracer can do the same work
//! - `points`: look-ups at many points, for micro-benchmarks
//! - `check`: what must be true before a time means anything
//! - `spread`, `machine`: how times are told, and of what

mod check;
mod frame;
mod grid;
mod growth;
mod machine;
pub mod points;
pub mod ray_file;
mod spread;
mod stages;
mod trace;

pub use check::{BenchError, scalar_twin};
pub use frame::{FrameCase, FrameTimes};
pub use grid::grid_scene;
pub use growth::{Growth, GrowthPoint, MeshCost, Study};
pub use machine::Machine;
pub use spread::Spread;
pub use stages::StageTimes;
pub use trace::{Answers, RayRace, RaySpeed};

/// A pool of that many threads; 0 means one per core.
fn pool(threads: usize) -> Result<rayon::ThreadPool, BenchError> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(|i| format!("bench-{i}"))
        .build()
        .map_err(|error| BenchError::Threads(std::io::Error::other(error)))
}
