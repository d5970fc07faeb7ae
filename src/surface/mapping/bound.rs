//! Maps tied to one material: all constants folded, ready for a tile's loops.

use glam::{Vec2, Vec3};

use crate::texture::{Addressing, HeightMap, NormalMap, Wrap};

/// A height map with its amplitude: `displacement = stored · scale + offset`, internal units along the
/// normal.
///
/// Amplitude, midlevel, inversion, gain and bias are all in the two numbers, so that every method reads
/// the same relief and none pays for a switch.
#[derive(Debug, Clone, Copy)]
pub struct BoundHeight<'a> {
    /// Stored heights.
    pub map: &'a HeightMap,
    /// From uv to the picture.
    pub addressing: Addressing,
    /// Internal units from stored 0 to stored 1; negative if inverted.
    pub scale: f32,
    /// Displacement at stored 0.
    pub offset: f32,
}

impl BoundHeight<'_> {
    /// Displacement along the normal at `uv`, internal units; positive is outwards.
    #[must_use]
    pub fn displacement(&self, uv: Vec2) -> f32 {
        self.map
            .sample(self.addressing.st(uv), self.addressing.wrap)
            * self.scale
            + self.offset
    }

    /// Derivatives of the displacement by u and v: exact for the bilinear height.
    #[must_use]
    pub fn analytic_slope(&self, uv: Vec2) -> Vec2 {
        let slope = self
            .map
            .sample_slope(self.addressing.st(uv), self.addressing.wrap)
            .slope_st;
        slope * self.addressing.scale * self.scale
    }

    /// The same by the report's central differences (2.15).
    #[must_use]
    pub fn central_slope(&self, uv: Vec2) -> Vec2 {
        let slope = self
            .map
            .central_slope(self.addressing.st(uv), self.addressing.wrap);
        slope * self.addressing.scale * self.scale
    }
}

/// A normal or slope map with the factor that takes it from its own amplitude to the scene's.
#[derive(Debug, Clone, Copy)]
pub struct BoundNormal<'a> {
    /// Stored `2c − 1`.
    pub map: &'a NormalMap,
    /// From uv to the picture.
    pub addressing: Addressing,
    /// Amplitude over the amplitude the map was baked for, at least 0.
    pub strength: f32,
    /// Signs that turn stored x and y towards +u and +v: flipped green, flipped v and negative scales.
    pub signs: Vec2,
}

impl BoundNormal<'_> {
    /// Stored vector at `uv`, x along +u and y along +v, before `strength`.
    #[must_use]
    pub fn stored(&self, uv: Vec2) -> Vec3 {
        let st = self.addressing.st(uv);
        let m = self.map.sample(st, self.addressing.wrap);
        let signs = if self.addressing.wrap == Wrap::Mirror {
            self.signs * mirror_signs(st)
        } else {
            self.signs
        };
        Vec3::new(m.x * signs.x, m.y * signs.y, m.z)
    }
}

/// In every other copy of a mirrored picture its slopes point the other way.
fn mirror_signs(st: Vec2) -> Vec2 {
    let sign = |c: f32| {
        if (c * 0.5).fract().abs() >= 0.5 {
            -1.0
        } else {
            1.0
        }
    };
    let floor = st.floor();
    Vec2::new(sign(floor.x), sign(floor.y))
}
