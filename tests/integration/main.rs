//! One binary for all integration tests, so that they link once.

#![allow(clippy::unwrap_used, reason = "a test that panics has failed")]

mod answers;
mod bench;
mod bent_normals;
mod borders;
mod built_in;
mod bundles;
mod bvh;
mod cli;
mod cli_measure;
mod destair;
mod displaced_holes;
mod filter;
mod fuzz;
mod golden;
mod layering;
mod load_large;
mod load_mtl;
mod load_obj;
mod mapping;
#[cfg(target_os = "linux")]
mod memory;
mod metrics;
mod normal_maps;
mod numerics;
mod oracle;
mod progressive;
mod reference;
mod scene_file;
mod shapes;
mod specular;
mod stability;
mod support;
mod terminator;
mod trade;
#[cfg(feature = "viewer")]
mod viewer;
mod views;
