//! Pictures of methods against a reference, from the same samples, with what either half of these says.

use super::{PictureDoubt, PictureErrors};
use crate::math::LinearRgb;
use crate::measure::flip::{PIXELS_PER_DEGREE, flip};
use crate::measure::metrics::distance;
use crate::render::{PassEnd, Picture, Progressive, Snapshot};

/// Samples per pixel of pictures that are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Samples {
    /// Half of what a picture begins with, at least 1.
    pub half: u32,
    /// Doubling ends here, however much is in doubt.
    pub most: u32,
}

/// The true picture of a view, from as many samples as methods need to be told from it.
pub struct Reference<'a> {
    /// How far the halves of [`picture`](Self::picture), from samples of their own, are from the whole.
    pub noise: PictureErrors,
    samples: Samples,
    /// Goes on where the last set ends.
    renderer: &'a mut Progressive,
    /// From the first 2, 4, 8, … times `samples.half` samples; the first two at once, others when asked for.
    sets: Vec<Halved>,
}

/// A picture, and the two that either half of its samples make.
struct Halved {
    whole: Picture,
    halves: [Picture; 2],
}

impl Halved {
    /// `first` is made of the first half of the samples.
    fn new(whole: Picture, first: Picture) -> Self {
        let second = Picture {
            pixels: whole
                .pixels
                .iter()
                .zip(&first.pixels)
                .map(|(&whole, &first)| rest(whole, first))
                .collect(),
            ..first
        };
        Self {
            whole,
            halves: [first, second],
        }
    }

    /// How far the halves are from the whole.
    fn noise(&self) -> PictureErrors {
        let [a, b] = self.halves.each_ref();
        PictureErrors::worse(errors(a, &self.whole).0, errors(b, &self.whole).0)
    }

    /// How far it is from another of the same samples, what halves of the samples make of that, and the FLIP map.
    fn against(&self, other: &Self) -> (PictureErrors, PictureDoubt, Vec<f32>) {
        let (whole, flip_map) = errors(&self.whole, &other.whole);
        let halves = [0, 1].map(|i| errors(&self.halves[i], &other.halves[i]).0);
        (whole, PictureDoubt::of(&whole, &halves), flip_map)
    }
}

/// Renders so many samples on; `false` if it was stopped.
fn samples_on(renderer: &mut Progressive, count: u32, stop: &(dyn Fn() -> bool + Sync)) -> bool {
    let goal = renderer.samples() + count;
    while renderer.samples() < goal {
        if renderer.pass(stop) == PassEnd::Stopped {
            return false;
        }
    }
    true
}

fn start(renderer: &mut Progressive, snapshot: &Snapshot) {
    let mut snapshot = snapshot.clone();
    let mut settings = (*snapshot.settings).clone();
    // Whoever started it knows when to end.
    settings.samples = u32::MAX;
    snapshot.settings = std::sync::Arc::new(settings);
    renderer.start(snapshot);
}

impl<'a> Reference<'a> {
    /// Renders it with `4 · samples.half` samples per pixel; `None` if it was stopped.
    ///
    /// Either half of these, and either half of the first half, is a set of its own, as evenly spread as the whole:
    /// what the two disagree about is what the whole does not know yet.
    #[must_use]
    pub fn render(
        renderer: &'a mut Progressive,
        snapshot: &Snapshot,
        samples: Samples,
        stop: &(dyn Fn() -> bool + Sync),
    ) -> Option<Self> {
        start(renderer, snapshot);
        let mut next = || samples_on(renderer, samples.half, stop).then(|| renderer.picture());
        let [quarter, first] = [next()?, next()?];
        let mut reference = Self {
            noise: PictureErrors::default(),
            samples,
            renderer,
            sets: vec![Halved::new(first, quarter)],
        };
        reference.noise = reference.set(1, stop)?.noise();
        Some(reference)
    }

    /// From `4 · samples.half` samples.
    pub fn picture(&self) -> &Picture {
        &self.sets[1].whole
    }

    /// The picture from the first `2 · samples.half · 2ⁱ` samples, made if it is not there yet; `None` if it was stopped.
    fn set(&mut self, i: usize, stop: &(dyn Fn() -> bool + Sync)) -> Option<&Halved> {
        while self.sets.len() <= i {
            let known = &self.sets[self.sets.len() - 1].whole;
            let more = self.samples.half << self.sets.len();
            if !samples_on(self.renderer, more, stop) {
                return None;
            }
            self.sets
                .push(Halved::new(self.renderer.picture(), known.clone()));
        }
        Some(&self.sets[i])
    }

