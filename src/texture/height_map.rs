//! Heights, 16 bits each unless the file held floats; also used for opacity.

use glam::Vec2;

use super::grid::{BilinearCell, Floats};
use super::mips::{Ahead, halvings};
use super::{Channel, Grid, RawImage, Samples, Wrap};
use crate::math::{Bits as _, Mask as _, Real, V2};

/// One number a texel. Integers stay `u16` in memory (8-bit ones are spread to 16), behind one accessor.
#[derive(Debug, Clone, PartialEq)]
pub enum HeightMap {
    /// Fractions of 65535.
    U16(Grid<u16>),
    /// From float files, as stored.
    F32(Grid<f32>),
}

/// A height and its derivatives across the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeightSlope<F = f32> {
    /// Stored height, 0…1 for integer files.
    pub height: F,
    /// Change per picture width to the right (s) and per picture height downwards (t).
    pub slope_st: V2<F>,
}

impl HeightMap {
    /// Takes one channel out of a picture.
    #[must_use]
    pub fn from_image(image: &RawImage, channel: Channel) -> Self {
        let (w, h) = (image.width, image.height);
        if let (Samples::U16(samples), 1) = (&image.samples, image.channels)
            && channel != Channel::Alpha
        {
            return Self::U16(Grid::new(w, h, samples.clone()));
        }
        let pixels = (0..h).flat_map(|y| (0..w).map(move |x| (x, y)));
        let value = |(x, y)| channel_value(image, x, y, channel);
        if matches!(image.samples, Samples::F32(_)) {
            Self::F32(Grid::new(w, h, pixels.map(value).collect()))
        } else {
            let to_u16 = |f: f32| (f * 65_535.0 + 0.5) as u16;
            Self::U16(Grid::new(w, h, pixels.map(value).map(to_u16).collect()))
        }
    }

    /// Columns.
    #[must_use]
    pub const fn width(&self) -> u32 {
        match self {
            Self::U16(g) => g.width(),
            Self::F32(g) => g.width(),
        }
    }

    /// Rows.
    #[must_use]
    pub const fn height(&self) -> u32 {
        match self {
            Self::U16(g) => g.height(),
            Self::F32(g) => g.height(),
        }
    }

    /// The map halved again and again: means of heights.
    #[must_use]
    pub fn halvings(&self) -> Vec<Self> {
        let size = [self.width(), self.height()];
        let levels = halvings(size, |x, y| [self.texel(x, y)]).into_iter();
        let plain = |level: Grid<[f32; 1]>| {
            let texels = level.texels().iter().map(|[height]| *height);
            Grid::new(level.width(), level.height(), texels.collect())
        };
        levels.map(|level| Self::F32(plain(level))).collect()
    }

