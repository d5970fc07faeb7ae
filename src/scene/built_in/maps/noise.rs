//! Hashes and periodic gradient noise.

use super::dual::Dual;

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

    /// Value and derivatives in lattice coordinates.
    fn lattice(&self, x: f64, y: f64) -> [f64; 3] {
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let [px, py] = self.period;
        let i0 = (x.floor() as i64).rem_euclid(px as i64) as usize;
        let j0 = (y.floor() as i64).rem_euclid(py as i64) as usize;
        let i1 = if i0 + 1 == px { 0 } else { i0 + 1 };
        let j1 = if j0 + 1 == py { 0 } else { j0 + 1 };
        let g = |i: usize, j: usize| self.gradients[j * px + i];
        let (ga, gb, gc, gd) = (g(i0, j0), g(i1, j0), g(i0, j1), g(i1, j1));
        let dot = |g: [f64; 2], dx: f64, dy: f64| g[0] * dx + g[1] * dy;
        let a = dot(ga, fx, fy);
        let b = dot(gb, fx - 1.0, fy);
        let c = dot(gc, fx, fy - 1.0);
        let d = dot(gd, fx - 1.0, fy - 1.0);
        let ([s, ds], [t, dt]) = (fade(fx), fade(fy));
        let twist = a - b - c + d;
        let blend = |k: usize| {
            ga[k]
                + (gb[k] - ga[k]) * s
                + (gc[k] - ga[k]) * t
                + (ga[k] - gb[k] - gc[k] + gd[k]) * s * t
        };
        [
            a + (b - a) * s + (c - a) * t + twist * s * t,
            blend(0) + ((b - a) + twist * t) * ds,
            blend(1) + ((c - a) + twist * s) * dt,
        ]
    }
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
}
