//! Bilinear means of texels with several channels, the channels of a texel side by side in a vector.
//!
//! Points in lanes would look every channel of every corner up for themselves. So each point takes its turn: a corner
//! is one load and what makes numbers of it, the mean of all channels is as many operations as that of one, and only
//! the means are turned into lanes. On a Zen 3 that takes half the time of gathering.

use super::simd::{ExtractToken as _, Simd, SimdBase as _, f32x4};

/// Most lanes that a vector of any machine has.
const MAX_LANES: usize = 16;

/// Texels of up to four channels.
///
/// A trait, because a function that is handed on as a value is compiled without the vector instructions of its caller.
pub trait Channels: Copy {
    /// The channels of the texel at an index, as numbers.
    ///
    /// # Panics
    /// If there is none.
    fn at(self, index: usize) -> [f32; 4];
}

/// For each lane the mean of the first three channels of four texels: those to the left and right above, then those
/// below, weighed by the way to go to the right and down.
#[inline(always)]
pub(super) fn means<S: Simd>(
    corners: [S::u32s; 4],
    [right, down]: [S::f32s; 2],
    of: impl Channels,
) -> [S::f32s; 3] {
    let simd = right.token();
    let mut indices = [[0_u32; MAX_LANES]; 4];
    for k in 0..4 {
        corners[k].store_slice(&mut indices[k][..S::f32s::LEN]);
    }
    let mut ways = [[0.0; MAX_LANES]; 2];
    right.store_slice(&mut ways[0][..S::f32s::LEN]);
    down.store_slice(&mut ways[1][..S::f32s::LEN]);
    let mut found = [[0.0; MAX_LANES]; 3];
    for first in (0..S::f32s::LEN).step_by(4) {
        let mut rows = [0.0; 16];
        for i in 0..4 {
            let lane = first + i;
            let a = f32x4::from_slice(simd, &of.at(indices[0][lane] as usize));
            let b = f32x4::from_slice(simd, &of.at(indices[1][lane] as usize));
            let c = f32x4::from_slice(simd, &of.at(indices[2][lane] as usize));
            let d = f32x4::from_slice(simd, &of.at(indices[3][lane] as usize));
            let top = a + (b - a) * ways[0][lane];
            let bottom = c + (d - c) * ways[0][lane];
            let mean = top + (bottom - top) * ways[1][lane];
            mean.store_slice(&mut rows[4 * i..4 * i + 4]);
        }
        let channels = simd.load_four_interleaved_f32x4(&rows);
        for n in 0..3 {
            channels[n].store_slice(&mut found[n][first..first + 4]);
        }
    }
    [
        S::f32s::from_slice(simd, &found[0][..S::f32s::LEN]),
        S::f32s::from_slice(simd, &found[1][..S::f32s::LEN]),
        S::f32s::from_slice(simd, &found[2][..S::f32s::LEN]),
    ]
}

/// The same for one point.
#[inline(always)]
pub(super) fn mean(corners: [u32; 4], [right, down]: [f32; 2], of: impl Channels) -> [f32; 3] {
    let [a, b, c, d] = corners.map(|index| of.at(index as usize));
    std::array::from_fn(|n| {
        let top = a[n] + (b[n] - a[n]) * right;
        let bottom = c[n] + (d[n] - c[n]) * right;
        top + (bottom - top) * down
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::simd::{Kernel, SimdLevel};

    /// Numbers that a decimal place of the index tells.
    #[derive(Clone, Copy)]
    struct Digits;

    impl Channels for Digits {
        #[inline(always)]
        fn at(self, index: usize) -> [f32; 4] {
            assert!(index < 1000, "no such texel");
            [1, 10, 100, 1].map(|place| (index / place % 10) as f32 * 0.1)
        }
    }

    struct Compare {
        corners: [[u32; MAX_LANES]; 4],
        ways: [[f32; MAX_LANES]; 2],
    }

    impl Kernel for Compare {
        #[inline(always)]
        fn run<S: Simd>(self, simd: S) {
            let lanes = S::f32s::LEN;
            let [a, b, c, d] = self
                .corners
                .map(|row| S::u32s::from_slice(simd, &row[..lanes]));
            let [right, down] = self
                .ways
                .map(|row| S::f32s::from_slice(simd, &row[..lanes]));
            let found = means::<S>([a, b, c, d], [right, down], Digits);
            for lane in 0..lanes {
                let corners = self.corners.map(|row| row[lane]);
                let ways = self.ways.map(|row| row[lane]);
                let alone = mean(corners, ways, Digits);
                for n in 0..3 {
                    let lanes = found[n].as_slice();
                    assert_eq!(lanes[lane].to_bits(), alone[n].to_bits());
                }
            }
        }
    }

    #[test]
    fn every_level_gives_each_lane_the_mean_of_its_own_corners() {
        let number = |i: u32| i.wrapping_mul(2_654_435_761) >> 7;
        for round in 0..100 {
            let lane = |k: u32| {
                std::array::from_fn(|lane| number(round * 977 + k * 16 + lane as u32) % 1000)
            };
            let way = |k: u32| lane(k).map(|x| x as f32 / 1000.0);
            for level in SimdLevel::ALL {
                if level.is_available() {
                    level.run_or_plain(Compare {
                        corners: [lane(0), lane(1), lane(2), lane(3)],
                        ways: [way(4), way(5)],
                    });
                }
            }
        }
    }

    #[test]
    fn a_mean_leans_to_the_corner_that_is_near() {
        let corners = [0, 1, 2, 3];
        assert_eq!(mean(corners, [0.0, 0.0], Digits)[0], 0.0);
        assert_eq!(mean(corners, [1.0, 0.0], Digits)[0], 0.1);
        assert_eq!(mean(corners, [0.0, 1.0], Digits)[0], 0.2);
        let middle = mean(corners, [0.5, 0.5], Digits)[0];
        assert!((middle - 0.15).abs() < 1e-6);
    }
}
