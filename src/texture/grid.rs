//! A rectangle of texels and the address arithmetic of bilinear look-ups.

use glam::Vec2;

use super::Wrap;

/// `width · height` texels, row 0 on top.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid<T> {
    width: u32,
    height: u32,
    texels: Vec<T>,
}

/// Four texel indices around a point and its place between them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BilinearCell {
    /// Indices of the texels at (column, row) = (i, j), (i+1, j), (i, j+1), (i+1, j+1).
    pub texels: [u32; 4],
    /// Fraction towards column i+1, in `[0, 1)`.
    pub fx: f32,
    /// Fraction towards row j+1, in `[0, 1)`.
    pub fy: f32,
}

impl<T: Copy> Grid<T> {
    /// Wraps texels in rows from the top.
    ///
    /// # Panics
    /// If the count is not `width · height`, or either is 0.
    #[must_use]
    pub fn new(width: u32, height: u32, texels: Vec<T>) -> Self {
        assert!(width > 0 && height > 0, "a grid has at least one texel");
        assert_eq!(
            texels.len(),
            width as usize * height as usize,
            "a grid has width times height texels"
        );
        Self {
            width,
            height,
            texels,
        }
    }

    /// Columns.
    #[must_use]
    pub const fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    #[must_use]
    pub const fn height(&self) -> u32 {
        self.height
    }

    /// All texels in rows from the top.
    #[must_use]
    pub fn texels(&self) -> &[T] {
        &self.texels
    }

    /// The texel in column `x`, row `y`.
    ///
    /// # Panics
    /// If it is outside.
    #[must_use]
    pub fn at(&self, x: u32, y: u32) -> T {
        self.texels[y as usize * self.width as usize + x as usize]
    }

    /// The texel with a linear index from [`cell`](Self::cell).
    pub(super) fn texel(&self, index: u32) -> T {
        self.texels[index as usize]
    }

    /// Where `st` falls: s to the right and t downwards, both 0…1 across the picture, texel centres at
    /// `(i + ½) / size`. Non-finite coordinates count as 0.
    #[must_use]
    #[inline]
    pub fn cell(&self, st: Vec2, wrap: Wrap) -> BilinearCell {
        let (i0, i1, fx) = wrap.neighbours(st.x, self.width);
        let (j0, j1, fy) = wrap.neighbours(st.y, self.height);
        let (row0, row1) = (j0 * self.width, j1 * self.width);
        BilinearCell {
            texels: [row0 + i0, row0 + i1, row1 + i0, row1 + i1],
            fx,
            fy,
        }
    }
}

impl<T: Copy> Grid<T> {
    /// Bilinear means of the first three channels at `st`.
    pub(super) fn mix3(
        &self,
        st: Vec2,
        wrap: Wrap,
        channel: impl Fn(&T, usize) -> f32,
    ) -> [f32; 3] {
        let cell = self.cell(st, wrap);
        let texels = cell.texels.map(|i| self.texel(i));
        [0, 1, 2].map(|c| cell.mix([0, 1, 2, 3].map(|i: usize| channel(&texels[i], c))))
    }
}

impl Wrap {
    /// The two texels around coordinate `c` (0…1 across `n` texels) and the fraction between them.
    pub(super) fn neighbours(self, c: f32, n: u32) -> (u32, u32, f32) {
        let c = if c.is_finite() { c } else { 0.0 };
        match self {
            // Taking off whole turns first is exact and keeps the fraction's precision.
            Self::Repeat => {
                let x = (c - floor(c)) * n as f32 - 0.5;
                let below = floor(x);
                let i = below as i32;
                let i0 = if i < 0 { n - 1 } else { (i as u32).min(n - 1) };
                let i1 = if i0 + 1 == n { 0 } else { i0 + 1 };
                (i0, i1, x - below)
            }
            Self::Clamp | Self::Mirror => {
                let c = if self == Self::Clamp {
                    c.clamp(-1.0, 2.0)
                } else {
                    c - 2.0 * (c * 0.5).floor()
                };
                let x = c * n as f32 - 0.5;
                let floor = x.floor();
                let i = floor as i64;
                (self.index(i, n), self.index(i + 1, n), x - floor)
            }
        }
    }
}

/// The largest whole number not above `x`, without a call into the C library on processors older than
/// SSE 4.1, which is what a portable build is compiled for.
fn floor(x: f32) -> f32 {
    // From 2²³ on every float is whole.
    if x.abs() < 8_388_608.0 {
        let toward_zero = x as i32 as f32;
        if toward_zero > x {
            toward_zero - 1.0
        } else {
            toward_zero
        }
    } else {
        x
    }
}

impl BilinearCell {
    /// The bilinear mean of four corner values in the order of `texels`.
    #[must_use]
    pub fn mix(&self, [a, b, c, d]: [f32; 4]) -> f32 {
        let top = a + (b - a) * self.fx;
        let bottom = c + (d - c) * self.fx;
        top + (bottom - top) * self.fy
    }

    /// Derivatives of [`mix`](Self::mix) per texel, to the right and downwards.
    #[must_use]
    pub fn slope_per_texel(&self, [a, b, c, d]: [f32; 4]) -> Vec2 {
        let right = (b - a) + ((d - c) - (b - a)) * self.fy;
        let down = (c - a) + ((d - b) - (c - a)) * self.fx;
        Vec2::new(right, down)
    }
}
