//! A worker's clock: how long it spent in each stage.

use std::time::{Duration, Instant};

use crate::render::{Stage, StageWatch};

/// One worker's clock.
#[derive(Debug, Clone, Copy)]
pub struct StageClock {
    last: Instant,
    /// Time within each [`Stage`], in their order.
    pub spent: [Duration; 4],
}

impl StageClock {
    /// Thread time of all workers in each stage, ms.
    #[must_use]
    pub fn sum_millis(clocks: &[Self]) -> [f64; 4] {
        [0, 1, 2, 3].map(|stage| {
            let all = clocks.iter().map(|clock| clock.spent[stage]);
            all.sum::<Duration>().as_secs_f64() * 1e3
        })
    }
}

impl Default for StageClock {
    fn default() -> Self {
        Self {
            last: Instant::now(),
            spent: [Duration::ZERO; 4],
        }
    }
}

impl StageWatch for StageClock {
    fn begin(&mut self) {
        self.last = Instant::now();
    }

    fn done(&mut self, stage: Stage) {
        let now = Instant::now();
        self.spent[stage as usize] += now - self.last;
        self.last = now;
    }
}
