//! Every test that needs more than one room, in one binary: one link.

mod bvh;
mod numerics;
mod shapes;
