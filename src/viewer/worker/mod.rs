//! The thread that renders: one slot in, one slot out, the newest request wins.
//!
//! The window's thread never waits for a picture. It overwrites the inbox and looks into the outbox. A
//! snapshot's first pass (a coarse preview where a full one would be too slow for the screen) is never
//! cancelled, or a continuous drag would show nothing at all; every later pass is given up as soon as a newer
//! request arrives. At rest the picture is refined until it has converged; then the thread sleeps.
//!
//! Besides `measure` this is the only room that reads a clock.

mod coordinator;
mod costs;
mod pair;

use std::io;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use egui::{Color32, ColorImage};

use crate::measure::error_map::{ErrorMetric, ErrorSummary};
use crate::measure::stage_clock::StageClock;
use crate::render::{
    Counters, Legend, PassEnd, Picture, Progressive, Recording, Records, Shown, Snapshot,
};
use crate::scene::DisplaySettings;
use crate::surface::mapping::Method;

/// What the worker needs from a renderer. [`Progressive`] is the one that ships.
pub trait PassRenderer: Send {
    /// See [`Progressive::start`].
    fn start(&mut self, snapshot: Snapshot);
    /// See [`Progressive::preview`].
    fn preview(&mut self, stride: u32, stop: &(dyn Fn() -> bool + Sync)) -> PassEnd;
    /// See [`Progressive::pass`].
    fn pass(&mut self, stop: &(dyn Fn() -> bool + Sync)) -> PassEnd;
    /// A pass, and the thread time in each stage of it, ms; what it does not measure is 0.
    fn timed_pass(&mut self, stop: &(dyn Fn() -> bool + Sync)) -> (PassEnd, [f64; 4]) {
        (self.pass(stop), [0.0; 4])
    }
    /// See [`Progressive::record`]. One that keeps no records does not listen.
    fn record(&mut self, _what: Recording) {}
    /// See [`Progressive::records`].
    fn records(&self) -> Option<Records> {
        None
    }
    /// See [`Progressive::samples`].
    fn samples(&self) -> u32;
    /// See [`Progressive::picture`].
    fn picture(&self) -> Picture;
    /// See [`Progressive::shown`].
    fn shown(&self) -> Shown;
    /// See [`Progressive::encode_shown_into`].
    fn encode_shown_into(&self, exposure_ev: f32, rgba: &mut [[u8; 4]]);
    /// See [`Progressive::is_converged`].
    fn is_converged(&self) -> bool;
    /// See [`Progressive::counters`].
    fn counters(&self) -> Counters;
    /// See [`Progressive::kept_bytes`].
    fn kept_bytes(&self) -> usize {
        0
    }
    /// See [`Progressive::reuses_hits`].
    fn reuses_hits(&self) -> bool;
    /// See [`Progressive::threads`].
    fn threads(&self) -> usize;
}

impl PassRenderer for Progressive {
    fn start(&mut self, snapshot: Snapshot) {
        Self::start(self, snapshot);
    }
    fn preview(&mut self, stride: u32, stop: &(dyn Fn() -> bool + Sync)) -> PassEnd {
        Self::preview(self, stride, stop)
    }
    fn pass(&mut self, stop: &(dyn Fn() -> bool + Sync)) -> PassEnd {
        Self::pass(self, stop)
    }
    fn timed_pass(&mut self, stop: &(dyn Fn() -> bool + Sync)) -> (PassEnd, [f64; 4]) {
        let (end, clocks) = self.watched_pass::<StageClock>(stop);
        (end, StageClock::sum_millis(&clocks))
    }
    fn record(&mut self, what: Recording) {
        Self::record(self, what);
    }
    fn records(&self) -> Option<Records> {
        Self::records(self)
    }
    fn samples(&self) -> u32 {
        Self::samples(self)
    }
    fn picture(&self) -> Picture {
        Self::picture(self)
    }
    fn shown(&self) -> Shown {
        Self::shown(self)
    }
    fn encode_shown_into(&self, exposure_ev: f32, rgba: &mut [[u8; 4]]) {
        Self::encode_shown_into(self, exposure_ev, rgba);
    }
    fn is_converged(&self) -> bool {
        Self::is_converged(self)
    }
    fn counters(&self) -> Counters {
        Self::counters(self)
    }
    fn kept_bytes(&self) -> usize {
        Self::kept_bytes(self)
    }
    fn reuses_hits(&self) -> bool {
        Self::reuses_hits(self)
    }
    fn threads(&self) -> usize {
        Self::threads(self)
    }
}

/// Makes a renderer with a pool of so many threads (0: one per core).
pub type RendererFactory = Box<dyn FnMut(usize) -> io::Result<Box<dyn PassRenderer>> + Send>;

/// How the first pass of a snapshot is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FirstPass {
    /// As fine as the measured cost allows at 60 Hz.
    #[default]
    Adaptive,
    /// Always every pixel.
    FullResolution,
}