    /// Heap bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        match self {
            Self::U16(g) => size_of_val(g.texels()),
            Self::F32(g) => size_of_val(g.texels()),
        }
    }

    /// Smallest and largest stored height.
    #[must_use]
    pub fn extremes(&self) -> [f32; 2] {
        fn of<T: Copy + PartialOrd>(texels: &[T]) -> [T; 2] {
            let first = [texels[0]; 2];
            texels.iter().fold(first, |[low, high], &t| {
                [
                    if t < low { t } else { low },
                    if t > high { t } else { high },
                ]
            })
        }
        match self {
            Self::U16(g) => of(g.texels()).map(fraction),
            Self::F32(g) => of(g.texels()),
        }
    }

    /// Stored value of the texel in column `x`, row `y`.
    ///
    /// # Panics
    /// If it is outside.
    #[must_use]
    pub fn texel(&self, x: u32, y: u32) -> f32 {
        match self {
            Self::U16(g) => fraction(g.at(x, y)),
            Self::F32(g) => g.at(x, y),
        }
    }

    /// Bilinear value at `st` (see [`Grid::cell`]).
    #[must_use]
    #[inline(always)]
    pub fn sample<F: Real>(&self, st: V2<F>, wrap: Wrap) -> F {
        let (cell, corners) = self.corners(st, wrap);
        cell.mix(corners)
    }

    /// Bilinear value and its analytic derivative: exact for the bilinear surface, discontinuous at
    /// texel lines.
    #[must_use]
    #[inline(always)]
    pub fn sample_slope<F: Real>(&self, st: V2<F>, wrap: Wrap) -> HeightSlope<F> {
        let (cell, corners) = self.corners(st, wrap);
        HeightSlope {
            height: cell.mix(corners),
            slope_st: cell.slope_per_texel(corners).times(self.size()),
        }
    }

    /// The report's central differences (2.15) per picture width and height, continuous between texels.
    ///
    /// Differences of the bilinear height one texel to either side equal the bilinear interpolation of
    /// the texels' own central differences.
    #[must_use]
    #[inline(always)]
    pub fn central_slope<F: Real>(&self, st: V2<F>, wrap: Wrap) -> V2<F> {
        let size = self.size();
        let (ds, dt) = (Vec2::new(1.0 / size.x, 0.0), Vec2::new(0.0, 1.0 / size.y));
        let right = self.sample(st.plus(ds), wrap) - self.sample(st.plus(-ds), wrap);
        let down = self.sample(st.plus(dt), wrap) - self.sample(st.plus(-dt), wrap);
        V2::new(right, down).times(size * 0.5)
    }

    /// The cell that `st` falls into and the values at its corners.
    #[inline(always)]
    fn corners<F: Real>(&self, st: V2<F>, wrap: Wrap) -> (BilinearCell<F>, [F; 4]) {
        match self {
            Self::U16(g) => {
                let cell = g.cell(st, wrap);
                let corners = halves(g.texels(), &cell);
                (cell, corners)
            }
            Self::F32(g) => {
                let cell = g.cell(st, wrap);
                let [[a], [b], [c], [d]] = g.corners(&cell, Floats);
                (cell, [a, b, c, d])
            }
        }
    }

    /// Columns and rows.
    #[must_use]
    #[inline(always)]
    pub fn size(&self) -> Vec2 {
        Vec2::new(self.width() as f32, self.height() as f32)
    }
}

impl Ahead for HeightMap {
    #[inline(always)]
    fn prefetch<F: Real>(&self, st: V2<F>, wrap: Wrap) {
        match self {
            Self::U16(g) => g.prefetch(st, wrap),
            Self::F32(g) => g.prefetch(st, wrap),
        }
    }
}

/// The height that a stored number means.
pub(super) fn fraction(stored: u16) -> f32 {
    f32::from(stored) * (1.0 / 65_535.0)
}

/// [`fraction`] of numbers that were fetched.
#[inline(always)]
fn fractions<F: Real>(stored: F::Bits) -> F {
    stored.signed_to_real() * (1.0 / 65_535.0)
}

/// The heights at the corners of cells.
#[inline(always)]
fn halves<F: Real>(texels: &[u16], cell: &BilinearCell<F>) -> [F; 4] {
    let [a, b, c, d] = cell.texels;
    // Most cells lie within the picture: two numbers next to each other are one look-up.
    let [after_a, after_c] = [a.plus(1), c.plus(1)];
    if (after_a.equals_each(b) & after_c.equals_each(d)).all() {
        let (upper, lower) = (a.fetch_pair(texels), c.fetch_pair(texels));
        return [
            fractions(upper.and(0xffff)),
            fractions(upper.shr(16)),
            fractions(lower.and(0xffff)),
            fractions(lower.shr(16)),
        ];
    }
    [
        fractions(a.fetch_half(texels)),
        fractions(b.fetch_half(texels)),
        fractions(c.fetch_half(texels)),
        fractions(d.fetch_half(texels)),
    ]
}

fn channel_value(image: &RawImage, x: u32, y: u32, channel: Channel) -> f32 {
    let at = |c| image.fraction(x, y, c);
    match (channel, image.is_color()) {
        (Channel::Alpha, _) => image.alpha_channel().map_or(1.0, at),
        (_, false) | (Channel::R, true) => at(0),
        (Channel::G, true) => at(1),
        (Channel::B, true) => at(2),
        (Channel::Luma, true) => {
            let (r, g, b) = (at(0), at(1), at(2));
            // Equal channels must keep their exact value, which the weighted sum would round.
            if r == g && g == b {
                r
            } else {
                0.2126 * r + 0.7152 * g + 0.0722 * b
            }
        }
    }
}
