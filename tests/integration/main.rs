//! One binary for all integration tests, so that they link once.

mod bvh;
mod layering;
mod mapping;
mod metrics;
mod numerics;
mod progressive;
mod reference;
mod shapes;
mod support;
#[cfg(feature = "viewer")]
mod viewer;
