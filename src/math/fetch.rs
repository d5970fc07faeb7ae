//! Elements of a table by index, one for each vector lane: the one door to the processor's gather instructions.
//!
//! Without them every lane asks for itself, and what it finds goes through memory into the vector, which waits for
//! all of it: three times as long on a Zen 3. Each function gives the same bits at every level; the plain loop of
//! [`each`] is the twin that tests compare with.

#![expect(unsafe_code, reason = "gather instructions take a bare address")]

use glam::{Vec2, Vec3};

use super::simd::{
    Bytes as _, ExtractToken as _, Select as _, Simd, SimdBase as _, SimdMask, gathers,
};

/// Most lanes that a vector of any machine has.
const MAX_LANES: usize = 16;

/// Added to whole numbers from 0 to 2³², it leaves them in the lower half of a double's bits.
pub(crate) const WHOLE: f64 = 4_503_599_627_370_496.0;

/// What is made of `N` words of 32 bits.
///
/// # Safety
/// The words are all that there is, in the order of memory: `N` times four bytes, every one of them initialised.
pub unsafe trait Words<const N: usize>: Copy {
    /// The words.
    fn words(self) -> [u32; N];
}

// SAFETY: a word.
unsafe impl Words<1> for u32 {
    #[inline(always)]
    fn words(self) -> [u32; 1] {
        [self]
    }
}
// SAFETY: as wide as a word.
unsafe impl Words<1> for f32 {
    #[inline(always)]
    fn words(self) -> [u32; 1] {
        [self.to_bits()]
    }
}
// SAFETY: arrays lie without gaps.
unsafe impl<const N: usize> Words<N> for [u32; N] {
    #[inline(always)]
    fn words(self) -> [u32; N] {
        self
    }
}
// SAFETY: arrays lie without gaps.
unsafe impl<const N: usize> Words<N> for [f32; N] {
    #[inline(always)]
    fn words(self) -> [u32; N] {
        self.map(f32::to_bits)
    }
}
// SAFETY: four bytes; machines that gather have the lowest first.
unsafe impl Words<1> for [u8; 4] {
    #[inline(always)]
    fn words(self) -> [u32; 1] {
        [u32::from_le_bytes(self)]
    }
}
// SAFETY: two words of two numbers each; machines that gather have the lower first.
unsafe impl Words<2> for [u16; 4] {
    #[inline(always)]
    fn words(self) -> [u32; 2] {
        let [a, b, c, d] = self.map(u32::from);
        [a | b << 16, c | d << 16]
    }
}
// SAFETY: two floats, `repr(C)`.
unsafe impl Words<2> for Vec2 {
    #[inline(always)]
    fn words(self) -> [u32; 2] {
        self.to_array().words()
    }
}
// SAFETY: three floats, `repr(C)`.
unsafe impl Words<3> for Vec3 {
    #[inline(always)]
    fn words(self) -> [u32; 3] {
        self.to_array().words()
    }
}

/// The words of the elements at indices.
///
/// # Panics
/// If one is beyond the table.
#[inline(always)]
pub(super) fn words<S: Simd, T: Words<N>, const N: usize>(
    table: &[T],
    at: S::u32s,
) -> [S::u32s; N] {
    const { assert!(size_of::<T>() == 4 * N, "elements without gaps") };
    let simd = at.token();
    let mut found = [at; N];
    if gathers(simd) && table.len() <= i32::MAX as usize / N {
        check(at.simd_lt(table.len() as u32));
        let as_rows = match N {
            2 => true,
            3 => at.simd_lt((table.len() - 1) as u32).all_true(),
            _ => false,
        };
        if as_rows {
            // SAFETY: the vectors gather, and every index is in the table; where four words are read for three, an element
            // follows.
            let columns = unsafe { rows::<S, N>(table.as_ptr().cast(), at) };
            found.copy_from_slice(&columns[..N]);
            return found;
        }
        let first = at * N as u32;
        for (n, found) in found.iter_mut().enumerate() {
            let from = table.as_ptr().cast::<u32>().wrapping_add(n);
            // SAFETY: the vectors gather; every index is in the table, so that word `n < N` from `N` times the index on
            // is, too, and all of that is below 2³¹.
            *found = unsafe { gather::<S, 4>(from.cast(), first) };
        }
        return found;
    }
    let rows = each::<S, N>(at, |index| table[index].words());
    for n in 0..N {
        found[n] = S::u32s::from_slice(simd, &rows[n][..S::u32s::LEN]);
    }
    found
}

