//! Distances between two pictures.
//!
//! Linear values are compared as they are; PSNR and SSIM take what a screen would show at exposure 0:
//! clipped to `[0, 1]` and sRGB-encoded, not rounded to bytes.

use crate::math::{LinearRgb, srgb_from_linear};
use crate::render::Picture;

/// How far two pictures of one size are apart. All figures are symmetric in the two.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distance {
    /// Root of the mean squared difference of linear values, over pixels and channels.
    pub linear_rmse: f64,
    /// Largest difference of a linear channel anywhere; infinite if one is not a number.
    pub linear_max: f64,
    /// Peak signal to noise ratio of clipped sRGB, decibels; infinite for equal pictures.
    pub psnr_db: f64,
    /// Structural similarity of the Rec. 709 luma of clipped sRGB, at most 1 (equal).
    pub ssim: f64,
}

/// Two pictures that cannot be compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the pictures differ in size: {}×{} and {}×{}", .0[0], .0[1], .1[0], .1[1])]
pub struct SizeMismatch(pub [u32; 2], pub [u32; 2]);

/// Every distance of two pictures.
///
/// # Errors
/// [`SizeMismatch`].
pub fn distance(a: &Picture, b: &Picture) -> Result<Distance, SizeMismatch> {
    let (size_a, size_b) = ([a.width, a.height], [b.width, b.height]);
    if size_a != size_b || a.pixels.len() != b.pixels.len() {
        return Err(SizeMismatch(size_a, size_b));
    }
    let (shown_a, shown_b) = (shown_planes(a), shown_planes(b));
    let planes = || shown_a.iter().zip(&shown_b);
    let shown_mse = planes().map(|(x, y)| mean_square(x, y)).sum::<f64>() / 3.0;
    let width = (a.width as usize).max(1);
    Ok(Distance {
        linear_rmse: linear_mse(a, b).sqrt(),
        linear_max: linear_max(a, b),
        psnr_db: psnr_db(shown_mse),
        ssim: ssim(&luma(&shown_a), &luma(&shown_b), width),
    })
}

/// `10·log₁₀(1 / mse)` for values of range 1; infinite at 0.
#[must_use]
pub fn psnr_db(mse: f64) -> f64 {
    -10.0 * mse.log10()
}

fn linear_mse(a: &Picture, b: &Picture) -> f64 {
    let square = |x: f32, y: f32| (f64::from(x) - f64::from(y)).powi(2);
    channel_pairs(a, b).map(|(x, y)| square(x, y)).sum::<f64>() / (a.pixels.len() * 3) as f64
}

fn linear_max(a: &Picture, b: &Picture) -> f64 {
    // A NaN must not hide: f64::max would drop it.
    let difference = |(x, y): (f32, f32)| {
        let d = (f64::from(x) - f64::from(y)).abs();
        if d.is_nan() { f64::INFINITY } else { d }
    };
    channel_pairs(a, b).map(difference).fold(0.0, f64::max)
}

fn channel_pairs<'a>(a: &'a Picture, b: &'a Picture) -> impl Iterator<Item = (f32, f32)> + 'a {
    let channels = |p: &LinearRgb| p.to_array();
    let left = a.pixels.iter().flat_map(channels);
    left.zip(b.pixels.iter().flat_map(channels))
}

/// Red, green and blue of what a screen shows, 0…1.
fn shown_planes(picture: &Picture) -> [Vec<f64>; 3] {
    [0, 1, 2].map(|channel| {
        let shown = |p: &LinearRgb| f64::from(srgb_from_linear(p.to_array()[channel]));
        picture.pixels.iter().map(shown).collect()
    })
}

/// Rec. 709 weights on encoded values, as SSIM is usually taken from colour pictures.
fn luma([r, g, b]: &[Vec<f64>; 3]) -> Vec<f64> {
    let weigh = |((r, g), b): ((&f64, &f64), &f64)| 0.2126 * r + 0.7152 * g + 0.0722 * b;
    r.iter().zip(g).zip(b).map(weigh).collect()
}

fn mean_square(a: &[f64], b: &[f64]) -> f64 {
    let squares = a.iter().zip(b).map(|(x, y)| (x - y) * (x - y));
    squares.sum::<f64>() / a.len() as f64
}

/// Half the side of SSIM's window without its middle: 11×11 pixels.
const WINDOW_RADIUS: usize = 5;
/// Standard deviation of SSIM's Gaussian window, pixels.
const WINDOW_SIGMA: f64 = 1.5;
/// `(0.01·L)²` and `(0.03·L)²` for the range L = 1: they keep the ratio quiet where it is dark or flat.
const SSIM_C: [f64; 2] = [0.01 * 0.01, 0.03 * 0.03];

