//! The tests of a plan on a pool of threads, told in the order of the list.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use super::{Finding, Plan, Test};

/// A test and what it found.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The test's family.
    pub family: &'static str,
    /// The test's name.
    pub name: String,
    /// What it found.
    pub finding: Finding,
}

/// What has been found and what of it has been told.
struct Told<'a, F> {
    found: Vec<Option<Outcome>>,
    next: usize,
    tell: &'a mut F,
}

/// Runs all tests on `threads` threads (0 means one per core). `tell` hears of each in the order of the list;
/// a test that panics falls short of any bar.
///
/// # Errors
/// If the system gives no threads.
pub fn run<F: FnMut(&Outcome) + Send>(
    plan: &Plan,
    tests: &[Test],
    threads: usize,
    mut tell: F,
) -> std::io::Result<Vec<Outcome>> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(|i| format!("stability-{i}"))
        .build()
        .map_err(std::io::Error::other)?;
    let told = Mutex::new(Told {
        found: vec![None; tests.len()],
        next: 0,
        tell: &mut tell,
    });
    let next = AtomicUsize::new(0);
    pool.broadcast(|_| {
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(test) = tests.get(index) else {
                return;
            };
            let outcome = outcome(plan, test);
            let mut told = told.lock().unwrap_or_else(PoisonError::into_inner);
            told.found[index] = Some(outcome);
            told.go_on();
        }
    });
    let told = told.into_inner().unwrap_or_else(PoisonError::into_inner);
    Ok(told.found.into_iter().flatten().collect())
}

impl<F: FnMut(&Outcome)> Told<'_, F> {
    /// Tells what can be told in order.
    fn go_on(&mut self) {
        while let Some(Some(outcome)) = self.found.get(self.next) {
            (self.tell)(outcome);
            self.next += 1;
        }
    }
}

fn outcome(plan: &Plan, test: &Test) -> Outcome {
    // Nothing outlives the closure but its result, so no broken state can be seen.
    let finding = catch_unwind(AssertUnwindSafe(|| test.run(plan)))
        .unwrap_or_else(|panic| Finding::none_of(1, "panics", 1).with_note(message(&*panic)));
    Outcome {
        family: test.family,
        name: test.name.clone(),
        finding,
    }
}

/// What a panic said.
fn message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "a panic without words".to_owned())
}

#[cfg(test)]
mod tests {
    use super::super::{Effort, Kernel, OffsetRule};
    use super::*;

    #[test]
    fn told_in_order_and_a_panic_falls_short() {
        let plan = Plan {
            effort: Effort::Smoke,
            kernel: Kernel::Watertight,
            offset_rule: OffsetRule::Bound,
            seed: 1,
        };
        let test = |i: u64| {
            Test::new("count", i.to_string(), move |_| {
                assert!(i != 7, "seven");
                Finding::none_of(1, "wrong", i % 2)
            })
        };
        let tests: Vec<_> = (0..20).map(test).collect();
        let mut names = Vec::new();
        let all = run(&plan, &tests, 3, |o| names.push(o.name.clone())).expect("threads");
        assert_eq!(names, (0..20).map(|i| i.to_string()).collect::<Vec<_>>());
        assert_eq!(all[7].finding.what, "panics");
        assert_eq!(all[7].finding.note, "seven");
        assert!(all[6].finding.is_good() && !all[7].finding.is_good() && !all[9].finding.is_good());
    }
}
