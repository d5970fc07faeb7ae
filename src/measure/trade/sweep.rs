//! A whole sweep: every view of a plan, every variant in it.

use super::geometric::TrueView;
use super::page::thumbnail;
use super::pictures::{Compared, Reference};
use super::precompute::{made_before, timed};
use super::record::{FORMAT, Thumbnail};
use super::sights::{Pinhole, Sights};
use super::{
    Cell, Cost, GeometricErrors, MachineFacts, Plan, Record, Shard, Subject, SubjectFacts,
    TradeError, Variant, View, ViewFacts, quantile, timing,
};
use crate::math::hash;
use crate::measure::bench::Machine;
use crate::render::{Frame, Progressive};
use crate::scene::RenderSettings;
use crate::surface::mapping::Method;
use crate::texture::MapRole;

/// Angles whose pictures the page shows, degrees.
const SHOWN_ANGLES: [f64; 3] = [30.0, 60.0, 80.0];

/// Who looks on.
pub struct Watch<'a> {
    /// Whether to stop; asked between cells.
    pub stop: &'a (dyn Fn() -> bool + Sync),
    /// Told how many of how many cells are done.
    pub reached: &'a dyn Fn(usize, usize),
}

/// Measures a plan, or a shard of it, on so many threads (0 for one per core).
///
/// Errors and counts are pure functions of the subject and the plan: not of the threads, not of the shard. A sweep
/// that is stopped keeps the cells that are done, and says that it is partial.
///
/// # Errors
/// If the system gives no threads.
pub fn measure(
    subject: &mut Subject,
    input: &str,
    (plan, shard): (&Plan, Option<Shard>),
    threads: usize,
    watch: &Watch<'_>,
) -> Result<Record, TradeError> {
    let new_renderer = || Progressive::new(threads).map_err(TradeError::Threads);
    let (mut renderer, mut reference_renderer) = (new_renderer()?, new_renderer()?);
    if plan.eight_bits {
        subject.prepare_eight_bits();
    }
    let slopes = plan
        .methods
        .contains(&Method::Slope)
        .then(|| timed(|| subject.prepare_slopes()));
    let (variants, left_out) = measurable(subject, plan);
    let columns = columns(subject, &variants);
    let views = plan.views_of(shard);
    let total = views.len() * columns.len();
    (watch.reached)(0, total);
    let mut record = Record {
        format: FORMAT,
        subject: facts(subject, input),
        plan: plan.clone(),
        shard,
        truth: subject.truth().summary().to_owned(),
        command: String::new(),
        machines: vec![machine(renderer.threads())],
        partial: false,
        left_out,
        precompute: made_before(subject, plan, slopes),
        views: Vec::new(),
        cells: Vec::new(),
        pictures: Vec::new(),
    };
    for view in views {
        let done = record.cells.len();
        let watch = Watch {
            stop: watch.stop,
            reached: &|cells, _| (watch.reached)(done + cells, total),
        };
        let mut work = ViewWork {
            subject,
            plan,
            view,
            seen: subject.seen_from(view),
            renderer: &mut renderer,
        };
        work.measure(&columns, &mut reference_renderer, &watch, &mut record);
        if (watch.stop)() {
            break;
        }
    }
    record.partial = record.cells.len() < total;
    Ok(record)
}

/// The variants that this subject can show, and why the others cannot.
fn measurable(subject: &Subject, plan: &Plan) -> (Vec<Variant>, Vec<String>) {
    let lacks = |method: Method| match method {
        Method::Normal if !subject.has(MapRole::Normal) => {
            Some("normal: the material has no normal map")
        }
        Method::Slope if !subject.has(MapRole::Slope) => Some(
            "slope: the material has no slope map, and no normal map to make one from (from heights it is bump by central differences)",
        ),
        _ => None,
    };
    let mut left_out: Vec<String> = plan
        .methods
        .iter()
        .filter_map(|&m| lacks(m).map(str::to_owned))
        .collect();
    if plan.eight_bits && subject.depths().len() == 1 {
        left_out.push(
            "8 bits: the height map has no more, or floats that 8 bits cannot hold".to_owned(),
        );
    }
    let variants = plan.variants();
    let shown = variants.into_iter().filter(|v| lacks(v.method).is_none());
    (shown.collect(), left_out)
}

