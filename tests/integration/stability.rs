//! The matrix of extremes in its small form: the very tests that `reliefscope stability` runs.

use std::process::{Command, Output};

use reliefscope::measure::stability::{Effort, Kernel, OffsetRule, Outcome, Plan, run, tests};
use serde_json::Value;

const PLAN: Plan = Plan {
    effort: Effort::Smoke,
    kernel: Kernel::Watertight,
    offset_rule: OffsetRule::Bound,
    seed: 1,
};

/// Outcomes of the families that trace rays one by one, whose kernel can be chosen.
fn by_rays(plan: Plan, families: &[&str]) -> Vec<Outcome> {
    let mut list = tests(&plan);
    list.retain(|test| families.contains(&test.family));
    assert!(!list.is_empty());
    run(&plan, &list, 2, |_| {}).expect("threads")
}

fn shortfalls(outcomes: &[Outcome]) -> Vec<&Outcome> {
    outcomes.iter().filter(|o| !o.finding.is_good()).collect()
}

#[test]
fn every_test_keeps_to_its_bar() {
    let outcomes = run(&PLAN, &tests(&PLAN), 2, |_| {}).expect("threads");
    let short = shortfalls(&outcomes);
    assert!(short.is_empty(), "{short:#?}");
}

/// What catches nothing in a textbook kernel would catch nothing in ours.
#[test]
fn textbook_kernels_fall_short() {
    for kernel in [Kernel::MollerTrumbore, Kernel::Report] {
        for family in ["watertight", "borders"] {
            let outcomes = by_rays(Plan { kernel, ..PLAN }, &[family]);
            assert!(
                !shortfalls(&outcomes).is_empty(),
                "{}: {family}",
                kernel.name()
            );
        }
    }
}

/// Woop's test in single precision leaks nothing that these few rays find, but loses digits as the view grazes.
#[test]
fn distances_lose_digits_without_double_precision() {
    let worst = |kernel| {
        let outcomes = by_rays(Plan { kernel, ..PLAN }, &["accuracy"]);
        let grazing = outcomes.iter().find(|o| o.name.starts_with("t, 89"));
        grazing.expect("there is such a test").finding.figure
    };
    let (woop, ours) = (worst(Kernel::Woop), worst(Kernel::Watertight));
    assert!(woop > 20.0 * ours, "{woop} against {ours}");
}

#[test]
fn a_fixed_offset_falls_short() {
    let fixed = Plan {
        offset_rule: OffsetRule::Fixed,
        ..PLAN
    };
    let outcomes = by_rays(fixed, &["contact"]);
    let short = shortfalls(&outcomes);
    let some = |what| short.iter().any(|o| o.finding.what == what);
    assert!(
        some("falsely shadowed") && some("gap in radii"),
        "{short:#?}"
    );
}

#[test]
fn figures_depend_on_the_seed_and_on_nothing_else() {
    let figures = |seed, threads| {
        let plan = Plan { seed, ..PLAN };
        let mut list = tests(&plan);
        list.retain(|test| test.family == "accuracy");
        let outcomes = run(&plan, &list, threads, |_| {}).expect("threads");
        outcomes
            .iter()
            .map(|o| o.finding.figure.to_bits())
            .collect::<Vec<_>>()
    };
    assert_eq!(figures(1, 1), figures(1, 3));
    assert_ne!(figures(1, 1), figures(2, 1));
}

fn program(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_reliefscope"))
        .arg("stability")
        .args(arguments)
        .output()
        .expect("the program starts")
}

#[test]
fn the_command_says_by_its_exit_code_what_happened() {
    let good = program(&["accuracy", "u and v, 0-60", "--json"]);
    assert_eq!(good.status.code(), Some(0));
    let json: Value = serde_json::from_slice(&good.stdout).expect("JSON");
    assert_eq!((&json["short"], &json["seed"]), (&0.into(), &1.into()));
    assert_eq!(json["tests"].as_array().map(Vec::len), Some(1));
    let short = program(&["watertight", "sphere, as it is", "--kernel", "report"]);
    assert_eq!(short.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&short.stdout).contains("SHORT"));
    assert_eq!(program(&["no such test"]).status.code(), Some(2));
    assert_eq!(program(&["--kernel", "none"]).status.code(), Some(2));
}
