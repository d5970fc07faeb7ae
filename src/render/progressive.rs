//! A picture that gets better pass by pass.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use super::film::{Film, Picture, lock};
use super::recorder::{Recorder, Yardsticks, uv_yardsticks};
use super::stages::{Scratch, StageWatch};
use super::{Counters, Frame, Recording, Records, Stop};
use crate::math::{LinearRgb, SrgbEncoder};
use crate::scene::{RenderSettings, Scene};
use crate::surface::mapping::MappingSettings;
use crate::texture::MapRole;

/// What to render: everything a pass depends on besides its number.
#[derive(Debug, Clone)]
pub struct Snapshot {
    /// Geometry and maps.
    pub scene: Arc<Scene>,
    /// Everything a slider can move.
    pub settings: Arc<RenderSettings>,
    /// Columns and rows of the picture, each at least 1.
    pub size: [u32; 2],
}

/// How a pass ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PassEnd {
    /// Every tile is done.
    Complete,
    /// Stopped early: some tiles have the pass, some do not. The next call of the same kind goes on
    /// where this one stopped.
    Stopped,
}

/// What a renderer has to show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shown {
    /// Columns and rows.
    pub size: [u32; 2],
    /// 1 for the picture itself; otherwise a preview of every `stride`-th pixel in both directions.
    pub stride: u32,
}

/// Renders a snapshot in passes on a worker pool of its own.
///
/// Pass `k` is a pure function of the snapshot and `k`: preview history, thread count and stopping leave
/// no trace in the finished picture. Previews are pictures of their own, from the same rays as every
/// `stride`-th pixel's first sample, whose hits they hand on.
#[derive(Debug)]
pub struct Progressive {
    pool: rayon::ThreadPool,
    snapshot: Option<Snapshot>,
    film: Film,
    /// One for each stride but 1, made when first wanted.
    previews: [Option<Film>; 3],
    scratch: Vec<Mutex<Scratch>>,
    reuses_hits: bool,
    recording: Recording,
}

impl Progressive {
    /// The preview strides that [`preview`](Self::preview) takes.
    pub const PREVIEW_STRIDES: [u32; 4] = [1, 2, 4, 8];

