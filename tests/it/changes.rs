//! Laws of `diff`: a program and itself are the same, whatever its numbers, comments and spaces.
use gcode_sim::changes::{Record, Revision, changes};
use gcode_sim::machine::Machine;
use gcode_sim::program::NoLibrary;
use gcode_sim::session::Request;
use proptest::prelude::*;

fn revision(text: &str) -> Revision {
    let request = Request::new("O1.nc", text.as_bytes().to_vec(), Machine::default());
    Revision::of(&request, &mut NoLibrary, None).unwrap()
}

/// A block and what it may look like after a rewrite: `{}` stands for the number of a local.
const BLOCKS: [&str; 12] = [
    "G0 X#{} Y5.",
    "G1 X10. Y#{} F100",
    "G81 X#{} Y0 Z-5. R2. F50",
    "X20.",
    "G80",
    "#{}=#{}+1.5",
    "M00",
    "T2 M6",
    "G2 X5. Y5. R20. F80",
    "G4 P500",
    "G91 G0 Z1.",
    "G90 G54 S500 M3",
];

fn program(blocks: &[usize], local: u32) -> String {
    let lines = blocks.iter().map(|block| BLOCKS[*block].replace("{}", &local.to_string()) + "\n");
    format!("O1\n#{local}=7\n{}M30\n", lines.collect::<String>())
}

/// Sequence numbers, comments and spaces in every block.
fn rewritten(text: &str) -> String {
    let lines = text.lines().enumerate().map(|(n, line)| match n {
        0 => format!("{line}(REWRITTEN)\n"),
        _ => format!("N{} {} (LINE {n})\n", 10 * n, line.replace(' ', "  ")),
    });
    lines.collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn what_a_rewrite_keeps_is_no_change(blocks in prop::collection::vec(0..BLOCKS.len(), 0..24)) {
        let old = revision(&program(&blocks, 1));
        let new = revision(&rewritten(&program(&blocks, 14)));
        let found = changes(&old.record, &new.record, 0.0001);
        prop_assert!(found.is_empty(), "{found:?}");
    }

    /// What is accepted is written to a file and read again: nothing is lost on the way.
    #[test]
    fn a_record_read_again_is_the_same(blocks in prop::collection::vec(0..BLOCKS.len(), 0..24)) {
        let record = revision(&program(&blocks, 1)).record;
        let text = record.to_json().unwrap();
        let again = Record::from_json(&text).unwrap();
        let found = changes(&record, &again, 1e-9);
        prop_assert!(found.is_empty(), "{found:?}");
        prop_assert_eq!(again.to_json().unwrap(), text);
    }

    /// One move more, in a place where nothing else depends on it, is one entry and leaves the others alone.
    #[test]
    fn one_inserted_dwell_is_one_entry(
        blocks in prop::collection::vec(0..BLOCKS.len(), 0..24),
        at in 0..25_usize,
    ) {
        let old = program(&blocks, 1);
        // Behind an alarm nothing is executed.
        prop_assume!(revision(&old).stopped().next().is_none());
        let mut lines: Vec<&str> = old.lines().collect();
        let at = 2 + at.min(blocks.len());
        lines.insert(at, "G4 P123");
        let found = changes(&revision(&old).record, &revision(&(lines.join("\n") + "\n")).record, 0.0001);
        let codes: Vec<_> = found.iter().map(|change| &*change.code).collect();
        prop_assert_eq!(codes, ["dwell"]);
    }
}

/// The programs of the project, each file with other sequence numbers, other locals beyond those that arguments come in, more
/// blanks, and other remarks: nothing changes.
#[test]
fn the_projects_own_macros_rewritten_are_no_change() {
    let less = [("flutes = 16", "flutes = 1"), ("length = 300.0", "length = 20.0")];
    for family in gcode_gen::families::ALL {
        let job = less.iter().fold(family.new_job.to_owned(), |job, (from, to)| job.replace(from, to));
        let package = gcode_gen::families::emit(&gcode_sim::job::Job::parse(&job).unwrap());
        let mut other = package.clone();
        other.programs.iter_mut().for_each(|program| program.text = otherwise(&program.text));
        for main in &package.mains {
            let of = |package: &gcode_gen::package::Package| {
                let machine = Machine::parse(&package.machine).unwrap();
                let text = package.program(*main).unwrap().text.as_bytes().to_vec();
                let request = Request::new(format!("O{main}.nc"), text, machine);
                Revision::of(&request, &mut gcode_gen::check::Programs(package), None).unwrap().record
            };
            let (was, is) = (of(&package), of(&other));
            assert!(1 < was.totals.blocks, "{}: O{main} does nothing", family.name);
            let found = changes(&was, &is, 0.0001);
            assert!(found.is_empty(), "{}: O{main}: {found:#?}", family.name);
        }
    }
}

/// A program's text with N and GOTO counted from elsewhere, #27 to #33 in the opposite order, two blanks for one and a remark
/// in place of each that stands alone. What an operator is shown stays.
fn otherwise(text: &str) -> String {
    let line = |line: &str| {
        if line.starts_with('(') {
            return "(ANOTHER REMARK)".to_owned();
        }
        let (code, remark) = line.find('(').map_or((line, ""), |at| line.split_at(at));
        let code = (27..=33)
            .fold(code.to_owned(), |code, n| code.replace(&format!("#{n}"), &format!("#@{}@", 60 - n)));
        let code = code.replace("#@", "#").replace('@', "").replace(' ', "  ");
        let mut renumbered = String::new();
        let mut rest = code.as_str();
        while let Some(at) = rest.starts_with('N').then_some(1).or(rest.find("GOTO").map(|at| at + 4)) {
            let digits = rest[at..].trim_start().chars().take_while(char::is_ascii_digit).count();
            let skip = rest[at..].len() - rest[at..].trim_start().len();
            let number = &rest[at + skip..at + skip + digits];
            renumbered.push_str(&rest[..at]);
            renumbered.push_str(&number.parse::<u32>().map_or(String::new(), |n| (n + 5000).to_string()));
            rest = &rest[at + skip + digits..];
        }
        format!("{renumbered}{rest}{remark}")
    };
    text.lines().map(|one| line(one) + "\n").collect()
}
