//! Small pictures of every built-in scene and method, compared with kept ones.
//!
//! `UPDATE_SNAPSHOTS=1 cargo test --release golden` rewrites them. A difference leaves an
//! expected/difference/actual strip under `target/golden`.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use reliefscope::measure::read_picture;
use reliefscope::render::{Picture, Progressive, Snapshot};
use reliefscope::scene::load::LoadOptions;
use reliefscope::scene::save_picture::write_png;
use reliefscope::scene::{LoadedScene, built_in, open};
use reliefscope::surface::mapping::Method;

const SIZE: [u32; 2] = [96, 64];

/// Steps of 8 bits that a channel may be off: other processors round powers and roots otherwise.
const CHANNEL_TOLERANCE: u8 = 2;

/// Pixels that may be off by more: where rounding decides which side of an edge a ray passes.
const PIXEL_TOLERANCE: usize = 12;

fn snapshot(loaded: LoadedScene, method: Method) -> Snapshot {
    let mut settings = loaded.settings;
    settings.mapping.method = method;
    settings.samples = 4;
    Snapshot {
        scene: loaded.scene,
        settings: Arc::new(settings),
        size: SIZE,
    }
}

fn bytes(renderer: &Progressive) -> Vec<[u8; 3]> {
    let mut rgba = vec![[0; 4]; (SIZE[0] * SIZE[1]) as usize];
    renderer.encode_into(0.0, &mut rgba);
    rgba.iter().map(|&[r, g, b, _]| [r, g, b]).collect()
}

fn kept_bytes(picture: &Picture) -> Vec<[u8; 3]> {
    picture
        .pixels
        .iter()
        .map(|&c| reliefscope::math::srgb8_from_linear(c))
        .collect()
}

/// Renders, compares with the kept picture of this name and says what differs.
fn check(name: &str, snapshot: Snapshot) -> Result<(), String> {
    let mut renderer = Progressive::new(2).map_err(|e| e.to_string())?;
    renderer.start(snapshot);
    while !renderer.is_converged() {
        renderer.pass(&|| false);
    }
    let actual = bytes(&renderer);
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data/golden")
        .join(format!("{name}.png"));
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        return write_png(&path, SIZE, &actual).map_err(|e| e.to_string());
    }
    let kept =
        read_picture(&path).map_err(|e| format!("{e}: run with UPDATE_SNAPSHOTS=1 to make it"))?;
    let expected = kept_bytes(&kept);
    let off = |(a, b): (&[u8; 3], &[u8; 3])| {
        a.iter()
            .zip(b)
            .any(|(x, y)| x.abs_diff(*y) > CHANNEL_TOLERANCE)
    };
    let count = expected
        .iter()
        .zip(&actual)
        .filter(|&pair| off(pair))
        .count();
    if count <= PIXEL_TOLERANCE {
        return Ok(());
    }
    let strip = write_strip(name, &expected, &actual)?;
    Err(format!(
        "{name}: {count} pixels differ, see {}",
        strip.display()
    ))
}

/// Expected, difference and actual side by side.
fn write_strip(name: &str, expected: &[[u8; 3]], actual: &[[u8; 3]]) -> Result<PathBuf, String> {
    let width = SIZE[0] as usize;
    let mut strip = Vec::with_capacity(expected.len() * 3);
    for (e, a) in expected.chunks(width).zip(actual.chunks(width)) {
        strip.extend_from_slice(e);
        strip.extend(
            e.iter()
                .zip(a)
                .map(|(e, a)| [0, 1, 2].map(|c| e[c].abs_diff(a[c]).saturating_mul(4))),
        );
        strip.extend_from_slice(a);
    }
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("golden");
    std::fs::create_dir_all(&folder).map_err(|e| e.to_string())?;
    let path = folder.join(format!("{name}.png"));
    write_png(&path, [SIZE[0] * 3, SIZE[1]], &strip).map_err(|e| e.to_string())?;
    Ok(path)
}

fn check_all(cases: impl Iterator<Item = (String, Snapshot)>) {
    let failures: Vec<String> = cases
        .filter_map(|(name, snapshot)| check(&name, snapshot).err())
        .collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn every_built_in_scene_looks_as_it_did() {
    check_all(built_in::SCENES.iter().map(|info| {
        let loaded =
            open(Path::new(info.name), &LoadOptions::default()).expect("a built-in scene opens");
        let method = loaded.settings.mapping.method;
        (format!("scene-{}", info.name), snapshot(loaded, method))
    }));
}

#[test]
fn every_method_looks_as_it_did() {
    let loaded = open(Path::new(built_in::default_name()), &LoadOptions::default())
        .expect("the default scene opens");
    check_all(Method::ALL.into_iter().map(|method| {
        (
            format!("method-{}", method.name()),
            snapshot(loaded.clone(), method),
        )
    }));
}
