//! Eight `f32` side by side.
//!
//! Made of glam's four-lane vectors, which are SSE2 or NEON registers: loops over arrays were left
//! scalar by the compiler. Each lane does exactly what scalar code would; there is no fused multiply-add.

use std::ops::{Mul, Sub};

use glam::Vec4;

use super::triangle::LANES;

/// Eight numbers.
#[derive(Debug, Clone, Copy)]
pub(super) struct F32x8([Vec4; 2]);

impl F32x8 {
    /// The same number in each lane.
    #[inline(always)]
    pub(super) const fn splat(x: f32) -> Self {
        Self([Vec4::splat(x); 2])
    }

    /// From memory.
    #[inline(always)]
    pub(super) const fn load(x: &[f32; LANES]) -> Self {
        let [a, b, c, d, e, f, g, h] = *x;
        Self([Vec4::new(a, b, c, d), Vec4::new(e, f, g, h)])
    }

    /// To memory.
    #[inline(always)]
    pub(super) fn to_array(self) -> [f32; LANES] {
        let mut out = [0.0; LANES];
        self.0[0].write_to_slice(&mut out[..4]);
        self.0[1].write_to_slice(&mut out[4..]);
        out
    }

    /// The larger of each pair; where `self` is NaN, `other` or NaN.
    #[inline(always)]
    pub(super) fn max(self, other: Self) -> Self {
        Self([self.0[0].max(other.0[0]), self.0[1].max(other.0[1])])
    }

    /// The smaller of each pair; where `self` is NaN, `other` or NaN.
    #[inline(always)]
    pub(super) fn min(self, other: Self) -> Self {
        Self([self.0[0].min(other.0[0]), self.0[1].min(other.0[1])])
    }

    /// Bit `i` says whether lane `i` is greater than the other's; no where one is NaN.
    #[inline(always)]
    pub(super) fn greater(self, other: Self) -> u32 {
        let [a, b] = [0, 1].map(|half| self.0[half].cmpgt(other.0[half]).bitmask());
        a | b << 4
    }

    /// Bit `i` says whether lane `i` is equal to the other's; no where one is NaN.
    #[inline(always)]
    pub(super) fn equal(self, other: Self) -> u32 {
        let [a, b] = [0, 1].map(|half| self.0[half].cmpeq(other.0[half]).bitmask());
        a | b << 4
    }
}

impl Mul for F32x8 {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        Self([self.0[0] * o.0[0], self.0[1] * o.0[1]])
    }
}

impl Sub for F32x8 {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self([self.0[0] - o.0[0], self.0[1] - o.0[1]])
    }
}
