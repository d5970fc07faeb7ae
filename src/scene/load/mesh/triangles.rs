//! From polygons to triangles, many faces at the same time.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::geometry::{Normalization, TriangleAttributes};
use crate::scene::LoadError;
use crate::scene::load::obj::{Corner, NONE, Obj, Span};
use crate::scene::load::polygon::Triangulator;
use crate::scene::load::{LoadMonitor, Stage};

/// Faces of a piece: few enough to share the work well and to stop soon.
const PIECE: usize = 8192;

/// Radians (0.01°: what the four decimals of an exported `vn` resolve) up to which a vertex normal counts
/// as the triangle's own.
const SAME_NORMAL: f64 = 2e-4;

/// A triangle whose corners are not joined to vertices yet.
pub(super) struct Triangle {
    /// Of each corner what makes its vertex: position, texture coordinate, normal or [`NONE`].
    pub keys: [[u32; 3]; 3],
    pub attributes: TriangleAttributes,
}

/// Triangles of some faces of the same material.
#[derive(Default)]
pub(super) struct Piece {
    /// Those with an area.
    pub triangles: Vec<Triangle>,
    /// How many there are with the others.
    pub counted: usize,
    /// Surface area, world units.
    pub area: f64,
    /// Lines of faces whose triangles overlap because the face crosses itself.
    pub crossed: Vec<u32>,
}

/// Triangulates all faces; the pieces come in the order of the file.
pub(super) fn triangulate(
    obj: &Obj,
    normalization: &Normalization,
    monitor: &LoadMonitor,
) -> Result<Vec<Piece>, LoadError> {
    let pieces: Vec<_> = obj
        .spans()
        .flat_map(|(span, faces)| {
            let starts = faces.clone().step_by(PIECE);
            starts.map(move |start| (span, start..faces.end.min(start + PIECE)))
        })
        .collect();
    let done = AtomicUsize::new(0);
    pieces
        .into_par_iter()
        .with_max_len(1)
        .map_init(Cutter::default, |cutter, (span, faces)| {
            let done = done.fetch_add(faces.len(), Ordering::Relaxed);
            monitor.reached(Stage::Assembling, done as f32 / obj.faces.len() as f32)?;
            Ok(cutter.piece(obj, normalization, span, faces))
        })
        .collect()
}

/// Memory that is used again for every face.
#[derive(Default)]
struct Cutter {
    triangulator: Triangulator,
    polygon: Vec<DVec3>,
}

impl Cutter {
    fn piece(
        &mut self,
        obj: &Obj,
        normalization: &Normalization,
        span: Span,
        faces: Range<usize>,
    ) -> Piece {
        let corners = obj.corners_of(faces.start).start..obj.corners_of(faces.end - 1).end;
        let mut piece = Piece {
            triangles: Vec::with_capacity(corners.len().saturating_sub(2 * faces.len())),
            ..Piece::default()
        };
        for face in faces {
            let corners = &obj.corners[obj.corners_of(face)];
            if corners.is_empty() {
                continue;
            }
            self.polygon.clear();
            let position = |c: &Corner| obj.positions[c.v as usize];
            self.polygon.extend(corners.iter().map(position));
            let result = self.triangulator.triangulate(&self.polygon);
            let area = result.area_vector.length();
            if area.is_finite() {
                piece.area += area;
            }
            if result.crossed {
                piece.crossed.push(obj.faces[face].line);
            }
            let triangles = result.triangles.iter().filter_map(|triangle| {
                let corners = triangle.map(|i| corners[i as usize]);
                Triangle::new(obj, normalization, span.material, corners)
            });
            piece.triangles.extend(triangles);
            piece.counted += corners.len() - 2;
        }
        piece
    }
}

impl Triangle {
    /// `None` without area.
    fn new(
        obj: &Obj,
        normalization: &Normalization,
        material: u16,
        corners: [Corner; 3],
    ) -> Option<Self> {
        let world = corners.map(|c| obj.positions[c.v as usize]);
        if !has_area(world.map(|p| normalization.internal_from_world(p))) {
            return None;
        }
        let own = (world[1] - world[0])
            .cross(world[2] - world[0])
            .normalize_or_zero();
        let smooth = corners.iter().all(|c| c.vn != NONE)
            && corners
                .iter()
                .any(|c| differs(obj.normals[c.vn as usize], own));
        Some(Self {
            keys: corners.map(|c| [c.v, c.vt, if smooth { c.vn } else { NONE }]),
            attributes: TriangleAttributes {
                material,
                has_uv: corners[0].vt != NONE,
                smooth,
            },
        })
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
