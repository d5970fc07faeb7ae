//! What the rendering thread does next: take a request, save, render a pass, or sleep.

use std::any::Any;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};

use egui::{Color32, ColorImage};

use super::costs::Costs;
use super::pair::Pair;
use super::{
    FirstPass, Frame, FrameStats, PassRenderer, Refinement, RenderNote, RenderRequest,
    RendererFactory, Shared, lock,
};
use crate::render::{Legend, PassEnd, Snapshot, crashing_pixel};
use crate::scene::save_picture::{SaveError, write_exr, write_png};
use crate::scene::{DisplaySettings, SceneSource, View};

/// A stride becomes finer only when the finer pass is expected to fit with this margin, so that the
/// resolution does not flicker during a drag.
const FINER_MARGIN: f32 = 0.75;
/// Full passes slower than this are approached through every finer preview instead of at once.
const SLOW_PASS_MILLIS: f32 = 120.0;
/// One pixel in 16 is shown down to 30 pictures a second before fewer are; milliseconds.
const BEARABLE_MILLIS: f32 = 30.0;
/// The coarsest preview: one pixel in 64.
const COARSEST: u32 = 8;
/// Refinement shows its first samples as they come, later ones ten times a second: each shown frame costs
/// an encoding and an upload that the refinement itself could use.
const SHOW_EVERY: Duration = Duration::from_millis(100);
/// How long a preview waits for the next edit before it is refined. In a drag edits come faster than this,
/// and the window, too, needs the cores that refining would take.
const REST: Duration = Duration::from_millis(20);
/// How long a first pass may take before a newer edit ends it: what it would show is out of date, and the next may
/// be quicker.
const PATIENCE: Duration = Duration::from_secs(2);
/// Samples that are shown as they come.
const FAST_SAMPLES: u32 = 4;

/// The request being worked on.
struct Job {
    generation: u64,
    request: RenderRequest,
    /// Stride of what is in the film; 0 before the first pass.
    stride: u32,
    /// Time spent on the pass under way, stopped parts included.
    spent: Duration,
    /// Duration of the last complete pass.
    pass_millis: f32,
    /// Rays of the last complete pass, and of all up to it.
    pass_rays: u64,
    rays: u64,
    /// A panic ended it; nothing more is tried until the next request.
    failed: bool,
}

enum Step {
    Quit,
    Take(u64, RenderRequest),
    Save(PathBuf),
    Render,
}

pub(super) struct Coordinator {
    shared: Arc<Shared>,
    factory: RendererFactory,
    renderer: Option<Pair>,
    job: Option<Job>,
    /// Of first passes in this scene.
    costs: Costs,
    /// Stride of the last first pass.
    stride: u32,
    passes: u64,
    shown_at: Option<Instant>,
    /// Until then nothing is refined.
    rest_until: Option<Instant>,
}

impl Coordinator {
    pub(super) fn new(shared: Arc<Shared>, factory: RendererFactory) -> Self {
        Self {
            shared,
            factory,
            renderer: None,
            job: None,
            costs: Costs::default(),
            stride: COARSEST,
            passes: 0,
            shown_at: None,
            rest_until: None,
        }
    }

    pub(super) fn run(mut self) {
        loop {
            match self.next_step() {
                Step::Quit => return,
                Step::Take(generation, request) => self.take(generation, request),
                Step::Save(path) => self.save(&path),
                Step::Render => self.guarded(Self::render),
            }
        }
    }

    /// Sleeps until there is something to do.
    fn next_step(&mut self) -> Step {
        let mut inbox = lock(&self.shared.inbox);
        loop {
            if self.shared.quit.load(Ordering::Acquire) {
                return Step::Quit;
            }
            if let Some((generation, request)) = inbox.request.take() {
                return Step::Take(generation, request);
            }
            if self.has_sample() && !inbox.saves.is_empty() {
                return Step::Save(inbox.saves.remove(0));
            }
            let rest = self.rest_until.map(|until| until - Instant::now());
            match rest.filter(|rest| !rest.is_zero()) {
                Some(rest) => {
                    let bell = self.shared.bell.wait_timeout(inbox, rest);
                    inbox = bell.unwrap_or_else(PoisonError::into_inner).0;
                    continue;
                }
                None => self.rest_until = None,
            }
            if self.has_work() {
                return Step::Render;
            }
            self.shared.asleep.store(true, Ordering::Release);
            inbox = self
                .shared
                .bell
                .wait(inbox)
                .unwrap_or_else(PoisonError::into_inner);
            self.shared.asleep.store(false, Ordering::Release);
        }
    }

