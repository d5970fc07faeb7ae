//! Samples → the sums of the film.

use super::super::Frame;
use super::{Column3, Places, get_rgb, groups, set_rgb};
use crate::math::simd::{Kernel, Simd};
use crate::math::wide::Wide;
use crate::math::{LinearRgb, Real as _};

/// Makes samples black that are not finite; returns the places of the others among `active`.
pub fn drop_non_finite(
    frame: &Frame<'_>,
    count: usize,
    active: Places,
    radiance: &mut Column3,
) -> Places {
    let mut finite = Places::EMPTY;
    frame.level.run_or_plain(DropNonFinite {
        count,
        radiance,
        finite: &mut finite,
    });
    finite & active
}

struct DropNonFinite<'a> {
    count: usize,
    radiance: &'a mut Column3,
    finite: &'a mut Places,
}

impl Kernel for DropNonFinite<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let black = LinearRgb::splat(Wide::new(simd, 0.0), LinearRgb::BLACK);
        for group in 0..groups::<S>(self.count) {
            let LinearRgb { r, g, b } = get_rgb(simd, self.radiance, group);
            let finite = r.is_finite() & g.is_finite() & b.is_finite();
            set_rgb(self.radiance, group, !finite, black);
            self.finite.add(group, finite);
        }
    }
}

/// Adds the samples of a full pass to the sums; the first one replaces what they held.
pub fn add(frame: &Frame<'_>, active: Places, first: bool, radiance: &Column3, sums: &mut Column3) {
    frame.level.run_or_plain(Add {
        active,
        first,
        radiance,
        sums,
    });
}

struct Add<'a> {
    active: Places,
    first: bool,
    radiance: &'a Column3,
    sums: &'a mut Column3,
}

impl Kernel for Add<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        for group in 0..groups::<S>(super::PLACES) {
            let sample = get_rgb(simd, self.radiance, group);
            let sum = if self.first {
                sample
            } else {
                get_rgb(simd, self.sums, group) + sample
            };
            set_rgb(self.sums, group, self.active.mask(simd, group), sum);
        }
    }
}
