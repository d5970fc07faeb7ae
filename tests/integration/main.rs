//! One binary for all integration tests, so that they link once.

#![allow(
    clippy::unwrap_used,
    reason = "a test that panics has failed; the configuration exempts only the test functions themselves"
)]

mod bvh;
mod layering;
mod mapping;
mod metrics;
mod numerics;
mod oracle;
mod progressive;
mod reference;
mod shapes;
mod support;
