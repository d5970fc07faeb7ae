//! Several times of the same work.

use std::time::Instant;

/// Median and range of several measurements.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Spread {
    /// The middle one, or the mean of the two in the middle.
    pub median: f64,
    /// The least.
    pub min: f64,
    /// The greatest.
    pub max: f64,
}

impl Spread {
    /// Of measurements in any order; zeros if there are none.
    #[must_use]
    pub fn of(mut samples: Vec<f64>) -> Self {
        samples.sort_by(f64::total_cmp);
        let (Some(&min), Some(&max)) = (samples.first(), samples.last()) else {
            return Self::default();
        };
        let (lower, upper) = ((samples.len() - 1) / 2, samples.len() / 2);
        Self {
            median: 0.5 * (samples[lower] + samples[upper]),
            min,
            max,
        }
    }
}

/// Milliseconds that some work takes.
pub(super) fn millis(work: impl FnOnce()) -> f64 {
    let began = Instant::now();
    work();
    began.elapsed().as_secs_f64() * 1e3
}

#[cfg(test)]
mod tests {
    use super::Spread;

    #[test]
    fn medians() {
        let of = |samples: &[f64]| Spread::of(samples.to_vec());
        let spread = |median, min, max| Spread { median, min, max };
        assert_eq!(of(&[]), Spread::default());
        assert_eq!(of(&[3.0]), spread(3.0, 3.0, 3.0));
        assert_eq!(of(&[4.0, 1.0]), spread(2.5, 1.0, 4.0));
        assert_eq!(of(&[9.0, 1.0, 2.0]), spread(2.0, 1.0, 9.0));
    }
}
