//! A hand that does anything: seeded random actions, each of which leaves a window that still works.
//!
//! `RELIEFSCOPE_WILD_ACTIONS=100000 cargo test --release --test integration wild` runs as many as wanted,
//! `RELIEFSCOPE_WILD_SEED` chooses others.

use std::env::var;

use egui::accesskit::Role;
use egui::{Key, Modifiers, PointerButton, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use reliefscope::measure::stability::Random;

use super::driver::{Driver, WINDOW};

/// Actions of an ordinary test run.
const ACTIONS: usize = 300;
/// Actions between two looks at whether the picture still comes.
const ROUND: usize = 50;

/// Roles of what can be used.
const ROLES: [Role; 6] = [
    Role::Button,
    Role::CheckBox,
    Role::Slider,
    Role::SpinButton,
    Role::ComboBox,
    Role::DisclosureTriangle,
];

/// What leaves the window: dialogs of the system, its end, and a thousand threads.
const LEFT_ALONE: [&str; 8] = [
    "…", "Quit", "Save", "Threads", "Open", "replace", "path", "Files",
];

const KEYS: [Key; 22] = [
    Key::Num0,
    Key::Num1,
    Key::Num4,
    Key::Num7,
    Key::Num9,
    Key::A,
    Key::B,
    Key::C,
    Key::E,
    Key::F,
    Key::H,
    Key::P,
    Key::R,
    Key::S,
    Key::T,
    Key::V,
    Key::X,
    Key::Z,
    Key::Escape,
    Key::Tab,
    Key::Enter,
    Key::Space,
];

const VALUES: [f64; 12] = [
    0.0,
    1.0,
    -1.0,
    0.5,
    1e-6,
    1e6,
    1e30,
    -1e30,
    f64::MAX,
    89.99,
    1e-300,
    -0.0,
];

fn setting(name: &str, default: usize) -> usize {
    var(name)
        .ok()
        .and_then(|text| text.parse().ok())
        .unwrap_or(default)
}

/// Uses some control in some way.
fn control(driver: &mut Driver, random: &mut Random) {
    let role = random.pick(&ROLES);
    let value = random.pick(&VALUES);
    let nodes: Vec<_> = driver
        .harness
        .query_all_by_role(role)
        .filter(|node| {
            let label = node.accesskit_node().label().unwrap_or_default();
            !label.is_empty() && !LEFT_ALONE.iter().any(|word| label.contains(word))
        })
        .collect();
    if nodes.is_empty() {
        return;
    }
    let node = &nodes[random.below(nodes.len())];
    match role {
        Role::Slider | Role::SpinButton => node.set_value_accesskit(value),
        _ => node.click_accesskit(),
    }
}

fn act(driver: &mut Driver, random: &mut Random) {
    let middle = driver.free_place();
    let by = vec2(
        random.between(-300.0, 300.0) as f32,
        random.between(-300.0, 300.0) as f32,
    );
    let modifiers = random.pick(&[Modifiers::NONE, Modifiers::SHIFT, Modifiers::ALT]);
    match random.below(8) {
        0 => driver.keys(modifiers, random.pick(&KEYS)),
        1 => driver.wheel(middle, random.between(-9.0, 9.0) as f32),
        2 => {
            let button = random.pick(&[
                PointerButton::Primary,
                PointerButton::Middle,
                PointerButton::Secondary,
            ]);
            driver.drag(button, modifiers, by);
        }
        3 => driver.click_at(middle + by * 0.5, 1 + random.below(2), modifiers),
        4 => {
            let size = random.pick(&[vec2(1.0, 1.0), vec2(40.0, 900.0), vec2(900.0, 40.0), WINDOW]);
            driver.harness.set_size(size);
        }
        _ => control(driver, random),
    }
    driver.harness.step();
}

#[test]
fn whatever_the_hand_does_pictures_come() {
    let actions = setting("RELIEFSCOPE_WILD_ACTIONS", ACTIONS);
    let seed = setting("RELIEFSCOPE_WILD_SEED", 1);
    eprintln!("seed {seed}, {actions} actions");
    let mut random = Random::new(seed as u64);
    let mut driver = Driver::reference();
    for action in 0..actions {
        act(&mut driver, &mut random);
        if action % ROUND == ROUND - 1 {
            driver.harness.set_size(WINDOW);
            driver.key(Key::Escape);
            driver.settle();
            let failed = driver
                .app()
                .messages()
                .find(|text| text.contains("Rendering failed"));
            assert_eq!(failed, None, "seed {seed}, action {action}");
        }
    }
}

#[test]
fn a_window_of_one_point_and_back() {
    let mut driver = Driver::reference();
    driver.harness.set_size(vec2(1.0, 1.0));
    driver.harness.run_steps(4);
    driver.harness.set_size(WINDOW);
    driver.settle();
}

#[test]
fn zooming_a_million_times_in_and_out_keeps_a_camera() {
    for notches in [40.0, -40.0] {
        let mut driver = Driver::reference();
        let before = driver.camera().distance();
        for _ in 0..400 {
            driver.wheel(driver.free_place(), notches);
            let ratio = driver.camera().distance() / before;
            if !(1e-6..1e6).contains(&ratio) {
                break;
            }
        }
        driver.settle();
        let camera = driver.camera();
        assert!(
            camera.eye.is_finite() && camera.target.is_finite(),
            "{camera:?}"
        );
        assert!(camera.distance() > 0.0, "{camera:?}");
        assert!(!driver.app().messages().any(|text| text.contains("failed")));
    }
}
