//! Maps tied to one material: all constants folded, ready for a tile's loops.

use glam::Vec2;

use crate::math::{Real, V2, V3};
use crate::texture::{
    Addressing, HeightMap, Look, Mips, NormalAxes, NormalMap, NormalSpace, SlopeMoments, Wrap,
};

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
    /// For means over what the ray's cone covers; `None` reads the map at points. Searches do so anyway.
    pub mips: Option<Mips<'a, HeightMap>>,
    /// How much slopes differ there; `None` where nobody asks.
    pub moments: Option<Mips<'a, SlopeMoments>>,
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
            mips: None,
            moments: None,
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

    /// Whether anything is displaced at all.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.scale != 0.0 || self.offset != 0.0
    }

    /// Displacement along the normal at `uv`, internal units; positive is outwards.
    #[inline(always)]
    #[must_use]
    pub fn displacement<F: Real>(&self, uv: V2<F>) -> F {
        let st = self.addressing.st(uv);
        self.map.sample(st, self.addressing.wrap) * self.scale + self.offset
    }

    /// See [`Mips::prefetch`].
    #[inline(always)]
    pub fn prefetch<F: Real>(&self, uv: V2<F>) {
        let place = (self.addressing.st(uv), self.addressing.wrap);
        Mips::prefetch(self.map, self.mips.as_ref(), place);
    }

    /// The same as its mean over the footprint of a point.
    #[inline(always)]
    #[must_use]
    pub fn displacement_over<F: Real>(&self, uv: V2<F>, footprint: F) -> F {
        let [height] = self.look(footprint, &HeightAt(self.place(uv)));
        height * self.scale + self.offset
    }

    /// Derivatives of the displacement by u and v, the mean over the footprint of a point: exact for the bilinear
    /// height.
    #[inline(always)]
    #[must_use]
    pub fn analytic_slope<F: Real>(&self, uv: V2<F>, footprint: F) -> V2<F> {
        let [s, t] = self.look(footprint, &AnalyticAt(self.place(uv)));
        V2::new(s, t).times(self.addressing.scale * self.scale)
    }

    /// The same by the report's central differences (2.15).
    #[inline(always)]
    #[must_use]
    pub fn central_slope<F: Real>(&self, uv: V2<F>, footprint: F) -> V2<F> {
        let [s, t] = self.look(footprint, &CentralAt(self.place(uv)));
        V2::new(s, t).times(self.addressing.scale * self.scale)
    }

    /// Variance of the relief's slopes over the footprint of a point, the mean of both axes: pure numbers.
    /// `grads` are the gradients of u and v.
    #[inline(always)]
    #[must_use]
    pub fn slope_variance<F: Real>(&self, uv: V2<F>, footprint: F, grads: [V3<F>; 2]) -> F {
        let Some(moments) = &self.moments else {
            return footprint.splat(0.0);
        };
        let [a, b, ab] = moments.look_beyond(footprint, &VariancesAt(self.place(uv)));
        // The tilt is −(a ∇s + b ∇t) with the gradients of the place on the picture.
        let per_s = grads[0] * a.splat(self.addressing.scale.x * self.scale);
        let per_t = grads[1] * a.splat(self.addressing.scale.y * self.scale);
        let both = a * per_s.dot(per_s) + b * per_t.dot(per_t) + ab * per_s.dot(per_t) * 2.0;
        (both * 0.5).larger(a.splat(0.0))
    }

    #[inline(always)]
    fn place<F: Real>(&self, uv: V2<F>) -> Place<F> {
        (self.addressing.st(uv), self.addressing.wrap)
    }

    #[inline(always)]
    fn look<F: Real, const N: usize>(
        &self,
        footprint: F,
        look: &impl Look<F, N, Map = HeightMap>,
    ) -> [F; N] {
        Mips::look(self.map, self.mips.as_ref(), footprint, look)
    }
}

/// A place on a picture, and what goes on beyond its border.
type Place<F> = (V2<F>, Wrap);

/// Stored heights.
struct HeightAt<F: Real>(Place<F>);

impl<F: Real> Look<F, 1> for HeightAt<F> {
    type Map = HeightMap;
    #[inline(always)]
    fn at(&self, map: &HeightMap) -> [F; 1] {
        let (st, wrap) = self.0;
        [map.sample(st, wrap)]
    }
}

/// Derivatives of the bilinear height.
struct AnalyticAt<F: Real>(Place<F>);

impl<F: Real> Look<F, 2> for AnalyticAt<F> {
    type Map = HeightMap;
    #[inline(always)]
    fn at(&self, map: &HeightMap) -> [F; 2] {
        let (st, wrap) = self.0;
        let slope = map.sample_slope(st, wrap).slope_st;
        [slope.x, slope.y]
    }
}

/// Central differences.
struct CentralAt<F: Real>(Place<F>);

