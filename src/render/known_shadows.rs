//! What the first samples of a tile know of shadows, for pictures that differ only in what neither throws nor takes
//! them: colours and brightness of lights, materials, maps that tilt normals, other lights.

use super::Frame;
use super::frame::{FrameLight, FrameLightKind};
use super::stages::{Places, Shadows};

/// Which points see which light, as far as it was asked. The points are those of the tile's kept hits, nowhere searched
/// for on a relief.
#[derive(Debug, Default)]
pub struct KnownShadows {
    lights: Vec<KnownLight>,
    /// Where shadow rays start depends on it.
    smooth_terminator: bool,
}

/// What is known of one light.
#[derive(Debug)]
struct KnownLight {
    /// Where it stands; how it shines does not matter.
    kind: FrameLightKind,
    /// Places from which a shadow ray went.
    asked: Places,
    /// Those of them where something was in the way.
    occluded: Places,
}

impl KnownShadows {
    /// Nothing is known any more.
    pub fn forget(&mut self) {
        self.lights.clear();
    }

    /// Forgets what means nothing in this frame.
    pub fn keep_for(&mut self, frame: &Frame<'_>) {
        let starts_alike = self.smooth_terminator == frame.smooth_terminator;
        self.smooth_terminator = frame.smooth_terminator;
        self.lights.retain(|known| {
            starts_alike && frame.lights.iter().any(|light| light.kind == known.kind)
        });
    }

    /// Finds the shadow rays to a light with something before their end. Only those that are not known are traced, by
    /// `trace`.
    pub fn any_hits(
        &mut self,
        light: &FrameLight,
        shadows: &mut Shadows,
        trace: impl FnOnce(&mut Shadows),
    ) {
        let index = self
            .lights
            .iter()
            .position(|known| known.kind == light.kind)
            .unwrap_or_else(|| {
                self.lights.push(KnownLight {
                    kind: light.kind,
                    asked: Places::EMPTY,
                    occluded: Places::EMPTY,
                });
                self.lights.len() - 1
            });
        let known = &mut self.lights[index];
        let lit = shadows.lit;
        shadows.lit = lit & !known.asked;
        if !shadows.lit.is_empty() {
            for place in (lit & known.asked).iter() {
                shadows.rays.t_max.0[place] = -1.0;
            }
            trace(shadows);
            known.asked = known.asked | shadows.lit;
            known.occluded = known.occluded | (shadows.occluded & shadows.lit);
        }
        shadows.lit = lit;
        shadows.occluded = known.occluded & lit;
    }
}
