//! Grown, woven, flowing and coated surfaces.

use super::cells::Cells;
use super::dual::Dual;
use super::exact::floor;
use super::noise::{Fbm, unit};
use super::paint::Paint;
use super::{Pattern, Texel};

/// Smooth swell under a celadon glaze: a handful of plane waves, nothing else.
#[derive(Debug)]
pub struct Waves {
    cloud: Fbm,
}

impl Waves {
    /// Whole waves across and up the tile, amplitude, phase in turns.
    const TRAINS: [([f64; 2], f64, f64); 5] = [
        ([3.0, 1.0], 1.0, 0.0),
        ([-2.0, 4.0], 0.6, 0.207),
        ([5.0, -3.0], 0.35, 0.334),
        ([1.0, 7.0], 0.25, 0.064),
        ([8.0, 5.0], 0.12, 0.637),
    ];
    const DEEP: Paint = Paint::hex(0x2f6f70);
    const CREST: Paint = Paint::hex(0x9cc9b8);

    /// Prepares the noise.
    #[must_use]
    pub fn new() -> Self {
        Self {
            cloud: Fbm::new([4, 4], 3, 801),
        }
    }
}

impl Pattern for Waves {
    fn texel(&self, u: Dual, v: Dual) -> Texel {
        let sum = Self::TRAINS
            .iter()
            .fold(Dual::constant(0.0), |sum, ([k, l], a, phase)| {
                sum + (u * *k + v * *l + *phase).sin_turns() * *a
            });
        let height = sum * (0.5 / 2.32) + 0.5;
        // Glaze runs off crests and gathers in hollows.
        let thin = height.value + 0.25 * self.cloud.value(u.value, v.value);
        Texel {
            height,
            paint: Self::DEEP.mix(Self::CREST, thin),
        }
    }
}

/// Rings around the middle of the tile, as a drop leaves them in still water.
#[derive(Debug)]
pub struct Ripple;

impl Ripple {
    const LOW: Paint = Paint::hex(0x2b5574);
    const HIGH: Paint = Paint::hex(0x8fc0d2);
}

impl Pattern for Ripple {
    fn texel(&self, u: Dual, v: Dual) -> Texel {
        let (x, y) = (u.fract() - 0.5, v.fract() - 0.5);
        let r = (x.squared() + y.squared() + 1e-5).sqrt();
        let calm = 1.0 - r.smoothstep(0.36, 0.495);
        let rings = (r * 11.0).cos_turns() * calm * (r * 2.6).exp_neg();
        let height = rings * 0.47 + 0.5;
        Texel {
            height,
            paint: Self::LOW.mix(Self::HIGH, 0.15 + 0.7 * height.value),
        }
    }
}

/// Basket work: flat canes over and under each other.
#[derive(Debug)]
pub struct Weave {
    /// Fibres of canes that run up the tile, and of those that run across.
    fibres: [Fbm; 2],
}

impl Weave {
    const COUNT: f64 = 12.0;
    const PALETTE: [Paint; 5] = [
        Paint::hex(0xb89058),
        Paint::hex(0xc9a46c),
        Paint::hex(0xa57c48),
        Paint::hex(0xd0b07c),
        Paint::hex(0x936b3d),
    ];
    const GAP: Paint = Paint::hex(0x3a2818);

    /// Prepares the noise.
    #[must_use]
    pub fn new() -> Self {
        Self {
            fibres: [Fbm::new([110, 6], 2, 901), Fbm::new([6, 110], 2, 911)],
        }
    }
}

impl Pattern for Weave {
    fn texel(&self, u: Dual, v: Dual) -> Texel {
        let (x, y) = (u * Self::COUNT, v * Self::COUNT);
        let cell = [floor(x.value), floor(y.value)];
        let side = if (cell[0] + cell[1]).rem_euclid(2) == 0 {
            1.0
        } else {
            -1.0
        };
        let (fx, fy) = (x.fract() - 0.5, y.fract() - 0.5);
        // A cane is a flattened ellipse across and a sine along.
        let round = |f: Dual| (1.0 - f.squared() * 4.0).max(Dual::constant(0.0));
        let profile = |f: Dual| (round(f) + 0.004).sqrt();
        let wave = |f: Dual, s: f64| (f * 0.5).cos_turns() * (0.40 * s) + 0.5;
        let [up, across] = [&self.fibres[0], &self.fibres[1]].map(|f| f.at(u, v));
        let warp = profile(fx) * wave(fy, side) + up * 0.03 * profile(fx);
        let weft = profile(fy) * wave(fx, -side) + across * 0.03 * profile(fy);
        let warp_on_top = warp.value >= weft.value;
        let height = warp.max(weft) + 0.03;

        let (line, fibre, bulge) = if warp_on_top {
            ([cell[0].rem_euclid(12), 0], up, profile(fx))
        } else {
            ([cell[1].rem_euclid(12), 1], across, profile(fy))
        };
        let depth = height.value + 0.3 * (bulge.value - 1.0);
        let cane = Paint::pick(&Self::PALETTE, unit(line, 91)).scaled(1.0 + 0.75 * fibre.value);
        Texel {
            height,
            paint: Self::GAP.mix(cane, depth * 1.7 - 0.2),
        }
    }
}

