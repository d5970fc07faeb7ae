//! True displacement: the surface `S = p + d(uv)·n` over each triangle of a mesh, with its silhouettes.
//!
//! `p` and `n` are linear over the triangle, `n` is not normalised; `d = amplitude·(h − midlevel)` with the
//! bilinear height `h`.
//!
//! - `weld`: one normal for each place, so that hard edges do not tear
//! - `seams`: edges at which texture coordinates jump; heights are averaged along them
//! - `charts`: which triangles are flat reliefs, and how fine the others are cut up
//! - `sheets`: which flat reliefs of many triangles are walked as one
//! - `flat`: where `n` is constant: the exact walk answers, nothing is cut up
//! - `pieces`: elsewhere: which pieces of much the same size triangles fall into
//! - `fine`: micro-triangles of pieces, made where rays come, from a tree that is nowhere stored
//! - `parts`: which parts a part falls into
//! - `cells`: which displacements their parts have
//! - `local`: which of their parts a ray can meet
//! - `micro`: the same micro-triangles all at once, in a tree of their own, where memory allows
//! - `trace`: what a ray meets
//! - `smooth`: the surface between the micro-triangles, for measurements
//!
//! Source: surface and bounds after techniques of Thonat et al. 2021 (tessellation-free displacement),
//! without its affine arithmetic, which an `n` that is not normalised makes unnecessary.

mod cells;
mod charts;
mod clip_lanes;
mod fine;
mod flat;
mod hit_lanes;
mod local;
mod micro;
mod parts;
mod pieces;
mod prism_lanes;
mod seams;
mod sheets;
mod smooth;
mod trace;
mod weld;

use std::sync::{Arc, Mutex, PoisonError};

use glam::Vec3;
use rayon::prelude::*;

use crate::geometry::bvh::BoxTree;
use crate::geometry::{Aabb, TriangleMesh};
use crate::math::simd::SimdLevel;
use crate::surface::mapping::relief::ReliefField;
use crate::texture::Addressing;

use charts::{Charts, Shape};
pub use micro::MicroMesh;
use parts::Cut;
use pieces::Piece;
pub use seams::SeamReport;
use seams::Seams;
use sheets::Sheet;
pub use smooth::{SmoothHit, SmoothPoint};
pub use trace::{DisplacedMesh, Hits, Search, SurfaceHit, Tracer};

/// How the reliefs of a scene are laid on its mesh.
#[derive(Debug, Clone, Copy)]
pub struct Reliefs<'a, 'm> {
    /// One for each material; `None` where it has no relief.
    pub fields: &'a [Option<ReliefField<'m>>],
    /// Whether heights are averaged along edges at which texture coordinates jump; otherwise cracks open.
    pub weld_seams: bool,
}

impl<'m> Reliefs<'_, 'm> {
    /// The relief on a triangle.
    #[must_use]
    pub fn on(&self, mesh: &TriangleMesh, prim: u32) -> Option<&ReliefField<'m>> {
        let attributes = mesh.attributes[prim as usize];
        let field = self.fields.get(usize::from(attributes.material))?.as_ref();
        field.filter(|_| attributes.has_uv)
    }
}

/// The displaced triangles of a mesh, ready to be traced. Made for one set of reliefs; holds no micro-triangle.
#[derive(Debug)]
pub struct Displacement {
    /// What displaced triangles fall into, in their order and in that of the boxes.
    pieces: Vec<Piece>,
    /// Flat reliefs of many triangles.
    sheets: Vec<Sheet>,
    /// Displaced triangles: those that are walked as flat reliefs, and those that are cut up.
    kinds: [usize; 2],
    /// Pieces that are walked, if they are so few that every ray may be held against each.
    few_flat: Vec<u32>,
    /// For each material whether any of its triangles is walked.
    walked: Vec<bool>,
    /// Displacement normals, one for each vertex of the mesh.
    normals: Vec<Vec3>,
    seams: Seams,
    tree: BoxTree,
    /// Smallest and largest displacement of each piece.
    ranges: Vec<[f32; 2]>,
    /// Whether the mesh has other triangles, too.
    has_plain: bool,
    /// All micro-triangles, once they were asked for.
    micro: Mutex<Option<Arc<MicroMesh>>>,
}

/// So many flat reliefs are held against all rays in lanes faster than a tree finds those along each: with four it is a
/// little faster, with nine a little slower.
const FEW_FLAT: usize = 4;

/// Fewer pieces than this are not worth a task.
const FEW: usize = 1024;

