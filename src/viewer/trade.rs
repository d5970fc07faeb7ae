//! Measures the scene on show on a thread of its own, as long as somebody looks at the figures.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use crate::measure::trade::{Glance, glance};
use crate::render::{Progressive, Snapshot};
use crate::scene::{RenderSettings, Scene};
use crate::surface::mapping::Method;

/// How long nothing may change before it is measured, seconds: a drag is not worth it.
const REST_SECS: f64 = 0.5;

/// What is measured and what was.
#[derive(Debug, Default)]
pub struct TradeMeter {
    /// What was seen last, and since when nothing of it has changed.
    seen: Option<(Subject, f64)>,
    running: Option<Running>,
    done: Option<(Subject, Result<Glance, String>)>,
    /// Whether anybody has looked since the last frame.
    is_looked_at: bool,
}

/// Everything that the figures depend on.
#[derive(Debug, Clone)]
struct Subject {
    scene: Arc<Scene>,
    settings: RenderSettings,
    size: [u32; 2],
}

impl PartialEq for Subject {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.scene, &other.scene)
            && self.settings == other.settings
            && self.size == other.size
    }
}

impl Subject {
    /// The method on show is only one of those that are measured.
    fn of(snapshot: &Snapshot) -> Self {
        let mut settings = (*snapshot.settings).clone();
        if settings.mapping.method != Method::RelaxedCone {
            settings.mapping.method = Method::None;
        }
        settings.samples = 1;
        Self {
            scene: Arc::clone(&snapshot.scene),
            settings,
            size: snapshot.size,
        }
    }

    fn snapshot(&self) -> Snapshot {
        Snapshot {
            scene: Arc::clone(&self.scene),
            settings: Arc::new(self.settings.clone()),
            size: self.size,
        }
    }
}

/// A measurement under way.
#[derive(Debug)]
struct Running {
    subject: Subject,
    stop: Arc<AtomicBool>,
    result: Receiver<Result<Option<Glance>, String>>,
}

impl Drop for Running {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

impl TradeMeter {
    /// The figures of a snapshot, or the last ones while newer are measured; errors are one line. Whoever looks must
    /// look in every frame: `now` is the window's time in seconds, `ctx` is woken when there is something new.
    pub fn look(
        &mut self,
        ctx: &egui::Context,
        snapshot: &Snapshot,
        (threads, now): (usize, f64),
    ) -> Option<&Result<Glance, String>> {
        self.is_looked_at = true;
        let subject = Subject::of(snapshot);
        if self.seen.as_ref().is_none_or(|(seen, _)| *seen != subject) {
            self.seen = Some((subject.clone(), now));
        }
        self.collect();
        let is = |known: Option<&Subject>| known == Some(&subject);
        if self.running.is_some() && !is(self.running.as_ref().map(|r| &r.subject)) {
            self.running = None;
        }
        if self.running.is_none() && !is(self.done.as_ref().map(|d| &d.0)) {
            let since = self.seen.as_ref().map_or(now, |(_, since)| *since);
            let rest = since + REST_SECS - now;
            if rest <= 0.0 {
                self.begin(ctx, subject, threads);
            } else {
                ctx.request_repaint_after(std::time::Duration::from_secs_f64(rest));
            }
        }
        self.done.as_ref().map(|(_, found)| found)
    }

    /// Whether figures are on their way.
    #[must_use]
    pub const fn is_running(&self) -> bool {
        self.running.is_some()
    }

    /// Must be called after each frame: stops what nobody has looked at in it.
    pub fn end_frame(&mut self) {
        if !std::mem::take(&mut self.is_looked_at) {
            self.running = None;
        }
    }

    fn collect(&mut self) {
        let Some(running) = &self.running else { return };
        let found = match running.result.try_recv() {
            Ok(Ok(None)) | Err(TryRecvError::Empty) => return,
            Ok(Ok(Some(glance))) => Ok(glance),
            Ok(Err(why)) => Err(why),
            Err(TryRecvError::Disconnected) => Err("measuring ended early".to_owned()),
        };
        self.done = Some((running.subject.clone(), found));
        self.running = None;
    }

    fn begin(&mut self, ctx: &egui::Context, subject: Subject, threads: usize) {
        let (sender, result) = channel();
        let stop = Arc::new(AtomicBool::new(false));
        let (stopped, snapshot, ctx) = (Arc::clone(&stop), subject.snapshot(), ctx.clone());
        let measured = move || {
            let mut renderer = Progressive::new(threads).map_err(|error| error.to_string())?;
            let stop = || stopped.load(Ordering::Relaxed);
            glance(&snapshot, &mut renderer, &stop).map_err(|error| error.to_string())
        };
        let thread = std::thread::Builder::new().name("measure".into());
        let spawned = thread.spawn(move || {
            // Nobody listens any more if something else is to be measured by now.
            let _ = sender.send(measured());
            ctx.request_repaint();
        });
        match spawned {
            Ok(_) => {
                self.running = Some(Running {
                    subject,
                    stop,
                    result,
                });
            }
            Err(error) => self.done = Some((subject, Err(error.to_string()))),
        }
    }
}
