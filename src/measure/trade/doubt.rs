//! What the samples of a picture leave open about its errors.

use serde::{Deserialize, Serialize};

use super::PictureErrors;

/// A figure is known if it is this many times what the halves of its samples differ by.
const CLEAR: f64 = 10.0;

/// How far the errors that either half of the samples gives are from those that all of them give, at most.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct PictureDoubt {
    /// See [`PictureErrors::linear_rmse`].
    pub linear_rmse: f64,
    /// Decibels; 0 where pictures are equal.
    pub psnr_db: f64,
    /// See [`PictureErrors::ssim`].
    pub ssim: f64,
    /// See [`PictureErrors::flip`].
    pub flip: f64,
}

impl PictureDoubt {
    /// From the errors of all samples and those of the halves.
    #[must_use]
    pub fn of(whole: &PictureErrors, halves: &[PictureErrors; 2]) -> Self {
        let most = |difference: fn(&PictureErrors, &PictureErrors) -> f64| {
            let [a, b] = halves;
            difference(a, whole).abs().max(difference(b, whole).abs())
        };
        Self {
            linear_rmse: most(|a, b| a.linear_rmse - b.linear_rmse),
            psnr_db: most(|a, b| a.psnr_db.zip(b.psnr_db).map_or(0.0, |(a, b)| a - b)),
            ssim: most(|a, b| a.ssim - b.ssim),
            flip: most(|a, b| a.flip - b.flip),
        }
    }

    /// Whether one of the errors is less than ten times the doubt about it. Decibels count as the root mean square that
    /// they tell of.
    #[must_use]
    pub fn limits(&self, errors: &PictureErrors) -> bool {
        let psnr = 10.0_f64.powf(self.psnr_db / 20.0) - 1.0;
        errors.linear_rmse < CLEAR * self.linear_rmse
            || errors.flip < CLEAR * self.flip
            || 1.0 - errors.ssim < CLEAR * self.ssim
            || 1.0 < CLEAR * psnr
    }
}

impl PictureErrors {
    /// The worse of two in each figure.
    #[must_use]
    pub fn worse(a: Self, b: Self) -> Self {
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
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHOLE: PictureErrors = PictureErrors {
        linear_rmse: 0.1,
        psnr_db: Some(20.0),
        ssim: 0.5,
        flip: 0.2,
    };

    #[test]
    fn a_figure_is_known_from_ten_times_its_doubt_on() {
        let known = PictureDoubt {
            linear_rmse: 0.0099,
            psnr_db: 0.82,
            ssim: 0.049,
            flip: 0.0199,
        };
        assert!(!known.limits(&WHOLE));
        let doubts = [
            PictureDoubt {
                linear_rmse: 0.0101,
                ..known
            },
            PictureDoubt {
                psnr_db: 0.84,
                ..known
            },
            PictureDoubt {
                ssim: 0.051,
                ..known
            },
            PictureDoubt {
                flip: 0.0201,
                ..known
            },
        ];
        assert!(doubts.iter().all(|doubt| doubt.limits(&WHOLE)));
        // Of equal pictures nothing is in doubt.
        let equal = PictureErrors {
            ssim: 1.0,
            ..PictureErrors::default()
        };
        assert!(!PictureDoubt::of(&equal, &[equal; 2]).limits(&equal));
    }

    #[test]
    fn the_half_that_differs_more_counts() {
        let half = |by: f64| PictureErrors {
            linear_rmse: 0.1 + by,
            psnr_db: Some(20.0 - by),
            ssim: 0.5 - by,
            flip: 0.2 + by,
        };
        let doubt = PictureDoubt::of(&WHOLE, &[half(0.25), half(-0.125)]);
        let figures = [doubt.linear_rmse, doubt.psnr_db, doubt.ssim, doubt.flip];
        assert!(
            figures.iter().all(|f| (f - 0.25).abs() < 1e-12),
            "{doubt:?}"
        );
    }
}
