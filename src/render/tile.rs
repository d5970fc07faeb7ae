//! One tile: its share of the film, its cached hits, and its passes.

use super::film::Film;
use super::known_shadows::KnownShadows;
use super::sites::Sites;
use super::stages::camera::Pixels;
use super::stages::{
    self, Column, Column3, PLACES, Scratch, Stage, StageWatch, camera, film, trace,
};
use super::{Counters, Frame, PassEnd, PixelRecord};
use crate::geometry::HitLanes;

/// Pixels along one side of a tile. 32 measured well: enough rays to amortise a stage, small enough to
/// stay in the second-level cache.
pub const TILE_SIZE: u32 = 32;

/// A rectangle of pixels with everything that is kept of them between passes.
#[derive(Debug)]
pub struct Tile {
    /// Its pixels in the picture.
    pub pixels: Pixels,
    /// Columns and rows, at most [`TILE_SIZE`].
    pub size: [u32; 2],
    /// Samples in every sum.
    pub samples: u32,
    /// Counts since the snapshot was taken.
    pub counters: Counters,
    /// Sums of linear samples; anything before the first.
    pub sums: Box<Column3>,
    /// Hits of the first samples, if there is one.
    pub hits: Box<HitLanes<PLACES>>,
    /// What the first samples found, by place; empty unless they were asked for.
    pub records: Vec<PixelRecord>,
    knows_hits: bool,
    /// Shadows at the hits of the first samples.
    shadows: KnownShadows,
}

impl Tile {
    /// An empty tile.
    #[must_use]
    pub fn new(corner: [u32; 2], size: [u32; 2], stride: u32) -> Self {
        let active = Sites::get().within(size[0], size[1]);
        Self {
            pixels: Pixels {
                corner,
                stride,
                active,
            },
            size,
            samples: 0,
            counters: Counters::default(),
            sums: Box::new([Column::splat(0.0); 3]),
            hits: Box::new(HitLanes::none()),
            records: Vec::new(),
            knows_hits: false,
            shadows: KnownShadows::default(),
        }
    }

    /// Forgets the picture; and the hits too, unless they are still true.
    pub fn reset(&mut self, keep_hits: bool) {
        self.samples = 0;
        self.records = Vec::new();
        self.counters = Counters::ZERO;
        self.knows_hits &= keep_hits;
    }

    /// Renders the next sample of every pixel. The first takes hits over from a coarser film of the same
    /// picture, if there is one. A tile that is left off on the way stays as it was, but for its hits.
    pub fn sample(
        &mut self,
        frame: &Frame<'_>,
        coarser: Option<&Film>,
        scratch: &mut Scratch,
        watch: &mut impl StageWatch,
    ) -> PassEnd {
        watch.begin();
        let before = self.counters;
        let (index, counters) = (self.samples, &mut self.counters);
        let Scratch { hits, known, work } = scratch;
        camera::camera_rays(frame, &self.pixels, index, &mut work.rays);
        work.radiance = [Column::splat(0.0); 3];
        // The first sample's hits are kept for the next snapshot, which may only shade them anew.
        let hits = if index == 0 { &mut self.hits } else { hits };
        let is_unknown = index > 0 || !self.knows_hits;
        let traces = is_unknown || (watch.wants_every_ray() && frame.displaced.is_some());
        if index == 0 && is_unknown {
            self.shadows.forget();
        }
        if traces {
            known.clear();
            // Hits on displaced surfaces are more than a cached hit can tell.
            let coarser = coarser.filter(|_| index == 0 && frame.displaced.is_none());
            if let Some(film) = coarser {
                film.hits_for(&self.pixels, known);
            }
            for &(place, _) in &*known {
                work.rays.lanes.t_max.0[place] = -1.0;
            }
            counters.camera_rays += self.pixels.active.count() - known.len() as u64;
            let tracer = &mut work.tracer;
            trace::closest_hits(frame, &mut work.rays, hits, tracer, counters);
            for &(place, hit) in &*known {
                hits.put(place, hit);
            }
            self.knows_hits = true;
        } else {
            work.tracer.clear();
        }
        watch.traced(&self.pixels.active, &work.tracer);
        watch.done(Stage::Trace);
        // Where surfaces are displaced, points and what is in their way change together; who counts rays wants all.
        let keeps_shadows = index == 0
            && frame.displaced.is_none()
            && frame.charts.is_none()
            && !watch.wants_every_ray();
        if keeps_shadows {
            work.shadows.known = Some(std::mem::take(&mut self.shadows));
        }
        work.shade_hits(frame, hits, stages::mirrors_at(frame, 0), counters, watch);
        if let Some(shadows) = work.shadows.known.take() {
            self.shadows = shadows;
        }
        scratch.follow_mirrors(frame, counters, watch);
        if frame.is_left_off() {
            self.counters = before;
            self.knows_hits &= index > 0 || !traces;
            return PassEnd::Stopped;
        }
        counters.non_finite += film::add(
            frame,
            &self.pixels.active,
            index == 0,
            &scratch.work.radiance,
            &mut self.sums,
        );
        self.samples += 1;
        watch.done(Stage::Resolve);
        PassEnd::Complete
    }
}
