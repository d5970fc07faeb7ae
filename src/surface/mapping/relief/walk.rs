//! The exact walk: where a straight ray first meets the bilinear relief.

use super::axis::Axis;
use super::field::ReliefField;
use super::parabola::first_not_above;
use super::ray::ReliefRay;
use super::typed::Typed;
use super::walk_lanes::{Stored, walk_all};
use crate::math::simd::SimdLevel;
use crate::texture::{StoredHeights, Wrap};

/// What a walk came to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Walk {
    /// τ at which the ray first is not on its side of the relief any more; `None` if it always is.
    pub at: Option<f64>,
    /// Pyramid nodes and cells looked at.
    pub steps: u32,
    /// Whether it was given up after more steps than any walk should need.
    pub capped: bool,
}

impl Walk {
    /// No step was taken.
    pub const NONE: Self = Self {
        at: None,
        steps: 0,
        capped: false,
    };
}

/// No walk takes more steps, whatever the map: some milliseconds. Seen from 89.99°, a relief ten tiles deep is left
/// after less than half of them, a step or two for each of 57,000 tiles.
pub(super) const STEP_CAP: f64 = 524_288.0;

impl ReliefField<'_> {
    /// Where the ray first meets the bilinear relief.
    ///
    /// Never misses and never stops early, at any angle: cells are counted in integers, parameters are
    /// doubles, and squares are skipped only where the ray passes clear of all of their corners. A sinking
    /// ray from above that ends at or below the lowest displacement always hits. Rays that reach farther
    /// than 10¹² texels are not walked.
    ///
    /// Source: max mipmaps, Tevs et al. 2008.
    #[must_use]
    pub fn walk(&self, ray: &ReliefRay) -> Walk {
        if !ray.is_near() {
            return Walk::NONE;
        }
        match self.stored {
            StoredHeights::U16(all) => self.with(all).walk(ray),
            StoredHeights::F32(all) => self.with(all).walk(ray),
        }
    }

    /// Steps after which the walk of a ray is given up.
    #[must_use]
    pub fn step_cap(&self, ray: &ReliefRay) -> u32 {
        step_cap(self.layout.size, ray)
    }

    /// [`Self::walk`] for many rays, with the instructions of `level`: the same bits.
    ///
    /// # Panics
    /// If there are not as many places for what came of them as rays.
    pub fn walk_all(&self, level: SimdLevel, rays: &[ReliefRay], walks: &mut [Walk]) {
        assert_eq!(rays.len(), walks.len(), "one place for each ray");
        match self.stored {
            StoredHeights::U16(all) => walk_all(&self.with(all), level, rays, walks),
            StoredHeights::F32(all) => walk_all(&self.with(all), level, rays, walks),
        }
    }
}

impl<T: Stored> Typed<'_, T> {
    pub(super) fn walk(&self, ray: &ReliefRay) -> Walk {
        let sign = ray.side.sign();
        let line = [ray.z * sign, ray.z_rate * sign];
        let inv_sinking = 1.0 / -line[1];
        let end = ray.end;
        let mut x = Axis::new(self.layout.size[0], ray.start[0], ray.rate[0]);
        let mut y = Axis::new(self.layout.size[1], ray.start[1], ray.rate[1]);
        let cap = self.step_cap(ray);
        let top = self.layout.top;
        let mut level = start_level(ray, top);
        let mut tau = 0.0_f64;
        let mut steps = 0;
        let found = loop {
            steps += 1;
            if steps > cap {
                break None;
            }
            let (span_x, span_y) = (x.span(level), y.span(level));
            let (exit_x, exit_y) = (x.exit(span_x), y.exit(span_y));
            let exit = larger(smaller(exit_x, exit_y), tau);
            let leave = smaller(exit, end);
            let lowest = line[0] + line[1] * if line[1] > 0.0 { tau } else { leave };
            let high = if self.wrap == Wrap::Repeat {
                self.high(level, [x.local(), y.local()], sign)
            } else {
                let columns = x.cells(span_x, self.wrap);
                self.highest(level, columns, y.cells(span_y, self.wrap), sign)
            };
            if lowest <= high {
                if level > 0 {
                    level -= 1;
                    if line[1] < 0.0 {
                        // Down to the highest point nothing is in the way.
                        let down = (line[0] - high) * inv_sinking;
                        tau = larger(tau, smaller(down, leave));
                    }
                    x.settle(span_x, tau);
                    y.settle(span_y, tau);
                    continue;
                }
                let line = [line[0] + line[1] * tau, line[1]];
                if let Some(after) = self.meet_cell((&x, &y), tau, leave - tau, line, sign) {
                    break Some(tau + after);
                }
            }
            if exit >= end {
                break None;
            }
            tau = exit;
            let leaves_square = if exit_x <= exit_y {
                y.settle(span_y, tau);
                x.cross(span_x, level)
            } else {
                x.settle(span_x, tau);
                y.cross(span_y, level)
            };
            if leaves_square && level < top {
                level += 1;
            }
        };
        Walk {
            at: found,
            steps,
            capped: steps > cap,
        }
    }

    /// How far after `tau`, but not beyond `len`, the ray meets the bilinear patch of its cell. `line` is
    /// its displacement there and the change per unit of τ, seen from the side of `sign`.
    #[inline(always)]
    fn meet_cell(
        &self,
        (x, y): (&Axis, &Axis),
        tau: f64,
        len: f64,
        line: [f64; 2],
        sign: f64,
    ) -> Option<f64> {
        let [h00, h10, h01, h11] = self.corners(x, y).map(|h| h * sign);
        let (fx, fy) = (x.fraction(tau), y.fraction(tau));
        let (dx, dy) = (x.rate(), y.rate());
        let (hx, hy, twist) = (h10 - h00, h01 - h00, h00 - h10 - h01 + h11);
        // Ray minus patch: a σ² + b σ + c.
        let a = -twist * dx * dy;
        let b = line[1] - (hx * dx + hy * dy + twist * (fx * dy + fy * dx));
        let c = line[0] - (h00 + hx * fx + hy * fy + twist * fx * fy);
        first_not_above(a, b, c, len)
    }

    /// Twice what the finest possible walk could take, ups and downs included.
    fn step_cap(&self, ray: &ReliefRay) -> u32 {
        step_cap(self.layout.size, ray)
    }
}

/// Steps after which a walk over a map of that size is given up.
fn step_cap(size: [u32; 2], ray: &ReliefRay) -> u32 {
    let [w, h] = size.map(f64::from);
    let tiles = 2.0 + (ray.rate[0] * ray.end / w).abs() + (ray.rate[1] * ray.end / h).abs();
    let cap = 64.0 + 4.0 * (w + h) * tiles;
    cap.min(STEP_CAP) as u32
}

/// The smaller of two numbers that are not NaN, in one instruction.
#[inline(always)]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The larger.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The level whose squares are about a quarter as wide as the way to go: finer ones would be climbed, coarser ones
/// descended, for nothing.
#[inline(always)]
fn start_level(ray: &ReliefRay, top: u32) -> u32 {
    // Close to the relief that it leaves, a ray passes no square of more than one cell.
    if ray.z_rate * ray.side.sign() > 0.0 {
        return 0;
    }
    let texels = ray.rate[0].abs().max(ray.rate[1].abs()) * ray.end;
    let level = (texels.min(1e9) as u32).max(1).ilog2();
    level.saturating_sub(2).min(top)
}
