//! One displacement normal for each place of a mesh.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use crate::geometry::TriangleMesh;

/// Vertices brought together by their positions.
#[derive(Debug)]
pub struct Welded {
    /// Number of each vertex's place; vertices in the same place have the same.
    pub places: Vec<u32>,
    /// Displacement normal of each vertex: unit, or zero where the normals around cancel.
    pub normals: Vec<Vec3>,
}

/// Averages the normals of the triangles around each place, weighed by their angles there, so that the
/// cutting of a face into triangles does not matter.
pub fn weld(mesh: &TriangleMesh, prims: &[u32]) -> Welded {
    let mut numbers = HashMap::with_capacity(mesh.positions.len());
    let places: Vec<u32> = mesh
        .positions
        .iter()
        .map(|p| {
            let next = numbers.len() as u32;
            // −0 is the same place as 0.
            let key = (*p + Vec3::ZERO).to_array().map(f32::to_bits);
            *numbers.entry(key).or_insert(next)
        })
        .collect();
    let mut sums = vec![DVec3::ZERO; numbers.len()];
    for &prim in prims {
        let corners = mesh.indices[prim as usize];
        let p = mesh.corners(prim).map(|p| p.as_dvec3());
        let face = (p[1] - p[0]).cross(p[2] - p[0]).normalize_or_zero();
        let smooth = mesh.attributes[prim as usize].smooth;
        for (k, vertex) in corners.into_iter().enumerate() {
            let normal = if smooth {
                mesh.normals[vertex as usize].as_dvec3().normalize_or(face)
            } else {
                face
            };
            let [to_next, to_last] = [1, 2].map(|step| p[(k + step) % 3] - p[k]);
            sums[places[vertex as usize] as usize] += normal * to_next.angle_between(to_last);
        }
    }
    let normals = places
        .iter()
        .map(|&place| sums[place as usize].normalize_or_zero().as_vec3());
    Welded {
        normals: normals.collect(),
        places,
    }
}
