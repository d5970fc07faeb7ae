//! A picture that gets better pass by pass.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use rayon::prelude::*;

use super::film::{Picture, centre_first, tiles_of};
use super::stages::Scratch;
use super::tile::{TILE_SIZE, Tile};
use super::{Counters, Frame};
use crate::math::{LinearRgb, SrgbEncoder};
use crate::scene::{RenderSettings, Scene};
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

/// Renders a snapshot in passes on a worker pool of its own.
///
/// Pass `k` is a pure function of the snapshot and `k`: preview history, thread count and stopping leave
/// no trace in the finished picture.
#[derive(Debug)]
pub struct Progressive {
    pool: rayon::ThreadPool,
    snapshot: Option<Snapshot>,
    tiles: Vec<Mutex<Tile>>,
    order: Vec<usize>,
    scratch: Vec<Mutex<Scratch>>,
    reuses_hits: bool,
}

impl Progressive {
    /// The preview strides that [`preview`](Self::preview) takes: divisors of a tile's side.
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
            tiles: Vec::new(),
            order: Vec::new(),
            scratch,
            reuses_hits: false,
        })
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
        if last.is_none_or(|last| last.size != snapshot.size) {
            let tiles = tiles_of(snapshot.size);
            self.order = centre_first(&tiles, snapshot.size);
            self.tiles = tiles.into_iter().map(Mutex::new).collect();
        } else {
            let keep = self.reuses_hits;
            self.pool.install(|| {
                self.tiles
                    .par_iter_mut()
                    .for_each(|t| tile_mut(t).reset(keep))
            });
        }
        self.snapshot = Some(snapshot);
    }

    /// Renders the first sample of every `stride`-th pixel in both directions (`stride` is one of
    /// [`PREVIEW_STRIDES`](Self::PREVIEW_STRIDES), others are rounded up to one). These pixels are those
    /// of the full pass, and their hits are kept for it. `stop` is polled before each tile.
    pub fn preview(&mut self, stride: u32, stop: &(dyn Fn() -> bool + Sync)) -> PassEnd {
        let largest = Self::PREVIEW_STRIDES[Self::PREVIEW_STRIDES.len() - 1];
        let stride = stride.clamp(1, largest).next_power_of_two();
        let wants = |tile: &Tile| tile.wants_preview(stride);
        self.for_each_tile(stop, &wants, &|tile, frame, scratch| {
            tile.preview(frame, stride, scratch)
        })
    }

    /// Renders the next sample of every pixel; `stop` is polled before each tile. Does nothing once the
    /// picture has converged.
    pub fn pass(&mut self, stop: &(dyn Fn() -> bool + Sync)) -> PassEnd {
        let Some(snapshot) = &self.snapshot else {
            return PassEnd::Complete;
        };
        let goal = (self.samples() + 1).min(snapshot.settings.samples.max(1));
        // Tiles that a stopped pass had done already are ahead.
        self.for_each_tile(stop, &|tile| tile.samples < goal, &Tile::sample)
    }

    /// Runs `work` on all tiles that want it. `stop` is asked only before tiles that do, so that passes
    /// stopped again and again still come to an end.
    fn for_each_tile(
        &self,
        stop: &(dyn Fn() -> bool + Sync),
        wants: &(dyn Fn(&Tile) -> bool + Sync),
        work: &(dyn Fn(&mut Tile, &Frame<'_>, &mut Scratch) + Sync),
    ) -> PassEnd {
        let Some(snapshot) = &self.snapshot else {
            return PassEnd::Complete;
        };
        let frame = Frame::new(snapshot);
        let next = AtomicUsize::new(0);
        let done = AtomicUsize::new(0);
        self.pool.broadcast(|context| {
            // One worker per slot and one slot per worker: these locks are never waited for.
            let mut scratch = self.scratch[context.index()]
                .lock()
                .unwrap_or_else(PoisonError::into_inner);
            while let Some(&i) = self.order.get(next.fetch_add(1, Ordering::Relaxed)) {
                let mut tile = lock(&self.tiles[i]);
                if wants(&tile) {
                    if stop() {
                        break;
                    }
                    work(&mut tile, &frame, &mut scratch);
                }
                done.fetch_add(1, Ordering::Relaxed);
            }
        });
        if done.into_inner() == self.order.len() {
            PassEnd::Complete
        } else {
            PassEnd::Stopped
        }
    }

    /// The snapshot being rendered.
    #[must_use]
    pub const fn snapshot(&self) -> Option<&Snapshot> {
        self.snapshot.as_ref()
    }

    /// Samples that every pixel has.
    #[must_use]
    pub fn samples(&self) -> u32 {
        self.tiles
            .iter()
            .map(|t| lock(t).samples)
            .min()
            .unwrap_or(0)
    }

    /// Whether every pixel has all its samples.
    #[must_use]
    pub fn is_converged(&self) -> bool {
        self.snapshot
            .as_ref()
            .is_none_or(|s| self.samples() >= s.settings.samples.max(1))
    }

    /// Exact counts since [`start`](Self::start).
    #[must_use]
    pub fn counters(&self) -> Counters {
        self.tiles
            .iter()
            .fold(Counters::default(), |mut sum, tile| {
                sum += lock(tile).counters;
                sum
            })
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

    /// The linear picture so far, without exposure.
    #[must_use]
    pub fn picture(&self) -> Picture {
        let Some(snapshot) = &self.snapshot else {
            return Picture::default();
        };
        let mut picture = Picture::black(snapshot.size);
        self.for_each_row(&mut picture.pixels, |color| color);
        picture
    }

    /// Encodes the picture so far for the screen: opaque RGBA, row by row. After only a preview its
    /// pixels stand for their neighbours. Linear values are multiplied by `2^exposure_ev` first.
    ///
    /// # Panics
    /// If `rgba` does not have one entry per pixel.
    pub fn encode_into(&self, exposure_ev: f32, rgba: &mut [[u8; 4]]) {
        let factor = exposure_ev.exp2();
        let encoder = SrgbEncoder::get();
        self.for_each_row(rgba, |color| {
            let [r, g, b] = encoder.encode(color * factor);
            [r, g, b, 255]
        });
    }

    /// Fills `out` row by row with what `f` makes of every pixel.
    fn for_each_row<T: Copy + Send>(&self, out: &mut [T], f: impl Fn(LinearRgb) -> T + Sync) {
        let Some(snapshot) = &self.snapshot else {
            return;
        };
        let [width, height] = snapshot.size.map(|n| n as usize);
        assert_eq!(out.len(), width * height, "one entry per pixel");
        let columns = width.div_ceil(TILE_SIZE as usize);
        let band = width * TILE_SIZE as usize;
        self.pool.install(|| {
            let bands = out.par_chunks_mut(band).zip(self.tiles.par_chunks(columns));
            bands.for_each(|(rows, tiles)| {
                tiles
                    .iter()
                    .for_each(|t| lock(t).write_rows(rows, width, &f))
            });
        });
    }
}

fn lock(tile: &Mutex<Tile>) -> std::sync::MutexGuard<'_, Tile> {
    // A panic in a worker leaves at worst a tile with a wrong colour, which the next start resets.
    tile.lock().unwrap_or_else(PoisonError::into_inner)
}

fn tile_mut(tile: &mut Mutex<Tile>) -> &mut Tile {
    tile.get_mut().unwrap_or_else(PoisonError::into_inner)
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
    Arc::ptr_eq(&a.scene, &b.scene)
        && a.size == b.size
        && a.settings.camera == b.settings.camera
        && cutouts(a) == cutouts(b)
}
