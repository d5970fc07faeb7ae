//! The same look-ups at many points, one point at a time and by vector lanes: for micro-benchmarks.

use crate::geometry::simd::SimdLevel;
use crate::math::lanes::Lanes;
use crate::math::simd::{Kernel, Simd, SimdBase as _};
use crate::math::{Real, V2, V3};
use crate::texture::{ColorMap, HeightMap, NormalMap, Wrap};

/// Points that are worked on at a time: a tile.
pub const POINTS: usize = 1024;

/// Three numbers for each point.
pub type Found = [Lanes<f32, POINTS>; 3];

/// What is done at a point.
#[derive(Debug, Clone, Copy)]
pub enum PointWork<'a> {
    /// Height and slope.
    Height(&'a HeightMap),
    /// Stored normal.
    Normal(&'a NormalMap),
    /// Linear colour.
    Color(&'a ColorMap),
}

impl PointWork<'_> {
    /// The numbers at one place, or at one for each lane.
    #[inline(always)]
    fn at<F: Real>(&self, st: V2<F>) -> V3<F> {
        match self {
            Self::Height(map) => {
                let found = map.sample_slope(st, Wrap::Repeat);
                V3::new(found.height, found.slope_st.x, found.slope_st.y)
            }
            Self::Normal(map) => map.sample(st, Wrap::Repeat),
            Self::Color(map) => {
                let color = map.sample(st, Wrap::Repeat);
                V3::new(color.r, color.g, color.b)
            }
        }
    }

    /// At each point by itself.
    pub fn alone(&self, points: &[Lanes<f32, POINTS>; 2], found: &mut Found) {
        for i in 0..POINTS {
            let V3 { x, y, z } = self.at(V2::new(points[0].0[i], points[1].0[i]));
            (found[0].0[i], found[1].0[i], found[2].0[i]) = (x, y, z);
        }
    }

    /// At as many points at once as the level has lanes.
    pub fn by_lanes(&self, level: SimdLevel, points: &[Lanes<f32, POINTS>; 2], found: &mut Found) {
        level.run_or_plain(ByLanes {
            work: self,
            points,
            found,
        });
    }
}

struct ByLanes<'a> {
    work: &'a PointWork<'a>,
    points: &'a [Lanes<f32, POINTS>; 2],
    found: &'a mut Found,
}

impl Kernel for ByLanes<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        for group in 0..POINTS / S::f32s::LEN {
            let [s, t] = self.points;
            let found = self
                .work
                .at(V2::new(s.get(simd, group), t.get(simd, group)));
            let [x, y, z] = &mut *self.found;
            x.set(group, found.x);
            y.set(group, found.y);
            z.set(group, found.z);
        }
    }
}