/// Mean structural similarity of two planes with values in `[0, 1]`, in rows of `width`.
///
/// Gaussian window of 11×11 pixels with σ = 1.5. Only windows that lie inside the picture count; across a
/// picture smaller than the window, windows are cut off and weighted anew.
/// Source: Wang, Bovik, Sheikh & Simoncelli 2004, "Image quality assessment", eq. 13.
fn ssim(a: &[f64], b: &[f64], width: usize) -> f64 {
    let product = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).collect::<Vec<_>>();
    let (mean_a, mean_b) = (blurred(a, width), blurred(b, width));
    let (square_a, square_b) = (
        blurred(&product(a, a), width),
        blurred(&product(b, b), width),
    );
    let mixed = blurred(&product(a, b), width);
    let similarity = |i: usize| {
        let (ma, mb) = (mean_a[i], mean_b[i]);
        let (var_a, var_b) = (square_a[i] - ma * ma, square_b[i] - mb * mb);
        let covariance = mixed[i] - ma * mb;
        let [c1, c2] = SSIM_C;
        (2.0 * ma * mb + c1) * (2.0 * covariance + c2)
            / ((ma * ma + mb * mb + c1) * (var_a + var_b + c2))
    };
    let (columns, rows) = (window_centers(width), window_centers(a.len() / width));
    let count = columns.len() * rows.len();
    let row = |y| columns.clone().map(move |x| similarity(y * width + x));
    rows.map(|y| row(y).sum::<f64>()).sum::<f64>() / count as f64
}

/// Where along `n` pixels a whole window fits; everywhere if it fits nowhere.
fn window_centers(n: usize) -> std::ops::Range<usize> {
    if n > 2 * WINDOW_RADIUS {
        WINDOW_RADIUS..n - WINDOW_RADIUS
    } else {
        0..n
    }
}

/// The plane under SSIM's window: across, then down.
fn blurred(plane: &[f64], width: usize) -> Vec<f64> {
    let height = plane.len() / width;
    let row = |y: usize| &plane[y * width..(y + 1) * width];
    let across: Vec<f64> = (0..height)
        .flat_map(|y| (0..width).map(move |x| weighted_mean(x, width, |i| row(y)[i])))
        .collect();
    let down = |y| (0..width).map(move |x| (x, y));
    (0..height)
        .flat_map(down)
        .map(|(x, y)| weighted_mean(y, height, |j| across[j * width + x]))
        .collect()
}

