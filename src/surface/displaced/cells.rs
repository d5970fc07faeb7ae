//! Which cells of the height map lie under parts of a piece that does not cross the map's border: most pieces.

use crate::math::{Bits as _, Mask as _, Real};
use crate::surface::mapping::relief::ReliefField;
use crate::texture::Wrap;

/// A piece on its map.
#[derive(Debug, Clone, Copy)]
pub struct PieceCells {
    /// Column and row.
    axes: [Axis; 2],
}

/// One coordinate of the piece, in cells, none of its points outside the picture.
#[derive(Debug, Clone, Copy)]
struct Axis {
    /// At the piece's first corner, and its change to the others.
    at: f32,
    ways: [f32; 2],
    /// What rounding may change, here and where micro-triangles are made.
    margin: f32,
    /// The last cell.
    end: f32,
}

impl PieceCells {
    /// Of a piece whose corners have these texture coordinates; `None` if it reaches beyond the picture.
    pub fn new(field: &ReliefField<'_>, uv: [[f64; 2]; 3]) -> Option<Self> {
        let [a, b, c] = uv.map(|uv| field.texels_from_uv(uv));
        let axis = |k: usize| {
            let repeats = field.height.addressing.wrap == Wrap::Repeat;
            Axis::new([a[k], b[k], c[k]], field.size()[k], repeats)
        };
        Some(Self {
            axes: [axis(0)?, axis(1)?],
        })
    }

    /// Smallest and largest displacements in the sixteen parts of a part, given by their anchors and sizes as shares
    /// of the piece's edges; all sizes are `size` or its opposite.
    #[inline(always)]
    pub fn ranges<F: Real>(&self, field: &ReliefField<'_>, part: [F; 3], size: f32) -> [F; 2] {
        let [x, y] = &self.axes;
        let cells = x.width(size).max(y.width(size)) as u32 + 1;
        let mut level = cells.next_power_of_two().ilog2();
        let (columns, rows) = (x.cells(part), y.cells(part));
        // So many cells and one more begin in at most two squares of a level, wherever they begin. Mostly half as
        // large squares do.
        if level > 0 {
            let most = columns[0].splat((1_u32 << (level - 1)) as f32);
            let wider = |[first, last]: [F; 2]| most.lt(last - first);
            if !(wider(columns) | wider(rows)).any() {
                level -= 1;
            }
        }
        let squares =
            |[first, last]: [F; 2]| [first.to_index().shr(level), last.to_index().shr(level)];
        field.ranges_in(level, squares(columns), squares(rows))
    }
}

impl Axis {
    fn new([a, b, c]: [f64; 3], size: u32, repeats: bool) -> Option<Self> {
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        // As for places anywhere (`ReliefField::ranges_near`).
        let margin = 0.01 + 2e-6 * low.abs().max(high.abs());
        let n = f64::from(size);
        let turns = if repeats {
            ((low - margin) / n).floor() * n
        } else {
            0.0
        };
        // No for NaN, too.
        let is_inside = low - margin >= turns && high + margin < turns + n;
        is_inside.then_some(Self {
            at: (a - turns) as f32,
            ways: [(b - a) as f32, (c - a) as f32],
            margin: margin as f32,
            end: (n - 1.0) as f32,
        })
    }

    /// Cells across a part of this size, less than one too few.
    fn width(&self, size: f32) -> f32 {
        let [x, y] = self.ways;
        (x.max(y).max(0.0) - x.min(y).min(0.0)) * size + 2.0 * self.margin
    }

    /// The first and the last cell under each part.
    #[inline(always)]
    fn cells<F: Real>(&self, [a, b, s]: [F; 3]) -> [F; 2] {
        let [x, y] = self.ways;
        let (zero, end) = (a.splat(0.0), a.splat(self.end));
        let at = a * x + b * y + self.at;
        let (to_x, to_y) = (s * x, s * y);
        let low = at + to_x.smaller(to_y).smaller(zero) - self.margin;
        let high = at + to_x.larger(to_y).larger(zero) + self.margin;
        // Rounding may take them over the border.
        [low.floor().larger(zero), high.floor().smaller(end)]
    }
}
