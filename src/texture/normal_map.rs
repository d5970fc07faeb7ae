//! Tangent-space normals and slopes: raw numbers, never sRGB-decoded.

use glam::{Vec2, Vec3};

use super::grid::{Decode, Floats};
use super::mips::{Ahead, halvings};
use super::{Grid, MapRole, RawImage, Samples, Wrap};
use crate::math::{Bits as _, Real, V2, V3, normalize_or};

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
    #[inline(always)]
    pub fn sample<F: Real>(&self, st: V2<F>, wrap: Wrap) -> V3<F> {
        let ([x, y, z], factor) = match self {
            Self::U8(g) => (g.mix(&g.cell(st, wrap), Bytes), 2.0 / 255.0),
            Self::U16(g) => (g.mix(&g.cell(st, wrap), Halves), 2.0 / 65_535.0),
            Self::F32(g) => (g.mix(&g.cell(st, wrap), Floats), 2.0),
        };
        V3::new(x * factor - 1.0, y * factor - 1.0, z * factor - 1.0)
    }

    /// The map halved again and again: means of stored vectors, brought to unit length before (so that rounding
    /// does not pass for roughness) and not after. Of slopes, whose third number means nothing, as they are.
    #[must_use]
    pub fn halvings(&self, role: MapRole) -> Vec<Self> {
        let stored = |x: u32, y: u32| {
            let [r, g, b] = self.fraction(x, y);
            if role == MapRole::Slope {
                return [r, g, b];
            }
            let m = Vec3::new(r, g, b) * 2.0 - 1.0;
            (normalize_or(m, Vec3::ZERO) * 0.5 + 0.5).to_array()
        };
        let [w, h] = self.size().to_array().map(|n| n as u32);
        halvings([w, h], stored)
            .into_iter()
            .map(Self::F32)
            .collect()
    }

    /// The numbers of a texel as fractions.
    pub(super) fn fraction(&self, x: u32, y: u32) -> [f32; 3] {
        match self {
            Self::U8(g) => {
                let [r, g, b, _] = g.at(x, y);
                [r, g, b].map(|c| f32::from(c) / 255.0)
            }
            Self::U16(g) => {
                let [r, g, b, _] = g.at(x, y);
                [r, g, b].map(|c| f32::from(c) / 65_535.0)
            }
            Self::F32(g) => g.at(x, y),
        }
    }

    /// Columns and rows.
    #[must_use]
    pub fn size(&self) -> Vec2 {
        let [w, h] = match self {
            Self::U8(g) => [g.width(), g.height()],
            Self::U16(g) => [g.width(), g.height()],
            Self::F32(g) => [g.width(), g.height()],
        };
        Vec2::new(w as f32, h as f32)
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

impl Ahead for NormalMap {
    #[inline(always)]
    fn prefetch<F: Real>(&self, st: V2<F>, wrap: Wrap) {
        match self {
            Self::U8(g) => g.prefetch(st, wrap),
            Self::U16(g) => g.prefetch(st, wrap),
            Self::F32(g) => g.prefetch(st, wrap),
        }
    }
}

/// Three bytes, the lowest first.
#[derive(Clone, Copy)]
struct Bytes;

impl Decode<1, 3> for Bytes {
    #[inline(always)]
    fn decode<F: Real>(self, [xyz]: [F::Bits; 1]) -> [F; 3] {
        [
            xyz.and(0xff).signed_to_real(),
            xyz.shr(8).and(0xff).signed_to_real(),
            xyz.shr(16).and(0xff).signed_to_real(),
        ]
    }
}

/// Three numbers of 16 bits, the lowest first.
#[derive(Clone, Copy)]
struct Halves;

impl Decode<2, 3> for Halves {
    #[inline(always)]
    fn decode<F: Real>(self, [xy, z]: [F::Bits; 2]) -> [F; 3] {
        [
            xy.and(0xffff).signed_to_real(),
            xy.shr(16).signed_to_real(),
            z.and(0xffff).signed_to_real(),
        ]
    }
}
