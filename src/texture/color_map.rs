//! Surface colours: decoded from sRGB to linear light before filtering.

use std::sync::LazyLock;

use glam::Vec2;

use super::grid::{Decode, Floats};
use super::mips::{Ahead, halvings};
use super::{Grid, RawImage, Samples, Wrap};
use crate::math::{Bits as _, LinearRgb, Real, V2, linear_from_srgb};

/// Colours of a surface.
#[derive(Debug, Clone, PartialEq)]
pub enum ColorMap {
    /// sRGB bytes, decoded at each look-up; the fourth byte pads.
    Srgb8(Grid<[u8; 4]>),
    /// Linear floats: from float files as stored, from 16-bit files decoded when loaded.
    Linear(Grid<[f32; 3]>),
}

static LINEAR_FROM_BYTE: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|i| linear_from_srgb(i as f32 / 255.0)));

impl ColorMap {
    /// Reads the first three channels; a grey picture counts as three equal ones.
    #[must_use]
    pub fn from_image(image: &RawImage) -> Self {
        let (w, h) = (image.width, image.height);
        let step = usize::from(image.channels);
        let picks: [usize; 3] = if image.is_color() {
            [0, 1, 2]
        } else {
            [0, 0, 0]
        };
        match &image.samples {
            Samples::U8(s) => {
                let texels = s
                    .chunks_exact(step)
                    .map(|p| [p[picks[0]], p[picks[1]], p[picks[2]], 255]);
                Self::Srgb8(Grid::new(w, h, texels.collect()))
            }
            Samples::U16(s) => {
                let decode = |v: u16| linear_from_srgb(f32::from(v) / 65_535.0);
                let texels = s.chunks_exact(step).map(|p| picks.map(|c| decode(p[c])));
                Self::Linear(Grid::new(w, h, texels.collect()))
            }
            Samples::F32(s) => {
                let texels = s.chunks_exact(step).map(|p| picks.map(|c| p[c]));
                Self::Linear(Grid::new(w, h, texels.collect()))
            }
        }
    }

    /// Bilinear linear colour at `st` (see [`Grid::cell`]).
    #[must_use]
    #[inline(always)]
    pub fn sample<F: Real>(&self, st: V2<F>, wrap: Wrap) -> LinearRgb<F> {
        match self {
            Self::Srgb8(g) => LinearRgb::from(g.mix(&g.cell(st, wrap), Srgb)),
            Self::Linear(g) => LinearRgb::from(g.mix(&g.cell(st, wrap), Floats)),
        }
    }

    /// The map halved again and again: means of linear colours, not rounded to bytes.
    #[must_use]
    pub fn halvings(&self) -> Vec<Self> {
        let levels = match self {
            Self::Srgb8(g) => halvings([g.width(), g.height()], |x, y| {
                let [r, g, b, _] = g.at(x, y);
                [r, g, b].map(|byte| LINEAR_FROM_BYTE[usize::from(byte)])
            }),
            Self::Linear(g) => halvings([g.width(), g.height()], |x, y| g.at(x, y)),
        };
        levels.into_iter().map(Self::Linear).collect()
    }

    /// Columns and rows.
    #[must_use]
    pub fn size(&self) -> Vec2 {
        let [w, h] = match self {
            Self::Srgb8(g) => [g.width(), g.height()],
            Self::Linear(g) => [g.width(), g.height()],
        };
        Vec2::new(w as f32, h as f32)
    }

    /// Heap bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        match self {
            Self::Srgb8(g) => size_of_val(g.texels()),
            Self::Linear(g) => size_of_val(g.texels()),
        }
    }
}

impl Ahead for ColorMap {
    #[inline(always)]
    fn prefetch<F: Real>(&self, st: V2<F>, wrap: Wrap) {
        match self {
            Self::Srgb8(g) => g.prefetch(st, wrap),
            Self::Linear(g) => g.prefetch(st, wrap),
        }
    }
}

/// Three sRGB bytes, the lowest first.
#[derive(Clone, Copy)]
struct Srgb;

impl Decode<1, 3> for Srgb {
    #[inline(always)]
    fn decode<F: Real>(self, [texel]: [F::Bits; 1]) -> [F; 3] {
        let linear = &*LINEAR_FROM_BYTE;
        let [r] = texel.and(0xff).fetch(linear);
        let [g] = texel.shr(8).and(0xff).fetch(linear);
        let [b] = texel.shr(16).and(0xff).fetch(linear);
        Floats.decode([r, g, b])
    }
}
