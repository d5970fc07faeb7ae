//! Bricks, cobbles and tiles.

use super::cells::{Cells, courses};
use super::dual::Dual;
use super::noise::{Fbm, GradientNoise, unit};
use super::paint::Paint;
use super::{Pattern, Texel};

/// A brick wall: worn bricks in running bond with deep, sandy joints.
#[derive(Debug)]
pub struct Bricks {
    warp: [GradientNoise; 2],
    surface: Fbm,
    pits: GradientNoise,
    sand: Fbm,
    stain: Fbm,
}

impl Bricks {
    const SEED: u64 = 11;
    const LAYOUT: [i64; 2] = [6, 12];
    const PALETTE: [Paint; 7] = [
        Paint::hex(0x97594a),
        Paint::hex(0xa46653),
        Paint::hex(0x874d42),
        Paint::hex(0xaf765d),
        Paint::hex(0x764840),
        Paint::hex(0x9b6453),
        Paint::hex(0xb98a6d),
    ];
    const BURNT: Paint = Paint::hex(0x54444a);
    const MORTAR: Paint = Paint::hex(0xa39a8b);
    const SOOT: Paint = Paint::hex(0x4a4038);

    /// Prepares the noise.
    #[must_use]
    pub fn new() -> Self {
        Self {
            warp: [
                GradientNoise::new([20, 20], 101),
                GradientNoise::new([20, 20], 111),
            ],
            surface: Fbm::new([22, 34], 4, 121),
            pits: GradientNoise::new([64, 64], 131),
            sand: Fbm::new([90, 90], 2, 141),
            stain: Fbm::new([3, 3], 3, 151),
        }
    }
}

impl Pattern for Bricks {
    fn texel(&self, u: Dual, v: Dual) -> Texel {
        let wu = u + self.warp[0].at(u, v) * 0.004;
        let wv = v + self.warp[1].at(u, v) * 0.004;
        let block = courses(wu, wv, Self::LAYOUT, 0.5);
        let random = |salt| unit(block.id, Self::SEED + salt);
        let surface = self.surface.at(u, v);
        let sand = self.sand.at(u, v);

        let edge = block.edge[0].smooth_min(block.edge[1], 0.007) + surface * 0.004;
        let body = edge.smoothstep(0.003, 0.0125);
        let pit = self.pits.at(u, v).smoothstep(0.26, 0.5);
        let tilt = block.local[0] * (0.10 * (random(1) - 0.5))
            + block.local[1] * (0.12 * (random(2) - 0.5));
        let top = tilt + surface * 0.16 - pit * 0.10 + (0.85 + 0.12 * (random(0) - 0.5));
        let joint = sand * 0.16 + 0.14;
        let height = joint.lerp(top, body);

        let stain = self.stain.value(u.value, v.value);
        let shade = 1.0 + 0.16 * (random(4) - 0.5) + 0.55 * surface.value + 0.22 * stain
            - 0.30 * pit.value
            + 0.10 * sand.value;
        let mut brick = Paint::pick(&Self::PALETTE, random(3));
        if random(5) < 0.11 {
            brick = brick.mix(Self::BURNT, 0.75);
        }
        // Worn arrises are paler, as the fired skin is gone.
        let arris = body.value * (1.0 - edge.smoothstep(0.009, 0.018).value);
        let brick = brick.scaled(shade).mix(Paint::hex(0xc79c80), 0.22 * arris);
        let mortar = Self::MORTAR
            .scaled(0.92 + 0.45 * sand.value + 0.25 * stain)
            .mix(Self::SOOT, 0.30 - 0.4 * stain);
        Texel {
            height,
            paint: mortar.mix(brick, body.value),
        }
    }
}

/// Cobbles: rounded stones of many greys with earth and moss between them.
#[derive(Debug)]
pub struct Cobble {
    stones: Cells,
    warp: [GradientNoise; 2],
    surface: Fbm,
    earth: Fbm,
    moss: Fbm,
}

impl Cobble {
    const PALETTE: [Paint; 7] = [
        Paint::hex(0x8f8a82),
        Paint::hex(0x7c7e80),
        Paint::hex(0x9b9080),
        Paint::hex(0x716e6b),
        Paint::hex(0xa59a8b),
        Paint::hex(0x867d76),
        Paint::hex(0x8d9294),
    ];
    const EARTH: Paint = Paint::hex(0x4a4137);
    const MOSS: Paint = Paint::hex(0x565c33);

