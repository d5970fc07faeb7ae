//! Displaced triangles cut into pieces of much the same size, each of which falls into as many segments along every
//! edge.
//!
//! Two triangles at an edge must cut it alike, or cracks open. So how often an edge of the mesh is halved depends on
//! the edge alone, and how often one within a triangle depends on that triangle. A long strip then falls into pieces
//! as wide as itself instead of slivers as many as its length asks for.

use std::collections::HashMap;

use super::charts::Shape;
use super::{Reliefs, texels_at};
use crate::geometry::TriangleMesh;

/// Weight 1 of a corner.
pub const WHOLE: i16 = 1 << WHOLE_LOG2;

/// How often an edge can be halved.
pub const WHOLE_LOG2: u8 = 14;

/// Longest edge of a piece in texels, to begin with: sixteen segments, so that a piece is one box of sixteen
/// parts.
const SHORT: f64 = 8.0;

/// Longest edge of a piece in texels that there can be.
const LONG: f64 = 8192.0;

/// Most segments along an edge.
pub const MAX_SEGMENTS_LOG2: u8 = 14;

/// Halvings and segments together may have as many bits as a float has, so that weights are exact.
const BITS: u8 = 24;

/// From this many pieces on they are made longer instead.
const MANY: usize = 1 << 18;

/// A part of a displaced triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Piece {
    /// Triangle of the mesh.
    pub prim: u32,
    /// How it is traced.
    pub shape: Shape,
    /// Corners of the triangle in the order in which its neighbours, too, have those that they share.
    pub order: [u8; 3],
    /// Weights of the second and third of them at the piece's corners, in shares of [`WHOLE`].
    pub corners: Corners,
}

/// Weights of the second and third corner.
pub type Place = [i16; 2];

/// Three places in a triangle, see [`Piece::corners`].
pub type Corners = [Place; 3];

/// The triangle as it is.
pub const ALL: Corners = [[0, 0], [WHOLE, 0], [0, WHOLE]];

/// Which pieces triangles fall into.
#[derive(Debug)]
pub struct Cutting {
    /// Longest edge of a piece in texels.
    length: f64,
    /// How often edges of the mesh are halved that are, by the places of their ends; not at all if they are not
    /// here.
    halvings: HashMap<[u32; 2], u8>,
}

impl Cutting {
    /// For these triangles, by the numbers of the places of the mesh's vertices.
    pub fn new(
        mesh: &TriangleMesh,
        reliefs: &Reliefs<'_, '_>,
        fine: &[u32],
        places: &[u32],
    ) -> Self {
        let mut length = SHORT;
        loop {
            let cutting = Self::with_length(mesh, reliefs, fine, (places, length));
            if cutting.halvings.is_empty() || cutting.makes_few(mesh, reliefs, fine, places) {
                return cutting;
            }
            if length >= LONG {
                // Texture coordinates that run on and on: triangles stay whole, and segments are longer than texels.
                return Self {
                    halvings: HashMap::new(),
                    ..cutting
                };
            }
            // Two halvings are one level of boxes.
            length *= 4.0;
        }
    }

    /// Whether there are not too many pieces.
    fn makes_few(
        &self,
        mesh: &TriangleMesh,
        reliefs: &Reliefs<'_, '_>,
        fine: &[u32],
        places: &[u32],
    ) -> bool {
        let most = MANY.max(2 * fine.len());
        let mut count = 0;
        fine.iter().all(|&prim| {
            self.cut(mesh, reliefs, prim, places, |_| {
                count += 1;
                count <= most
            });
            count <= most
        })
    }

    /// Longest edge of a piece, texels.
    pub const fn length(&self) -> f64 {
        self.length
    }

    fn with_length(
        mesh: &TriangleMesh,
        reliefs: &Reliefs<'_, '_>,
        fine: &[u32],
        (places, length): (&[u32], f64),
    ) -> Self {
        let mut halvings = HashMap::new();
        for &prim in fine {
            let chart = Chart::of(mesh, reliefs, prim);
            for k in 0..3 {
                let [a, b] = [ALL[(k + 1) % 3], ALL[(k + 2) % 3]];
                let times = (chart.length(a, b) / length).log2().ceil();
                if times > 0.0 {
                    let most = WHOLE_LOG2.min(BITS - segments_log2(length));
                    let known = halvings.entry(chart.edge(mesh, places, k)).or_insert(0);
                    *known = (times as u8).min(most).max(*known);
                }
            }
        }
        Self { length, halvings }
    }

