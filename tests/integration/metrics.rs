//! Distances of the reference pictures from one another, as other programs measured them.

use std::path::Path;

use nv_flip::FlipImageRgb8;
use reliefscope::math::LinearRgb;
use reliefscope::measure::flip::{PIXELS_PER_DEGREE, flip};
use reliefscope::measure::{metrics, read_picture};
use reliefscope::render::Picture;

fn reference(name: &str) -> Picture {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/reference");
    read_picture(&root.join(name)).expect("the reference picture can be read")
}

/// Linear RMSE, PSNR and SSIM to the displaced mesh, from tests/data/reference/README.md.
#[test]
fn published_distances_to_the_displaced_plane_are_met() {
    let truth = reference("plane_45_disp.exr");
    let published = [
        ("plane_45_flat.exr", 0.1410, 11.8, 0.454),
        ("plane_45_bumpown.exr", 0.1280, 12.3, 0.499),
    ];
    for (name, rmse, psnr, ssim) in published {
        let d = metrics::distance(&reference(name), &truth).expect("sizes agree");
        assert!((d.linear_rmse - rmse).abs() < 1e-4, "{name}: {d:?}");
        assert!((d.psnr_db - psnr).abs() < 0.06, "{name}: {d:?}");
        assert!((d.ssim - ssim).abs() < 6e-4, "{name}: {d:?}");
    }
}

#[test]
fn a_missing_picture_is_an_error_that_names_it() {
    let error = read_picture(Path::new("no/such/picture.exr")).unwrap_err();
    assert!(error.to_string().contains("picture.exr"), "{error}");
}

/// Measured by another program of ours on the same two files.
#[test]
fn flip_of_the_flat_plane_is_as_published() {
    let [flat, truth] = ["plane_45_flat.exr", "plane_45_disp.exr"].map(reference);
    let width = flat.width as usize;
    let values = flip(&flat.pixels, &truth.pixels, width, PIXELS_PER_DEGREE);
    let mean = values.iter().sum::<f32>() / values.len() as f32;
    assert!((mean - 0.353).abs() < 0.01, "{mean}");
}

/// Pictures made of whole numbers, the same in any language: `kind`, `moved` texels to the left.
fn generated(kind: &str, moved: u32) -> Picture {
    const SIZE: [u32; 2] = [96, 64];
    let value = |x: u32, y: u32, c: u32| -> u32 {
        let u = u64::from(x + moved);
        let (wide_y, wide_c) = (u64::from(y), u64::from(c));
        match kind {
            "slopes" => (2 * (x + moved) + y * (c + 1)) % 256,
            "noise" => {
                (((u * 7919 + wide_y * 104_729 + wide_c * 1_299_709).pow(2) >> 7) % 256) as u32
            }
            "stripes" if ((x + moved) / 5 + y / 9) % 2 == 1 => [230, 40, 90][c as usize],
            "stripes" => [20, 160, 200][c as usize],
            "dots" if (x + moved) % 11 == 3 && y % 7 == 2 => 255,
            _ => 30 + 20 * c,
        }
    };
    let pixels = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y)));
    let color = |(x, y)| {
        let [r, g, b] = [0, 1, 2].map(|c| (f64::from(value(x, y, c)) / 255.0) as f32);
        LinearRgb::new(r, g, b)
    };
    Picture {
        width: SIZE[0],
        height: SIZE[1],
        pixels: pixels.map(color).collect(),
    }
}

