//! Samples → the sums of the film.

use super::super::Frame;
use super::{Column3, PLACES, Places, get_rgb, groups};
use crate::math::simd::{Kernel, Simd};
use crate::math::wide::Wide;
use crate::math::{LinearRgb, Real as _};

/// Adds the samples in `active` to the sums; the first one replaces what they held. One that is not finite
/// counts as black; returns how many are.
pub fn add(
    frame: &Frame<'_>,
    active: &Places,
    first: bool,
    radiance: &Column3,
    sums: &mut Column3,
) -> u64 {
    let mut finite = Places::EMPTY;
    frame.level.run_or_plain(Add {
        first,
        radiance,
        sums,
        finite: &mut finite,
    });
    (*active & !finite).count()
}

struct Add<'a> {
    first: bool,
    radiance: &'a Column3,
    sums: &'a mut Column3,
    finite: &'a mut Places,
}

impl Kernel for Add<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let black = LinearRgb::splat(Wide::new(simd, 0.0), LinearRgb::BLACK);
        for group in 0..groups::<S>(PLACES) {
            let sample = get_rgb(simd, self.radiance, group);
            let LinearRgb { r, g, b } = sample;
            let finite = r.is_finite() & g.is_finite() & b.is_finite();
            self.finite.add(group, finite);
            let sample = LinearRgb::select(finite, sample, black);
            let sum = if self.first {
                sample
            } else {
                get_rgb(simd, self.sums, group) + sample
            };
            let [red, green, blue] = &mut *self.sums;
            red.set(group, sum.r);
            green.set(group, sum.g);
            blue.set(group, sum.b);
        }
    }
}
