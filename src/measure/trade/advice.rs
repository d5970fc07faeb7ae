//! The answer to the real question: which method is cheap and good enough here.

use super::{Record, Variant};

/// Texels that a method may be off for 95 % of the rays.
const TEXEL: f64 = 1.0;
/// Mean FLIP up to which a picture passes for the truth.
const LOOKS_ALIKE: f64 = 0.05;
/// Views up to this angle are all views that matter, degrees.
const ALL_VIEWS_DEG: f64 = 75.0;

/// One variant in one view, as far as advice needs to know it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// Method and parameters.
    pub variant: Variant,
    /// Angle of the view, degrees.
    pub angle_deg: f64,
    /// 95 % of the rays are not farther off, texels.
    pub p95_texels: f64,
    /// Mean FLIP, where pictures were compared.
    pub flip: Option<f64>,
    /// Time of a sample, ns.
    pub ns: f64,
}

/// What a user wants to know.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Question {
    /// Right to a texel from one angle, degrees.
    Here(f64),
    /// Right to a texel from all angles up to this.
    UpTo(f64),
    /// Looks like the truth from one angle.
    Looks(f64),
}

/// A question with its answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Advice {
    /// What was asked.
    pub question: Question,
    /// The cheapest variant that is good enough; `None` if none of the measured is.
    pub variant: Option<Variant>,
    /// Both in one line.
    pub line: String,
}

/// Answers the three questions for the view nearest to `here_deg`, from the material's own amplitude and bits.
#[must_use]
pub fn advise(measured: &[Measured], here_deg: f64) -> Vec<Advice> {
    let distance = |m: &&Measured| (m.angle_deg - here_deg).abs();
    let nearest = measured
        .iter()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)));
    let Some(here) = nearest.map(|m| m.angle_deg) else {
        return Vec::new();
    };
    let farthest = measured
        .iter()
        .map(|m| m.angle_deg)
        .filter(|&a| a <= ALL_VIEWS_DEG)
        .fold(here.min(ALL_VIEWS_DEG), f64::max);
    let mut questions = vec![Question::Here(here)];
    let angles = measured.iter().filter(|m| m.angle_deg <= farthest);
    if angles.clone().any(|m| m.angle_deg != here) {
        questions.push(Question::UpTo(farthest));
    }
    if measured.iter().any(|m| m.flip.is_some()) {
        questions.push(Question::Looks(here));
    }
    questions.into_iter().map(|q| answer(measured, q)).collect()
}

/// Error and cost of a variant as a question sees them.
struct Rated {
    variant: Variant,
    error: f64,
    ns: f64,
}

fn answer(measured: &[Measured], question: Question) -> Advice {
    let rated = rated(measured, question);
    let limit = match question {
        Question::Looks(_) => LOOKS_ALIKE,
        Question::Here(_) | Question::UpTo(_) => TEXEL,
    };
    let enough = rated.iter().filter(|r| r.error <= limit);
    let cheapest = enough.min_by(|a, b| a.ns.total_cmp(&b.ns));
    let best = rated.iter().min_by(|a, b| a.error.total_cmp(&b.error));
    let unit = match question {
        Question::Looks(_) => "FLIP",
        Question::Here(_) | Question::UpTo(_) => "texels",
    };
    let told = |r: &Rated| {
        format!(
            "{} ({} {unit}, {:.0} ns a sample)",
            r.variant.label(),
            super::short(r.error),
            r.ns
        )
    };
    let found = match (cheapest, best) {
        (Some(cheapest), _) => told(cheapest),
        (None, Some(best)) => format!("none of the measured; nearest is {}", told(best)),
        (None, None) => "nothing was measured".to_owned(),
    };
    Advice {
        question,
        variant: cheapest.map(|r| r.variant),
        line: format!("{}: {found}", question.text()),
    }
}

impl Question {
    /// In words.
    #[must_use]
    pub fn text(self) -> String {
        match self {
            Self::Here(a) => format!("cheapest method with p95 ≤ 1 texel from this view ({a:.0}°)"),
            Self::UpTo(a) => format!("cheapest for all views up to {a:.0}°"),
            Self::Looks(a) => {
                format!("to look like the truth from {a:.0}° at FLIP ≤ {LOOKS_ALIKE}")
            }
        }
    }
}

