//! Surface colours: decoded from sRGB to linear light before filtering.

use std::sync::LazyLock;

use glam::Vec2;

use super::{Grid, RawImage, Samples, Wrap};
use crate::math::{LinearRgb, linear_from_srgb};

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
    pub fn sample(&self, st: Vec2, wrap: Wrap) -> LinearRgb {
        match self {
            Self::Srgb8(g) => {
                let lut = &*LINEAR_FROM_BYTE;
                LinearRgb::from(g.mix3(st, wrap, |t, c| lut[usize::from(t[c])]))
            }
            Self::Linear(g) => LinearRgb::from(g.mix3(st, wrap, |t, c| t[c])),
        }
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
