//! From a surface's uv to a place on a picture.

use glam::Vec2;

use super::{MapSlot, Wrap};
use crate::math::{Real, V2};

/// `st = uv · scale + offset`: s to the right and t downwards across the picture.
///
/// Row 0 of a picture lies at v = 1, so the plain case is `scale = (1, −1)`, `offset = (0, 1)`. Flipping
/// v and MTL's `-s`, `-o` are folded in, so a look-up costs the same with or without them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Addressing {
    /// Picture widths per unit of u, picture heights (downwards) per unit of v.
    pub scale: Vec2,
    /// Place of uv = (0, 0).
    pub offset: Vec2,
    /// Beyond the border.
    pub wrap: Wrap,
}

impl Addressing {
    /// The addressing that a slot asks for.
    #[must_use]
    pub fn from_slot(slot: &MapSlot) -> Self {
        let [su, sv] = slot.uv_scale;
        let [ou, ov] = slot.uv_offset;
        let (scale_t, offset_t) = if slot.flip_v {
            (sv, ov)
        } else {
            (-sv, 1.0 - ov)
        };
        Self {
            scale: Vec2::new(su, scale_t),
            offset: Vec2::new(ou, offset_t),
            wrap: slot.wrap,
        }
    }

    /// Texels per unit of texture coordinates on a picture of `size`: the geometric mean of both directions.
    #[must_use]
    pub fn texels_per_uv(&self, size: Vec2) -> f32 {
        let texels = (size * self.scale).abs();
        (texels.x * texels.y).sqrt()
    }

    /// Place on the picture of a surface point's `uv`.
    #[must_use]
    #[inline(always)]
    pub fn st<F: Real>(&self, uv: V2<F>) -> V2<F> {
        uv.times(self.scale).plus(self.offset)
    }
}
