//! Integer hashing for samples that repeat on every machine and thread count.

/// Mixes 32 bits so that each input bit affects each output bit (Ellis' `lowbias32` constants).
#[must_use]
pub const fn hash_u32(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// The upper 24 bits as a number in `[0, 1)`, exact in `f32`.
#[must_use]
pub fn unit_f32_from_bits(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}
