//! Distances of the reference pictures from one another, as other programs measured them.

use std::path::Path;

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
