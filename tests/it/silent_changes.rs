//! What a run alone doesn't show: what a program finds as it was left, places that are the same here alone, pulses,
//! guards that no run needed.
use gcode_review::{changes, unexecuted};
use gcode_tests::changes::{effects, messages, revision};

/// `PROGRAM` with one thing written otherwise.
fn changed(from: &str, to: &str) -> Vec<String> {
    assert_eq!(PROGRAM.matches(from).count(), 1, "{from}");
    messages(PROGRAM, &PROGRAM.replace(from, to))
}

/// Two tools, the second one started anew.
const PROGRAM: &str = "O1\nG90 G21 G54\nG17 G40 G49 G80\nG10 L2 P1 X0 Y0\nT1 M6\nS1000 M3\nG0 X0 Y0\nG43 H1 Z50.\nX10.\nG1 Z-5. F100\n\
    G0 Z50.\nT2 M6\nS3000 M3\nG43 H2 X20.\nG1 Z-8.\nG0 Z50.\nM5\nM30\n";

#[test]
fn a_spindle_that_is_not_started_again_behind_a_tool_change_is_told() {
    assert_eq!(changed("S3000 M3", "S3000"), ["spindle: S3000 without M03 or M04 instead of M03 S3000"]);
    assert_eq!(messages(PROGRAM, PROGRAM), Vec::<String>::new());
}

#[test]
fn a_mode_that_is_no_longer_commanded_is_told_with_its_block() {
    let relies = "the program now depends on the previous program's modes";
    assert_eq!(
        changed("G90 G21 G54\n", ""),
        [format!("start: G90, G21 and G54 are no longer commanded before the first move: {relies}")]
    );
    assert_eq!(
        changed("G17 ", ""),
        [format!("start: G17 is no longer commanded before the first move: {relies}")]
    );
    // Later than before, but for a move that needs it.
    let late = PROGRAM.replace("G90 G21 G54", "G21 G54").replace("X10.\n", "G90 X10.\n");
    assert_eq!(
        messages(PROGRAM, &late),
        [format!("start: G90 is no longer commanded before the first move: {relies}")]
    );
    assert_eq!(messages(&late, PROGRAM), Vec::<String>::new(), "what is commanded earlier relies on less");
}

#[test]
fn modes_commanded_elsewhere_before_the_first_move_are_the_same() {
    let called = "M98 P2\nG17 G40 G49 G80\n";
    let (block, end) = ("G90 G21 G54\nG17 G40 G49 G80\n", "M30\nO2\nG90\nG21 G54\nM99\n");
    let other = PROGRAM.replace(block, called).replace("M30\n", end);
    assert_eq!(messages(PROGRAM, &other), Vec::<String>::new());
    // In the block of the move itself.
    let with = PROGRAM.replace("G90 G21 G54\n", "").replace("G0 X0 Y0", "G90 G21 G54 G0 X0 Y0");
    assert_eq!(messages(PROGRAM, &with), Vec::<String>::new());
}

#[test]
fn an_axis_that_is_no_longer_sent_anywhere_is_told() {
    assert_eq!(
        changed("G0 X0 Y0\n", "G0\n"),
        ["start: X and Y are no longer positioned before the first move: the start position is undefined"]
    );
    assert_eq!(
        changed("G0 X0 Y0\n", "G91 G0 X0 Y0\nG90\n")[0],
        "start: X and Y are no longer positioned before the first move: the start position is undefined"
    );
}

#[test]
fn an_offset_that_is_no_longer_written_is_told_though_it_is_the_same_here() {
    assert_eq!(
        changed("G10 L2 P1 X0 Y0\n", ""),
        ["start: G10 L2 P1 X and G10 L2 P1 Y are no longer written before the first move: the program now \
          depends on the value left by the previous program"]
    );
}

#[test]
fn codes_that_end_in_the_same_place_here_are_told() {
    let with = |block: &str| PROGRAM.replace("M5\n", &format!("{block}\nM5\n"));
    for (old, new, wanted) in [
        ("G91 G28 Z0", "G91 G30 Z0", "g-code: G30 instead of G28"),
        ("G91 G30 P2 Z0", "G91 G30 P3 Z0", "g-code: G30 P3 instead of G30 P2"),
        ("G60 X5.", "G0 X5.", "path-mode: G60 is removed"),
        ("G0 X5.", "G60 X5.", "path-mode: G60 is added"),
        ("M19 R90.", "M19 R91.", "m-code: M19 R91 instead of M19 R90"),
        ("#1100=1\nG4 P100\n#1100=0", "#1101=1\nG4 P100\n#1101=0", "signal: #1101=1 instead of #1100=1"),
        ("#1132=1\n#1132=0", "#1132=0", "signal: #1132=1 is removed"),
        ("#1100=1", "#1101=1", "signal: #1101=1 instead of #1100=1"),
    ] {
        let found = messages(&with(old), &with(new));
        assert_eq!(found[0], wanted, "{old} -> {new}: {found:?}");
        let pulse = if old.contains("G4") { 2 } else { 1 };
        assert_eq!(found.len(), pulse, "{old} -> {new}: {found:?}");
        assert_eq!(messages(&with(old), &with(old)), Vec::<String>::new(), "{old}");
    }
    // Where the moves are others these are the headline of the one entry.
    assert_eq!(
        effects(&with("G91 G28 Z0"), &with("G91")),
        [
            "move-lost: a rapid to Z0.0000 is removed | g-code: G28 is removed | mode: the program ends in G43 instead \
          of G49"
        ]
    );
}

#[test]
fn another_o_number_is_another_program() {
    assert_eq!(
        changed("O1\n", "O2\n"),
        ["program: O0002 instead of O0001: a different program on the control"]
    );
}

#[test]
fn a_guard_that_no_run_needed_is_named() {
    let guarded = PROGRAM.replace("G0 X0 Y0\n", "#1=5\nN7 IF[#1 GT 50]THEN #3000=1(TOO BIG)\nG0 X0 Y0\n");
    let without = guarded.replace("N7 IF[#1 GT 50]THEN #3000=1(TOO BIG)\n", "");
    let (old, new) = (revision(&guarded), revision(&without));
    assert!(changes(&old.record, &new.record, 0.0001).is_empty());
    let idle = unexecuted(&old, &new);
    assert_eq!(idle.len(), 1, "{idle:?}");
    assert_eq!((idle[0].old.as_ref().unwrap().line, &idle[0].new), (8, &None));
    // Another number, another remark: the same guard. One whose condition holds was executed.
    let renumbered = guarded.replace("N7 IF", "N8 IF").replace("TOO BIG", "MUCH TOO BIG");
    assert_eq!(unexecuted(&old, &revision(&renumbered)), []);
    let held = guarded.replace("THEN #3000=1(TOO BIG)", "THEN #2=1").replace("#1=5", "#1=60");
    assert_eq!(unexecuted(&revision(&held), &revision(&held.replace("THEN #2=1", "THEN #2=2"))), []);
    let jump =
        guarded.replace("THEN #3000=1(TOO BIG)", "GOTO 9").replace("M30", "GOTO 10\nN9 G0 X1.\nN10 M30");
    let other = jump.replace("N9 G0 X1.", "N9 G0 X2.");
    let idle = unexecuted(&revision(&jump), &revision(&other));
    let lines = idle
        .iter()
        .map(|block| [&block.old, &block.new].map(|side| side.as_ref().map(|at| at.block.as_str())));
    assert_eq!(lines.collect::<Vec<_>>(), [[Some("N9 G0 X1."), Some("N9 G0 X2.")]]);
}
