//! Maps halved again and again, and means over what a ray's cone covers.

use super::{Grid, Wrap};
use crate::math::{Bits as _, Mask as _, Real, V2};

/// One way of reading a map at a place.
pub trait Look<F: Real, const N: usize> {
    /// What is read.
    type Map;

    /// The numbers at the place.
    fn at(&self, map: &Self::Map) -> [F; N];
}

/// A map that can be asked for ahead.
pub trait Ahead {
    /// Has memory bring what will be looked up around `st` soon.
    fn prefetch<F: Real>(&self, st: V2<F>, wrap: Wrap);
}

/// The halvings of a map that is tied to a material.
#[derive(Debug)]
pub struct Mips<'a, T> {
    /// From half the size down to one texel.
    pub halved: &'a [T],
    /// Texels of the full map per unit of texture coordinates, the geometric mean of both directions.
    pub rate: f32,
}

// Derived, they would ask the same of T.
impl<T> Clone for Mips<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<T> Copy for Mips<'_, T> {}

impl<T> Mips<'_, T> {
    /// Has memory bring what will be looked up soon of a map that is read at points. Which halvings are read of
    /// others is not known yet.
    #[inline(always)]
    pub fn prefetch<F: Real>(base: &T, mips: Option<&Self>, (st, wrap): (V2<F>, Wrap))
    where
        T: Ahead,
    {
        if mips.is_none() {
            base.prefetch(st, wrap);
        }
    }

    /// What `base` and its halvings give over a square of `footprint` units of texture coordinates: two levels,
    /// each bilinear, mixed by the logarithm of the footprint in texels. Without halvings, what `base` alone
    /// gives.
    ///
    /// Up to one texel it is the latter, too, to the bit.
    #[inline(always)]
    #[must_use]
    pub fn look<F: Real, L: Look<F, N, Map = T>, const N: usize>(
        base: &T,
        mips: Option<&Self>,
        footprint: F,
        look: &L,
    ) -> [F; N] {
        let (level, halved) = match mips {
            Some(mips) => (Some(mips.level(footprint)), mips.halved),
            None => (None, [].as_slice()),
        };
        let maps = std::iter::once(base).chain(halved).enumerate();
        mixed(level, maps, footprint.splat(0.0), look)
    }

    /// The same where only halvings tell anything, and the full map counts as zero.
    #[inline(always)]
    #[must_use]
    pub fn look_beyond<F: Real, L: Look<F, N, Map = T>, const N: usize>(
        &self,
        footprint: F,
        look: &L,
    ) -> [F; N] {
        let maps = (1..).zip(self.halved);
        mixed(
            Some(self.level(footprint)),
            maps,
            footprint.splat(0.0),
            look,
        )
    }

    /// How many times the map is halved until a texel is as wide as a footprint; 0 up to the number of halvings.
    #[inline(always)]
    fn level<F: Real>(&self, footprint: F) -> F {
        let zero = footprint.splat(0.0);
        let last = zero.splat(self.halved.len() as f32);
        log2(footprint * self.rate).larger(zero).smaller(last)
    }
}

/// The mean of maps, each with its level, weighed by how near that is to `level`; what the first map gives where
/// there is none.
///
/// One look-up for all levels in one loop: look-ups are long, and every place that calls one is compiled for each
/// kind of vector instructions.
#[inline(always)]
fn mixed<'m, F: Real, L: Look<F, N>, const N: usize>(
    level: Option<F>,
    maps: impl Iterator<Item = (usize, &'m L::Map)>,
    zero: F,
    look: &L,
) -> [F; N]
where
    L::Map: 'm,
{
    let one = zero.splat(1.0);
    let wanted = level.unwrap_or(zero);
    let mut sum = [zero; N];
    for (i, map) in maps {
        let share = one - (wanted - i as f32).abs();
        let counts = share.gt(zero);
        if level.is_some() && !counts.any() {
            continue;
        }
        let found = look.at(map);
        // Nothing of the rest may cost those who do not ask for it.
        if level.is_none() {
            return found;
        }
        for n in 0..N {
            sum[n] = F::select(counts, sum[n] + found[n] * share, sum[n]);
        }
    }
    sum
}

/// Logarithm read off the representation: exact at powers of two, straight between them, at most 0.09 too
/// small. −127 for 0.
#[inline(always)]
fn log2<F: Real>(x: F) -> F {
    x.to_bits().signed_to_real() * (1.0 / 8_388_608.0) - 127.0
}

/// All halvings of a map of this size, down to one texel: none for a single texel.
pub(super) fn halvings<const N: usize>(
    size: [u32; 2],
    texel: impl Fn(u32, u32) -> [f32; N],
) -> Vec<Grid<[f32; N]>> {
    let mut levels = Vec::new();
    let mut size = size;
    while size != [1, 1] {
        let next = match levels.last() {
            None => halved(size, &texel),
            Some(finer) => halved(size, |x, y| Grid::at(finer, x, y)),
        };
        size = [next.width(), next.height()];
        levels.push(next);
    }
    levels
}

