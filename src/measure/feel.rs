//! How a window feels: from the times at which cameras were asked for and pictures were shown.
//!
//! This file reads no clock; the window says what time it is, in seconds from any moment on.

use std::collections::VecDeque;

/// A pause of the hand longer than this ends a movement, seconds.
const PAUSE_SECS: f64 = 0.3;
/// Waits that are kept of one movement: the latest minute of it at 60 Hz.
const MOST_WAITS: usize = 3600;

/// What a movement of the camera felt like.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Feel {
    /// From its first camera to its last, seconds.
    pub seconds: f64,
    /// Cameras that were asked for.
    pub asked: u64,
    /// Pictures that showed a camera which no picture before them had shown, or a later one.
    pub shown: u64,
    /// The same per second of the movement.
    pub shown_per_sec: f64,
    /// From asking for a camera to showing a picture of it or of a later one, ms: half of all were faster.
    pub wait_p50_ms: f64,
    /// 95 in 100 were faster.
    pub wait_p95_ms: f64,
    /// The longest.
    pub wait_max_ms: f64,
    /// Coarsest picture: one pixel in `coarsest`, across and down.
    pub coarsest: u32,
    /// Stride of the middle picture, if they are put in order.
    pub median_stride: u32,
    /// From the last camera asked for to a picture of it with every pixel, ms; `None` while there is none.
    pub rest_to_full_ms: Option<f64>,
}

/// Follows the camera's last movement.
#[derive(Debug, Clone, Default)]
pub struct FeelLog {
    /// Cameras without a picture: generation and time.
    waiting: VecDeque<(u64, f64)>,
    /// Finished waits, ms.
    waits: VecDeque<f64>,
    /// Pictures by the power of two of their stride.
    strides: [u64; 8],
    asked: u64,
    /// Time of the first camera.
    began: f64,
    /// Last camera: generation and time.
    last: (u64, f64),
    full_at: Option<f64>,
}

impl FeelLog {
    /// A camera that differs from the last one was asked for.
    pub fn ask(&mut self, generation: u64, now: f64) {
        if now - self.last.1 > PAUSE_SECS || self.asked == 0 {
            *self = Self {
                began: now,
                ..Self::default()
            };
        }
        self.asked += 1;
        self.last = (generation, now);
        self.full_at = None;
        self.waiting.push_back((generation, now));
    }

    /// A picture is shown: of which generation, and of every how manieth pixel.
    pub fn show(&mut self, generation: u64, stride: u32, now: f64) {
        let mut is_new = false;
        while let Some(&(_, asked)) = self.waiting.front().filter(|w| w.0 <= generation) {
            self.waiting.pop_front();
            self.waits.push_back((now - asked) * 1e3);
            is_new = true;
        }
        while self.waits.len() > MOST_WAITS {
            self.waits.pop_front();
        }
        if is_new {
            self.strides[stride.max(1).ilog2().min(7) as usize] += 1;
        }
        if stride == 1 && self.asked > 0 && generation >= self.last.0 {
            self.full_at.get_or_insert(now);
        }
    }

    /// The last movement so far; `None` if there was none.
    #[must_use]
    pub fn feel(&self) -> Option<Feel> {
        if self.waits.is_empty() {
            return None;
        }
        let mut waits: Vec<f64> = self.waits.iter().copied().collect();
        waits.sort_by(f64::total_cmp);
        let quantile = |q: f64| waits[((waits.len() - 1) as f64 * q).round() as usize];
        let seconds = self.last.1 - self.began;
        let shown: u64 = self.strides.iter().sum();
        let stride = |power: usize| 1 << power;
        let used = |power: &usize| self.strides[*power] > 0;
        let up_to = |power: usize| self.strides[..=power].iter().sum::<u64>();
        Some(Feel {
            seconds,
            asked: self.asked,
            shown,
            shown_per_sec: if seconds > 0.0 {
                shown as f64 / seconds
            } else {
                0.0
            },
            wait_p50_ms: quantile(0.5),
            wait_p95_ms: quantile(0.95),
            wait_max_ms: quantile(1.0),
            coarsest: (0..8).rev().find(used).map_or(1, stride),
            median_stride: (0..8).find(|&p| 2 * up_to(p) >= shown).map_or(1, stride),
            rest_to_full_ms: self.full_at.map(|at| (at - self.last.1) * 1e3),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::FeelLog;

    #[test]
    fn a_drag_at_sixty_a_second() {
        let mut log = FeelLog::default();
        assert_eq!(log.feel(), None);
        for i in 0..=60_u64 {
            let now = i as f64 / 60.0;
            log.ask(i + 1, now);
            log.show(i + 1, if i == 7 { 4 } else { 2 }, now + 0.010);
        }
        log.show(61, 1, 1.080);
        log.show(61, 1, 1.200);
        let feel = log.feel().unwrap();
        assert_eq!((feel.asked, feel.shown), (61, 61));
        assert!((feel.shown_per_sec - 61.0).abs() < 1e-9);
        assert!((feel.wait_p50_ms - 10.0).abs() < 1e-6 && (feel.wait_max_ms - 10.0).abs() < 1e-6);
        assert_eq!((feel.coarsest, feel.median_stride), (4, 2));
        assert!((feel.rest_to_full_ms.unwrap() - 80.0).abs() < 1e-6);
    }

    #[test]
    fn a_later_picture_answers_all_cameras_before_it() {
        let mut log = FeelLog::default();
        for generation in 1..=3 {
            log.ask(generation, 0.1 * generation as f64);
        }
        log.show(3, 4, 0.4);
        let feel = log.feel().unwrap();
        assert_eq!((feel.asked, feel.shown), (3, 1));
        assert!((feel.wait_max_ms - 300.0).abs() < 1e-6);
        assert_eq!(feel.rest_to_full_ms, None);
    }

    #[test]
    fn a_pause_begins_a_new_movement() {
        let mut log = FeelLog::default();
        log.ask(1, 0.0);
        log.show(1, 8, 0.5);
        log.ask(2, 9.0);
        log.show(2, 1, 9.01);
        let feel = log.feel().unwrap();
        assert_eq!((feel.asked, feel.coarsest), (1, 1));
        assert!((feel.rest_to_full_ms.unwrap() - 10.0).abs() < 1e-6);
    }
}
