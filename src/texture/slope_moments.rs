//! How much slopes differ within what a ray's cone covers.

use super::grid::Floats;
use super::mips::halvings;
use super::{Grid, HeightMap, NormalMap, Wrap};
use crate::math::{Real, V2};

/// Means of two slopes a, b and of their products: `a, b, a², b², ab`. One level of halvings.
///
/// Source: Olano & Baker 2010, "LEAN Mapping".
#[derive(Debug, Clone, PartialEq)]
pub struct SlopeMoments(Grid<[f32; 5]>);

impl SlopeMoments {
    /// Moments of the slopes of heights per picture width and height, from half the map's size down to one texel.
    /// A texel's slope is the one in the middle of the cell to its right and below.
    #[must_use]
    pub fn of_heights(map: &HeightMap, wrap: Wrap) -> Vec<Self> {
        let (w, h) = (map.width(), map.height());
        let size = map.size();
        let next = |i: u32, n| wrap.index(i64::from(i) + 1, n);
        let slopes = |x: u32, y: u32| {
            let (right, below) = (next(x, w), next(y, h));
            let at = |x, y| map.texel(x, y);
            let (a, b, c, d) = (at(x, y), at(right, y), at(x, below), at(right, below));
            [
                (b - a + d - c) * 0.5 * size.x,
                (c - a + d - b) * 0.5 * size.y,
            ]
        };
        Self::halved([w, h], slopes)
    }

    /// Moments of stored slopes, `2c − 1`.
    #[must_use]
    pub fn of_slopes(map: &NormalMap) -> Vec<Self> {
        let [w, h] = map.size().to_array().map(|n| n as u32);
        Self::halved([w, h], |x, y| {
            let [r, g, _] = map.fraction(x, y);
            [2.0 * r - 1.0, 2.0 * g - 1.0]
        })
    }

    fn halved(size: [u32; 2], slopes: impl Fn(u32, u32) -> [f32; 2]) -> Vec<Self> {
        let moments = |x, y| {
            let [a, b] = slopes(x, y);
            [a, b, a * a, b * b, a * b]
        };
        halvings(size, moments).into_iter().map(Self).collect()
    }

    /// Variances of a and b and their covariance around `st`, bilinear.
    #[must_use]
    #[inline(always)]
    pub fn variances<F: Real>(&self, st: V2<F>, wrap: Wrap) -> [F; 3] {
        let cell = self.0.cell(st, wrap);
        let [a, b, aa, bb, ab] = self.0.mix(&cell, Floats);
        let zero = a.splat(0.0);
        // Rounding can leave a hair less than nothing.
        [
            (aa - a * a).larger(zero),
            (bb - b * b).larger(zero),
            ab - a * b,
        ]
    }

    /// Heap bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(self.0.texels())
    }
}
