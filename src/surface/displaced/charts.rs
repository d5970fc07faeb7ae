//! Which displaced triangles are flat reliefs, which of them are walked as one, and how the others are cut up.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use super::parts::Cut;
use super::pieces::{self, Cutting, Piece};
use super::seams::Seams;
use super::sheets::Sheet;
use super::{Reliefs, texels_at};
use crate::geometry::TriangleMesh;
use crate::math::Groups;

/// How a piece of a displaced triangle is traced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Its displacement normal is constant: a height field over a flat chart.
    Flat,
    /// It and others of the plane are one such, by the number of their sheet.
    Sheet(u32),
    /// It is cut into micro-triangles.
    Fine(Cut),
}

/// Welded normals that differ less than this angle (radians) from their mean are taken as equal: 10⁻⁵ of
/// the displacement at the most.
const SAME_DIRECTION: f64 = 1e-5;

/// A triangle this nearly along its displacement normal (sine) is no height field.
const MIN_SLOPE: f64 = 1e-3;

/// What displaced triangles fall into.
#[derive(Debug)]
pub struct Charts {
    pub pieces: Vec<Piece>,
    pub sheets: Vec<Sheet>,
    /// Triangles that are flat reliefs.
    pub flat: usize,
}

/// Cuts up displaced triangles, or puts them together. Triangles that hang together by a corner are all flat, or all
/// cut up, their pieces with as many segments along every edge, so that no crack opens between them. Flat parts get
/// their mean normal.
pub fn charts(
    mesh: &TriangleMesh,
    reliefs: &Reliefs<'_, '_>,
    prims: &[u32],
    (places, seams): (&[u32], &Seams),
    normals: &mut [Vec3],
) -> Charts {
    let parts = parts(mesh, prims, places);
    let count = parts.iter().map(|part| part + 1).max().unwrap_or(0) as usize;
    let mut sums = vec![DVec3::ZERO; count];
    for (&prim, &part) in prims.iter().zip(&parts) {
        for vertex in mesh.indices[prim as usize] {
            sums[part as usize] += normals[vertex as usize].as_dvec3();
        }
    }
    let means: Vec<DVec3> = sums.into_iter().map(DVec3::normalize_or_zero).collect();
    let mut is_flat = vec![true; count];
    let mut texels = vec![0.0_f64; count];
    for (&prim, &part) in prims.iter().zip(&parts) {
        let part = part as usize;
        let mean = means[part];
        let vertices = mesh.indices[prim as usize];
        let differs = |vertex: u32| {
            let normal = normals[vertex as usize].as_dvec3();
            !((normal - mean).length() < SAME_DIRECTION)
        };
        let p = mesh.corners(prim).map(|p| p.as_dvec3());
        let area = (p[1] - p[0]).cross(p[2] - p[0]);
        let upright = !(area.dot(mean).abs() > MIN_SLOPE * area.length());
        is_flat[part] &= !upright && !vertices.into_iter().any(differs) && !seams.touches(prim);
        texels[part] = texels[part].max(longest_edge(mesh, reliefs, prim));
    }
    for (&prim, &part) in prims.iter().zip(&parts) {
        if is_flat[part as usize] {
            for vertex in mesh.indices[prim as usize] {
                normals[vertex as usize] = means[part as usize].as_vec3();
            }
        }
    }
    let is_fine = |part: u32| !is_flat[part as usize];
    let both = || prims.iter().copied().zip(parts.iter().copied());
    let fine: Vec<u32> = both()
        .filter(|(_, part)| is_fine(*part))
        .map(|(prim, _)| prim)
        .collect();
    let cutting = Cutting::new(mesh, reliefs, &fine, places);
    let mut flat: HashMap<u32, Vec<u32>> = HashMap::new();
    for (prim, part) in both().filter(|(_, part)| !is_fine(*part)) {
        flat.entry(part).or_default().push(prim);
    }
    let mut pieces = Vec::with_capacity(fine.len());
    let mut sheets = Vec::new();
    for (prim, part) in both() {
        if !is_fine(part) {
            // With the first of them come all.
            let Some(prims) = flat.remove(&part) else {
                continue;
            };
            let normal = means[part as usize].as_vec3().as_dvec3();
            let mut push = |prim: u32, shape: Shape| {
                pieces.push(Piece {
                    prim,
                    shape,
                    order: [0, 1, 2],
                    corners: pieces::ALL,
                });
            };
            if let Some(sheet) = Sheet::new(mesh, reliefs, &prims, normal) {
                push(prim, Shape::Sheet(sheets.len() as u32));
                sheets.push(sheet);
            } else {
                prims.into_iter().for_each(|prim| push(prim, Shape::Flat));
            }
            continue;
        }
        let segments_log2 = pieces::segments_log2(texels[part as usize].min(cutting.length()));
        let on_seam = seams.touches(prim);
        let order = pieces::order(mesh, prim);
        cutting.cut(mesh, reliefs, prim, places, |corners| {
            let on_seam = on_seam && pieces::is_at_border(corners);
            pieces.push(Piece {
                prim,
                shape: Shape::Fine(Cut {
                    segments_log2,
                    on_seam,
                }),
                order,
                corners,
            });
            true
        });
    }
    Charts {
        pieces,
        sheets,
        flat: prims.len() - fine.len(),
    }
}

/// Length of a triangle's longest edge in texels.
fn longest_edge(mesh: &TriangleMesh, reliefs: &Reliefs<'_, '_>, prim: u32) -> f64 {
    let Some(field) = reliefs.on(mesh, prim) else {
        return 0.0;
    };
    let at = mesh.indices[prim as usize].map(|i| texels_at(mesh, field, i));
    let length = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let longest = length(at[0], at[1])
        .max(length(at[1], at[2]))
        .max(length(at[2], at[0]));
    if longest.is_finite() { longest } else { 0.0 }
}

/// Numbers of the parts that the triangles belong to: those with a corner in the same place hang together.
fn parts(mesh: &TriangleMesh, prims: &[u32], places: &[u32]) -> Vec<u32> {
    let count = places.iter().map(|place| place + 1).max().unwrap_or(0);
    let mut groups = Groups::new(count as usize);
    for &prim in prims {
        let [a, b, c] = mesh.indices[prim as usize].map(|i| places[i as usize]);
        groups.join(a, b);
        groups.join(a, c);
    }
    let mut numbers = HashMap::new();
    let mut number = |prim: &u32| {
        let place = places[mesh.indices[*prim as usize][0] as usize];
        let next = numbers.len() as u32;
        *numbers.entry(groups.root(place)).or_insert(next)
    };
    prims.iter().map(&mut number).collect()
}
