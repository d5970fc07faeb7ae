//! Pictures to compare: linear light, whatever the file held.

use crate::math::{LinearRgb, linear_from_srgb};
use crate::render::Film;
use crate::texture::{RawImage, Samples};

/// A picture of linear light in rows from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    width: u32,
    height: u32,
    pixels: Vec<LinearRgb>,
}

impl Picture {
    /// Wraps pixels in rows from the top.
    ///
    /// # Panics
    /// If the count is not `width · height`, or either is 0.
    #[must_use]
    pub fn new([width, height]: [u32; 2], pixels: Vec<LinearRgb>) -> Self {
        assert!(width > 0 && height > 0, "a picture has at least one pixel");
        assert_eq!(
            pixels.len(),
            width as usize * height as usize,
            "a picture has width times height pixels"
        );
        Self {
            width,
            height,
            pixels,
        }
    }

    /// The light that a decoded file shows: floats as stored, integers decoded from sRGB. Grey counts as
    /// three equal channels; opacity is not read.
    #[must_use]
    pub fn from_image(image: &RawImage) -> Self {
        let channels: [u8; 3] = if image.is_color() {
            [0, 1, 2]
        } else {
            [0, 0, 0]
        };
        let is_linear = matches!(image.samples, Samples::F32(_));
        let light = |x, y| {
            let stored = channels.map(|c| image.fraction(x, y, c));
            LinearRgb::from(if is_linear {
                stored
            } else {
                stored.map(linear_from_srgb)
            })
        };
        let pixels = (0..image.height)
            .flat_map(|y| (0..image.width).map(move |x| light(x, y)))
            .collect();
        Self::new([image.width, image.height], pixels)
    }

    /// What a film shows at exposure 0: the mean of its samples.
    ///
    /// # Panics
    /// If the film has no pixels.
    #[must_use]
    pub fn from_film(film: &Film) -> Self {
        let [width, height] = film.size();
        let pixels = (0..height)
            .flat_map(|y| (0..width).map(move |x| film.mean(x, y)))
            .collect();
        Self::new([width, height], pixels)
    }

    /// Columns and rows.
    #[must_use]
    pub const fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// All pixels in rows from the top.
    #[must_use]
    pub fn pixels(&self) -> &[LinearRgb] {
        &self.pixels
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn raw(channels: u8, samples: Samples) -> RawImage {
        RawImage {
            width: 2,
            height: 1,
            channels,
            samples,
        }
    }

    #[test]
    fn bytes_are_decoded_and_floats_are_not() {
        let bytes = Picture::from_image(&raw(3, Samples::U8(vec![0, 255, 188, 255, 0, 0])));
        let middle = linear_from_srgb(188.0 / 255.0);
        assert_eq!(bytes.pixels()[0], LinearRgb::new(0.0, 1.0, middle));
        assert!((middle - 0.5029).abs() < 1e-4);
        let floats = Picture::from_image(&raw(1, Samples::F32(vec![0.5, 7.0])));
        assert_eq!(
            floats.pixels(),
            [LinearRgb::gray(0.5), LinearRgb::gray(7.0)]
        );
    }

    #[test]
    fn opacity_is_not_read() {
        let picture =
            Picture::from_image(&raw(4, Samples::F32(vec![1., 2., 3., 0., 4., 5., 6., 0.])));
        assert_eq!(picture.size(), [2, 1]);
        assert_eq!(picture.pixels()[1], LinearRgb::new(4.0, 5.0, 6.0));
    }
}