/// A landscape: ridged mountains, rock where it is steep, snow where it is high.
#[derive(Debug)]
pub struct Terrain {
    ridges: Vec<super::noise::GradientNoise>,
    patches: Fbm,
}

impl Terrain {
    const GRASS: Paint = Paint::hex(0x5b6b3a);
    const MEADOW: Paint = Paint::hex(0x858549);
    const ROCK: Paint = Paint::hex(0x7b7168);
    const SNOW: Paint = Paint::hex(0xe6eaee);

    /// Prepares the noise.
    #[must_use]
    pub fn new() -> Self {
        Self {
            ridges: (0..6)
                .map(|o| super::noise::GradientNoise::new([3 << o; 2], 50 + o))
                .collect(),
            patches: Fbm::new([16, 16], 3, 1001),
        }
    }
}

impl Pattern for Terrain {
    fn texel(&self, u: Dual, v: Dual) -> Texel {
        let mut sum = Dual::constant(0.0);
        let mut weight = Dual::constant(1.0);
        let mut amplitude = 1.0;
        let mut total = 0.0;
        // Ridges sharpen where the coarser octave is already high (Musgrave's ridged multifractal).
        for noise in &self.ridges {
            let ridge = 1.0 - (noise.at(u, v).squared() + 1e-4).sqrt() * 1.4;
            let octave = ridge.squared() * weight;
            sum = sum + octave * amplitude;
            weight = (octave * 1.6).clamp(0.0, 1.0);
            total += amplitude;
            amplitude *= 0.5;
        }
        let height = sum * (0.95 / total) + 0.02;
        let patches = self.patches.value(u.value, v.value);
        let steep = (height.du * height.du + height.dv * height.dv).sqrt();
        let green = Self::GRASS.mix(Self::MEADOW, 0.5 + 2.0 * patches);
        let rock = Self::ROCK.scaled(1.0 + 0.8 * patches);
        let land = green.mix(
            rock,
            steep * 0.30 - 0.45 + 2.2 * (height.value - 0.45) + patches,
        );
        let snow = (height.value - 0.70 + 0.25 * patches) * 10.0 - 0.10 * (steep - 6.0).max(0.0);
        Texel {
            height,
            paint: land.mix(Self::SNOW, snow),
        }
    }
}

/// Lacquer that dried unevenly, or plaster seen from afar: soft dimples.
#[derive(Debug)]
pub struct OrangePeel {
    dimples: Cells,
    swell: Fbm,
    cloud: Fbm,
}

impl OrangePeel {
    const BASE: Paint = Paint::hex(0xd8d3c8);

    /// Prepares dimples and noise.
    #[must_use]
    pub fn new() -> Self {
        Self {
            dimples: Cells::new(28, 1.0, 61),
            swell: Fbm::new([28, 28], 2, 1101),
            cloud: Fbm::new([3, 3], 4, 1111),
        }
    }
}

impl Pattern for OrangePeel {
    fn texel(&self, u: Dual, v: Dual) -> Texel {
        let d2 = self.dimples.dents(u, v, 0.35);
        let pore = (d2.max(Dual::constant(-0.2)) * 4.0 + 0.8)
            .max(Dual::constant(0.0))
            .exp_neg();
        let height = 0.74 - pore * 0.5 + self.swell.at(u, v) * 0.42;
        let cloud = self.cloud.value(u.value, v.value);
        Texel {
            height,
            paint: Self::BASE.scaled(1.0 + 0.16 * cloud - 0.10 * pore.value),
        }
    }
}