    fn has_sample(&self) -> bool {
        let job = self.job.as_ref();
        job.is_some_and(|job| job.stride == 1 && !job.failed)
    }

    fn is_converged(&self) -> bool {
        self.has_sample() && self.renderer.as_ref().is_some_and(Pair::is_converged)
    }

    fn has_work(&self) -> bool {
        let Some(job) = self.job.as_ref().filter(|job| !job.failed) else {
            return false;
        };
        let running = job.request.refinement == Refinement::Running;
        job.stride != 1 || (running && !self.is_converged())
    }

    fn take(&mut self, generation: u64, request: RenderRequest) {
        let keeps_film =
            |job: &&mut Job| !job.failed && job.stride > 0 && job.request.same_samples(&request);
        if let Some(job) = self.job.as_mut().filter(keeps_film) {
            job.generation = generation;
            job.request = request;
            if let (None, Some(renderer)) = (job.request.compare, &mut self.renderer) {
                renderer.drop_second();
            }
            self.publish();
            return;
        }
        if let Some(job) = &self.job
            && !Arc::ptr_eq(&job.request.snapshot.scene, &request.snapshot.scene)
        {
            self.costs = Costs::default();
            self.stride = COARSEST;
        }
        self.rest_until = None;
        self.job = Some(Job {
            generation,
            request,
            stride: 0,
            spent: Duration::ZERO,
            pass_millis: 0.0,
            pass_rays: 0,
            rays: 0,
            failed: false,
        });
        self.guarded(Self::start);
    }

    /// Runs one step of a job; a panic in it ends the job, not the program.
    fn guarded(&mut self, step: impl FnOnce(&mut Self) -> io::Result<()>) {
        let message = match catch_unwind(AssertUnwindSafe(|| step(self))) {
            Ok(Ok(())) => return,
            Ok(Err(error)) => format!("The renderer could not start: {error}"),
            Err(panic) => {
                // Its state is not to be trusted any more.
                self.renderer = None;
                let (story, text) = (self.story(), panic_text(&*panic));
                format!("Rendering failed{story}: {text}{}", self.culprit())
            }
        };
        if let Some(job) = &mut self.job {
            job.failed = true;
        }
        self.note(RenderNote::Error(message));
    }

    /// What was being rendered, for whoever has to reproduce it.
    fn story(&self) -> String {
        self.job.as_ref().map_or_else(String::new, |job| {
            let Snapshot {
                scene,
                settings,
                size: [w, h],
            } = &job.request.snapshot;
            let method = settings.mapping.method.name();
            let (name, passes) = (&scene.name, self.passes);
            format!(" ({name} at {w}x{h}, method {method}, after {passes} passes)")
        })
    }

    /// The pixel that a panic came from and how to see it again, if it can be.
    fn culprit(&self) -> String {
        let snapshot = self.job.as_ref().map(|job| &job.request.snapshot);
        snapshot.map_or_else(String::new, |snapshot| {
            crashing_pixel(snapshot).map_or_else(String::new, |pixel| replay(snapshot, pixel))
        })
    }

    fn start(&mut self) -> io::Result<()> {
        let Some(job) = &self.job else { return Ok(()) };
        let threads = job.request.threads;
        if self.renderer.as_ref().is_none_or(|r| r.threads != threads) {
            // The old pool goes first: two at once would fight for the cores.
            self.renderer = None;
            self.renderer = Some(Pair::new(threads, &mut self.factory)?);
        }
        match &mut self.renderer {
            Some(renderer) => renderer.start(&job.request, &mut self.factory),
            None => Ok(()),
        }
    }

