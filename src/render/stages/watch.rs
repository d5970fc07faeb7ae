//! Where a tile's time and work go, for whoever asks. This room reads no clock; a listener may.

use super::super::Frame;
use super::{PLACES, Places, Rays, Shadows, Surfaces, Walks};
use crate::geometry::HitLanes;
use crate::surface::displaced::Tracer;

/// A part of a tile's work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Rays are made or traced, of all kinds: camera, shadow, mirror.
    Trace,
    /// Surface points are made from hits: interpolated, perturbed, coloured by maps.
    Perturb,
    /// Lights are aimed at and added up, mirrors set.
    Shade,
    /// Samples go into the film.
    Resolve,
}

/// Is told what a worker has just done. `()` does not listen, and costs nothing; nor does any listener for what
/// it leaves to the defaults here.
pub trait StageWatch {
    /// A tile begins.
    fn begin(&mut self);
    /// Everything since the last call belonged to this stage.
    fn done(&mut self, stage: Stage);
    /// Whether even rays whose hits are known must be traced, because kept hits do not tell what they cost.
    fn wants_every_ray(&self) -> bool {
        false
    }
    /// Rays were traced to their closest hits; the tracer holds those against displaced surfaces.
    fn traced(&mut self, _rays: &Places, _tracer: &Tracer) {}
    /// Hits became mapped surfaces.
    fn mapped(
        &mut self,
        _frame: &Frame<'_>,
        _hit: (&Rays, &HitLanes<PLACES>),
        _surfaces: &Surfaces,
    ) {
    }
    /// A relief was asked what of itself it shadows.
    fn walked(&mut self, _walks: &Walks) {}
    /// Shadow rays to a light were traced; the tracer holds those against displaced surfaces.
    fn shadowed(
        &mut self,
        _frame: &Frame<'_>,
        _points: (&Rays, &Surfaces),
        _traced: (&Shadows, &Tracer),
    ) {
    }
}

/// Both listen.
impl<A: StageWatch, B: StageWatch> StageWatch for (&mut A, &mut B) {
    fn begin(&mut self) {
        self.0.begin();
        self.1.begin();
    }
    fn done(&mut self, stage: Stage) {
        self.0.done(stage);
        self.1.done(stage);
    }
    fn wants_every_ray(&self) -> bool {
        self.0.wants_every_ray() || self.1.wants_every_ray()
    }
    fn traced(&mut self, rays: &Places, tracer: &Tracer) {
        self.0.traced(rays, tracer);
        self.1.traced(rays, tracer);
    }
    fn mapped(&mut self, frame: &Frame<'_>, hit: (&Rays, &HitLanes<PLACES>), surfaces: &Surfaces) {
        self.0.mapped(frame, hit, surfaces);
        self.1.mapped(frame, hit, surfaces);
    }
    fn walked(&mut self, walks: &Walks) {
        self.0.walked(walks);
        self.1.walked(walks);
    }
    fn shadowed(
        &mut self,
        frame: &Frame<'_>,
        points: (&Rays, &Surfaces),
        traced: (&Shadows, &Tracer),
    ) {
        self.0.shadowed(frame, points, traced);
        self.1.shadowed(frame, points, traced);
    }
}

impl StageWatch for () {
    #[inline(always)]
    fn begin(&mut self) {}
    #[inline(always)]
    fn done(&mut self, _: Stage) {}
}
