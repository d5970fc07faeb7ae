//! From polygons with separate indices to a triangle mesh in internal units.

mod triangles;
mod vertices;

use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;

use super::normals::complete_normals;
use super::obj::Obj;
use super::{LoadOptions, Stage};
use crate::geometry::{Normalization, TriangleMesh};
use crate::math::normalize_or;
use crate::scene::{LoadError, ModelFacts};
use triangles::{Piece, triangulate};
use vertices::VertexTable;

/// Corners or vertices that a thread takes at a time.
const SHARED_MIN: usize = 16_384;

/// A mesh and what its file says.
pub(super) struct Assembly {
    /// In internal units.
    pub mesh: TriangleMesh,
    /// Between world and internal units.
    pub normalization: Normalization,
    /// Counts, area and box.
    pub facts: ModelFacts,
    /// Lines of faces whose triangles overlap because the face crosses itself.
    pub crossed: Vec<u32>,
}

/// Triangulates the faces, completes their normals and joins corners that agree in every attribute, on the
/// current rayon pool.
///
/// A triangle is *smooth* only where some corner's normal differs from its own: flat ones need no
/// interpolation. Triangles without area in single precision are counted and left out.
pub(super) fn assemble(mut obj: Obj, options: &LoadOptions) -> Result<Assembly, LoadError> {
    let monitor = &*options.monitor;
    monitor.reached(Stage::Assembling, 0.0)?;
    let bounds = bounds(&obj);
    let normalization = match bounds {
        Some([min, max]) if options.normalize => Normalization::fit(min, max),
        _ => Normalization::IDENTITY,
    };
    complete_normals(&mut obj, monitor)?;
    let pieces = triangulate(&obj, &normalization, monitor)?;
    let mut facts = ModelFacts {
        path: Some(obj.path.clone()),
        vertices: obj.positions.len(),
        triangles: pieces.iter().map(|p| p.counted).sum(),
        area: pieces.iter().map(|p| p.area).sum(),
        bounds,
        ..ModelFacts::default()
    };
    let crossed = pieces.iter().flat_map(|p| &p.crossed).copied().collect();
    let mesh = join(&obj, &normalization, pieces);
    facts.degenerate = facts.triangles - mesh.len();
    Ok(Assembly {
        mesh,
        normalization,
        facts,
        crossed,
    })
}

/// Box around the finite positions that faces use.
fn bounds(obj: &Obj) -> Option<[DVec3; 2]> {
    let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let [min, max] = obj
        .corners
        .par_iter()
        .with_min_len(SHARED_MIN)
        .map(|c| obj.positions[c.v as usize])
        .filter(|p| p.is_finite())
        .fold(|| none, |[min, max], p| [min.min(p), max.max(p)])
        .reduce(|| none, |a, b| [a[0].min(b[0]), a[1].max(b[1])]);
    min.is_finite().then_some([min, max])
}

/// Gives each combination of position, texture coordinate and normal a vertex, in the order of first use.
fn join(obj: &Obj, normalization: &Normalization, pieces: Vec<Piece>) -> TriangleMesh {
    let triangles = pieces.iter().map(|p| p.triangles.len()).sum();
    let mut mesh = TriangleMesh {
        indices: Vec::with_capacity(triangles),
        attributes: Vec::with_capacity(triangles),
        ..TriangleMesh::default()
    };
    let mut table = VertexTable::with_capacity(obj.positions.len().min(3 * triangles));
    for triangle in pieces.into_iter().flat_map(|p| p.triangles) {
        mesh.indices.push(triangle.keys.map(|k| table.index_of(k)));
        mesh.attributes.push(triangle.attributes);
    }
    let keys = table.into_keys();
    mesh.positions = per_vertex(&keys, |[v, _, _]| {
        normalization.internal_from_world(obj.positions[v as usize])
    });
    if mesh.attributes.iter().any(|a| a.has_uv) {
        let uv = |vt: u32| obj.uvs.get(vt as usize).copied();
        mesh.uvs = per_vertex(&keys, |[_, vt, _]| uv(vt).unwrap_or(Vec2::ZERO));
    }
    if mesh.attributes.iter().any(|a| a.smooth) {
        let normal = |vn: u32| obj.normals.get(vn as usize).copied();
        mesh.normals = per_vertex(&keys, |[_, _, vn]| normal(vn).unwrap_or(Vec3::ZERO));
        fill_flat_normals(&mut mesh);
    }
    mesh
}

fn per_vertex<T: Send>(keys: &[[u32; 3]], value: impl Fn([u32; 3]) -> T + Sync) -> Vec<T> {
    let keys = keys.par_iter().with_min_len(SHARED_MIN);
    keys.map(|key| value(*key)).collect()
}

/// Vertices of flat triangles have no normal of their own, but normals are unit vectors everywhere.
fn fill_flat_normals(mesh: &mut TriangleMesh) {
    for (prim, attributes) in mesh.attributes.iter().enumerate() {
        if !attributes.smooth {
            let [a, b, c] = mesh.corners(prim as u32);
            let own = normalize_or((b - a).cross(c - a), Vec3::Z);
            for vertex in mesh.indices[prim] {
                mesh.normals[vertex as usize] = own;
            }
        }
    }
}
