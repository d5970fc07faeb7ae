//! From records of pixels to the colours of a view, and what these mean.

use glam::Vec3;

use super::{PixelRecord, Records};
use crate::math::false_color;
use crate::scene::{View, ViewKind};

/// Where a view has nothing to tell: a grey that no scale holds.
pub const NO_VALUE: [u8; 3] = [44, 44, 48];
/// What overlays paint with: as loud on bright pictures as on dark ones.
pub const MARK: [u8; 3] = [255, 0, 190];

/// Nearer to the base than this, in amplitudes, a place lies on it: rounding.
const ON_BASE: f32 = 1e-3;

/// What the colours of a view mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Legend {
    /// The view.
    pub view: View,
    /// Values of the scale's ends; 0 and 1 for views without a scale.
    pub range: [f32; 2],
    /// Pixels that an overlay paints, or that lie beyond the scale.
    pub marked: u64,
}

impl Legend {
    /// The one legend of all these records, which stand side by side; `None` for the plain picture.
    #[must_use]
    pub fn of(view: View, records: &[&Records]) -> Option<Self> {
        if view.kind() == ViewKind::Picture {
            return None;
        }
        let pixels = || records.iter().flat_map(|records| &records.pixels);
        let values = || pixels().filter_map(|record| value(view, record));
        let most = values().fold(0.0, f32::max);
        let least = values().fold(0.0, f32::min);
        let range = match view {
            View::Steps | View::Samples | View::Cost => [0.0, round_up(usual_most(values()))],
            // A relief may lie under the base, over it, or on both sides.
            View::Depth => {
                let (is_over, is_under) = (least < -ON_BASE, most > ON_BASE);
                let low = if is_over { -1.0 } else { 0.0 };
                [low, if is_under || !is_over { 1.0 } else { 0.0 }]
            }
            _ => [0.0, 1.0],
        };
        let marked = match view.kind() {
            ViewKind::Scale => values().filter(|value| *value > range[1]).count(),
            _ => pixels().filter(|record| is_marked(view, record)).count(),
        };
        Some(Self {
            view,
            range,
            marked: marked as u64,
        })
    }

    /// Paints the view over the pixels of the picture, opaque RGBA: over all of them, or over those that are marked.
    ///
    /// # Panics
    /// If there is not one pixel for each record.
    pub fn paint(&self, records: &Records, pixels: &mut [[u8; 4]]) {
        assert_eq!(records.pixels.len(), pixels.len(), "one pixel a record");
        for (pixel, record) in pixels.iter_mut().zip(&records.pixels) {
            if let Some([r, g, b]) = self.color(record) {
                *pixel = [r, g, b, 255];
            }
        }
    }

    /// The colour of a pixel; `None` where the picture shows.
    fn color(&self, record: &PixelRecord) -> Option<[u8; 3]> {
        let byte = |x: f32| (x.clamp(0.0, 1.0) * 255.0).round() as u8;
        let or_nothing = |color: Option<[u8; 3]>| Some(color.unwrap_or(NO_VALUE));
        match self.view.kind() {
            ViewKind::Picture => None,
            ViewKind::Marks => is_marked(self.view, record).then_some(MARK),
            ViewKind::Scale => or_nothing(value(self.view, record).map(|value| {
                let [low, high] = self.range;
                false_color((value - low) / (high - low))
            })),
            ViewKind::Channels if self.view == View::Uv => or_nothing(
                record
                    .uv
                    .map(|uv| [byte(uv.x - uv.x.floor()), byte(uv.y - uv.y.floor()), 0]),
            ),
            ViewKind::Channels => or_nothing(record.material.map(|_| {
                let color = record.normal * 0.5 + Vec3::splat(0.5);
                color.to_array().map(byte)
            })),
        }
    }
}

/// What a scale shows of a pixel.
fn value(view: View, record: &PixelRecord) -> Option<f32> {
    let of_surface = |value: f32| record.material.map(|_| value);
    match view {
        View::Height => record.height,
        View::Depth => of_surface(record.depth),
        View::Steps => of_surface(record.steps as f32),
        View::Samples => Some(record.samples as f32),
        View::Cost => Some(record.cost as f32),
        _ => None,
    }
}

