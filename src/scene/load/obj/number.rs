//! Numbers from bytes.

/// Powers of ten that `f64` holds exactly.
const EXACT_POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];

/// A finite decimal number, correctly rounded; `None` for anything else (hexadecimal, `nan`, overflow,
/// a decimal comma).
///
/// Up to 2⁵³ and 22 decimals the digits and the power of ten are both exact, so that one division rounds
/// once (Clinger 1990, the fast path of every parser); the rest goes to the standard library.
pub(in crate::scene::load) fn float(word: &[u8]) -> Option<f64> {
    plain(word).or_else(|| {
        let value: f64 = std::str::from_utf8(word).ok()?.parse().ok()?;
        value.is_finite().then_some(value)
    })
}

fn plain(word: &[u8]) -> Option<f64> {
    let (negative, digits) = match word {
        [b'-', rest @ ..] => (true, rest),
        rest => (false, rest),
    };
    // 19 digits fit u64.
    if digits.len() > 19 {
        return None;
    }
    let mut mantissa = 0_u64;
    let mut decimals = None;
    for (i, &b) in digits.iter().enumerate() {
        match b {
            b'0'..=b'9' => mantissa = mantissa * 10 + u64::from(b - b'0'),
            b'.' if decimals.is_none() => decimals = Some(digits.len() - i - 1),
            _ => return None,
        }
    }
    let has_digits = digits.len() > usize::from(decimals.is_some());
    if !has_digits || mantissa > 1 << 53 {
        return None;
    }
    let value = mantissa as f64 / EXACT_POWERS[decimals.unwrap_or(0)];
    Some(if negative { -value } else { value })
}

/// A decimal integer. Too many digits saturate, which is out of range for every use.
pub(in crate::scene::load) fn integer(word: &[u8]) -> Option<i64> {
    let (negative, digits) = match word {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        rest => (false, rest),
    };
    if digits.is_empty() {
        return None;
    }
    let mut value = 0_i64;
    for &b in digits {
        if !b.is_ascii_digit() {
            return None;
        }
        value = value.saturating_mul(10).saturating_add(i64::from(b - b'0'));
    }
    Some(if negative { -value } else { value })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_standard_library_to_the_bit() {
        let mut state = 7_u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            state >> 33
        };
        for _ in 0..20_000 {
            let (whole, part) = (random() % 100_000, random());
            let sign = if random() % 2 == 0 { "-" } else { "" };
            for text in [
                format!("{sign}{whole}.{part}"),
                format!("{sign}{whole}"),
                format!("{sign}.{part:010}"),
                format!("{sign}{whole}.{part}e-{}", part % 40),
            ] {
                let expected: f64 = text.parse().expect("a number");
                let got = float(text.as_bytes()).expect("a number");
                assert_eq!(got.to_bits(), expected.to_bits(), "{text}");
            }
        }
    }

    #[test]
    fn refuses_what_is_no_finite_decimal() {
        for text in [
            "", ".", "-", "nan", "inf", "1e400", "0x10", "1,5", "1.2.3", "--1", "1 ",
        ] {
            assert_eq!(float(text.as_bytes()), None, "{text:?}");
        }
        assert_eq!(float(b"+1.5"), Some(1.5));
        assert_eq!(float(b"5."), Some(5.0));
    }

    #[test]
    fn integers_saturate() {
        assert_eq!(integer(b"99999999999999999999"), Some(i64::MAX));
        assert_eq!(integer(b"-12"), Some(-12));
        assert_eq!(integer(b"1.0"), None);
        assert_eq!(integer(b"-"), None);
    }
}
