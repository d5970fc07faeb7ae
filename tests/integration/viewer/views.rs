//! Views in place of the picture, and overlays over it.

use egui::{Key, Modifiers, PointerButton, vec2};
use reliefscope::geometry::{Kernel, OffsetRule};
use reliefscope::render::{MARK, NO_VALUE};
use reliefscope::scene::{SceneSource, View, ViewKind};
use reliefscope::shading::LightKind;

use reliefscope::viewer::status::grouped;

use super::driver::{Driver, reference};
use super::files::type_path;

fn colors(driver: &Driver) -> Vec<[u8; 3]> {
    let image = driver.app().image().expect("a picture");
    let pixels = image.pixels.iter();
    pixels.map(|c| [c.r(), c.g(), c.b()]).collect()
}

#[test]
fn a_key_goes_through_all_views() {
    let mut driver = Driver::open(reference("torus.toml"));
    driver.wait_until(|app| app.stats().samples == 1);
    let picture = colors(&driver);
    for view in View::ALL.into_iter().skip(1) {
        driver.key(Key::V);
        driver.settle();
        assert_eq!(driver.doc().display.view, view);
        driver.wait_until(|app| app.stats().legend.is_some_and(|l| l.view == view));
        let label = format!("View {}: {}", view.name(), view.meaning());
        assert!(driver.has(&label), "{label}");
        match view.kind() {
            ViewKind::Marks => {
                let legend = driver.app().stats().legend.expect("a legend");
                let marks = colors(&driver).iter().filter(|c| **c == MARK).count();
                assert_eq!(legend.marked, marks as u64, "{label}");
                let count = grouped(marks as u64);
                assert!(driver.has(&format!("{count} {}", view.name())), "{label}");
            }
            _ => {
                assert_ne!(colors(&driver), picture, "{label}");
                assert!(driver.has(&format!("view {}", view.name())), "{label}");
            }
        }
    }
    driver.keys(Modifiers::SHIFT, Key::V);
    driver.key(Key::V);
    driver.key(Key::V);
    driver.settle();
    assert_eq!(driver.doc().display.view, View::Picture);
    driver.wait_until(|app| app.stats().legend.is_none() && app.stats().samples == 1);
    assert_eq!(colors(&driver), picture);
}

#[test]
fn a_list_chooses_and_undo_takes_back() {
    let mut driver = Driver::reference();
    driver.key(Key::Num0);
    driver.section("Display");
    driver.choose("View", "steps");
    driver.settle();
    let legend = driver.app().stats().legend.expect("a legend");
    assert_eq!((legend.view, legend.range[0]), (View::Steps, 0.0));
    assert!(legend.range[1] >= 2.0, "a search takes steps");
    // What has only just appeared is measured before it is drawn.
    driver.wait_until(|app| app.stats().samples == 1);
    driver.harness.run_steps(3);
    let legend = driver.app().stats().legend.expect("a legend");
    assert!(driver.has(&format!("Colours from 0 to {}", legend.range[1])));
    // Only what the method finds changes.
    driver.key(Key::Num2);
    driver.settle();
    let legend = driver.app().stats().legend.expect("a legend");
    assert_eq!(legend.range, [0.0, 1.0], "bump does not search");
    for _ in 0..40 {
        driver.harness.step();
    }
    driver.keys(Modifiers::COMMAND, Key::Z);
    driver.settle();
    driver.choose("View", "picture");
    driver.settle();
    assert_eq!(driver.app().stats().legend, None);
}

#[test]
fn views_follow_the_camera() {
    let mut driver = Driver::reference();
    driver.section("Display");
    driver.choose("View", "normals");
    driver.settle();
    let before = colors(&driver);
    driver.drag(PointerButton::Primary, Modifiers::NONE, vec2(60.0, 40.0));
    driver.settle();
    let after = colors(&driver);
    assert!(driver.app().stats().legend.is_some());
    assert_ne!(before, after);
    assert!(after.iter().any(|c| *c != NO_VALUE));
}

#[test]
fn both_sides_of_a_comparison_show_the_view() {
    let mut driver = Driver::reference();
    driver.key(Key::Num1);
    driver.key(Key::C);
    driver.wait_until(|app| app.other_image().is_some());
    driver.section("Display");
    driver.choose("View", "depth");
    driver.wait_until(|app| app.stats().legend.is_some_and(|l| l.view == View::Depth));
    driver.settle();
    let legend = driver.app().stats().legend.expect("a legend");
    assert_eq!(legend.range, [0.0, 1.0]);
    let other = &driver.app().other_image().expect("B").pixels;
    assert_ne!(&driver.app().image().expect("A").pixels, other);
}

