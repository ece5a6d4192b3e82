//! Laws of `diff`: a program and itself are the same, whatever its numbers, comments and spaces.
use gcode_review::{Record, changes};
use gcode_tests::changes::{effects, find_changes, messages, revision};
use proptest::prelude::*;

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
        let found = find_changes(&program(&blocks, 1), &rewritten(&program(&blocks, 14)));
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
        let found = find_changes(&old, &(lines.join("\n") + "\n"));
        let codes: Vec<_> = found.iter().map(|change| &*change.code).collect();
        prop_assert_eq!(codes, ["dwell"]);
    }
}

/// Two tools on two holes, a contour beside the part; all offsets are 0 and unknown to the run.
const PART: &str = "O1\nG90 G54\nT1 M6\nG43 H1 G0 Z50. M8\nG98 G81 X10. Y0 Z-1. R2. F100\nX20.\nG80\nT2 M6\n\
    G43 H2 G0 Z50.\nG98 G81 X10. Y0 Z-9. R2. F80\nX20.\nG80\nG0 X0 Y30. M1\nG41 D1 G1 Y40. F200\nX50.\nG40 Y30.\nM30\n";

/// `PART` with one thing written otherwise.
fn changed(from: &str, to: &str) -> Vec<String> {
    assert_eq!(PART.matches(from).count(), 1, "{from}");
    messages(PART, &PART.replace(from, to))
}

#[test]
fn what_is_called_by_number_counts_where_the_tables_hold_the_same() {
    assert_eq!(messages(PART, PART), Vec::<String>::new());
    let found = changed("G43 H2", "G43 H3");
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].starts_with("tool-length: G43 H3 instead of G43 H2, both 0 here ("), "{found:?}");
    for (from, to, what) in [
        ("G41 D1", "G42 D1", "cutter-side: G42 D1 instead of G41 D1 ("),
        ("G41 D1", "G41 D2", "cutter-side: G41 D2 instead of G41 D1 ("),
        ("G41 D1 ", "", "cutter-side: G40 instead of G41 D1 ("),
        ("G0 X0 Y30.", "G55 G0 X0 Y30.", "work-system: G55 instead of G54 ("),
        ("G41 D1 G1", "G61 G41 D1 G1", "path-mode: G61 instead of G64 ("),
    ] {
        assert_eq!(PART.matches(from).count(), 1, "{from}");
        let found = effects(PART, &PART.replace(from, to));
        assert_eq!(found.len(), 1, "{from} -> {to}: {found:?}");
        assert!(found[0].starts_with(what), "{from} -> {to}: {found:?}");
        let stays = matches!(to, "G55 G0 X0 Y30." | "G61 G41 D1 G1");
        assert_eq!(found[0].contains(" | mode: the program ends in "), stays, "{found:?}");
    }
}

#[test]
fn mist_is_no_coolant() {
    assert_eq!(changed("M8", "M7"), ["coolant: M07 instead of M08"]);
}

#[test]
fn a_lost_spot_drilling_is_told_at_its_hole() {
    let found = changed("Z-1. R2. F100\nX20.\n", "Z-1. R2. F100\n");
    assert_eq!(found, ["hole-tool: hole 2: no longer made by T1, in total by T2"]);
}

#[test]
fn a_stop_that_comes_later_is_one_entry() {
    let old = "O1\nG0 X1.\nM00\nG0 Y5.\nM30\n";
    let new = "O1\nG0 X1.\nG0 Y5.\nM00\nM30\n";
    assert_eq!(messages(old, new), ["stop: the stop M00 is executed later than before"]);
    assert_eq!(messages(new, old), ["stop: the stop M00 is executed earlier than before"]);
}

#[test]
fn behind_an_alarm_nothing_is_compared() {
    let stops = PART.replace("T2 M6\n", "T2 M6\n#3000=1(NO TOOL)\n");
    let found = messages(PART, &stops);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].starts_with("outcome: "), "{found:?}");
}

#[test]
fn a_block_skip_and_codes_that_move_nothing_here_are_one_entry_each() {
    for (from, to, told) in [
        ("G0 X0 Y30. M1", "/G0 X0 Y30. M1", "block-skip: the block skip / is added"),
        ("G0 X0 Y30. M1", "/3 G0 X0 Y30. M1", "block-skip: the block skip /3 is added"),
        ("G0 X0 Y30. M1", "G0 X0 /2 Y30. M1", "block-skip: the block skip /2 is added"),
        ("X50.\nG40", "G9 X50.\nG40", "path-mode: G09 is added"),
        ("T1 M6", "G5.1 Q1\nT1 M6", "path-mode: G05.1 Q1 is added"),
        ("T1 M6", "G8 P1\nT1 M6", "path-mode: G08 P1 is added"),
        ("T1 M6", "G25\nT1 M6", "g-code: G25 is added"),
        ("T1 M6", "M29 S500\nT1 M6", "m-code: M29 is added"),
    ] {
        assert_eq!(changed(from, to), [told], "{to}");
        let gone = PART.replace(from, to);
        assert_eq!(
            self::messages(&gone, PART),
            [told.replace(" is added", " is removed")],
            "{to} taken away"
        );
    }
    let (off, on) = (PART.replace("T1 M6", "G5.1 Q0\nT1 M6"), PART.replace("T1 M6", "G5.1 Q1\nT1 M6"));
    assert_eq!(messages(&off, &on), ["path-mode: G05.1 Q1 instead of G05.1 Q0"]);
}

