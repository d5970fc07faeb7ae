//! Powers of numbers just below 1, as sharp highlights need them.

use std::ops::Mul;

use super::real::{Bits as _, Real};

/// Bits of `√½`.
const SQRT_HALF: u32 = 0x3f35_04f3;
/// Bits of 1.
const ONE: u32 = 0x3f80_0000;
/// Bits of the fraction.
const FRACTION: u32 = 0x007f_ffff;
const EXPONENT_BIAS: f32 = 127.0;

/// Powers below `e^LEAST` count as 0.
const LEAST: f32 = -87.0;

/// `(1 − miss)^exponent` for `miss` in `[0, 1)` and `exponent >= 0`.
///
/// Given as the distance from 1, because a number near 1 has only steps of 6·10⁻⁸ in `f32`, which an
/// exponent of 10⁴ and more turns into visible rings. The relative error is below 10⁻⁶ times one plus the
/// natural logarithm of the result; `0⁰` is 1.
#[inline(always)]
#[must_use]
pub fn power_below_one<F: Real + Mul<E, Output = F>, E>(miss: F, exponent: E) -> F {
    exp(ln_one_minus(miss) * exponent)
}

/// `ln(1 − m)`: `ln 2ᵏ + ln(1 + f)`, the second by its series in `f / (2 + f)`.
#[inline(always)]
fn ln_one_minus<F: Real>(miss: F) -> F {
    let one = miss.splat(1.0);
    let shifted = (one - miss).to_bits().plus(ONE - SQRT_HALF);
    let k = shifted.shr(23).signed_to_real() - EXPONENT_BIAS;
    let near_one = shifted.and(FRACTION).plus(SQRT_HALF).to_real();
    // For k = 0 nothing has been rounded away yet.
    let f = F::select(k.eq(one.splat(0.0)), -miss, near_one - one);
    let s = f / (f + 2.0);
    let s2 = s * s;
    let series = (((s2 * (2.0 / 11.0) + 2.0 / 9.0) * s2 + 2.0 / 7.0) * s2 + 2.0 / 5.0) * s2;
    let ln_1p = (series + 2.0 / 3.0) * s2 * s + s * 2.0;
    k * std::f32::consts::LN_2 + ln_1p
}

/// `eˣ` for `x <= 0`: `2ⁿ eʳ` with `|r| <= ln 2 / 2`, the second by its Taylor series.
#[inline(always)]
fn exp<F: Real>(x: F) -> F {
    // The upper part of ln 2 has few bits, so that its product with n is exact.
    const LN_2_HIGH: f32 = 0.693_359_4;
    const LN_2_LOW: f32 = -2.121_944_4e-4;
    let in_range = x.ge(x.splat(LEAST));
    let x = F::select(in_range, x, x.splat(0.0));
    let n = (x * std::f32::consts::LOG2_E + 0.5).floor();
    let r = (x - n * LN_2_HIGH) - n * LN_2_LOW;
    let tail = ((r * (1.0 / 720.0) + 1.0 / 120.0) * r + 1.0 / 24.0) * r + 1.0 / 6.0;
    let exp_r = ((tail * r + 0.5) * r) * r + r + 1.0;
    let two_n = (n + EXPONENT_BIAS).to_index().shl(23).to_real();
    F::select(in_range, exp_r * two_n, x.splat(0.0))
}

#[cfg(test)]
mod tests {
    use super::power_below_one;

    #[test]
    fn powers_agree_with_f64() {
        let mut miss = 1e-9_f32;
        while miss < 1.0 {
            for exponent in [0.0, 0.5, 1.0, 10.0, 100.0, 1e4, 1e6] {
                let exact = (f64::from(exponent) * (-f64::from(miss)).ln_1p()).exp();
                let found = f64::from(power_below_one(miss, exponent));
                let allowed = 1e-6 * exact * (1.0 + exact.max(1e-38).ln().abs()) + 1e-36;
                assert!(
                    (found - exact).abs() <= allowed,
                    "(1 − {miss})^{exponent} = {exact}, not {found}"
                );
            }
            miss *= 1.07;
        }
        assert_eq!(power_below_one(0.0_f32, 1e6), 1.0);
    }
}