    /// Prepares stones and noise.
    #[must_use]
    pub fn new() -> Self {
        Self {
            stones: Cells::new(7, 0.72, 21),
            warp: [
                GradientNoise::new([14, 14], 201),
                GradientNoise::new([14, 14], 202),
            ],
            surface: Fbm::new([18, 18], 4, 211),
            earth: Fbm::new([56, 56], 2, 221),
            moss: Fbm::new([4, 4], 3, 231),
        }
    }
}

impl Pattern for Cobble {
    fn texel(&self, u: Dual, v: Dual) -> Texel {
        let wu = u + self.warp[0].at(u, v) * 0.012;
        let wv = v + self.warp[1].at(u, v) * 0.012;
        let stone = self.stones.at(wu, wv, 0.12);
        let random = |salt| self.stones.random(stone.id, salt);
        let surface = self.surface.at(u, v);
        let earth = self.earth.at(u, v);

        let rise = ((stone.edge + surface * 0.03 - 0.03) * (1.0 / 0.34)).clamp(0.0, 1.0);
        // A quarter of a circle, eased at its foot where its slope would be infinite.
        let dome = ((2.0 - rise) * rise + 0.01).sqrt() * stone.edge.smoothstep(0.0, 0.10);
        let top = surface * 0.22 + (0.76 + 0.16 * (random(0) - 0.5));
        let joint = earth * 0.10 + 0.06;
        let height = joint + dome * top;

        let bare = dome.smoothstep(0.18, 0.62).value;
        let shade = 0.94 + 0.24 * (random(2) - 0.5) + 0.55 * surface.value + 0.18 * earth.value;
        let paint = Paint::pick(&Self::PALETTE, random(1)).scaled(shade);
        let moss = Dual::constant(self.moss.value(u.value, v.value))
            .smoothstep(-0.05, 0.30)
            .value;
        let ground = Self::EARTH
            .mix(Self::MOSS, moss)
            .scaled(0.95 + 0.8 * earth.value);
        Texel {
            height,
            paint: ground.mix(paint, bare),
        }
    }
}

/// Floor tiles: pale and dark stone in a chequer, slightly cushioned, with sandy joints.
#[derive(Debug)]
pub struct Tiles {
    surface: Fbm,
    veins: [Fbm; 2],
    sand: Fbm,
}

impl Tiles {
    const SEED: u64 = 31;
    const LAYOUT: [i64; 2] = [4, 4];
    const PALE: Paint = Paint::hex(0xcfc6b4);
    const DARK: Paint = Paint::hex(0x5b6264);
    const GROUT: Paint = Paint::hex(0x8b8478);

    /// Prepares the noise.
    #[must_use]
    pub fn new() -> Self {
        Self {
            surface: Fbm::new([8, 8], 3, 301),
            veins: [Fbm::new([5, 5], 3, 311), Fbm::new([7, 7], 3, 321)],
            sand: Fbm::new([80, 80], 2, 331),
        }
    }
}

impl Pattern for Tiles {
    fn texel(&self, u: Dual, v: Dual) -> Texel {
        let block = courses(u, v, Self::LAYOUT, 0.0);
        let random = |salt| unit(block.id, Self::SEED + salt);
        let surface = self.surface.at(u, v);
        let sand = self.sand.at(u, v);

        let edge = block.edge[0].smooth_min(block.edge[1], 0.010);
        let body = edge.smoothstep(0.0045, 0.018);
        let cushion = block.local[0].squared() + block.local[1].squared();
        let tilt = block.local[0] * (0.10 * (random(1) - 0.5))
            + block.local[1] * (0.10 * (random(2) - 0.5));
        let top = tilt - cushion * 0.18 + surface * 0.05 + (0.93 + 0.05 * (random(0) - 0.5));
        let joint = sand * 0.12 + 0.14;
        let height = joint.lerp(top, body);

        let dark = (block.id[0] + block.id[1]) % 2 == 1;
        // Every slab is cut from another place of the quarry.
        let (ou, ov) = (u.value + random(3), v.value + random(4));
        let vein = |f: &Fbm| 1.0 - (f.value(ou, ov).abs() * 14.0).min(1.0);
        let vein = vein(&self.veins[0]).max(0.6 * vein(&self.veins[1]));
        let cloud = surface.value;
        let (stone, streak) = if dark {
            (Self::DARK, Paint::hex(0x9a9d98))
        } else {
            (Self::PALE, Paint::hex(0xa28f78))
        };
        let stone = stone
            .scaled(1.0 + 0.10 * (random(5) - 0.5) + 0.35 * cloud + 0.10 * sand.value)
            .mix(streak, 0.38 * vein * vein);
        let grout = Self::GROUT.scaled(0.82 + 0.5 * sand.value + 0.2 * surface.value);
        Texel {
            height,
            paint: grout.mix(stone, body.value),
        }
    }
}