impl<F: Real> Look<F, 2> for CentralAt<F> {
    type Map = HeightMap;
    #[inline(always)]
    fn at(&self, map: &HeightMap) -> [F; 2] {
        let (st, wrap) = self.0;
        let slope = map.central_slope(st, wrap);
        [slope.x, slope.y]
    }
}

/// Variances and covariance of slopes.
struct VariancesAt<F: Real>(Place<F>);

impl<F: Real> Look<F, 3> for VariancesAt<F> {
    type Map = SlopeMoments;
    #[inline(always)]
    fn at(&self, map: &SlopeMoments) -> [F; 3] {
        let (st, wrap) = self.0;
        map.variances(st, wrap)
    }
}

/// How much of unit vectors their mean has lost: the variance of both axes together.
struct LostAt<F: Real>(Place<F>);

impl<F: Real> Look<F, 1> for LostAt<F> {
    type Map = NormalMap;
    #[inline(always)]
    fn at(&self, map: &NormalMap) -> [F; 1] {
        let (st, wrap) = self.0;
        let mean = map.sample(st, wrap);
        let one = mean.x.splat(1.0);
        [(one - mean.dot(mean)).larger(one.splat(0.0))]
    }
}

/// Stored vectors.
struct VectorAt<F: Real>(Place<F>);

impl<F: Real> Look<F, 3> for VectorAt<F> {
    type Map = NormalMap;
    #[inline(always)]
    fn at(&self, map: &NormalMap) -> [F; 3] {
        let (st, wrap) = self.0;
        let V3 { x, y, z } = map.sample(st, wrap);
        [x, y, z]
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
    /// In object space, the axes that the channels tell.
    pub axes: NormalAxes,
    /// For means over what the ray's cone covers; `None` reads the map at points.
    pub mips: Option<Mips<'a, NormalMap>>,
    /// Of slope maps, how much slopes differ there; of normal maps the means themselves tell.
    pub moments: Option<Mips<'a, SlopeMoments>>,
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
            axes: NormalAxes::FILE,
            mips: None,
            moments: None,
        }
    }
}

impl BoundNormal<'_> {
    /// Stored vector at `uv`, the mean over the footprint of a point, before `strength`: x along +u and y along +v,
    /// or in the axes of the model's file.
    #[inline(always)]
    #[must_use]
    pub fn stored<F: Real>(&self, uv: V2<F>, footprint: F) -> V3<F> {
        let st = self.addressing.st(uv);
        let stored = self.signed(st, footprint);
        // Turned-over and mirrored copies of a picture say the same in the axes of the file.
        if self.space == NormalSpace::Object {
            self.axes.in_file(stored)
        } else if self.addressing.wrap == Wrap::Mirror {
            let V3 { x, y, z } = stored;
            V3::new(unmirrored(x, st.x), unmirrored(y, st.y), z)
        } else {
            stored
        }
    }

    /// See [`Mips::prefetch`].
    #[inline(always)]
    pub fn prefetch<F: Real>(&self, uv: V2<F>) {
        let place = (self.addressing.st(uv), self.addressing.wrap);
        Mips::prefetch(self.map, self.mips.as_ref(), place);
    }

    /// Variance of a slope map's slopes over the footprint of a point, the mean of both axes.
    #[inline(always)]
    #[must_use]
    pub fn slope_variance<F: Real>(&self, uv: V2<F>, footprint: F) -> F {
        let place = (self.addressing.st(uv), self.addressing.wrap);
        let both = self
            .moments
            .as_ref()
            .map_or(footprint.splat(0.0), |moments| {
                let [a, b, _] = moments.look_beyond(footprint, &VariancesAt(place));
                a + b
            });
        both * (0.5 * self.strength * self.strength)
    }

    /// The same for a normal map: what the mean of unit vectors lacks of a unit.
    ///
    /// Source: Toksvig 2005, "Mipmapping Normal Maps".
    #[inline(always)]
    #[must_use]
    pub fn normal_variance<F: Real>(&self, uv: V2<F>, footprint: F) -> F {
        let place = (self.addressing.st(uv), self.addressing.wrap);
        let both = self.mips.as_ref().map_or(footprint.splat(0.0), |mips| {
            let [lost] = mips.look_beyond(footprint, &LostAt(place));
            lost
        });
        both * (0.5 * self.strength * self.strength)
    }

    #[inline(always)]
    fn signed<F: Real>(&self, st: V2<F>, footprint: F) -> V3<F> {
        let look = VectorAt((st, self.addressing.wrap));
        let [x, y, z] = Mips::look(self.map, self.mips.as_ref(), footprint, &look);
        V3::new(x * self.signs.x, y * self.signs.y, z)
    }
}

/// In every other copy of a mirrored picture its slopes point the other way.
#[inline(always)]
fn unmirrored<F: Real>(slope: F, c: F) -> F {
    let half = c.floor() * 0.5;
    let is_copy = !half.floor().eq(half);
    F::select(is_copy, -slope, slope)
}