/// Gaussian mean of the values around index `center` of a line of `n`, as far as the line goes.
fn weighted_mean(center: usize, n: usize, value: impl Fn(usize) -> f64) -> f64 {
    let first = center.saturating_sub(WINDOW_RADIUS);
    let last = (center + WINDOW_RADIUS).min(n - 1);
    let (mut sum, mut weights) = (0.0, 0.0);
    for i in first..=last {
        let offset = i.abs_diff(center) as f64 / WINDOW_SIGMA;
        let weight = (-0.5 * offset * offset).exp();
        sum += weight * value(i);
        weights += weight;
    }
    sum / weights
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{hash, linear_from_srgb, unit_interval};

    // Wider than SSIM's window and less high.
    const SIZE: [u32; 2] = [17, 9];

    fn picture(pixel: impl Fn(u32, u32) -> LinearRgb) -> Picture {
        let [w, h] = SIZE;
        let pixel = &pixel;
        let pixels = (0..h).flat_map(|y| (0..w).map(move |x| pixel(x, y)));
        Picture {
            width: w,
            height: h,
            pixels: pixels.collect(),
        }
    }

    fn noise(seed: u32) -> Picture {
        let value = |x, y, c| unit_interval(hash(seed * 65_536 + (x * 64 + y) * 4 + c));
        picture(|x, y| LinearRgb::new(value(x, y, 1), value(x, y, 2), value(x, y, 3)))
    }

    #[test]
    fn equal_pictures_are_not_apart() {
        let d = distance(&noise(1), &noise(1)).unwrap();
        assert_eq!((d.linear_rmse, d.linear_max), (0.0, 0.0));
        assert_eq!(d.psnr_db, f64::INFINITY);
        assert!((d.ssim - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_constant_offset_on_the_screen_has_a_known_psnr() {
        let shown = |s: f32| picture(|_, _| LinearRgb::gray(linear_from_srgb(s)));
        let d = distance(&shown(0.5), &shown(0.6)).unwrap();
        assert!((d.psnr_db - 20.0).abs() < 1e-4, "{}", d.psnr_db);
        let linear = f64::from(linear_from_srgb(0.6) - linear_from_srgb(0.5));
        assert!((d.linear_rmse - linear).abs() < 1e-7);
        // Flat pictures: only the luminance term of SSIM is left.
        let ssim = (2.0 * 0.3 + 1e-4) / (0.25 + 0.36 + 1e-4);
        assert!((d.ssim - ssim).abs() < 1e-5, "{} is not {ssim}", d.ssim);
    }

    #[test]
    fn one_wrong_pixel_counts_by_its_share() {
        let black = picture(|_, _| LinearRgb::BLACK);
        let dot = picture(|x, y| LinearRgb::new(f32::from(u8::from((x, y) == (4, 7))), 0.0, 0.0));
        let d = distance(&black, &dot).unwrap();
        let share = 1.0 / f64::from(SIZE[0] * SIZE[1] * 3);
        assert!((d.linear_rmse - share.sqrt()).abs() < 1e-12);
        // The f32 encoding of white is one rounding below 1.
        assert!((d.psnr_db - psnr_db(share)).abs() < 1e-5);
        assert_eq!(d.linear_max, 1.0);
    }

    #[test]
    fn what_no_screen_shows_counts_only_in_linear_figures() {
        let d = distance(
            &picture(|_, _| LinearRgb::gray(3.0)),
            &picture(|_, _| LinearRgb::gray(5.0)),
        )
        .unwrap();
        assert_eq!((d.linear_rmse, d.psnr_db), (2.0, f64::INFINITY));
    }

    #[test]
    fn a_number_that_is_none_never_passes_for_equal() {
        let nan = picture(|_, _| LinearRgb::gray(f32::NAN));
        let d = distance(&nan, &nan).unwrap();
        assert!(d.linear_rmse.is_nan());
        assert_eq!(d.linear_max, f64::INFINITY);
    }

    #[test]
    fn figures_do_not_depend_on_the_order() {
        let (a, b) = (noise(1), noise(2));
        assert_eq!(distance(&a, &b), distance(&b, &a));
    }

    #[test]
    fn pictures_of_two_sizes_are_refused() {
        let small = Picture::black([1, 1]);
        let error = distance(&noise(1), &small).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the pictures differ in size: 17×9 and 1×1"
        );
    }

    /// SSIM by its definition: one window after the other, two-dimensional weights, centred moments.
    fn naive_ssim(a: &[f64], b: &[f64]) -> f64 {
        let [w, h] = SIZE.map(i64::from);
        let mut total = 0.0;
        let centers = (0..h).flat_map(|y| (5..w - 5).map(move |x| (x, y)));
        for (cx, cy) in centers.clone() {
            let window: Vec<(f64, f64, f64)> = (0..h)
                .flat_map(|y| (0..w).map(move |x| (x, y)))
                .filter(|(x, y)| (x - cx).abs() <= 5 && (y - cy).abs() <= 5)
                .map(|(x, y)| {
                    let r2 = ((x - cx).pow(2) + (y - cy).pow(2)) as f64;
                    let i = (y * w + x) as usize;
                    ((-r2 / 4.5).exp(), a[i], b[i])
                })
                .collect();
            let weight: f64 = window.iter().map(|p| p.0).sum();
            let mean = |f: &dyn Fn(f64, f64) -> f64| {
                window.iter().map(|&(k, x, y)| k * f(x, y)).sum::<f64>() / weight
            };
            let (ma, mb) = (mean(&|x, _| x), mean(&|_, y| y));
            let var_a = mean(&|x, _| (x - ma).powi(2));
            let var_b = mean(&|_, y| (y - mb).powi(2));
            let cov = mean(&|x, y| (x - ma) * (y - mb));
            let luminance = (2.0 * ma * mb + 1e-4) / (ma * ma + mb * mb + 1e-4);
            total += luminance * (2.0 * cov + 9e-4) / (var_a + var_b + 9e-4);
        }
        total / centers.count() as f64
    }

    #[test]
    fn ssim_equals_its_definition() {
        let (a, b) = (noise(7), noise(8));
        let luma_of = |p: &Picture| luma(&shown_planes(p));
        let naive = naive_ssim(&luma_of(&a), &luma_of(&b));
        let d = distance(&a, &b).unwrap();
        assert!((d.ssim - naive).abs() < 1e-12);
        assert!(d.ssim < 0.5, "noise is not alike");
    }
}