/// What happens once a snapshot has its first sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Refinement {
    /// Samples are added until the picture has converged.
    #[default]
    Running,
    /// Nothing more is rendered until something changes.
    Paused,
}

/// A second picture of the same snapshot, with the same samples, by another method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compare {
    /// The other method.
    pub method: Method,
    /// Show how far the two are apart instead of the second picture.
    pub error: Option<ErrorView>,
}

/// How errors become colours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorView {
    /// What is measured.
    pub metric: ErrorMetric,
    /// The error that gets the brightest colour, above 0.
    pub full_scale: f32,
}

/// Everything that a picture on the screen depends on.
#[derive(Debug, Clone)]
pub struct RenderRequest {
    /// What to render.
    pub snapshot: Snapshot,
    /// A change of it alone encodes again without rendering, unless a view begins that needs records.
    pub display: DisplaySettings,
    /// Preview or not.
    pub first_pass: FirstPass,
    /// Refine or not.
    pub refinement: Refinement,
    /// Worker threads, 0 for one per core. A change makes a new renderer.
    pub threads: usize,
    /// What to render beside it.
    pub compare: Option<Compare>,
}

impl RenderRequest {
    /// Whether there is nothing to do for the other one.
    #[must_use]
    pub fn is_same(&self, other: &Self) -> bool {
        self.same_samples(other)
            && self.display == other.display
            && self.first_pass == other.first_pass
            && self.refinement == other.refinement
            && self.compare == other.compare
    }

    /// What first samples must leave.
    #[must_use]
    pub fn recording(&self) -> Recording {
        let error = self.compare.and_then(|compare| compare.error);
        match Recording::for_view(&self.display) {
            Recording::Nothing if error.is_some_and(|e| e.metric.needs_records()) => {
                Recording::Pixels
            }
            recording => recording,
        }
    }

    /// Whether the other one asks for no other samples, so that what is done can stay. A comparison that begins
    /// needs both pictures from the start, so that they always have the same samples; and records are made of
    /// first samples only.
    fn same_samples(&self, other: &Self) -> bool {
        let (a, b) = (&self.snapshot, &other.snapshot);
        let method = |request: &Self| request.compare.map(|compare| compare.method);
        Arc::ptr_eq(&a.scene, &b.scene)
            && Arc::ptr_eq(&a.settings, &b.settings)
            && a.size == b.size
            && self.threads == other.threads
            && (other.compare.is_none() || method(self) == method(other))
            && self.recording().serves(other.recording())
    }
}

/// What is known about a finished frame.
#[derive(Debug, Clone, Copy, Default)]
pub struct FrameStats {
    /// The request it answers.
    pub generation: u64,
    /// Columns and rows of the picture that was asked for.
    pub size: [u32; 2],
    /// 1 for full resolution, else every `stride`-th pixel was rendered.
    pub stride: u32,
    /// Samples per pixel so far; 0 while only a preview exists.
    pub samples: u32,
    /// Samples per pixel asked for.
    pub samples_wanted: u32,
    /// Whether every pixel has all its samples.
    pub converged: bool,
    /// Duration of the last pass.
    pub pass_millis: f32,
    /// Thread time in the stages of the last full pass of the first picture, ms: tracing, perturbing, shading,
    /// putting into the film.
    pub stage_millis: [f64; 4],
    /// Bytes that workers keep of displaced triangles.
    pub kept_bytes: usize,
    /// Rays of all kinds in the last pass.
    pub pass_rays: u64,
    /// Exact counts of the whole picture so far.
    pub counters: Counters,
    /// Whether hits of the snapshot before replaced camera rays.
    pub reshaded: bool,
    /// Passes and previews completed since the worker started.
    pub passes: u64,
    /// Size of the pool.
    pub threads: usize,
    /// How far the two pictures are apart, if that is shown.
    pub error: Option<ErrorSummary>,
    /// What the colours mean where a view is shown instead of the picture, or over it.
    pub legend: Option<Legend>,
}

/// A picture for the screen.
#[derive(Debug)]
pub struct Frame {
    /// Opaque pixels, row 0 on top: of the picture, or of every `stride`-th pixel in both directions.
    pub image: ColorImage,
    /// What stands beside it while two methods are compared, of the same size: the other picture, or the errors.
    pub other: Option<ColorImage>,
    /// What is known about it.
    pub stats: FrameStats,
}

/// Something to tell the user.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum RenderNote {
    /// A render or a save failed.
    Error(String),
    /// A picture was written.
    Saved(String),
}

#[derive(Default)]
struct Inbox {
    request: Option<(u64, RenderRequest)>,
    saves: Vec<PathBuf>,
}

#[derive(Default)]
struct Outbox {
    frame: Option<Frame>,
    notes: Vec<RenderNote>,
    spare: Vec<Vec<Color32>>,
    /// The window waits for a frame of this generation or a later one.
    awaited: Option<u64>,
}