/// The numbers at indices in the lower half of each lane, those after them in the upper half.
///
/// # Panics
/// If one is beyond the table.
#[inline(always)]
pub(super) fn pairs<S: Simd>(table: &[u16], at: S::u32s) -> S::u32s {
    let simd = at.token();
    if gathers(simd) && (1..=i32::MAX as usize).contains(&table.len()) {
        check(at.simd_lt((table.len() - 1) as u32));
        // SAFETY: the vectors gather; every index is below that of the last number, and that is below 2³¹.
        return unsafe { gather::<S, 2>(table.as_ptr().cast(), at) };
    }
    let rows = each::<S, 1>(at, |index| [pair(table, index)]);
    S::u32s::from_slice(simd, &rows[0][..S::u32s::LEN])
}

/// The numbers at indices.
///
/// # Panics
/// If one is beyond the table.
#[inline(always)]
pub(super) fn halves<S: Simd>(table: &[u16], at: S::u32s) -> S::u32s {
    let simd = at.token();
    if gathers(simd) && (2..=i32::MAX as usize).contains(&table.len()) {
        let last = (table.len() - 1) as u32;
        let is_last = at.simd_eq(last);
        // The last one has none after it: it is the second of the last two.
        let both = pairs::<S>(table, is_last.select(at - 1, at));
        return is_last.select(both >> 16, both & 0xffff);
    }
    let rows = each::<S, 1>(at, |index| [u32::from(table[index])]);
    S::u32s::from_slice(simd, &rows[0][..S::u32s::LEN])
}

/// [`pairs`] for vectors of doubles: indices are [`WHOLE`] doubles, and what is found is whole numbers.
#[inline(always)]
pub(crate) fn wide_pairs<S: Simd>(table: &[u16], at: S::f64s) -> S::u64s {
    let simd = at.token();
    if gathers(simd) && (1..=i32::MAX as usize).contains(&table.len()) {
        // No for NaN, too.
        check(at.simd_ge(WHOLE) & at.simd_lt(WHOLE + (table.len() - 1) as f64));
        // SAFETY: the vectors gather; the lower halves are below the index of the last number, and that is below 2³¹.
        return unsafe { gather_wide::<S>(table.as_ptr(), at.bitcast()) };
    }
    let mut lanes = [0.0; MAX_LANES];
    at.store_slice(&mut lanes[..S::f64s::LEN]);
    let mut found = [0; MAX_LANES];
    for (found, lane) in found.iter_mut().zip(lanes).take(S::f64s::LEN) {
        *found = u64::from(pair(table, lane.to_bits() as u32 as usize));
    }
    S::u64s::from_slice(simd, &found[..S::u64s::LEN])
}

/// That all indices are in the table.
#[inline(always)]
fn check<S: Simd>(within: impl SimdMask<S>) {
    if !within.all_true() {
        beyond();
    }
}

#[cold]
#[inline(never)]
fn beyond() -> ! {
    panic!("index out of bounds of a table");
}

/// Tells memory that the elements at these indices will soon be asked for. Changes nothing else, and any index will do.
#[inline(always)]
pub(super) fn prefetch<S: Simd, T>(table: &[T], at: S::u32s) {
    let mut lanes = [0; MAX_LANES];
    at.store_slice(&mut lanes[..S::u32s::LEN]);
    for &index in &lanes[..S::u32s::LEN] {
        hint(table.as_ptr().wrapping_add(index as usize));
    }
}

