//! Rates per second out of running counts, for the status line.

use std::collections::VecDeque;

/// Seconds that a rate is averaged over.
const WINDOW_SECS: f64 = 1.0;

/// Seconds without a count after which the rate is 0.
const STILL_SECS: f64 = 2.0;

/// How fast a count grows.
#[derive(Debug, Default)]
pub struct Meter {
    marks: VecDeque<(f64, u64)>,
}

impl Meter {
    /// Notes the count at a time (seconds, never going back).
    pub fn note(&mut self, now: f64, count: u64) {
        if self.marks.back().is_none_or(|&(_, last)| last != count) {
            self.marks.push_back((now, count));
        }
        while self.marks.len() > 2 && self.marks[1].0 < now - WINDOW_SECS {
            self.marks.pop_front();
        }
    }

    /// Counts per second over the last second, or over the last interval where counts come less often;
    /// 0 once nothing has happened for two seconds.
    #[must_use]
    pub fn rate(&self, now: f64) -> f64 {
        let recent = |&&(time, _): &&(f64, u64)| time >= now - WINDOW_SECS;
        let Some(&(end, last)) = self.marks.back() else {
            return 0.0;
        };
        let before = self.marks.len().checked_sub(2).map(|i| self.marks[i]);
        let inside = self.marks.iter().find(recent).copied();
        let begin = inside.filter(|&(time, _)| time < end).or(before);
        match begin {
            Some((time, first)) if now - end < STILL_SECS => {
                last.saturating_sub(first) as f64 / (end - time).max(0.005)
            }
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Meter;

    #[test]
    fn sixty_counts_in_a_second_are_sixty() {
        let mut meter = Meter::default();
        for i in 0..=120_u32 {
            meter.note(f64::from(i) / 60.0, u64::from(i));
        }
        assert!((meter.rate(2.0) - 60.0).abs() < 1.0, "{}", meter.rate(2.0));
    }

    #[test]
    fn slow_counts_have_a_rate_too() {
        let mut meter = Meter::default();
        for i in 0..4_u32 {
            meter.note(f64::from(i) * 1.6, u64::from(i));
        }
        assert!(
            (meter.rate(5.0) - 0.625).abs() < 1e-6,
            "{}",
            meter.rate(5.0)
        );
    }

    #[test]
    fn a_still_count_has_no_rate() {
        let mut meter = Meter::default();
        meter.note(0.0, 0);
        meter.note(0.5, 30);
        meter.note(5.0, 30);
        assert_eq!(meter.rate(5.0), 0.0);
    }
}
