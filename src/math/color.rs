//! Linear light and its sRGB encoding.

use std::ops::{Add, AddAssign, Mul, MulAssign, Sub};

use serde::{Deserialize, Serialize};

use super::Real;

/// Linear light with Rec. 709 primaries. Any range: values above 1 are brighter than white.
///
/// With vector lanes, one colour for each.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LinearRgb<F = f32> {
    /// Red.
    pub r: F,
    /// Green.
    pub g: F,
    /// Blue.
    pub b: F,
}

impl LinearRgb {
    /// No light.
    pub const BLACK: Self = Self::new(0.0, 0.0, 0.0);
    /// Unit light in each channel.
    pub const WHITE: Self = Self::new(1.0, 1.0, 1.0);

    /// From three channels.
    #[must_use]
    pub const fn new(r: f32, g: f32, b: f32) -> Self {
        Self { r, g, b }
    }

    /// The same value in each channel.
    #[must_use]
    pub const fn gray(value: f32) -> Self {
        Self::new(value, value, value)
    }

    /// Largest channel.
    #[must_use]
    pub const fn max_channel(self) -> f32 {
        self.r.max(self.g).max(self.b)
    }

    /// Whether every channel is a finite number.
    #[must_use]
    pub const fn is_finite(self) -> bool {
        self.r.is_finite() && self.g.is_finite() && self.b.is_finite()
    }

    /// `f` of each channel.
    #[must_use]
    pub fn map(self, f: impl Fn(f32) -> f32) -> Self {
        Self::new(f(self.r), f(self.g), f(self.b))
    }
}

impl<F: Copy> LinearRgb<F> {
    /// The channels in order.
    #[must_use]
    pub const fn to_array(self) -> [F; 3] {
        [self.r, self.g, self.b]
    }
}

impl<F: Real> LinearRgb<F> {
    /// The same colour in as many lanes as `like` has.
    #[inline(always)]
    #[must_use]
    pub fn splat(like: F, c: LinearRgb) -> Self {
        Self {
            r: like.splat(c.r),
            g: like.splat(c.g),
            b: like.splat(c.b),
        }
    }

    /// `yes` where the mask holds, else `no`.
    #[inline(always)]
    #[must_use]
    pub fn select(mask: F::Mask, yes: Self, no: Self) -> Self {
        Self {
            r: F::select(mask, yes.r, no.r),
            g: F::select(mask, yes.g, no.g),
            b: F::select(mask, yes.b, no.b),
        }
    }
}

impl Serialize for LinearRgb {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.to_array().serialize(serializer)
    }
}
impl<'de> Deserialize<'de> for LinearRgb {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        <[f32; 3]>::deserialize(deserializer).map(Self::from)
    }
}
impl<F> From<[F; 3]> for LinearRgb<F> {
    #[inline(always)]
    fn from([r, g, b]: [F; 3]) -> Self {
        Self { r, g, b }
    }
}
impl From<LinearRgb> for [f32; 3] {
    fn from(c: LinearRgb) -> Self {
        c.to_array()
    }
}
impl<F: Real> Add for LinearRgb<F> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self {
            r: self.r + o.r,
            g: self.g + o.g,
            b: self.b + o.b,
        }
    }
}
impl<F: Real> Sub for LinearRgb<F> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self {
            r: self.r - o.r,
            g: self.g - o.g,
            b: self.b - o.b,
        }
    }
}
impl<F: Real> AddAssign for LinearRgb<F> {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}
impl<F: Real> Mul for LinearRgb<F> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        Self {
            r: self.r * o.r,
            g: self.g * o.g,
            b: self.b * o.b,
        }
    }
}
impl<F: Real> Mul<F> for LinearRgb<F> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, k: F) -> Self {
        Self {
            r: self.r * k,
            g: self.g * k,
            b: self.b * k,
        }
    }
}
impl MulAssign<f32> for LinearRgb {
    fn mul_assign(&mut self, k: f32) {
        *self = *self * k;
    }
}

/// Decodes one sRGB-encoded channel in `[0, 1]` (IEC 61966-2-1).
#[must_use]
pub fn linear_from_srgb(c: f32) -> f32 {
    if c <= 0.040_45 {
        c / 12.92
    } else {
        ((c + 0.055) / 1.055).powf(2.4)
    }
}