impl Displacement {
    /// Makes the reliefs ready; the same for any number of threads.
    #[must_use]
    pub fn new(mesh: &TriangleMesh, reliefs: &Reliefs<'_, '_>) -> Self {
        let count = u32::try_from(mesh.len()).unwrap_or(u32::MAX);
        let prims: Vec<u32> = (0..count)
            .filter(|&prim| reliefs.on(mesh, prim).is_some())
            .collect();
        let welded = weld::weld(mesh, &prims);
        let seams = Seams::find(mesh, reliefs, &prims, &welded.places);
        let mut normals = welded.normals;
        let Charts {
            pieces,
            sheets,
            flat,
        } = charts::charts(
            mesh,
            reliefs,
            &prims,
            (&welded.places, &seams),
            &mut normals,
        );
        let (boxes, ranges): (Vec<Aabb>, Vec<[f32; 2]>) = pieces
            .par_iter()
            .with_min_len(FEW)
            .map(|piece| match piece.shape {
                Shape::Sheet(sheet) => {
                    sheet_prism((mesh, reliefs, &normals), piece, &sheets[sheet as usize])
                }
                _ => prism(mesh, reliefs, &normals, piece),
            })
            .unzip();
        let mut walked = vec![false; reliefs.fields.len()];
        for piece in &pieces {
            let material = mesh.attributes[piece.prim as usize].material;
            walked[usize::from(material)] |= !matches!(piece.shape, Shape::Fine(_));
        }
        Self {
            kinds: [flat, prims.len() - flat],
            few_flat: few_flat(&pieces),
            walked,
            pieces,
            sheets,
            normals,
            seams,
            tree: BoxTree::build(&boxes),
            ranges,
            has_plain: prims.len() < mesh.len(),
            micro: Mutex::default(),
        }
    }

    /// All micro-triangles, if they are there and take at most `budget` bytes. More are given back.
    #[must_use]
    pub fn micro(&self, budget: usize) -> Option<Arc<MicroMesh>> {
        let mut micro = self.micro.lock().unwrap_or_else(PoisonError::into_inner);
        if micro.as_ref().is_some_and(|micro| micro.bytes() > budget) {
            *micro = None;
        }
        micro.clone()
    }

    /// The same, made if they are not there yet. `None` if there is nothing to be made, if it would take more than
    /// `budget` bytes, and once `stop` says so.
    #[must_use]
    pub fn make_micro(
        &self,
        mesh: DisplacedMesh<'_, '_>,
        budget: usize,
        level: SimdLevel,
        stop: &(dyn Fn() -> bool + Sync),
    ) -> Option<Arc<MicroMesh>> {
        let known = self.micro(budget);
        let [_, fine] = self.kinds;
        if known.is_some() || fine == 0 || MicroMesh::bytes_for(self) > budget {
            return known;
        }
        let made = Arc::new(MicroMesh::new(mesh, level, stop)?);
        let mut micro = self.micro.lock().unwrap_or_else(PoisonError::into_inner);
        *micro = Some(Arc::clone(&made));
        Some(made)
    }

    /// Pieces that are cut up, and how.
    fn cuts(&self) -> impl Iterator<Item = (u32, Cut)> {
        let cut = |(i, piece): (usize, &Piece)| match piece.shape {
            Shape::Flat | Shape::Sheet(_) => None,
            Shape::Fine(cut) => Some((i as u32, cut)),
        };
        self.pieces.iter().enumerate().filter_map(cut)
    }

    /// Largest magnitude of a coordinate.
    const fn reach(&self) -> f32 {
        self.tree.reach()
    }

    /// Whether the mesh has triangles that are not displaced.
    #[must_use]
    pub const fn has_plain(&self) -> bool {
        self.has_plain
    }

    /// What was found at edges where texture coordinates jump.
    #[must_use]
    pub const fn seams(&self) -> SeamReport {
        self.seams.report()
    }

    /// Triangles that are walked as flat reliefs, and triangles that are cut up.
    #[must_use]
    pub const fn kinds(&self) -> [usize; 2] {
        self.kinds
    }

    /// Pieces that are walked as flat reliefs, if there are but a few; none if there are more.
    fn few_flat(&self) -> &[u32] {
        &self.few_flat
    }

    /// Whether any triangle of a material is walked as a flat relief.
    #[must_use]
    pub fn walks(&self, material: usize) -> bool {
        self.walked.get(material).is_some_and(|walked| *walked)
    }

    /// Flat reliefs of many triangles that are walked as one.
    #[must_use]
    pub const fn sheets(&self) -> usize {
        self.sheets.len()
    }

    /// Heap bytes, seams left out.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.tree.bytes()
            + size_of_val(self.pieces.as_slice())
            + size_of_val(self.ranges.as_slice())
            + size_of_val(self.normals.as_slice())
            + size_of_val(self.sheets.as_slice())
            + self.sheets.iter().map(Sheet::bytes).sum::<usize>()
    }
}

/// Pieces that are not cut up; none if there are more than [`FEW_FLAT`].
fn few_flat(pieces: &[Piece]) -> Vec<u32> {
    let flat = pieces
        .iter()
        .zip(0..)
        .filter(|(piece, _)| !matches!(piece.shape, Shape::Fine(_)));
    let few: Vec<u32> = flat.map(|(_, i)| i).take(FEW_FLAT + 1).collect();
    if few.len() > FEW_FLAT {
        Vec::new()
    } else {
        few
    }
}