    /// Tells the pieces of a triangle, in an order of their own, as long as `tell` wants more.
    pub fn cut(
        &self,
        mesh: &TriangleMesh,
        reliefs: &Reliefs<'_, '_>,
        prim: u32,
        places: &[u32],
        mut tell: impl FnMut(Corners) -> bool,
    ) {
        let chart = Chart::of(mesh, reliefs, prim);
        let times = [0, 1, 2].map(|k| {
            let edge = chart.edge(mesh, places, k);
            self.halvings.get(&edge).copied().unwrap_or(0)
        });
        let is_long = |a: Place, b: Place| {
            let ends = [weights(a), weights(b)];
            // On an edge of the triangle the weight of the corner across is 0.
            if let Some(k) = (0..3).find(|&k| ends.iter().all(|w| w[k] == 0)) {
                let share = i32::from(ends[0][(k + 1) % 3] - ends[1][(k + 1) % 3]);
                return share.abs() << times[k] > i32::from(WHOLE);
            }
            let can_be_halved = (a[0] ^ b[0]) & 1 == 0 && (a[1] ^ b[1]) & 1 == 0;
            can_be_halved && chart.length(a, b) > self.length
        };
        let mut left = vec![ALL];
        while let Some(corners) = left.pop() {
            let long = [0, 1, 2].map(|k| is_long(corners[(k + 1) % 3], corners[(k + 2) % 3]));
            let count = long.iter().filter(|long| **long).count();
            // Of one long edge and of one short edge, the corner across comes first.
            let odd = long.iter().position(|long| *long == (count == 1));
            let [a, b, c] = [0, 1, 2].map(|k| corners[(odd.unwrap_or(0) + k) % 3]);
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            match count {
                0 if !tell(corners) => return,
                0 => {}
                1 => left.extend([[a, bc, c], [a, b, bc]]),
                // What is left beside the tip at `a` has two diagonals.
                2 if chart.length(ab, c) <= chart.length(b, ca) => {
                    left.extend([[ab, c, ca], [ab, b, c], [a, ab, ca]]);
                }
                2 => left.extend([[b, c, ca], [ab, b, ca], [a, ab, ca]]),
                _ => left.extend([[ab, bc, ca], [ca, bc, c], [ab, b, bc], [a, ab, ca]]),
            }
        }
    }
}

/// Whether one of the corners lies on an edge of the triangle.
pub fn is_at_border(corners: Corners) -> bool {
    corners.into_iter().flat_map(weights).any(|w| w == 0)
}

/// Weights of all three corners, their sum 1.
pub fn shares(place: Place) -> [f32; 3] {
    weights(place).map(|w| f32::from(w) / f32::from(WHOLE))
}

/// Weights of all three corners.
const fn weights([b, c]: Place) -> [i16; 3] {
    [WHOLE - b - c, b, c]
}

const fn middle(a: Place, b: Place) -> Place {
    // Both are at most 2¹⁴.
    [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2]
}

/// At least two segments for each texel along an edge of so many.
pub fn segments_log2(texels: f64) -> u8 {
    let segments = (2.0 * texels)
        .ceil()
        .clamp(4.0, f64::from(1 << MAX_SEGMENTS_LOG2));
    (segments as u32).next_power_of_two().ilog2() as u8
}

/// A triangle on the map, in texels.
struct Chart {
    order: [u8; 3],
    prim: u32,
    /// The ways from the first corner to the others.
    ways: [[f64; 2]; 2],
}

impl Chart {
    fn of(mesh: &TriangleMesh, reliefs: &Reliefs<'_, '_>, prim: u32) -> Self {
        let order = order(mesh, prim);
        let vertices = mesh.indices[prim as usize];
        let texels = match reliefs.on(mesh, prim) {
            Some(field) => order.map(|k| texels_at(mesh, field, vertices[usize::from(k)])),
            None => [[0.0; 2]; 3],
        };
        let [t0, t1, t2] = texels;
        let way = |t: [f64; 2]| [t[0] - t0[0], t[1] - t0[1]];
        Self {
            order,
            prim,
            ways: [way(t1), way(t2)],
        }
    }

    /// Length between two places in texels; the same both ways. 0 where texture coordinates are no numbers.
    fn length(&self, a: Place, b: Place) -> f64 {
        let [along1, along2] = self.ways;
        let [w1, w2] = [0, 1].map(|k| f64::from(a[k] - b[k]));
        let across = [0, 1].map(|k| (along1[k] * w1 + along2[k] * w2) / f64::from(WHOLE));
        let length = across[0].hypot(across[1]);
        if length.is_finite() { length } else { 0.0 }
    }

    /// The places of the ends of the edge across from a corner.
    fn edge(&self, mesh: &TriangleMesh, places: &[u32], across: usize) -> [u32; 2] {
        let vertices = mesh.indices[self.prim as usize];
        let [a, b] = [1, 2].map(|k| {
            let corner = usize::from(self.order[(across + k) % 3]);
            places[vertices[corner] as usize]
        });
        [a.min(b), a.max(b)]
    }
}

/// Corners of a triangle by place: both triangles at an edge weigh its ends in the same order, so that their vertices
/// there have the same bits.
pub fn order(mesh: &TriangleMesh, prim: u32) -> [u8; 3] {
    let corners = mesh.corners(prim);
    let key = |k: &u8| corners[usize::from(*k)].to_array();
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| {
        let (a, b) = (key(a), key(b));
        a.partial_cmp(&b).unwrap_or(std::cmp::Ordering::Equal)
    });
    order
}