/// What is measured in each view: every variant by every depth of heights that changes it.
fn columns(subject: &Subject, variants: &[Variant]) -> Vec<(Variant, u8)> {
    let depths = subject.depths();
    let lookup = subject.snapshot().settings.mapping.lookup;
    let with_depths = |&variant: &Variant| {
        let count = if variant.method.reads(lookup).height {
            depths.len()
        } else {
            1
        };
        depths[..count]
            .iter()
            .map(move |&bits| (variant, bits))
            .collect::<Vec<_>>()
    };
    variants.iter().flat_map(with_depths).collect()
}

fn facts(subject: &Subject, input: &str) -> SubjectFacts {
    let snapshot = subject.snapshot();
    let image = subject.height_image();
    SubjectFacts {
        input: input.to_owned(),
        triangles: snapshot.scene.facts.triangles,
        material: snapshot.settings.materials[subject.material()].name.clone(),
        height_map: image.map(|i| i.name.clone()).unwrap_or_default(),
        map_size: image.map_or([0; 2], |i| [i.raw.width, i.raw.height]),
        map_bits: image.map_or(0, |i| i.raw.bits()),
        amplitude: subject.amplitude(),
        own_angle_deg: subject.own_angle_deg(),
    }
}

fn machine(threads: usize) -> MachineFacts {
    let machine = Machine::this();
    MachineFacts {
        cpu: machine.cpu,
        cores: machine.cores,
        threads,
        level: machine.level.to_string(),
        version: machine.version.to_owned(),
        commit: machine.commit.map(str::to_owned),
    }
}

/// One view being measured.
struct ViewWork<'a> {
    subject: &'a Subject,
    plan: &'a Plan,
    view: View,
    seen: RenderSettings,
    renderer: &'a mut Progressive,
}

