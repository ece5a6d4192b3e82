//! Variables that the alignment programs write: only those that their heads name, and after a RESET at any block no incomplete set that
//! the next program would use.
use std::collections::{BTreeMap, BTreeSet};

use gcode_control::{Control, Limits, Observer, Outcome};
use gcode_gen::package::file_name;
use gcode_inspect::machine::Placement;
use gcode_tests::bench::{Bench, alarm, kept_variables, marks, placement, vacant, value};
use gcode_tests::workspace;

/// The common variables that each file's blocks assign.
#[derive(Default)]
struct Assigned(BTreeMap<String, BTreeSet<u32>>);

impl Observer for Assigned {
    fn before_block(&mut self, control: &mut Control) {
        let Some(block) = control.next_block() else { return };
        let file = control.memory().sources().get(block.source).name.to_string();
        let numbers =
            control.next_assigned_variables().into_iter().filter(|number| (100..1000).contains(number));
        self.0.entry(file).or_default().extend(numbers);
    }

    fn after_block(&mut self, _: &Control) {}
}

/// `#501-#560 #578`, of a head's line.
fn overwrites(text: &str) -> &str {
    let line = text.lines().find_map(|line| line.strip_prefix("(OVERWRITES "));
    line.and_then(|line| line.strip_suffix(')')).unwrap_or_else(|| panic!("{text}"))
}

fn ranges(numbers: &BTreeSet<u32>) -> String {
    let mut named: Vec<String> = Vec::new();
    let mut left = numbers.iter().copied().peekable();
    while let Some(from) = left.next() {
        let mut to = from;
        while let Some(next) = left.next_if_eq(&(to + 1)) {
            to = next;
        }
        named.push(if from == to { format!("#{from}") } else { format!("#{from}-#{to}") });
    }
    if named.is_empty() { "NO COMMON VARIABLE".to_owned() } else { named.join(" ") }
}

#[test]
fn every_head_names_the_common_variables_that_are_overwritten() {
    let bench = Bench::example("alignment", &[]);
    let mut all = Assigned::default();
    let good = Placement::default();
    let tilt = [(583, 0.1), (585, 0.001)];
    let anew = [(578, 0.0)];
    for (main, set) in
        [(8210, &[][..]), (8230, &tilt), (8200, &[]), (8200, &marks()), (8200, &anew), (8220, &[])]
    {
        assert_eq!(alarm(&bench.run_observed(main, &good, set, &mut (), &mut all)), None, "O{main}");
    }
    // As many readings as there may be; they are taken before the fit begins.
    let most = Bench {
        limits: Limits { blocks: 4_000 },
        ..Bench::example("alignment", &["25.0, 11] => 25.0, 100]"])
    };
    most.run_observed(8210, &good, &[], &mut (), &mut all);

    let readme = std::fs::read_to_string(workspace().join("macros/README.md")).unwrap();
    let page = std::fs::read_to_string(workspace().join("docs/methods/alignment.md")).unwrap();
    let macros = [(8200, &[8201, 8202][..]), (8210, &[8211]), (8220, &[8221]), (8230, &[8231])];
    for (main, called) in macros {
        let mut together = all.0.get(&file_name(main)).cloned().unwrap_or_default();
        for one in called {
            let own = all.0.get(&file_name(*one)).unwrap();
            together.extend(own);
            let found = ranges(own);
            assert_eq!(overwrites(&bench.package.program(*one).unwrap().text), found, "O{one}");
            let row = readme.lines().find(|line| line.starts_with(&format!("| O{one} |"))).unwrap();
            for range in found.split(' ').filter(|word| word.starts_with('#')) {
                let range = range.replace('-', "–");
                assert!(row.contains(&range), "macros/README.md doesn't have {range} in the row of O{one}");
            }
        }
        let found = ranges(&together);
        assert_eq!(overwrites(&bench.package.program(main).unwrap().text), found, "O{main}");
        let row = format!("| O{main} | {} |", found.replace('-', "–").replace("NO COMMON VARIABLE", "none"));
        assert!(page.contains(&row), "docs/methods/alignment.md hasn't the row {row}");
    }
}

/// What #500 to #599 hold after every block, each state once.
#[derive(Default)]
struct States(Vec<Vec<(u32, f64)>>);

impl Observer for States {
    fn before_block(&mut self, _: &mut Control) {}

    fn after_block(&mut self, control: &Control) {
        let now: Vec<_> = control.variables().filter(|(number, _)| (500..600).contains(number)).collect();
        if self.0.last() != Some(&now) && !self.0.contains(&now) {
            self.0.push(now);
        }
    }
}

fn of(state: &[(u32, f64)], number: u32) -> Option<f64> {
    state.iter().find(|(one, _)| *one == number).map(|(_, value)| *value)
}

