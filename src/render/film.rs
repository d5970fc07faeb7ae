//! Linear sums per pixel.

use crate::math::{LinearRgb, srgb8_from_linear};

/// Sums of linear samples, row 0 on top.
#[derive(Debug, Clone, Default)]
pub struct Film {
    width: u32,
    height: u32,
    sums: Vec<LinearRgb>,
    samples: u32,
}

impl Film {
    /// A black picture without samples.
    #[must_use]
    pub fn new([width, height]: [u32; 2]) -> Self {
        Self {
            width,
            height,
            sums: vec![LinearRgb::BLACK; width as usize * height as usize],
            samples: 0,
        }
    }

    /// Columns and rows.
    #[must_use]
    pub const fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// Samples that every pixel has.
    #[must_use]
    pub const fn samples(&self) -> u32 {
        self.samples
    }

    /// Mean of the samples of the pixel in column `x`, row `y`; black before the first.
    ///
    /// # Panics
    /// If it is outside.
    #[must_use]
    pub fn mean(&self, x: u32, y: u32) -> LinearRgb {
        let sum = self.sums[y as usize * self.width as usize + x as usize];
        sum * (1.0 / self.samples.max(1) as f32)
    }

    /// What a screen takes of a mean at this exposure (stops).
    #[must_use]
    pub fn encode(mean: LinearRgb, exposure_ev: f32) -> [u8; 3] {
        srgb8_from_linear(mean * exposure_ev.exp2())
    }
}
