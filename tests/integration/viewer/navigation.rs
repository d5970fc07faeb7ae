//! Mouse and keys in the picture.

use egui::accesskit::Role;
use egui::{Key, Modifiers, PointerButton, Pos2, Rect, pos2, vec2};
use egui_kittest::kittest::Queryable;
use reliefscope::shading::LightKind;
use reliefscope::surface::mapping::Method;
use reliefscope::viewer::status::Progress;

use super::driver::{Driver, WINDOW};

#[test]
fn left_drag_orbits_around_the_pivot() {
    let mut driver = Driver::reference();
    let before = driver.camera();
    driver.drag(PointerButton::Primary, Modifiers::NONE, vec2(120.0, 60.0));
    let after = driver.camera();
    assert_ne!(after.eye, before.eye);
    assert_eq!(after.target, before.target);
    assert!((after.distance() - before.distance()).abs() < 1e-9);
    // The model follows the hand: dragged to the right, the eye goes left of where it was.
    let moved = (after.eye - before.eye).dot(before.axes().right);
    assert!(moved < 0.0, "{moved}");
    driver.settle();
}

#[test]
fn shift_or_middle_drag_pans() {
    let drags = [
        (PointerButton::Primary, Modifiers::SHIFT),
        (PointerButton::Middle, Modifiers::NONE),
    ];
    for (button, modifiers) in drags {
        let mut driver = Driver::reference();
        let before = driver.camera();
        driver.drag(button, modifiers, vec2(100.0, 40.0));
        let after = driver.camera();
        let shift = after.target - before.target;
        assert!(shift.length() > 1e-3, "{button:?}");
        assert!((after.eye - before.eye - shift).length() < 1e-9);
        // What was under the pointer goes with it.
        assert!(shift.dot(before.axes().right) < 0.0);
        assert!(shift.dot(before.axes().up) > 0.0);
    }
}

#[test]
fn the_wheel_zooms_to_the_cursor() {
    let mut driver = Driver::reference();
    let before = driver.camera();
    driver.wheel(driver.free_place(), 3.0);
    let centred = driver.camera();
    assert!(centred.distance() < before.distance() * 0.7);
    // In the middle of the picture the view stays where it was.
    assert!((centred.target - before.target).length() < 0.02);
    driver.wheel(driver.free_place() + vec2(-150.0, 0.0), 3.0);
    let aside = driver.camera();
    let shift = (aside.target - centred.target).dot(centred.axes().right);
    assert!(shift < 0.0, "towards the cursor, on the left: {shift}");
    driver.wheel(driver.free_place(), -2.0);
    assert!(driver.camera().distance() > aside.distance());
}

#[test]
fn f_frames_the_model() {
    let mut driver = Driver::reference();
    driver.wheel(driver.free_place() + vec2(-100.0, 0.0), 12.0);
    assert!(driver.camera().distance() < 3.0);
    driver.key(Key::F);
    let camera = driver.camera();
    let [min, max] = driver.doc().bounds();
    assert!((camera.target - (min + max) * 0.5).length() < 1e-9);
    assert!(camera.distance() > (max - min).length());
}

#[test]
fn double_click_sets_the_pivot_on_the_model() {
    let mut driver = Driver::reference();
    let before = driver.camera();
    driver.click_at(driver.free_place() + vec2(-180.0, 0.0), 2, Modifiers::NONE);
    let after = driver.camera();
    assert!(after.target.x < -0.05, "{:?}", after.target);
    // The reference model is the plane z = 0.
    assert!(after.target.z.abs() < 1e-4, "{:?}", after.target);
    let (a, b) = (before.axes().forward, after.axes().forward);
    assert!((a - b).length() < 1e-9, "the view does not turn");
}

#[test]
fn h_hides_and_shows_the_panel() {
    let mut driver = Driver::reference();
    driver.section("Lights");
    driver.button("Point");
    assert!(driver.has("Amplitude slider") && driver.has("Marker of point"));
    driver.key(Key::H);
    assert!(!driver.app().panel_shown());
    assert!(!driver.has("Amplitude slider") && !driver.has("Marker of point"));
    driver.key(Key::H);
    assert!(driver.app().panel_shown());
}

#[test]
fn number_keys_select_every_method() {
    let mut driver = Driver::reference();
    for method in Method::ALL.into_iter().rev() {
        let name = method.info().key.to_string();
        driver.key(Key::from_name(&name).expect("a key"));
        assert_eq!(driver.settings().mapping.method, method);
        driver.settle();
    }
}

#[test]
fn a_method_changes_the_picture() {
    let mut driver = Driver::reference();
    driver.key(Key::P);
    let converged =
        |app: &reliefscope::viewer::ViewerApp| matches!(app.progress(), Progress::Converged(_));
    driver.wait_until(converged);
    let bump = driver.app().image().expect("a picture").pixels.clone();
    driver.key(Key::Num1);
    driver.wait_until(converged);
    let none = driver.app().image().expect("a picture").pixels.clone();
    assert_ne!(bump, none);
    driver.key(Key::Num2);
    driver.wait_until(converged);
    let again = driver.app().image().expect("a picture").pixels.clone();
    assert!(bump == again, "the same settings give the same bytes");
}

