//! Colours for numbers: from nearly black over blue, teal and green to light yellow.
//!
//! The map is a path through Oklab (Ottosson 2020): its lightness rises evenly, so that equal steps of the number look
//! equal and the order survives without colour; the hue turns once, from violet to yellow, with as much chroma,
//! up to a limit, as the screen has there.

use std::sync::LazyLock;

use super::{LinearRgb, srgb8_from_linear};

/// Oklab lightness of 0 and of 1.
const LIGHTNESS: [f32; 2] = [0.14, 0.95];
/// Hue of 0 and of 1, degrees.
const HUE: [f32; 2] = [305.0, 100.0];
/// Most chroma.
const CHROMA: f32 = 0.16;

/// The sRGB colour of a number in `[0, 1]`; values outside are clamped, NaN counts as 1, so that it is seen.
#[must_use]
pub fn false_color(value: f32) -> [u8; 3] {
    static TABLE: LazyLock<Vec<[u8; 3]>> = LazyLock::new(|| {
        (0..256_u16)
            .map(|i| on_path(f32::from(i) / 255.0))
            .collect()
    });
    // Written so that NaN becomes 1.
    let value = if value < 1.0 { value.max(0.0) } else { 1.0 };
    TABLE[(value * 255.0 + 0.5) as usize]
}

fn on_path(t: f32) -> [u8; 3] {
    let along = |[from, to]: [f32; 2]| from + (to - from) * t;
    let (lightness, hue) = (along(LIGHTNESS), along(HUE).to_radians());
    let chromas = (0..=32).rev().map(|i| CHROMA * i as f32 / 32.0);
    let mut colors = chromas.map(|c| from_oklab(lightness, c * hue.cos(), c * hue.sin()));
    let shown = |c: &LinearRgb| c.to_array().iter().all(|x| (0.0..=1.0).contains(x));
    let color = colors
        .find(shown)
        .unwrap_or(LinearRgb::gray(lightness.powi(3)));
    srgb8_from_linear(color)
}

fn from_oklab(lightness: f32, a: f32, b: f32) -> LinearRgb {
    let l = (lightness + 0.396_337_78 * a + 0.215_803_76 * b).powi(3);
    let m = (lightness - 0.105_561_346 * a - 0.063_854_17 * b).powi(3);
    let s = (lightness - 0.089_484_18 * a - 1.291_485_5 * b).powi(3);
    LinearRgb::new(
        4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s,
        -1.268_438 * l + 2.609_757_4 * m - 0.341_319_38 * s,
        -0.004_196_086_3 * l - 0.703_418_6 * m + 1.707_614_7 * s,
    )
}

#[cfg(test)]
mod tests {
    use super::false_color;
    use crate::math::linear_from_srgb;

    #[test]
    fn larger_is_lighter() {
        let luminance = |i: usize| {
            let color = false_color(i as f32 / 64.0);
            let [r, g, b] = color.map(|x| linear_from_srgb(f32::from(x) / 255.0));
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        for i in 0..64 {
            assert!(luminance(i) < luminance(i + 1), "{i}");
        }
        assert!(luminance(0) < 0.01 && luminance(64) > 0.7);
    }

    #[test]
    fn what_is_no_number_shows() {
        assert_eq!(false_color(f32::NAN), false_color(1.0));
        assert_eq!(false_color(7.0), false_color(1.0));
        assert_eq!(false_color(-7.0), false_color(0.0));
    }
}
