//! Where a tile's time goes, for whoever asks. This room reads no clock; a listener may.

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

/// Is told what a worker has just done. `()` does not listen, and costs nothing.
pub trait StageWatch {
    /// A tile begins.
    fn begin(&mut self);
    /// Everything since the last call belonged to this stage.
    fn done(&mut self, stage: Stage);
}

impl StageWatch for () {
    #[inline(always)]
    fn begin(&mut self) {}
    #[inline(always)]
    fn done(&mut self, _: Stage) {}
}
