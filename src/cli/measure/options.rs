//! What was asked of `measure`, after checking.

use std::fmt::Write as _;
use std::path::PathBuf;

use super::MeasureArgs;
use crate::cli::error::CliError;
use crate::cli::options::SceneOptions;
use crate::measure::trade::{Plan, Shard};

/// One of two things.
#[derive(Debug)]
pub(super) enum MeasureOptions {
    /// Measure.
    Sweep(Box<SweepOptions>),
    /// Join what was measured.
    Merge(MergeOptions),
}

/// Measure.
#[derive(Debug)]
pub(super) struct SweepOptions {
    /// The scene, with what is changed about it.
    pub scene: SceneOptions,
    /// What to measure.
    pub plan: Plan,
    /// Which part of it.
    pub shard: Option<Shard>,
    /// Worker threads; 0 means one per core.
    pub threads: usize,
    /// The command that repeats this.
    pub command: String,
    /// Where results go.
    pub output: OutputOptions,
}

/// Join what was measured.
#[derive(Debug)]
pub(super) struct MergeOptions {
    /// Records.
    pub files: Vec<PathBuf>,
    /// Where results go.
    pub output: OutputOptions,
}

/// Where results go.
#[derive(Debug)]
pub(super) struct OutputOptions {
    /// JSON instead of text.
    pub json: bool,
    /// A folder for the report.
    pub report: Option<PathBuf>,
}

impl MeasureArgs {
    /// Makes the report's folder, so that nothing is measured for nothing.
    pub(super) fn check(self) -> Result<MeasureOptions, CliError> {
        if let Some(folder) = &self.report {
            std::fs::create_dir_all(folder).map_err(|source| CliError::NoPlace {
                path: folder.clone(),
                message: format!("cannot make this folder: {source}"),
            })?;
        }
        let command = self.command();
        let plan = self.plan();
        let output = OutputOptions {
            json: self.json,
            report: self.report,
        };
        // The parser wants one of the two.
        let Some(input) = self.input else {
            return Ok(MeasureOptions::Merge(MergeOptions {
                files: self.merge,
                output,
            }));
        };
        Ok(MeasureOptions::Sweep(Box::new(SweepOptions {
            scene: SceneOptions {
                input,
                load: self.load.check(),
                size: None,
                method: None,
                overrides: self.set,
            },
            plan,
            shard: self.shard,
            threads: usize::from(self.threads),
            command,
            output,
        })))
    }

    fn plan(&self) -> Plan {
        let mut plan = if self.quick {
            Plan::quick()
        } else {
            Plan::full()
        };
        let given = |list: &[f64], usual: Vec<f64>| {
            if list.is_empty() {
                return usual;
            }
            let mut list = list.to_vec();
            list.sort_by(f64::total_cmp);
            list.dedup();
            list
        };
        plan.angles_deg = given(&self.angles, plan.angles_deg);
        plan.amplitudes = given(&self.amplitudes, plan.amplitudes);
        if !self.methods.is_empty() {
            plan.methods.retain(|m| self.methods.contains(m));
        }
        plan.rays = self.rays.unwrap_or(plan.rays);
        plan.size = self.size.unwrap_or(plan.size);
        let times_as_many = plan.most_samples / plan.samples;
        plan.samples = self.samples.unwrap_or(plan.samples);
        plan.most_samples = self.most_samples.unwrap_or(times_as_many * plan.samples);
        plan.rounds = self.passes.unwrap_or(plan.rounds);
        plan.seed = self.seed;
        plan
    }

    /// The whole sweep as one would type it again: without shard, output and threads.
    fn command(&self) -> String {
        let mut line = "reliefscope measure".to_owned();
        // Writing to a string cannot fail.
        let mut add = |name: &str, value: Option<String>| {
            let _ = value.map(|value| write!(line, " {name}{}", quoted(&value)));
        };
        let numbers = |list: &[f64]| {
            let texts: Vec<String> = list.iter().map(f64::to_string).collect();
            (!list.is_empty()).then(|| texts.join(","))
        };
        let names: Vec<_> = self.methods.iter().map(|m| m.name()).collect();
        add("", self.input.as_ref().map(|i| i.display().to_string()));
        add("--angles ", numbers(&self.angles));
        add("--amplitudes ", numbers(&self.amplitudes));
        add("--methods ", (!names.is_empty()).then(|| names.join(",")));
        add("--rays ", self.rays.map(|n| n.to_string()));
        add("--size ", self.size.map(|[w, h]| format!("{w}x{h}")));
        add("--samples ", self.samples.map(|n| n.to_string()));
        add("--most-samples ", self.most_samples.map(|n| n.to_string()));
        add("--passes ", self.passes.map(|n| n.to_string()));
        add("--seed ", (self.seed != 1).then(|| self.seed.to_string()));
        for (key, value) in &self.set {
            add("--set ", Some(format!("{key}={value}")));
        }
        add("--quick", self.quick.then(String::new));
        add("--no-normalize", self.load.no_normalize.then(String::new));
        line
    }
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./,:=+".contains(c);
    if word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::quoted;

    #[test]
    fn words_survive_a_shell() {
        assert_eq!(quoted("wall"), "wall");
        assert_eq!(quoted("red brick.obj"), "'red brick.obj'");
        assert_eq!(quoted("it's"), "'it'\\''s'");
        assert_eq!(quoted("$(x)"), "'$(x)'");
    }
}
