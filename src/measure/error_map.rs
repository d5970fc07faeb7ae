//! How far every pixel of one shown picture is from another's, for false colours.

use super::flip::{PIXELS_PER_DEGREE, flip};
use crate::math::{LinearRgb, angle, linear_from_srgb};
use crate::render::{PixelRecord, Records};

/// What is measured in each pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ErrorMetric {
    /// Absolute difference of the Rec. 709 luma of sRGB-encoded colours, 0…1.
    #[default]
    Luma,
    /// [`flip`] at [`PIXELS_PER_DEGREE`], 0…1.
    Flip,
    /// Angle between the normals that light is computed with, degrees.
    NormalAngle,
    /// Distance between the texture coordinates shown, texels of the material's map (see
    /// [`UvYardstick`](crate::render::UvYardstick)).
    Uv,
    /// Difference of the displacement along the smooth normal, over the amplitude.
    Depth,
}

impl ErrorMetric {
    /// Every metric, the cheapest first.
    pub const ALL: [Self; 5] = [
        Self::Luma,
        Self::Flip,
        Self::NormalAngle,
        Self::Uv,
        Self::Depth,
    ];

    /// As lists show it.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Luma => "luma difference",
            Self::Flip => "FLIP",
            Self::NormalAngle => "normal angle",
            Self::Uv => "uv distance",
            Self::Depth => "depth over amplitude",
        }
    }

    /// What follows its numbers.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Luma | Self::Flip | Self::Depth => "",
            Self::NormalAngle => "°",
            Self::Uv => " texels",
        }
    }

    /// An error that usually deserves the brightest colour.
    #[must_use]
    pub const fn usual_full_scale(self) -> f32 {
        match self {
            Self::Luma | Self::Depth => 0.25,
            Self::Flip => 1.0,
            Self::NormalAngle => 45.0,
            Self::Uv => 8.0,
        }
    }

    /// The largest full scale that means something.
    #[must_use]
    pub const fn most_full_scale(self) -> f32 {
        match self {
            Self::Luma | Self::Flip => 1.0,
            Self::NormalAngle => 180.0,
            Self::Uv => 1024.0,
            Self::Depth => 4.0,
        }
    }

    /// Whether it looks at [`Records`] instead of colours.
    #[must_use]
    pub const fn needs_records(self) -> bool {
        matches!(self, Self::NormalAngle | Self::Uv | Self::Depth)
    }
}

/// A map of errors in a few numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorSummary {
    /// What was measured.
    pub metric: ErrorMetric,
    /// Over all pixels that have an error.
    pub mean: f32,
    /// The 95th percentile: the smallest value that at least 95 % of these pixels do not exceed.
    pub p95: f32,
    /// Pixels with an infinite error: only one of the two pictures shows a surface there.
    pub lone: u64,
}

impl ErrorSummary {
    /// Of the values of a map; zeros for an empty one.
    #[must_use]
    pub fn of(metric: ErrorMetric, values: &[f32]) -> Self {
        let mut finite: Vec<f32> = values.iter().copied().filter(|v| v.is_finite()).collect();
        let sum: f64 = finite.iter().map(|&v| f64::from(v)).sum();
        let mean = (sum / finite.len().max(1) as f64) as f32;
        let rank = (finite.len() * 95).div_ceil(100).saturating_sub(1);
        let p95 = if finite.is_empty() {
            0.0
        } else {
            *finite.select_nth_unstable_by(rank, f32::total_cmp).1
        };
        let lone = values.iter().filter(|v| v.is_infinite()).count() as u64;
        Self {
            metric,
            mean,
            p95,
            lone,
        }
    }
}

/// One of two pictures.
#[derive(Debug, Clone, Copy)]
pub struct Shown<'a> {
    /// sRGB bytes, the fourth not looked at, in rows.
    pub pixels: &'a [[u8; 4]],
    /// What is known beside the colours.
    pub records: Option<&'a Records>,
}

