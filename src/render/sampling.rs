//! Where in a pixel its samples lie.

use crate::math::{hash_u32, unit_f32_from_bits};

/// Place of sample `index` in the pixel (column `x`, row `y`), both coordinates in `[0, 1)`.
///
/// Sample 0 is the pixel's centre. Any first 2ᵏ samples of a pixel fall one each into all elementary
/// intervals of that size (a (0, 2)-sequence): 64 samples are stratified 8×8, 64×1 and everything between.
/// A pure function of its arguments, so pictures repeat whatever the threads.
///
/// Source: Sobol' dimensions 0 and 1 with hash-based Owen scrambling (Laine & Karras 2011; Burley 2020),
/// then a digital shift that takes the first point to the centre and keeps every stratum.
#[must_use]
pub fn pixel_sample([x, y]: [u32; 2], index: u32) -> [f32; 2] {
    if index == 0 {
        return [0.5, 0.5];
    }
    let seed = hash_u32(x ^ hash_u32(y ^ 0x9e37_79b9));
    let scrambled =
        |bits: u32, seed: u32| owen_scramble(bits, seed) ^ owen_scramble(0, seed) ^ 0x8000_0000;
    let first = scrambled(index.reverse_bits(), seed);
    let second = scrambled(sobol_dimension_1(index), hash_u32(seed ^ 0x5bd1_e995));
    [unit_f32_from_bits(first), unit_f32_from_bits(second)]
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
fn owen_scramble(bits: u32, seed: u32) -> u32 {
    let mut x = bits.reverse_bits();
    x = x.wrapping_add(seed);
    x ^= x.wrapping_mul(0x6c50_b47c);
    x ^= x.wrapping_mul(0xb82f_1e52);
    x ^= x.wrapping_mul(0xc7af_e638);
    x ^= x.wrapping_mul(0x8d22_f6e6);
    x.reverse_bits()
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
                        let [sx, sy] = pixel_sample(pixel, k);
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
