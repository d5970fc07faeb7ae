//! Rates per second out of running counts, for the status line.

use std::collections::VecDeque;

/// Seconds that a rate is averaged over.
const WINDOW_SECS: f64 = 1.0;

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
        while self.marks.len() > 1 && self.marks[1].0 < now - WINDOW_SECS {
            self.marks.pop_front();
        }
    }

    /// Counts per second within the last second; 0 when nothing happened in it.
    #[must_use]
    pub fn rate(&self, now: f64) -> f64 {
        let recent = |&&(time, _): &&(f64, u64)| time >= now - WINDOW_SECS;
        let (Some(&(begin, first)), Some(&(_, last))) =
            (self.marks.iter().find(recent), self.marks.back())
        else {
            return 0.0;
        };
        let span = (now - begin).max(0.25);
        last.saturating_sub(first) as f64 / span
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
    fn a_still_count_has_no_rate() {
        let mut meter = Meter::default();
        meter.note(0.0, 0);
        meter.note(0.5, 30);
        meter.note(5.0, 30);
        assert_eq!(meter.rate(5.0), 0.0);
    }
}
