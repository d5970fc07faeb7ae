//! What a frame takes: counts, and times of many methods taken in turns.

use std::sync::Arc;
use std::time::Instant;

use super::{Cost, Spread3};
use crate::measure::bench::Spread;
use crate::render::{Counters, Progressive, Snapshot};

/// How far the camera turns between frames, radians, so that no hit is known before it is traced.
const TURN: f64 = 0.01;
/// Pixels of a full-HD frame.
const FULL_HD: f64 = 1920.0 * 1080.0;

/// The costs of frames of one sample per pixel, one for each snapshot. `covered` is the share of the picture that
/// the model covers.
///
/// The methods take turns, so that a machine that slows down slows all of them; the first round warms up.
#[must_use]
pub fn costs(
    renderer: &mut Progressive,
    snapshots: &[Snapshot],
    rounds: u32,
    covered: f64,
) -> Vec<Cost> {
    let mut times = vec![Vec::new(); snapshots.len()];
    let mut counts = vec![Counters::ZERO; snapshots.len()];
    for round in 0..=rounds {
        for (i, snapshot) in snapshots.iter().enumerate() {
            renderer.start(turned(snapshot));
            renderer.start(snapshot.clone());
            let began = Instant::now();
            renderer.pass(&|| false);
            let ms = began.elapsed().as_secs_f64() * 1e3;
            counts[i] = renderer.counters();
            if round > 0 {
                times[i].push(ms);
            }
        }
    }
    let pixels = |s: &Snapshot| f64::from(s.size[0]) * f64::from(s.size[1]);
    let all = snapshots.iter().zip(times).zip(&counts);
    all.map(|((snapshot, times), counts)| {
        let samples = (pixels(snapshot) * covered).max(1.0);
        let frame_ms = Spread3::from(Spread::of(times));
        Cost {
            look_ups: counts.texture_fetches as f64 / samples,
            steps: counts.relief_steps as f64 / samples,
            rays: counts.rays() as f64 / samples,
            shadow_walks: counts.relief_shadow_walks as f64 / samples,
            frame_ms,
            ns_per_sample: frame_ms.times(1e6 / samples),
            full_hd_ms: frame_ms.median * FULL_HD / pixels(snapshot),
        }
    })
    .collect()
}

/// The same with the camera turned a little.
fn turned(snapshot: &Snapshot) -> Snapshot {
    let mut settings = (*snapshot.settings).clone();
    settings.camera.orbit(TURN, 0.0);
    Snapshot {
        settings: Arc::new(settings),
        ..snapshot.clone()
    }
}
