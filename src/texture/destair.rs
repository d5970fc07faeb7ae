//! Smooths the stairs that few levels make of gentle slopes, without moving any height beyond its own level.

use rayon::prelude::*;

use super::{Grid, HeightMap, Wrap};

/// Texels to the farthest neighbours that are looked at: stairs wider than this keep some of their edge.
const WIDEST: u32 = 64;
/// Times that each distance is gone over.
const ROUNDS: usize = 4;
/// A step of more levels than this is an edge of the relief and not of the numbers.
const EDGE: f32 = 1.5;
/// No step is taken for larger: a map of two heights is a drawing, not a relief with stairs.
const LARGEST_STEP: f32 = 1.0 / 32.0;

/// The map with its stairs smoothed: an estimate of the heights before they were rounded to levels `step`
/// apart (see [`Levels`](super::Levels)).
///
/// No height moves by more than half a step, which is as far as rounding may have moved it. Means over
/// neighbours at 64 texels down to one (weights 1, 2, 1 along rows, then columns) are taken again and again,
/// each time brought back within half a step of what was stored. Where either neighbour is more than one
/// and a half steps away there is an edge, and nothing is smoothed across it.
///
/// The data are altered: a map whose stairs are meant should be left alone. With a `step` of 0 it is.
#[must_use]
pub fn destaired(map: &HeightMap, step: f32, wrap: Wrap) -> HeightMap {
    let step = step.min(LARGEST_STEP);
    if !(step > 0.0) {
        return map.clone();
    }
    let (w, h) = (map.width(), map.height());
    let texels = (0..h).flat_map(|y| (0..w).map(move |x| (x, y)));
    let stored: Vec<f32> = texels.map(|(x, y)| map.texel(x, y)).collect();
    let smoothed = smooth(&stored, [w, h], step, wrap);
    match map {
        HeightMap::F32(_) => HeightMap::F32(Grid::new(w, h, smoothed)),
        HeightMap::U16(grid) => {
            // Rounding to 16 bits must not leave the level either.
            let most = (f64::from(step) * 0.5 * 65_535.0) as i32;
            let texels = grid.texels().iter().zip(&smoothed).map(|(&own, &smooth)| {
                let moved = (smooth * 65_535.0).round() as i32 - i32::from(own);
                (i32::from(own) + moved.clamp(-most, most)).clamp(0, 65_535) as u16
            });
            HeightMap::U16(Grid::new(w, h, texels.collect()))
        }
    }
}

fn smooth(stored: &[f32], [w, h]: [u32; 2], step: f32, wrap: Wrap) -> Vec<f32> {
    let (mut from, mut to) = (stored.to_vec(), vec![0.0; stored.len()]);
    let mut distance = WIDEST;
    while distance > 0 {
        // A neighbour beyond half the map says nothing about this place.
        if distance == 1 || 4 * distance <= w.max(h) {
            for _ in 0..ROUNDS {
                for axis in [Axis::Rows, Axis::Columns] {
                    mean(&from, &mut to, [w, h], (distance, axis, wrap), step);
                    let bounded = to.par_iter_mut().zip(stored);
                    bounded.for_each(|(t, s)| *t = t.clamp(s - step * 0.5, s + step * 0.5));
                    std::mem::swap(&mut from, &mut to);
                }
            }
        }
        distance /= 2;
    }
    from
}

#[derive(Clone, Copy)]
enum Axis {
    Rows,
    Columns,
}

/// `(a + 2b + c) / 4` of each texel b and its neighbours along an axis.
fn mean(
    from: &[f32],
    to: &mut [f32],
    [w, h]: [u32; 2],
    (distance, axis, wrap): (u32, Axis, Wrap),
    step: f32,
) {
    let row = |y: u32| &from[y as usize * w as usize..][..w as usize];
    let around = |i: u32, n: u32| {
        let (i, distance) = (i64::from(i), i64::from(distance));
        [wrap.index(i - distance, n), wrap.index(i + distance, n)]
    };
    let near = EDGE * step;
    let smoothed = |[a, b, c]: [f32; 3]| {
        if (a - b).abs() <= near && (c - b).abs() <= near {
            (a + c) * 0.25 + b * 0.5
        } else {
            b
        }
    };
    let rows = to.par_chunks_exact_mut(w as usize).enumerate();
    rows.for_each(|(y, to)| match axis {
        Axis::Rows => {
            let own = row(y as u32);
            for (x, to) in to.iter_mut().enumerate() {
                let [a, c] = around(x as u32, w).map(|x| own[x as usize]);
                *to = smoothed([a, own[x], c]);
            }
        }
        Axis::Columns => {
            let [above, below] = around(y as u32, h).map(row);
            let texels = above.iter().zip(row(y as u32)).zip(below).zip(to);
            for (((&a, &b), &c), to) in texels {
                *to = smoothed([a, b, c]);
            }
        }
    });
}
