//! [`Real`] for the vectors of a machine.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use super::fetch::{self, Words};
use super::real::{Bits, Mask, Real};
use super::simd::{
    Bytes as _, ExtractToken as _, Select as _, Simd, SimdBase, SimdCvtFloat as _, SimdFloat,
    SimdMask, larger, smaller,
};

/// Most lanes that a vector of any machine has.
const MAX_LANES: usize = 16;

/// As many numbers as a vector has lanes.
#[derive(Debug, Clone, Copy)]
pub struct Wide<S: Simd>(pub S::f32s);

/// Yes or no for each lane of a [`Wide`].
#[derive(Clone, Copy)]
pub struct WideMask<S: Simd>(pub S::mask32s);

/// 32 bits for each lane of a [`Wide`].
#[derive(Debug, Clone, Copy)]
pub struct WideBits<S: Simd>(pub S::u32s);

impl<S: Simd> Wide<S> {
    /// `x` in each lane.
    #[inline(always)]
    pub fn new(simd: S, x: f32) -> Self {
        Self(S::f32s::splat(simd, x))
    }
}

macro_rules! operators {
    ($($trait:ident $method:ident $operator:tt),*) => {$(
        impl<S: Simd> $trait for Wide<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, o: Self) -> Self {
                Self(self.0 $operator o.0)
            }
        }
    )*};
}
operators!(Add add +, Sub sub -, Mul mul *, Div div /);

macro_rules! operators_with_one {
    ($($trait:ident $method:ident $operator:tt),*) => {$(
        impl<S: Simd> $trait<f32> for Wide<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, x: f32) -> Self {
                Self(self.0 $operator x)
            }
        }
    )*};
}
operators_with_one!(Add add +, Sub sub -, Mul mul *);

impl<S: Simd> Neg for Wide<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl<S: Simd> BitAnd for WideMask<S> {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, o: Self) -> Self {
        Self(self.0 & o.0)
    }
}
impl<S: Simd> BitOr for WideMask<S> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, o: Self) -> Self {
        Self(self.0 | o.0)
    }
}
impl<S: Simd> Not for WideMask<S> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl<S: Simd> Mask for WideMask<S> {
    #[inline(always)]
    fn any(self) -> bool {
        self.0.any_true()
    }
    #[inline(always)]
    fn all(self) -> bool {
        self.0.all_true()
    }
}

impl<S: Simd> Real for Wide<S> {
    type Mask = WideMask<S>;
    type Bits = WideBits<S>;

    #[inline(always)]
    fn splat(self, x: f32) -> Self {
        Self::new(self.0.token(), x)
    }
    #[inline(always)]
    fn larger(self, o: Self) -> Self {
        Self(larger(self.0, o.0))
    }
    #[inline(always)]
    fn smaller(self, o: Self) -> Self {
        Self(smaller(self.0, o.0))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs())
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        Self(self.0.copysign(sign.0))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self(self.0.floor())
    }
    #[inline(always)]
    fn lt(self, o: Self) -> WideMask<S> {
        WideMask(self.0.simd_lt(o.0))
    }
    #[inline(always)]
    fn le(self, o: Self) -> WideMask<S> {
        WideMask(self.0.simd_le(o.0))
    }
    #[inline(always)]
    fn eq(self, o: Self) -> WideMask<S> {
        WideMask(self.0.simd_eq(o.0))
    }
    #[inline(always)]
    fn select(mask: WideMask<S>, yes: Self, no: Self) -> Self {
        Self(mask.0.select(yes.0, no.0))
    }
    #[inline(always)]
    fn to_bits(self) -> WideBits<S> {
        WideBits(self.0.bitcast())
    }
    #[inline(always)]
    fn each<const I: usize, const O: usize>(
        wanted: WideMask<S>,
        inputs: [Self; I],
        f: impl Fn([f32; I]) -> [f32; O],
    ) -> [Self; O] {
        let simd = wanted.0.token();
        let mut lanes = [[0.0; I]; MAX_LANES];
        for (i, input) in inputs.iter().enumerate() {
            for (lane, &x) in input.0.as_slice().iter().enumerate() {
                lanes[lane % MAX_LANES][i] = x;
            }
        }
        let mut found = [[0.0; MAX_LANES]; O];
        each_lane(wanted.0.to_bitmask(), &lanes, f, &mut found);
        let mut wide = [Self::new(simd, 0.0); O];
        for o in 0..O {
            wide[o] = Self(S::f32s::from_slice(simd, &found[o][..S::f32s::LEN]));
        }
        wide
    }
    #[inline(always)]
    fn to_index(self) -> WideBits<S> {
        // Through signed integers, which machines before AVX-512 convert in one instruction.
        WideBits(self.0.to_int::<S::i32s>().bitcast())
    }
}

impl<S: Simd> Bits for WideBits<S> {
    type Real = Wide<S>;