    /// The picture of a method from `2 · samples.half` samples per pixel, with its errors; from twice as many, and so
    /// on, as long as one of these is in doubt. `on_the_way` also asks for the FLIP after 1, 2, 4, … of the first
    /// samples, against [`picture`](Self::picture). `None` if it was stopped.
    #[must_use]
    pub fn compare(
        &mut self,
        renderer: &mut Progressive,
        snapshot: &Snapshot,
        on_the_way: bool,
        stop: &(dyn Fn() -> bool + Sync),
    ) -> Option<Compared> {
        let Samples { half, most } = self.samples;
        start(renderer, snapshot);
        let mut flip_by_samples = Vec::new();
        let mut next = 1;
        let mut quarter = None;
        while renderer.samples() < 2 * half {
            if !samples_on(renderer, 1, stop) {
                return None;
            }
            let samples = renderer.samples();
            if samples == half {
                quarter = Some(renderer.picture());
            }
            if on_the_way && (samples == next || samples == 2 * half) {
                flip_by_samples.push(mean(&flip_of(&renderer.picture(), self.picture())));
                next *= 2;
            }
        }
        let first = renderer.picture();
        let quarter = quarter.unwrap_or_else(|| first.clone());
        let mut picture = Halved::new(first, quarter);
        let mut set = 0;
        loop {
            let (errors, doubt, flip_map) = picture.against(self.set(set, stop)?);
            let samples = renderer.samples();
            if !doubt.limits(&errors) || samples > most / 2 {
                return Some(Compared {
                    errors,
                    doubt,
                    samples,
                    flip_by_samples,
                    picture: picture.whole,
                    flip_map,
                });
            }
            if !samples_on(renderer, samples, stop) {
                return None;
            }
            picture = Halved::new(renderer.picture(), picture.whole);
            set += 1;
        }
    }
}

/// A method's picture against the reference.
pub struct Compared {
    /// How far it is.
    pub errors: PictureErrors,
    /// How far that is from what either half of the samples says.
    pub doubt: PictureDoubt,
    /// Samples per pixel that it took.
    pub samples: u32,
    /// After 1, 2, 4, … and all samples; empty if nobody asked.
    pub flip_by_samples: Vec<f64>,
    /// The picture.
    pub picture: Picture,
    /// FLIP of every pixel.
    pub flip_map: Vec<f32>,
}

/// What the other half of the samples says: `2 · whole − first`.
fn rest(whole: LinearRgb, first: LinearRgb) -> LinearRgb {
    let [w, f] = [whole, first].map(LinearRgb::to_array);
    LinearRgb::new(2.0 * w[0] - f[0], 2.0 * w[1] - f[1], 2.0 * w[2] - f[2])
}

fn flip_of(a: &Picture, b: &Picture) -> Vec<f32> {
    flip(&a.pixels, &b.pixels, a.width as usize, PIXELS_PER_DEGREE)
}

fn mean(values: &[f32]) -> f64 {
    values.iter().map(|&v| f64::from(v)).sum::<f64>() / values.len().max(1) as f64
}

/// The distance of two pictures of one size, and their FLIP map.
fn errors(a: &Picture, b: &Picture) -> (PictureErrors, Vec<f32>) {
    let map = flip_of(a, b);
    let flip = mean(&map);
    // The pictures of one view are of one size; if not, that is the largest error there is.
    let errors = distance(a, b).map_or(
        PictureErrors {
            linear_rmse: f64::MAX,
            psnr_db: Some(f64::MIN),
            ssim: -1.0,
            flip: 1.0,
        },
        |d| PictureErrors {
            linear_rmse: d.linear_rmse,
            psnr_db: d.psnr_db.is_finite().then_some(d.psnr_db),
            ssim: d.ssim,
            flip,
        },
    );
    (errors, map)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gray(values: &[f32]) -> Picture {
        Picture {
            width: values.len() as u32,
            height: 1,
            pixels: values.iter().map(|&v| LinearRgb::gray(v)).collect(),
        }
    }

    #[test]
    fn halves_of_known_pictures() {
        let halved = Halved::new(gray(&[0.5, 0.25]), gray(&[0.75, 0.25]));
        assert_eq!(halved.halves[1].pixels, gray(&[0.25, 0.25]).pixels);
        let off = (0.25_f64 * 0.25 / 2.0).sqrt();
        assert!((halved.noise().linear_rmse - off).abs() < 1e-7);
    }

    #[test]
    fn what_both_pictures_share_is_no_doubt() {
        // The samples differ, but of both pictures alike.
        let a = Halved::new(gray(&[0.5, 0.25]), gray(&[0.75, 0.25]));
        let b = Halved::new(gray(&[0.375, 0.125]), gray(&[0.625, 0.125]));
        let (errors, doubt, _) = a.against(&b);
        assert_eq!((errors.linear_rmse, doubt.linear_rmse), (0.125, 0.0));
        let (same, none, map) = a.against(&a);
        assert_eq!(
            (same.linear_rmse, same.psnr_db, map),
            (0.0, None, vec![0.0; 2])
        );
        assert_eq!(none, PictureDoubt::default());
        // Here only one half sees a difference.
        let c = Halved::new(gray(&[0.5, 0.125]), gray(&[0.75, 0.25]));
        let (errors, doubt, _) = a.against(&c);
        assert!(doubt.linear_rmse >= 0.99 * errors.linear_rmse, "{doubt:?}");
    }

    #[test]
    fn equal_pictures_have_no_error_at_all() {
        let (same, map) = errors(&gray(&[0.1, 0.9]), &gray(&[0.1, 0.9]));
        assert_eq!(
            (same.linear_rmse, same.psnr_db, same.flip),
            (0.0, None, 0.0)
        );
        assert_eq!(map, [0.0, 0.0]);
        let (other, _) = errors(&gray(&[0.0, 0.0]), &gray(&[1.0, 1.0]));
        assert_eq!(other.linear_rmse, 1.0);
        assert!(other.flip > 0.9 && other.psnr_db.is_some_and(|db| db.abs() < 1e-4));
    }
}
