//! For each texel, how wide a cone on it may be: what relaxed cone stepping reads.

use std::f64::consts::TAU;

use rayon::prelude::*;

use super::grid::Floats;
use super::{Grid, HeightMap, Wrap};
use crate::math::{Real, V2};

/// Directions in which the neighbourhood of a texel is looked through.
const AZIMUTHS: u32 = 16;

/// Texels that are looked through in each direction, at the most.
const REACH: u32 = 64;

/// One width a texel: texels of radius per unit of stored height over the apex.
///
/// A cone of that width on the texel's height is entered from above by no ray that crosses the relief more
/// than once inside. Found along sixteen directions and up to 64 texels away, at whole texels: a thin
/// feature between two directions may be missed, as in the source.
///
/// Source: Policarpo & Oliveira 2007, whose search over all pairs of texels this shortens: on the profile
/// along one direction, a ray from above the apex leaves the relief where the profile comes out under the
/// line from the start to there.
#[derive(Debug, Clone, PartialEq)]
pub struct ConeMap(Grid<f32>);

impl ConeMap {
    /// The cones of a map that goes on beyond its border by `wrap`. `inverted` turns the heights over first.
    /// Takes seconds for a million texels; runs on the current rayon pool.
    #[must_use]
    pub fn new(map: &HeightMap, wrap: Wrap, inverted: bool) -> Self {
        let (w, h) = (map.width(), map.height());
        let heights = Heights::new(map, wrap, inverted);
        let offsets: Vec<Vec<[i32; 2]>> = (0..AZIMUTHS).map(offsets).collect();
        let rows = (0..h).into_par_iter().flat_map_iter(|y| {
            let (heights, offsets) = (&heights, &offsets);
            (0..w).map(move |x| heights.width(x, y, offsets))
        });
        Self(Grid::new(w, h, rows.collect()))
    }

    /// The narrowest of the cones on the four texels around `st`.
    #[must_use]
    #[inline(always)]
    pub fn narrowest<F: Real>(&self, st: V2<F>, wrap: Wrap) -> F {
        let cell = self.0.cell(st, wrap);
        let [[a], [b], [c], [d]] = self.0.corners(&cell, Floats);
        a.smaller(b).smaller(c.smaller(d))
    }

    /// Heap bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(self.0.texels())
    }
}

/// Texels at whole distances along one direction.
fn offsets(azimuth: u32) -> Vec<[i32; 2]> {
    let (sin, cos) = (f64::from(azimuth) * TAU / f64::from(AZIMUTHS)).sin_cos();
    let at = |r: u32| [cos, sin].map(|c| (c * f64::from(r)).round() as i32);
    (1..=REACH).map(at).collect()
}

/// Heights between 0 and 1 (the map's own range), copied for speed.
struct Heights {
    values: Vec<f32>,
    top: f32,
    /// Columns from `REACH` before the first to `REACH` after the last, brought into the picture.
    columns: Vec<usize>,
    /// Starts of rows alike.
    rows: Vec<usize>,
}

impl Heights {
    fn new(map: &HeightMap, wrap: Wrap, inverted: bool) -> Self {
        let size = [map.width(), map.height()];
        let sign = if inverted { -1.0 } else { 1.0 };
        let values: Vec<f32> = (0..size[1])
            .flat_map(|y| (0..size[0]).map(move |x| (x, y)))
            .map(|(x, y)| map.texel(x, y) * sign)
            .collect();
        let top = values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let around = |n: u32, step: usize| {
            let reach = i64::from(REACH);
            let places = -reach..i64::from(n) + reach;
            places
                .map(|i| wrap.index(i, n) as usize * step)
                .collect::<Vec<_>>()
        };
        Self {
            values,
            top,
            columns: around(size[0], 1),
            rows: around(size[1], size[0] as usize),
        }
    }

    /// The height so many texels from a place in the picture, at most `REACH`.
    #[inline]
    fn at(&self, [x, y]: [u32; 2], [dx, dy]: [i32; 2]) -> f32 {
        let near = |k: u32, d: i32| (k + REACH).wrapping_add_signed(d) as usize;
        self.values[self.rows[near(y, dy)] + self.columns[near(x, dx)]]
    }

    /// The width of the cone on one texel.
    fn width(&self, x: u32, y: u32, offsets: &[Vec<[i32; 2]>]) -> f32 {
        let apex = self.at([x, y], [0, 0]);
        // Rounded up, so that a cone on the highest texel has a width.
        let depth = (self.top - apex).max(f32::MIN_POSITIVE);
        let mut width = (REACH as f32 / depth).min(1e9);
        for line in offsets {
            let mut before = apex;
            for (r, &offset) in (1_u32..).zip(line) {
                let distance = r as f32;
                if distance >= width * depth {
                    break;
                }
                let height = self.at([x, y], offset);
                // On the line from over the apex to this texel, one texel before it.
                let line_before = self.top + (height - self.top) * ((distance - 1.0) / distance);
                if height > apex && before > line_before {
                    width = width.min(distance / (height - apex));
                }
                before = height;
            }
        }
        width
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(w: u32, h: u32, value: impl Fn(u32, u32) -> f32) -> HeightMap {
        let texels = (0..h).flat_map(|y| (0..w).map(move |x| (x, y)));
        HeightMap::F32(Grid::new(w, h, texels.map(|(x, y)| value(x, y)).collect()))
    }

    #[test]
    fn over_a_flat_map_cones_are_as_wide_as_they_may_be() {
        let cones = ConeMap::new(&map(4, 4, |_, _| 0.5), Wrap::Repeat, false);
        assert!(cones.0.texels().iter().all(|&w| w >= REACH as f32));
    }

    #[test]
    fn behind_a_wall_no_cone_reaches_past_what_a_ray_could_see_twice() {
        // A wall two texels thick whose far side has a step at half height: a ray over the wall's foot that
        // enters the wall comes out over the step.
        let profile = [0.0, 0.0, 1.0, 1.0, 0.5, 0.5, 0.0, 0.0];
        let heights = map(64, 1, |x, _| *profile.get(x as usize).unwrap_or(&0.0));
        let cones = ConeMap::new(&heights, Wrap::Clamp, false);
        // From texel 0, the line to texel 4 at height 0.5 passes inside the wall: 4 texels at 0.5.
        let width = cones.0.at(0, 0);
        assert!((width - 8.0).abs() < 1e-6, "{width}");
        // Turned over, the wall is a trench and the foot is the top.
        let inverted = ConeMap::new(&heights, Wrap::Clamp, true);
        assert!(inverted.0.at(0, 0) > 1e6);
    }
}
