//! Right at the extremes: what goes wrong where numbers are very large, very small or very slanted, measured.
//!
//! The list of tests is one ([`tests`]); the command line prints it and the test suite runs a small form of
//! it. Each test is a pure function of a [`Plan`]: no clock, no thread count, no order of work in it.
//!
//! - `plan`: how much is tested and with which kernel; what a test is and what it found
//! - `run`: the tests on a pool, told in order
//! - `random`, `bodies`, `placement`, `trees`: rays and meshes, where they are put, the levels they are traced by
//! - `oracle`: rays and triangles in `f64`, by brute force, with a margin of doubt
//!
//! The families:
//!
//! - `watertight`: no ray leaves a closed mesh; `displaced`: nor one that is truly displaced; `scans`: nor a scan
//! - `borders`: none hits what it passes by
//! - `accuracy`: distances, weights, points and normals
//! - `contact`: no false shadow, no lost contact, ray by ray; `convex`: the same in pictures
//! - `terminator`: where light ends on coarse meshes
//! - `sweep`: a camera that moves less than a pixel
//! - `methods`, `maps`: every method at all angles, amplitudes and maps (`board` is their scene)
//! - `shading`: highlights, lights and mirrors
//! - `faces`: charts, normals and triangles that are not what they should be

mod accuracy;
mod board;
mod bodies;
mod borders;
mod contact;
mod convex;
mod displaced;
mod faces;
mod maps;
mod methods;
mod oracle;
mod placement;
mod plan;
mod random;
mod run;
mod scans;
mod shading;
mod sweep;
mod terminator;
mod trees;
mod watertight;

pub use crate::geometry::triangle::PlainWoop;
pub use crate::geometry::{Kernel, OffsetRule};
pub use plan::{Effort, Finding, Plan, Test};
pub use random::Random;
pub use run::{Outcome, run};
pub use scans::scan_tests;

/// Every test of a plan, family by family, but for [those of scans](scan_tests).
#[must_use]
pub fn tests(plan: &Plan) -> Vec<Test> {
    let families = [
        watertight::tests,
        displaced::tests,
        borders::tests,
        accuracy::tests,
        contact::tests,
        convex::tests,
        terminator::tests,
        sweep::tests,
        methods::tests,
        maps::tests,
        shading::tests,
        faces::tests,
    ];
    families.iter().flat_map(|family| family(plan)).collect()
}
