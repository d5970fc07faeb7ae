//! One renderer, or two that render the same snapshot by different methods, pass by pass.

use std::io;

use egui::Color32;

use super::{Compare, PassRenderer, RendererFactory};
use crate::measure::error_map::{ErrorSummary, error_map};
use crate::render::{Counters, PassEnd, Snapshot};
use crate::viewer::false_color::false_color;

/// The renderers of a job. The second exists only while two methods are compared.
pub(super) struct Pair {
    /// The pool size asked for.
    pub threads: usize,
    /// Of the picture itself.
    pub first: Box<dyn PassRenderer>,
    second: Option<Box<dyn PassRenderer>>,
    /// Thread time by stage of the first's pass under way, ms.
    spent: [f64; 4],
    /// The same of its last whole pass.
    pub stage_millis: [f64; 4],
}

impl Pair {
    pub fn new(threads: usize, factory: &mut RendererFactory) -> io::Result<Self> {
        Ok(Self {
            threads,
            first: factory(threads)?,
            second: None,
            spent: [0.0; 4],
            stage_millis: [0.0; 4],
        })
    }

    /// Starts both afresh: the second renders what the first does, but for the method.
    pub fn start(
        &mut self,
        snapshot: Snapshot,
        compare: Option<Compare>,
        factory: &mut RendererFactory,
    ) -> io::Result<()> {
        match compare {
            None => self.drop_second(),
            Some(compare) => {
                let mut settings = (*snapshot.settings).clone();
                settings.mapping.method = compare.method;
                let second = match &mut self.second {
                    Some(second) => second,
                    none => none.insert(factory(self.threads)?),
                };
                second.start(Snapshot {
                    settings: settings.into(),
                    ..snapshot.clone()
                });
            }
        }
        self.first.start(snapshot);
        self.spent = [0.0; 4];
        Ok(())
    }

    /// The comparison is over.
    pub fn drop_second(&mut self) {
        self.second = None;
    }

    /// A pass or preview of the first, then of the second. Where that was stopped between them, it goes on there.
    pub fn advance(&mut self, stride: u32, stop: &(dyn Fn() -> bool + Sync)) -> PassEnd {
        let is_ahead =
            |second: &dyn PassRenderer| stride == 1 && self.first.samples() > second.samples();
        if !self.second.as_deref().is_some_and(is_ahead)
            && self.advance_first(stride, stop) == PassEnd::Stopped
        {
            return PassEnd::Stopped;
        }
        match &mut self.second {
            None => PassEnd::Complete,
            Some(second) if stride == 1 => second.pass(stop),
            Some(second) => second.preview(stride, stop),
        }
    }

    fn advance_first(&mut self, stride: u32, stop: &(dyn Fn() -> bool + Sync)) -> PassEnd {
        if stride > 1 {
            return self.first.preview(stride, stop);
        }
        let (end, spent) = self.first.timed_pass(stop);
        // A pass that was stopped goes on later.
        let sums = self.spent.iter_mut().zip(spent);
        sums.for_each(|(sum, spent)| *sum += spent);
        if end == PassEnd::Complete {
            self.stage_millis = std::mem::take(&mut self.spent);
        }
        end
    }

    /// Samples that every pixel of both has.
    pub fn samples(&self) -> u32 {
        let second = self.second.as_ref().map_or(u32::MAX, |r| r.samples());
        self.first.samples().min(second)
    }

    pub fn is_converged(&self) -> bool {
        self.first.is_converged() && self.second.as_ref().is_none_or(|r| r.is_converged())
    }

    /// Of both together.
    pub fn counters(&self) -> Counters {
        let mut sum = self.first.counters();
        if let Some(second) = &self.second {
            sum += second.counters();
        }
        sum
    }

    /// Whether both can be shown at one resolution. Between a preview of the first and one of the second they cannot.
    pub fn is_even(&self) -> bool {
        let second = self.second.as_ref();
        second.is_none_or(|second| second.shown() == self.first.shown())
    }

    /// Encodes the second beside the shown first, or their errors in false colours, into a buffer made by
    /// `buffer`. Does nothing where nothing is compared.
    pub fn encode_second(
        &self,
        compare: Option<Compare>,
        exposure_ev: f32,
        first: &[Color32],
        buffer: impl FnOnce() -> Vec<Color32>,
    ) -> Option<(Vec<Color32>, Option<ErrorSummary>)> {
        let second = self.second.as_ref()?;
        let error = compare?.error;
        let mut pixels = buffer();
        second.encode_shown_into(exposure_ev, bytemuck::cast_slice_mut(&mut pixels));
        let summary = error.map(|error| {
            let shown = second.shown();
            let [a, b] = [first, &pixels].map(bytemuck::cast_slice::<Color32, [u8; 4]>);
            let map = error_map(error.metric, a, b, shown.size[0] as usize, shown.stride);
            for (pixel, value) in pixels.iter_mut().zip(&map) {
                *pixel = false_color(value / error.full_scale);
            }
            ErrorSummary::of(error.metric, &map)
        });
        Some((pixels, summary))
    }
}
