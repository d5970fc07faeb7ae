//! The rendering thread: what is replaced, what is finished, when it sleeps, what a panic does.

use std::io;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use reliefscope::render::{Counters, PassEnd, Picture, Shown, Snapshot};
use reliefscope::viewer::worker::{
    Compare, ErrorView, FirstPass, Frame, PassRenderer, Refinement, RenderNote, RenderRequest,
    RenderWorker,
};

use reliefscope::measure::error_map::ErrorMetric;
use reliefscope::scene::DisplaySettings;
use reliefscope::surface::mapping::Method;

use crate::support::{QuadScene, edited};

/// Longer than any machine needs; only a hang takes it.
const PATIENCE: Duration = Duration::from_secs(60);

/// What the fake renderer was told.
#[derive(Debug, Clone, PartialEq)]
enum Event {
    /// `start` with so many samples wanted, which tells snapshots apart.
    Start(u32),
    Preview(u32, PassEnd),
    Pass(PassEnd),
}

/// Counts instead of tracing. A pass waits at the gate if there is one, then asks whether to stop.
struct Fake {
    log: Arc<Mutex<Vec<Event>>>,
    arrived: Sender<()>,
    gate: Option<Arc<Mutex<Receiver<()>>>>,
    samples: u32,
    stride: u32,
    snapshot: Option<Snapshot>,
    alive: Arc<AtomicUsize>,
}

impl Drop for Fake {
    fn drop(&mut self) {
        self.alive.fetch_sub(1, Ordering::SeqCst);
    }
}

impl Fake {
    fn finish(&self, stop: &(dyn Fn() -> bool + Sync)) -> PassEnd {
        // Nobody may be listening any more.
        let _ = self.arrived.send(());
        if let Some(gate) = &self.gate {
            let _ = gate.lock().expect("gate").recv_timeout(PATIENCE);
        }
        if stop() {
            PassEnd::Stopped
        } else {
            PassEnd::Complete
        }
    }

    fn wanted(&self) -> u32 {
        self.snapshot.as_ref().map_or(0, |s| s.settings.samples)
    }

    fn note(&self, event: Event) {
        self.log.lock().expect("log").push(event);
    }
}

impl PassRenderer for Fake {
    fn start(&mut self, snapshot: Snapshot) {
        assert!(snapshot.settings.samples != 13, "thirteen is unlucky");
        self.note(Event::Start(snapshot.settings.samples));
        self.samples = 0;
        self.snapshot = Some(snapshot);
    }
    fn preview(&mut self, stride: u32, stop: &(dyn Fn() -> bool + Sync)) -> PassEnd {
        let end = self.finish(stop);
        self.stride = stride;
        self.note(Event::Preview(stride, end));
        end
    }
    fn pass(&mut self, stop: &(dyn Fn() -> bool + Sync)) -> PassEnd {
        let end = self.finish(stop);
        self.samples += u32::from(end == PassEnd::Complete);
        self.note(Event::Pass(end));
        end
    }
    fn samples(&self) -> u32 {
        self.samples
    }
    fn picture(&self) -> Picture {
        Picture::black([2, 2])
    }
    fn shown(&self) -> Shown {
        Shown {
            size: self.snapshot.as_ref().map_or([1; 2], |s| s.size),
            stride: if self.samples == 0 { self.stride } else { 1 },
        }
    }
    fn encode_shown_into(&self, exposure_ev: f32, rgba: &mut [[u8; 4]]) {
        rgba.fill([exposure_ev as u8, 0, 0, 255]);
    }
    fn is_converged(&self) -> bool {
        self.samples >= self.wanted()
    }
    fn counters(&self) -> Counters {
        Counters::default()
    }
    fn reuses_hits(&self) -> bool {
        false
    }
    fn threads(&self) -> usize {
        1
    }
}

struct Bench {
    worker: RenderWorker,
    log: Arc<Mutex<Vec<Event>>>,
    arrived: Receiver<()>,
    open_gate: Sender<()>,
    woken: Receiver<()>,
    /// Renderers that exist.
    alive: Arc<AtomicUsize>,
}

