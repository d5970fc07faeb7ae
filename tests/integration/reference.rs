//! The reference scene against pictures that another renderer made (see tests/data/reference/README.md).

use std::path::{Path, PathBuf};
use std::sync::Arc;

use reliefscope::measure::{metrics, read_picture};
use reliefscope::render::{PassEnd, Picture, Progressive, Snapshot};
use reliefscope::scene::RenderSettings;
use reliefscope::scene::load::LoadOptions;
use reliefscope::surface::mapping::Method;

fn data(name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    root.join("tests/data/reference").join(name)
}

/// Renders a scene file at its own size until it has all its samples.
fn rendered(scene_file: &str) -> Picture {
    rendered_with(scene_file, |_| {})
}

/// The same after an edit.
fn rendered_with(scene_file: &str, edit: impl FnOnce(&mut RenderSettings)) -> Picture {
    let mut loaded = reliefscope::scene::open(&data(scene_file), &LoadOptions::default())
        .expect("the scene file can be read");
    assert_eq!(loaded.scene.facts.triangles, 1152);
    edit(&mut loaded.settings);
    let mut renderer = Progressive::new(0).expect("the system gives threads");
    renderer.start(Snapshot {
        scene: loaded.scene,
        size: loaded.size.expect("the scene file gives a size"),
        settings: Arc::new(loaded.settings),
    });
    while !renderer.is_converged() {
        assert_eq!(renderer.pass(&|| false), PassEnd::Complete);
    }
    renderer.picture()
}

fn assert_psnr(scene_file: &str, truth: &str, at_least_db: f64) {
    let truth = read_picture(&data(truth)).expect("the reference picture can be read");
    let distance = metrics::distance(&rendered(scene_file), &truth).expect("sizes agree");
    assert!(
        distance.psnr_db >= at_least_db,
        "{scene_file}: {distance:?} is below {at_least_db} dB"
    );
}

/// The distance of one method's picture to a truth, decibels.
#[expect(
    clippy::print_stdout,
    reason = "the figures that docs/methods.md quotes"
)]
fn psnr_of(method: Method, [self_shadow, shadows]: [bool; 2], samples: u32, truth: &str) -> f64 {
    let picture = rendered_with("bump.toml", |s| {
        s.mapping.method = method;
        s.mapping.search.self_shadow = self_shadow;
        s.mapping.search.min_layers = s.mapping.search.layers;
        s.shading.shadows = shadows;
        s.samples = samples;
    });
    let truth = read_picture(&data(truth)).expect("the reference picture can be read");
    let psnr = metrics::distance(&picture, &truth)
        .expect("sizes agree")
        .psnr_db;
    println!(
        "{}: {psnr:.1} dB, self-shadow {self_shadow}, shadows {shadows}",
        method.name()
    );
    psnr
}

/// The table of tests/data/reference/README.md: what textbook methods are worth at 45°, as measured with a
/// march inside another renderer. Its only row with relief shadows marches them too and stays at 42.3 dB;
/// ours are exact.
#[test]
fn every_method_is_as_far_from_the_displaced_plane_as_it_should_be() {
    for (method, expected) in [
        (Method::None, 11.8),
        (Method::Bump, 12.3),
        (Method::Parallax, 14.5),
        (Method::ParallaxLimited, 14.7),
        (Method::Steep, 22.8),
        (Method::Occlusion, 22.4),
        (Method::Relief, 22.4),
        (Method::RelaxedCone, 22.4),
        (Method::Exact, 22.4),
    ] {
        let psnr = psnr_of(method, [false, true], 4, "plane_45_disp.exr");
        assert!((psnr - expected).abs() < 0.5, "{method:?}: {psnr}");
    }
}

#[test]
fn the_exact_relief_is_the_displaced_plane() {
    let lit = psnr_of(Method::Exact, [true, true], 64, "plane_45_disp.exr");
    assert!(lit >= 45.0, "with shadows: {lit}");
    let shadowless = psnr_of(Method::Exact, [false, false], 64, "plane_45_dispns.exr");
    assert!(shadowless >= 53.0, "without: {shadowless}");
}

#[test]
fn true_displacement_is_the_displaced_plane() {
    let lit = psnr_of(Method::Displacement, [true, true], 64, "plane_45_disp.exr");
    assert!(lit >= 45.0, "with shadows: {lit}");
    let truth = "plane_45_dispns.exr";
    let shadowless = psnr_of(Method::Displacement, [true, false], 64, truth);
    assert!(shadowless >= 53.0, "without: {shadowless}");
}

#[test]
fn the_flat_plane_is_the_reference() {
    assert_psnr("flat.toml", "plane_45_flat.exr", 65.0);
}

#[test]
fn bump_mapping_is_the_reference() {
    assert_psnr("bump.toml", "plane_45_bumpown.exr", 55.0);
}

#[test]
fn normal_mapping_is_the_reference() {
    assert_psnr("normal.toml", "plane_45_normalown.exr", 60.0);
}
