//! Worked metal: hammered, riveted, rolled and struck.

use super::cells::{Cells, courses};
use super::dual::Dual;
use super::exact::floor;
use super::noise::{Fbm, unit};
use super::paint::Paint;
use super::{Pattern, Texel};

/// Metal beaten with a round hammer: shallow dents that meet in soft ridges.
#[derive(Debug)]
pub struct Hammered {
    dents: Cells,
    polish: Fbm,
    patina: Fbm,
}

impl Hammered {
    const BRIGHT: Paint = Paint::hex(0xdc9a70);
    const DULL: Paint = Paint::hex(0xa65f40);

    /// Prepares dents and noise.
    #[must_use]
    pub fn new() -> Self {
        Self {
            dents: Cells::new(9, 0.85, 41),
            polish: Fbm::new([32, 32], 2, 401),
            patina: Fbm::new([5, 5], 4, 411),
        }
    }
}

impl Pattern for Hammered {
    fn texel(&self, u: Dual, v: Dual) -> Texel {
        let d2 = self.dents.dents(u, v, 0.24);
        let bowl = (d2 * 1.25).smooth_min(Dual::constant(0.92), 0.12);
        let height = bowl + self.polish.at(u, v) * 0.012 + 0.05;
        let patina = self.patina.value(u.value, v.value);
        Texel {
            height,
            paint: Self::DULL.mix(
                Self::BRIGHT,
                0.62 + 0.8 * patina + 0.25 * (bowl.value - 0.4),
            ),
        }
    }
}

/// Painted steel plates with round-headed rivets; rust where water stays.
#[derive(Debug)]
pub struct Rivets {
    paint: Fbm,
    rust: Fbm,
    grain: Fbm,
}

impl Rivets {
    const PAINT: Paint = Paint::hex(0x5f7f83);
    const RUST: Paint = Paint::hex(0x7d4526);
    const DEEP_RUST: Paint = Paint::hex(0x4a2a1c);
    const STEEL: Paint = Paint::hex(0xa6a8a6);
    /// Radius of a rivet's head in spacings.
    const HEAD: f64 = 0.15;

    /// Prepares the noise.
    #[must_use]
    pub fn new() -> Self {
        Self {
            paint: Fbm::new([6, 6], 3, 501),
            rust: Fbm::new([9, 9], 4, 511),
            grain: Fbm::new([64, 64], 2, 521),
        }
    }
}

impl Pattern for Rivets {
    fn texel(&self, u: Dual, v: Dual) -> Texel {
        let x = (u * 4.0).fract() - 0.5;
        let y = (v * 4.0).fract() - 0.5;
        let d2 = x.squared() + y.squared() + 1e-9;
        let d = d2.sqrt();
        let grain = self.grain.at(u, v);
        let cap = (1.0 - d2 * (1.0 / (Self::HEAD * Self::HEAD))).max(Dual::constant(0.0)) + 0.02;
        let head = 1.0 - d.smoothstep(Self::HEAD * 0.92, Self::HEAD * 1.02);
        let dome = cap.sqrt() * head * 0.42;
        let plate = courses(u, v, [2, 2], 0.0);
        let border = plate.edge[0].smooth_min(plate.edge[1], 0.006);
        let seam = border.smoothstep(0.003, 0.012);
        let buckle = self.paint.at(u, v) * 0.05;
        let height = seam * 0.40 + dome + buckle * seam + grain * 0.02 + 0.08;

        let rust = self.rust.value(u.value, v.value);
        let near_seam = 1.0 - border.smoothstep(0.0, 0.035).value;
        let near_rivet = 1.0 - d.smoothstep(Self::HEAD * 0.9, Self::HEAD * 1.9).value;
        let ring = near_rivet * d.smoothstep(Self::HEAD * 0.55, Self::HEAD).value;
        let amount = (1.15 * near_seam + 0.85 * ring + 2.6 * rust - 0.35).clamp(0.0, 1.0);
        let coat = Self::PAINT
            .scaled(
                1.0 + 0.12 * (unit(plate.id, 71) - 0.5) + 0.25 * self.paint.value(u.value, v.value),
            )
            .mix(
                Self::STEEL,
                0.55 * head.value * (cap.value - 0.75).max(0.0) * 4.0,
            );
        let rusty = Self::RUST
            .mix(Self::DEEP_RUST, 0.5 - 1.6 * rust)
            .scaled(1.0 + 0.8 * grain.value);
        Texel {
            height,
            paint: coat.mix(rusty, amount),
        }
    }
}

/// Tread plate: raised lozenges in alternate directions.
#[derive(Debug)]
pub struct Tread {
    rolled: Fbm,
    dirt: Fbm,
}

impl Tread {
    const METAL: Paint = Paint::hex(0x9ca1a5);
    const WORN: Paint = Paint::hex(0xd3d5d3);
    const DIRT: Paint = Paint::hex(0x4c4741);

