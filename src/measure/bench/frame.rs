//! A frame's parts, as the window meets them while a person works.

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::DVec3;

use super::check::same_picture;
use super::spread::millis;
use super::stages::StageLog;
use super::{BenchError, Spread, StageTimes};
use crate::render::{Counters, Picture, Progressive, Snapshot};
use crate::scene::{RenderSettings, Scene};
use crate::shading::LightKind;

/// Preview stride that is timed.
const STRIDE: u32 = 4;
/// How far the camera turns between frames, radians: a step of a slow drag.
const TURN: f64 = 0.01;

/// Rounds that are timed however long they take.
const FEWEST_ROUNDS: usize = 3;
/// After this no further round is begun.
const PATIENCE: Duration = Duration::from_secs(8);

/// One view of one scene by one method.
#[derive(Debug, Clone)]
pub struct FrameCase {
    snapshot: Snapshot,
}

/// What the parts of a frame take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameTimes {
    /// Taking a new snapshot whose camera has moved, ms.
    pub start: Spread,
    /// The preview that has one pixel in four, across and down, ms.
    pub preview: Spread,
    /// One sample of each pixel, nothing known before, ms.
    pub full: Spread,
    /// One sample of each pixel after the brightness of a light has changed, from the hits and shadows that are known,
    /// ms. A change of a material, or of a method that leaves points where they are, costs much the same.
    pub reshade: Spread,
    /// The same after a light has moved: its shadow rays are traced anew, ms.
    pub relight: Spread,
    /// From linear colours to those of the screen, ms.
    pub encode: Spread,
    /// Where full passes like the timed ones spend their time, with clocks in the workers.
    pub stages: StageTimes,
    /// What the full pass computed.
    pub counters: Counters,
}

impl FrameCase {
    /// The snapshot is what the full pass renders.
    #[must_use]
    pub const fn new(snapshot: Snapshot) -> Self {
        Self { snapshot }
    }

    /// Re-shading gives the picture that rendering afresh does, and vectors the one that `twin` does: the
    /// same scene at another level.
    ///
    /// # Errors
    /// If not, or if there are no threads.
    pub fn check(&self, twin: &Arc<Scene>) -> Result<(), BenchError> {
        let moved = self.moved();
        let again = first_sample(&[&self.snapshot, &moved])?;
        same_picture("moving a light", &first_sample(&[&moved])?, &again)?;
        let lit = self.lit();
        let fresh = first_sample(&[&lit])?;
        let again = first_sample(&[&self.snapshot, &lit])?;
        same_picture("re-shading", &fresh, &again)?;
        let scalar = Snapshot {
            scene: Arc::clone(twin),
            ..lit
        };
        same_picture("vector code", &fresh, &first_sample(&[&scalar])?)
    }

    /// Times each part `rounds` times, after a round that warms up; fewer times, but at least thrice, where that
    /// would take longer than a few seconds.
    ///
    /// # Errors
    /// If there are no threads.
    pub fn time(&self, threads: usize, rounds: usize) -> Result<FrameTimes, BenchError> {
        let mut renderer = renderer(threads)?;
        let mut rgba = vec![[0; 4]; self.snapshot.size.map(|n| n as usize).iter().product()];
        let (turned, lit, moved) = (self.turned(), self.lit(), self.moved());
        let mut times: [Vec<f64>; 6] = Default::default();
        let mut stages = StageLog::default();
        let mut counters = Counters::default();
        let began = Instant::now();
        for round in 0..=rounds {
            if round > FEWEST_ROUNDS && began.elapsed() > PATIENCE {
                break;
            }
            renderer.start(turned.clone());
            renderer.start(self.snapshot.clone());
            stages.pass(&mut renderer);
            renderer.start(turned.clone());
            let preview = millis(|| {
                renderer.preview(STRIDE, &|| false);
            });
            let start = millis(|| renderer.start(self.snapshot.clone()));
            let full = millis(|| {
                renderer.pass(&|| false);
            });
            counters = renderer.counters();
            let encode = millis(|| renderer.encode_into(0.0, &mut rgba));
            renderer.start(lit.clone());
            let reshade = millis(|| {
                renderer.pass(&|| false);
            });
            renderer.start(moved.clone());
            let relight = millis(|| {
                renderer.pass(&|| false);
            });
            if round > 0 {
                let round = [start, preview, full, reshade, relight, encode];
                times.iter_mut().zip(round).for_each(|(t, ms)| t.push(ms));
            }
        }
        let [start, preview, full, reshade, relight, encode] = times.map(Spread::of);
        Ok(FrameTimes {
            start,
            preview,
            full,
            reshade,
            relight,
            encode,
            stages: stages.times(),
            counters,
        })
    }

    /// The same with the camera turned a little.
    fn turned(&self) -> Snapshot {
        self.edited(|settings| settings.camera.orbit(TURN, 0.0))
    }

    /// The same with the first light a little brighter.
    fn lit(&self) -> Snapshot {
        self.edited(|settings| {
            if let Some(light) = settings.lights.first_mut() {
                light.intensity *= 1.01;
            }
        })
    }

    /// The same with the first light that throws shadows moved or turned a little.
    fn moved(&self) -> Snapshot {
        self.edited(|settings| {
            let mut places = settings
                .lights
                .iter_mut()
                .filter_map(|light| match &mut light.kind {
                    LightKind::Point { position, .. } => Some(position),
                    LightKind::Directional { direction } => Some(direction),
                    LightKind::Ambient => None,
                });
            if let Some(place) = places.next() {
                *place += DVec3::X * (0.01 * place.length());
            }
        })
    }

    fn edited(&self, edit: impl FnOnce(&mut RenderSettings)) -> Snapshot {
        let mut settings = (*self.snapshot.settings).clone();
        edit(&mut settings);
        Snapshot {
            settings: Arc::new(settings),
            ..self.snapshot.clone()
        }
    }
}

/// The first sample of the last snapshot, after passes of those before it.
fn first_sample(snapshots: &[&Snapshot]) -> Result<Picture, BenchError> {
    let mut renderer = renderer(0)?;
    for &snapshot in snapshots {
        renderer.start(snapshot.clone());
        renderer.pass(&|| false);
    }
    Ok(renderer.picture())
}

fn renderer(threads: usize) -> Result<Progressive, BenchError> {
    Progressive::new(threads).map_err(BenchError::Threads)
}
