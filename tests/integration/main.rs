//! Every test that needs more than one room, in one binary: one link.

#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

mod bvh;
mod numerics;
mod shapes;