#[test]
fn e_changes_exposure_without_touching_settings() {
    let mut driver = Driver::reference();
    let before = driver.settings().clone();
    driver.key(Key::E);
    driver.key(Key::E);
    driver.keys(Modifiers::SHIFT, Key::E);
    let stops = driver.doc().display.exposure_ev;
    assert!((stops - 1.0 / 3.0).abs() < 1e-6, "{stops}");
    assert_eq!(*driver.settings(), before);
    driver.settle();
}

#[test]
fn p_i_and_f1_switch() {
    let mut driver = Driver::reference();
    assert!(driver.app().state().paused, "the driver pauses");
    driver.key(Key::P);
    assert!(!driver.app().state().paused);
    driver.key(Key::I);
    assert!(driver.app().state().probe);
    driver.key(Key::F1);
    assert!(driver.app().state().help && driver.has("Zoom to the cursor"));
    driver.key(Key::Questionmark);
    assert!(!driver.app().state().help);
}

#[test]
fn the_help_fits_the_window() {
    let mut driver = Driver::reference();
    for size in [vec2(480.0, 320.0), vec2(1280.0, 720.0)] {
        driver.harness.set_size(size);
        driver.key(Key::F1);
        driver.harness.run_steps(4);
        let window = Rect::from_min_size(Pos2::ZERO, size);
        let title = driver.node(Role::Window, "Keys and mouse").rect();
        assert!(window.contains_rect(title), "{title:?} in {size:?}");
        if size.x > 1000.0 {
            for label in ["Mouse", "Orbit", "Keys and mouse", "Displacement"] {
                let row = driver.node(Role::Label, label).rect();
                assert!(title.contains_rect(row), "{label}: {row:?} in {title:?}");
            }
        }
        driver.key(Key::F1);
    }
}

#[test]
fn alt_click_tells_the_story_of_the_pixel() {
    let mut driver = Driver::reference();
    let place = driver.free_place();
    driver.click_at(place, 1, Modifiers::ALT);
    let [x, y] = [WINDOW.x, WINDOW.y].map(|n| (n * 0.125 * 0.5) as u32);
    let story = driver.app().state().story.clone().expect("a story");
    let text = &story.text;
    let told = text.contains(&x.to_string()) && text.contains(&y.to_string());
    assert!(told && text.contains("bump"), "{text}");
    let cut = story.cut.as_ref().expect("the plane has a relief");
    assert_eq!(cut.method, "bump");
    driver.harness.get_by_label("Cut through the relief");
    let before = driver.camera();
    driver.key(Key::I);
    driver.click_at(pos2(place.x, place.y + 200.0), 1, Modifiers::NONE);
    assert_ne!(driver.app().state().story.as_ref(), Some(&story));
    assert_eq!(driver.camera(), before);
}

#[test]
fn undo_and_redo_leave_the_camera_alone() {
    let mut driver = Driver::reference();
    driver.key(Key::Num1);
    driver.drag(PointerButton::Primary, Modifiers::NONE, vec2(80.0, 0.0));
    let camera = driver.camera();
    driver.keys(Modifiers::COMMAND, Key::Z);
    assert_eq!(driver.settings().mapping.method, Method::Bump);
    assert_eq!(driver.camera(), camera);
    driver.keys(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    assert_eq!(driver.settings().mapping.method, Method::None);
}

#[test]
fn a_point_light_is_dragged_across_and_along_the_view() {
    let mut driver = Driver::reference();
    driver.section("Lights");
    driver.button("Point");
    let position = |driver: &Driver| match driver.settings().lights.last().map(|l| l.kind) {
        Some(LightKind::Point { position, .. }) => position,
        other => panic!("{other:?}"),
    };
    let (camera, start) = (driver.camera(), position(&driver));
    let from = driver
        .harness
        .get_by_label("Marker of point")
        .rect()
        .center();
    driver.drag_from(
        from,
        PointerButton::Primary,
        Modifiers::NONE,
        vec2(60.0, 30.0),
    );
    assert_eq!(driver.camera(), camera, "the light moves, not the camera");
    let across = position(&driver) - start;
    let axes = camera.axes();
    assert!(across.dot(axes.right) > 0.0 && across.dot(axes.up) < 0.0);
    assert!(across.dot(axes.forward).abs() < 1e-6 * across.length());
    let (start, from) = (position(&driver), from + vec2(60.0, 30.0));
    driver.drag_from(
        from,
        PointerButton::Primary,
        Modifiers::SHIFT,
        vec2(0.0, 40.0),
    );
    let along = position(&driver) - start;
    assert!(along.dot(axes.forward) < 0.0, "pulled down it comes nearer");
    assert_eq!(driver.camera(), camera);
}

#[test]
fn a_directional_light_turns_by_its_marker() {
    let mut driver = Driver::reference();
    let direction = |driver: &Driver| match driver.settings().lights[0].kind {
        LightKind::Directional { direction } => direction,
        other => panic!("{other:?}"),
    };
    let (camera, before) = (driver.camera(), direction(&driver));
    let from = driver
        .harness
        .get_by_label("Marker of directional 1")
        .rect()
        .center();
    driver.drag_from(
        from,
        PointerButton::Primary,
        Modifiers::NONE,
        vec2(50.0, 0.0),
    );
    let after = direction(&driver);
    assert_eq!(driver.camera(), camera);
    assert!((after.length() - before.length()).abs() < 1e-9);
    // The marker stands where the light comes from and follows the pointer to the right.
    assert!((after - before).dot(camera.axes().right) < 0.0);
}
