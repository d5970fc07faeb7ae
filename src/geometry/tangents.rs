//! Tangents at the corners of triangles, as bakers of normal maps make them.

use std::collections::HashMap;
use std::sync::OnceLock;

use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::Vec3;

use super::TriangleMesh;
use crate::math::normalize_or;

/// Normals at one place that differ by less are one normal (0.01°, what four decimals of a file resolve).
/// Triangles that are flat got theirs from their corners, which rounds otherwise than the file's.
const SAME_NORMAL: f32 = 2e-4;

/// A tangent and the sign of the bitangent, `sign · (n × t)`.
pub type Tangent = [f32; 4];

/// What MikkTSpace makes of a mesh: a unit tangent for each corner of each triangle, shared by neighbours that
/// agree in place, normal, texture coordinate and handedness.
///
/// Zero where triangles have no texture coordinates, or a chart without area and no neighbour to borrow from.
/// The mesh counts as triangles: a baker that sees quads may cut them otherwise.
///
/// Source: Mikkelsen 2008, "Simulation of Wrinkled Surfaces Revisited"; mikktspace.com.
#[derive(Debug, Clone, PartialEq)]
pub struct Tangents(Vec<[Tangent; 3]>);

impl Tangents {
    /// Works them out.
    #[must_use]
    pub fn new(mesh: &TriangleMesh) -> Self {
        let prims = 0..mesh.len() as u32;
        let mut chart = Chart {
            mesh,
            normals: corner_normals(mesh),
            prims: prims
                .filter(|&prim| mesh.attributes[prim as usize].has_uv)
                .collect(),
            tangents: vec![[[0.0; 4]; 3]; mesh.len()],
        };
        // Its error has no cases: nothing can go wrong.
        let _ = generate_tangents(&mut chart);
        Self(chart.tangents)
    }

    /// Those of all corners, three for each triangle.
    #[inline]
    #[must_use]
    pub const fn corners(&self) -> &[Tangent] {
        self.0.as_slice().as_flattened()
    }

    /// Heap bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(self.0.as_slice())
    }
}

/// The tangents of one mesh, made when a material first asks for them.
#[derive(Debug, Default)]
pub struct TangentCell(OnceLock<Tangents>);

impl TangentCell {
    /// Those of the mesh that the cell belongs to.
    pub fn get(&self, mesh: &TriangleMesh) -> &Tangents {
        self.0.get_or_init(|| Tangents::new(mesh))
    }

    /// Heap bytes, 0 as long as nobody asked.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.0.get().map_or(0, Tangents::bytes)
    }
}

impl Clone for TangentCell {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// The normal at each corner: the one that shades, and the same bits where neighbours mean the same.
fn corner_normals(mesh: &TriangleMesh) -> Vec<[Vec3; 3]> {
    let mut known: HashMap<[u32; 3], Vec<Vec3>> = HashMap::new();
    let mut shared = |p: Vec3, n: Vec3| {
        let here = known.entry(p.to_array().map(f32::to_bits)).or_default();
        let same = |m: &&Vec3| (**m - n).length_squared() < SAME_NORMAL * SAME_NORMAL;
        let found = here.iter().find(same).copied();
        found.unwrap_or_else(|| {
            here.push(n);
            n
        })
    };
    let mut normals = Vec::with_capacity(mesh.len());
    for (prim, attributes) in mesh.attributes.iter().enumerate() {
        let corners = mesh.corners(prim as u32);
        let [a, b, c] = corners;
        let own = normalize_or((b - a).cross(c - a), Vec3::Z);
        let [i, j, k] = mesh.indices[prim].map(|i| i as usize);
        let each = if attributes.smooth {
            [mesh.normals[i], mesh.normals[j], mesh.normals[k]]
        } else {
            [own; 3]
        };
        normals.push([0, 1, 2].map(|corner| shared(corners[corner], each[corner])));
    }
    normals
}

/// A mesh as the generator reads it.
struct Chart<'a> {
    mesh: &'a TriangleMesh,
    normals: Vec<[Vec3; 3]>,
    /// Triangles with texture coordinates.
    prims: Vec<u32>,
    tangents: Vec<[Tangent; 3]>,
}

impl Chart<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.indices[self.prims[face] as usize][corner] as usize
    }
}

impl Geometry for Chart<'_> {
    fn num_faces(&self) -> usize {
        self.prims.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.positions[self.vertex(face, corner)].to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.normals[self.prims[face] as usize][corner].to_array()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        self.mesh.uvs[self.vertex(face, corner)].to_array()
    }

    fn set_tangent(&mut self, made: Option<TangentSpace>, face: usize, corner: usize) {
        let tangent = made.map_or([0.0; 4], |made| made.tangent_encoded());
        let prim = self.prims[face] as usize;
        self.tangents[prim][corner] = tangent;
    }
}