/// A number in the lower half, the one after it in the upper.
#[inline(always)]
pub(super) fn pair(table: &[u16], index: usize) -> u32 {
    let both = &table[index..index + 2];
    u32::from(both[0]) | u32::from(both[1]) << 16
}

/// What `fetch` finds at each index: `[word][lane]`.
#[inline(always)]
fn each<S: Simd, const N: usize>(
    at: S::u32s,
    fetch: impl Fn(usize) -> [u32; N],
) -> [[u32; MAX_LANES]; N] {
    let mut lanes = [0; MAX_LANES];
    at.store_slice(&mut lanes[..S::u32s::LEN]);
    let mut found = [[0; MAX_LANES]; N];
    each_of(&lanes[..S::u32s::LEN], fetch, &mut found);
    found
}

/// Never inlined: as part of a kernel, the compiler unrolls it into hundreds of insertions into vector registers.
#[inline(never)]
fn each_of<const N: usize>(
    at: &[u32],
    fetch: impl Fn(usize) -> [u32; N],
    found: &mut [[u32; MAX_LANES]; N],
) {
    for (lane, &index) in at.iter().enumerate().take(MAX_LANES) {
        let words = fetch(index as usize);
        for n in 0..N {
            found[n][lane] = words[n];
        }
    }
}

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
use x86::{gather, gather_wide, hint, rows};

#[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
use elsewhere::{gather, gather_wide, hint, rows};

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
mod x86 {
    #[cfg(target_arch = "x86")]
    use std::arch::x86 as arch;
    #[cfg(target_arch = "x86_64")]
    use std::arch::x86_64 as arch;

    use super::super::simd::{ExtractToken as _, Simd, SimdBase as _};

    /// Brings the line of an address into the caches.
    #[inline(always)]
    pub fn hint<T>(at: *const T) {
        // SAFETY: every processor of this kind has it, and nothing is read, whatever the address.
        unsafe { arch::_mm_prefetch::<{ arch::_MM_HINT_T0 }>(at.cast()) }
    }

    /// The 32 bits at `at` times `SCALE` bytes from an address, for each lane.
    ///
    /// # Safety
    /// [`gathers`]; as signed numbers all of `at` are at least 0, and the four bytes there may be read.
    #[inline(always)]
    pub unsafe fn gather<S: Simd, const SCALE: i32>(from: *const u8, at: S::u32s) -> S::u32s {
        let simd = at.token();
        let mut words = [0_u32; super::MAX_LANES];
        let words = &mut words[..S::u32s::LEN];
        at.store_slice(words);
        if S::u32s::LEN == 16 {
            // SAFETY: sixteen lanes are AVX-512; sixteen words are read and written, and the rest as asked.
            unsafe {
                let at = arch::_mm512_loadu_si512(words.as_ptr().cast());
                let found = arch::_mm512_i32gather_epi32::<SCALE>(at, from.cast());
                arch::_mm512_storeu_si512(words.as_mut_ptr().cast(), found);
            }
        } else {
            // SAFETY: eight lanes are AVX2; eight words are read and written, and the rest as asked.
            unsafe {
                let at = arch::_mm256_loadu_si256(words.as_ptr().cast());
                let found = arch::_mm256_i32gather_epi32::<SCALE>(from.cast(), at);
                arch::_mm256_storeu_si256(words.as_mut_ptr().cast(), found);
            }
        }
        S::u32s::from_slice(simd, words)
    }

