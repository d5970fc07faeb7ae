//! Tangent-space normals and slopes: raw numbers, never sRGB-decoded.

use glam::{Vec2, Vec3};

use super::{Grid, RawImage, Samples, Wrap};

/// Three numbers a texel, read as `2c − 1`.
#[derive(Debug, Clone, PartialEq)]
pub enum NormalMap {
    /// 8 bits a channel; the fourth byte pads.
    U8(Grid<[u8; 4]>),
    /// 16 bits a channel; the fourth word pads.
    U16(Grid<[u16; 4]>),
    /// Floats, stored as fractions like the integers.
    F32(Grid<[f32; 3]>),
}

impl NormalMap {
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
                    .map(|p| [p[picks[0]], p[picks[1]], p[picks[2]], 0]);
                Self::U8(Grid::new(w, h, texels.collect()))
            }
            Samples::U16(s) => {
                let texels = s
                    .chunks_exact(step)
                    .map(|p| [p[picks[0]], p[picks[1]], p[picks[2]], 0]);
                Self::U16(Grid::new(w, h, texels.collect()))
            }
            Samples::F32(s) => {
                let texels = s.chunks_exact(step).map(|p| picks.map(|c| p[c]));
                Self::F32(Grid::new(w, h, texels.collect()))
            }
        }
    }

    /// Bilinear `2c − 1` at `st`, not renormalised: x along +u, y along the stored green, z outwards.
    #[must_use]
    pub fn sample(&self, st: Vec2, wrap: Wrap) -> Vec3 {
        let stored = match self {
            Self::U8(g) => Vec3::from(g.mix3(st, wrap, |t, c| f32::from(t[c]))) * (1.0 / 255.0),
            Self::U16(g) => Vec3::from(g.mix3(st, wrap, |t, c| f32::from(t[c]))) * (1.0 / 65_535.0),
            Self::F32(g) => Vec3::from(g.mix3(st, wrap, |t, c| t[c])),
        };
        stored * 2.0 - Vec3::ONE
    }

    /// Heap bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        match self {
            Self::U8(g) => size_of_val(g.texels()),
            Self::U16(g) => size_of_val(g.texels()),
            Self::F32(g) => size_of_val(g.texels()),
        }
    }
}