    #[inline(always)]
    fn splat(self, x: u32) -> Self {
        Self(S::u32s::splat(self.0.token(), x))
    }
    #[inline(always)]
    fn plus(self, x: u32) -> Self {
        Self(self.0 + x)
    }
    #[inline(always)]
    fn plus_each(self, o: Self) -> Self {
        Self(self.0 + o.0)
    }
    #[inline(always)]
    fn times(self, x: u32) -> Self {
        Self(self.0 * x)
    }
    #[inline(always)]
    fn and(self, x: u32) -> Self {
        Self(self.0 & x)
    }
    #[inline(always)]
    fn or(self, x: u32) -> Self {
        Self(self.0 | x)
    }
    #[inline(always)]
    fn xor_each(self, o: Self) -> Self {
        Self(self.0 ^ o.0)
    }
    #[inline(always)]
    fn or_each(self, o: Self) -> Self {
        Self(self.0 | o.0)
    }
    #[inline(always)]
    fn shl(self, by: u32) -> Self {
        Self(self.0 << by)
    }
    #[inline(always)]
    fn shr(self, by: u32) -> Self {
        Self(self.0 >> by)
    }
    #[inline(always)]
    fn select(mask: WideMask<S>, yes: Self, no: Self) -> Self {
        Self(mask.0.select(yes.0, no.0))
    }
    #[inline(always)]
    fn equals_each(self, o: Self) -> WideMask<S> {
        WideMask(self.0.simd_eq(o.0))
    }
    #[inline(always)]
    fn equals(self, x: u32) -> WideMask<S> {
        WideMask(self.0.simd_eq(S::u32s::splat(self.0.token(), x)))
    }
    #[inline(always)]
    fn to_real(self) -> Wide<S> {
        Wide(self.0.bitcast())
    }
    #[inline(always)]
    fn signed_to_real(self) -> Wide<S> {
        let signed: S::i32s = self.0.bitcast();
        Wide(S::f32s::float_from(signed))
    }
    #[inline(always)]
    fn fetch<T: Words<N>, const N: usize>(self, table: &[T]) -> [Self; N] {
        let found = fetch::words::<S, T, N>(table, self.0);
        let mut wide = [self; N];
        for n in 0..N {
            wide[n] = Self(found[n]);
        }
        wide
    }
    #[inline(always)]
    fn prefetch<T>(self, table: &[T]) {
        fetch::prefetch::<S, T>(table, self.0);
    }
    #[inline(always)]
    fn fetch_half(self, table: &[u16]) -> Self {
        Self(fetch::halves::<S>(table, self.0))
    }
    #[inline(always)]
    fn fetch_pair(self, table: &[u16]) -> Self {
        Self(fetch::pairs::<S>(table, self.0))
    }
}

/// `found[o][lane]` is the `o`-th number of `f` of each lane in the mask.
#[inline(never)]
fn each_lane<const I: usize, const O: usize>(
    mut wanted: u64,
    lanes: &[[f32; I]; MAX_LANES],
    f: impl Fn([f32; I]) -> [f32; O],
    found: &mut [[f32; MAX_LANES]; O],
) {
    while wanted != 0 {
        let lane = wanted.trailing_zeros() as usize % MAX_LANES;
        wanted &= wanted - 1;
        for (found, x) in found.iter_mut().zip(f(lanes[lane])) {
            found[lane] = x;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::simd::{Kernel, SimdLevel};

    const NUMBERS: [f32; 8] = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
        f32::MIN_POSITIVE,
    ];

    /// Bits of the larger and of the smaller of each pair, by one level.
    #[derive(Default)]
    struct Extremes(Vec<[u32; 2]>);

    impl Kernel for &mut Extremes {
        #[inline(always)]
        fn run<S: Simd>(self, simd: S) {
            for a in NUMBERS {
                for b in NUMBERS {
                    let (wide_a, wide_b) = (Wide::new(simd, a), Wide::new(simd, b));
                    let mut found = [0; 2];
                    let both = [wide_a.larger(wide_b), wide_a.smaller(wide_b)];
                    for (found, wide) in found.iter_mut().zip(both) {
                        let mut lanes = [0.0; MAX_LANES];
                        wide.0.store_slice(&mut lanes[..S::f32s::LEN]);
                        *found = lanes[0].to_bits();
                    }
                    self.0.push(found);
                }
            }
        }
    }

    #[test]
    fn extremes_are_the_same_bits_at_every_level() {
        let pairs = NUMBERS.into_iter().flat_map(|a| NUMBERS.map(|b| (a, b)));
        let expected: Vec<_> = pairs
            .map(|(a, b)| [if a > b { a } else { b }, if a < b { a } else { b }].map(f32::to_bits))
            .collect();
        for level in SimdLevel::ALL {
            let mut found = Extremes::default();
            if level.is_available() {
                level.run_or_plain(&mut found);
                assert_eq!(found.0, expected, "{level}");
            }
        }
    }
}
