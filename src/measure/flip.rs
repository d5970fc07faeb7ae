//! ꟻLIP: what somebody sees who flips between two pictures on a screen.
//!
//! Colours are blurred as the eye's contrast sensitivity does, compared in Hunt-adjusted CIELAB by the HyAB
//! distance, and amplified where edges or points come or go. Source: Andersson, Nilsson, Akenine-Möller,
//! Oskarsson, Åström & Fairchild 2020, "FLIP: A Difference Evaluator for Alternating Images" (LDR-FLIP), with
//! the authors' erratum: the largest colour distance is that of Hunt-adjusted green and blue.

use std::f32::consts::PI;

use crate::math::LinearRgb;

/// The paper's viewer: 0.7 m from a screen 0.7 m wide with 3840 columns.
pub const PIXELS_PER_DEGREE: f32 = 67.0;

/// Exponent of the colour distance.
const QC: f32 = 0.7;
/// Exponent of the feature difference.
const QF: f32 = 0.5;
/// Distances below this part of the largest …
const PC: f32 = 0.4;
/// … fill this part of the range.
const PT: f32 = 0.95;
/// Width of the feature detectors, degrees.
const FEATURE_DEGREES: f32 = 0.082;
/// `[a, b]` of each Gaussian of the contrast sensitivity: achromatic, red–green, blue–yellow.
const ACHROMATIC: [[f32; 2]; 1] = [[1.0, 0.0047]];
const RED_GREEN: [[f32; 2]; 1] = [[1.0, 0.0053]];
const BLUE_YELLOW: [[f32; 2]; 2] = [[34.1, 0.04], [13.5, 0.025]];
/// CIE XYZ of linear sRGB's primaries, by rows.
const XYZ: [[f32; 3]; 3] = [
    [0.412_390_8, 0.357_584_34, 0.180_480_8],
    [0.212_639, 0.715_168_7, 0.072_192_32],
    [0.019_330_819, 0.119_194_78, 0.950_532_14],
];
/// Its inverse.
const RGB: [[f32; 3]; 3] = [
    [3.240_97, -1.537_383_2, -0.498_610_76],
    [-0.969_243_65, 1.875_967_5, 0.041_555_06],
    [0.055_630_08, -0.203_976_96, 1.056_971_5],
];
/// XYZ of white.
const WHITE: [f32; 3] = [0.950_455_9, 1.0, 1.089_057_8];

/// ꟻLIP of every pixel of two pictures in rows of `width`, 0 (equal) to 1. Values are clipped to `[0, 1]` first;
/// `pixels_per_degree` says how close the viewer sits, usually [`PIXELS_PER_DEGREE`]. Symmetric in the two.
///
/// Pixels that one picture has and the other has not are left out.
#[must_use]
pub fn flip(a: &[LinearRgb], b: &[LinearRgb], width: usize, pixels_per_degree: f32) -> Vec<f32> {
    let (width, degree) = (width.max(1), pixels_per_degree.max(1.0));
    let (a, b) = (Seen::new(a, width, degree), Seen::new(b, width, degree));
    let largest = largest_distance();
    let pixels = a
        .lab
        .iter()
        .zip(&b.lab)
        .zip(a.features.iter().zip(&b.features));
    pixels
        .map(|((lab_a, lab_b), (features_a, features_b))| {
            let color = redistributed(hyab(lab_a, lab_b).powf(QC), largest);
            let change = |i: usize| (features_a[i] - features_b[i]).abs();
            let feature = (change(0).max(change(1)) * std::f32::consts::FRAC_1_SQRT_2).powf(QF);
            color.powf(1.0 - feature.min(1.0)).clamp(0.0, 1.0)
        })
        .collect()
}

/// A picture as the eye takes it in.
struct Seen {
    /// Blurred, Hunt-adjusted CIELAB.
    lab: Vec<[f32; 3]>,
    /// Strength of edges and of points.
    features: Vec<[f32; 2]>,
}

impl Seen {
    fn new(pixels: &[LinearRgb], width: usize, degree: f32) -> Self {
        let opponent: Vec<_> = pixels.iter().map(|&c| opponent(clipped(c))).collect();
        let [luma, red_green, blue_yellow] =
            [0, 1, 2].map(|i| opponent.iter().map(|c| c[i]).collect::<Vec<_>>());
        let gray: Vec<_> = luma.iter().map(|y| (y + 16.0) / 116.0).collect();
        let planes = [
            contrast_filtered(&luma, width, degree, &ACHROMATIC),
            contrast_filtered(&red_green, width, degree, &RED_GREEN),
            contrast_filtered(&blue_yellow, width, degree, &BLUE_YELLOW),
        ];
        let lab = (0..pixels.len())
            .map(|i| {
                let rgb = from_opponent([planes[0][i], planes[1][i], planes[2][i]]);
                hunt_lab(rgb.map(|c| c.clamp(0.0, 1.0)))
            })
            .collect();
        Self {
            lab,
            features: features(&gray, width, degree),
        }
    }
}