    /// A renderer with its own pool; 0 threads means one per core.
    ///
    /// # Errors
    /// If the system gives no threads.
    pub fn new(threads: usize) -> std::io::Result<Self> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|i| format!("trace-{i}"))
            .build()
            .map_err(std::io::Error::other)?;
        let scratch = (0..pool.current_num_threads())
            .map(|_| Mutex::default())
            .collect();
        Ok(Self {
            pool,
            snapshot: None,
            film: Film::new([0; 2], 1),
            previews: [const { None }; 3],
            scratch,
            reuses_hits: false,
            recording: Recording::Nothing,
        })
    }

    /// Says what first samples leave in [`Self::records`], from the next [`Self::start`] on. It changes no pixel.
    pub const fn record(&mut self, what: Recording) {
        self.recording = what;
    }

    /// Takes the next snapshot and starts its picture afresh. Hits of the last one stay if they cannot
    /// have changed: same scene, camera, size and cut-outs.
    pub fn start(&mut self, snapshot: Snapshot) {
        let snapshot = Snapshot {
            size: snapshot.size.map(|n| n.max(1)),
            ..snapshot
        };
        let last = self.snapshot.as_ref();
        self.reuses_hits = last.is_some_and(|last| same_visibility(last, &snapshot));
        if self.film.size == snapshot.size {
            self.film.reset(self.reuses_hits);
            for preview in self.previews.iter_mut().flatten() {
                preview.reset(self.reuses_hits);
            }
        } else {
            self.film = Film::new(snapshot.size, 1);
            self.previews = [const { None }; 3];
        }
        self.snapshot = Some(snapshot);
    }

    /// Renders the first sample of every `stride`-th pixel in both directions (`stride` is one of
    /// [`PREVIEW_STRIDES`](Self::PREVIEW_STRIDES), others are rounded up to one; 1 is the first pass). Does
    /// nothing if there is something as fine. `stop` is polled before each tile.
    pub fn preview(&mut self, stride: u32, stop: &(dyn Fn() -> bool + Sync)) -> PassEnd {
        let largest = Self::PREVIEW_STRIDES[Self::PREVIEW_STRIDES.len() - 1];
        let stride = stride.clamp(1, largest).next_power_of_two();
        if self.snapshot.is_none() || self.finest().is_some_and(|film| film.stride <= stride) {
            return PassEnd::Complete;
        }
        let size = self.film.size;
        let preview = (stride.trailing_zeros() as usize).checked_sub(1);
        if let Some(i) = preview {
            self.previews[i].get_or_insert_with(|| Film::new(size, stride));
        }
        let film = preview.and_then(|i| self.previews[i].as_ref());
        self.render::<()>(film.unwrap_or(&self.film), 1, stop).0
    }

    /// Renders the next sample of every pixel; `stop` is polled before each tile. Does nothing once the
    /// picture has converged.
    pub fn pass(&mut self, stop: &(dyn Fn() -> bool + Sync)) -> PassEnd {
        self.watched_pass::<()>(stop).0
    }

    /// [`pass`](Self::pass) with a listener in each worker that is told of its stages.
    pub fn watched_pass<W: StageWatch + Default + Send>(
        &mut self,
        stop: &(dyn Fn() -> bool + Sync),
    ) -> (PassEnd, Vec<W>) {
        let wanted = self.snapshot.as_ref().map_or(0, samples_wanted);
        // Tiles that a stopped pass had done already are ahead.
        let goal = (self.samples() + 1).min(wanted);
        self.render(&self.film, goal, stop)
    }

    /// Brings all tiles of a film to `goal` samples. `stop` is asked only before tiles that need one, so
    /// that passes stopped again and again still come to an end; and within tiles of displaced surfaces, one of
    /// which may take seconds.
    fn render<W: StageWatch + Default + Send>(
        &self,
        film: &Film,
        goal: u32,
        stop: &(dyn Fn() -> bool + Sync),
    ) -> (PassEnd, Vec<W>) {
        let Some(snapshot) = &self.snapshot else {
            return (PassEnd::Complete, Vec::new());
        };
        let mut frame = Frame::new(snapshot);
        // Not for previews: what moves may have changed before it is done.
        if film.stride == 1 && film.samples() < goal {
            self.pool.install(|| frame.make_ready(stop));
        }
        frame.stop = Stop::when(stop);
        let recording = self.recording;
        let yardsticks =
            (recording != Recording::Nothing).then(|| Yardsticks::new(snapshot, recording));
        let coarser = self.finest().filter(|known| known.stride > film.stride);
        let next = AtomicUsize::new(0);
        let done = AtomicUsize::new(0);
        let watches = self.pool.broadcast(|context| {
            let mut watch = W::default();
            // One worker per slot and one slot per worker: these locks are never waited for.
            let mut scratch = self.scratch[context.index()]
                .lock()
                .unwrap_or_else(PoisonError::into_inner);
            while let Some(&i) = film.order.get(next.fetch_add(1, Ordering::Relaxed)) {
                let mut tile = lock(&film.tiles[i]);
                if tile.samples < goal {
                    if stop() {
                        break;
                    }
                    let end = match yardsticks.as_ref().filter(|_| tile.samples == 0) {
                        None => tile.sample(&frame, coarser, &mut scratch, &mut watch),
                        Some(yardsticks) => {
                            let mut recorder = Recorder::new(yardsticks);
                            let mut both = (&mut watch, &mut recorder);
                            let end = tile.sample(&frame, coarser, &mut scratch, &mut both);
                            if end == PassEnd::Complete {
                                tile.records = recorder.finish(&scratch.work.radiance);
                            }
                            end
                        }
                    };
                    if end == PassEnd::Stopped {
                        break;
                    }
                }
                done.fetch_add(1, Ordering::Relaxed);
            }
            watch
        });
        let end = if done.into_inner() == film.order.len() {
            PassEnd::Complete
        } else {
            PassEnd::Stopped
        };
        (end, watches)
    }

    /// The snapshot being rendered.
    #[must_use]
    pub const fn snapshot(&self) -> Option<&Snapshot> {
        self.snapshot.as_ref()
    }

    /// Samples that every pixel has.
    #[must_use]
    pub fn samples(&self) -> u32 {
        self.film.samples()
    }

    /// Whether every pixel has all its samples.
    #[must_use]
    pub fn is_converged(&self) -> bool {
        let wanted = self.snapshot.as_ref().map_or(0, samples_wanted);
        self.samples() >= wanted
    }

    /// Exact counts since [`start`](Self::start), previews included.
    #[must_use]
    pub fn counters(&self) -> Counters {
        let mut sum = self.film.counters();
        for preview in self.previews.iter().flatten() {
            sum += preview.counters();
        }
        sum
    }

    /// Heap bytes of the micro-triangles that are kept of displaced surfaces.
    #[must_use]
    pub fn kept_bytes(&self) -> usize {
        let displaced = |snapshot: &Snapshot| snapshot.scene.displaced.last();
        let displacement = self.snapshot.as_ref().and_then(displaced);
        let micro = displacement.and_then(|displacement| displacement.micro(usize::MAX));
        micro.map_or(0, |micro| micro.bytes())
    }

    /// Whether hits of the snapshot before this one serve again, so that camera rays are saved.
    #[must_use]
    pub const fn reuses_hits(&self) -> bool {
        self.reuses_hits
    }

    /// Worker threads.
    #[must_use]
    pub fn threads(&self) -> usize {
        self.pool.current_num_threads()
    }

    /// What there is to show: the picture once every pixel has a sample, before that the finest preview.
    #[must_use]
    pub fn shown(&self) -> Shown {
        let film = self.finest().unwrap_or(&self.film);
        Shown {
            size: film.size,
            stride: film.stride,
        }
    }

    /// What the first samples of what is [`shown`](Self::shown) found; `None` unless they were
    /// [asked for](Self::record).
    #[must_use]
    pub fn records(&self) -> Option<Records> {
        let film = self.finest()?;
        let pixels = film.records();
        (!pixels.is_empty()).then(|| Records {
            size: film.size,
            pixels,
            yardsticks: self.snapshot.as_ref().map_or_else(Vec::new, uv_yardsticks),
        })
    }

    /// The finest film in which every pixel has a sample.
    fn finest(&self) -> Option<&Film> {
        let films = std::iter::once(&self.film).chain(self.previews.iter().flatten());
        films.into_iter().find(|film| film.samples() > 0)
    }

    /// The linear picture so far, without exposure; pixels of a preview stand for their neighbours.
    #[must_use]
    pub fn picture(&self) -> Picture {
        let mut picture = Picture::black(self.film.size);
        self.map_shown(&mut picture.pixels, |color| color);
        picture
    }

    /// Encodes the picture so far for the screen: opaque RGBA, row by row; pixels of a preview stand for
    /// their neighbours. Linear values are multiplied by `2^exposure_ev` first.
    ///
    /// # Panics
    /// If `rgba` does not have one entry per pixel.
    pub fn encode_into(&self, exposure_ev: f32, rgba: &mut [[u8; 4]]) {
        self.map_shown(rgba, encode(exposure_ev));
    }

    /// [`encode_into`](Self::encode_into) for what is [`shown`](Self::shown), at its own size.
    ///
    /// # Panics
    /// If `rgba` does not have one entry per pixel of it.
    pub fn encode_shown_into(&self, exposure_ev: f32, rgba: &mut [[u8; 4]]) {
        let film = self.finest().unwrap_or(&self.film);
        self.map_film(film, rgba, encode(exposure_ev));
    }

    /// Fills `out`, one entry for each pixel of the picture.
    fn map_shown<T: Copy + Send>(&self, out: &mut [T], f: impl Fn(LinearRgb) -> T + Sync) {
        let film = self.finest().unwrap_or(&self.film);
        if film.stride == 1 {
            self.map_film(film, out, f);
            return;
        }
        let [width, height] = self.film.size.map(|n| n as usize);
        assert_eq!(out.len(), width * height, "one entry per pixel");
        let (stride, columns) = (film.stride as usize, film.size[0] as usize);
        let mut coarse = vec![f(LinearRgb::BLACK); columns * film.size[1] as usize];
        self.map_film(film, &mut coarse, f);
        for (y, row) in out.chunks_exact_mut(width).enumerate() {
            let coarse = &coarse[y / stride * columns..];
            for (pixels, &value) in row.chunks_mut(stride).zip(coarse) {
                pixels.fill(value);
            }
        }
    }

    fn map_film<T: Copy + Send>(
        &self,
        film: &Film,
        out: &mut [T],
        f: impl Fn(LinearRgb) -> T + Sync,
    ) {
        let [width, height] = film.size.map(|n| n as usize);
        assert_eq!(out.len(), width * height, "one entry per pixel");
        if !out.is_empty() {
            self.pool.install(|| film.map_into(out, &f));
        }
    }
}

