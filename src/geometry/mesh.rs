//! Indexed triangles with their attributes.

use glam::{Vec2, Vec3};

use super::Aabb;

/// What a triangle needs besides its corners.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TriangleAttributes {
    /// Index of the material.
    pub material: u16,
    /// Whether the texture coordinates of its corners mean something.
    pub has_uv: bool,
    /// Whether vertex normals are interpolated; otherwise the face normal shades.
    pub smooth: bool,
}

/// Triangles in internal coordinates. A vertex is one combination of position, normal and uv.
///
/// Trusted data: indices are in range and positions finite. Triangles without area were dropped by
/// the loader.
#[derive(Debug, Clone, Default)]
pub struct TriangleMesh {
    /// Vertex positions.
    pub positions: Vec<Vec3>,
    /// Unit vertex normals, one per position; empty where no triangle is smooth.
    pub normals: Vec<Vec3>,
    /// Texture coordinates (v up), one per position; empty where no triangle has any.
    pub uvs: Vec<Vec2>,
    /// Corner indices of each triangle, counter-clockwise seen from the front.
    pub indices: Vec<[u32; 3]>,
    /// One per triangle.
    pub attributes: Vec<TriangleAttributes>,
}

impl TriangleMesh {
    /// Number of triangles.
    #[must_use]
    pub fn len(&self) -> usize {
        self.indices.len()
    }

    /// Whether there are no triangles.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.indices.is_empty()
    }

    /// Corner positions of triangle `prim`.
    ///
    /// # Panics
    /// If `prim` is out of range.
    #[must_use]
    pub fn corners(&self, prim: u32) -> [Vec3; 3] {
        self.indices[prim as usize].map(|i| self.positions[i as usize])
    }

    /// Box around all triangles.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        let corners = self
            .indices
            .iter()
            .flatten()
            .map(|&i| self.positions[i as usize]);
        Aabb::from_points(corners)
    }

    /// Heap bytes of all arrays.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.positions.len() * size_of::<Vec3>()
            + self.normals.len() * size_of::<Vec3>()
            + self.uvs.len() * size_of::<Vec2>()
            + self.indices.len() * size_of::<[u32; 3]>()
            + self.attributes.len() * size_of::<TriangleAttributes>()
    }
}
