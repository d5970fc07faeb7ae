//! From a mesh in world units to a scene.

use glam::DVec3;

use super::meshes::WorldMesh;
use crate::geometry::bvh::Bvh;
use crate::geometry::{Normalization, TriangleMesh};
use crate::scene::load::LoadOptions;
use crate::scene::{ModelFacts, Scene, SceneSource};
use crate::texture::MapImage;

/// Builds a scene around generated geometry: normalises it like a loaded model, drops triangles that have
/// no area in single precision, collects the facts and builds the tree.
#[must_use]
pub fn assemble(
    name: &str,
    source: SceneSource,
    mesh: &WorldMesh,
    images: Vec<MapImage>,
    options: &LoadOptions,
) -> Scene {
    let bounds = bounds(mesh);
    let normalization = match bounds {
        Some([min, max]) if options.normalize => Normalization::fit(min, max),
        _ => Normalization::IDENTITY,
    };
    let internal = internal_mesh(mesh, &normalization);
    let facts = ModelFacts {
        path: None,
        vertices: mesh.vertices.len(),
        triangles: mesh.indices.len(),
        degenerate: mesh.indices.len() - internal.len(),
        area: mesh
            .indices
            .iter()
            .map(|&corners| 0.5 * mesh.area_vector(corners).length())
            .sum(),
        bounds,
    };
    Scene {
        displaced: crate::surface::displaced::DisplacementCell::default(),
        tangents: crate::geometry::TangentCell::default(),
        uv_charts: crate::geometry::UvChartCell::default(),
        name: name.to_owned(),
        source,
        bvh: Bvh::build(&internal),
        mesh: internal,
        normalization,
        images,
        facts,
    }
}

/// Corners of the box around used vertices.
fn bounds(mesh: &WorldMesh) -> Option<[DVec3; 2]> {
    let mut corners = mesh
        .indices
        .iter()
        .flatten()
        .map(|&i| mesh.vertices[i as usize].position);
    let first = corners.next()?;
    Some(corners.fold([first, first], |[min, max], p| [min.min(p), max.max(p)]))
}

fn internal_mesh(mesh: &WorldMesh, normalization: &Normalization) -> TriangleMesh {
    let mut internal = TriangleMesh {
        positions: mesh
            .vertices
            .iter()
            .map(|v| normalization.internal_from_world(v.position))
            .collect(),
        normals: mesh.vertices.iter().map(|v| v.normal.as_vec3()).collect(),
        uvs: mesh.vertices.iter().map(|v| v.uv.as_vec2()).collect(),
        ..TriangleMesh::default()
    };
    for (&corners, &attributes) in mesh.indices.iter().zip(&mesh.attributes) {
        let [a, b, c] = corners.map(|i| internal.positions[i as usize].as_dvec3());
        if (b - a).cross(c - a) != DVec3::ZERO {
            internal.indices.push(corners);
            internal.attributes.push(attributes);
        }
    }
    internal
}
