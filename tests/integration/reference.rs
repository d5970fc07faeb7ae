//! The reference scene against pictures that another renderer made (see tests/data/reference/README.md).

use std::path::{Path, PathBuf};
use std::sync::Arc;

use reliefscope::measure::{metrics, read_picture};
use reliefscope::render::{PassEnd, Picture, Progressive, Snapshot};
use reliefscope::scene::load::LoadOptions;

fn data(name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    root.join("tests/data/reference").join(name)
}

/// Renders a scene file at its own size until it has all its samples.
fn rendered(scene_file: &str) -> Picture {
    let loaded = reliefscope::scene::open(&data(scene_file), &LoadOptions::default())
        .expect("the scene file can be read");
    assert_eq!(loaded.scene.facts.triangles, 1152);
    let mut renderer = Progressive::new(0).expect("the system gives threads");
    renderer.start(Snapshot {
        scene: loaded.scene,
        size: loaded.size.expect("the scene file gives a size"),
        settings: Arc::new(loaded.settings),
    });
    while !renderer.is_converged() {
        assert_eq!(renderer.pass(&|| false), PassEnd::Complete);
    }
    assert_eq!(renderer.samples(), 64);
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
