//! Bounding volume hierarchy.

/// A tree over a mesh.
#[derive(Debug, Default)]
pub struct Bvh;