/// Encodes one linear channel; values outside `[0, 1]` are clamped, NaN becomes 0.
#[must_use]
pub fn srgb_from_linear(c: f32) -> f32 {
    // Written so that NaN becomes 0.
    let c = if c > 0.0 { c.min(1.0) } else { 0.0 };
    if c <= 0.003_130_8 {
        c * 12.92
    } else {
        1.055 * c.powf(1.0 / 2.4) - 0.055
    }
}

/// Encodes linear light into the three bytes that a screen takes, rounded to nearest.
#[must_use]
pub fn srgb8_from_linear(c: LinearRgb) -> [u8; 3] {
    c.to_array()
        .map(|x| (srgb_from_linear(x) * 255.0 + 0.5) as u8)
}

/// [`srgb8_from_linear`] by table: the same bytes, without a power per channel.
#[derive(Debug)]
pub struct SrgbEncoder {
    /// `thresholds[b]` is the smallest linear value that encodes to byte `b`.
    thresholds: [f32; 257],
    /// Byte of the smallest value in each bucket: 8 exponent and 8 mantissa bits of the value.
    buckets: Vec<u8>,
}

/// The smallest linear value told apart from 0 by the table's buckets: 2⁻¹³ is below the first threshold.
const FIRST_BUCKET_BITS: u32 = 0x3900_0000;
const BUCKET_SHIFT: u32 = 15;

impl SrgbEncoder {
    /// The one table.
    #[must_use]
    pub fn get() -> &'static Self {
        static TABLE: std::sync::LazyLock<SrgbEncoder> = std::sync::LazyLock::new(SrgbEncoder::new);
        &TABLE
    }

    fn new() -> Self {
        let encode = |x: f32| (srgb_from_linear(x) * 255.0 + 0.5) as u8;
        let mut thresholds = [f32::INFINITY; 257];
        thresholds[0] = 0.0;
        for byte in 1..=255_u8 {
            // Non-negative floats are ordered like their bits, so bisection over bits finds the exact one.
            let (mut low, mut high) = (0_u32, 1.0_f32.to_bits());
            while high - low > 1 {
                let middle = low + (high - low) / 2;
                if encode(f32::from_bits(middle)) < byte {
                    low = middle
                } else {
                    high = middle
                }
            }
            thresholds[usize::from(byte)] = f32::from_bits(high);
        }
        let count = (1.0_f32.to_bits() - FIRST_BUCKET_BITS) >> BUCKET_SHIFT;
        let buckets = (0..=count)
            .map(|i| encode(f32::from_bits(FIRST_BUCKET_BITS + (i << BUCKET_SHIFT))))
            .collect();
        Self {
            thresholds,
            buckets,
        }
    }

    /// Three bytes for the screen; equal to [`srgb8_from_linear`].
    #[must_use]
    pub fn encode(&self, c: LinearRgb) -> [u8; 3] {
        c.to_array().map(|x| {
            let x = if x > 0.0 { x.min(1.0) } else { 0.0 };
            let bucket = x.to_bits().saturating_sub(FIRST_BUCKET_BITS) >> BUCKET_SHIFT;
            let byte = self.buckets[bucket as usize];
            // A bucket is narrower than a step of the encoding, so at most one threshold lies in it.
            byte + u8::from(x >= self.thresholds[usize::from(byte) + 1])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_gives_the_bytes_of_the_formula() {
        let encoder = SrgbEncoder::get();
        let check = |x: f32| {
            let c = LinearRgb::gray(x);
            assert_eq!(encoder.encode(c), srgb8_from_linear(c), "at {x:e}");
        };
        for special in [
            0.0,
            -0.0,
            -1.0,
            1.0,
            2.0,
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::MIN_POSITIVE,
        ] {
            check(special);
        }
        for bits in (0..1.01_f32.to_bits()).step_by(997) {
            check(f32::from_bits(bits));
        }
        for &t in &encoder.thresholds[1..256] {
            check(t);
            check(t.next_down());
        }
    }
}
