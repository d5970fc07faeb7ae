//! The real app in a harness without a display, on the reference plane.

use std::path::PathBuf;
use std::time::Duration;

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, Vec2, pos2, vec2};
use egui_kittest::kittest::Queryable;
use egui_kittest::{Harness, Node, TestRenderer};
use reliefscope::scene::{Camera, RenderSettings};
use reliefscope::viewer::document::Document;
use reliefscope::viewer::status::Progress;
use reliefscope::viewer::{ViewOptions, ViewerApp};

/// Points. Tall, so that every section fits without scrolling.
pub const WINDOW: Vec2 = vec2(900.0, 2400.0);
/// Steps of a millisecond that any machine is done in.
const PATIENCE: usize = 60_000;

/// Uploads go nowhere: tests look at the app's own pixels.
struct Nowhere;

impl TestRenderer for Nowhere {
    fn handle_delta(&mut self, delta: &mut egui::TexturesDelta) {
        delta.clear();
    }
}

/// Whether the picture shown answers the last edit.
fn answers(app: &ViewerApp) -> bool {
    let shown = !matches!(app.progress(), Progress::Waiting | Progress::Outdated);
    app.document().is_some() && !app.is_loading() && shown
}

pub fn reference(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data/reference")
        .join(name)
}

pub struct Driver {
    pub harness: Harness<'static, ViewerApp>,
}

impl Driver {
    /// Opens a file and waits for its first picture; refining is paused to leave the cores to other tests.
    pub fn open(input: impl Into<PathBuf>) -> Self {
        Self::open_at(input, 0.125)
    }

    /// The same with so many pixels a point.
    pub fn open_at(input: impl Into<PathBuf>, pixels_per_point: f32) -> Self {
        let options = ViewOptions {
            input: Some(input.into()),
            threads: 1,
            normalize: true,
        };
        let harness = Harness::builder()
            .with_size(WINDOW)
            .with_pixels_per_point(pixels_per_point)
            .with_step_dt(1.0 / 60.0)
            .with_max_steps(8)
            .renderer(Nowhere)
            .build_eframe(|creation| ViewerApp::new(creation, options).expect("threads"));
        let mut driver = Self { harness };
        driver.key(Key::P);
        driver.settle();
        driver
    }

    pub fn reference() -> Self {
        Self::open(reference("bump.toml"))
    }

    /// Steps until the shown picture answers the last edit.
    pub fn settle(&mut self) {
        self.wait_until(answers);
    }

    /// The same for so many steps of a millisecond; says whether it does.
    pub fn settles_within(&mut self, steps: usize) -> bool {
        self.comes_true(answers, steps)
    }

    pub fn wait_until(&mut self, done: impl Fn(&ViewerApp) -> bool) {
        if self.comes_true(done, PATIENCE) {
            return;
        }
        let texts: Vec<_> = self.app().messages().collect();
        panic!("not done: {:?} {texts:?}", self.app().progress());
    }

    fn comes_true(&mut self, done: impl Fn(&ViewerApp) -> bool, steps: usize) -> bool {
        // Two steps at least: one to take the input, one to draw what followed.
        self.harness.run_steps(2);
        for _ in 0..steps {
            if done(self.harness.state()) {
                return true;
            }
            std::thread::sleep(Duration::from_millis(1));
            self.harness.step();
        }
        false
    }

    pub fn app(&self) -> &ViewerApp {
        self.harness.state()
    }

    pub fn doc(&self) -> &Document {
        self.app().document().expect("a scene is open")
    }

    pub fn settings(&self) -> &RenderSettings {
        &self.doc().settings
    }

    pub fn camera(&self) -> Camera {
        self.settings().camera
    }

    pub fn node<'a>(&'a self, role: Role, label: &'a str) -> Node<'a> {
        self.harness.get_by_role_and_label(role, label)
    }

    pub fn has(&self, label: &str) -> bool {
        self.harness.query_all_by_label(label).next().is_some()
    }

    /// Clicks a control found by role and name.
    pub fn click(&mut self, role: Role, label: &str) {
        // What has only just appeared is laid out once more before it stands still.
        self.harness.run_steps(3);
        self.node(role, label).click();
        self.harness.run_steps(2);
    }

    pub fn button(&mut self, label: &str) {
        self.click(Role::Button, label);
    }

    /// Opens or closes a section of the panel.
    pub fn section(&mut self, title: &str) {
        self.click(Role::DisclosureTriangle, title);
    }

    pub fn check(&mut self, label: &str) {
        self.click(Role::CheckBox, label);
    }

    /// Sets a number as a screen reader does.
    pub fn number(&mut self, label: &str, value: f64) {
        self.node(Role::SpinButton, label)
            .set_value_accesskit(value);
        self.harness.run_steps(2);
    }

    pub fn slider(&mut self, label: &str, value: f64) {
        self.node(Role::Slider, label).set_value_accesskit(value);
        self.harness.run_steps(2);
    }

    /// Opens a list and picks an entry.
    pub fn choose(&mut self, list: &str, entry: &str) {
        self.click(Role::ComboBox, list);
        self.button(entry);
    }

    pub fn key(&mut self, key: Key) {
        self.keys(Modifiers::NONE, key);
    }

    pub fn keys(&mut self, modifiers: Modifiers, key: Key) {
        self.harness.key_press_modifiers(modifiers, key);
        self.harness.run_steps(2);
    }

    /// A place in the picture that nothing lies over.
    pub fn free_place(&self) -> Pos2 {
        pos2(WINDOW.x * 0.5, WINDOW.y * 0.5)
    }

    pub fn drag(&mut self, button: PointerButton, modifiers: Modifiers, by: Vec2) {
        self.drag_from(self.free_place(), button, modifiers, by);
    }

    pub fn drag_from(&mut self, from: Pos2, button: PointerButton, modifiers: Modifiers, by: Vec2) {
        let pressed = |pos, pressed| Event::PointerButton {
            pos,
            button,
            pressed,
            modifiers,
        };
        self.harness.event(Event::ModifiersChanged(modifiers));
        self.harness.event(Event::PointerMoved(from));
        self.harness.event(pressed(from, true));
        for part in 1..=4 {
            let pos = from + by * (part as f32 / 4.0);
            self.harness.event(Event::PointerMoved(pos));
        }
        self.harness.event(pressed(from + by, false));
        self.harness.event(Event::ModifiersChanged(Modifiers::NONE));
        self.harness.step();
        self.harness.step();
    }

    pub fn wheel(&mut self, at: Pos2, notches: f32) {
        self.harness.event(Event::PointerMoved(at));
        self.harness.step();
        self.harness.event(Event::MouseWheel {
            unit: egui::MouseWheelUnit::Line,
            delta: vec2(0.0, notches),
            phase: egui::TouchPhase::Move,
            source: egui::MouseWheelSource::Wheel,
            modifiers: Modifiers::NONE,
        });
        self.harness.step();
    }

    pub fn click_at(&mut self, at: Pos2, times: usize, modifiers: Modifiers) {
        self.harness.event(Event::ModifiersChanged(modifiers));
        self.harness.event(Event::PointerMoved(at));
        for _ in 0..times {
            for pressed in [true, false] {
                self.harness.event(Event::PointerButton {
                    pos: at,
                    button: PointerButton::Primary,
                    pressed,
                    modifiers,
                });
            }
        }
        self.harness.event(Event::ModifiersChanged(Modifiers::NONE));
        self.harness.step();
        self.harness.step();
    }
}
