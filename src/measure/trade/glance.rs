//! A small sweep of the scene on show, for a window: few rays, small pictures, soon done.

use super::geometric::TrueView;
use super::pictures::{Reference, Samples};
use super::sights::Pinhole;
use super::{
    Advice, GeometricErrors, Measured, Subject, TradeError, Truth, Variant, View, advise, timing,
};
use crate::render::{Frame, Progressive, Snapshot};
use crate::surface::mapping::Method;
use crate::texture::MapRole;

/// View rays of a view.
const RAYS: u32 = 600;
/// Angles beside the scene's own, degrees.
const ANGLES: [f64; 6] = [0.0, 30.0, 45.0, 60.0, 75.0, 85.0];
/// Columns and rows of the frames that are timed.
const TIMED: [u32; 2] = [160, 90];
/// Times of each frame.
const ROUNDS: u32 = 5;
/// Columns and rows of the pictures that are compared in the scene's own view, and their samples per pixel.
const COMPARED: [u32; 2] = [160, 90];
const SAMPLES: Samples = Samples { half: 2, most: 8 };

/// What a glance found.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Glance {
    /// Angle of the scene's own view, degrees.
    pub own_angle_deg: f64,
    /// Every variant in the scene's own view, then in others.
    pub points: Vec<GlancePoint>,
    /// The cheapest that are good enough.
    pub advice: Vec<Advice>,
}

/// One variant in one view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GlancePoint {
    /// Method and parameters.
    pub variant: Variant,
    /// Angle of the view, degrees.
    pub angle_deg: f64,
    /// Whether this is the scene's own view.
    pub is_own: bool,
    /// Where rays land.
    pub errors: GeometricErrors,
    /// Mean FLIP of the picture; in the scene's own view.
    pub flip: Option<f64>,
    /// Time of a sample on the model, median, ns.
    pub ns: f64,
}

/// Measures every method, by its present parameters and by those of a quick plan, in the snapshot's view; and by its
/// present parameters from other angles. `None` if it was stopped.
///
/// Relaxed cones are left out unless they are the chosen method, because their map takes seconds to make.
///
/// # Errors
/// [`TradeError`].
pub fn glance(
    snapshot: &Snapshot,
    renderer: &mut Progressive,
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Glance>, TradeError> {
    let subject = Subject::new(snapshot.clone(), Truth::suiting(snapshot))?;
    let own = subject.own_angle_deg();
    let mut glance = Glance {
        own_angle_deg: own,
        ..Glance::default()
    };
    for (i, &angle_deg) in std::iter::once(&own).chain(&ANGLES).enumerate() {
        let is_own = i == 0;
        let view = View {
            index: i,
            angle_deg,
            amplitude: 1.0,
        };
        let variants = variants(&subject, is_own);
        let Some(points) = look(&subject, (view, is_own), &variants, renderer, stop)? else {
            return Ok(None);
        };
        glance.points.extend(points);
    }
    glance.advice = advise(&glance.measured(), own);
    Ok(Some(glance))
}

fn variants(subject: &Subject, is_own: bool) -> Vec<Variant> {
    let mapping = &subject.snapshot().settings.mapping;
    let is_possible = |m: &Method| match m {
        Method::RelaxedCone => mapping.method == Method::RelaxedCone,
        Method::Normal => subject.has(MapRole::Normal),
        Method::Slope => subject.has(MapRole::Slope),
        _ => true,
    };
    let mut variants = Vec::new();
    for method in Method::ALL.into_iter().filter(is_possible) {
        variants.push(Variant::current(method, mapping));
        if is_own {
            variants.extend(
                Variant::of(method, true)
                    .into_iter()
                    .filter(|v| !v.is_bare()),
            );
        }
    }
    let mut seen = std::collections::HashSet::new();
    variants.retain(|v| seen.insert(*v));
    variants
}

fn look(
    subject: &Subject,
    (view, is_own): (View, bool),
    variants: &[Variant],
    renderer: &mut Progressive,
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Vec<GlancePoint>>, TradeError> {
    let seen = subject.seen_from(view);
    let size = subject.snapshot().size;
    let exact = subject.true_snapshot(&seen, size);
    let frame = Frame::new(&exact);
    let sights = Pinhole::of(&frame).sights(RAYS, 1);
    let truth = TrueView::new(&frame, subject.truth(), &sights);
    let mut points = Vec::new();
    for &variant in variants {
        if stop() {
            return Ok(None);
        }
        let snapshot = subject.variant_snapshot(&seen, (&variant, 0), size);
        let frame = Frame::new(&snapshot);
        points.push(GlancePoint {
            variant,
            angle_deg: view.angle_deg,
            is_own,
            errors: truth.errors(&frame, None),
            flip: None,
            ns: f64::INFINITY,
        });
    }
    if is_own {
        let timed: Vec<_> = variants
            .iter()
            .map(|v| subject.variant_snapshot(&seen, (v, 0), TIMED))
            .collect();
        let costs = timing::costs(renderer, &timed, ROUNDS, sights.covered());
        for (point, cost) in points.iter_mut().zip(costs) {
            point.ns = cost.ns_per_sample.median;
        }
        let exact = subject.true_snapshot(&seen, COMPARED);
        let mut another = Progressive::new(renderer.threads()).map_err(TradeError::Threads)?;
        let reference = Reference::render(&mut another, &exact, SAMPLES, stop);
        let Some(mut reference) = reference else {
            return Ok(None);
        };
        for point in &mut points {
            let snapshot = subject.variant_snapshot(&seen, (&point.variant, 0), COMPARED);
            let Some(compared) = reference.compare(renderer, &snapshot, false, stop) else {
                return Ok(None);
            };
            point.flip = Some(compared.errors.flip);
        }
    }
    Ok(Some(points))
}

impl Glance {
    /// What advice is taken from. Times are those of the scene's own view.
    #[must_use]
    pub fn measured(&self) -> Vec<Measured> {
        let time = |variant: Variant| {
            let own = self
                .points
                .iter()
                .find(|p| p.is_own && p.variant == variant);
            own.map_or(f64::INFINITY, |p| p.ns)
        };
        let point = |p: &GlancePoint| Measured {
            variant: p.variant,
            angle_deg: p.angle_deg,
            p95_texels: p.errors.uv_texels.p95,
            flip: p.flip,
            ns: time(p.variant),
        };
        self.points.iter().map(point).collect()
    }
}
