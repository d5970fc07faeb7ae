//! Where in a pixel its samples lie.

use crate::math::{Bits, Real as _, hash, unit_interval};

/// Place of sample `index` in the pixel (column `x`, row `y`), both coordinates in `[0, 1)`.
///
/// Sample 0 is the pixel's centre. Any first 2ᵏ samples of a pixel fall one each into all elementary
/// intervals of that size (a (0, 2)-sequence): 64 samples are stratified 8×8, 64×1 and everything between.
/// A pure function of its arguments, so pictures repeat whatever the threads.
///
/// Source: Sobol' dimensions 0 and 1 with hash-based Owen scrambling (Laine & Karras 2011; Burley 2020),
/// then a digital shift that takes the first point to the centre and keeps every stratum.
#[inline(always)]
#[must_use]
pub fn pixel_sample<B: Bits>([x, y]: [B; 2], index: u32) -> [B::Real; 2] {
    if index == 0 {
        let half = x.to_real().splat(0.5);
        return [half, half];
    }
    let seed = hash(x.xor_each(hash(y.xor_each(y.splat(0x9e37_79b9)))));
    let first = scrambled(index.reverse_bits(), seed);
    let other_seed = hash(seed.xor_each(seed.splat(0x5bd1_e995)));
    let second = scrambled(sobol_dimension_1(index), other_seed);
    [unit_interval(first), unit_interval(second)]
}

/// The point scrambled for a pixel, and shifted so that the pixel's first point lies in the centre.
#[inline(always)]
fn scrambled<B: Bits>(bits: u32, seed: B) -> B {
    let moved = owen_scramble(seed.splat(bits), seed);
    let first = owen_scramble(seed.splat(0), seed);
    moved.xor_each(first).xor_each(seed.splat(0x8000_0000))
}

/// Second dimension of the Sobol' sequence: direction numbers of the polynomial x + 1.
fn sobol_dimension_1(mut index: u32) -> u32 {
    let mut direction = 0x8000_0000_u32;
    let mut bits = 0;
    while index != 0 {
        if index & 1 == 1 {
            bits ^= direction;
        }
        direction ^= direction >> 1;
        index >>= 1;
    }
    bits
}

/// Nested uniform scrambling: each bit is flipped by a hash of the bits above it.
#[inline(always)]
fn owen_scramble<B: Bits>(bits: B, seed: B) -> B {
    let mut x = reversed(bits).plus_each(seed);
    x = x.xor_each(x.times(0x6c50_b47c));
    x = x.xor_each(x.times(0xb82f_1e52));
    x = x.xor_each(x.times(0xc7af_e638));
    x = x.xor_each(x.times(0x8d22_f6e6));
    reversed(x)
}

/// The bits in opposite order.
#[inline(always)]
fn reversed<B: Bits>(x: B) -> B {
    let swap = |x: B, by: u32, low: u32| x.shr(by).and(low).or_each(x.and(low).shl(by));
    let x = swap(x, 1, 0x5555_5555);
    let x = swap(x, 2, 0x3333_3333);
    let x = swap(x, 4, 0x0f0f_0f0f);
    let x = swap(x, 8, 0x00ff_00ff);
    x.shr(16).or_each(x.shl(16))
}

#[cfg(test)]
mod tests {
    use super::pixel_sample;

    #[test]
    fn every_power_of_two_is_stratified_in_both_ways() {
        for pixel in [[0, 0], [17, 3], [1279, 719]] {
            for log_count in 0..=8 {
                let count = 1_u32 << log_count;
                for log_columns in 0..=log_count {
                    let (columns, rows) =
                        (1_u32 << log_columns, 1_u32 << (log_count - log_columns));
                    let mut seen = vec![false; count as usize];
                    for k in 0..count {
                        let [sx, sy] = pixel_sample::<u32>(pixel, k);
                        assert!((0.0..1.0).contains(&sx) && (0.0..1.0).contains(&sy));
                        let cell =
                            (sy * rows as f32) as u32 * columns + (sx * columns as f32) as u32;
                        assert!(
                            !seen[cell as usize],
                            "two samples of {count} share a {columns}×{rows} cell at {pixel:?}"
                        );
                        seen[cell as usize] = true;
                    }
                }
            }
        }
    }

    #[test]
    fn the_first_sample_is_the_centre_and_pixels_differ() {
        assert_eq!(pixel_sample([5, 9], 0), [0.5, 0.5]);
        assert_ne!(pixel_sample([5, 9], 1), pixel_sample([6, 9], 1));
    }
}