/// The error of every pixel of two shown pictures of one size, in rows of `width`. `stride` is 1, or how many
/// pixels of the screen one of these stands for.
///
/// NaN where there is nothing to compare: neither shows a surface, or the records that the metric needs are
/// missing. Infinite where only one shows a surface, or the two show maps of different materials.
#[must_use]
pub fn error_map(
    metric: ErrorMetric,
    [a, b]: [Shown<'_>; 2],
    width: usize,
    stride: u32,
) -> Vec<f32> {
    match metric {
        ErrorMetric::Luma => {
            let pixels = a.pixels.iter().zip(b.pixels);
            pixels.map(|(a, b)| luma_difference(a, b)).collect()
        }
        ErrorMetric::Flip => {
            let per_degree = PIXELS_PER_DEGREE / stride.max(1) as f32;
            flip(&linear(a.pixels), &linear(b.pixels), width, per_degree)
        }
        ErrorMetric::NormalAngle | ErrorMetric::Uv | ErrorMetric::Depth => {
            let (Some(records), Some(others)) = (a.records, b.records) else {
                return vec![f32::NAN; a.pixels.len()];
            };
            let pairs = records.pixels.iter().zip(&others.pixels);
            pairs
                .map(|(a, b)| record_difference(metric, records, (a, b)))
                .collect()
        }
    }
}

fn record_difference(
    metric: ErrorMetric,
    records: &Records,
    (a, b): (&PixelRecord, &PixelRecord),
) -> f32 {
    let (material, other) = match (a.material, b.material) {
        (None, None) => return f32::NAN,
        (Some(a), Some(b)) => (a, b),
        _ => return f32::INFINITY,
    };
    match metric {
        ErrorMetric::NormalAngle => {
            angle(a.normal.as_dvec3(), b.normal.as_dvec3()).to_degrees() as f32
        }
        ErrorMetric::Depth => (a.depth - b.depth).abs(),
        _ if material != other => f32::INFINITY,
        _ => match (a.uv, b.uv, records.yardsticks.get(usize::from(material))) {
            (Some(a), Some(b), Some(yardstick)) => yardstick.texels(a, b),
            _ => f32::NAN,
        },
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
    use glam::{Vec2, Vec3};

    use super::*;
    use crate::render::UvYardstick;

    #[test]
    fn mean_and_percentile() {
        let values: Vec<f32> = (1..=100).rev().map(|i| i as f32).collect();
        let summary = ErrorSummary::of(ErrorMetric::Luma, &values);
        assert_eq!((summary.mean, summary.p95), (50.5, 95.0));
        let nothing = ErrorSummary::of(ErrorMetric::Luma, &[]);
        assert_eq!((nothing.mean, nothing.p95), (0.0, 0.0));
        let some = [f32::NAN, 1.0, f32::INFINITY, 3.0];
        let some = ErrorSummary::of(ErrorMetric::Uv, &some);
        assert_eq!((some.mean, some.p95, some.lone), (2.0, 3.0, 1));
    }

    /// A pixel whose normal leans by `deg` and whose place lies so deep, so far along u.
    fn leaning(deg: f32, depth: f32, u: f32) -> PixelRecord {
        let (sin, cos) = deg.to_radians().sin_cos();
        PixelRecord {
            material: Some(0),
            normal: Vec3::new(sin, 0.0, cos),
            uv: Some(Vec2::new(u, 0.5)),
            depth,
            ..PixelRecord::NOTHING
        }
    }

    #[test]
    fn records_are_compared_in_degrees_texels_and_amplitudes() {
        let nothing = PixelRecord::NOTHING;
        let records = |first, last| Records {
            size: [3, 1],
            pixels: vec![first, nothing, last],
            yardsticks: vec![UvYardstick {
                texels_per_uv: Vec2::new(64.0, 32.0),
                turns_per_uv: Vec2::ZERO,
            }],
        };
        let (a, b) = (
            records(leaning(0.0, 0.5, 0.25), nothing),
            records(leaning(30.0, 0.75, 0.5), leaning(0.0, 0.0, 0.0)),
        );
        let pixels = [[0; 4]; 3];
        let shown = |records| Shown {
            pixels: &pixels,
            records: Some(records),
        };
        let expected = [
            (ErrorMetric::NormalAngle, 30.0),
            (ErrorMetric::Uv, 16.0),
            (ErrorMetric::Depth, 0.25),
        ];
        for (metric, error) in expected {
            let map = error_map(metric, [shown(&a), shown(&b)], 3, 1);
            assert!((map[0] - error).abs() < 1e-4, "{metric:?}: {map:?}");
            assert!(
                map[1].is_nan() && map[2].is_infinite(),
                "{metric:?}: {map:?}"
            );
            let unknown = Shown {
                records: None,
                ..shown(&a)
            };
            let map = error_map(metric, [shown(&a), unknown], 3, 1);
            assert!(map.iter().all(|e| e.is_nan()), "{metric:?}: {map:?}");
        }
    }

    #[test]
    fn a_turn_of_a_repeating_map_is_no_distance() {
        let repeating = UvYardstick {
            texels_per_uv: Vec2::new(64.0, 32.0),
            turns_per_uv: Vec2::new(2.0, 0.0),
        };
        let apart = |a: [f32; 2], b: [f32; 2]| repeating.texels(a.into(), b.into());
        // Half a unit of u is one picture.
        assert_eq!(apart([1.25, 0.0], [0.25, 0.0]), 0.0);
        assert!((apart([0.49, 0.0], [0.01, 0.0]) - 0.02 * 64.0).abs() < 1e-4);
        assert_eq!(apart([0.0, 1.0], [0.0, 0.0]), 32.0);
    }

    #[test]
    fn equal_pictures_have_no_error_and_opposite_ones_all() {
        let (black, white) = ([[0, 0, 0, 255]; 9], [[255; 4]; 9]);
        for metric in [ErrorMetric::Luma, ErrorMetric::Flip] {
            let shown = |pixels| Shown {
                pixels,
                records: None,
            };
            let same = error_map(metric, [shown(&white), shown(&white)], 3, 1);
            assert_eq!(same, [0.0; 9], "{metric:?}");
            let opposite = error_map(metric, [shown(&black), shown(&white)], 3, 1);
            assert!(
                opposite.iter().all(|&e| e > 0.95 && e <= 1.0),
                "{opposite:?}"
            );
        }
    }
}