#[test]
fn the_extremes_section() {
    let mut driver = Driver::open("extremes");
    let (extent, distance) = (driver.doc().extent(), driver.camera().distance());
    driver.section("Method");
    driver.section("Extremes");
    driver.slider("View angle", 80.0);
    driver.slider("Amplitude 10^", -1.0);
    let to_eye = driver.camera().eye - driver.camera().target;
    let angle = (to_eye.z / to_eye.length()).acos().to_degrees();
    assert!((angle - 80.0).abs() < 0.1, "{angle}");
    let amplitude = driver.settings().mapping.amplitude.expect("an amplitude");
    driver.choose("Kernel", "report");
    driver.choose("Overlay", "leaks");
    assert_eq!(driver.doc().display.kernel, Kernel::Report);
    driver.slider("Scale 10^", -12.0);
    let is_placed = |source: &SceneSource| *source == SceneSource::BuiltIn("extremes@1e-12".into());
    driver.wait_until(|app| {
        app.document()
            .is_some_and(|doc| is_placed(&doc.scene.source))
    });
    let ratio = driver.doc().extent() / extent;
    assert!((ratio * 1e12 - 1.0).abs() < 1e-6, "{ratio}");
    let moved = driver.camera().distance() / distance;
    assert!(
        (moved * 1e12 - 1.0).abs() < 1e-6,
        "the camera goes along: {moved}"
    );
    let small = driver.settings().mapping.amplitude.expect("kept");
    assert!((small * 1e12 / amplitude - 1.0).abs() < 1e-6);
    assert_eq!(driver.doc().display.view, View::Leaks);
    driver.check("Centred and scaled before tracing");
    driver.wait_until(|app| {
        let legend = app.stats().legend;
        !app.is_loading() && legend.is_some_and(|l| l.view == View::Leaks && l.marked > 500)
    });
    driver.choose("Kernel", "watertight");
    driver.settle();
    driver.wait_until(|app| app.stats().legend.is_some_and(|l| l.marked == 0));
    driver.choose("Offset rule", "fixed");
    driver.choose("Overlay", "false-shadows");
    assert_eq!(driver.doc().display.offset_rule, OffsetRule::Fixed);
    driver.slider("Radii away 10^", 4.0);
    let is_far =
        |source: &SceneSource| *source == SceneSource::BuiltIn("extremes@1e-12,1e4".into());
    driver.wait_until(|app| app.document().is_some_and(|doc| is_far(&doc.scene.source)));
    driver.settle();
}

/// What was edited goes along with a scene that is put elsewhere, and the picture stays.
#[test]
fn edits_survive_a_move() {
    let mut driver = Driver::open("extremes");
    driver.section("Lights");
    driver.section("Materials");
    driver.button("Point");
    driver.settle();
    let lights = driver.settings().lights.clone();
    let lamp = lights
        .iter()
        .position(|l| matches!(l.kind, LightKind::Point { .. }));
    let lamp = lamp.expect("a lamp");
    driver.number("Shininess", 7.0);
    driver.section("Method");
    driver.section("Extremes");
    driver.wait_until(|app| app.stats().samples == 1);
    let before = driver.app().image().expect("a picture").pixels.clone();
    let edited = driver.settings().clone();
    assert_eq!(edited.materials[0].shininess, 7.0);

    driver.slider("Scale 10^", 6.0);
    let is_there = |source: &SceneSource| *source == SceneSource::BuiltIn("extremes@1e6".into());
    driver.wait_until(|app| {
        app.document()
            .is_some_and(|doc| is_there(&doc.scene.source))
    });
    driver.settle();
    driver.wait_until(|app| app.stats().samples == 1);
    let moved = driver.settings();
    assert_eq!(moved.lights.len(), edited.lights.len());
    assert_eq!(moved.materials[0].shininess, 7.0);
    let (old, new) = (&edited.lights[lamp], &moved.lights[lamp]);
    assert_eq!(old.color, new.color);
    assert!((f64::from(new.intensity) / f64::from(old.intensity) * 1e-12 - 1.0).abs() < 1e-6);
    let after = &driver.app().image().expect("a picture").pixels;
    let off = |(a, b): (&egui::Color32, &egui::Color32)| {
        let pairs = a.to_array().into_iter().zip(b.to_array());
        pairs.map(|(a, b)| a.abs_diff(b)).max().unwrap_or(0) > 2
    };
    let differing = before.iter().zip(after).filter(|&pair| off(pair)).count();
    assert!(
        differing * 200 < before.len(),
        "{differing} of {}",
        before.len()
    );
}

/// A picture that was added in the window goes along, too, and is still shown.
#[test]
fn added_maps_survive_a_move() {
    let mut driver = Driver::open("extremes");
    driver.section("Materials");
    let images = driver.doc().scene.images.len();
    let maps = driver.settings().materials[0].maps.len();
    type_path(&mut driver, "Picture path", &reference("normal.png"));
    driver.button("Add picture");
    driver.wait_until(|app| {
        app.document()
            .is_some_and(|doc| doc.settings.materials[0].maps.len() == maps + 1)
    });
    let added = driver.settings().materials[0].maps[maps].clone();
    assert_eq!(added.image, images);
    driver.section("Method");
    driver.section("Extremes");
    for (slider, value, name) in [
        ("Scale 10^", 3.0, "extremes@1e3"),
        ("Radii away 10^", 2.0, "extremes@1e3,1e2"),
    ] {
        driver.slider(slider, value);
        let is_there = |source: &SceneSource| *source == SceneSource::BuiltIn(name.into());
        driver.wait_until(|app| {
            app.document()
                .is_some_and(|doc| is_there(&doc.scene.source))
        });
        driver.settle();
        let doc = driver.doc();
        assert_eq!(doc.scene.images.len(), images + 1, "{name}");
        let path = doc.scene.images[images].path.as_deref();
        assert_eq!(path, Some(reference("normal.png").as_path()), "{name}");
        let slot = &doc.settings.materials[0].maps[maps];
        assert_eq!((slot.image, slot.role), (added.image, added.role), "{name}");
        // What is a length goes along.
        let [before, after] = [&added, slot].map(|slot| slot.baked_amplitude.expect("known"));
        assert!((after / before * 1e-3 - 1.0).abs() < 1e-6, "{name}");
    }
}
