//! Views in place of the picture, and overlays over it.

use egui::{Key, Modifiers, PointerButton, vec2};
use reliefscope::render::{MARK, NO_VALUE};
use reliefscope::scene::{View, ViewKind};

use reliefscope::viewer::status::grouped;

use super::driver::{Driver, reference};

fn colors(driver: &Driver) -> Vec<[u8; 3]> {
    let image = driver.app().image().expect("a picture");
    let pixels = image.pixels.iter();
    pixels.map(|c| [c.r(), c.g(), c.b()]).collect()
}

#[test]
fn a_key_goes_through_all_views() {
    let mut driver = Driver::open(reference("torus.toml"));
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
                assert!(
                    driver.has(&format!("{count} {}", view.name())),
                    "{label}"
                );
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
    driver.wait_until(|app| app.stats().legend.is_none());
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