    /// The first three words of the elements of `N` words, two or three, at `at`; of two, the third means nothing.
    ///
    /// One load for each element, and rows are turned into columns: on a Zen 4 a fraction of the time that one gather for
    /// each word takes.
    ///
    /// # Safety
    /// [`gathers`](super::gathers); from `N` times each index on, two words may be read if `N` is 2, four if it is 3.
    #[inline(always)]
    pub unsafe fn rows<S: Simd, const N: usize>(from: *const f32, at: S::u32s) -> [S::u32s; 3] {
        let simd = at.token();
        let mut places = [0_u32; super::MAX_LANES];
        at.store_slice(&mut places[..S::u32s::LEN]);
        let mut columns = [[0_u32; super::MAX_LANES]; 3];
        // SAFETY: sixteen lanes are AVX-512, eight AVX2; columns have room for sixteen, and the rest as asked.
        unsafe {
            if S::u32s::LEN == 16 {
                let a = four_rows::<N>(from, &places, 0);
                let b = four_rows::<N>(from, &places, 1);
                let c = four_rows::<N>(from, &places, 2);
                let d = four_rows::<N>(from, &places, 3);
                let (ab, cd) = (
                    arch::_mm512_unpacklo_ps(a, b),
                    arch::_mm512_unpacklo_ps(c, d),
                );
                let turned = [
                    arch::_mm512_shuffle_ps::<FIRST>(ab, cd),
                    arch::_mm512_shuffle_ps::<SECOND>(ab, cd),
                    arch::_mm512_shuffle_ps::<FIRST>(
                        arch::_mm512_unpackhi_ps(a, b),
                        arch::_mm512_unpackhi_ps(c, d),
                    ),
                ];
                for n in 0..3 {
                    arch::_mm512_storeu_ps(columns[n].as_mut_ptr().cast(), turned[n]);
                }
            } else {
                let a = two_rows::<N>(from, &places, 0);
                let b = two_rows::<N>(from, &places, 1);
                let c = two_rows::<N>(from, &places, 2);
                let d = two_rows::<N>(from, &places, 3);
                let (ab, cd) = (
                    arch::_mm256_unpacklo_ps(a, b),
                    arch::_mm256_unpacklo_ps(c, d),
                );
                let turned = [
                    arch::_mm256_shuffle_ps::<FIRST>(ab, cd),
                    arch::_mm256_shuffle_ps::<SECOND>(ab, cd),
                    arch::_mm256_shuffle_ps::<FIRST>(
                        arch::_mm256_unpackhi_ps(a, b),
                        arch::_mm256_unpackhi_ps(c, d),
                    ),
                ];
                for n in 0..3 {
                    arch::_mm256_storeu_ps(columns[n].as_mut_ptr().cast(), turned[n]);
                }
            }
        }
        let mut found = [at; 3];
        for n in 0..3 {
            found[n] = S::u32s::from_slice(simd, &columns[n][..S::u32s::LEN]);
        }
        found
    }

    /// The first two of each four, of both vectors.
    const FIRST: i32 = 0b01_00_01_00;
    /// The last two.
    const SECOND: i32 = 0b11_10_11_10;

    /// The element at the place of a lane.
    ///
    /// # Safety
    /// As for [`rows`].
    #[inline(always)]
    unsafe fn row<const N: usize>(
        from: *const f32,
        places: &[u32; super::MAX_LANES],
        lane: usize,
    ) -> arch::__m128 {
        // SAFETY: as asked; processors that gather have these loads, from any address.
        unsafe {
            let at = from.add(places[lane] as usize * N);
            if N == 2 {
                arch::_mm_castpd_ps(arch::_mm_load_sd(at.cast()))
            } else {
                arch::_mm_loadu_ps(at)
            }
        }
    }

    /// The elements of lane `first` and of the fourth after it.
    ///
    /// # Safety
    /// As for [`rows`], and AVX2.
    #[inline(always)]
    unsafe fn two_rows<const N: usize>(
        from: *const f32,
        places: &[u32; super::MAX_LANES],
        first: usize,
    ) -> arch::__m256 {
        // SAFETY: as asked.
        unsafe {
            let a = arch::_mm256_castps128_ps256(row::<N>(from, places, first));
            arch::_mm256_insertf128_ps::<1>(a, row::<N>(from, places, first + 4))
        }
    }