/// SSIM by scikit-image 0.26.0, FLIP by NVIDIA's flip-evaluator 1.7, on the pictures of [`generated`] (made with numpy
/// by the same formulas) moved by 0 and by 2:
///
/// ```python
/// luma = lambda p: srgb(p) @ numpy.array([0.2126, 0.7152, 0.0722])  # sRGB's curve, in doubles
/// skimage.metrics.structural_similarity(luma(a), luma(b), data_range=1.0,
///     gaussian_weights=True, sigma=1.5, use_sample_covariance=False)
/// flip_evaluator.evaluate(a, b, "LDR", inputsRGB=False, applyMagma=False,
///     computeMeanError=True, parameters={"ppd": ppd})  # mean, maximum, and the value at column 30 of row 20
/// ```
///
/// For SSIM no crate does: `image-compare` and `dssim` weigh otherwise than Wang et al.
#[test]
fn ssim_and_flip_are_those_of_the_usual_programs() {
    type Flips = [(f32, [f64; 3]); 2];
    let known: [(&str, f64, Flips); 4] = [
        (
            "slopes",
            0.911_204_768,
            [
                (67.0, [0.138_274_714, 0.963_893_652, 0.065_076_925]),
                (24.0, [0.121_471_561, 0.989_547_372, 0.065_088_205]),
            ],
        ),
        (
            "noise",
            -0.001_082_354,
            [
                (67.0, [0.308_620_065, 0.963_835_895, 0.318_382_829]),
                (24.0, [0.707_101_047, 0.982_268_870, 0.957_281_590]),
            ],
        ),
        (
            "stripes",
            0.237_092_786,
            [
                (67.0, [0.497_587_711, 0.870_522_320, 0.586_650_312]),
                (24.0, [0.504_184_067, 0.969_215_393, 0.331_169_516]),
            ],
        ),
        (
            "dots",
            0.291_301_374,
            [
                (67.0, [0.073_256_813, 0.352_967_590, 0.004_120_805]),
                (24.0, [0.058_909_167, 0.941_115_857, 0.000_020_577]),
            ],
        ),
    ];
    for (kind, ssim, flips) in known {
        let (a, b) = (generated(kind, 0), generated(kind, 2));
        let d = metrics::distance(&a, &b).expect("sizes agree");
        assert!((d.ssim - ssim).abs() < 2e-5, "{kind}: SSIM {}", d.ssim);
        for (ppd, [mean, most, one]) in flips {
            let values = flip(&a.pixels, &b.pixels, a.width as usize, ppd);
            let sum: f64 = values.iter().map(|&v| f64::from(v)).sum();
            let ours = [
                sum / values.len() as f64,
                f64::from(values.iter().copied().fold(0.0, f32::max)),
                f64::from(values[20 * 96 + 30]),
            ];
            for (ours, theirs) in ours.into_iter().zip([mean, most, one]) {
                assert!(
                    (ours - theirs).abs() < 1e-3,
                    "{kind}, {ppd}: FLIP {ours}, not {theirs}"
                );
            }
        }
    }
}

/// The authors' own code beside ours, on the same bytes.
#[test]
fn every_pixel_of_flip_is_that_of_its_authors() {
    let linear = |byte: u8| {
        let c = f64::from(byte) / 255.0;
        let linear = if c <= 0.04045 {
            c / 12.92
        } else {
            ((c + 0.055) / 1.055).powf(2.4)
        };
        linear as f32
    };
    for kind in ["slopes", "noise", "stripes", "dots"] {
        let [a, b] = [0, 2].map(|moved| generated(kind, moved));
        let [w, h] = [a.width, a.height];
        // Whatever the bytes mean: both are given the same.
        let bytes = |picture: &Picture| -> Vec<u8> {
            let channels = picture.pixels.iter().flat_map(|p| p.to_array());
            channels.map(|c| (c * 255.0).round() as u8).collect()
        };
        let (a, b) = (bytes(&a), bytes(&b));
        let pixels = |bytes: &[u8]| -> Vec<LinearRgb> {
            let pixels = bytes.chunks_exact(3);
            pixels
                .map(|p| LinearRgb::new(linear(p[0]), linear(p[1]), linear(p[2])))
                .collect()
        };
        for ppd in [PIXELS_PER_DEGREE, 24.0] {
            let ours = flip(&pixels(&a), &pixels(&b), w as usize, ppd);
            let image = |bytes: &[u8]| FlipImageRgb8::with_data(w, h, bytes);
            let theirs = nv_flip::flip(image(&a), image(&b), ppd).to_vec();
            let off = |(a, b): (&f32, &f32)| (a - b).abs();
            let off = ours.iter().zip(&theirs).map(off).fold(0.0, f32::max);
            eprintln!("{kind}, {ppd} pixels a degree: {off}");
            assert!(off < 1e-4, "{kind}, {ppd}: {off}");
        }
    }
}
