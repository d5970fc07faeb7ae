//! One tile: its share of the film, its cached hits, and the walk of its rays through the stages.

use super::sampling::pixel_sample;
use super::stages::{self, Mirrors, Scratch, trace};
use super::{Counters, Frame};
use crate::geometry::{Hit, Ray};
use crate::math::LinearRgb;

/// Pixels along one side of a tile. 32 measured well: enough rays to amortise a stage, small enough to
/// stay in the second-level cache.
pub const TILE_SIZE: u32 = 32;

/// Side of the blocks that a tile's pixels are listed in; divides [`TILE_SIZE`].
const BLOCK_SIZE: u32 = 8;

/// One pixel of a tile in a pass.
#[derive(Debug, Clone, Copy)]
pub struct TilePixel {
    /// Column in the picture.
    pub column: u32,
    /// Row in the picture.
    pub row: u32,
    /// Index in the tile's arrays.
    pub place: u32,
}

/// What the cache knows of a pixel's first camera ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CachedHit {
    /// Not traced yet.
    Unknown,
    /// It left the scene.
    Miss,
    /// It hit.
    Hit(Hit),
}

/// A rectangle of pixels with everything that is kept of them between passes.
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
    /// Sums of linear samples, row by row.
    pub sums: Vec<LinearRgb>,
    /// Samples in every sum; the first may be partly there, see `first_stride`.
    pub samples: u32,
    /// If previews were rendered: sums of pixels whose column and row are multiples of this hold the
    /// first sample already.
    pub first_stride: Option<u32>,
    /// Hits of the first samples.
    pub hits: Vec<CachedHit>,
    /// Counts since the snapshot was taken.
    pub counters: Counters,
}

impl Tile {
    /// An empty tile.
    #[must_use]
    pub fn new(x0: u32, y0: u32, width: u32, height: u32) -> Self {
        let count = width as usize * height as usize;
        Self {
            x0,
            y0,
            width,
            height,
            sums: vec![LinearRgb::BLACK; count],
            samples: 0,
            first_stride: None,
            hits: vec![CachedHit::Unknown; count],
            counters: Counters::default(),
        }
    }

    /// Forgets the picture; and the hits too, unless they are still true.
    pub fn reset(&mut self, keep_hits: bool) {
        self.sums.fill(LinearRgb::BLACK);
        self.samples = 0;
        self.first_stride = None;
        self.counters = Counters::default();
        if !keep_hits {
            self.hits.fill(CachedHit::Unknown);
        }
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

    /// Lists the pixels that a pass renders, in blocks of 8×8 so that 64 rays in a row are neighbours.
    fn list_pixels(&self, index: u32, stride: u32, pixels: &mut Vec<TilePixel>) {
        let done = if index == 0 { self.first_stride } else { None };
        let is_done = |column: u32, row: u32| {
            done.is_some_and(|d| column.is_multiple_of(d) && row.is_multiple_of(d))
        };
        let block = BLOCK_SIZE * stride;
        pixels.clear();
        for y_block in (0..self.height).step_by(block as usize) {
            for x_block in (0..self.width).step_by(block as usize) {
                let (y_end, x_end) = (
                    (y_block + block).min(self.height),
                    (x_block + block).min(self.width),
                );
                for y in (y_block..y_end).step_by(stride as usize) {
                    for x in (x_block..x_end).step_by(stride as usize) {
                        let (column, row) = (self.x0 + x, self.y0 + y);
                        if !is_done(column, row) {
                            pixels.push(TilePixel {
                                column,
                                row,
                                place: y * self.width + x,
                            });
                        }
                    }
                }
            }
        }
    }

    fn shade(&mut self, frame: &Frame<'_>, index: u32, stride: u32, scratch: &mut Scratch) {
        let mut counters = Counters::default();
        let mut pixels = std::mem::take(&mut scratch.pixels);
        self.list_pixels(index, stride, &mut pixels);
        scratch.queue.clear();
        for (slot, pixel) in pixels.iter().enumerate() {
            let [sx, sy] = pixel_sample([pixel.column, pixel.row], index);
            let dir = frame
                .camera
                .direction(pixel.column as f32 + sx, pixel.row as f32 + sy);
            scratch.queue.push(
                Ray {
                    origin: frame.camera.origin,
                    dir,
                },
                slot as u32,
                1.0,
            );
        }
        scratch.radiance.clear();
        scratch.radiance.resize(pixels.len(), LinearRgb::BLACK);
        if index == 0 {
            self.first_hits(frame, &pixels, scratch, &mut counters);
        } else {
            counters.camera_rays += scratch.queue.rays.len() as u64;
            stages::trace_queue(frame, scratch, &mut counters);
        }
        walk(frame, scratch, &mut counters);
        for (pixel, &sample) in pixels.iter().zip(&scratch.radiance) {
            if sample.is_finite() {
                self.sums[pixel.place as usize] += sample;
            } else {
                counters.non_finite += 1;
            }
        }
        self.counters += counters;
        scratch.pixels = pixels;
    }

    /// Hits of the first samples: from the cache where it knows them, else traced and remembered.
    fn first_hits(
        &mut self,
        frame: &Frame<'_>,
        pixels: &[TilePixel],
        scratch: &mut Scratch,
        counters: &mut Counters,
    ) {
        let Scratch {
            queue,
            next,
            t_max,
            hits,
            ..
        } = scratch;
        next.clear();
        for (slot, pixel) in pixels.iter().enumerate() {
            if self.hits[pixel.place as usize] == CachedHit::Unknown {
                next.push(queue.rays[slot], slot as u32, 1.0);
            }
        }
        counters.camera_rays += next.rays.len() as u64;
        trace::closest_hits(frame, &next.rays, t_max, hits, counters);
        for (hit, &slot) in hits.iter().zip(&next.slots) {
            self.hits[pixels[slot as usize].place as usize] =
                hit.map_or(CachedHit::Miss, CachedHit::Hit);
        }
        hits.clear();
        hits.extend(
            pixels
                .iter()
                .map(|pixel| match self.hits[pixel.place as usize] {
                    CachedHit::Hit(hit) => Some(hit),
                    CachedHit::Miss | CachedHit::Unknown => None,
                }),
        );
    }
}

/// Walks the queue whose first hits are known through all bounces: a queue per bounce, no recursion.
fn walk(frame: &Frame<'_>, scratch: &mut Scratch, counters: &mut Counters) {
    for bounce in 0..=frame.max_bounces {
        let mirrors = if bounce == frame.max_bounces {
            Mirrors::End
        } else {
            Mirrors::Follow
        };
        if bounce > 0 {
            counters.mirror_rays += scratch.queue.rays.len() as u64;
            stages::trace_queue(frame, scratch, counters);
        }
        stages::shade_hits(frame, mirrors, scratch, counters);
        if scratch.next.rays.is_empty() {
            break;
        }
        std::mem::swap(&mut scratch.queue, &mut scratch.next);
    }
}
