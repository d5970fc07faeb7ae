//! Hashes and periodic gradient noise.

use super::dual::Dual;
use super::exact::{floor, wrap};

/// 64 well-mixed bits of a lattice point (finaliser of splitmix64; Steele, Lea & Flood 2014).
#[must_use]
pub const fn hash(ix: i64, iy: i64, seed: u64) -> u64 {
    let mut x = (ix as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)
        ^ (iy as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f)
        ^ seed.wrapping_mul(0x1656_67b1_9e37_79f9);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// The hash as a number in `[0, 1)`.
#[must_use]
pub fn unit([ix, iy]: [i64; 2], seed: u64) -> f64 {
    (hash(ix, iy, seed) >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
}

/// Perlin's gradient noise (1985, with the quintic fade of 2002) that repeats after one tile.
#[derive(Debug)]
pub struct GradientNoise {
    period: [usize; 2],
    gradients: Vec<[f64; 2]>,
}

impl GradientNoise {
    /// Noise with `period` lattice cells across and up the tile, each at least 1.
    #[must_use]
    pub fn new(period: [usize; 2], seed: u64) -> Self {
        let [px, py] = period;
        let points = (0..py).flat_map(|y| (0..px).map(move |x| [x as i64, y as i64]));
        Self {
            period,
            gradients: points
                .map(|p| unit_vector(unit(p, seed) * 2.0 - 1.0))
                .collect(),
        }
    }

    /// Value in about `[−0.7, 0.7]` with mean 0, at tile coordinates of any range.
    #[must_use]
    pub fn at(&self, u: Dual, v: Dual) -> Dual {
        let x = u * self.period[0] as f64;
        let y = v * self.period[1] as f64;
        Dual::chain2(x, y, self.lattice(x.value, y.value))
    }

    /// The same without derivatives, for colours.
    #[must_use]
    pub fn value(&self, u: f64, v: f64) -> f64 {
        let [px, py] = self.period;
        let cell = self.cell(u * px as f64, v * py as f64);
        let [a, b, c, d] = cell.ramps;
        let (s, t) = (fade(cell.fx)[0], fade(cell.fy)[0]);
        a + (b - a) * s + (c - a) * t + (a - b - c + d) * s * t
    }

    /// Value and derivatives in lattice coordinates.
    fn lattice(&self, x: f64, y: f64) -> [f64; 3] {
        let cell = self.cell(x, y);
        let ([a, b, c, d], [ga, gb, gc, gd]) = (cell.ramps, cell.gradients);
        let ([s, ds], [t, dt]) = (fade(cell.fx), fade(cell.fy));
        let twist = a - b - c + d;
        let st = s * t;
        let blend = |k: usize| {
            ga[k] + (gb[k] - ga[k]) * s + (gc[k] - ga[k]) * t + (ga[k] - gb[k] - gc[k] + gd[k]) * st
        };
        [
            a + (b - a) * s + (c - a) * t + twist * st,
            blend(0) + ((b - a) + twist * t) * ds,
            blend(1) + ((c - a) + twist * s) * dt,
        ]
    }

    #[inline]
    fn cell(&self, x: f64, y: f64) -> Cell {
        let (i, j) = (floor(x), floor(y));
        let (fx, fy) = (x - i as f64, y - j as f64);
        let [px, py] = self.period;
        let (i0, j0) = (wrap(i, px), wrap(j, py));
        let i1 = if i0 + 1 == px { 0 } else { i0 + 1 };
        let j1 = if j0 + 1 == py { 0 } else { j0 + 1 };
        let g = |i: usize, j: usize| self.gradients[j * px + i];
        let gradients = [g(i0, j0), g(i1, j0), g(i0, j1), g(i1, j1)];
        let ramp = |g: [f64; 2], dx: f64, dy: f64| g[0] * dx + g[1] * dy;
        Cell {
            fx,
            fy,
            gradients,
            ramps: [
                ramp(gradients[0], fx, fy),
                ramp(gradients[1], fx - 1.0, fy),
                ramp(gradients[2], fx, fy - 1.0),
                ramp(gradients[3], fx - 1.0, fy - 1.0),
            ],
        }
    }
}

/// Corner gradients and ramps of one lattice cell, and the place in it.
struct Cell {
    fx: f64,
    fy: f64,
    gradients: [[f64; 2]; 4],
    ramps: [f64; 4],
}

/// Perlin's quintic and its derivative.
fn fade(t: f64) -> [f64; 2] {
    [
        t * t * t * (t * (t * 6.0 - 15.0) + 10.0),
        30.0 * t * t * (t - 1.0) * (t - 1.0),
    ]
}

/// A unit vector for a parameter in `[−1, 1)`, by the rational circle: no sine, so no platform differs.
fn unit_vector(parameter: f64) -> [f64; 2] {
    // The two halves of the range take the two halves of the circle.
    let t = parameter.abs() * 2.0 - 1.0;
    let scale = 1.0 / (1.0 + t * t);
    let (c, s) = ((1.0 - t * t) * scale, 2.0 * t * scale);
    if parameter < 0.0 { [-c, -s] } else { [c, s] }
}

/// A sum of octaves of gradient noise, each twice as fine and half as strong.
#[derive(Debug)]
pub struct Fbm {
    octaves: Vec<(GradientNoise, f64)>,
}

impl Fbm {
    /// Octaves starting with `period` cells across and up the tile.
    #[must_use]
    pub fn new(period: [usize; 2], octaves: usize, seed: u64) -> Self {
        let total = 2.0 - 0.5_f64.powi(octaves as i32 - 1);
        let octave = |o: usize| {
            let noise = GradientNoise::new(period.map(|p| p << o), seed + o as u64);
            (noise, 0.5_f64.powi(o as i32) / total)
        };
        Self {
            octaves: (0..octaves).map(octave).collect(),
        }
    }

    /// Weighted mean of the octaves, in about `[−0.6, 0.6]` with mean 0.
    #[must_use]
    pub fn at(&self, u: Dual, v: Dual) -> Dual {
        self.octaves
            .iter()
            .fold(Dual::constant(0.0), |sum, (noise, weight)| {
                sum + noise.at(u, v) * *weight
            })
    }

    /// The same without derivatives, for colours.
    #[must_use]
    pub fn value(&self, u: f64, v: f64) -> f64 {
        self.octaves
            .iter()
            .map(|(noise, weight)| noise.value(u, v) * weight)
            .sum()
    }
}
