//! A number, or several side by side: what the arithmetic of surfaces, maps and light is written for.
//!
//! A function that takes any [`Real`] is the plain code and the vector code in one: with `f32` it works on
//! one point, with the vectors of [`simd`](super::simd) on as many as the machine has lanes. Both do the
//! same operations in the same order and round after each, so each lane holds the bits of the plain code.
//!
//! Branches become [`Mask`]s and selections. Such functions must be `#[inline(always)]`, or they are
//! compiled without the vector instructions of their caller.

use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use super::fetch::{self, Words};

/// Numbers with the rounding of `f32`.
pub trait Real:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f32, Output = Self>
    + Sub<f32, Output = Self>
    + Mul<f32, Output = Self>
{
    /// The answer to a comparison, for each lane.
    type Mask: Mask;
    /// 32 bits for each lane.
    type Bits: Bits<Real = Self>;

    /// `x` in as many lanes as `self` has.
    #[must_use]
    fn splat(self, x: f32) -> Self;
    /// Square root.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Magnitude.
    #[must_use]
    fn abs(self) -> Self;
    /// The magnitude of `self` with the sign of `sign`.
    #[must_use]
    fn copysign(self, sign: Self) -> Self;
    /// The largest whole number not above.
    #[must_use]
    fn floor(self) -> Self;
    /// `self < o`; no for NaN.
    fn lt(self, o: Self) -> Self::Mask;
    /// `self <= o`; no for NaN.
    fn le(self, o: Self) -> Self::Mask;
    /// `self == o`; no for NaN.
    fn eq(self, o: Self) -> Self::Mask;
    /// `yes` where the mask holds, else `no`.
    #[must_use]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// The representation.
    fn to_bits(self) -> Self::Bits;
    /// Whole part towards zero. The number must be in `[0, 2³¹)`.
    fn to_index(self) -> Self::Bits;

    /// `f` of each lane that is `wanted`, one after the other; 0 elsewhere. For work that lanes cannot do
    /// in step.
    fn each<const I: usize, const O: usize>(
        wanted: Self::Mask,
        inputs: [Self; I],
        f: impl Fn([f32; I]) -> [f32; O],
    ) -> [Self; O];

    /// `self > o`; no for NaN.
    #[inline(always)]
    fn gt(self, o: Self) -> Self::Mask {
        o.lt(self)
    }
    /// `self >= o`; no for NaN.
    #[inline(always)]
    fn ge(self, o: Self) -> Self::Mask {
        o.le(self)
    }
    /// The larger; `o` where `self` is NaN.
    #[inline(always)]
    #[must_use]
    fn larger(self, o: Self) -> Self {
        Self::select(o.lt(self), self, o)
    }
    /// The smaller; `o` where `self` is NaN.
    #[inline(always)]
    #[must_use]
    fn smaller(self, o: Self) -> Self {
        Self::select(self.lt(o), self, o)
    }
    /// Whether it is neither infinite nor NaN.
    #[inline(always)]
    fn is_finite(self) -> Self::Mask {
        self.abs().le(self.splat(f32::MAX))
    }
    /// The next number towards infinity where `up`, towards minus infinity where `down`, else the same.
    /// Numbers nearer to 0 than `smallest` become that, with the sign of the step. Infinities and NaN stay.
    #[inline(always)]
    #[must_use]
    fn stepped(self, up: Self::Mask, down: Self::Mask, smallest: f32) -> Self {
        let zero = self.splat(0.0);
        let bits = self.to_bits();
        // Bits count away from zero on both sides of it.
        let grows = (zero.lt(self) & up) | (self.lt(zero) & down);
        let away = Self::Bits::select(grows, bits.plus(1), bits.plus(u32::MAX));
        let smallest = self.splat(smallest);
        let from_zero = Self::select(up, smallest, -smallest);
        let moved = Self::select(self.abs().lt(smallest), from_zero, away.to_real());
        Self::select((up | down) & self.is_finite(), moved, self)
    }
}

/// Yes or no for each lane.
pub trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// Whether any lane says yes.
    fn any(self) -> bool;
    /// Whether every lane does.
    fn all(self) -> bool;
}

/// 32 bits for each lane, with wrapping arithmetic.
pub trait Bits: Copy + Debug {
    /// The numbers with as many lanes.
    type Real: Real<Bits = Self>;

