//! What first passes cost, by stride, as measured.

/// Weight of the newest measurement.
const NEWEST: f32 = 0.5;
/// A pass takes at most this share of the next finer one: it has a quarter of the pixels, but rays that are
/// farther apart cost more each.
const OF_FINER: f32 = 0.5;
/// A pass takes at most so many times as long as the next coarser one, and usually much less.
const OF_COARSER: f32 = 4.0;

/// Milliseconds of passes with strides 1, 2, 4 and 8 in one scene.
#[derive(Debug, Clone, Copy, Default)]
pub struct Costs([Option<f32>; 4]);

impl Costs {
    /// Notes what a pass took.
    pub fn note(&mut self, stride: u32, millis: f32) {
        if let Some(cost) = self.0.get_mut(stride.trailing_zeros() as usize) {
            let known = cost.unwrap_or(millis);
            *cost = Some(known + (millis - known) * NEWEST);
        }
    }

    /// What a pass should take: as measured; else, between two strides that were measured, as if every halving multiplied it
    /// by the same; else at most so much as the nearest one says.
    #[must_use]
    pub fn expected(&self, stride: u32) -> Option<f32> {
        let place = (stride.trailing_zeros() as usize).min(3);
        let measured = |place: usize| self.0[place].map(|millis| (place, millis));
        let finer = (0..=place).rev().find_map(measured);
        let coarser = (place..4).find_map(measured);
        let steps = |from: usize| place.abs_diff(from) as i32;
        match (finer, coarser) {
            (Some((from, fine)), Some((to, coarse))) if from < to => {
                let way = steps(from) as f32 / (to - from) as f32;
                Some(fine.powf(1.0 - way) * coarse.powf(way))
            }
            (Some((from, fine)), _) => Some(fine * OF_FINER.powi(steps(from))),
            (None, Some((to, coarse))) => Some(coarse * OF_COARSER.powi(steps(to))),
            (None, None) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Costs;

    #[test]
    fn measured_costs_go_before_guesses() {
        let mut costs = Costs::default();
        assert_eq!(costs.expected(1), None);
        costs.note(8, 2.0);
        assert_eq!(costs.expected(8), Some(2.0));
        assert_eq!(costs.expected(2), Some(32.0));
        costs.note(1, 16.0);
        for (stride, expected) in [(2, 8.0), (4, 4.0)] {
            let millis = costs.expected(stride).unwrap();
            assert!((millis - expected).abs() < 1e-4, "{stride}: {millis}");
        }
        costs.note(2, 6.0);
        costs.note(2, 8.0);
        assert_eq!(costs.expected(2), Some(7.0));
        assert_eq!(costs.expected(8), Some(2.0));
    }
}
