//! How far every pixel of one shown picture is from another's, for false colours.

use super::flip::{PIXELS_PER_DEGREE, flip};
use crate::math::{LinearRgb, linear_from_srgb};

/// What is measured in each pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ErrorMetric {
    /// Absolute difference of the Rec. 709 luma of sRGB-encoded colours, 0…1.
    #[default]
    Luma,
    /// [`flip`] at [`PIXELS_PER_DEGREE`], 0…1.
    Flip,
}

impl ErrorMetric {
    /// Every metric, the cheapest first.
    pub const ALL: [Self; 2] = [Self::Luma, Self::Flip];

    /// As lists show it.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Luma => "luma difference",
            Self::Flip => "FLIP",
        }
    }

    /// An error that usually deserves the brightest colour.
    #[must_use]
    pub const fn usual_full_scale(self) -> f32 {
        match self {
            Self::Luma => 0.25,
            Self::Flip => 1.0,
        }
    }
}

/// A map of errors in two numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorSummary {
    /// What was measured.
    pub metric: ErrorMetric,
    /// Over all pixels.
    pub mean: f32,
    /// The 95th percentile: the smallest value that at least 95 % of the pixels do not exceed.
    pub p95: f32,
}

impl ErrorSummary {
    /// Of the values of a map; zeros for an empty one.
    #[must_use]
    pub fn of(metric: ErrorMetric, values: &[f32]) -> Self {
        let sum: f64 = values.iter().map(|&v| f64::from(v)).sum();
        let mut sorted = values.to_vec();
        let rank = (values.len() * 95).div_ceil(100).saturating_sub(1);
        let p95 = if sorted.is_empty() {
            0.0
        } else {
            *sorted.select_nth_unstable_by(rank, f32::total_cmp).1
        };
        Self {
            metric,
            mean: (sum / values.len().max(1) as f64) as f32,
            p95,
        }
    }
}

/// The error of every pixel of two shown pictures of one size: sRGB bytes, the fourth not looked at, in rows of
/// `width`. `stride` is 1, or how many pixels of the screen one of these stands for.
#[must_use]
pub fn error_map(
    metric: ErrorMetric,
    a: &[[u8; 4]],
    b: &[[u8; 4]],
    width: usize,
    stride: u32,
) -> Vec<f32> {
    match metric {
        ErrorMetric::Luma => a
            .iter()
            .zip(b)
            .map(|(a, b)| luma_difference(a, b))
            .collect(),
        ErrorMetric::Flip => {
            let per_degree = PIXELS_PER_DEGREE / stride.max(1) as f32;
            flip(&linear(a), &linear(b), width, per_degree)
        }
    }
}

fn luma_difference(a: &[u8; 4], b: &[u8; 4]) -> f32 {
    let difference = |i: usize| f32::from(a[i]) - f32::from(b[i]);
    (0.2126 * difference(0) + 0.7152 * difference(1) + 0.0722 * difference(2)).abs() / 255.0
}

fn linear(bytes: &[[u8; 4]]) -> Vec<LinearRgb> {
    let table: Vec<f32> = (0..=255_u8)
        .map(|b| linear_from_srgb(f32::from(b) / 255.0))
        .collect();
    let decode = |b: u8| table[usize::from(b)];
    let pixel = |&[r, g, b, _]: &[u8; 4]| LinearRgb::new(decode(r), decode(g), decode(b));
    bytes.iter().map(pixel).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_percentile() {
        let values: Vec<f32> = (1..=100).rev().map(|i| i as f32).collect();
        let summary = ErrorSummary::of(ErrorMetric::Luma, &values);
        assert_eq!((summary.mean, summary.p95), (50.5, 95.0));
        let nothing = ErrorSummary::of(ErrorMetric::Luma, &[]);
        assert_eq!((nothing.mean, nothing.p95), (0.0, 0.0));
    }

    #[test]
    fn equal_pictures_have_no_error_and_opposite_ones_all() {
        let (black, white) = ([[0, 0, 0, 255]; 9], [[255; 4]; 9]);
        for metric in ErrorMetric::ALL {
            let same = error_map(metric, &white, &white, 3, 1);
            assert_eq!(same, [0.0; 9], "{metric:?}");
            let opposite = error_map(metric, &black, &white, 3, 1);
            assert!(
                opposite.iter().all(|&e| e > 0.95 && e <= 1.0),
                "{opposite:?}"
            );
        }
    }
}
