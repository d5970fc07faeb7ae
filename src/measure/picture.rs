//! Pictures to compare, as linear light, whatever the file held.

use std::path::Path;

use crate::math::{LinearRgb, linear_from_srgb};
use crate::render::Picture;
use crate::scene::LoadError;
use crate::scene::load::{PictureLimits, decode_picture};
use crate::texture::{RawImage, Samples};

/// Reads a picture file of any kind that maps may have; see [`picture_from_image`].
///
/// # Errors
/// [`LoadError::Invalid`] with the file and the cause.
pub fn read_picture(path: &Path) -> Result<Picture, LoadError> {
    let decoded = decode_picture(path, &PictureLimits::default());
    let decoded = decoded.map_err(|cause| LoadError::Invalid {
        path: path.to_owned(),
        line: None,
        message: cause.to_string(),
    })?;
    Ok(picture_from_image(&decoded.image))
}

/// The light that a decoded file shows: floats as stored, integers decoded from sRGB. Grey counts as three
/// equal channels; opacity is not read.
#[must_use]
pub fn picture_from_image(image: &RawImage) -> Picture {
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
    let row = |y| (0..image.width).map(move |x| (x, y));
    Picture {
        width: image.width,
        height: image.height,
        pixels: (0..image.height)
            .flat_map(row)
            .map(|(x, y)| light(x, y))
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixels(channels: u8, samples: Samples) -> Vec<LinearRgb> {
        let image = RawImage {
            width: 2,
            height: 1,
            channels,
            samples,
        };
        let picture = picture_from_image(&image);
        assert_eq!((picture.width, picture.height), (2, 1));
        picture.pixels
    }

    #[test]
    fn bytes_are_decoded_and_floats_are_not() {
        let bytes = pixels(3, Samples::U8(vec![0, 255, 188, 255, 0, 0]));
        let middle = linear_from_srgb(188.0 / 255.0);
        assert_eq!(bytes[0], LinearRgb::new(0.0, 1.0, middle));
        assert!((middle - 0.5029).abs() < 1e-4);
        let floats = pixels(1, Samples::F32(vec![0.5, 7.0]));
        assert_eq!(floats, [LinearRgb::gray(0.5), LinearRgb::gray(7.0)]);
    }

    #[test]
    fn opacity_is_not_read() {
        let samples = vec![1.0, 2.0, 3.0, 0.0, 4.0, 5.0, 6.0, 0.0];
        let picture = pixels(4, Samples::F32(samples));
        assert_eq!(picture[1], LinearRgb::new(4.0, 5.0, 6.0));
    }
}
