//! Every test that needs more than one room, in one binary: one link.

mod bvh;
mod mapping;
mod numerics;
mod progressive;
mod shapes;
mod support;