    fn render(&mut self) -> io::Result<()> {
        let Some(stride) = self.choose_stride() else {
            return Ok(());
        };
        let Some((job, renderer)) = self.job.as_ref().zip(self.renderer.as_mut()) else {
            return Ok(());
        };
        let (shared, generation, first) = (&*self.shared, job.generation, job.stride == 0);
        // Whoever moves something wants to see it move: a first pass is finished, unless that takes too long.
        let began = Instant::now();
        let spent = job.spent;
        let stop = || {
            let outdated = || shared.newest.load(Ordering::Relaxed) != generation;
            let may_go = || !first || spent + began.elapsed() > PATIENCE;
            shared.quit.load(Ordering::Relaxed) || (may_go() && outdated())
        };
        let end = renderer.advance(stride, &stop);
        if let Some(job) = &mut self.job {
            job.spent += began.elapsed();
        }
        if end == PassEnd::Complete {
            self.complete(stride);
        }
        Ok(())
    }

    /// Stride of the next pass: at first the finest that should fit into a screen interval, then finer ones.
    fn choose_stride(&mut self) -> Option<u32> {
        let job = self.job.as_ref()?;
        let millis = |stride| self.costs.expected(stride);
        let slow = millis(1).is_none_or(|full| full > SLOW_PASS_MILLIS);
        match (job.stride, job.request.first_pass) {
            (0, FirstPass::FullResolution) | (1 | 2, _) => Some(1),
            (0, FirstPass::Adaptive) => {
                let bits = self.shared.first_pass_millis.load(Ordering::Relaxed);
                let limit = |stride| {
                    f32::from_bits(bits)
                        * if stride < self.stride {
                            FINER_MARGIN
                        } else {
                            1.0
                        }
                };
                let fits = |&stride: &u32| millis(stride).is_some_and(|t| t <= limit(stride));
                let bearable = |&stride: &u32| millis(stride).is_some_and(|t| t <= BEARABLE_MILLIS);
                let finest = [1, 2, 4].into_iter().find(fits);
                self.stride = finest
                    .or_else(|| Some(4).filter(bearable))
                    .unwrap_or(COARSEST);
                Some(self.stride)
            }
            (stride, _) => Some(if slow { stride / 2 } else { 1 }),
        }
    }

    fn complete(&mut self, stride: u32) {
        self.passes += 1;
        let Some((job, renderer)) = self.job.as_mut().zip(self.renderer.as_ref()) else {
            return;
        };
        let took = std::mem::take(&mut job.spent).as_secs_f32();
        let before = std::mem::replace(&mut job.stride, stride);
        let rays = renderer.counters().rays();
        job.pass_rays = rays.saturating_sub(job.rays);
        job.rays = rays;
        job.pass_millis = took * 1e3;
        self.rest_until = (before == 0 && stride > 1).then(|| Instant::now() + REST);
        if before != 1 {
            // Later samples say nothing about a first pass, whose hits may be cached.
            self.costs.note(stride, took * 1e3);
        }
        let due = self.shown_at.is_none_or(|at| at.elapsed() >= SHOW_EVERY);
        let young = before != 1 || renderer.samples() <= FAST_SAMPLES;
        if young || due || self.is_converged() {
            self.publish();
        }
    }

