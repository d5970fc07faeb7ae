//! Arrays that vectors are read from and written to, and sets of their places.

use std::ops::{BitAnd, BitOr, Not};

use super::simd::{Simd, SimdBase, SimdMask};
use super::wide::{Wide, WideBits, WideMask};

/// `N` values, where `N` is a multiple of every vector's lanes, aligned to the widest.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub struct Lanes<T, const N: usize>(pub [T; N], Gap);

/// A cache line between the columns of a table. Without it those of 1024 floats would lie 4096 bytes apart, and the
/// same place of all of them in one and the same set of the first cache, which holds eight or twelve lines: every loop
/// over more columns than that would wait for the second cache.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Gap([u8; 64]);

impl<T: Copy, const N: usize> Lanes<T, N> {
    /// The same for all.
    #[must_use]
    pub const fn splat(x: T) -> Self {
        Self([x; N], Gap([0; 64]))
    }

    /// The part of a group: `width` neighbours. Both must fit.
    #[inline(always)]
    #[must_use]
    pub fn group(&self, group: usize, width: usize) -> &[T] {
        // The remainder changes nothing; it lets the compiler see that the slice fits.
        let first = group * width % N;
        &self.0[first..first + width]
    }

    /// [`Self::group`], to write to.
    #[inline(always)]
    pub fn group_mut(&mut self, group: usize, width: usize) -> &mut [T] {
        let first = group * width % N;
        &mut self.0[first..first + width]
    }
}

impl<const N: usize> Lanes<f32, N> {
    /// Reads one vector.
    #[inline(always)]
    pub fn load<S: Simd>(&self, simd: S, group: usize) -> S::f32s {
        S::f32s::from_slice(simd, self.group(group, S::f32s::LEN))
    }

    /// Writes one vector.
    #[inline(always)]
    pub fn store<S: Simd>(&mut self, group: usize, x: S::f32s) {
        x.store_slice(self.group_mut(group, S::f32s::LEN));
    }

    /// Reads one vector of numbers.
    #[inline(always)]
    pub(crate) fn get<S: Simd>(&self, simd: S, group: usize) -> Wide<S> {
        Wide(self.load(simd, group))
    }

    /// Writes one vector of numbers.
    #[inline(always)]
    pub(crate) fn set<S: Simd>(&mut self, group: usize, x: Wide<S>) {
        self.store::<S>(group, x.0);
    }
}

impl<const N: usize> Lanes<u32, N> {
    /// Reads one vector.
    #[inline(always)]
    pub(crate) fn get<S: Simd>(&self, simd: S, group: usize) -> WideBits<S> {
        WideBits(S::u32s::from_slice(simd, self.group(group, S::u32s::LEN)))
    }
}

/// A set of up to `64 · W` places.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PlaceSet<const W: usize>(pub [u64; W]);

impl<const W: usize> PlaceSet<W> {
    /// No place.
    pub const EMPTY: Self = Self([0; W]);

    /// Number of places.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.0.iter().map(|word| u64::from(word.count_ones())).sum()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.iter().all(|&word| word == 0)
    }

    /// Whether a place is in it.
    #[must_use]
    pub const fn contains(&self, place: usize) -> bool {
        self.0[place / 64] >> (place % 64) & 1 != 0
    }

    /// Adds a place.
    pub const fn insert(&mut self, place: usize) {
        self.0[place / 64] |= 1 << (place % 64);
    }

    /// Takes a place out.
    pub const fn remove(&mut self, place: usize) {
        self.0[place / 64] &= !(1 << (place % 64));
    }

    /// All places in order.
    pub fn iter(&self) -> impl Iterator<Item = usize> {
        let words = self.0.into_iter().enumerate();
        words.flat_map(|(word, bits)| ones(bits).map(move |bit| word * 64 + bit))
    }

    /// The groups of a vector's width that have any of the places, in order.
    #[inline(always)]
    pub(crate) fn groups<S: Simd>(self) -> impl Iterator<Item = usize> {
        (0..64 * W / S::f32s::LEN).filter(move |&group| self.bits::<S>(group) != 0)
    }

    /// The lanes of a group as bits.
    #[inline(always)]
    pub(crate) const fn bits<S: Simd>(&self, group: usize) -> u64 {
        let first = group * S::f32s::LEN;
        let all = u64::MAX >> (64 - S::f32s::LEN);
        self.0[first / 64 % W] >> (first % 64) & all
    }

    /// The lanes of a group.
    #[inline(always)]
    pub(crate) fn mask<S: Simd>(&self, simd: S, group: usize) -> WideMask<S> {
        WideMask(S::mask32s::from_bitmask(simd, self.bits::<S>(group)))
    }

    /// Adds lanes of a group.
    #[inline(always)]
    pub(crate) fn add<S: Simd>(&mut self, group: usize, mask: WideMask<S>) {
        let first = group * S::f32s::LEN;
        self.0[first / 64 % W] |= mask.0.to_bitmask() << (first % 64);
    }
}

impl<const W: usize> BitAnd for PlaceSet<W> {
    type Output = Self;
    fn bitand(mut self, o: Self) -> Self {
        self.0.iter_mut().zip(o.0).for_each(|(a, b)| *a &= b);
        self
    }
}

impl<const W: usize> BitOr for PlaceSet<W> {
    type Output = Self;
    fn bitor(mut self, o: Self) -> Self {
        self.0.iter_mut().zip(o.0).for_each(|(a, b)| *a |= b);
        self
    }
}

impl<const W: usize> Not for PlaceSet<W> {
    type Output = Self;
    fn not(self) -> Self {
        Self(self.0.map(|word| !word))
    }
}

/// Positions of the bits that are set, in order.
pub fn ones(mut bits: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = bits.trailing_zeros() as usize;
        bits &= bits.wrapping_sub(1);
        (bit < 64).then_some(bit)
    })
}