/// Also in front of what makes no step: an assignment, a jump, a call.
#[test]
fn a_block_skip_before_a_statement_is_told_at_its_block() {
    let old = "O1\n#100=5.\nG0 X#100\nIF[#100 GT 9.]GOTO 9\nM98 P2\nN9 M30\nO2\nG0 Y1.\nM99\n";
    for block in ["#100=5.", "IF[#100", "M98 P2"] {
        let new = old.replace(block, &format!("/{block}"));
        let found = find_changes(old, &new);
        let codes: Vec<_> = found.iter().map(|change| &*change.code).collect();
        assert_eq!(codes, ["block-skip"], "{block}");
        let place = found[0].new.as_ref().unwrap();
        assert!(place.block.starts_with(&format!("/{block}")) && place.calls.is_empty(), "{place:?}");
    }
}

/// The block that wrote it last, and the call that led there.
#[test]
fn what_is_left_names_the_block_that_wrote_it() {
    let old = "O1\n#500=1.\nG65 P2 A2.\nM30\nO2\n#501=#1\n#502=7.\nG10 L2 P1 X#1\n#2005=#1\nM99\n";
    let new = old.replace("A2.", "A3.");
    let found = find_changes(old, &new);
    let shown: Vec<String> = found
        .iter()
        .flat_map(|change| {
            std::iter::once((&change.message, &change.new))
                .chain(change.also.iter().map(|one| (&one.message, &one.new)))
        })
        .map(|(message, place)| {
            let place = place.as_ref().unwrap();
            format!("{message} by {}, from {}", place.block, place.calls[0].block)
        })
        .collect();
    assert_eq!(found.len(), 1, "{found:#?}");
    assert_eq!(
        shown,
        [
            "G54 X ends as 3 instead of 2 by G10 L2 P1 X#1, from G65 P2 A3.",
            "H5 wear ends as 3 instead of 2 by #2005=#1, from G65 P2 A3.",
            "#501 ends as 3 instead of 2 by #501=#1, from G65 P2 A3.",
        ]
    );
}

/// T1 drills both holes, T2 one, and then T1 comes once more with G81 as the first time.
#[test]
fn a_hole_that_a_tool_makes_once_more_is_one_entry() {
    let again = "T1 M6\nG43 H1 G0 Z50.\nG98 G81 X10. Y0 Z-1. R2. F100\nG80\n";
    let found = changed("T2 M6", &format!("{again}T2 M6"));
    assert_eq!(found, ["hole-tool: hole 1: one more pass by T1, in total by T1 (2 times) and T2"]);
}

#[test]
fn a_swapped_tool_is_one_entry_for_all_its_holes() {
    // T2 drills what T1 has drilled, and one hole alone: in all of them T3 stands for T2.
    let more = PART.replace("Z-9. R2. F80\nX20.\n", "Z-9. R2. F80\nX20.\nX30.\n");
    assert_eq!(
        messages(&more, &more.replace("T2 M6", "T3 M6")),
        ["hole-tool: holes 1, 2, 3: made by T3 instead of T2"]
    );
    // T1 twice: T2 isn't there any more.
    assert_eq!(
        messages(&more, &more.replace("T2 M6", "T1 M6")),
        ["hole-tool: holes 1, 2, 3: made by T1 instead of T2"]
    );
}

/// Behind the first cycle the next block goes to Z50 anyway. Behind the second one, R2, 48 mm below the initial level, is
/// where the contour is milled: that has to be seen, and that G99 stays for the next program.
#[test]
fn the_return_level_alone_is_one_entry() {
    let found = changed("G98 G81 X10. Y0 Z-1.", "G99 G81 X10. Y0 Z-1.");
    assert_eq!(found.len(), 1, "{found:#?}");
    assert!(found[0].starts_with("return-level: G99 instead of G98: "), "{found:#?}");

    let found = effects(PART, &PART.replace("G98 G81 X10. Y0 Z-9.", "G99 G81 X10. Y0 Z-9."));
    assert_eq!(
        found,
        [
            "return-level: G99 instead of G98: the rapids between holes run at the R level (7 moves) | move-shifted: \
          moves end at a different point: Z -48.0000 (3 rapids, 3 feeds) | move-lost: a rapid to X20.0000 is removed | \
          mode: the program ends in G99 instead of G98"
        ]
    );
}