    /// Prepares the noise.
    #[must_use]
    pub fn new() -> Self {
        Self {
            rolled: Fbm::new([12, 96], 2, 601),
            dirt: Fbm::new([6, 6], 4, 611),
        }
    }
}

impl Pattern for Tread {
    fn texel(&self, u: Dual, v: Dual) -> Texel {
        let (x, y) = (u * 6.0, v * 6.0);
        let even = (floor(x.value) + floor(y.value)).rem_euclid(2) == 0;
        let (fx, fy) = (x.fract() - 0.5, y.fract() - 0.5);
        let diagonal = std::f64::consts::FRAC_1_SQRT_2;
        let (a, b) = ((fx + fy) * diagonal, (fx - fy) * diagonal);
        let (along, across) = if even { (a, b) } else { (b, a) };
        let along = along * (1.0 / 0.44);
        let across = across * (1.0 / 0.14);
        let reach = (along.squared() + across.squared() + 1e-9).sqrt();
        let stud = 1.0 - reach.smoothstep(0.40, 1.0);
        let rolled = self.rolled.at(u, v);
        let height = stud * 0.78 + rolled * 0.02 + 0.15;
        let dirt = self.dirt.value(u.value, v.value);
        let foot = (1.0 - stud.value) * (1.0 - reach.smoothstep(0.9, 1.6).value);
        Texel {
            height,
            paint: Self::METAL
                .scaled(1.0 + 0.35 * rolled.value)
                .mix(
                    Self::DIRT,
                    0.22 + 1.1 * dirt + 0.35 * foot - 0.5 * stud.value,
                )
                .mix(Self::WORN, 0.8 * stud.value * stud.value),
        }
    }
}

/// A struck bronze: star, beads and rim around the middle of the tile.
#[derive(Debug)]
pub struct Medallion {
    field: Fbm,
    patina: Fbm,
}

impl Medallion {
    const BRONZE: Paint = Paint::hex(0xc09455);
    const POLISHED: Paint = Paint::hex(0xe0bd7d);
    const PATINA: Paint = Paint::hex(0x4f6f61);

    /// Prepares the noise.
    #[must_use]
    pub fn new() -> Self {
        Self {
            field: Fbm::new([40, 40], 2, 701),
            patina: Fbm::new([7, 7], 4, 711),
        }
    }

    /// Cosine of `2^doublings · odd` times the polar angle, by powers of `(x + iy)/r`.
    fn cos_multiple(x: Dual, y: Dual, inverse_r: Dual, odd: u32, doublings: u32) -> Dual {
        let (c1, s1) = (x * inverse_r, y * inverse_r);
        let (mut c, mut s) = (c1, s1);
        for _ in 1..odd {
            (c, s) = (c * c1 - s * s1, c * s1 + s * c1);
        }
        for _ in 0..doublings {
            (c, s) = (c * c - s * s, c * s * 2.0);
        }
        c
    }
}

impl Pattern for Medallion {
    fn texel(&self, u: Dual, v: Dual) -> Texel {
        let (x, y) = (u.fract() - 0.5, v.fract() - 0.5);
        let r2 = x.squared() + y.squared() + 1e-9;
        let r = r2.sqrt();
        let inverse_r = r.recip();
        // Gaussian ridges of a given radius and width.
        let ridge =
            |radius: f64, sigma: f64| ((r - radius).squared() * (0.5 / (sigma * sigma))).exp_neg();
        let beads = ridge(0.365, 0.011) * (Self::cos_multiple(x, y, inverse_r, 3, 4) * 0.5 + 0.5);
        let lobe = Self::cos_multiple(y, x, inverse_r, 5, 0) * 0.075 + 0.215;
        let star = 1.0 - (r - lobe).smoothstep(-0.035, 0.03);
        let groove = ridge(0.305, 0.010);
        let disc = 1.0 - r.smoothstep(0.452, 0.474);
        let boss = (r2 * (0.5 / (0.055 * 0.055))).exp_neg();
        let field = self.field.at(u, v);
        let relief = ridge(0.425, 0.013) * 0.42 + beads * 0.34 - groove * 0.10
            + star * ((1.0 - r * 1.2) * 0.40)
            + star * boss * 0.20
            + field * 0.015;
        let height = disc * (relief + 0.30) + 0.06;
        let patina = self.patina.value(u.value, v.value);
        let high = ((height.value - 0.34) * 2.4).clamp(0.0, 1.0);
        Texel {
            height,
            paint: Self::BRONZE
                .mix(Self::PATINA, 0.62 + 1.5 * patina - 1.3 * high)
                .mix(Self::POLISHED, 0.75 * high)
                .scaled(0.92 + 0.4 * field.value),
        }
    }
}
