//! Functions that give the same bits on every machine.
//!
//! The system's sine and exponential may differ in the last place from one platform to the next. These use
//! only additions, multiplications and roundings, which IEEE 754 fixes to the bit.

/// The next lower whole number, for |x| below 2^62.
///
/// The library's `floor` is a function call on processors before SSE 4.1, which is what this program is
/// built for; a conversion is not.
#[must_use]
pub fn floor(x: f64) -> i64 {
    let towards_zero = x as i64;
    towards_zero - i64::from(x < towards_zero as f64)
}

/// `i` brought into `0..n` by whole tiles (`n > 0`); the usual case, already inside, costs no division.
#[must_use]
pub fn wrap(i: i64, n: usize) -> usize {
    let n = n as i64;
    (if (0..n).contains(&i) {
        i
    } else {
        i.rem_euclid(n)
    }) as usize
}

/// `(−1)^k / (2k + first)!` for the eight terms of a Taylor series.
const fn taylor(first: u32) -> [f64; 8] {
    let mut terms = [1.0; 8];
    let mut k = 1;
    while k < 8 {
        let n = (2 * k as u32 + first) as f64;
        terms[k] = -terms[k - 1] / (n * (n - 1.0));
        k += 1;
    }
    terms
}
const SIN: [f64; 8] = taylor(1);
const COS: [f64; 8] = taylor(0);

/// Sine and cosine of an angle in turns, to about 1e-15.
///
/// Reduced to an eighth of a turn around the nearest quarter, where Taylor series of eight terms suffice:
/// `(π/4)^16 / 16! < 2e-15`.
#[must_use]
pub fn sin_cos_turns(turns: f64) -> (f64, f64) {
    let quarters = (turns - floor(turns) as f64) * 4.0;
    let nearest = floor(quarters + 0.5);
    let x = (quarters - nearest as f64) * std::f64::consts::FRAC_PI_2;
    let x2 = x * x;
    let series =
        |coefficients: &[f64; 8]| coefficients.iter().rev().fold(0.0, |sum, c| sum * x2 + c);
    let (sin, cos) = (x * series(&SIN), series(&COS));
    match nearest {
        1 => (cos, -sin),
        2 => (-sin, -cos),
        3 => (-cos, sin),
        _ => (sin, cos),
    }
}

/// `e^−x` for `x ≥ 0` (negative arguments count as 0), to about 1e-15; exactly 0 beyond `e^−690`.
#[must_use]
pub fn exp_neg(x: f64) -> f64 {
    let x = x.max(0.0);
    let halvings = floor(x.min(1e6) * std::f64::consts::LOG2_E + 0.5);
    if halvings > 1000 {
        return 0.0;
    }
    let rest = halvings as f64 * std::f64::consts::LN_2 - x;
    let (mut term, mut sum) = (1.0, 1.0);
    for n in 1..=14 {
        term *= rest / f64::from(n);
        sum += term;
    }
    sum * f64::from_bits((1023 - halvings as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agree_with_the_system_library() {
        for i in -400..400 {
            let x = f64::from(i) * 0.013_7;
            let (sin, cos) = sin_cos_turns(x);
            let (s, c) = (x * std::f64::consts::TAU).sin_cos();
            assert!(
                (sin - s).abs() < 1e-13 && (cos - c).abs() < 1e-13,
                "at {x} turns"
            );
            let y = x.abs() * 5.0;
            assert!((exp_neg(y) - (-y).exp()).abs() < 1e-14, "at {y}");
        }
    }
}