/// Half the size, rounded down: each texel the mean over its share of the area, so that the mean of the whole
/// stays the same for odd sizes, too.
fn halved<const N: usize>(
    [w, h]: [u32; 2],
    texel: impl Fn(u32, u32) -> [f32; N],
) -> Grid<[f32; N]> {
    let [columns, rows] = [w, h].map(|n| (n / 2).max(1));
    let across = shares(w, columns);
    let down = shares(h, rows);
    let mut texels = Vec::with_capacity(columns as usize * rows as usize);
    for (top, weights_down) in &down {
        for (left, weights_across) in &across {
            let mut mean = [0.0; N];
            for (y, wy) in (*top..).zip(weights_down) {
                for (x, wx) in (*left..).zip(weights_across) {
                    let found = texel(x, y);
                    for n in 0..N {
                        mean[n] += found[n] * (wx * wy);
                    }
                }
            }
            texels.push(mean);
        }
    }
    Grid::new(columns, rows, texels)
}

/// For each of `parts` equal parts of a line of `n` texels: the first texel, and the share of the part that each
/// covers.
fn shares(n: u32, parts: u32) -> Vec<(u32, Vec<f32>)> {
    let (n, count) = (u64::from(n), u64::from(parts));
    let part = |i: u64| {
        // In units of 1/parts of a texel everything is whole.
        let (from, to) = (i * n, (i + 1) * n);
        let (first, end) = (from / count, to.div_ceil(count));
        let share = |k: u64| {
            let covered = to.min((k + 1) * count) - from.max(k * count);
            covered as f32 / n as f32
        };
        (first as u32, (first..end).map(share).collect())
    };
    (0..count).map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halvings_keep_the_mean_of_every_size() {
        for [w, h] in [[1, 1], [8, 8], [7, 5], [1, 6], [13, 2], [3, 3]] {
            let value = |x: u32, y: u32| ((x * 7919 + y * 104_729) % 1000) as f32 / 1000.0;
            let levels = halvings([w, h], |x, y| [value(x, y)]);
            let places = (0..h).flat_map(|y| (0..w).map(move |x| (x, y)));
            let mean = places.map(|(x, y)| value(x, y)).sum::<f32>() / (w * h) as f32;
            let mut size = [w, h];
            for level in &levels {
                size = size.map(|n| (n / 2).max(1));
                assert_eq!([level.width(), level.height()], size);
                let count = level.texels().len() as f32;
                let found = level.texels().iter().map(|[v]| v).sum::<f32>() / count;
                assert!((found - mean).abs() < 1e-6, "{w}×{h}: {found}, not {mean}");
            }
            assert_eq!(size, [1, 1], "the last is one texel");
        }
    }

    #[test]
    fn a_third_of_three_is_one_and_a_half_texels() {
        let [level] = &halvings([3, 1], |x, _| [x as f32])[..] else {
            panic!("one level");
        };
        assert_eq!(level.texels(), [[1.0]]);
        let five = halvings([5, 1], |x, _| [if x == 2 { 1.0 } else { 0.0 }]);
        // Both halves have half of the middle texel: 0.5 of 2.5.
        assert_eq!(five[0].texels(), [[0.2], [0.2]]);
    }

    #[test]
    fn the_logarithm_is_exact_at_powers_of_two() {
        for e in -20..20 {
            assert_eq!(log2(2.0_f32.powi(e)), e as f32);
        }
        let mut x = 1e-3_f32;
        while x < 1e3 {
            let off = x.log2() - log2(x);
            assert!((-1e-4..0.09).contains(&off), "{x}: {off}");
            x *= 1.01;
        }
        assert!(log2(0.0_f32) <= -126.0);
    }

    struct Value;
    impl<F: Real> Look<F, 1> for Value {
        type Map = F;
        fn at(&self, map: &F) -> [F; 1] {
            [*map]
        }
    }

    #[test]
    fn up_to_a_texel_the_base_alone_counts() {
        let mips = Mips {
            halved: &[10.0_f32, 20.0],
            rate: 64.0,
        };
        let at = |texels: f32| Mips::look(&0.3, Some(&mips), texels / 64.0, &Value)[0];
        for texels in [0.0, 1e-30, 0.5, 1.0] {
            assert_eq!(at(texels).to_bits(), 0.3_f32.to_bits());
        }
        assert_eq!(at(2.0), 10.0);
        assert_eq!(at(3.0), 15.0);
        assert_eq!(at(f32::INFINITY), 20.0);
        assert!(at(f32::NAN).is_finite());
    }
}
