//! Pictures of methods against a reference that knows its own error.

use super::PictureErrors;
use crate::math::LinearRgb;
use crate::measure::flip::{PIXELS_PER_DEGREE, flip};
use crate::measure::metrics::distance;
use crate::render::{PassEnd, Picture, Progressive, Snapshot};

/// Errors below this many times the reference's own are limited by its noise.
const CLEAR_OF_NOISE: f64 = 10.0;

/// The true picture of a view.
pub struct Reference {
    /// From all samples.
    pub picture: Picture,
    /// How far its halves, from samples of their own, are from the whole.
    pub noise: PictureErrors,
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

fn start(renderer: &mut Progressive, snapshot: &Snapshot, samples: u32) {
    let mut snapshot = snapshot.clone();
    let mut settings = (*snapshot.settings).clone();
    settings.samples = samples;
    snapshot.settings = std::sync::Arc::new(settings);
    renderer.start(snapshot);
}

impl Reference {
    /// Renders it with `2 · half` samples per pixel; `None` if it was stopped.
    ///
    /// The first half of the samples and the second are sets of their own, each as evenly spread as the whole, so
    /// what they disagree about is what the whole does not know yet.
    #[must_use]
    pub fn render(
        renderer: &mut Progressive,
        snapshot: &Snapshot,
        half: u32,
        stop: &(dyn Fn() -> bool + Sync),
    ) -> Option<Self> {
        start(renderer, snapshot, 2 * half);
        let first = samples_on(renderer, half, stop).then(|| renderer.picture())?;
        let picture = samples_on(renderer, half, stop).then(|| renderer.picture())?;
        let second = Picture {
            pixels: picture
                .pixels
                .iter()
                .zip(&first.pixels)
                .map(|(&whole, &first)| rest(whole, first))
                .collect(),
            ..first
        };
        let halves = [&first, &second].map(|half| errors(half, &picture).0);
        Some(Self {
            noise: PictureErrors::worse(halves[0], halves[1]),
            picture,
        })
    }

    /// The picture of a method from `samples` per pixel, with its errors. `on_the_way` also asks for the FLIP after
    /// 1, 2, 4, … samples.
    #[must_use]
    pub fn compare(
        &self,
        renderer: &mut Progressive,
        snapshot: &Snapshot,
        samples: u32,
        on_the_way: bool,
    ) -> Compared {
        start(renderer, snapshot, samples);
        let mut flip_by_samples = Vec::new();
        let mut next = 1;
        while !renderer.is_converged() {
            renderer.pass(&|| false);
            if on_the_way && renderer.samples() == next && next < samples {
                flip_by_samples.push(mean(&flip_of(&renderer.picture(), &self.picture)));
                next *= 2;
            }
        }
        let picture = renderer.picture();
        let (errors, flip_map) = errors(&picture, &self.picture);
        if on_the_way {
            flip_by_samples.push(errors.flip);
        }
        Compared {
            limited_by_noise: errors.is_limited_by(&self.noise),
            errors,
            flip_by_samples,
            picture,
            flip_map,
        }
    }
}

/// A method's picture against the reference.
pub struct Compared {
    /// How far it is.
    pub errors: PictureErrors,
    /// Whether the reference's noise shows in that.
    pub limited_by_noise: bool,
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

impl PictureErrors {
    /// The worse of two in each figure.
    fn worse(a: Self, b: Self) -> Self {
        Self {
            linear_rmse: a.linear_rmse.max(b.linear_rmse),
            psnr_db: match (a.psnr_db, b.psnr_db) {
                (Some(a), Some(b)) => Some(a.min(b)),
                (a, b) => a.or(b),
            },
            ssim: a.ssim.min(b.ssim),
            flip: a.flip.max(b.flip),
        }
    }

    /// Whether one of the errors is less than ten times what the reference does not know of itself. Decibels follow
    /// the root mean square: ten times are 20 dB.
    fn is_limited_by(&self, noise: &Self) -> bool {
        let db = 20.0 * CLEAR_OF_NOISE.log10();
        let psnr_is_limited = match (self.psnr_db, noise.psnr_db) {
            (_, None) => false,
            (None, Some(_)) => true,
            (Some(own), Some(noise)) => own + db > noise,
        };
        self.linear_rmse < CLEAR_OF_NOISE * noise.linear_rmse
            || self.flip < CLEAR_OF_NOISE * noise.flip
            || 1.0 - self.ssim < CLEAR_OF_NOISE * (1.0 - noise.ssim)
            || psnr_is_limited
    }
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
        let [whole, first] = [LinearRgb::gray(0.5), LinearRgb::gray(0.75)];
        assert_eq!(rest(whole, first), LinearRgb::gray(0.25));
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

    #[test]
    fn an_error_is_clear_of_noise_from_ten_times_on() {
        let noise = PictureErrors {
            linear_rmse: 0.001,
            psnr_db: Some(60.0),
            ssim: 0.999,
            flip: 0.002,
        };
        let clear = PictureErrors {
            linear_rmse: 0.011,
            psnr_db: Some(39.0),
            ssim: 0.98,
            flip: 0.021,
        };
        assert!(!clear.is_limited_by(&noise));
        let near = [
            PictureErrors {
                linear_rmse: 0.009,
                ..clear
            },
            PictureErrors {
                psnr_db: Some(41.0),
                ..clear
            },
            PictureErrors {
                psnr_db: None,
                ..clear
            },
            PictureErrors {
                ssim: 0.995,
                ..clear
            },
            PictureErrors {
                flip: 0.019,
                ..clear
            },
        ];
        assert!(near.iter().all(|near| near.is_limited_by(&noise)));
    }
}