struct Shared {
    inbox: Mutex<Inbox>,
    bell: Condvar,
    newest: AtomicU64,
    quit: AtomicBool,
    asleep: AtomicBool,
    outbox: Mutex<Outbox>,
    /// Rung when something comes into the outbox that the window waits for.
    arrived: Condvar,
    /// Bits of the milliseconds that a first pass should take at most.
    first_pass_millis: AtomicU32,
    wake_window: Box<dyn Fn() + Send + Sync>,
}

/// Milliseconds that a first pass may take at 60 Hz where a graphics card draws the window: the rest of the
/// interval goes to encoding and to the window.
pub const FIRST_PASS_MILLIS: f32 = 13.0;

/// A poisoned lock only means that another thread panicked between two plain assignments.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The window's handle on the rendering thread, which ends when this is dropped.
pub struct RenderWorker {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
    generation: u64,
}

impl RenderWorker {
    /// Starts the thread named `render`. `wake_window` is called from it whenever something is in the outbox.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn spawn(
        factory: RendererFactory,
        wake_window: impl Fn() + Send + Sync + 'static,
    ) -> io::Result<Self> {
        let shared = Arc::new(Shared {
            inbox: Mutex::default(),
            bell: Condvar::new(),
            newest: AtomicU64::new(0),
            quit: AtomicBool::new(false),
            asleep: AtomicBool::new(false),
            outbox: Mutex::default(),
            arrived: Condvar::new(),
            first_pass_millis: AtomicU32::new(FIRST_PASS_MILLIS.to_bits()),
            wake_window: Box::new(wake_window),
        });
        let for_thread = Arc::clone(&shared);
        let thread = std::thread::Builder::new()
            .name("render".into())
            .spawn(move || coordinator::Coordinator::new(for_thread, factory).run())?;
        Ok(Self {
            shared,
            thread: Some(thread),
            generation: 0,
        })
    }

    /// Replaces whatever was asked for before; returns the generation that its frames will carry.
    pub fn submit(&mut self, request: RenderRequest) -> u64 {
        self.generation += 1;
        lock(&self.shared.inbox).request = Some((self.generation, request));
        self.shared.newest.store(self.generation, Ordering::Release);
        self.shared.bell.notify_one();
        self.generation
    }

    /// Writes the picture as soon as it has a sample; `.exr` holds linear values, anything else what is shown.
    pub fn save_picture(&self, path: PathBuf) {
        lock(&self.shared.inbox).saves.push(path);
        self.shared.bell.notify_one();
    }

    /// Generation of the last request.
    #[must_use]
    pub const fn generation(&self) -> u64 {
        self.generation
    }

    /// Says how long adaptive first passes should take at most, milliseconds.
    pub fn set_first_pass_millis(&self, millis: f32) {
        let bits = millis.to_bits();
        self.shared.first_pass_millis.store(bits, Ordering::Relaxed);
    }

    /// Waits until the outbox has a frame of the last request, or something went wrong with it, but not longer
    /// than `most`. A frame that is waited for does not wake the window.
    pub fn wait_for_frame(&self, most: Duration) {
        let until = Instant::now() + most;
        let mut outbox = lock(&self.shared.outbox);
        outbox.awaited = Some(self.generation);
        loop {
            let frame = outbox.frame.as_ref();
            let is_there = frame.is_some_and(|frame| frame.stats.generation >= self.generation);
            let left = until.saturating_duration_since(Instant::now());
            if is_there || left.is_zero() || !outbox.notes.is_empty() {
                outbox.awaited = None;
                return;
            }
            let woken = self.shared.arrived.wait_timeout(outbox, left);
            outbox = woken.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// The newest finished frame, once.
    #[must_use]
    pub fn take_frame(&self) -> Option<Frame> {
        lock(&self.shared.outbox).frame.take()
    }

    /// Messages since the last call.
    #[must_use]
    pub fn take_notes(&self) -> Vec<RenderNote> {
        std::mem::take(&mut lock(&self.shared.outbox).notes)
    }

    /// Gives the memory of a shown picture back for the next one.
    pub fn recycle(&self, pixels: Vec<Color32>) {
        let mut outbox = lock(&self.shared.outbox);
        if outbox.spare.len() < 5 {
            outbox.spare.push(pixels);
        }
    }

    /// Whether the thread waits for work.
    #[must_use]
    pub fn is_asleep(&self) -> bool {
        self.shared.asleep.load(Ordering::Acquire)
    }
}

impl Drop for RenderWorker {
    fn drop(&mut self) {
        {
            // Under the lock, or the thread could miss the bell between its check and its wait.
            let _inbox = lock(&self.shared.inbox);
            self.shared.quit.store(true, Ordering::Release);
        }
        self.shared.bell.notify_one();
        if let Some(thread) = self.thread.take() {
            // Panics were reported where they happened.
            let _ = thread.join();
        }
    }
}
