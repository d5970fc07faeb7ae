//! One tile: its share of the film, its cached hits, and its passes.

use super::sites::{Sites, film_place};
use super::stages::{self, Column, Column3, PLACES, Places, Scratch, camera, film, trace};
use super::{Counters, Frame};
use crate::geometry::HitLanes;
use crate::math::LinearRgb;

/// Pixels along one side of a tile. 32 measured well: enough rays to amortise a stage, small enough to
/// stay in the second-level cache.
pub const TILE_SIZE: u32 = 32;

/// A rectangle of pixels with everything that is kept of them between passes, listed block by block
/// ([`Sites`]).
#[derive(Debug)]
pub struct Tile {
    /// Column of the left edge.
    pub x0: u32,
    /// Row of the upper edge.
    pub y0: u32,
    /// Columns, at most [`TILE_SIZE`].
    pub width: u32,
    /// Rows, at most [`TILE_SIZE`].
    pub height: u32,
    /// Samples in every sum; the first may be partly there, see `first_stride`.
    pub samples: u32,
    /// If previews were rendered: sums of pixels whose column and row are multiples of this hold the
    /// first sample already. Other sums hold anything before `samples` is 1.
    pub first_stride: Option<u32>,
    /// Counts since the snapshot was taken.
    pub counters: Counters,
    /// Places of a full pass that lie in the picture.
    pub inside: Places,
    /// Sums of linear samples.
    sums: Box<Column3>,
    /// Hits of the first samples of pixels whose column and row are multiples of `known`.
    hits: Box<HitLanes<PLACES>>,
    known: Option<u32>,
}

impl Tile {
    /// An empty tile.
    #[must_use]
    pub fn new(x0: u32, y0: u32, width: u32, height: u32) -> Self {
        Self {
            x0,
            y0,
            width,
            height,
            samples: 0,
            first_stride: None,
            counters: Counters::default(),
            inside: Sites::all().places(|x, y| x < width && y < height),
            sums: Box::new([Column::splat(0.0); 3]),
            hits: Box::new(HitLanes::none()),
            known: None,
        }
    }

    /// Forgets the picture; and the hits too, unless they are still true.
    pub fn reset(&mut self, keep_hits: bool) {
        self.samples = 0;
        self.first_stride = None;
        self.counters = Counters::default();
        if !keep_hits {
            self.known = None;
        }
    }

    /// Sum of the samples of the pixel in column `x` and row `y` of the tile.
    #[must_use]
    pub fn sum(&self, x: u32, y: u32) -> LinearRgb {
        let place = film_place(x, y) as usize;
        let [r, g, b] = &*self.sums;
        LinearRgb::new(r.0[place], g.0[place], b.0[place])
    }

    /// Whether a preview of this stride would show anything new.
    #[must_use]
    pub fn wants_preview(&self, stride: u32) -> bool {
        self.samples == 0 && self.first_stride.is_none_or(|done| done > stride)
    }

    /// Renders the first sample of every pixel whose column and row are multiples of `stride`.
    pub fn preview(&mut self, frame: &Frame<'_>, stride: u32, scratch: &mut Scratch) {
        self.shade(frame, 0, stride, scratch);
        self.first_stride = Some(stride);
    }

    /// Renders the next sample of every pixel.
    pub fn sample(&mut self, frame: &Frame<'_>, scratch: &mut Scratch) {
        self.shade(frame, self.samples, 1, scratch);
        self.samples += 1;
    }

    fn shade(&mut self, frame: &Frame<'_>, index: u32, stride: u32, scratch: &mut Scratch) {
        let mut counters = Counters::default();
        let sites = Sites::of_stride(stride);
        let active = self.pixels(sites, index);
        let corner = [self.x0, self.y0];
        camera::camera_rays(
            frame,
            sites,
            corner,
            (active, index),
            &mut scratch.work.rays,
        );
        scratch.work.radiance = [Column::splat(0.0); 3];
        if index == 0 {
            self.first_hits(frame, sites, stride, scratch, &mut counters);
        } else {
            counters.camera_rays += active.count();
            trace::closest_hits(frame, &scratch.work.rays, &mut scratch.hits, &mut counters);
        }
        let mirrors = stages::mirrors_at(frame, 0);
        scratch
            .work
            .shade_hits(frame, &scratch.hits, mirrors, &mut counters);
        scratch.follow_mirrors(frame, &mut counters);
        let radiance = &mut scratch.work.radiance;
        self.add(frame, sites, active, index, radiance, &mut counters);
        self.counters += counters;
    }

    /// The places of the pixels that still want sample `index`.
    fn pixels(&self, sites: &Sites, index: u32) -> Places {
        let done = if index == 0 { self.first_stride } else { None };
        if sites.count == PLACES && done.is_none() {
            return self.inside;
        }
        sites.places(|x, y| {
            let is_done = done.is_some_and(|d| x.is_multiple_of(d) && y.is_multiple_of(d));
            x < self.width && y < self.height && !is_done
        })
    }

    /// Hits of the first samples: from the cache where it knows them, else traced and remembered.
    fn first_hits(
        &mut self,
        frame: &Frame<'_>,
        sites: &Sites,
        stride: u32,
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) {
        let Scratch { hits, work } = scratch;
        let rays = &mut work.rays;
        let known = match self.known {
            None => Places::EMPTY,
            Some(known) if known <= stride => rays.active,
            Some(known) => {
                let known = sites.places(|x, y| x.is_multiple_of(known) && y.is_multiple_of(known));
                known & rays.active
            }
        };
        let unknown = rays.active & !known;
        if !unknown.is_empty() {
            for place in known.iter() {
                rays.lanes.t_max.0[place] = -1.0;
            }
            counters.camera_rays += unknown.count();
            trace::closest_hits(frame, rays, hits, counters);
        }
        if sites.count == PLACES && unknown == self.inside {
            self.hits.clone_from(hits);
        } else if sites.count == PLACES && known == self.inside {
            hits.clone_from(&self.hits);
        } else {
            for place in unknown.iter() {
                copy_hit(
                    hits,
                    place,
                    &mut self.hits,
                    sites.film_place.0[place] as usize,
                );
            }
            for place in known.iter() {
                copy_hit(&self.hits, sites.film_place.0[place] as usize, hits, place);
            }
        }
        self.known = Some(self.known.map_or(stride, |known| known.min(stride)));
    }

    /// Adds samples to the film; one that is not finite counts as black.
    fn add(
        &mut self,
        frame: &Frame<'_>,
        sites: &Sites,
        active: Places,
        index: u32,
        radiance: &mut Column3,
        counters: &mut Counters,
    ) {
        let finite = film::drop_non_finite(frame, sites.count, active, radiance);
        counters.non_finite += (active & !finite).count();
        if sites.count == PLACES {
            film::add(frame, active, index == 0, radiance, &mut self.sums);
            return;
        }
        for place in active.iter() {
            let film_place = sites.film_place.0[place] as usize;
            for (sum, x) in self.sums.iter_mut().zip(&*radiance) {
                sum.0[film_place] = x.0[place];
            }
        }
    }
}

fn copy_hit(from: &HitLanes<PLACES>, at: usize, to: &mut HitLanes<PLACES>, place: usize) {
    to.prim.0[place] = from.prim.0[at];
    to.u.0[place] = from.u.0[at];
    to.v.0[place] = from.v.0[at];
}