/// Every variant once, with its worst error over the views in question.
fn rated(measured: &[Measured], question: Question) -> Vec<Rated> {
    let concerns = |m: &&Measured| match question {
        Question::Here(a) => m.angle_deg == a && !m.variant.is_bare(),
        Question::Looks(a) => m.angle_deg == a,
        Question::UpTo(a) => m.angle_deg <= a && !m.variant.is_bare(),
    };
    let mut rated: Vec<Rated> = Vec::new();
    for m in measured.iter().filter(concerns) {
        let error = match question {
            Question::Looks(_) => m.flip.unwrap_or(f64::INFINITY),
            Question::Here(_) | Question::UpTo(_) => m.p95_texels,
        };
        match rated.iter_mut().find(|r| r.variant == m.variant) {
            Some(known) => {
                known.error = known.error.max(error);
                known.ns = known.ns.max(m.ns);
            }
            None => rated.push(Rated {
                variant: m.variant,
                error,
                ns: m.ns,
            }),
        }
    }
    rated
}

impl Record {
    /// What advice is taken from: the amplitude nearest to the material's own, and all bits of its map.
    #[must_use]
    pub fn measured(&self) -> Vec<Measured> {
        let usual = self.usual_amplitude();
        let bits = self.subject.map_bits;
        let cells = self.cells.iter();
        cells
            .filter(|c| c.amplitude == usual && c.bits == bits)
            .map(|c| Measured {
                variant: c.variant,
                angle_deg: c.angle_deg,
                p95_texels: c.geometry.uv_texels.p95,
                flip: Some(c.picture.flip),
                ns: c.cost.ns_per_sample.median,
            })
            .collect()
    }

    /// The measured factor on the amplitude that is nearest to 1.
    #[must_use]
    pub fn usual_amplitude(&self) -> f64 {
        let factors = self.plan.amplitudes.iter().copied();
        let distance = |f: &f64| f.ln().abs();
        factors
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .unwrap_or(1.0)
    }

    /// The three answers for the scene's own view.
    #[must_use]
    pub fn advice(&self) -> Vec<Advice> {
        advise(&self.measured(), self.subject.own_angle_deg)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::mapping::Method;

    fn measured(method: Method, angle_deg: f64, p95_texels: f64, flip: f64, ns: f64) -> Measured {
        Measured {
            variant: Variant {
                method,
                steps: None,
                self_shadow: method.searches(),
            },
            angle_deg,
            p95_texels,
            flip: Some(flip),
            ns,
        }
    }

    fn table() -> Vec<Measured> {
        vec![
            measured(Method::Parallax, 30.0, 0.8, 0.2, 10.0),
            measured(Method::Relief, 30.0, 0.5, 0.04, 50.0),
            measured(Method::Exact, 30.0, 0.0, 0.0, 80.0),
            measured(Method::Parallax, 70.0, 9.0, 0.5, 10.0),
            measured(Method::Relief, 70.0, 0.9, 0.06, 60.0),
            measured(Method::Exact, 70.0, 0.0, 0.0, 90.0),
        ]
    }

    #[test]
    fn the_cheapest_that_is_good_enough() {
        let advice = advise(&table(), 33.0);
        let chosen: Vec<_> = advice.iter().map(|a| a.variant.map(|v| v.method)).collect();
        let expected = [Method::Parallax, Method::Relief, Method::Relief];
        assert_eq!(chosen, expected.map(Some));
        assert_eq!(advice[1].question, Question::UpTo(70.0));
        assert!(advice[0].line.contains("30°") && advice[0].line.contains("10 ns"));
        let far = advise(&table(), 80.0);
        let chosen: Vec<_> = far.iter().map(|a| a.variant.map(|v| v.method)).collect();
        let expected = [Method::Relief, Method::Relief, Method::Exact];
        assert_eq!(chosen, expected.map(Some));
    }

    #[test]
    fn where_nothing_is_good_enough_the_nearest_is_named() {
        let only = [measured(Method::Bump, 60.0, 12.0, 0.4, 5.0)];
        let advice = advise(&only, 60.0);
        assert_eq!(advice.len(), 2, "one angle is not a range of views");
        assert!(advice.iter().all(|a| a.variant.is_none()));
        assert!(
            advice[0].line.contains("nearest is bump"),
            "{}",
            advice[0].line
        );
        assert!(advise(&[], 10.0).is_empty());
    }

    #[test]
    fn missing_shadows_count_only_where_looks_do() {
        let mut table = table();
        table.push(Measured {
            variant: Variant {
                method: Method::Exact,
                steps: None,
                self_shadow: false,
            },
            ..measured(Method::Exact, 30.0, 0.0, 0.03, 5.0)
        });
        let advice = advise(&table, 30.0);
        assert_eq!(advice[0].variant.map(|v| v.method), Some(Method::Parallax));
        assert!(advice[2].variant.is_some_and(|v| v.is_bare()));
    }
}
