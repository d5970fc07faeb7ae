//! Mixing of sRGB-encoded colours.
//!
//! Palettes are picked and mixed as encoded values: steps look even, and no power function is needed.

/// An sRGB-encoded colour, each channel 0…1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Paint(pub [f64; 3]);

impl Paint {
    /// From `0xRRGGBB`.
    #[must_use]
    pub const fn hex(rgb: u32) -> Self {
        let [_, r, g, b] = rgb.to_be_bytes();
        Self([r as f64 / 255.0, g as f64 / 255.0, b as f64 / 255.0])
    }

    /// `self` at 0, `other` at 1; `t` outside is clamped.
    #[must_use]
    pub fn mix(self, other: Self, t: f64) -> Self {
        let t = t.clamp(0.0, 1.0);
        Self(std::array::from_fn(|i| {
            self.0[i] + (other.0[i] - self.0[i]) * t
        }))
    }

    /// Brighter or darker.
    #[must_use]
    pub fn scaled(self, k: f64) -> Self {
        Self(self.0.map(|c| c * k))
    }

    /// One of `palette` by a number in `[0, 1)`.
    #[must_use]
    pub fn pick(palette: &[Self], random: f64) -> Self {
        let last = palette.len().saturating_sub(1);
        palette
            .get(((random * palette.len() as f64) as usize).min(last))
            .copied()
            .unwrap_or(Self([0.5; 3]))
    }

    /// Rounded to bytes; out of range is clamped.
    #[must_use]
    pub fn to_bytes(self) -> [u8; 3] {
        self.0.map(|c| (c.clamp(0.0, 1.0) * 255.0 + 0.5) as u8)
    }
}
