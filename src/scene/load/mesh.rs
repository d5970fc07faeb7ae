//! From polygons with separate indices to a triangle mesh in internal units.

mod vertices;

use glam::{DVec3, Vec2, Vec3};

use super::LoadOptions;
use super::normals::complete_normals;
use super::obj::{Corner, NONE, Obj, Span};
use super::polygon::Triangulator;
use crate::geometry::{Normalization, TriangleAttributes, TriangleMesh};
use crate::math::normalize_or;
use crate::scene::{LoadError, ModelFacts};
use vertices::VertexTable;

/// Faces between two looks at the monitor.
const FACES_PER_REPORT: usize = 16_384;

/// Radians (0.01°: what the four decimals of an exported `vn` resolve) up to which a vertex normal counts
/// as the triangle's own.
const SAME_NORMAL: f64 = 2e-4;

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

/// Triangulates the faces, completes their normals and joins corners that agree in every attribute.
/// The monitor is told fractions within `share`.
///
/// A triangle is *smooth* only where some corner's normal differs from its own: flat ones need no
/// interpolation. Triangles without area in single precision are counted and left out.
pub(super) fn assemble(
    mut obj: Obj,
    options: &LoadOptions,
    share: [f32; 2],
) -> Result<Assembly, LoadError> {
    let bounds = bounds(&obj);
    let normalization = match bounds {
        Some([min, max]) if options.normalize => Normalization::fit(min, max),
        _ => Normalization::IDENTITY,
    };
    complete_normals(&mut obj);
    let mut builder = Builder::new(&obj, normalization);
    for (span, faces) in obj.spans() {
        for face in faces {
            if face % FACES_PER_REPORT == 0 {
                let done = face as f32 / obj.faces.len() as f32;
                options
                    .monitor
                    .reached(share[0] + (share[1] - share[0]) * done)?;
            }
            builder.face(span, face);
        }
    }
    let mut assembly = builder.finish();
    assembly.facts.bounds = bounds;
    Ok(assembly)
}

/// Box around the finite positions that faces use.
fn bounds(obj: &Obj) -> Option<[DVec3; 2]> {
    let used = obj.corners.iter().map(|c| obj.positions[c.v as usize]);
    used.filter(|p| p.is_finite()).fold(None, |bounds, p| {
        let [min, max] = bounds.unwrap_or([p, p]);
        Some([min.min(p), max.max(p)])
    })
}

struct Builder<'a> {
    obj: &'a Obj,
    normalization: Normalization,
    triangulator: Triangulator,
    polygon: Vec<DVec3>,
    table: VertexTable,
    indices: Vec<[u32; 3]>,
    attributes: Vec<TriangleAttributes>,
    facts: ModelFacts,
    crossed: Vec<u32>,
}

impl<'a> Builder<'a> {
    fn new(obj: &'a Obj, normalization: Normalization) -> Self {
        let triangles = obj.corners.len().saturating_sub(2 * obj.faces.len());
        Self {
            obj,
            normalization,
            triangulator: Triangulator::default(),
            polygon: Vec::new(),
            table: VertexTable::with_capacity(obj.positions.len().min(obj.corners.len())),
            indices: Vec::with_capacity(triangles),
            attributes: Vec::with_capacity(triangles),
            facts: ModelFacts {
                path: Some(obj.path.clone()),
                vertices: obj.positions.len(),
                ..ModelFacts::default()
            },
            crossed: Vec::new(),
        }
    }

    fn face(&mut self, span: Span, face: usize) {
        let corners = &self.obj.corners[self.obj.corners_of(face)];
        if corners.is_empty() {
            return;
        }
        let position = |c: &Corner| self.obj.positions[c.v as usize];
        self.polygon.clear();
        self.polygon.extend(corners.iter().map(position));
        let mut triangulator = std::mem::take(&mut self.triangulator);
        let result = triangulator.triangulate(&self.polygon);
        let area = result.area_vector.length();
        if area.is_finite() {
            self.facts.area += area;
        }
        if result.crossed {
            self.crossed.push(self.obj.faces[face].line);
        }
        for triangle in result.triangles {
            self.triangle(span.material, triangle.map(|i| corners[i as usize]));
        }
        self.facts.triangles += corners.len() - 2;
        self.triangulator = triangulator;
    }

    fn triangle(&mut self, material: u16, corners: [Corner; 3]) {
        let world = corners.map(|c| self.obj.positions[c.v as usize]);
        let internal = world.map(|p| self.normalization.internal_from_world(p));
        if !has_area(internal) {
            return;
        }
        let own = (world[1] - world[0])
            .cross(world[2] - world[0])
            .normalize_or_zero();
        let smooth = corners.iter().all(|c| c.vn != NONE)
            && corners
                .iter()
                .any(|c| differs(self.obj.normals[c.vn as usize], own));
        self.indices.push(corners.map(|c| {
            self.table
                .index_of([c.v, c.vt, if smooth { c.vn } else { NONE }])
        }));
        self.attributes.push(TriangleAttributes {
            material,
            has_uv: corners[0].vt != NONE,
            smooth,
        });
    }

    fn finish(mut self) -> Assembly {
        self.indices.shrink_to_fit();
        self.attributes.shrink_to_fit();
        self.facts.degenerate = self.facts.triangles - self.indices.len();
        let keys = self.table.into_keys();
        let obj = self.obj;
        let internal = |v: u32| {
            self.normalization
                .internal_from_world(obj.positions[v as usize])
        };
        let mut mesh = TriangleMesh {
            positions: keys.iter().map(|k| internal(k[0])).collect(),
            normals: Vec::new(),
            uvs: Vec::new(),
            indices: self.indices,
            attributes: self.attributes,
        };
        if mesh.attributes.iter().any(|a| a.has_uv) {
            let uv = |vt: u32| obj.uvs.get(vt as usize).copied().unwrap_or(Vec2::ZERO);
            mesh.uvs = keys.iter().map(|k| uv(k[1])).collect();
        }
        if mesh.attributes.iter().any(|a| a.smooth) {
            let normal = |vn: u32| obj.normals.get(vn as usize).copied().unwrap_or(Vec3::ZERO);
            mesh.normals = keys.iter().map(|k| normal(k[2])).collect();
            fill_flat_normals(&mut mesh);
        }
        Assembly {
            mesh,
            normalization: self.normalization,
            facts: self.facts,
            crossed: self.crossed,
        }
    }
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

/// Whether a triangle has an area that single precision can see. A sliver whose cross product rounds to
/// zero would have no normal to shade with.
fn has_area([a, b, c]: [Vec3; 3]) -> bool {
    let single = (b - a).cross(c - a);
    let [a, b, c] = [a, b, c].map(Vec3::as_dvec3);
    let exact = (b - a).cross(c - a);
    single.is_finite() && single != Vec3::ZERO && exact != DVec3::ZERO
}

fn differs(normal: Vec3, own: DVec3) -> bool {
    (normal.as_dvec3() - own).length_squared() > SAME_NORMAL * SAME_NORMAL
}
