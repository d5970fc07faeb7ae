//! A hand that does anything: seeded random actions, each of which leaves a window that still works, and memory that
//! does not grow for good.
//!
//! `RELIEFSCOPE_WILD_ACTIONS=100000 cargo test --release --test integration wild` runs as many as wanted,
//! `RELIEFSCOPE_WILD_SEED` chooses others.

use std::env::var;

use egui::accesskit::Role;
use egui::{Key, Modifiers, PointerButton, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use reliefscope::measure::stability::Random;
use reliefscope::surface::mapping::Method;

use super::driver::{Driver, WINDOW, reference};

/// Actions of an ordinary test run.
const ACTIONS: usize = 300;
/// Actions between two looks at whether the picture still comes.
const ROUND: usize = 50;
/// Small pictures: some settings that the hand finds take a second for a thousand pixels.
const PIXELS_PER_POINT: f32 = 0.04;
/// Steps of a millisecond after which a picture is given up for a fast one.
const SLOW: usize = 10_000;
/// Rounds between two lines that say how far it is.
const TOLD: usize = 20;
/// What the memory of late rounds may hold beyond that of early ones: allocators keep what large scenes left.
const SLACK: u64 = 256 << 20;

/// Roles of what can be used.
const ROLES: [Role; 6] = [
    Role::Button,
    Role::CheckBox,
    Role::Slider,
    Role::SpinButton,
    Role::ComboBox,
    Role::DisclosureTriangle,
];

/// What lifts a relief or repeats it stays below this: a surface displaced by many times its own size, or a map repeated
/// a million times on it, takes minutes a picture, and would tell nothing else.
const MODERATE: [&str; 4] = ["mplitude", "ampl.", "Gain", "Scale"];
const MOST: f64 = 0.02;

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
    let label = node.accesskit_node().label().unwrap_or_default();
    let is_moderate = MODERATE.iter().any(|word| label.contains(word));
    let value = if is_moderate { value.min(MOST) } else { value };
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

/// Bytes of memory that the process holds; `None` where the system does not say.
fn resident_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmRSS:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib << 10)
}

/// Whether memory grows for good: at no time of the last quarter as little as at some time of the first.
fn grows(rounds: &[u64]) -> bool {
    let quarter = rounds.len() / 4;
    let early = rounds[..quarter].iter().max();
    let late = rounds[rounds.len() - quarter..].iter().min();
    early
        .zip(late)
        .is_some_and(|(early, late)| *late > early + SLACK)
}

/// Changes the size of the picture, so that another has to come, and waits for it. A picture that takes too long must
/// end when it is out of date, after the tile at hand: the method `none` takes its place, without a comparison. Says
/// whether that was needed.
fn ask_for_a_frame(driver: &mut Driver) -> bool {
    driver.harness.set_size(WINDOW);
    driver.key(Key::Escape);
    let slow = !driver.settles_within(SLOW);
    if slow {
        let doc = driver.doc();
        eprintln!("slow: {:?}, {:?}", doc.scene.source, doc.settings.mapping);
        let before = driver.settings().clone();
        driver.harness.run_steps(5);
        assert_eq!(
            &before,
            driver.settings(),
            "settings that change by themselves"
        );
        if driver.doc().comparison.request().is_some() {
            driver.key(Key::C);
        }
        driver.key(Key::Num1);
        assert_eq!(driver.settings().mapping.method, Method::None);
        driver.settle();
    }
    let before = driver.app().stats().generation;
    driver.harness.set_size(WINDOW * 0.9);
    driver.settle();
    let after = driver.app().stats().generation;
    assert!(after > before, "still frame {before}");
    slow
}

#[test]
fn whatever_the_hand_does_pictures_come() {
    let actions = setting("RELIEFSCOPE_WILD_ACTIONS", ACTIONS);
    let seed = setting("RELIEFSCOPE_WILD_SEED", 1);
    eprintln!("seed {seed}, {actions} actions");
    let mut random = Random::new(seed as u64);
    let mut driver = Driver::open_at(reference("bump.toml"), PIXELS_PER_POINT);
    let (mut memory, mut slow) = (Vec::new(), 0);
    for action in 0..actions {
        act(&mut driver, &mut random);
        if action % ROUND == ROUND - 1 {
            let round = action / ROUND;
            slow += usize::from(ask_for_a_frame(&mut driver));
            let failed = driver
                .app()
                .messages()
                .find(|text| text.contains("Rendering failed"));
            assert_eq!(failed, None, "seed {seed}, action {action}");
            memory.extend(resident_bytes());
            if round % TOLD == TOLD - 1 {
                let held = memory.last().map_or(0, |bytes| bytes >> 20);
                eprintln!("seed {seed}: {} actions, {held} MiB", action + 1);
            }
        }
    }
    let mib = |bytes: Option<&u64>| bytes.map_or(0, |bytes| bytes >> 20);
    let (least, most) = (mib(memory.iter().min()), mib(memory.iter().max()));
    eprintln!("seed {seed}: {actions} actions, {least} to {most} MiB, {slow} slow pictures");
    assert!(!grows(&memory), "seed {seed}: {memory:?}");
}

#[test]
fn a_leak_would_be_noticed() {
    let rounds = |step: u64| {
        (0..2000)
            .map(|i| (100 << 20) + i * step)
            .collect::<Vec<_>>()
    };
    // Half a MiB in 50 actions.
    assert!(grows(&rounds(1 << 19)));
    assert!(!grows(&rounds(1 << 14)));
    let up_and_down: Vec<_> = (0..2000).map(|i| (i % 7) << 30).collect();
    assert!(!grows(&up_and_down) && !grows(&[]));
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