impl ViewWork<'_> {
    /// Adds the view and its cells to the record; fewer if it is stopped.
    fn measure(
        &mut self,
        columns: &[(Variant, u8)],
        reference_renderer: &mut Progressive,
        watch: &Watch<'_>,
        record: &mut Record,
    ) {
        let size = self.plan.size;
        let exact = self.subject.true_snapshot(&self.seen, size);
        let frame = Frame::new(&exact);
        let sights = Pinhole::of(&frame).sights(self.plan.rays, self.seed());
        let truth = TrueView::new(&frame, self.subject.truth(), &sights);
        let samples = self.plan.picture_samples();
        let reference = Reference::render(reference_renderer, &exact, samples, watch.stop);
        let Some(mut reference) = reference else {
            return;
        };
        let shown = self.is_shown();
        if shown {
            let picture = thumbnail(reference.picture(), None);
            record.pictures.extend(self.named("truth", picture));
        }
        let mut cells = Vec::new();
        for column in columns {
            if (watch.stop)() {
                break;
            }
            let geometry = self.geometry(&truth, column);
            let Some(compared) = self.compared(&mut reference, column, watch) else {
                break;
            };
            if shown && self.is_usual(column) {
                let picture = thumbnail(&compared.picture, Some(&compared.flip_map));
                record
                    .pictures
                    .extend(self.named(&column.0.label(), picture));
            }
            cells.push(self.cell(column, geometry, &compared));
            (watch.reached)(cells.len(), columns.len());
        }
        self.add_costs(&mut cells, sights.covered());
        record.views.push(self.facts(&truth, &sights, &reference));
        record.cells.extend(cells);
    }

    /// Decides where this view's rays lie, whatever was measured before it.
    fn seed(&self) -> u32 {
        hash(self.plan.seed ^ hash((self.view.angle_deg * 1000.0).round() as u32))
    }

    fn geometry(&self, truth: &TrueView<'_>, &(variant, bits): &(Variant, u8)) -> GeometricErrors {
        let snapshot = self
            .subject
            .variant_snapshot(&self.seen, (&variant, bits), self.plan.size);
        let frame = Frame::new(&snapshot);
        let outline = self.subject.truth().moves_outlines().then(|| {
            let sights = Pinhole::of(&frame).sights(self.plan.rays, self.seed());
            sights.outline
        });
        truth.errors(&frame, outline.as_deref())
    }

    fn compared(
        &mut self,
        reference: &mut Reference<'_>,
        &(variant, bits): &(Variant, u8),
        watch: &Watch<'_>,
    ) -> Option<Compared> {
        let snapshot = self
            .subject
            .variant_snapshot(&self.seen, (&variant, bits), self.plan.size);
        let on_the_way = self.view.amplitude == 1.0 && bits == self.subject.depths()[0];
        reference.compare(self.renderer, &snapshot, on_the_way, watch.stop)
    }

    fn cell(
        &self,
        &(variant, bits): &(Variant, u8),
        geometry: GeometricErrors,
        compared: &Compared,
    ) -> Cell {
        Cell {
            view: self.view.index,
            angle_deg: self.view.angle_deg,
            amplitude: self.view.amplitude,
            bits,
            variant,
            geometry,
            samples: compared.samples,
            picture: compared.errors,
            picture_doubt: compared.doubt,
            limited_by_noise: compared.doubt.limits(&compared.errors),
            flip_by_samples: compared.flip_by_samples.clone(),
            cost: Cost::default(),
        }
    }

    fn add_costs(&mut self, cells: &mut [Cell], covered: f64) {
        let size = self.plan.timed_size;
        let snapshots: Vec<_> = cells
            .iter()
            .map(|cell| {
                self.subject
                    .variant_snapshot(&self.seen, (&cell.variant, cell.bits), size)
            })
            .collect();
        let costs = timing::costs(self.renderer, &snapshots, self.plan.rounds, covered);
        for (cell, cost) in cells.iter_mut().zip(costs) {
            cell.cost = cost;
        }
    }

    fn facts(&self, truth: &TrueView<'_>, sights: &Sights, reference: &Reference<'_>) -> ViewFacts {
        let angles = truth.angles_deg();
        ViewFacts {
            index: self.view.index,
            angle_deg: self.view.angle_deg,
            amplitude: self.view.amplitude,
            rays: truth.rays(),
            ray_angles_deg: [0.05, 0.5, 0.95].map(|q| quantile(&angles, q)),
            covered: sights.covered(),
            truth_doubt_texels: truth.doubt_texels,
            reference_noise: reference.noise,
        }
    }

    /// Whether the page shows pictures of this view.
    fn is_shown(&self) -> bool {
        let nearest = |wanted: f64| {
            let distance = |a: &&f64| (**a - wanted).abs();
            let angles = self.plan.angles_deg.iter();
            angles
                .min_by(|a, b| distance(a).total_cmp(&distance(b)))
                .copied()
        };
        let usual = self.plan.amplitudes.contains(&1.0);
        (self.view.amplitude == 1.0 || !usual && self.view.index < self.plan.angles_deg.len())
            && SHOWN_ANGLES
                .iter()
                .any(|&a| nearest(a) == Some(self.view.angle_deg))
    }

    /// Whether the page shows pictures of this variant: each method once.
    fn is_usual(&self, &(variant, bits): &(Variant, u8)) -> bool {
        bits == self.subject.depths()[0] && variant.is_usual()
    }

    fn named(
        &self,
        label: &str,
        (picture, error): (Option<String>, Option<String>),
    ) -> Option<Thumbnail> {
        Some(Thumbnail {
            view: self.view.index,
            label: label.to_owned(),
            picture: picture?,
            error: error.unwrap_or_default(),
        })
    }
}