/// From linear light to what a screen takes.
fn encode(exposure_ev: f32) -> impl Fn(LinearRgb) -> [u8; 4] + Sync {
    let factor = exposure_ev.exp2();
    let encoder = SrgbEncoder::get();
    move |color| {
        let [r, g, b] = encoder.encode(color * factor);
        [r, g, b, 255]
    }
}

fn samples_wanted(snapshot: &Snapshot) -> u32 {
    snapshot.settings.samples.max(1)
}

/// Whether every camera ray of `a` hits the same in `b`.
fn same_visibility(a: &Snapshot, b: &Snapshot) -> bool {
    let cutouts = |s: &Snapshot| -> Vec<_> {
        s.settings
            .materials
            .iter()
            .map(|m| m.map(MapRole::Opacity).cloned())
            .collect()
    };
    let displaced = |s: &Snapshot| {
        let mapping = &s.settings.mapping;
        let heights = s.settings.materials.iter().map(|m| {
            let map = m.map(MapRole::Height).cloned();
            (map, m.amplitude, m.default_amplitude, m.midlevel)
        });
        mapping.displaces().then(|| {
            let MappingSettings {
                amplitude,
                midlevel,
                weld_seams,
                ..
            } = *mapping;
            (amplitude, midlevel, weld_seams, heights.collect::<Vec<_>>())
        })
    };
    // Where reliefs are cut off, every setting of the mapping counts.
    let cut = |s: &Snapshot| {
        let mapping = s.settings.mapping;
        (mapping.cut_at_border).then(|| (mapping, s.settings.materials.clone()))
    };
    Arc::ptr_eq(&a.scene, &b.scene)
        && cut(a) == cut(b)
        && a.size == b.size
        && a.settings.camera == b.settings.camera
        && cutouts(a) == cutouts(b)
        && displaced(a) == displaced(b)
}
