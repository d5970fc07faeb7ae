//! One binary for all integration tests, so that they link once.

mod bvh;
mod layering;
mod metrics;
mod numerics;
mod oracle;
mod reference;
mod shapes;