    /// Encodes the film, puts it into the outbox and wakes the window.
    fn publish(&mut self) {
        let converged = self.is_converged();
        let Some((job, renderer)) = self.job.as_ref().zip(self.renderer.as_mut()) else {
            return;
        };
        if !renderer.is_even() {
            return; // The pass under way makes them so, and shows them.
        }
        let Snapshot { settings, size, .. } = &job.request.snapshot;
        let shown = renderer.first.shown();
        let mut stats = FrameStats {
            generation: job.generation,
            size: *size,
            stride: shown.stride,
            samples: if job.stride == 1 {
                renderer.samples()
            } else {
                0
            },
            samples_wanted: settings.samples.max(1),
            converged,
            pass_millis: job.pass_millis,
            stage_millis: renderer.stage_millis,
            kept_bytes: renderer.first.kept_bytes(),
            pass_rays: job.pass_rays,
            counters: renderer.counters(),
            reshaded: renderer.first.reuses_hits(),
            passes: self.passes,
            threads: renderer.first.threads(),
            error: None,
            legend: None,
        };
        let size = shown.size.map(|n| n as usize);
        let buffer = || {
            let mut pixels = lock(&self.shared.outbox).spare.pop().unwrap_or_default();
            pixels.resize(size[0] * size[1], Color32::BLACK);
            pixels
        };
        let pictures = renderer.encode(&job.request, buffer);
        (stats.error, stats.legend) = (pictures.error, pictures.legend);
        let other = pictures.other.map(|pixels| ColorImage::new(size, pixels));
        let image = ColorImage::new(size, pictures.first);
        self.shown_at = Some(Instant::now());
        let is_awaited = {
            let mut outbox = lock(&self.shared.outbox);
            let frame = Frame {
                image,
                other,
                stats,
            };
            if let Some(unseen) = outbox.frame.replace(frame) {
                outbox.spare.push(unseen.image.pixels);
                outbox.spare.extend(unseen.other.map(|image| image.pixels));
            }
            outbox.awaited.is_some_and(|g| g <= stats.generation)
        };
        if is_awaited {
            self.shared.arrived.notify_one();
        } else {
            (self.shared.wake_window)();
        }
    }

    fn save(&mut self, path: &Path) {
        let Some((job, renderer)) = self.job.as_ref().zip(self.renderer.as_ref()) else {
            return;
        };
        let (samples, wanted) = (
            renderer.first.samples(),
            job.request.snapshot.settings.samples,
        );
        let note = match write_picture(path, &*renderer.first, job.request.display) {
            Ok(()) => RenderNote::Saved(format!(
                "Saved {} ({samples} of {wanted} samples)",
                path.display()
            )),
            Err(error) => RenderNote::Error(format!("Could not save: {error}")),
        };
        self.note(note);
    }

    fn note(&self, note: RenderNote) {
        lock(&self.shared.outbox).notes.push(note);
        self.shared.arrived.notify_one();
        (self.shared.wake_window)();
    }
}

/// Writes what is shown, view and all, or linear values without exposure if the name ends in `.exr`.
fn write_picture(
    path: &Path,
    renderer: &dyn PassRenderer,
    display: DisplaySettings,
) -> Result<(), SaveError> {
    let picture = renderer.picture();
    let size = [picture.width, picture.height];
    let ending = path.extension();
    if ending.is_some_and(|ending| ending.eq_ignore_ascii_case("exr")) {
        let linear: Vec<_> = picture.pixels.iter().map(|c| c.to_array()).collect();
        return write_exr(path, size, &linear);
    }
    let mut rgba = vec![[0; 4]; picture.pixels.len()];
    renderer.encode_shown_into(display.exposure_ev, &mut rgba);
    if let Some(records) = renderer.records().filter(|_| display.view != View::Picture)
        && let Some(legend) = Legend::of(display.view, &[&records])
    {
        legend.paint(&records, &mut rgba);
    }
    let rgb: Vec<_> = rgba.iter().map(|&[r, g, b, _]| [r, g, b]).collect();
    write_png(path, size, &rgb)
}

/// The command that tells the story of a pixel: as long as the scene was not edited, that very pixel's.
fn replay(snapshot: &Snapshot, [x, y]: [u32; 2]) -> String {
    let input = match &snapshot.scene.source {
        SceneSource::BuiltIn(name) => name.clone(),
        SceneSource::Model(path) | SceneSource::SceneFile(path) => path.display().to_string(),
    };
    let [width, height] = snapshot.size;
    let method = snapshot.settings.mapping.method.name();
    format!(
        "; pixel {x},{y}; replay: reliefscope probe '{input}' --size {width}x{height} --method {method} --pixel {x},{y}"
    )
}

/// What a panic said.
fn panic_text(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("no message")
}
