//! One renderer, or two that render the same snapshot by different methods, pass by pass.

use std::io;

use egui::Color32;

use super::{PassRenderer, RenderRequest, RendererFactory};
use crate::math::false_color;
use crate::measure::error_map::{self, ErrorSummary, error_map};
use crate::render::{
    Counters, Legend, MARK, NO_VALUE, PassEnd, Recording, Records, Shown, Snapshot,
};
use crate::scene::{DisplaySettings, View};

/// The renderers of a job. The second exists only while two methods are compared: a method beside itself is one picture
/// shown twice.
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
    /// Records of both that were asked for since they started.
    records: [Option<Remembered>; 2],
}

/// Records of what a renderer showed.
struct Remembered {
    shown: Shown,
    records: Records,
}

/// What is shown of both renderers.
pub(super) struct Pictures {
    /// Of the first.
    pub first: Vec<Color32>,
    /// Of the second, or the errors.
    pub other: Option<Vec<Color32>>,
    /// How far they are apart, if that is shown.
    pub error: Option<ErrorSummary>,
    /// What the colours of a view mean.
    pub legend: Option<Legend>,
}

impl Pair {
    pub fn new(threads: usize, factory: &mut RendererFactory) -> io::Result<Self> {
        Ok(Self {
            threads,
            first: factory(threads)?,
            second: None,
            spent: [0.0; 4],
            stage_millis: [0.0; 4],
            records: [const { None }; 2],
        })
    }

    /// Starts both afresh: the second renders what the first does, but for the method.
    pub fn start(
        &mut self,
        request: &RenderRequest,
        factory: &mut RendererFactory,
    ) -> io::Result<()> {
        let (snapshot, recording) = (&request.snapshot, request.recording());
        let a = snapshot.settings.mapping.method;
        match request.compare.filter(|compare| compare.method != a) {
            None => self.drop_second(),
            Some(compare) => {
                let mut settings = (*snapshot.settings).clone();
                settings.mapping.method = compare.method;
                let second = match &mut self.second {
                    Some(second) => second,
                    none => none.insert(factory(self.threads)?),
                };
                second.record(recording);
                second.start(Snapshot {
                    settings: settings.into(),
                    ..snapshot.clone()
                });
            }
        }
        self.first.record(recording);
        self.first.start(snapshot.clone());
        self.records = [const { None }; 2];
        self.spent = [0.0; 4];
        Ok(())
    }

    /// The comparison is over.
    pub fn drop_second(&mut self) {
        self.second = None;
        self.records[1] = None;
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

    /// Encodes what is shown of both, each into a buffer made by `buffer`.
    pub fn encode(
        &mut self,
        request: &RenderRequest,
        mut buffer: impl FnMut() -> Vec<Color32>,
    ) -> Pictures {
        let DisplaySettings {
            exposure_ev, view, ..
        } = request.display;
        let is_recorded = request.recording() != Recording::Nothing;
        if is_recorded {
            let stays = |known: &Remembered, renderer: &dyn PassRenderer| {
                // Of all that is in records only the number of samples changes from pass to pass.
                known.shown == renderer.shown() && view != View::Samples
            };
            let renderers = [Some(&self.first), self.second.as_ref()];
            for (known, renderer) in self.records.iter_mut().zip(renderers) {
                let renderer = renderer.map(|renderer| &**renderer);
                if known
                    .as_ref()
                    .zip(renderer)
                    .is_some_and(|(k, r)| stays(k, r))
                {
                    continue;
                }
                *known = renderer.and_then(|renderer| {
                    let (shown, records) = (renderer.shown(), renderer.records()?);
                    Some(Remembered { shown, records })
                });
            }
        }
        let encoded = |renderer: &dyn PassRenderer, mut pixels: Vec<Color32>| {
            renderer.encode_shown_into(exposure_ev, bytemuck::cast_slice_mut(&mut pixels));
            pixels
        };
        let mut first = encoded(&*self.first, buffer());
        let mut other = request.compare.map(|_| match &self.second {
            Some(second) => encoded(&**second, buffer()),
            None => {
                let mut twin = buffer();
                twin.copy_from_slice(&first);
                twin
            }
        });
        let mut records = self.records.each_ref().map(|known| {
            let known = known.as_ref().filter(|_| is_recorded);
            known.map(|known| &known.records)
        });
        if self.second.is_none() && request.compare.is_some() {
            records[1] = records[0];
        }
        let error = request.compare.and_then(|compare| compare.error);
        let error = error.zip(other.as_mut()).map(|(error, other)| {
            let Shown { size, stride } = self.first.shown();
            let shown = |pixels, records| error_map::Shown { pixels, records };
            let [a, b] = [&first, &*other].map(|p| bytemuck::cast_slice::<Color32, [u8; 4]>(p));
            let pair = [shown(a, records[0]), shown(b, records[1])];
            let map = error_map(error.metric, pair, size[0] as usize, stride);
            for (pixel, &value) in other.iter_mut().zip(&map) {
                *pixel = error_color(value, error.full_scale);
            }
            ErrorSummary::of(error.metric, &map)
        });
        // Errors stand where the second picture would.
        let views = [
            records[0].map(|records| (records, &mut first)),
            records[1].zip(other.as_mut().filter(|_| error.is_none())),
        ];
        let known: Vec<_> = views
            .iter()
            .flatten()
            .map(|(records, _)| *records)
            .collect();
        let legend = if known.is_empty() {
            None
        } else {
            Legend::of(view, &known)
        };
        for (records, pixels) in views.into_iter().flatten() {
            if let Some(legend) = &legend {
                legend.paint(records, bytemuck::cast_slice_mut(pixels));
            }
        }
        Pictures {
            first,
            other,
            error,
            legend,
        }
    }
}

/// The false colour of an error; loud where only one picture shows a surface, grey where there is nothing to say.
fn error_color(value: f32, full_scale: f32) -> Color32 {
    let [r, g, b] = if value.is_nan() {
        NO_VALUE
    } else if value.is_infinite() {
        MARK
    } else {
        false_color(value / full_scale)
    };
    Color32::from_rgb(r, g, b)
}