impl Bench {
    fn new(gated: bool) -> Self {
        let log = Arc::new(Mutex::new(Vec::new()));
        let (arrived_sender, arrived) = channel();
        let (open_gate, gate) = channel();
        let (wake, woken) = channel();
        let gate = gated.then(|| Arc::new(Mutex::new(gate)));
        let for_factory = Arc::clone(&log);
        let alive = Arc::new(AtomicUsize::new(0));
        let count = Arc::clone(&alive);
        let factory = move |_threads| -> io::Result<Box<dyn PassRenderer>> {
            count.fetch_add(1, Ordering::SeqCst);
            Ok(Box::new(Fake {
                log: Arc::clone(&for_factory),
                arrived: arrived_sender.clone(),
                gate: gate.clone(),
                samples: 0,
                stride: 1,
                snapshot: None,
                alive: Arc::clone(&count),
            }))
        };
        let wake = Mutex::new(wake);
        let worker = RenderWorker::spawn(Box::new(factory), move || {
            // The test may be over.
            let _ = wake.lock().expect("wake").send(());
        })
        .expect("a thread");
        Self {
            worker,
            log,
            arrived,
            open_gate,
            woken,
            alive,
        }
    }

    fn wait_for_pass(&self) {
        self.arrived.recv_timeout(PATIENCE).expect("a pass begins");
    }

    /// Lets one pass through.
    fn release(&self) {
        self.open_gate.send(()).expect("the worker lives");
    }

    fn frame_where(&self, fits: impl Fn(&Frame) -> bool) -> Frame {
        loop {
            if let Some(frame) = self.worker.take_frame().filter(&fits) {
                return frame;
            }
            self.woken.recv_timeout(PATIENCE).expect("another frame");
        }
    }