    /// The elements of lane `first` and of every fourth after it.
    ///
    /// # Safety
    /// As for [`rows`], and AVX-512.
    #[inline(always)]
    unsafe fn four_rows<const N: usize>(
        from: *const f32,
        places: &[u32; super::MAX_LANES],
        first: usize,
    ) -> arch::__m512 {
        // SAFETY: as asked.
        unsafe {
            let a = arch::_mm512_castps128_ps512(row::<N>(from, places, first));
            let a = arch::_mm512_insertf32x4::<1>(a, row::<N>(from, places, first + 4));
            let a = arch::_mm512_insertf32x4::<2>(a, row::<N>(from, places, first + 8));
            arch::_mm512_insertf32x4::<3>(a, row::<N>(from, places, first + 12))
        }
    }

    /// Two 16-bit numbers from each index in the lower halves of `at` on, in the lower half of each lane.
    ///
    /// # Safety
    /// [`gathers`]; as signed numbers the lower halves are at least 0, and both numbers may be read.
    #[inline(always)]
    pub unsafe fn gather_wide<S: Simd>(from: *const u16, at: S::u64s) -> S::u64s {
        let simd = at.token();
        let at = at & u64::from(u32::MAX);
        let mut lanes = [0_u64; super::MAX_LANES / 2];
        let lanes = &mut lanes[..S::u64s::LEN];
        at.store_slice(lanes);
        if S::u64s::LEN == 8 {
            // SAFETY: eight lanes of 64 bits are AVX-512; all of them are read and written, and the rest as asked.
            unsafe {
                let at = arch::_mm512_loadu_si512(lanes.as_ptr().cast());
                let found = arch::_mm512_i64gather_epi32::<2>(at, from.cast());
                let found = arch::_mm512_cvtepu32_epi64(found);
                arch::_mm512_storeu_si512(lanes.as_mut_ptr().cast(), found);
            }
        } else {
            // SAFETY: four lanes of 64 bits are AVX2; all of them are read and written, and the rest as asked.
            unsafe {
                let at = arch::_mm256_loadu_si256(lanes.as_ptr().cast());
                let found = arch::_mm256_i64gather_epi32::<2>(from.cast(), at);
                let found = arch::_mm256_cvtepu32_epi64(found);
                arch::_mm256_storeu_si256(lanes.as_mut_ptr().cast(), found);
            }
        }
        S::u64s::from_slice(simd, lanes)
    }
}

#[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
mod elsewhere {
    use super::super::simd::Simd;

    /// Nothing that stable Rust could ask for.
    #[inline(always)]
    pub const fn hint<T>(_: *const T) {}

    /// # Safety
    /// Must not be called.
    pub unsafe fn gather<S: Simd, const SCALE: i32>(_: *const u8, _: S::u32s) -> S::u32s {
        unreachable!("there are no gather instructions")
    }

    /// # Safety
    /// Must not be called.
    pub unsafe fn rows<S: Simd, const N: usize>(_: *const f32, _: S::u32s) -> [S::u32s; 3] {
        unreachable!("there are no gather instructions")
    }

    /// # Safety
    /// Must not be called.
    pub unsafe fn gather_wide<S: Simd>(_: *const u16, _: S::u64s) -> S::u64s {
        unreachable!("there are no gather instructions")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::simd::{Kernel, SimdLevel};

    /// Elements, halves and pairs of a table by each kind of vector.
    struct Fetches<'a> {
        words: &'a [[u32; 3]],
        pairs_of_words: &'a [[u32; 2]],
        halves: &'a [u16],
        at: [u32; MAX_LANES],
    }

