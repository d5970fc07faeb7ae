//! A decoded picture before anyone has said what it means.

/// Sample values as the file stored them. Nothing is colour-managed.
#[derive(Debug, Clone, PartialEq)]
pub enum Samples {
    /// 0…255.
    U8(Vec<u8>),
    /// 0…65535.
    U16(Vec<u16>),
    /// Linear floats (HDR, EXR, float TIFF). Non-finite values were replaced by 0 when loaded.
    F32(Vec<f32>),
}

/// Interleaved samples, row 0 on top (v = 1).
#[derive(Debug, Clone, PartialEq)]
pub struct RawImage {
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// 1 (grey), 2 (grey, alpha), 3 (RGB) or 4 (RGBA).
    pub channels: u8,
    /// `width · height · channels` values.
    pub samples: Samples,
}

impl RawImage {
    /// Sample `channel` of the texel in column `x`, row `y`, as a fraction: integers over their largest
    /// value, floats as they are.
    ///
    /// # Panics
    /// If the place is outside the picture.
    #[must_use]
    pub fn fraction(&self, x: u32, y: u32, channel: u8) -> f32 {
        let i = (y as usize * self.width as usize + x as usize) * usize::from(self.channels)
            + usize::from(channel);
        match &self.samples {
            Samples::U8(s) => f32::from(s[i]) / 255.0,
            Samples::U16(s) => f32::from(s[i]) / 65_535.0,
            Samples::F32(s) => s[i],
        }
    }

    /// Bits per sample in the file: 8, 16 or 32.
    #[must_use]
    pub const fn bits(&self) -> u8 {
        match self.samples {
            Samples::U8(_) => 8,
            Samples::U16(_) => 16,
            Samples::F32(_) => 32,
        }
    }

    /// Whether there are red, green and blue samples.
    #[must_use]
    pub const fn is_color(&self) -> bool {
        self.channels >= 3
    }

    /// Index of the alpha sample, if there is one.
    #[must_use]
    pub const fn alpha_channel(&self) -> Option<u8> {
        match self.channels {
            2 => Some(1),
            4 => Some(3),
            _ => None,
        }
    }

    /// Puts 0 in place of infinities and NaN in floats; returns how many there were.
    pub fn make_finite(&mut self) -> usize {
        let Samples::F32(samples) = &mut self.samples else {
            return 0;
        };
        let mut replaced = 0;
        for sample in samples.iter_mut().filter(|s| !s.is_finite()) {
            *sample = 0.0;
            replaced += 1;
        }
        replaced
    }
}
