//! Where the time of a pass goes, by stage.

use std::time::Instant;

use super::Spread;
use crate::measure::stage_clock::StageClock;
use crate::render::Progressive;

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
        let clocks = renderer.watched_pass::<StageClock>(&|| false).1;
        let whole = began.elapsed().as_secs_f64() * clocks.len() as f64;
        let spent = StageClock::sum_millis(&clocks);
        for (times, spent) in self.times.iter_mut().zip(spent) {
            times.push(spent);
        }
        let share = spent.iter().sum::<f64>() * 1e-3 / whole.max(f64::MIN_POSITIVE);
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
