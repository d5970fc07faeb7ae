//! Height maps with fewer bits.

use crate::scene::Scene;
use crate::texture::{MapImage, RawImage, Samples};

/// The scene with these pictures rounded to 8 bits; `None` if none of them has more, or if one holds what 8 bits
/// cannot (floats outside 0…1).
#[must_use]
pub fn cut_to_eight_bits(scene: &Scene, images: &[usize]) -> Option<Scene> {
    let raw = |i: usize| &scene.images[i].raw;
    let has_more = images.iter().any(|&i| raw(i).bits() > 8);
    if !has_more || !images.iter().all(|&i| fits(raw(i))) {
        return None;
    }
    let mut cut = scene.clone();
    for &i in images {
        let image = &scene.images[i];
        cut.images[i] = MapImage::new(&image.name, image.path.clone(), rounded(&image.raw));
    }
    Some(cut)
}

fn fits(image: &RawImage) -> bool {
    match &image.samples {
        Samples::F32(values) => values.iter().all(|v| (0.0..=1.0).contains(v)),
        Samples::U8(_) | Samples::U16(_) => true,
    }
}

/// Every sample to the nearest of 256 equal steps.
fn rounded(image: &RawImage) -> RawImage {
    let bytes = match &image.samples {
        Samples::U8(values) => values.clone(),
        // 65535 = 255 · 257.
        Samples::U16(values) => values
            .iter()
            .map(|&v| ((u32::from(v) + 128) / 257) as u8)
            .collect(),
        Samples::F32(values) => values.iter().map(|v| (v * 255.0).round() as u8).collect(),
    };
    RawImage {
        samples: Samples::U8(bytes),
        ..*image
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sixteen_bit_value_moves_by_half_a_step_at_most() {
        let values: Vec<u16> = (0..=u16::MAX).collect();
        let image = RawImage {
            width: 256,
            height: 256,
            channels: 1,
            samples: Samples::U16(values.clone()),
        };
        let cut = rounded(&image);
        assert_eq!(cut.bits(), 8);
        for (i, v) in (0..).zip(values) {
            let (x, y) = (i % 256, i / 256);
            let moved = (cut.fraction(x, y, 0) - f32::from(v) / 65_535.0).abs();
            assert!(moved <= 0.5 / 255.0 + 1e-6, "{v}: {moved}");
        }
    }

    #[test]
    fn floats_that_do_not_fit_are_left_alone() {
        let image = |value| RawImage {
            width: 1,
            height: 1,
            channels: 1,
            samples: Samples::F32(vec![value]),
        };
        assert!(fits(&image(1.0)) && !fits(&image(1.5)));
        assert_eq!(rounded(&image(0.5)).samples, Samples::U8(vec![128]));
    }
}
