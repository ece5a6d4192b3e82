//! Properties of `diff`: a program and its rewriting have no change, whatever its numbers, comments and spaces.
use gcode_review::{Record, changes};
use gcode_tests::changes::{find_changes, revision};
use proptest::prelude::*;

/// Blocks of random programs; `{}` stands for the number of a local.
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
    fn a_rewritten_program_has_no_change(blocks in prop::collection::vec(0..BLOCKS.len(), 0..24)) {
        let found = find_changes(&program(&blocks, 1), &rewritten(&program(&blocks, 14)));
        prop_assert!(found.is_empty(), "{found:?}");
    }

    /// An accepted result is written to a file and read again without loss.
    #[test]
    fn a_record_read_again_is_the_same(blocks in prop::collection::vec(0..BLOCKS.len(), 0..24)) {
        let record = revision(&program(&blocks, 1)).record;
        let text = record.to_json().unwrap();
        let again = Record::from_json(&text).unwrap();
        let found = changes(&record, &again, 1e-9);
        prop_assert!(found.is_empty(), "{found:?}");
        prop_assert_eq!(again.to_json().unwrap(), text);
    }

    #[test]
    fn one_inserted_dwell_is_one_entry(
        blocks in prop::collection::vec(0..BLOCKS.len(), 0..24),
        at in 0..25_usize,
    ) {
        let old = program(&blocks, 1);
        // Nothing is executed behind an alarm.
        prop_assume!(revision(&old).stopped().next().is_none());
        let mut lines: Vec<&str> = old.lines().collect();
        let at = 2 + at.min(blocks.len());
        lines.insert(at, "G4 P123");
        let found = find_changes(&old, &(lines.join("\n") + "\n"));
        let codes: Vec<_> = found.iter().map(|change| &*change.code).collect();
        prop_assert_eq!(codes, ["dwell"]);
    }
}
