//! A scripted hand: drags the camera of one scene after another through the real window, and notes how that felt.

use std::sync::mpsc::{Sender, channel};
use std::time::{Duration, Instant};

use egui::{Event, Modifiers, PointerButton, Pos2, RawInput, ViewportCommand, pos2};

use super::status::Progress;
use super::{Memory, ViewError, ViewOptions, ViewerApp, show_window};
use crate::measure::feel::Feel;
use crate::scene::LoadedScene;

/// The window is left alone for so long before it is dragged in.
const CALM: Duration = Duration::from_millis(500);
/// Longest wait for a full picture, before and after a drag.
const PATIENCE: Duration = Duration::from_secs(20);

/// What the hand does.
#[derive(Debug, Clone)]
pub struct FeelOptions {
    /// Scenes to drag in, in this order.
    pub scenes: Vec<LoadedScene>,
    /// Worker threads, 0 for one per core.
    pub threads: usize,
    /// Size of the window, points.
    pub size: [u32; 2],
    /// Length of a drag, seconds.
    pub seconds: f64,
}

/// How one scene felt.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Felt {
    /// The drag and the rest after it.
    pub feel: Feel,
    /// Columns and rows of the picture.
    pub size: [u32; 2],
    /// Time that drawing the window takes after the picture is there, median, ms.
    pub draw_p50_ms: f64,
}

/// Opens a window, drags in each scene, and closes it. One answer for each scene, in order.
///
/// # Errors
/// [`ViewError`] where no window can be shown, or where it was closed too early.
pub fn measure_feel(options: FeelOptions) -> Result<Vec<Felt>, ViewError> {
    let (felt, answers) = channel();
    let (count, size) = (options.scenes.len(), options.size);
    show_window(size, Memory::Blank, move |creation| {
        let view = ViewOptions {
            threads: options.threads,
            ..ViewOptions::default()
        };
        Ok(Box::new(Hand {
            app: ViewerApp::empty(creation, &view)?,
            scenes: options.scenes.into_iter(),
            seconds: options.seconds,
            state: State::Next,
            since: Instant::now(),
            drawn: Vec::new(),
            drawing_since: None,
            felt,
        }))
    })?;
    let felt: Vec<Felt> = answers.iter().collect();
    if felt.len() < count {
        return Err(ViewError::Closed);
    }
    Ok(felt)
}

/// What the hand is about to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    /// Put the next scene into the window.
    Next,
    /// Wait for its picture.
    Open,
    /// Drag.
    Drag,
    /// Wait for a full picture.
    Rest,
    /// Nothing any more.
    Done,
}

/// The window with a hand in it.
struct Hand {
    app: ViewerApp,
    scenes: std::vec::IntoIter<LoadedScene>,
    seconds: f64,
    state: State,
    since: Instant,
    drawn: Vec<f64>,
    drawing_since: Option<Instant>,
    felt: Sender<Felt>,
}

impl Hand {
    fn enter(&mut self, state: State) {
        self.state = state;
        self.since = Instant::now();
    }

    /// Goes on once there is nothing to wait for.
    fn step(&mut self, input: &mut RawInput) {
        let has_all_pixels = matches!(
            self.app.progress(),
            Progress::Refining(..) | Progress::Paused(..) | Progress::Converged(_)
        );
        let waited = self.since.elapsed();
        match self.state {
            State::Next => match self.scenes.next() {
                Some(scene) => {
                    self.app.adopt(scene);
                    self.enter(State::Open);
                }
                None => self.enter(State::Done),
            },
            State::Open if has_all_pixels && waited > CALM => {
                self.drawn.clear();
                self.enter(State::Drag);
                input.events.push(Event::PointerMoved(self.place(0.0)));
                input.events.push(self.button(true));
            }
            State::Drag => {
                let place = self.place(waited.as_secs_f64());
                if waited.as_secs_f64() < self.seconds {
                    input.events.push(Event::PointerMoved(place));
                } else {
                    input.events.push(self.button(false));
                    self.enter(State::Rest);
                }
            }
            State::Rest if has_all_pixels && waited > CALM || waited > PATIENCE => {
                if let Some(feel) = self.app.feel() {
                    // Nobody listens only if the window is about to close anyway.
                    let _ = self.felt.send(Felt {
                        feel,
                        size: self.app.picture_size(),
                        draw_p50_ms: median(&mut self.drawn),
                    });
                }
                self.enter(State::Next);
            }
            _ => {}
        }
    }

    /// Where the pointer is after so many seconds: slow circles in the part of the picture that panels leave
    /// free, with one full turn of the camera to the left and back in ten seconds.
    fn place(&self, seconds: f64) -> Pos2 {
        let [width, height] = self.app.picture_size().map(f64::from);
        let angle = seconds * std::f64::consts::TAU / 10.0;
        let x = width * (0.35 - 0.25 * angle.sin());
        let y = height * (0.5 + 0.04 * (3.0 * angle).sin());
        pos2(x as f32, y as f32)
    }

    fn button(&self, pressed: bool) -> Event {
        let seconds = if pressed { 0.0 } else { self.seconds };
        Event::PointerButton {
            pos: self.place(seconds),
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        }
    }
}

impl eframe::App for Hand {
    fn raw_input_hook(&mut self, _: &egui::Context, input: &mut RawInput) {
        // The real mouse would disturb.
        input
            .events
            .retain(|e| !matches!(e, Event::PointerMoved(_) | Event::PointerGone));
        self.step(input);
    }

    fn logic(&mut self, ctx: &egui::Context, frame: &mut eframe::Frame) {
        if let Some(since) = self.drawing_since.take() {
            self.drawn.push(since.elapsed().as_secs_f64() * 1e3);
        }
        self.app.logic(ctx, frame);
    }

    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        self.app.ui(ui, frame);
        match self.state {
            State::Drag => {
                self.drawing_since = Some(Instant::now());
                ui.ctx().request_repaint();
            }
            State::Done => ui.ctx().send_viewport_cmd(ViewportCommand::Close),
            _ => ui.ctx().request_repaint_after(CALM / 2),
        }
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        self.app.clear_color(visuals)
    }

    fn persist_egui_memory(&self) -> bool {
        false
    }
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
