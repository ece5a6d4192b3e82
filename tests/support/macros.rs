//! Cases of kind `macro`: the programs that a job becomes, run with something edited, set or misplaced.
//!
//! `cases.txt` begins with a sentence on what it is about and with lines that hold for all of its cases. A case is a name and rows;
//! every row with an expectation is a run of its own:
//!
//! ```text
//! job examples/alignment/job.toml
//! run O8230
//! == a sign that is neither 1 nor -1
//! set #583=0.1 #585=0.001
//! U1. =>     -- alarm=MC3164; #586=vacant
//! U1. => U2. -- alarm=MC3164; #586=vacant
//! ```
//!
//! | word | meaning |
//! |---|---|
//! | `job FILE` | the job file, from the folder of the workspace; without it the case's own `job.toml` |
//! | `job: A => B` | the job has B in place of A |
//! | `run O8230` | the main program that is run |
//! | `run G21;G65 P8101 …` | these blocks are run, and M30 behind them |
//! | `A => B` | what is run has B in place of the only A; `;` is the end of a line |
//! | `O8211: A => B` | this program has |
//! | `machine TEXT` | further lines of the machine file |
//! | `part shift 0.2 0 -0.1 tilt 0.1 0 0.2` | the part is shifted (mm) and then tilted about x, y and z (degrees) |
//! | `set #583=0.1 #585=0.001` | variables at the start |
//! | `set marks` | those of [`marks`](crate::bench::marks); `set marks #501-#559` these of them, `set marks + 5 0 0` all moved |
//! | `left by NAME` | #500 to #599 as the last run of that case left them |
//!
//! Words on lines of their own hold for the rows below them; ` & ` stands between the words of a row. Behind `-- ` stands what
//! [`crate::expect`] compares, and `set=kept` if the run leaves the variables as they were set.
use std::collections::BTreeMap;

use gcode_session::Run;

use crate::bench::{Bench, kept_variables, marks, placement};
use crate::expect::{Ran, Recorder};
use crate::{Case, edited, workspace};

/// What a run begins with.
#[derive(Clone, Default)]
struct Setup {
    job: String,
    run: String,
    edits: Vec<(Option<u32>, String)>,
    machine: String,
    shift: [f64; 3],
    tilt: [f64; 3],
    variables: Vec<(u32, f64)>,
}

pub(crate) fn run(case: &Case) {
    let text = case.text("cases.txt");
    let mut entries = text.split("\n== ");
    let head = entries.next().unwrap().lines().skip(1);
    let mut common = Setup { job: case.optional("job.toml").unwrap_or_default(), ..Setup::default() };
    let (mut left, mut benches) = (BTreeMap::new(), BTreeMap::new());
    head.filter(|line| is_row(line)).for_each(|line| common.add(line, &left));
    let mut wrong = String::new();
    for entry in entries {
        let (name, rows) = entry.split_once('\n').unwrap();
        let mut setup = common.clone();
        assert!(rows.contains("-- "), "{}: {name}: no row with an expectation", case.name());
        for row in rows.lines().filter(|line| is_row(line)) {
            let Some((words, expected)) = row.split_once("-- ") else {
                setup.add(row, &left);
                continue;
            };
            let mut row = setup.clone();
            words
                .split(" & ")
                .filter(|word| !word.trim().is_empty())
                .for_each(|word| row.add(word.trim(), &left));
            let ran = row.run(&mut benches);
            let mut expected = expected.trim().to_owned();
            if let Some(others) = expected.strip_suffix("; set=kept") {
                let last: BTreeMap<u32, f64> = row.variables.iter().copied().collect();
                let kept = last.iter().map(|(number, value)| format!("; #{number}={value}"));
                expected = others.to_owned() + &kept.collect::<String>();
            }
            for difference in ran.differences(&expected) {
                wrong.push_str(&format!("{name}: {}: {difference}\n", words.trim()));
            }
            left.insert(name.to_owned(), kept_variables(&ran.control));
        }
    }
    assert!(text.contains("\n== "), "{}: no cases", case.name());
    assert!(wrong.is_empty(), "{}:\n{wrong}", case.name());
}

/// The marks that `#501-#559` names, or all of them moved by `+ X Y Z`.
fn marks_of(words: &str) -> Vec<(u32, f64)> {
    let mut marks = marks();
    if let Some(by) = words.strip_prefix(" + ") {
        let by: Vec<f64> = by.split(' ').map(|value| value.parse().unwrap()).collect();
        marks.iter_mut().for_each(|(number, value)| *value += by[(*number - 501) as usize % 3]);
    } else if let Some((first, last)) = words.split_once('-') {
        let [first, last] =
            [first, last].map(|number| number.trim().trim_start_matches('#').parse().unwrap());
        marks.retain(|(number, _)| (first..=last).contains(number));
    }
    marks
}

fn is_row(line: &str) -> bool {
    !line.trim().is_empty() && !line.starts_with("# ")
}

impl Setup {
    fn add(&mut self, line: &str, left: &BTreeMap<String, Vec<(u32, f64)>>) {
        let (word, rest) = line.split_once(' ').unwrap_or((line, ""));
        let number = word.strip_prefix('O').and_then(|word| word.strip_suffix(':')?.parse().ok());
        match word {
            "job" => self.job = std::fs::read_to_string(workspace().join(rest)).unwrap(),
            "job:" => self.job = edited(&self.job, rest),
            "run" => rest.clone_into(&mut self.run),
            "machine" => self.machine += &format!("\n{}\n", rest.replace(';', "\n")),
            "part" => {
                let mut words = rest.split_whitespace();
                while let Some(word) = words.next() {
                    let values = [0; 3].map(|_| words.next().unwrap().parse().unwrap());
                    *(if word == "shift" { &mut self.shift } else { &mut self.tilt }) = values;
                }
            }
            "set" if rest.starts_with("marks") => self.variables.extend(marks_of(&rest[5..])),
            "set" => self.variables.extend(rest.split_whitespace().map(|one| {
                let (number, value) = one.trim_start_matches('#').split_once('=').unwrap();
                (number.parse::<u32>().unwrap(), value.parse::<f64>().unwrap())
            })),
            "left" => self.variables.extend(&left[rest.strip_prefix("by ").unwrap()]),
            _ => {
                let edit = if number.is_some() { rest } else { line };
                assert!(edit.contains(" =>"), "no word of a case: {line}");
                self.edits.push((number, edit.to_owned()));
            }
        }
    }

    /// Runs the programs of the job, which are emitted once for all rows that share it.
    fn run(&self, benches: &mut BTreeMap<String, Bench>) -> Ran {
        let bench = benches.entry(self.job.clone()).or_insert_with(|| Bench::of(&self.job));
        let bench = bench.clone().with_machine(&self.machine);
        let (main, bench) = match self.run.strip_prefix('O').and_then(|number| number.parse().ok()) {
            Some(number) => (number, bench),
            None => (1, bench.with_main(1, &self.run.replace(';', "\n"))),
        };
        let edits = self.edits.iter();
        let bench = edits.fold(bench, |bench, (number, edit)| bench.edited(number.unwrap_or(main), edit));
        let mut recorder = Recorder::default();
        let part = placement(self.shift, self.tilt);
        let Run { control, outcome, .. } =
            bench.run_observed(main, &part, &self.variables, &mut recorder, &mut ());
        Ran { control, outcome, recorder }
    }
}
