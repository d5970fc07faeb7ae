//! True displacement: the surface `S = p + d(uv)·n` over each triangle of a mesh, with its silhouettes.
//!
//! `p` and `n` are linear over the triangle, `n` is not normalised; `d = amplitude·(h − midlevel)` with the
//! bilinear height `h`.
//!
//! - `weld`: one normal for each place, so that hard edges do not tear
//! - `seams`: edges at which texture coordinates jump; heights are averaged along them
//! - `charts`: which triangles are flat reliefs, and how fine the others are cut up
//! - `flat`: where `n` is constant: the exact walk answers, nothing is cut up
//! - `fine`: elsewhere: micro-triangles, made where rays come, from a tree that is nowhere stored
//! - `nodes`: boxes around parts of triangles, kept for a while
//! - `trace`: what a ray meets
//! - `smooth`: the surface between the micro-triangles, for measurements
//!
//! Source: surface and bounds after techniques of Thonat et al. 2021 (tessellation-free displacement),
//! without its affine arithmetic, which an `n` that is not normalised makes unnecessary.

mod charts;
mod fine;
mod flat;
mod nodes;
mod seams;
mod smooth;
mod trace;
mod weld;

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use glam::Vec3;

use crate::geometry::bvh::BoxTree;
use crate::geometry::{Aabb, TriangleMesh};
use crate::surface::mapping::relief::ReliefField;
use crate::texture::Addressing;

use charts::Shape;
pub use seams::SeamReport;
use seams::Seams;
pub use smooth::{SmoothHit, SmoothPoint};
pub use trace::{DisplacedMesh, Search, SurfaceHit, Tracer};

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
    /// Displaced triangles, in the order of their boxes.
    prims: Vec<u32>,
    shapes: Vec<Shape>,
    /// Displacement normals, one for each vertex of the mesh.
    normals: Vec<Vec3>,
    seams: Seams,
    tree: BoxTree,
    /// Whether the mesh has other triangles, too.
    has_plain: bool,
    /// Unlike that of any other displacement.
    number: u64,
}

/// Displacements made so far.
static MADE: AtomicU64 = AtomicU64::new(0);

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
        let shapes = charts::shapes(
            mesh,
            reliefs,
            &prims,
            (&welded.places, &seams),
            &mut normals,
        );
        let boxes: Vec<Aabb> = prims
            .iter()
            .map(|&prim| prism(mesh, reliefs, &normals, prim, seams.touches(prim)))
            .collect();
        Self {
            shapes,
            normals,
            seams,
            tree: BoxTree::build(&boxes),
            has_plain: prims.len() < mesh.len(),
            number: MADE.fetch_add(1, Ordering::Relaxed) + 1,
            prims,
        }
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
    pub fn kinds(&self) -> [usize; 2] {
        let flat = self.shapes.iter().filter(|shape| **shape == Shape::Flat);
        let flat = flat.count();
        [flat, self.shapes.len() - flat]
    }

    /// Heap bytes, seams left out.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.tree.bytes()
            + size_of_val(self.prims.as_slice())
            + size_of_val(self.shapes.as_slice())
            + size_of_val(self.normals.as_slice())
    }
}

/// Box around everything that a triangle's relief can reach: `p + d·n` over a triangle lies in the hull of
/// its corners at the smallest and largest `d`, because it is linear in each.
fn prism(
    mesh: &TriangleMesh,
    reliefs: &Reliefs<'_, '_>,
    normals: &[Vec3],
    prim: u32,
    on_seam: bool,
) -> Aabb {
    let Some(field) = reliefs.on(mesh, prim) else {
        return Aabb::EMPTY;
    };
    let corners = mesh.indices[prim as usize].map(|i| i as usize);
    let [low, high] = if on_seam {
        seams::range(reliefs)
    } else {
        let places = corners.map(|i| field.texels_from_uv(mesh.uvs[i].to_array().map(f64::from)));
        field.range_near(places)
    };
    let ends = [low as f32, high as f32];
    let points = corners
        .into_iter()
        .flat_map(|i| ends.map(|d| mesh.positions[i] + normals[i] * d));
    let hull = Aabb::from_points(points);
    // A few roundings of the points within.
    let margin = hull.min.abs().max(hull.max.abs()) * (8.0 * f32::EPSILON);
    Aabb {
        min: hull.min - margin,
        max: hull.max + margin,
    }
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
