//! Two methods in one view: keys, line, choice of the other, errors and what they say.

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, pos2, vec2};
use reliefscope::measure::error_map::ErrorMetric;
use reliefscope::surface::mapping::Method;
use reliefscope::viewer::comparison::Layout;

use super::driver::{Driver, WINDOW};

/// The reference plane without a map beside its true relief.
fn comparing() -> Driver {
    let mut driver = Driver::reference();
    driver.key(Key::Num1);
    driver.key(Key::C);
    driver.wait_until(|app| app.other_image().is_some());
    driver.settle();
    driver
}

/// What a screen reader says of the shown pictures.
fn names(driver: &Driver) -> [bool; 2] {
    ["A · None", "B · Displacement, the truth"].map(|name| driver.has(name))
}

#[test]
fn a_key_begins_and_ends_it() {
    let mut driver = Driver::reference();
    assert!(driver.app().other_image().is_none() && !driver.has("Wipe line"));
    driver = comparing();
    assert_eq!(driver.doc().comparison.method, Method::Displacement);
    assert_eq!(names(&driver), [true; 2]);
    let (a, b) = (driver.app().image(), driver.app().other_image());
    let (a, b) = (a.expect("A"), b.expect("B"));
    assert_eq!(a.size, b.size);
    assert_ne!(a.pixels, b.pixels, "two methods, two pictures");
    driver.key(Key::C);
    driver.wait_until(|app| app.other_image().is_none());
    assert_eq!(names(&driver), [false; 2]);
}

#[test]
fn the_line_is_dragged() {
    let mut driver = comparing();
    let camera = driver.camera();
    let line = pos2(WINDOW.x * 0.5, WINDOW.y * 0.4);
    let by = vec2(-WINDOW.x * 0.25, 0.0);
    driver.drag_from(line, PointerButton::Primary, Modifiers::NONE, by);
    let split = driver.doc().comparison.split;
    assert!((split - 0.25).abs() < 0.01, "{split}");
    assert_eq!(
        driver.camera(),
        camera,
        "the line moves, the camera does not"
    );
    let beside = pos2(WINDOW.x * 0.4, WINDOW.y * 0.4);
    driver.drag_from(beside, PointerButton::Primary, Modifiers::NONE, by);
    assert_ne!(driver.camera(), camera);
    assert_eq!(driver.doc().comparison.split, split);
}

#[test]
fn the_compare_section() {
    let mut driver = comparing();
    driver.section("Compare");
    driver.choose("Other method", "bump");
    assert_eq!(driver.doc().comparison.method, Method::Bump);
    driver.slider("Wipe slider", 0.75);
    assert_eq!(driver.doc().comparison.split, 0.75);
    driver.choose("Layout", "side by side");
    assert_eq!(driver.doc().comparison.layout, Layout::SideBySide);
    driver.settle();
    let size = driver.app().image().expect("A").size;
    assert!(size[0] * 2 * 8 < WINDOW.x as usize, "halves: {size:?}");
    driver.choose("Shown of B", "FLIP");
    assert_eq!(driver.doc().comparison.error, Some(ErrorMetric::Flip));
    driver.number("Full scale", 0.5);
    assert_eq!(driver.doc().comparison.full_scale, 0.5);
    driver.wait_until(|app| {
        app.stats()
            .error
            .is_some_and(|e| e.metric == ErrorMetric::Flip)
    });
    driver.choose("Layout", "hold B");
    driver.check("Compare two methods");
    assert!(!driver.doc().comparison.on);
}

#[test]
fn a_held_key_shows_the_other() {
    let mut driver = comparing();
    driver.section("Compare");
    driver.choose("Layout", "hold B");
    driver.harness.run_steps(2);
    assert_eq!(names(&driver), [true, false]);
    let key = |pressed| Event::Key {
        key: Key::B,
        physical_key: None,
        pressed,
        repeat: false,
        modifiers: Modifiers::NONE,
    };
    driver.harness.event(key(true));
    driver.harness.run_steps(2);
    assert_eq!(names(&driver), [false, true]);
    driver.harness.event(key(false));
    driver.harness.run_steps(2);
    assert_eq!(names(&driver), [true, false]);
}

#[test]
fn errors_have_a_legend_and_two_numbers() {
    let mut driver = Driver::reference();
    driver.key(Key::Num1);
    driver.key(Key::X);
    driver.wait_until(|app| app.stats().error.is_some());
    driver.settle();
    assert!(driver.has("Error: luma difference") && driver.has("Colours from 0 to 0.25"));
    let error = driver.app().stats().error.expect("an error");
    assert!(error.mean > 0.01 && error.p95 > error.mean, "{error:?}");
    assert!(driver.has(&format!("mean {:.4} p95 {:.4}", error.mean, error.p95)));
    // A method has no distance to itself.
    driver.section("Compare");
    driver.choose("Other method", "none");
    driver.settle();
    let error = driver.app().stats().error.expect("an error");
    assert_eq!((error.mean, error.p95), (0.0, 0.0));
    driver.key(Key::X);
    driver.wait_until(|app| app.stats().error.is_none());
    assert!(driver.doc().comparison.on && !driver.has("Error: luma difference"));
}

#[test]
fn both_pictures_follow_the_camera() {
    let mut driver = comparing();
    let before = driver.app().other_image().expect("B").pixels.clone();
    let beside_the_line = pos2(WINDOW.x * 0.25, WINDOW.y * 0.5);
    let way = vec2(60.0, 40.0);
    driver.drag_from(beside_the_line, PointerButton::Middle, Modifiers::NONE, way);
    driver.settle();
    assert_ne!(driver.app().other_image().expect("B").pixels, before);
    assert_eq!(
        driver.node(Role::Splitter, "Wipe line").rect().center().x,
        WINDOW.x * 0.5
    );
}

#[test]
fn errors_of_normals_places_and_depths() {
    let mut driver = comparing();
    driver.section("Compare");
    let metrics = [
        (ErrorMetric::NormalAngle, "Colours from 0 to 45°"),
        (ErrorMetric::Uv, "Colours from 0 to 8 texels"),
        (ErrorMetric::Depth, "Colours from 0 to 0.25"),
    ];
    for (metric, bar) in metrics {
        driver.choose("Shown of B", metric.label());
        driver.wait_until(|app| app.stats().error.is_some_and(|e| e.metric == metric));
        driver.settle();
        assert!(driver.has(&format!("Error: {}", metric.label())) && driver.has(bar));
        let error = driver.app().stats().error.expect("an error");
        assert!(error.mean > 0.01 && error.p95 >= error.mean, "{error:?}");
        let numbers = format!(
            "mean {:.4} p95 {:.4}{}",
            error.mean,
            error.p95,
            metric.unit()
        );
        assert!(driver.has(&numbers), "{numbers}");
    }
    // The exact walk over this flat chart is as good as the truth.
    driver.choose("Shown of B", ErrorMetric::Uv.label());
    driver.key(Key::Equals);
    driver.settle();
    let walked = driver.app().stats().error.expect("an error");
    assert!(walked.mean < 0.05, "{walked:?}");
    driver.number("Full scale", 500.0);
    assert_eq!(driver.doc().comparison.full_scale, 500.0);
}
