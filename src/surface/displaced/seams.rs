//! Edges at which texture coordinates jump: both sides see other heights, and the surface would tear.

use std::collections::{BTreeMap, HashMap};

use glam::Vec2;

use super::Reliefs;
use crate::geometry::TriangleMesh;
use crate::math::V2;
use crate::surface::mapping::relief::ReliefField;

/// What was found at seams.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SeamReport {
    /// Edges at which texture coordinates or materials differ.
    pub edges: usize,
    /// Largest difference of heights found along them, internal units.
    pub largest_gap: f32,
}

/// One side of a seam: a material and the texture coordinates at both ends, the lower place first.
#[derive(Debug, Clone, Copy, PartialEq)]
struct EdgeSide {
    material: u16,
    uv: [Vec2; 2],
}

/// All seams of a mesh; empty if heights are not averaged.
#[derive(Debug, Default)]
pub struct Seams {
    /// Sides of the seam edges, by the places of their ends.
    edges: HashMap<[u32; 2], Vec<EdgeSide>>,
    /// Material and texture coordinate of the corners that meet in a place, where they differ.
    corners: HashMap<u32, Vec<(u16, Vec2)>>,
    /// For each triangle on a seam, the places of its corners.
    prims: HashMap<u32, [u32; 3]>,
    report: SeamReport,
}

impl Seams {
    /// Finds the seams between displaced triangles.
    pub fn find(
        mesh: &TriangleMesh,
        reliefs: &Reliefs<'_, '_>,
        prims: &[u32],
        places: &[u32],
    ) -> Self {
        // Ordered, so that the report does not depend on a hash.
        let mut edges: BTreeMap<[u32; 2], Vec<EdgeSide>> = BTreeMap::new();
        let mut corners: HashMap<u32, Vec<(u16, Vec2)>> = HashMap::new();
        for &prim in prims {
            let vertices = mesh.indices[prim as usize];
            let material = mesh.attributes[prim as usize].material;
            for k in 0..3 {
                let (a, b) = (vertices[k] as usize, vertices[(k + 1) % 3] as usize);
                let corner = (material, mesh.uvs[a]);
                let there = corners.entry(places[a]).or_default();
                if !there.contains(&corner) {
                    there.push(corner);
                }
                let (a, b) = if places[a] <= places[b] {
                    (a, b)
                } else {
                    (b, a)
                };
                let side = EdgeSide {
                    material,
                    uv: [mesh.uvs[a], mesh.uvs[b]],
                };
                let sides = edges.entry([places[a], places[b]]).or_default();
                if !sides.contains(&side) {
                    sides.push(side);
                }
            }
        }
        edges.retain(|_, sides| sides.len() > 1);
        corners.retain(|_, sides| sides.len() > 1);
        let report = report(reliefs, &edges);
        if !reliefs.weld_seams {
            return Self {
                report,
                ..Self::default()
            };
        }
        let places_of = |prim: &u32| mesh.indices[*prim as usize].map(|i| places[i as usize]);
        let on_seam = |places: &[u32; 3]| places.iter().any(|place| corners.contains_key(place));
        let prims = prims.iter().map(|prim| (*prim, places_of(prim)));
        Self {
            prims: prims.filter(|(_, places)| on_seam(places)).collect(),
            edges: edges.into_iter().collect(),
            corners,
            report,
        }
    }

    /// Whether a corner of the triangle lies on a seam.
    pub fn touches(&self, prim: u32) -> bool {
        self.prims.contains_key(&prim)
    }

    /// What was found.
    pub const fn report(&self) -> SeamReport {
        self.report
    }

    /// The seams around a triangle; `None` if none of its corners lies on one.
    pub fn around(&self, prim: u32) -> Option<SeamsAround<'_>> {
        let places = self.prims.get(&prim)?;
        let edge = |opposite: usize| {
            let (a, b) = ((opposite + 1) % 3, (opposite + 2) % 3);
            let ends = if places[a] <= places[b] {
                [a, b]
            } else {
                [b, a]
            };
            let sides = self.edges.get(&ends.map(|k| places[k]))?;
            Some((ends, sides.as_slice()))
        };
        let corner = |k: usize| Some(self.corners.get(&places[k])?.as_slice());
        Some(SeamsAround {
            corners: [corner(0), corner(1), corner(2)],
            edges: [edge(0), edge(1), edge(2)],
        })
    }
}

/// The seams at a triangle's corners, and at the edges across from them.
#[derive(Debug, Clone, Copy)]
pub struct SeamsAround<'a> {
    corners: [Option<&'a [(u16, Vec2)]>; 3],
    /// With the corners that are their ends, in the order of the sides' texture coordinates.
    edges: [Option<([usize; 2], &'a [EdgeSide])>; 3],
}

impl SeamsAround<'_> {
    /// The displacement at a border vertex of the triangle: the mean of all sides, taken in the same order from each.
    /// `weights` are those of the triangle's corners; `None` for vertices on no seam.
    pub fn displacement(&self, reliefs: &Reliefs<'_, '_>, weights: [f32; 3]) -> Option<f32> {
        if let Some(corner) = weights.iter().position(|&w| w == 1.0) {
            let sides = self.corners[corner]?;
            return Some(mean(sides.iter().map(|&(m, uv)| at(reliefs, m, uv))));
        }
        let opposite = weights.iter().position(|&w| w == 0.0)?;
        let ([a, b], sides) = self.edges[opposite]?;
        let along = |side: &EdgeSide| {
            let uv = side.uv[0] * weights[a] + side.uv[1] * weights[b];
            at(reliefs, side.material, uv)
        };
        Some(mean(sides.iter().map(along)))
    }
}

/// Displacement of a material's relief, as every micro-vertex takes it.
fn at(reliefs: &Reliefs<'_, '_>, material: u16, uv: Vec2) -> f32 {
    let field = reliefs.fields[usize::from(material)].as_ref();
    field.map_or(0.0, |field| field.height.displacement(V2::from(uv)))
}

fn mean(sides: impl ExactSizeIterator<Item = f32>) -> f32 {
    // Sums of f32 in doubles do not round here, so that the order of the sides does not matter.
    let count = sides.len() as f64;
    (sides.map(f64::from).sum::<f64>() / count) as f32
}

/// Smallest and largest displacement of all reliefs: no mean leaves it.
pub fn range(reliefs: &Reliefs<'_, '_>) -> [f64; 2] {
    let ranges = reliefs.fields.iter().flatten().map(ReliefField::range);
    ranges.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], [low, high]| {
        [a.min(low), b.max(high)]
    })
}

/// Looks along every seam at a few places.
fn report(reliefs: &Reliefs<'_, '_>, edges: &BTreeMap<[u32; 2], Vec<EdgeSide>>) -> SeamReport {
    const PLACES: u32 = 16;
    let mut largest_gap = 0.0_f32;
    for sides in edges.values() {
        for i in 0..=PLACES {
            let t = i as f32 / PLACES as f32;
            let heights = sides
                .iter()
                .map(|side| at(reliefs, side.material, side.uv[0].lerp(side.uv[1], t)));
            let (low, high) = heights.fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), h| {
                (a.min(h), b.max(h))
            });
            largest_gap = largest_gap.max(high - low);
        }
    }
    SeamReport {
        edges: edges.len(),
        largest_gap,
    }
}
