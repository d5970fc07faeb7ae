//! Where the time of a pass goes, by stage.

use std::time::{Duration, Instant};

use super::Spread;
use crate::render::{Progressive, Stage, StageWatch};

/// Thread time of a pass by stage: what the workers' clocks show between the stages of a tile, summed over all
/// workers. It is wall-clock time within each, so that it counts pauses that the system imposes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StageTimes {
    /// Rays made and traced, of all kinds, thread-ms.
    pub trace: Spread,
    /// Surface points made and perturbed, thread-ms.
    pub perturb: Spread,
    /// Lights and mirrors, thread-ms.
    pub shade: Spread,
    /// Samples put into the film, thread-ms.
    pub resolve: Spread,
    /// Share of `workers × pass` that the four explain; the rest is starting, ending and waiting.
    pub share: Spread,
}

/// Collects passes.
#[derive(Debug, Default)]
pub(super) struct StageLog {
    times: [Vec<f64>; 4],
    share: Vec<f64>,
}

impl StageLog {
    /// Renders and notes one pass.
    pub fn pass(&mut self, renderer: &mut Progressive) {
        let began = Instant::now();
        let clocks = renderer.watched_pass::<StageClock>();
        let whole = began.elapsed().as_secs_f64() * clocks.len() as f64;
        let spent = |stage: usize| -> f64 {
            let all = clocks.iter().map(|clock| clock.spent[stage]);
            all.sum::<Duration>().as_secs_f64()
        };
        let spent = [0, 1, 2, 3].map(spent);
        for (times, spent) in self.times.iter_mut().zip(spent) {
            times.push(spent * 1e3);
        }
        let share = spent.iter().sum::<f64>() / whole.max(f64::MIN_POSITIVE);
        self.share.push(share);
    }

    /// All passes but the first, which warms up.
    pub fn times(self) -> StageTimes {
        let warm = |all: Vec<f64>| Spread::of(all.into_iter().skip(1).collect());
        let [trace, perturb, shade, resolve] = self.times.map(warm);
        StageTimes {
            trace,
            perturb,
            shade,
            resolve,
            share: warm(self.share),
        }
    }
}

/// One worker's clock.
struct StageClock {
    last: Instant,
    spent: [Duration; 4],
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
