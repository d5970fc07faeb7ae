//! What the samples of a picture leave open about its errors.

use serde::{Deserialize, Serialize};

use super::PictureErrors;

/// A figure is known if it is this many times what the halves of its samples differ by.
const CLEAR: f64 = 10.0;

/// Errors below these are told as being below: on the average such pictures differ by less than half a step of 8 bits,
/// which rounds to the same, and look alike.
const LEAST: PictureErrors = PictureErrors {
    linear_rmse: 1.0 / 510.0,
    psnr_db: Some(54.15),
    ssim: 0.99,
    flip: 0.002,
};

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

    /// What errors are at least if they are known: ten times the doubt about each. Decibels count as the root mean square
    /// that they tell of.
    fn bounds(&self, errors: &PictureErrors) -> PictureErrors {
        // Share of the root mean square by which so many decibels more or less change it.
        let share = 10.0_f64.powf(self.psnr_db / 20.0) - 1.0;
        let clear_db = 20.0 * (CLEAR * share).log10();
        PictureErrors {
            linear_rmse: CLEAR * self.linear_rmse,
            psnr_db: errors.psnr_db.map(|db| db - clear_db),
            ssim: 1.0 - CLEAR * self.ssim,
            flip: CLEAR * self.flip,
        }
    }

    /// Whether one of the errors, or what it is told to be below, is less than ten times the doubt about it.
    #[must_use]
    pub fn limits(&self, errors: &PictureErrors) -> bool {
        let told = PictureErrors::worse(*errors, LEAST);
        PictureErrors::worse(told, self.bounds(errors)) != told
    }
}

/// The next multiple of `1 / steps` below, or this if it is one to within rounding.
fn rounded_down(value: f64, steps: f64) -> f64 {
    (value * steps + 1e-6).floor() / steps
}

impl PictureErrors {
    /// Root mean square, decibels, SSIM and FLIP in words. What is less than ten times its doubt, or nearer than anybody
    /// sees, is told as being below that.
    #[must_use]
    pub fn told(&self, doubt: &PictureDoubt) -> [String; 4] {
        let Some(db) = self.psnr_db else {
            return ["0.000", "∞", "1.000", "0.000"].map(str::to_owned);
        };
        // Rounded away from what they bound.
        let bounds = Self::worse(LEAST, doubt.bounds(self));
        let below = |error: f64, bound: f64| {
            if error < bound {
                format!("<{:.3}", -rounded_down(-bound, 1e3))
            } else {
                format!("{error:.3}")
            }
        };
        let db_bound = bounds.psnr_db.unwrap_or(db);
        [
            below(self.linear_rmse, bounds.linear_rmse),
            if db > db_bound {
                format!(">{:.1}", rounded_down(db_bound, 10.0))
            } else {
                format!("{db:.1}")
            },
            if self.ssim > bounds.ssim {
                format!(">{:.2}", rounded_down(bounds.ssim, 100.0))
            } else {
                format!("{:.3}", self.ssim)
            },
            below(self.flip, bounds.flip),
        ]
    }

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
    fn what_is_told_as_below_is_known_by_what_it_is_below() {
        let near = PictureErrors {
            linear_rmse: 0.001,
            psnr_db: Some(60.0),
            ssim: 0.9999,
            flip: 0.001,
        };
        // Of the figures themselves next to nothing is known.
        let known = PictureDoubt {
            linear_rmse: 0.000_19,
            psnr_db: 1.5,
            ssim: 0.000_9,
            flip: 0.000_19,
        };
        assert!(!known.limits(&near));
        let doubts = [
            PictureDoubt {
                linear_rmse: 0.000_2,
                ..known
            },
            // A fifth of the root mean square of 60 dB is a tenth of that of 54.
            PictureDoubt {
                psnr_db: 1.6,
                ..known
            },
            PictureDoubt {
                ssim: 0.001_1,
                ..known
            },
            PictureDoubt {
                flip: 0.000_21,
                ..known
            },
        ];
        assert!(doubts.iter().all(|doubt| doubt.limits(&near)));
        assert_eq!(near.told(&known), ["<0.002", ">54.1", ">0.99", "<0.002"]);
        let exactly = PictureDoubt::default();
        assert_eq!(WHOLE.told(&exactly), ["0.100", "20.0", "0.500", "0.200"]);
        let hardly = PictureDoubt {
            linear_rmse: 0.02,
            // Twice the root mean square.
            psnr_db: 6.0,
            ssim: 0.06,
            flip: 0.03,
        };
        assert_eq!(WHOLE.told(&hardly), ["<0.200", ">0.0", ">0.40", "<0.300"]);
        // Rounded to the nearest, 0.2104 would not be below.
        let beside = PictureDoubt {
            flip: 0.021_04,
            ..exactly
        };
        assert_eq!(WHOLE.told(&beside)[3], "<0.211");
        let same = PictureErrors {
            ssim: 1.0,
            ..PictureErrors::default()
        };
        assert_eq!(same.told(&exactly), ["0.000", "∞", "1.000", "0.000"]);
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
