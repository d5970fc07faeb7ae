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

    /// What a pass should take: as measured, or else as the next strides that were measured suggest.
    #[must_use]
    pub fn expected(&self, stride: u32) -> Option<f32> {
        let place = stride.trailing_zeros() as usize;
        let factor = |of: f32, steps: usize| of.powi(steps as i32);
        let from_finer = (0..=place.min(3)).rev().find_map(|finer| {
            let steps = place - finer;
            self.0[finer].map(|millis| millis * factor(OF_FINER, steps))
        });
        from_finer.or_else(|| {
            (place + 1..4).find_map(|coarser| {
                let steps = coarser - place;
                self.0[coarser].map(|millis| millis * factor(OF_COARSER, steps))
            })
        })
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
        costs.note(1, 20.0);
        assert_eq!(costs.expected(2), Some(10.0));
        costs.note(2, 6.0);
        costs.note(2, 8.0);
        assert_eq!(costs.expected(2), Some(7.0));
        assert_eq!(costs.expected(8), Some(2.0));
    }
}