    impl Kernel for Fetches<'_> {
        #[inline(always)]
        fn run<S: Simd>(self, simd: S) {
            let Self {
                words,
                pairs_of_words,
                halves,
                at,
            } = self;
            let lanes = S::u32s::LEN;
            let indices = S::u32s::from_slice(simd, &at[..lanes]);
            let stored = |x: S::u32s| {
                let mut row = [0; MAX_LANES];
                x.store_slice(&mut row[..lanes]);
                row
            };
            let at = &at[..lanes];
            let found = super::words::<S, [u32; 3], 3>(words, indices);
            for n in 0..3 {
                for (found, &i) in stored(found[n]).iter().zip(at) {
                    assert_eq!(*found, words[i as usize][n]);
                }
            }
            let found = super::words::<S, [u32; 2], 2>(pairs_of_words, indices);
            for n in 0..2 {
                for (found, &i) in stored(found[n]).iter().zip(at) {
                    assert_eq!(*found, pairs_of_words[i as usize][n]);
                }
            }
            for (found, &i) in stored(super::halves::<S>(halves, indices)).iter().zip(at) {
                assert_eq!(*found, u32::from(halves[i as usize]));
            }
            if halves.len() < 2 {
                return;
            }
            let first = indices.min(halves.len() as u32 - 2);
            let firsts = stored(first);
            for (found, i) in stored(pairs::<S>(halves, first))
                .iter()
                .zip(firsts)
                .take(lanes)
            {
                assert_eq!(*found, pair(halves, i as usize));
            }
            let mut whole = [0.0; MAX_LANES];
            for (whole, i) in whole.iter_mut().zip(firsts) {
                *whole = WHOLE + f64::from(i);
            }
            let lanes = S::f64s::LEN;
            let found = wide_pairs::<S>(halves, S::f64s::from_slice(simd, &whole[..lanes]));
            let mut row = [0; MAX_LANES];
            found.store_slice(&mut row[..lanes]);
            for (found, i) in row.iter().zip(firsts).take(lanes) {
                assert_eq!(*found, u64::from(pair(halves, i as usize)));
            }
        }
    }

    #[test]
    fn every_level_fetches_what_is_there() {
        let number = |i: u32| i.wrapping_mul(2_654_435_761);
        for len in [1_u32, 2, 3, 7, 16, 1000] {
            // Boxed slices end where they end, so that tools which watch memory see every step beyond.
            let words: Box<[[u32; 3]]> = (0..len).map(|i| [i, i + 1, i + 2].map(number)).collect();
            let pairs_of_words: Box<[[u32; 2]]> =
                (0..len).map(|i| [i, i + 1].map(number)).collect();
            let halves: Box<[u16]> = (0..len).map(|i| (number(i) >> 16) as u16).collect();
            for round in 0..50 {
                let any: [u32; MAX_LANES] =
                    std::array::from_fn(|lane| number(round * 16 + lane as u32) % len);
                for at in [
                    any,
                    any.map(|i| len - 1 - i.min(1).min(len - 1)),
                    [len - 1; MAX_LANES],
                ] {
                    for level in SimdLevel::ALL {
                        if level.is_available() {
                            level.run_or_plain(Fetches {
                                words: &words,
                                pairs_of_words: &pairs_of_words,
                                halves: &halves,
                                at,
                            });
                        }
                    }
                }
            }
        }
    }

    /// An element of a table that is not there.
    struct Beyond<'a>(&'a [u16], u32);

    impl Kernel for Beyond<'_> {
        #[inline(always)]
        fn run<S: Simd>(self, simd: S) {
            let Self(table, index) = self;
            let at = S::u32s::splat(simd, index);
            halves::<S>(table, at);
        }
    }

    #[test]
    fn no_level_reads_beyond_a_table() {
        for level in SimdLevel::ALL {
            for (len, index) in [
                (4, 4),
                (4, 5),
                (1, 1),
                (2, 2),
                (0, 0),
                (4, u32::MAX),
                (4, 1 << 31),
            ] {
                let table = vec![7; len];
                if level.is_available() {
                    let read = || level.run_or_plain(Beyond(&table, index));
                    assert!(
                        std::panic::catch_unwind(read).is_err(),
                        "{level} {len} {index}"
                    );
                }
            }
        }
    }
}
