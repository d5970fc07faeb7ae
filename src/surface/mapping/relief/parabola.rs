//! Where a ray meets the bilinear patch of a cell: the first root of a parabola.

use crate::math::simd::{Simd, SimdBase as _};

/// The first σ in `[0, len]` at which `a σ² + b σ + c` is not above 0.
#[inline(always)]
pub(super) fn first_not_above(a: f64, b: f64, c: f64, len: f64) -> Option<f64> {
    if c <= 0.0 {
        return Some(0.0);
    }
    let at_end = (a * len + b) * len + c;
    // A parabola that ends above 0 can only have dipped below on the way if it opens upwards.
    let dips = || a > 0.0 && b < 0.0 && -b < 2.0 * a * len && b * b >= 4.0 * a * c;
    if at_end > 0.0 && !dips() {
        return None;
    }
    let root = (b * b - 4.0 * a * c).max(0.0).sqrt();
    // Without cancellation; of two positive roots the smaller.
    let first = if b < 0.0 {
        2.0 * c / (root - b)
    } else {
        -(b + root) / (2.0 * a)
    };
    Some(if first.is_finite() {
        first.clamp(0.0, len)
    } else {
        len
    })
}

/// In which lanes [`first_not_above`] finds something.
#[inline(always)]
pub(super) fn is_not_above<S: Simd>([a, b, c]: [S::f64s; 3], len: S::f64s) -> S::mask64s {
    let starts = c.simd_le(0.0);
    let at_end = (a * len + b) * len + c;
    let dips = a.simd_gt(0.0)
        & b.simd_lt(0.0)
        & (-b).simd_lt(a * 2.0 * len)
        & (b * b).simd_ge(a * 4.0 * c);
    starts | at_end.simd_le(0.0) | dips
}

#[cfg(test)]
mod tests {
    use super::first_not_above;

    #[test]
    fn the_first_root_is_found_from_above_only() {
        let close = |found: Option<f64>, root: f64| {
            assert!((found.expect("a root") - root).abs() < 1e-14, "{found:?}");
        };
        close(first_not_above(0.0, -1.0, 0.25, 1.0), 0.25);
        close(first_not_above(1.0, -1.0, 0.16, 1.0), 0.2);
        close(first_not_above(-1.0, 0.0, 0.25, 1.0), 0.5);
        close(first_not_above(-1.0, 0.1, 0.3, 1.0), 0.6);
        assert_eq!(first_not_above(1.0, -1.0, 0.26, 1.0), None, "no root");
        assert_eq!(
            first_not_above(1.0, -1.0, 0.16, 0.1),
            None,
            "beyond the end"
        );
        assert_eq!(
            first_not_above(0.0, 1.0, -0.5, 1.0),
            Some(0.0),
            "below already"
        );
        assert_eq!(first_not_above(0.0, 0.0, 0.5, 1.0), None);
        assert_eq!(first_not_above(0.0, -0.5, 0.5, 1.0), Some(1.0));
    }
}