/// Within `[0, 1]`, NaN as 0.
fn clipped(c: LinearRgb) -> [f32; 3] {
    c.to_array().map(|x| if x > 0.0 { x.min(1.0) } else { 0.0 })
}

fn times(matrix: &[[f32; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// XYZ as parts of white's.
fn relative_xyz(rgb: [f32; 3]) -> [f32; 3] {
    let xyz = times(&XYZ, rgb);
    [0, 1, 2].map(|i| xyz[i] / WHITE[i])
}

/// YCxCz, the linear opponent space: CIELAB without its roots.
fn opponent(rgb: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = relative_xyz(rgb);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn from_opponent([luma, cx, cz]: [f32; 3]) -> [f32; 3] {
    let y = (luma + 16.0) / 116.0;
    let relative = [y + cx / 500.0, y, y - cz / 200.0];
    times(&RGB, [0, 1, 2].map(|i| relative[i] * WHITE[i]))
}

/// CIELAB whose colourfulness falls with the lightness.
fn hunt_lab(rgb: [f32; 3]) -> [f32; 3] {
    const DELTA: f32 = 6.0 / 29.0;
    let root = |t: f32| {
        if t > DELTA * DELTA * DELTA {
            t.cbrt()
        } else {
            t / (3.0 * DELTA * DELTA) + 4.0 / 29.0
        }
    };
    let [x, y, z] = relative_xyz(rgb).map(root);
    let lightness = 116.0 * y - 16.0;
    let hunt = 0.01 * lightness;
    [lightness, hunt * 500.0 * (x - y), hunt * 200.0 * (y - z)]
}

fn hyab(p: &[f32; 3], q: &[f32; 3]) -> f32 {
    (p[0] - q[0]).abs() + (p[1] - q[1]).hypot(p[2] - q[2])
}

/// What becomes 1: the distance of green and blue, after the exponent.
fn largest_distance() -> f32 {
    hyab(&hunt_lab([0.0, 1.0, 0.0]), &hunt_lab([0.0, 0.0, 1.0])).powf(QC)
}

/// Spreads the small distances over most of `[0, 1]` and squeezes the large ones into the rest.
fn redistributed(distance: f32, largest: f32) -> f32 {
    let knee = PC * largest;
    if distance < knee {
        PT / knee * distance
    } else {
        PT + (distance - knee) / (largest - knee) * (1.0 - PT)
    }
}

/// Blurs by a channel's contrast sensitivity: a sum of Gaussians, weighted so that flat areas stay.
fn contrast_filtered(plane: &[f32], width: usize, degree: f32, csf: &[[f32; 2]]) -> Vec<f32> {
    // One radius for all channels: three standard deviations of the widest.
    let widest = BLUE_YELLOW[0][1];
    let radius = (3.0 * (widest / (2.0 * PI * PI)).sqrt() * degree).ceil() as i32;
    let kernels: Vec<(f32, Vec<f32>)> = csf
        .iter()
        .map(|&[a, b]| {
            let gauss = |i: i32| (-(PI * i as f32 / degree).powi(2) / b).exp();
            let kernel: Vec<_> = (-radius..=radius).map(gauss).collect();
            let sum: f32 = kernel.iter().sum();
            let weight = a * (PI / b).sqrt() * sum * sum;
            (weight, kernel.iter().map(|k| k / sum).collect())
        })
        .collect();
    let total: f32 = kernels.iter().map(|(weight, _)| weight).sum();
    let mut filtered = vec![0.0; plane.len()];
    for (weight, kernel) in &kernels {
        let blurred = convolved(plane, width, kernel, kernel);
        for (sum, value) in filtered.iter_mut().zip(blurred) {
            *sum += weight / total * value;
        }
    }
    filtered
}

/// Lengths of the Gaussian's first and second derivatives: edges and points.
fn features(gray: &[f32], width: usize, degree: f32) -> Vec<[f32; 2]> {
    let deviation = 0.5 * FEATURE_DEGREES * degree;
    let radius = (3.0 * deviation).ceil() as i32;
    let taps = |f: &dyn Fn(f32, f32) -> f32| -> Vec<f32> {
        let tap = |i: i32| {
            let x = i as f32 / deviation;
            f(x, (-0.5 * x * x).exp())
        };
        let raw: Vec<_> = (-radius..=radius).map(tap).collect();
        // Negative taps sum to −1, positive ones to 1.
        let sum = |sign: f32| raw.iter().map(|k| (k * sign).max(0.0)).sum::<f32>();
        let (above, below) = (sum(1.0), sum(-1.0));
        let unit = |k: &f32| k / if *k < 0.0 { below } else { above };
        raw.iter().map(unit).collect()
    };
    let smooth = taps(&|_, gauss| gauss);
    let edge = taps(&|x, gauss| -x * gauss);
    let point = taps(&|x, gauss| (x * x - 1.0) * gauss);
    let length = |kernel: &[f32]| -> Vec<f32> {
        let across = convolved(gray, width, kernel, &smooth);
        let down = convolved(gray, width, &smooth, kernel);
        across.iter().zip(down).map(|(x, y)| x.hypot(y)).collect()
    };
    let (edges, points) = (length(&edge), length(&point));
    edges.into_iter().zip(points).map(|(e, p)| [e, p]).collect()
}

/// Convolves rows with `across` and columns with `down`; the border's values go on outside.
fn convolved(plane: &[f32], width: usize, across: &[f32], down: &[f32]) -> Vec<f32> {
    let rows = plane.len() / width;
    let reach = across.len() / 2;
    let mut wide = vec![0.0; plane.len()];
    let mut padded = vec![0.0; width + 2 * reach];
    for (row, out) in plane.chunks_exact(width).zip(wide.chunks_exact_mut(width)) {
        padded[..reach].fill(row[0]);
        padded[reach..reach + width].copy_from_slice(row);
        padded[reach + width..].fill(row[width - 1]);
        for (i, k) in across.iter().enumerate() {
            add_scaled(out, *k, &padded[i..i + width]);
        }
    }
    let reach = down.len() / 2;
    let mut tall = vec![0.0; plane.len()];
    for (y, out) in tall.chunks_exact_mut(width).enumerate() {
        for (i, k) in down.iter().enumerate() {
            let from = (y + i).saturating_sub(reach).min(rows - 1);
            add_scaled(out, *k, &wide[from * width..(from + 1) * width]);
        }
    }
    tall
}

fn add_scaled(sums: &mut [f32], factor: f32, values: &[f32]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += factor * value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: usize = 48;

    fn flat(r: f32, g: f32, b: f32) -> Vec<LinearRgb> {
        vec![LinearRgb::new(r, g, b); SIDE * SIDE]
    }

    fn mean(a: &[LinearRgb], b: &[LinearRgb]) -> f32 {
        let values = flip(a, b, SIDE, PIXELS_PER_DEGREE);
        values.iter().sum::<f32>() / values.len() as f32
    }

    #[test]
    fn ends_of_the_scale() {
        let (black, white) = (flat(0.0, 0.0, 0.0), flat(1.0, 1.0, 1.0));
        assert_eq!(mean(&white, &white), 0.0);
        // Green against blue is the largest distance; black against white is a little less.
        let ends = mean(&flat(0.0, 1.0, 0.0), &flat(0.0, 0.0, 1.0));
        assert!((ends - 1.0).abs() < 1e-3, "{ends}");
        let gray = mean(&black, &white);
        assert!((0.95..1.0).contains(&gray), "{gray}");
        assert_eq!(gray, mean(&white, &black));
    }

    #[test]
    fn the_erratum_s_largest_distance() {
        assert!((largest_distance() - 41.276).abs() < 0.01);
    }

    #[test]
    fn matrices_are_inverses_and_flat_pictures_stay() {
        let color = [0.2, 0.5, 0.9];
        let back = from_opponent(opponent(color));
        for i in 0..3 {
            assert!((back[i] - color[i]).abs() < 1e-5, "{back:?}");
        }
        let plane = vec![0.7; SIDE * SIDE];
        for csf in [&ACHROMATIC[..], &BLUE_YELLOW[..]] {
            let filtered = contrast_filtered(&plane, SIDE, 67.0, csf);
            assert!(filtered.iter().all(|v| (v - 0.7).abs() < 1e-5));
        }
    }

    #[test]
    fn a_moved_edge_counts_only_where_it_is() {
        let edge = |at: usize| -> Vec<LinearRgb> {
            let shade = |i: usize| if i % SIDE < at { 0.2 } else { 0.5 };
            (0..SIDE * SIDE)
                .map(|i| LinearRgb::gray(shade(i)))
                .collect()
        };
        let values = flip(&edge(20), &edge(22), SIDE, PIXELS_PER_DEGREE);
        assert!(values[21] > 0.2, "{}", values[21]);
        assert!(values[SIDE - 1] < 1e-3);
    }

    #[test]
    fn broken_numbers_are_black() {
        let broken = vec![LinearRgb::gray(f32::NAN); SIDE * SIDE];
        assert_eq!(mean(&broken, &flat(0.0, 0.0, 0.0)), 0.0);
        assert!(flip(&[], &[], 0, PIXELS_PER_DEGREE).is_empty());
    }
}
