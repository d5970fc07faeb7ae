//! Few levels: counted, told, and smoothed without going beyond what rounding took.

use std::fs;

use reliefscope::render::Picture;
use reliefscope::scene::load::LoadOptions;
use reliefscope::scene::open;
use reliefscope::texture::{
    Channel, HeightMap, Levels, MapImage, MapRole, MapSlot, RawImage, Samples, Wrap, destaired,
};
use tempfile::TempDir;

use crate::support::{QuadScene, bits, edited, picture};

const SIDE: u32 = 128;

/// Gentle hills that repeat, with a wall through them and a floor between.
fn relief(x: u32, y: u32) -> f64 {
    let turn = std::f64::consts::TAU / f64::from(SIDE);
    let (s, t) = (f64::from(x) * turn, f64::from(y) * turn);
    if (40..48).contains(&x) {
        return 0.9;
    }
    if (80..100).contains(&x) {
        return 100.0 / 255.0;
    }
    0.3 + 0.05 * s.sin() + 0.04 * (t + s).cos()
}

fn image(bits: u8) -> RawImage {
    let places = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y)));
    let samples = match bits {
        8 => Samples::U8(
            places
                .map(|(x, y)| (relief(x, y) * 255.0).round() as u8)
                .collect(),
        ),
        16 => Samples::U16(
            places
                .map(|(x, y)| (relief(x, y) * 65_535.0).round() as u16)
                .collect(),
        ),
        _ => Samples::F32(
            places
                .map(|(x, y)| ((relief(x, y) * 255.0).round() / 255.0) as f32)
                .collect(),
        ),
    };
    RawImage {
        width: SIDE,
        height: SIDE,
        channels: 1,
        samples,
    }
}

/// Root mean square errors of heights and of slopes per texel against the relief before rounding, away from
/// the edges of wall and floor.
fn errors(map: &HeightMap) -> [f64; 2] {
    let (mut height, mut slope, mut count) = (0.0, 0.0, 0.0);
    let smooth = |x: u32| x < 38 || (50..78).contains(&x) || (102..SIDE - 1).contains(&x);
    for (x, y) in (0..SIDE)
        .flat_map(|y| (0..SIDE).map(move |x| (x, y)))
        .filter(|p| smooth(p.0))
    {
        let found = |x| f64::from(map.texel(x, y));
        height += (found(x) - relief(x, y)).powi(2);
        slope += (found(x + 1) - found(x) - relief(x + 1, y) + relief(x, y)).powi(2);
        count += 1.0;
    }
    [(height / count).sqrt(), (slope / count).sqrt()]
}

#[test]
fn errors_against_the_relief_before_rounding_fall() {
    for file_bits in [8, 32] {
        let map = HeightMap::from_image(&image(file_bits), Channel::Luma);
        let levels = Levels::of(&map);
        assert!((levels.step - 1.0 / 255.0).abs() < 1e-6, "{levels:?}");
        let smooth = destaired(&map, levels.step, Wrap::Repeat);
        let (before, after) = (errors(&map), errors(&smooth));
        eprintln!(
            "{file_bits} bits: heights {:.2e} → {:.2e}, slopes {:.2e} → {:.2e}",
            before[0], after[0], before[1], after[1]
        );
        assert!(after[0] < 0.7 * before[0], "heights: {before:?}, {after:?}");
        assert!(after[1] < 0.2 * before[1], "slopes: {before:?}, {after:?}");
    }
}

#[test]
fn no_height_leaves_its_level() {
    for file_bits in [8, 32] {
        for wrap in Wrap::ALL {
            let map = HeightMap::from_image(&image(file_bits), Channel::Luma);
            let smooth = destaired(&map, Levels::of(&map).step, wrap);
            assert_ne!(map, smooth);
            for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))) {
                let moved = (smooth.texel(x, y) - map.texel(x, y)).abs();
                assert!(moved <= 0.5 / 255.0 + 1e-7, "{x}, {y}: {moved}");
            }
        }
    }
}

#[test]
fn edges_and_floors_stay_as_they_are() {
    let map = HeightMap::from_image(&image(8), Channel::Luma);
    let smooth = destaired(&map, Levels::of(&map).step, Wrap::Repeat);
    for (x, y) in (0..SIDE).flat_map(|y| (82..98).chain(40..48).map(move |x| (x, y))) {
        assert_eq!(smooth.texel(x, y), map.texel(x, y), "{x}, {y}");
    }
    // A drawing of two heights is no relief with stairs, and nor is a flat map.
    for texels in [vec![0, 65_535, 0, 65_535], vec![7; 4]] {
        let drawing = HeightMap::U16(reliefscope::texture::Grid::new(2, 2, texels));
        assert_eq!(
            destaired(&drawing, Levels::of(&drawing).step, Wrap::Repeat),
            drawing
        );
    }
}

#[test]
fn fine_maps_are_left_alone() {
    let fine = MapImage::new("fine", None, image(16));
    assert!(fine.heights(Channel::Luma).levels().count > Levels::FEW);
    let many = HeightMap::F32(reliefscope::texture::Grid::new(
        5000,
        1,
        (0..5000).map(|i| i as f32 * 0.37).collect(),
    ));
    assert_eq!(destaired(&many, Levels::of(&many).step, Wrap::Clamp), many);
}

#[test]
fn the_smoothed_map_is_made_once_and_only_where_it_is_asked_for() {
    let mut scene = QuadScene::new().with_map(MapRole::Height, image(8));
    scene.settings.materials[0].default_amplitude = 0.2;
    let snapshot = scene.snapshot();
    let plain = picture(&snapshot);
    let bytes = snapshot.scene.images[0].bytes();
    let smooth = edited(&snapshot, |s| s.materials[0].maps[0].destair = true);
    let film: Picture = picture(&smooth);
    assert_ne!(bits(&plain), bits(&film));
    let more = smooth.scene.images[0].bytes() - bytes;
    assert_eq!(more, (SIDE * SIDE * 2) as usize);
    let slot = MapSlot {
        destair: true,
        ..MapSlot::new(0, MapRole::Height)
    };
    let image = &smooth.scene.images[0];
    assert!(std::ptr::eq(
        image.heights_of(&slot),
        image.heights_of(&slot)
    ));
    assert!(std::ptr::eq(
        image.heights_of(&MapSlot::new(0, MapRole::Height)),
        image.heights(Channel::Luma)
    ));
}

/// A scene file that asks for the filter, and a command that tells the levels.
#[test]
fn scene_files_ask_for_it_and_inspect_tells_the_levels() {
    let folder = TempDir::new().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let quad =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";
    fs::write(path("quad.obj"), quad).expect("is written");
    let grey: Vec<[u8; 3]> = (0..64).map(|i| [i / 2; 3]).collect();
    reliefscope::scene::save_picture::write_png(&path("h.png"), [8, 8], &grey).expect("is written");
    let scene = "model = \"quad.obj\"\n[[material]]\nname = \"*\"\nheight_map = \"h.png\"\ndestair = true\n";
    fs::write(path("scene.toml"), scene).expect("is written");
    let loaded = open(&path("scene.toml"), &LoadOptions::default()).expect("opens");
    assert!(loaded.settings.materials[0].maps[0].destair);
    let told = std::process::Command::new(env!("CARGO_BIN_EXE_reliefscope"))
        .arg("inspect")
        .arg(path("scene.toml"))
        .output()
        .expect("runs");
    let told = String::from_utf8_lossy(&told.stdout).into_owned();
    assert!(told.contains("32 levels, de-staired"), "{told}");
}
