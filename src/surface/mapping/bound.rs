//! Maps tied to one material: all constants folded, ready for a tile's loops.

use glam::Vec2;

use crate::math::{Real, V2, V3};
use crate::texture::{Addressing, HeightMap, NormalMap, NormalSpace, Wrap};

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
    /// Smallest and largest stored height.
    pub stored: [f32; 2],
}

impl<'a> BoundHeight<'a> {
    /// Looks the map through for its extremes.
    #[must_use]
    pub fn new(map: &'a HeightMap, addressing: Addressing, scale: f32, offset: f32) -> Self {
        Self {
            map,
            addressing,
            scale,
            offset,
            stored: map.extremes(),
        }
    }
}

impl BoundHeight<'_> {
    /// Smallest and largest displacement.
    #[inline(always)]
    #[must_use]
    pub fn range(&self) -> [f32; 2] {
        let [a, b] = self.stored.map(|h| h * self.scale + self.offset);
        [a.min(b), a.max(b)]
    }

    /// Displacement and its derivatives by u and v, exact for the bilinear height: one look-up for both.
    #[inline(always)]
    #[must_use]
    pub fn displacement_and_slope<F: Real>(&self, uv: V2<F>) -> (F, V2<F>) {
        let st = self.addressing.st(uv);
        let found = self.map.sample_slope(st, self.addressing.wrap);
        (
            found.height * self.scale + self.offset,
            found.slope_st.times(self.addressing.scale * self.scale),
        )
    }

    /// Displacement along the normal at `uv`, internal units; positive is outwards.
    #[inline(always)]
    #[must_use]
    pub fn displacement<F: Real>(&self, uv: V2<F>) -> F {
        let st = self.addressing.st(uv);
        self.map.sample(st, self.addressing.wrap) * self.scale + self.offset
    }

    /// Derivatives of the displacement by u and v: exact for the bilinear height.
    #[inline(always)]
    #[must_use]
    pub fn analytic_slope<F: Real>(&self, uv: V2<F>) -> V2<F> {
        let st = self.addressing.st(uv);
        let found = self.map.sample_slope(st, self.addressing.wrap);
        found.slope_st.times(self.addressing.scale * self.scale)
    }

    /// The same by the report's central differences (2.15).
    #[inline(always)]
    #[must_use]
    pub fn central_slope<F: Real>(&self, uv: V2<F>) -> V2<F> {
        let st = self.addressing.st(uv);
        let slope = self.map.central_slope(st, self.addressing.wrap);
        slope.times(self.addressing.scale * self.scale)
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
    /// The directions that the map is told in.
    pub space: NormalSpace,
}

impl<'a> BoundNormal<'a> {
    /// A tangent-space map as it is.
    #[must_use]
    pub const fn new(map: &'a NormalMap, addressing: Addressing) -> Self {
        Self {
            map,
            addressing,
            strength: 1.0,
            signs: Vec2::ONE,
            space: NormalSpace::Tangent,
        }
    }
}

impl BoundNormal<'_> {
    /// Stored vector at `uv`, x along +u and y along +v, before `strength`.
    #[inline(always)]
    #[must_use]
    pub fn stored<F: Real>(&self, uv: V2<F>) -> V3<F> {
        let st = self.addressing.st(uv);
        let m = self.map.sample(st, self.addressing.wrap);
        let (x, y) = (m.x * self.signs.x, m.y * self.signs.y);
        if self.addressing.wrap == Wrap::Mirror {
            V3::new(unmirrored(x, st.x), unmirrored(y, st.y), m.z)
        } else {
            V3::new(x, y, m.z)
        }
    }

    /// Stored vector at `uv` in the axes of the model's file. Turned-over and mirrored copies of a picture
    /// say the same there.
    #[inline(always)]
    #[must_use]
    pub fn stored_in_object<F: Real>(&self, uv: V2<F>) -> V3<F> {
        let st = self.addressing.st(uv);
        let m = self.map.sample(st, self.addressing.wrap);
        V3::new(m.x * self.signs.x, m.y * self.signs.y, m.z)
    }
}

/// In every other copy of a mirrored picture its slopes point the other way.
#[inline(always)]
fn unmirrored<F: Real>(slope: F, c: F) -> F {
    let half = c.floor() * 0.5;
    let is_copy = !half.floor().eq(half);
    F::select(is_copy, -slope, slope)
}
