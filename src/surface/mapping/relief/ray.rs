//! A ray over a relief.

/// Farther from the origin than this many texels nothing is looked for: cells could not be told apart.
pub(super) const FARTHEST: f64 = 1e12;

/// A straight ray over a flat chart, by a parameter τ ≥ 0 of any length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReliefRay {
    /// Place in texels (whole numbers at texel centres) at τ = 0.
    pub start: [f64; 2],
    /// Texels per unit of τ.
    pub rate: [f64; 2],
    /// Displacement at τ = 0, internal units along the normal.
    pub z: f64,
    /// Its change per unit of τ.
    pub z_rate: f64,
    /// τ at which it ends, finite.
    pub end: f64,
    /// Where it comes from.
    pub side: Side,
}

/// A side of a relief.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The side that the normal points to.
    Above,
    /// The other.
    Below,
}

impl Side {
    /// What displacements are multiplied by so that the ray is above: seen from below, a relief is the
    /// same turned over.
    #[inline(always)]
    pub(super) const fn sign(self) -> f64 {
        match self {
            Self::Above => 1.0,
            Self::Below => -1.0,
        }
    }
}

impl ReliefRay {
    /// A ray from displacement `z` to `z_end`, with the way gone along z as its parameter. `per_z` are
    /// texels per unit of z.
    #[must_use]
    pub fn by_height(start: [f64; 2], per_z: [f64; 2], z: f64, z_end: f64) -> Self {
        let toward = if z_end > z { 1.0 } else { -1.0 };
        Self {
            start,
            rate: per_z.map(|rate| rate * toward),
            z,
            z_rate: toward,
            end: (z_end - z).abs(),
            side: Side::Above,
        }
    }

    /// Displacement at τ.
    #[must_use]
    pub fn z_at(&self, tau: f64) -> f64 {
        self.z + self.z_rate * tau
    }

    /// Whether it stays where cells can be told apart.
    pub(super) fn is_near(&self) -> bool {
        let reach = |k: usize| self.start[k].abs() + self.rate[k].abs() * self.end;
        reach(0) < FARTHEST && reach(1) < FARTHEST
    }
}