    /// `x` in as many lanes as `self` has.
    #[must_use]
    fn splat(self, x: u32) -> Self;
    /// Sum.
    #[must_use]
    fn plus(self, x: u32) -> Self;
    /// Sum of each pair.
    #[must_use]
    fn plus_each(self, o: Self) -> Self;
    /// Product.
    #[must_use]
    fn times(self, x: u32) -> Self;
    /// Bits in both.
    #[must_use]
    fn and(self, x: u32) -> Self;
    /// Bits in either.
    #[must_use]
    fn or(self, x: u32) -> Self;
    /// Bits in one of each pair.
    #[must_use]
    fn xor_each(self, o: Self) -> Self;
    /// Bits in either of each pair.
    #[must_use]
    fn or_each(self, o: Self) -> Self;
    /// Moved to higher places, by less than 32.
    #[must_use]
    fn shl(self, by: u32) -> Self;
    /// Moved to lower places, by less than 32.
    #[must_use]
    fn shr(self, by: u32) -> Self;
    /// `yes` where the mask holds, else `no`.
    #[must_use]
    fn select(mask: <Self::Real as Real>::Mask, yes: Self, no: Self) -> Self;
    /// Which pairs are equal.
    fn equals_each(self, o: Self) -> <Self::Real as Real>::Mask;
    /// Which are equal to `x`.
    fn equals(self, x: u32) -> <Self::Real as Real>::Mask;
    /// The numbers with this representation.
    fn to_real(self) -> Self::Real;
    /// The numbers nearest to these as signed integers.
    fn signed_to_real(self) -> Self::Real;
    /// The words of the elements at these indices.
    ///
    /// # Panics
    /// If one is beyond the table, as for the others.
    fn fetch<T: Words<N>, const N: usize>(self, table: &[T]) -> [Self; N];
    /// Tells memory that the elements at these indices will soon be asked for. Changes nothing else; a single index
    /// is not worth it.
    fn prefetch<T>(self, table: &[T]);
    /// The numbers at these indices.
    #[must_use]
    fn fetch_half(self, table: &[u16]) -> Self;
    /// The numbers at these indices in the lower halves, those after them in the upper.
    #[must_use]
    fn fetch_pair(self, table: &[u16]) -> Self;
}

impl Real for f32 {
    type Mask = bool;
    type Bits = u32;

    #[inline(always)]
    fn each<const I: usize, const O: usize>(
        wanted: bool,
        inputs: [Self; I],
        f: impl Fn([Self; I]) -> [Self; O],
    ) -> [Self; O] {
        if wanted { f(inputs) } else { [0.0; O] }
    }

    #[inline(always)]
    fn splat(self, x: f32) -> Self {
        x
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self::abs(self)
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        Self::copysign(self, sign)
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self::floor(self)
    }
    #[inline(always)]
    fn lt(self, o: Self) -> bool {
        self < o
    }
    #[inline(always)]
    fn le(self, o: Self) -> bool {
        self <= o
    }
    #[inline(always)]
    fn eq(self, o: Self) -> bool {
        self == o
    }
    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
    #[inline(always)]
    fn to_bits(self) -> u32 {
        Self::to_bits(self)
    }
    #[inline(always)]
    fn to_index(self) -> u32 {
        self as u32
    }
}

impl Mask for bool {
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
    #[inline(always)]
    fn all(self) -> bool {
        self
    }
}

impl Bits for u32 {
    type Real = f32;

    #[inline(always)]
    fn splat(self, x: u32) -> Self {
        x
    }
    #[inline(always)]
    fn plus(self, x: u32) -> Self {
        self.wrapping_add(x)
    }
    #[inline(always)]
    fn plus_each(self, o: Self) -> Self {
        self.wrapping_add(o)
    }
    #[inline(always)]
    fn times(self, x: u32) -> Self {
        self.wrapping_mul(x)
    }
    #[inline(always)]
    fn and(self, x: u32) -> Self {
        self & x
    }
    #[inline(always)]
    fn or(self, x: u32) -> Self {
        self | x
    }
    #[inline(always)]
    fn xor_each(self, o: Self) -> Self {
        self ^ o
    }
    #[inline(always)]
    fn or_each(self, o: Self) -> Self {
        self | o
    }
    #[inline(always)]
    fn shl(self, by: u32) -> Self {
        self << by
    }
    #[inline(always)]
    fn shr(self, by: u32) -> Self {
        self >> by
    }
    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
    #[inline(always)]
    fn equals_each(self, o: Self) -> bool {
        self == o
    }
    #[inline(always)]
    fn equals(self, x: u32) -> bool {
        self == x
    }
    #[inline(always)]
    fn to_real(self) -> f32 {
        f32::from_bits(self)
    }
    #[inline(always)]
    fn signed_to_real(self) -> f32 {
        self as i32 as f32
    }
    #[inline(always)]
    fn fetch<T: Words<N>, const N: usize>(self, table: &[T]) -> [Self; N] {
        table[self as usize].words()
    }
    #[inline(always)]
    fn prefetch<T>(self, _: &[T]) {}
    #[inline(always)]
    fn fetch_half(self, table: &[u16]) -> Self {
        Self::from(table[self as usize])
    }
    #[inline(always)]
    fn fetch_pair(self, table: &[u16]) -> Self {
        fetch::pair(table, self as usize)
    }
}
