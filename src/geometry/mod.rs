//! Rays, boxes, triangles and the bounding volume hierarchy.
//!
//! Everything here is in *internal* coordinates: `f32`, usually centred and scaled by a power of two
//! when the model was loaded (see [`Normalization`]).

mod aabb;
mod bundle;
pub mod bvh;
mod kernel;
mod mesh;
mod normalization;
mod ray;
mod slabs;
mod tangents;
pub mod triangle;
mod uv_charts;
mod uv_outline;

/// The vector instructions that trees are traced with.
pub use crate::math::simd;
pub use aabb::Aabb;
pub use bvh::Bvh;
pub use kernel::{Kernel, OffsetRule};
pub use mesh::{TriangleAttributes, TriangleMesh};
pub use normalization::Normalization;
pub use ray::{
    CachedHit, DisplacedLanes, Hit, HitLanes, NO_HIT, OriginRule, Ray, RayLanes, offset_by_bound,
    offset_origin,
};
pub use slabs::RaySlabs;
pub use tangents::{Tangent, TangentCell, Tangents};
pub use uv_charts::{UvBox, UvChart, UvChartCell, UvCharts};