/// Whether an overlay paints a pixel.
const fn is_marked(view: View, record: &PixelRecord) -> bool {
    match view {
        View::InvalidNormals => record.invalid_normal,
        View::NonFinite => record.non_finite,
        View::StepsAtTheCap => record.at_the_cap,
        View::Leaks => record.leak,
        View::FalseShadows => record.false_shadow,
        _ => false,
    }
}

/// What one value in a hundred exceeds: a few pixels at silhouettes must not take the whole scale.
fn usual_most(values: impl Iterator<Item = f32>) -> f32 {
    let mut values: Vec<f32> = values.collect();
    let rank = (values.len() * 99).div_ceil(100).saturating_sub(1);
    match values.get(rank) {
        Some(_) => *values.select_nth_unstable_by(rank, f32::total_cmp).1,
        None => 0.0,
    }
}

/// The next of 1, 2, 5, 10, 20, 50 …, so that a scale seldom changes while the picture moves.
fn round_up(most: f32) -> f32 {
    let decades = (0..38).map(|exponent| 10_f32.powi(exponent));
    let mut ends = decades.flat_map(|decade| [1.0, 2.0, 5.0].map(|step| step * decade));
    ends.find(|&end| end >= most).unwrap_or(most)
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::super::UvYardstick;
    use super::*;

    fn seen(steps: u32, depth: f32) -> PixelRecord {
        PixelRecord {
            material: Some(0),
            normal: Vec3::Z,
            uv: Some(Vec2::new(-0.25, 3.5)),
            steps,
            depth,
            ..PixelRecord::NOTHING
        }
    }

    fn records(pixels: Vec<PixelRecord>) -> Records {
        Records {
            size: [pixels.len() as u32, 1],
            pixels,
            yardsticks: vec![UvYardstick::NONE],
        }
    }

    fn painted(view: View, records: &Records) -> Vec<[u8; 4]> {
        let mut pixels = vec![[1, 2, 3, 255]; records.pixels.len()];
        if let Some(legend) = Legend::of(view, &[records]) {
            legend.paint(records, &mut pixels);
        }
        pixels
    }

    #[test]
    fn scales_end_at_round_numbers() {
        let ends = [0.0, 1.0, 1.5, 2.0, 3.0, 9.0, 10.0, 11.0, 49.0, 51.0, 1234.0];
        let rounded = [
            1.0, 1.0, 2.0, 2.0, 5.0, 10.0, 10.0, 20.0, 50.0, 100.0, 2000.0,
        ];
        assert_eq!(ends.map(round_up), rounded);
    }

    #[test]
    fn numbers_become_colours_and_misses_stay_grey() {
        let records = records(vec![PixelRecord::NOTHING, seen(0, 0.5), seen(37, -0.5)]);
        let range = |view| Legend::of(view, &[&records]).map(|legend| legend.range);
        assert_eq!(range(View::Steps), Some([0.0, 50.0]));
        assert_eq!(range(View::Depth), Some([-1.0, 1.0]));
        assert_eq!(range(View::Picture), None);
        let rgb = |[r, g, b]: [u8; 3]| [r, g, b, 255];
        let steps = painted(View::Steps, &records);
        let expected = [NO_VALUE, false_color(0.0), false_color(0.74)];
        assert_eq!(steps, expected.map(rgb));
        assert_eq!(painted(View::Normals, &records)[1], [128, 128, 255, 255]);
        // Fractions of -0.25 and 3.5.
        assert_eq!(painted(View::Uv, &records)[1], [191, 128, 0, 255]);
        assert_eq!(painted(View::Picture, &records), [[1, 2, 3, 255]; 3]);
    }

    #[test]
    fn overlays_leave_the_picture_around_them() {
        let bad = PixelRecord {
            invalid_normal: true,
            ..seen(1, 0.0)
        };
        let records = records(vec![seen(1, 0.0), bad]);
        let legend = Legend::of(View::InvalidNormals, &[&records]).expect("a legend");
        assert_eq!(legend.marked, 1);
        let pixels = painted(View::InvalidNormals, &records);
        assert_eq!(pixels, [[1, 2, 3, 255], [MARK[0], MARK[1], MARK[2], 255]]);
        assert_eq!(painted(View::NonFinite, &records), [[1, 2, 3, 255]; 2]);
    }
}
