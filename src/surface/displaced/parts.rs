//! How pieces are cut up: the sixteen parts that a part falls into, and the vertices of a part with four segments.

use crate::math::lanes::Lanes;

/// Parts that a part falls into.
pub const PARTS: usize = 16;

/// A number for each part.
pub type Row = Lanes<f32, PARTS>;

/// Anchor and signed size of the sixteen parts of a triangle with four segments: corners
/// `(a, b)`, `(a + s, b)`, `(a, b + s)`. A negative size is a triangle turned by half a turn.
pub const CUT: [[i32; 3]; PARTS] = cut();

const fn cut() -> [[i32; 3]; PARTS] {
    let quarters = [[0, 0, 2], [2, 0, 2], [0, 2, 2], [2, 2, -2]];
    let mut parts = [[0; 3]; PARTS];
    let mut i = 0;
    while i < 4 {
        let [a, b, s] = quarters[i];
        let h = s / 2;
        parts[4 * i] = [a, b, h];
        parts[4 * i + 1] = [a + h, b, h];
        parts[4 * i + 2] = [a, b + h, h];
        parts[4 * i + 3] = [a + h, b + h, -h];
        i += 1;
    }
    parts
}

/// The same, `[anchor, anchor, size][part]`.
pub const CUTS: [Row; 3] = rows(&CUT);

/// A table by columns. Places that are left over repeat its last line.
const fn rows<const K: usize, const N: usize>(table: &[[i32; K]; N]) -> [Row; K] {
    let mut rows = [Row::splat(0.0); K];
    let mut i = 0;
    while i < PARTS {
        let line = table[if i < N { i } else { N - 1 }];
        let mut k = 0;
        while k < K {
            rows[k].0[i] = line[k] as f32;
            k += 1;
        }
        i += 1;
    }
    rows
}

/// Vertices of a triangle with four segments.
pub const VERTICES: usize = 15;

/// Their places, row by row.
const GRID: [[i32; 2]; VERTICES] = grid();

const fn grid() -> [[i32; 2]; VERTICES] {
    let mut places = [[0; 2]; VERTICES];
    let (mut i, mut b) = (0, 0);
    while b <= 4 {
        let mut a = 0;
        while a <= 4 - b {
            places[i] = [a, b];
            i += 1;
            a += 1;
        }
        b += 1;
    }
    places
}

/// The same, `[axis][vertex]`. The place that is left over repeats the last vertex.
pub const GRID_ROWS: [Row; 2] = rows(&GRID);

/// Index in [`GRID`].
const fn vertex(a: i32, b: i32) -> usize {
    (a + b * 5 - b * (b - 1) / 2) as usize
}

/// The vertices of its sixteen triangles, `[corner][triangle]`.
pub const TRIANGLES: [[usize; PARTS]; 3] = triangles();

const fn triangles() -> [[usize; PARTS]; 3] {
    let mut vertices = [[0; PARTS]; 3];
    let mut i = 0;
    while i < PARTS {
        let [a, b, s] = CUT[i];
        vertices[0][i] = vertex(a, b);
        vertices[1][i] = vertex(a + s, b);
        vertices[2][i] = vertex(a, b + s);
        i += 1;
    }
    vertices
}

/// How a piece is cut up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cut {
    /// Every edge falls into 2 to the power of this segments; at least 2.
    pub segments_log2: u8,
    /// Whether it reaches an edge or a corner of its triangle that may lie on a seam.
    pub on_seam: bool,
}

/// How many parts with four segments a piece has.
pub const fn leaf_count(cut: Cut) -> usize {
    1 << (2 * (cut.segments_log2 as usize - 2))
}

/// Anchors and signed sizes of all parts with four segments of a piece, in the order of their keys.
pub fn leaves(cut: Cut) -> Vec<[i32; 3]> {
    let segments = 1 << cut.segments_log2;
    let mut leaves = Vec::new();
    for a in (0..=segments).step_by(4) {
        for b in (0..=segments - a).step_by(4) {
            // Turned by half a turn, its corner is the farthest.
            if a >= 4 && b >= 4 {
                leaves.push([a, b, -4]);
            }
            if a + b < segments {
                leaves.push([a, b, 4]);
            }
        }
    }
    leaves
}
