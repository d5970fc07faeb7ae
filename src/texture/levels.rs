//! How finely a height map is quantised.

use std::collections::HashSet;

use super::HeightMap;

/// The different heights of a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Levels {
    /// How many there are, at most [`Self::MOST`]` + 1`.
    pub count: usize,
    /// Smallest step between neighbouring ones, in stored heights; 0 with fewer than two levels, or with
    /// more than [`Self::MOST`].
    pub step: f32,
}

impl Levels {
    /// More are not told apart: 12 bits show no stairs.
    pub const MOST: usize = 4096;
    /// Up to so many, gentle slopes are stairs: 8 bits and some.
    pub const FEW: usize = 512;

    /// Counts the heights of a map.
    #[must_use]
    pub fn of(map: &HeightMap) -> Self {
        let mut heights: Vec<f32> = match map {
            HeightMap::U16(grid) => {
                let mut used = vec![false; 1 << 16];
                for &texel in grid.texels() {
                    used[usize::from(texel)] = true;
                }
                let used = (0..=u16::MAX).filter(|&h| used[usize::from(h)]);
                used.map(super::height_map::fraction).collect()
            }
            HeightMap::F32(grid) => {
                let mut used = HashSet::new();
                for texel in grid.texels() {
                    // Both zeros are one height.
                    used.insert((texel + 0.0).to_bits());
                    if used.len() > Self::MOST {
                        break;
                    }
                }
                used.into_iter().map(f32::from_bits).collect()
            }
        };
        if heights.len() > Self::MOST {
            let count = Self::MOST + 1;
            return Self { count, step: 0.0 };
        }
        heights.sort_by(f32::total_cmp);
        let steps = heights.windows(2).map(|pair| pair[1] - pair[0]);
        let step = steps.fold(f32::INFINITY, f32::min);
        Self {
            count: heights.len(),
            step: if step.is_finite() { step } else { 0.0 },
        }
    }

    /// Whether there are more than were counted.
    #[must_use]
    pub const fn is_many(&self) -> bool {
        self.count > Self::MOST
    }

    /// Whether stairs may show.
    #[must_use]
    pub const fn is_few(&self) -> bool {
        self.count <= Self::FEW
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::Grid;

    #[test]
    fn levels_and_their_step_are_those_of_the_data() {
        let bytes = |values: &[u8]| {
            let texels = values.iter().map(|&v| u16::from(v) * 257).collect();
            Levels::of(&HeightMap::U16(Grid::new(values.len() as u32, 1, texels)))
        };
        assert_eq!(
            bytes(&[7, 7, 7]),
            Levels {
                count: 1,
                step: 0.0
            }
        );
        let all: Vec<u8> = (0..=255).collect();
        let found = bytes(&all);
        assert_eq!(found.count, 256);
        assert!((found.step - 1.0 / 255.0).abs() < 1e-6);
        assert!(found.is_few() && !found.is_many());
        // Every third value: the step is what the data has, not what the file could hold.
        assert!((bytes(&[0, 3, 6, 250]).step - 3.0 / 255.0).abs() < 1e-6);
        let floats = HeightMap::F32(Grid::new(4, 1, vec![0.0, -0.0, 0.5, 2.0]));
        assert_eq!(
            Levels::of(&floats),
            Levels {
                count: 3,
                step: 0.5
            }
        );
        let fine = (0..5000).map(|i| i as u16 * 13).collect();
        assert!(Levels::of(&HeightMap::U16(Grid::new(5000, 1, fine))).is_many());
    }
}
