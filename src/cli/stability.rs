//! `stability`: the matrix of extremes, a line a test.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use serde_json::{Value, json};

use super::args::MAX_THREADS;
use super::error::CliError;
use super::output;
use super::progress::Progress;
use crate::measure::bench::Machine;
use crate::measure::stability::{
    Effort, Finding, Kernel, OffsetRule, Outcome, Plan, run, scan_tests, tests,
};

/// `stability`.
#[derive(Debug, Args)]
pub(super) struct StabilityArgs {
    /// Under a minute on two cores; what happens without --full, too
    #[arg(long, conflicts_with = "full")]
    pub quick: bool,
    /// Rays and pixels by the million: what docs/stability.md quotes
    #[arg(long)]
    pub full: bool,
    /// Only tests whose family and name hold all these words
    #[arg(value_name = "WORD")]
    pub words: Vec<String>,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
    /// Ray-triangle test of the tests that trace rays one by one
    #[arg(long, value_name = "NAME", default_value = Kernel::Watertight.name(), value_parser = kernel_parser())]
    pub kernel: Kernel,
    /// How far from their surface leaving rays start, in the same tests
    #[arg(long, value_name = "NAME", default_value = OffsetRule::Bound.name(), value_parser = rule_parser())]
    pub offset_rule: OffsetRule,
    /// Worker threads; 0 means one per core. No figure depends on it
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=MAX_THREADS))]
    pub threads: u16,
    /// All random rays follow from it
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
}

fn kernel_parser() -> impl TypedValueParser<Value = Kernel> {
    PossibleValuesParser::new(Kernel::ALL.map(Kernel::name))
        .try_map(|name| Kernel::from_name(&name).ok_or("no such kernel"))
}

fn rule_parser() -> impl TypedValueParser<Value = OffsetRule> {
    PossibleValuesParser::new(OffsetRule::ALL.map(OffsetRule::name))
        .try_map(|name| OffsetRule::from_name(&name).ok_or("no such rule"))
}

/// Runs the command; says whether every test kept to its bar.
pub(super) fn run_matrix(args: &StabilityArgs) -> Result<(), CliError> {
    let plan = Plan {
        effort: if args.full {
            Effort::Full
        } else {
            Effort::Quick
        },
        kernel: args.kernel,
        offset_rule: args.offset_rule,
        seed: args.seed,
    };
    let mut all = tests(&plan);
    let models = std::env::var_os("RELIEFSCOPE_MODELS").map(PathBuf::from);
    all.extend(scan_tests(models.as_deref()));
    all.retain(|test| {
        let line = format!("{} {}", test.family, test.name).to_lowercase();
        args.words
            .iter()
            .all(|word| line.contains(&word.to_lowercase()))
    });
    if all.is_empty() {
        return Err(CliError::Arguments("no test has all these words"));
    }
    if !args.json {
        output::answer(&heading(&plan, all.len()))?;
    }
    let progress = Progress::counting(all.len() as u64, "tests");
    let (mut done, mut told) = (0, Ok(()));
    let tell = |outcome: &Outcome| {
        done += 1;
        if !args.json && told.is_ok() {
            told = progress.aside(|| output::answer(&line(outcome)));
        }
        progress.reached(done);
    };
    let outcomes = run(&plan, &all, usize::from(args.threads), tell).map_err(CliError::Threads)?;
    progress.finish();
    told?;
    let short = outcomes.iter().filter(|o| !o.finding.is_good()).count();
    if args.json {
        output::answer_json(&document(&plan, &outcomes))?;
    } else {
        output::answer(&closing(&outcomes, short))?;
    }
    if short > 0 {
        return Err(CliError::FellShort(short));
    }
    Ok(())
}

fn heading(plan: &Plan, tests: usize) -> String {
    let machine = Machine::this();
    format!(
        "{tests} tests, {}, kernel {}, offset rule {}, seed {}; {} cores, {}\n",
        plan.effort.name(),
        plan.kernel.name(),
        plan.offset_rule.name(),
        plan.seed,
        machine.cores,
        machine.level
    )
}

/// One test: what it found against what it may.
fn line(outcome: &Outcome) -> String {
    let Finding {
        cases,
        what,
        figure,
        bar,
        note,
    } = &outcome.finding;
    let verdict = match (outcome.finding.is_good(), bar) {
        (false, _) => "SHORT",
        (true, Some(_)) => "ok",
        (true, None) => "--",
    };
    let bar = bar.map_or_else(|| "none".to_owned(), number);
    let name = format!("{} {}", outcome.family, outcome.name);
    let note = if note.is_empty() {
        String::new()
    } else {
        format!("; {note}")
    };
    format!(
        "{verdict:<5} {name:<58} {:>9} {what}, bar {bar}, of {cases}{note}",
        number(*figure)
    )
}

/// Counts as they are, measures with three figures.
fn number(x: f64) -> String {
    if x == 0.0 || x.fract() == 0.0 && x.abs() < 1e15 {
        format!("{x:.0}")
    } else if (1e-2..1e4).contains(&x.abs()) {
        format!("{x:.3}")
    } else {
        format!("{x:.2e}")
    }
}

fn closing(outcomes: &[Outcome], short: usize) -> String {
    let cases: u64 = outcomes.iter().map(|o| o.finding.cases).sum();
    let tests = outcomes.len();
    format!("\n{tests} tests, {cases} cases, {short} fell short")
}

fn document(plan: &Plan, outcomes: &[Outcome]) -> Value {
    let machine = Machine::this();
    let test = |o: &Outcome| {
        let f = &o.finding;
        json!({
            "family": o.family, "name": o.name, "good": f.is_good(), "cases": f.cases,
            "what": f.what, "figure": f.figure, "bar": f.bar, "note": f.note,
        })
    };
    json!({
        "version": machine.version, "commit": machine.commit, "cores": machine.cores,
        "level": machine.level.to_string(), "effort": plan.effort.name(),
        "kernel": plan.kernel.name(), "offset_rule": plan.offset_rule.name(), "seed": plan.seed,
        "short": outcomes.iter().filter(|o| !o.finding.is_good()).count(),
        "tests": outcomes.iter().map(test).collect::<Vec<_>>(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_read_well() {
        assert_eq!(number(0.0), "0");
        assert_eq!(number(12_345.0), "12345");
        assert_eq!(number(3.25159), "3.252");
        assert_eq!(number(1.5e-7), "1.50e-7");
        assert_eq!(number(f64::NAN), "NaN");
    }

    #[test]
    fn a_line_says_whether_it_fell_short() {
        let outcome = |figure| Outcome {
            family: "accuracy",
            name: "t".to_owned(),
            finding: Finding::worst_of(9, "roundings", figure, Some(16.0)),
        };
        assert!(line(&outcome(2.5)).starts_with("ok "));
        assert!(line(&outcome(20.5)).starts_with("SHORT accuracy t"));
    }
}
