//! Functions that give the same bits on every machine.
//!
//! The system's sine and exponential may differ in the last place from one platform to the next. These use
//! only additions, multiplications and roundings, which IEEE 754 fixes to the bit.

/// Sine and cosine of an angle in turns, to about 1e-15.
///
/// Reduced to an eighth of a turn around the nearest quarter, where Taylor series to the 17th power
/// suffice: `(π/4)^17 / 17! < 5e-17`.
#[must_use]
pub fn sin_cos_turns(turns: f64) -> (f64, f64) {
    let quarters = (turns - turns.floor()) * 4.0;
    let nearest = quarters.round();
    let x = (quarters - nearest) * std::f64::consts::FRAC_PI_2;
    let x2 = x * x;
    let series = |first: f64, start: f64| {
        let (mut term, mut sum, mut n) = (first, first, start);
        for _ in 0..8 {
            term *= -x2 / ((n + 1.0) * (n + 2.0));
            sum += term;
            n += 2.0;
        }
        sum
    };
    let (sin, cos) = (series(x, 1.0), series(1.0, 0.0));
    match nearest as u8 {
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
    let halvings = (x * std::f64::consts::LOG2_E).round();
    if halvings > 1000.0 {
        return 0.0;
    }
    let rest = halvings * std::f64::consts::LN_2 - x;
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
