//! Layouts that divide a tile: scattered cells and courses of blocks.

use super::dual::Dual;
use super::exact::floor;
use super::noise::unit;

/// Points scattered over a tile, one in each square of an `n · n` lattice; the layout repeats.
#[derive(Debug)]
pub struct Cells {
    n: usize,
    seed: u64,
    /// Points of the lattice and of [`REACH`] squares around it.
    points: Vec<[f64; 2]>,
}

/// Squares searched to either side: enough for exact borders at any jitter up to 1.
const REACH: usize = 2;

/// Where a place lies in its cell. Lengths in lattice squares.
#[derive(Debug, Clone, Copy)]
pub struct CellPlace {
    /// Lattice coordinates of the cell that owns the place.
    pub id: [i64; 2],
    /// Distance to the cell's border, negative past rounded corners.
    pub edge: Dual,
}

impl Cells {
    /// `n` squares a side; `jitter` in `[0, 1]` is the share of the square that points roam.
    #[must_use]
    pub fn new(n: usize, jitter: f64, seed: u64) -> Self {
        let side = 0..n + 2 * REACH;
        let place = |x: usize, y: usize| {
            let id = [x, y].map(|c| (c as i64 - REACH as i64).rem_euclid(n as i64));
            [
                x as f64 + 0.5 + jitter * (unit(id, seed) - 0.5),
                y as f64 + 0.5 + jitter * (unit(id, seed + 1) - 0.5),
            ]
        };
        let rows = side.clone().flat_map(|y| side.clone().map(move |x| (x, y)));
        Self {
            n,
            seed,
            points: rows.map(|(x, y)| place(x, y)).collect(),
        }
    }

    /// A number in `[0, 1)` that belongs to a cell; `salt` selects one of many.
    #[must_use]
    pub fn random(&self, id: [i64; 2], salt: u64) -> f64 {
        unit(id, self.seed + 2 + salt)
    }

    /// The Voronoi cell around (u, v) and the distance to its border, with corners rounded over
    /// `rounding` squares (greater than 0).
    ///
    /// The border with each neighbour is the bisector of the two points, so the distance is exact where
    /// nothing is rounded (Quilez, "Voronoi borders").
    #[must_use]
    pub fn at(&self, u: Dual, v: Dual, rounding: f64) -> CellPlace {
        let (x, y) = (self.lattice(u), self.lattice(v));
        let (px, py) = (x.value, y.value);
        let near = self.neighbours(px, py);
        let distance2 = |p: &[f64; 2]| (p[0] - px) * (p[0] - px) + (p[1] - py) * (p[1] - py);
        let own = near
            .iter()
            .copied()
            .reduce(|a, b| if distance2(&b) < distance2(&a) { b } else { a })
            .unwrap_or([px, py]);
        let mut edge = Dual::constant(9.0);
        for p in near {
            let (rx, ry) = (p[0] - own[0], p[1] - own[1]);
            let length2 = rx * rx + ry * ry;
            // Distance to the bisector, times the length.
            let inside = (own[0] - px) * rx + (own[1] - py) * ry + 0.5 * length2;
            let reach = edge.value + rounding;
            // The own point, and those beyond what the blend below would notice.
            if length2 < 1e-18 || (reach > 0.0 && inside * inside > reach * reach * length2) {
                continue;
            }
            let scale = 1.0 / length2.sqrt();
            let bisector = Dual::chain2(x, y, [inside * scale, -rx * scale, -ry * scale]);
            edge = edge.smooth_min(bisector, rounding);
        }
        let id = own.map(|c| (floor(c) - REACH as i64).rem_euclid(self.n as i64));
        CellPlace { id, edge }
    }

    /// Squared distance to the nearest point, with the creases between cells rounded over differences
    /// up to `rounding` (greater than 0). Square lattice units; continuously differentiable.
    #[must_use]
    pub fn dents(&self, u: Dual, v: Dual, rounding: f64) -> Dual {
        let (x, y) = (self.lattice(u), self.lattice(v));
        self.neighbours(x.value, y.value)
            .iter()
            .fold(Dual::constant(9.0), |least, p| {
                let (dx, dy) = (x.value - p[0], y.value - p[1]);
                let d2 = dx * dx + dy * dy;
                // Further ones cannot come within any rounding of the nearest.
                if d2 > 3.0 {
                    return least;
                }
                let square = Dual::chain2(x, y, [d2, 2.0 * dx, 2.0 * dy]);
                least.smooth_min(square, rounding)
            })
    }

    /// Tile coordinate to padded lattice coordinate.
    fn lattice(&self, c: Dual) -> Dual {
        c.fract() * self.n as f64 + REACH as f64
    }

    fn neighbours(&self, x: f64, y: f64) -> [[f64; 2]; 25] {
        let row = self.n + 2 * REACH;
        // `fract` may round up to 1, which belongs to the last square.
        let corner = |c: f64| (c as usize).min(self.n + REACH - 1) - REACH;
        let start = corner(y) * row + corner(x);
        std::array::from_fn(|k| self.points[start + (k / 5) * row + k % 5])
    }
}

/// Where a place lies in its block.
#[derive(Debug, Clone, Copy)]
pub struct BlockPlace {
    /// Column and row, wrapped into the tile.
    pub id: [i64; 2],
    /// Distances to the nearer vertical and horizontal border, tile units.
    pub edge: [Dual; 2],
    /// Place from the block's middle, `−½…½` of its width and height.
    pub local: [Dual; 2],
}

/// Blocks in courses: `columns · rows` of them in a tile, every other row moved by `shift` of a width.
///
/// `rows` must be even where `shift` is not 0, or the tile does not repeat.
#[must_use]
pub fn courses(u: Dual, v: Dual, [columns, rows]: [i64; 2], shift: f64) -> BlockPlace {
    let y = v * rows as f64;
    let row = floor(y.value);
    let x = u * columns as f64 + shift * row.rem_euclid(2) as f64;
    let column = floor(x.value);
    let (fx, fy) = (x.fract(), y.fract());
    BlockPlace {
        id: [column.rem_euclid(columns), row.rem_euclid(rows)],
        edge: [
            fx.min(1.0 - fx) * (1.0 / columns as f64),
            fy.min(1.0 - fy) * (1.0 / rows as f64),
        ],
        local: [fx - 0.5, fy - 0.5],
    }
}
