//! The error budget compared with `verify` on the emitted program and with a machine that has the errors.
use std::num::NonZeroUsize;
use std::sync::atomic::AtomicUsize;

use gcode_gen::check::check;
use gcode_gen::families;
use gcode_inspect::budget::{Budget, BudgetRequest, budget};
use gcode_inspect::machine::{Machine, error_file};
use gcode_part::NominalPart;
use gcode_part::job::Job;
use gcode_tests::workspace;

fn example(name: &str) -> String {
    std::fs::read_to_string(workspace().join("examples").join(name)).unwrap()
}

fn found(job: &Job, errors: &str, samples: usize) -> Budget {
    let machine = Machine::from_job(job).unwrap();
    let reference = NominalPart::from_job(job).unwrap().into_holes().unwrap();
    let question = BudgetRequest {
        machine: &machine,
        holes: &reference.holes,
        clearance: job.clearance(),
        sources: &error_file(errors, &machine).unwrap(),
        samples,
        seed: 1,
        threads: NonZeroUsize::new(2).unwrap(),
        tolerance: 0.1,
    };
    budget(&question, &AtomicUsize::new(0)).unwrap()
}

/// Pairs the holes of two results, which must have the same number of them, and some.
fn pairs<'a, A, B>(one: &'a [A], other: &'a [B]) -> impl Iterator<Item = (&'a A, &'a B)> {
    assert!(!one.is_empty() && one.len() == other.len(), "{} and {} holes", one.len(), other.len());
    one.iter().zip(other)
}

/// A machine without errors drills what `verify` finds of the emitted program: rounding is in both.
#[test]
fn without_errors_the_budget_agrees_with_verify() {
    for name in ["melon-mould/job.toml", "prolate/job.toml", "head-by-axis/job.toml"] {
        let job = Job::parse(&example(name)).unwrap();
        let package = families::emit(&job);
        assert_eq!(Machine::from_job(&job).unwrap(), Machine::parse(&package.machine).unwrap(), "{name}");
        let verdict = check(&job, &package).unwrap().verdict.into_holes().unwrap();
        for (hole, judged) in pairs(&found(&job, "", 1).holes, &verdict.holes) {
            assert_eq!(hole.id, judged.id);
            assert!(
                (hole.nominal - judged.position_deviation).abs() < 1e-3,
                "{name}: {hole:?} and {}",
                judged.position_deviation
            );
            assert_eq!(hole.nominal, hole.statistics.max);
        }
    }
}

/// A fixed error in the budget is the same one in a machine file, but for rounding: the program sets the head to a whole increment,
/// and an axis may then be rounded the other way, which is Φ0.002.
#[test]
fn a_fixed_error_displaces_holes_as_on_a_machine_with_that_error() {
    let job = Job::parse(&example("melon-mould/job.toml")).unwrap();
    for (errors, least) in [
        (
            "[linear]\nx = { fixed = 0.02 }\n[rotary]\nindex = { fixed = 0.003 }\ncentre.z = { fixed = -0.03 }\n",
            0.03,
        ),
        ("[rotary]\ntilt.z = { fixed = 0.004 }\ntilt.x = { fixed = -0.003 }\n", 0.01),
        // 15 mm deep: 2·15·tan 0.1° = 0.0524 at the mouth.
        ("[head]\nangle = { fixed = 0.1 }\n", 0.05),
    ] {
        let mut package = families::emit(&job);
        let sections = errors.replace('[', "[errors.");
        package.machine = format!("{}\n{sections}", package.machine);
        let verdict = check(&job, &package).unwrap().verdict.into_holes().unwrap();
        let found = found(&job, errors, 1);
        assert!(found.parts.max > least, "{errors}: {found:?}");
        for (hole, judged) in pairs(&found.holes, &verdict.holes) {
            assert!(
                (hole.statistics.max - judged.position_deviation).abs() < 2e-3,
                "{errors}: {hole:?} and {}",
                judged.position_deviation
            );
        }
    }
}

/// Both example files are read, and the second set-up is the better one at every hole.
#[test]
fn after_alignment_every_hole_is_better_than_before() {
    let job = Job::parse(&example("melon-mould/job.toml")).unwrap();
    let [before, after] =
        ["before", "after"].map(|name| found(&job, &example(&format!("error-budget/{name}.toml")), 2000));
    for (before, after) in pairs(&before.holes, &after.holes) {
        assert!(4.0 * after.statistics.mean < before.statistics.mean);
    }
    assert!(0.9 < after.parts.share_in_tolerance && before.parts.share_in_tolerance < 0.2);
}
