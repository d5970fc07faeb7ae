//! How much is tested and with what; what a test is, and what it found.

use super::{Kernel, OffsetRule, Random};

/// How many rays and pixels each test gets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// A second or two: the form that the test suite runs.
    Smoke,
    /// Under a minute on two cores.
    Quick,
    /// What `docs/stability.md` quotes.
    Full,
}

impl Effort {
    /// One of three, by effort.
    #[must_use]
    pub const fn pick<T: Copy>(self, smoke: T, quick: T, full: T) -> T {
        match self {
            Self::Smoke => smoke,
            Self::Quick => quick,
            Self::Full => full,
        }
    }

    /// Name in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.pick("smoke", "quick", "full")
    }
}

/// What a run depends on, and nothing else.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Plan {
    /// Rays and pixels of each test.
    pub effort: Effort,
    /// The ray–triangle test, where rays are traced one by one. Pictures are always the program's own.
    pub kernel: Kernel,
    /// How far from a surface leaving rays start, where they are traced one by one.
    pub offset_rule: OffsetRule,
    /// All random numbers follow from it.
    pub seed: u64,
}

impl Plan {
    /// Random numbers of one test: different for each name, the same in each run.
    #[must_use]
    pub fn random(&self, name: &str) -> Random {
        let mix = |sum: u64, byte: u8| (sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        Random::new(name.bytes().fold(self.seed ^ 0xcbf2_9ce4_8422_2325, mix))
    }
}

/// What a test found.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Rays, pixels or pictures that were looked at.
    pub cases: u64,
    /// What `figure` counts or measures.
    pub what: &'static str,
    /// The worst there was, or how many; not above [`Self::bar`] in a good program.
    pub figure: f64,
    /// `None` for figures that are only reported.
    pub bar: Option<f64>,
    /// What else is worth telling; often empty.
    pub note: String,
}

impl Finding {
    /// `count` of `cases` were wrong, where none may be.
    #[must_use]
    pub fn none_of(cases: u64, what: &'static str, count: u64) -> Self {
        Self {
            cases,
            what,
            figure: count as f64,
            bar: Some(0.0),
            note: String::new(),
        }
    }

    /// The worst of `cases` against a bar.
    #[must_use]
    pub const fn worst_of(cases: u64, what: &'static str, figure: f64, bar: Option<f64>) -> Self {
        Self {
            cases,
            what,
            figure,
            bar,
            note: String::new(),
        }
    }

    /// The same with a remark.
    #[must_use]
    pub fn with_note(self, note: String) -> Self {
        Self { note, ..self }
    }

    /// Whether the figure keeps to its bar. NaN does not, and neither does a test without cases.
    #[must_use]
    pub fn is_good(&self) -> bool {
        self.cases > 0 && self.bar.is_none_or(|bar| self.figure <= bar)
    }
}

/// What a test does.
type Work = Box<dyn Fn(&Plan) -> Finding + Send + Sync>;

/// One line of the matrix.
pub struct Test {
    /// What it is about.
    pub family: &'static str,
    /// Which place, angle or case.
    pub name: String,
    work: Work,
}

impl Test {
    /// A test from what it does.
    pub fn new(
        family: &'static str,
        name: impl Into<String>,
        work: impl Fn(&Plan) -> Finding + Send + Sync + 'static,
    ) -> Self {
        Self {
            family,
            name: name.into(),
            work: Box::new(work),
        }
    }

    /// Runs it on this thread.
    #[must_use]
    pub fn run(&self, plan: &Plan) -> Finding {
        (self.work)(plan)
    }
}

impl std::fmt::Debug for Test {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.family, self.name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_finding_is_good_up_to_its_bar() {
        let figure = |figure| Finding::worst_of(1, "x", figure, Some(16.0));
        assert!(figure(16.0).is_good() && !figure(16.5).is_good() && !figure(f64::NAN).is_good());
        assert!(Finding::worst_of(1, "x", 1e9, None).is_good());
        assert!(!Finding::none_of(0, "x", 0).is_good(), "nothing was tested");
        assert!(Finding::none_of(1, "x", 0).is_good() && !Finding::none_of(1, "x", 1).is_good());
    }
}