/// A move elsewhere by the same in rapids, feeds and arcs is one entry at the first of them.
#[test]
fn one_shifted_word_is_one_entry() {
    let old = "O1\nG90 G54 G0 X0 Y0\nZ5.\nG1 Z-1. F100\nG1 X20.\nG2 X30. I5. J0\nG1 Y9.\nG0 Z5.\nM30\n";
    // The rapid to X0 wasn't needed before.
    assert_eq!(
        effects(old, &old.replace("G0 X0 Y0", "G0 X0.01 Y0")),
        [
            "move-shifted: moves end at a different point: X +0.0100 (a rapid, a feed) | move-added: a rapid to X0.0100 is \
          added"
        ]
    );
    let of_arc = effects(old, &old.replace("X30. I5.", "X30.02 I5.01"));
    // Its radius is another too, which where it ends doesn't say.
    let shape = "an arc of radius 5.0100 sweeps -180.000° about 25.0100 0.0000 instead of one of 5.0000 -180.000° about 25.0000 0.0000";
    let shifted = "move-shifted: moves end at a different point: X +0.0200 (an arc, a feed, a rapid)";
    assert_eq!(of_arc, [format!("move-arc: {shape} | {shifted}")]);
}

/// In G93 a way that is longer takes the same time.
#[test]
fn a_longer_way_in_inverse_time_has_no_other_feed() {
    let old = "O1\nG90 G93\nG1 X10. F10.\nX20. F10.\nX30. F20.\nG94\nM30\n";
    let longer = messages(old, &old.replace("X20.", "X20.01"));
    assert_eq!(longer, ["move-shifted: a feed ends at a different point: X +0.0100"]);
    // F10 over 10 mm is 100 mm/min, F12 is 120.
    let faster = messages(old, &old.replace("X20. F10.", "X20. F12."));
    assert_eq!(faster, ["feed: feed F120 instead of F100"]);
    // One block makes ways of 1, 2 and 3 mm in a tenth of a minute each, then in an eighth.
    let all = "O1\nG91 G93\n#1=1\nWHILE[#1 LE 3]DO1\nG1 X#1 F10.\n#1=#1+1\nEND1\nG94\nM30\n";
    assert_eq!(
        messages(all, &all.replace("F10.", "F8.")),
        ["feed: feed F8 instead of F10 (3 moves, all by the same factor)"]
    );
}

/// What the machine's own codes may take up: the run makes nothing of it.
#[test]
fn a_tool_called_and_a_speed_that_nothing_takes_up_are_one_entry() {
    // T3 waits in the magazine when the program ends; S800 is for M41, a builder's code.
    let old = "O1\nT1 M6\nT2\nS500 M3\nG0 X1.\nM6\nM5\nT3\nS800\nM41\nG0 X2.\nM30\n";
    for (from, to, entry) in [
        ("T3", "T4", "tool: T4 without M06 instead of T3 without M06"),
        ("T3\n", "", "tool: T3 without M06 is removed"),
        ("S800", "S900", "spindle: S900 without M03 or M04 instead of S800 without M03 or M04"),
        // Fetched early or late, the same tool is put in.
        ("T2\n", "", "tool: tool T1 instead of tool T2"),
    ] {
        assert_eq!(messages(old, &old.replace(from, to)), [entry], "{from} -> {to}");
    }
    assert_eq!(messages(old, &old.replace("T2\nS500 M3\n", "S500 M3\nT2\n")), Vec::<String>::new());
    assert_eq!(messages(old, &old.replace("S500 M3", "S500\nM3")), Vec::<String>::new());
}

#[test]
fn a_switch_of_the_control_is_one_entry() {
    let old = "O1\n#3003=1\n#3004=7\nG0 X1.\n#3004=0\n#3003=0\nM30\n";
    assert_eq!(messages(old, &old.replace("#3003=1", "#3003=3")), ["switch: #3003=3 instead of #3003=1"]);
    for lost in ["#3003=0", "#3004=7"] {
        assert_eq!(
            messages(old, &old.replace(&format!("{lost}\n"), "")),
            [format!("switch: {lost} is removed")]
        );
    }
}