/// Figures by hand: the table stands at 38.5 or at 40, the part tilted by 0.1 is turned back by 38.4 or 39.9; the blocks make 124.23,
/// asin(124.23/200) = 38.400 16, or 128.29 (200·sin 39.9° = 128.289 92), asin(128.29/200) = 39.900 03.
#[test]
fn reset_in_o8230_uses_no_tilt_twice() {
    let bench = Bench::example("alignment", &[]);
    for (stands, expected, new) in [(None, 38.4, 38.400_162), (Some(40.0), 39.9, 39.900_028)] {
        let mut set = vec![(583, 0.1), (585, 0.001)];
        set.extend(stands.map(|angle| (596, angle)));
        let mut states = States::default();
        bench.run_observed(8230, &Placement::default(), &set, &mut (), &mut states);
        let mut met = BTreeSet::new();
        for state in &states.0 {
            let next = bench.run(8230, &Placement::default(), state);
            match alarm(&next) {
                // As if nothing had been.
                None => assert!((value(&next, 586) - expected).abs() < 1e-9, "{state:?}"),
                // The tilt is used up, and the table's angle is the new one.
                Some(3165) => assert!((of(state, 596).unwrap() - new).abs() < 2e-6, "{state:?}"),
                // The angle is unknown.
                Some(number) => assert_eq!(number, 3169, "{state:?}"),
            }
            met.insert(alarm(&next));
        }
        assert_eq!(met, BTreeSet::from([None, Some(3165), Some(3169)]));
    }
}

/// #585 marks #580 to #584 as those of one pass, #595 marks #590 to #594.
#[test]
fn reset_in_o8210_leaves_no_mixture_of_two_parts() {
    let yesterday: Vec<_> = (580..586).chain(590..596).map(|number| (number, 0.25)).collect();
    let mut states = States::default();
    let whole = Bench::example("alignment", &[]).run_observed(
        8210,
        &placement([0.2, 0.0, -0.1], [0.1, 0.0, 0.2]),
        &yesterday,
        &mut (),
        &mut states,
    );
    assert_eq!(alarm(&whole), None);
    assert!(states.0.len() > 30, "every write is another state");
    for first in [580, 590] {
        let results = |state: &[(u32, f64)]| [0, 1, 2, 3, 4, 5].map(|n| of(state, first + n));
        let [before, after] = [results(&yesterday), results(&kept_variables(&whole.control))];
        assert!(before != after && after.iter().all(Option::is_some));
        for state in &states.0 {
            let now = results(state);
            assert!(now[5].is_none() || now == before || now == after, "{now:?}");
        }
    }
    // Nothing of yesterday is left when the first touch begins.
    assert!(states.0.iter().any(|state| results_are_vacant(state)));
}

fn results_are_vacant(state: &[(u32, f64)]) -> bool {
    (580..586).chain(590..596).all(|number| of(state, number).is_none())
}

/// After touched points and after marks the next run uses all of them, touches all anew, or moves nothing and stops with an alarm.
#[test]
fn reset_in_o8200_leaves_no_points_that_are_used_in_part_or_twice() {
    let bench = Bench::example("alignment", &[]);
    let high = placement([0.0, 0.2, 0.0], [0.0; 3]);
    for set in [Vec::new(), marks()] {
        let mut states = States::default();
        let whole = bench.run_observed(8200, &high, &set, &mut (), &mut states);
        assert_eq!(alarm(&whole), None);
        let expected = value(&whole, 574);
        let mut met = BTreeSet::new();
        for state in &states.0 {
            let next = bench.run(8200, &high, state);
            met.insert(alarm(&next));
            match alarm(&next) {
                None => {
                    // Marks that were typed in show 0 here, points that are touched anew 0.2.
                    let touched = next.control.moves() > 0;
                    let expected = if touched { 0.2 } else { expected };
                    assert!((value(&next, 574) - expected).abs() < 0.0006, "{state:?}");
                    assert!(touched || state.iter().filter(|(n, _)| (501..=560).contains(n)).count() == 60);
                }
                Some(number) => {
                    assert!([3068, 3135].contains(&number), "{number}");
                    assert_eq!(next.control.moves(), 0);
                }
            }
        }
        let refused = if set.is_empty() { 3135 } else { 3068 };
        assert_eq!(met, BTreeSet::from([None, Some(refused)]));
        assert!((501..=560).chain([578]).all(|number| vacant(&whole, number)));
    }
}

/// The results of an earlier run are gone from the start, and an unfinished fit leaves none.
#[test]
fn a_run_out_that_is_broken_off_leaves_no_result() {
    let bench = Bench::example("alignment", &[]);
    let yesterday: Vec<_> = (580..586).chain(590..596).map(|number| (number, 0.25)).collect();
    let off = placement([0.2, 0.0, -0.1], [0.1, 0.0, 0.2]);
    let whole = bench.run(8210, &off, &yesterday);
    assert!((580..586).chain(590..596).all(|number| !vacant(&whole, number)));
    // The first pass ends behind half of the blocks; 22 readings of 12 blocks are done after 400 at most, then four rounds of the fit.
    let all = whole.control.blocks();
    for part in [0.05, 0.1, 0.2, 0.3, 0.4, 0.45] {
        let blocks = (all as f64 * part) as u64;
        let run = Bench { limits: Limits { blocks }, ..bench.clone() }.run(8210, &off, &yesterday);
        assert!(matches!(run.outcome, Outcome::Limit), "{:?}", run.outcome);
        assert!((580..586).chain(590..596).all(|number| vacant(&run, number)), "{blocks} of {all}");
    }
    // In the second pass the first one's stand, and none of its own.
    let blocks = (all as f64 * 0.8) as u64;
    let run = Bench { limits: Limits { blocks }, ..bench }.run(8210, &off, &yesterday);
    assert!((580..586).all(|number| vacant(&run, number)));
    assert!((590..596).all(|number| !vacant(&run, number)));
}
