//! Integer hashing for samples that repeat on every machine and thread count.

use super::real::Bits;

/// Mixes 32 bits so that each input bit affects each output bit (Ellis' `lowbias32` constants).
#[inline(always)]
#[must_use]
pub fn hash<B: Bits>(mut x: B) -> B {
    x = x.xor_each(x.shr(16)).times(0x7feb_352d);
    x = x.xor_each(x.shr(15)).times(0x846c_a68b);
    x.xor_each(x.shr(16))
}

/// The upper 24 bits as a number in `[0, 1)`, exact in `f32`.
#[inline(always)]
#[must_use]
pub fn unit_interval<B: Bits>(bits: B) -> B::Real {
    bits.shr(8).signed_to_real() * (1.0 / 16_777_216.0)
}