/// The block that ends a run, and for one without an end the block that goes back.
#[test]
fn another_end_is_one_entry_that_names_its_block() {
    let old = "O1\nG0 X1.\nM30\n";
    let shown = |new: &str| -> Vec<String> {
        let found = find_changes(old, new);
        let line = |place: &Option<gcode_review::BlockLocation>| place.as_ref().map(|place| place.line);
        let each = found.iter();
        each.map(|c| format!("{} {:?} {:?}: {}", c.code, line(&c.old), line(&c.new), c.message)).collect()
    };
    let ends = "the program ends";
    assert_eq!(
        shown("O1\nG0 X1.\nM02\n"),
        [format!("outcome Some(3) Some(3): {ends} by M02; before: {ends}")]
    );
    assert_eq!(
        shown("O1\nG0 X1.\n"),
        [format!("outcome Some(3) Some(2): {ends} where its text does, without M30; before: {ends}")]
    );
    let endless = "the program doesn't end within the limits";
    assert_eq!(shown("O1\nG0 X1.\n\nM99\n"), [format!("outcome Some(3) Some(4): {endless}; before: {ends}")]);
    let found = shown("O1\nG0 X2.\nM02\n");
    assert_eq!(found.len(), 2, "another end hides no move: {found:?}");
}

/// One hole of G83 with pecks of 3 mm; contours with compensation and with an arc by its radius.
const PECKS: &str = "O1\nG90 G54 G0 X10. Y10. Z50.\nG83 Z-10. R2. Q3. F75.\nG80\nG0 Z50.\nM30\n";

#[test]
fn a_peck_more_is_told_by_the_depth() {
    assert_eq!(messages(PECKS, &PECKS.replace("Z-10.", "Z-10.01")), ["hole-depth: hole 1: 0.0100 mm deeper"]);
}

#[test]
fn a_rapid_where_a_feed_made_a_hole_is_told_as_that() {
    let found = messages(PECKS, &PECKS.replace("G83 Z-10. R2. Q3.", "G81 Z-10. R-10."));
    assert!(
        found[0].starts_with(
            "hole-lost: hole 1: a rapid instead of a feed goes to the bottom, at 10.000 10.000 "
        ),
        "{found:?}"
    );
}

/// Compensation holds each move back until it knows the next one; D is in force in the block that has it.
#[test]
fn moves_are_made_under_what_is_in_force_in_their_own_block() {
    let old = "O1\nG90 G54 G0 X0 Y0\nG1 G41 D1 X20. F100\nY20.\nG40 X0\nM30\n";
    let found = messages(old, &old.replace("D1", "D2"));
    assert_eq!(found, ["cutter-side: G41 D2 instead of G41 D1 (2 moves)"]);
    assert_eq!(messages(old, &old.replace(" D1", "")), ["cutter-side: G41 D0 instead of G41 D1 (2 moves)"]);
}

/// R of an arc says how far the centre is from both its ends.
#[test]
fn the_arc_behind_a_shifted_end_is_no_other_arc() {
    let old = "O1\nG90 G54 G0 X0 Y0\nG1 X20. F100\nG3 X30. Y20. R20.\nG1 Y30.\nM30\n";
    assert_eq!(
        messages(old, &old.replace("X20.", "X20.01")),
        ["move-shifted: a feed ends at a different point: X +0.0100"]
    );
    let other = messages(old, &old.replace("R20.", "R21."));
    assert!(other.len() == 1 && other[0].starts_with("move-arc: "), "{other:?}");
}

/// The new revision stops at the fourth of five holes, that are all alike but for their places.
#[test]
fn what_stands_behind_a_stop_midway_is_paired_with_nothing() {
    let holes = |blocks: &str| format!("O1\nG90 G54 G0 Z50.\nG81 Z-5. R2. X10. Y0 F100\n{blocks}G80\nM30\n");
    let (old, new) = ("X20.\nX30.\nX40.\nX50.\n", "X20.\nX30.\n#3000=1(STOP)\nX40.\nX50.\n");
    let found = messages(&holes(old), &holes(new));
    assert_eq!(found.len(), 1, "{found:?}");
    // Back at the first hole: a run that goes on looks alike.
    let again = messages(&holes("X20.\nX10.\nX20.\nX10.\n"), &holes("X20.\n#3000=1(STOP)\nX10.\n"));
    assert_eq!(again.len(), 1, "{again:?}");
}

/// G82 has no Q; G83 has.
#[test]
fn q_counts_where_the_cycle_has_it() {
    let old = "O1\nG90 G54 G0 Z50.\nG82 X10. Y0 Z-5. R2. Q3. P500 F100\nG80\nM30\n";
    assert_eq!(messages(old, &old.replace("Q3.", "Q4.")), Vec::<String>::new());
    // The same ways in one peck: what the control does between them is another matter.
    let found = messages(PECKS, &PECKS.replace("Q3.", "Q2."));
    assert_eq!(found, ["cycle: cycle G83 Q2 instead of G83 Q3 (1 hole)"]);
}