/// Place of a vertex on a map, texels.
fn texels_at(mesh: &TriangleMesh, field: &ReliefField<'_>, vertex: u32) -> [f64; 2] {
    field.texels_from_uv(mesh.uvs[vertex as usize].to_array().map(f64::from))
}

/// Box and displacements of all triangles of a sheet.
fn sheet_prism(
    (mesh, reliefs, normals): (&TriangleMesh, &Reliefs<'_, '_>, &[Vec3]),
    piece: &Piece,
    sheet: &Sheet,
) -> (Aabb, [f32; 2]) {
    let triangles = sheet.prims().iter();
    let prisms = triangles.map(|&prim| prism(mesh, reliefs, normals, &Piece { prim, ..*piece }));
    prisms
        .reduce(|(all, [low, high]), (hull, [least, most])| {
            (all.union(hull), [low.min(least), high.max(most)])
        })
        .unwrap_or((Aabb::EMPTY, [0.0; 2]))
}

/// Box around everything that a piece's relief can reach: `p + d·n` over a triangle lies in the hull of
/// its corners at the smallest and largest `d`, because it is linear in each. And these `d`, a little widened.
fn prism(
    mesh: &TriangleMesh,
    reliefs: &Reliefs<'_, '_>,
    normals: &[Vec3],
    piece: &Piece,
) -> (Aabb, [f32; 2]) {
    let prim = piece.prim;
    let Some(field) = reliefs.on(mesh, prim) else {
        return (Aabb::EMPTY, [0.0; 2]);
    };
    let vertices = mesh.indices[prim as usize];
    let order = piece.order.map(|k| vertices[usize::from(k)]);
    let corners = piece.corners.map(pieces::shares);
    let at = |w: [f32; 3], [a, b, c]: [Vec3; 3]| a * w[0] + b * w[1] + c * w[2];
    let [low, high] = if matches!(piece.shape, Shape::Fine(cut) if cut.on_seam) {
        seams::range(reliefs)
    } else {
        let [a, b, c] = order.map(|i| texels_at(mesh, field, i));
        let places = corners.map(|w| {
            let [w0, w1, w2] = w.map(f64::from);
            [0, 1].map(|k| a[k] * w0 + b[k] * w1 + c[k] * w2)
        });
        field.range_near(places)
    };
    let ends = [low as f32, high as f32];
    let points = corners.into_iter().flat_map(|w| {
        let p = at(w, order.map(|i| mesh.positions[i as usize]));
        let n = at(w, order.map(|i| normals[i as usize]));
        ends.map(|d| p + n * d)
    });
    let hull = Aabb::from_points(points);
    // A few roundings of the points within.
    let margin = hull.min.abs().max(hull.max.abs()) * (16.0 * f32::EPSILON);
    let hull = Aabb {
        min: hull.min - margin,
        max: hull.max + margin,
    };
    let [low, high] = ends;
    let slack = low.abs().max(high.abs()).max(field.height.offset.abs()) * 2e-6;
    (hull, [low - slack, high + slack])
}

/// The displacement of a scene that was asked for last, so that passes and settings that do not change it
/// need not make it again.
#[derive(Debug, Default)]
pub struct DisplacementCell(Mutex<Option<(CellKey, Arc<Displacement>)>>);

/// The reliefs of all materials, and whether seams are welded.
type CellKey = (Vec<Option<FieldKey>>, bool);

/// What of a relief its displacement depends on: map, addressing, scale and offset.
type FieldKey = (usize, Addressing, [u32; 2]);

impl DisplacementCell {
    /// The displacement of these reliefs, which must belong to the one mesh of the cell.
    #[must_use]
    pub fn get(&self, mesh: &TriangleMesh, reliefs: &Reliefs<'_, '_>) -> Arc<Displacement> {
        let fields = reliefs.fields.iter().map(|f| f.as_ref().map(key));
        let key: CellKey = (fields.collect(), reliefs.weld_seams);
        let mut cell = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((known, displacement)) = &*cell
            && *known == key
        {
            return Arc::clone(displacement);
        }
        let displacement = Arc::new(Displacement::new(mesh, reliefs));
        *cell = Some((key, Arc::clone(&displacement)));
        displacement
    }

    /// What was made last; `None` while something is being made.
    #[must_use]
    pub fn last(&self) -> Option<Arc<Displacement>> {
        let cell = self.0.try_lock().ok()?;
        cell.as_ref()
            .map(|(_, displacement)| Arc::clone(displacement))
    }
}

impl Clone for DisplacementCell {
    fn clone(&self) -> Self {
        Self::default()
    }
}

fn key(field: &ReliefField<'_>) -> FieldKey {
    let height = &field.height;
    // Maps stay where they are as long as their scene lives.
    let map = std::ptr::from_ref(height.map) as usize;
    (
        map,
        height.addressing,
        [height.scale.to_bits(), height.offset.to_bits()],
    )
}