    fn wait_for_sleep(&self) {
        for _ in 0..60_000 {
            if self.worker.is_asleep() {
                return;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        panic!("the worker never rests");
    }

    fn events(&self) -> Vec<Event> {
        self.log.lock().expect("log").clone()
    }
}

fn request(snapshot: &Snapshot, samples: u32) -> RenderRequest {
    RenderRequest {
        snapshot: edited(snapshot, |settings| settings.samples = samples),
        display: DisplaySettings::default(),
        first_pass: FirstPass::FullResolution,
        refinement: Refinement::Running,
        threads: 1,
        compare: None,
    }
}

fn quad() -> Snapshot {
    QuadScene::new().snapshot()
}

#[test]
fn a_newer_request_replaces_those_that_wait() {
    let (mut bench, quad) = (Bench::new(true), quad());
    bench.worker.submit(request(&quad, 1));
    bench.wait_for_pass();
    for samples in [2, 3, 1] {
        bench.worker.submit(request(&quad, samples));
    }
    bench.release();
    bench.wait_for_pass();
    bench.release();
    let frame = bench.frame_where(|frame| frame.stats.generation == 4);
    assert!(frame.stats.converged);
    let done = Event::Pass(PassEnd::Complete);
    let expected = [Event::Start(1), done.clone(), Event::Start(1), done];
    assert_eq!(bench.events(), expected);
}

#[test]
fn the_first_pass_completes_and_later_ones_give_way() {
    let (mut bench, quad) = (Bench::new(true), quad());
    bench.worker.submit(request(&quad, 9));
    bench.wait_for_pass();
    bench.release();
    // The second pass is under way when a newer request comes.
    bench.wait_for_pass();
    bench.worker.submit(request(&quad, 8));
    bench.release();
    // The first pass of that one is under way when the next comes.
    bench.wait_for_pass();
    bench.worker.submit(request(&quad, 1));
    bench.release();
    bench.wait_for_pass();
    bench.release();
    bench.frame_where(|frame| frame.stats.converged);
    let expected = [
        Event::Start(9),
        Event::Pass(PassEnd::Complete),
        Event::Pass(PassEnd::Stopped),
        Event::Start(8),
        Event::Pass(PassEnd::Complete),
        Event::Start(1),
        Event::Pass(PassEnd::Complete),
    ];
    assert_eq!(bench.events(), expected);
}

#[test]
fn a_preview_comes_first_and_completes() {
    let (mut bench, quad) = (Bench::new(true), quad());
    let adaptive = |samples| RenderRequest {
        first_pass: FirstPass::Adaptive,
        ..request(&quad, samples)
    };
    bench.worker.submit(adaptive(2));
    bench.wait_for_pass();
    bench.worker.submit(adaptive(1));
    bench.release();
    bench.wait_for_pass();
    for _ in 0..8 {
        bench.release();
    }
    bench.frame_where(|frame| frame.stats.converged);
    let events = bench.events();
    let first = Event::Preview(8, PassEnd::Complete);
    assert_eq!(events[..3], [Event::Start(2), first, Event::Start(1)]);
    let last = Event::Pass(PassEnd::Complete);
    assert_eq!(events.last(), Some(&last), "{events:?}");
}

#[test]
fn a_converged_picture_costs_nothing() {
    let (mut bench, quad) = (Bench::new(false), quad());
    bench.worker.submit(request(&quad, 5));
    let frame = bench.frame_where(|frame| frame.stats.converged);
    assert_eq!(frame.stats.samples, 5);
    bench.wait_for_sleep();
    let passes = |events: Vec<Event>| events.len() - 1;
    assert_eq!(passes(bench.events()), 5);
}

#[test]
fn paused_it_rests_after_the_first_sample_and_goes_on_later() {
    let (mut bench, quad) = (Bench::new(false), quad());
    let running = request(&quad, 3);
    let paused = RenderRequest {
        refinement: Refinement::Paused,
        ..running.clone()
    };
    bench.worker.submit(paused);
    bench.wait_for_sleep();
    let frame = bench.frame_where(|_| true);
    assert_eq!((frame.stats.samples, frame.stats.converged), (1, false));
    bench.worker.submit(running);
    let frame = bench.frame_where(|frame| frame.stats.converged);
    assert_eq!((frame.stats.samples, frame.stats.generation), (3, 2));
    let starts = bench
        .events()
        .iter()
        .filter(|e| matches!(e, Event::Start(_)))
        .count();
    assert_eq!(starts, 1, "nothing is rendered twice");
}

#[test]
fn exposure_encodes_again_without_rendering() {
    let (mut bench, quad) = (Bench::new(false), quad());
    let dark = request(&quad, 1);
    bench.worker.submit(dark.clone());
    bench.frame_where(|frame| frame.stats.converged);
    let before = bench.events();
    let bright = RenderRequest {
        display: DisplaySettings {
            exposure_ev: 4.0,
            ..DisplaySettings::default()
        },
        ..dark
    };
    bench.worker.submit(bright);
    let frame = bench.frame_where(|frame| frame.stats.generation == 2);
    assert_eq!(frame.image.pixels[0].r(), 4);
    assert!(frame.stats.converged);
    assert_eq!(bench.events(), before);
}

#[test]
fn a_panic_is_reported_and_the_next_request_works() {
    let (mut bench, quad) = (Bench::new(false), quad());
    bench.worker.submit(request(&quad, 13));
    bench.woken.recv_timeout(PATIENCE).expect("a message");
    let notes = bench.worker.take_notes();
    let [RenderNote::Error(text)] = &notes[..] else {
        panic!("{notes:?}");
    };
    for part in ["quad", "48x40", "thirteen is unlucky"] {
        assert!(text.contains(part), "{text}");
    }
    bench.wait_for_sleep();
    bench.worker.submit(request(&quad, 2));
    let frame = bench.frame_where(|frame| frame.stats.converged);
    assert_eq!(frame.stats.generation, 2);
}

fn against_exact(request: RenderRequest) -> RenderRequest {
    RenderRequest {
        compare: Some(Compare {
            method: Method::Exact,
            error: None,
        }),
        ..request
    }
}

#[test]
fn a_comparison_renders_both_pass_by_pass() {
    let (mut bench, quad) = (Bench::new(false), quad());
    bench.worker.submit(against_exact(request(&quad, 2)));
    let frame = bench.frame_where(|frame| frame.stats.converged);
    let other = frame.other.expect("a second picture");
    assert_eq!((other.size, frame.stats.samples), (frame.image.size, 2));
    let done = Event::Pass(PassEnd::Complete);
    let mut expected = vec![Event::Start(2); 2];
    expected.extend(vec![done; 4]);
    assert_eq!(bench.events(), expected);
    assert_eq!(bench.alive.load(Ordering::SeqCst), 2);
}

#[test]
fn a_method_beside_itself_is_rendered_once() {
    let (mut bench, quad) = (Bench::new(false), quad());
    let mut twins = against_exact(request(&quad, 2));
    twins.compare = twins.compare.map(|compare| Compare {
        method: quad.settings.mapping.method,
        ..compare
    });
    bench.worker.submit(twins);
    let frame = bench.frame_where(|frame| frame.stats.converged);
    let other = frame.other.expect("a second picture");
    assert_eq!(other.pixels, frame.image.pixels);
    let mut expected = vec![Event::Start(2)];
    expected.extend(vec![Event::Pass(PassEnd::Complete); 2]);
    assert_eq!(bench.events(), expected);
    assert_eq!(bench.alive.load(Ordering::SeqCst), 1);
}

#[test]
fn no_comparison_costs_nothing() {
    let (mut bench, quad) = (Bench::new(false), quad());
    let plain = request(&quad, 2);
    bench.worker.submit(plain.clone());
    let frame = bench.frame_where(|frame| frame.stats.converged);
    assert!(frame.other.is_none() && frame.stats.error.is_none());
    assert_eq!(bench.alive.load(Ordering::SeqCst), 1);
    bench.worker.submit(against_exact(plain.clone()));
    bench.frame_where(|frame| frame.stats.generation == 2 && frame.stats.converged);
    let before = bench.events();
    // Ended, it leaves nothing behind, and the picture stays as it is.
    bench.worker.submit(plain);
    let frame = bench.frame_where(|frame| frame.stats.generation == 3);
    assert!(frame.other.is_none() && frame.stats.converged);
    assert_eq!(bench.alive.load(Ordering::SeqCst), 1);
    assert_eq!(bench.events(), before);
}

#[test]
fn a_comparison_goes_on_where_it_was_stopped() {
    let (mut bench, quad) = (Bench::new(true), quad());
    let dark = against_exact(request(&quad, 2));
    bench.worker.submit(dark.clone());
    for _ in 0..3 {
        bench.wait_for_pass();
        bench.release();
    }
    // Both have a sample, the first has two, and now the second's is stopped by a change that keeps the samples.
    bench.wait_for_pass();
    bench.worker.submit(RenderRequest {
        display: DisplaySettings {
            exposure_ev: 4.0,
            ..DisplaySettings::default()
        },
        ..dark
    });
    bench.release();
    bench.wait_for_pass();
    bench.release();
    bench.frame_where(|frame| frame.stats.converged);
    let passes: Vec<_> = bench.events().into_iter().skip(2).collect();
    let (done, stopped) = (PassEnd::Complete, PassEnd::Stopped);
    let expected = [done, done, done, stopped, done].map(Event::Pass);
    assert_eq!(passes, expected);
}

#[test]
fn errors_are_measured_without_rendering_again() {
    let (mut bench, quad) = (Bench::new(false), quad());
    let plain = against_exact(request(&quad, 1));
    bench.worker.submit(plain.clone());
    bench.frame_where(|frame| frame.stats.converged);
    let before = bench.events();
    let mut errors = plain;
    let mut show = |bench: &mut Bench, metric| {
        errors.compare = errors.compare.map(|compare| Compare {
            error: Some(ErrorView {
                metric,
                full_scale: 1.0,
            }),
            ..compare
        });
        let generation = bench.worker.submit(errors.clone());
        let frame = bench
            .frame_where(|frame| frame.stats.generation == generation && frame.stats.converged);
        let error = frame.stats.error.expect("an error");
        // The fakes render the same.
        assert_eq!((error.metric, error.mean, error.p95), (metric, 0.0, 0.0));
    };
    for metric in [ErrorMetric::Luma, ErrorMetric::Flip] {
        show(&mut bench, metric);
    }
    assert_eq!(bench.events(), before);
    // Records are made of first samples only: both start once more, and that is enough for all that need them.
    for metric in [
        ErrorMetric::NormalAngle,
        ErrorMetric::Uv,
        ErrorMetric::Depth,
    ] {
        show(&mut bench, metric);
    }
    assert_eq!(bench.events(), [before.clone(), before].concat());
}
