//! Surfaces of revolution: columns and vases.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::{Vertex, WorldMesh, sin_cos_turns};

/// A cubic Bézier curve in the half plane of radius (x ≥ 0) and height (y).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curve(pub [DVec2; 4]);

impl Curve {
    /// A straight line.
    #[must_use]
    pub fn line(from: [f64; 2], to: [f64; 2]) -> Self {
        let (a, b) = (DVec2::from(from), DVec2::from(to));
        Self([a, a.lerp(b, 1.0 / 3.0), a.lerp(b, 2.0 / 3.0), b])
    }

    /// A quarter turn from `from` to `to` that leaves along the direction to `corner` and arrives from it.
    #[must_use]
    pub fn quarter(from: [f64; 2], corner: [f64; 2], to: [f64; 2]) -> Self {
        // 4/3·(√2 − 1): the Bézier closest to a circle, within 3e-4 of the radius.
        let kappa = 0.552_284_749_830_793_4;
        let (a, c, b) = (DVec2::from(from), DVec2::from(corner), DVec2::from(to));
        Self([a, a.lerp(c, kappa), b.lerp(c, kappa), b])
    }

    /// A bulge that starts and ends on a vertical line: half an ellipse, `depth` outwards.
    #[must_use]
    pub fn bulge([radius, bottom]: [f64; 2], top: f64, depth: f64) -> Self {
        // The middle of a cubic reaches 3/4 of the way to its two inner points.
        let out = radius + depth * 4.0 / 3.0;
        Self([
            DVec2::new(radius, bottom),
            DVec2::new(out, bottom),
            DVec2::new(out, top),
            DVec2::new(radius, top),
        ])
    }

    /// Point at `t` in `[0, 1]`.
    #[must_use]
    pub fn at(&self, t: f64) -> DVec2 {
        let s = 1.0 - t;
        let [a, b, c, d] = self.0;
        a * (s * s * s) + b * (3.0 * s * s * t) + c * (3.0 * s * t * t) + d * (t * t * t)
    }

    /// Unit tangent at `t`, by the derivative and, where that vanishes, by the chord.
    #[must_use]
    pub fn tangent(&self, t: f64) -> DVec2 {
        let s = 1.0 - t;
        let [a, b, c, d] = self.0;
        let derivative = (b - a) * (s * s) + (c - b) * (2.0 * s * t) + (d - c) * (t * t);
        derivative.normalize_or((d - a).normalize_or(DVec2::Y))
    }

    /// Length, by 64 chords.
    #[must_use]
    pub fn length(&self) -> f64 {
        (0..64_u32)
            .map(|i| {
                let t = f64::from(i) / 64.0;
                self.at(t).distance(self.at(t + 1.0 / 64.0))
            })
            .sum()
    }
}

/// Turns a chain of curves around the z axis. Each curve is smooth in itself; chains may have corners.
///
/// Curves run so that the outside is on their right: upwards on an outer wall. `around` whole tiles lie
/// on a turn, one tile per `tile` world units along the profile.
#[must_use]
pub fn revolve(
    chain: &[Curve],
    segments: u32,
    [around, tile]: [f64; 2],
    material: u16,
) -> WorldMesh {
    /// Quads along one curve.
    const STEPS: u32 = 16;
    let mut mesh = WorldMesh::default();
    let mut start = 0.0;
    for curve in chain {
        let length = curve.length();
        mesh.patch([segments, STEPS], material, |s, t| {
            let (sin, cos) = sin_cos_turns(s);
            let outwards = DVec3::new(cos, sin, 0.0);
            let (p, along) = (curve.at(t), curve.tangent(t));
            Vertex {
                position: outwards * p.x.max(0.0) + DVec3::Z * p.y,
                normal: outwards * along.y - DVec3::Z * along.x,
                uv: DVec2::new(s * around, (start + length * t) / tile),
            }
        });
        start += length;
    }
    mesh
}

/// The shaft of a column: `flutes` shallow channels with sharp arrises between them, around the z axis from
/// z = 0 to `height`, tapering from `radii[0]` to `radii[1]` with a slight swelling (entasis).
#[must_use]
pub fn fluted_shaft(
    height: f64,
    radii: [f64; 2],
    flutes: u32,
    tile: f64,
    material: u16,
) -> WorldMesh {
    /// Deepest cut of a flute as a share of the radius.
    const DEPTH: f64 = 0.075;
    /// Swelling as a share of the radius.
    const ENTASIS: f64 = 0.02;
    let radius = |t: f64| {
        let taper = radii[0] + (radii[1] - radii[0]) * t;
        (
            taper + radii[0] * ENTASIS * 4.0 * t * (1.0 - t),
            (radii[1] - radii[0] + radii[0] * ENTASIS * 4.0 * (1.0 - 2.0 * t)) / height,
        )
    };
    let turn = (TAU * radii[0] / tile).round().max(1.0);
    let mut mesh = WorldMesh::default();
    for flute in 0..flutes {
        mesh.patch([8, 16], material, |s, t| {
            let turns = (f64::from(flute) + s) / f64::from(flutes);
            let (sin, cos) = sin_cos_turns(turns);
            let (outwards, sideways) = (DVec3::new(cos, sin, 0.0), DVec3::new(-sin, cos, 0.0));
            let (r, rise) = radius(t);
            let cut = 1.0 - DEPTH * 4.0 * s * (1.0 - s);
            // Derivative of the cut by the angle; the normal of r(z)·cut(angle) follows from both.
            let bend = -DEPTH * 4.0 * (1.0 - 2.0 * s) * f64::from(flutes) / TAU;
            let normal = outwards * cut - sideways * bend - DVec3::Z * (rise * cut * cut);
            Vertex {
                position: outwards * (r * cut) + DVec3::Z * (height * t),
                normal: normal.normalize_or(outwards),
                uv: DVec2::new(turns * turn, height * t / tile),
            }
        });
    }
    mesh
}
