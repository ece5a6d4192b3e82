//! One cause is one entry, at the block that somebody has edited, and nothing it says is false.
use gcode_inspect::machine::Machine;
use gcode_review::Change;
use gcode_tests::changes::{effect_texts, find_changes_on, texts};

fn found_by(machine: &str, old: &str, new: &str) -> Vec<Change> {
    find_changes_on(&Machine::parse(machine).unwrap(), old, new)
}

fn found(old: &str, new: &str) -> Vec<Change> {
    found_by(FIXED, old, new)
}

/// What is different, as `code: message`.
fn told(old: &str, new: &str) -> Vec<String> {
    texts(&found(old, new))
}

/// As `told`, each entry with all that stands beside its headline.
fn effects(old: &str, new: &str) -> Vec<String> {
    effect_texts(&found(old, new))
}

/// The blocks of an entry, before and now.
fn blocks(change: &Change) -> [Option<&str>; 2] {
    [&change.old, &change.new].map(|side| side.as_ref().map(|at| at.block.as_str()))
}

const FIXED: &str = "[head]\nkind = \"fixed\"\ndirection = [0.0, 0.0, 1.0]\n";

/// T1 drills two holes, T2 taps them.
const TAPPED: &str = "O1\nG90 G54 G0 X0 Y0\nT1 M6\nG43 H1 Z50.\nS900 M3\nG98 G83 X10. Y0 Z-25. R2. Q5. F100\nX20.\nG80\n\
    T2 M6\nG43 H2 Z50.\nS500 M3\nM29 S500\nG98 G84 X10. Y0 Z-18. R5. F500\nX20.\nG80\nG0 Z50.\nM5\nM30\n";

/// M03 stands in the block before: S500 beside M29 says what is so.
#[test]
fn a_lost_m29_is_that_and_no_lost_m03() {
    let without = TAPPED.replace("M29 S500\n", "");
    assert_eq!(told(TAPPED, &without), ["m-code: M29 is removed"]);
    assert_eq!(told(&without, TAPPED), ["m-code: M29 is added"]);
    // Another speed than M03's, for both holes: each of them is tapped in with it, out and on.
    let faster = TAPPED.replace("M29 S500", "M29 S600");
    assert_eq!(
        effects(&faster, &without),
        [
            "m-code: M29 is removed | spindle: S600 is removed | spindle: S500 instead of S600 (6 spindle commands)"
        ]
    );
}

/// What is said twice and lost once does nothing, unless something between the two may have stopped it.
#[test]
fn spindle_and_coolant_that_are_commanded_again_are_told_behind_a_stop() {
    let with = |between: &str, again: &str| {
        format!("O1\nG90 G54 G0 X0 Y0 Z50.\nS900 M3\nM8\nX10.\n{between}{again}G1 Z-5. F100\nG0 Z50.\nM30\n")
    };
    for again in ["S900 M3\n", "S900\n", "M8\n"] {
        assert_eq!(told(&with("", again), &with("", "")), [""; 0], "{again}");
        assert_eq!(told(&with("", ""), &with("", again)), [""; 0], "{again}");
    }
    let stopped = |again: &str| told(&with("M0\n", again), &with("M0\n", ""));
    assert_eq!(stopped("S900 M3\n"), ["spindle: M03 S900 is removed"]);
    assert_eq!(stopped("M8\n"), ["coolant: M08 is removed"]);
    let off = |again: &str| told(&with("M5\nM9\n", again), &with("M5\nM9\n", ""));
    let cut = "O0001:8 is cut with";
    assert_eq!(
        off("S900 M3\n"),
        [format!("spindle: M03 S900 is removed: {cut} the spindle stopped instead of M03 S900")]
    );
    assert_eq!(off("M8\n"), [format!("coolant: M08 is removed: {cut} coolant off instead of M08")]);
}

/// G74 turns the spindle the other way at the bottom and on the way out.
#[test]
fn another_tapping_cycle_is_one_entry() {
    let left = TAPPED.replace("G84", "G74");
    assert_eq!(
        effects(TAPPED, &left),
        [
            "cycle: cycle G74 instead of G84 (2 holes) | spindle: M04 S500 instead of M03 S500 (2 spindle commands) | \
          spindle: M04 S500 is executed later than before (2 spindle commands) | spindle: M03 S500 is executed earlier \
          than before (2 spindle commands)"
        ]
    );
    assert_eq!(told(&left, TAPPED), ["cycle: cycle G84 instead of G74 (2 holes)"]);
}

/// A Φ10 spot drill goes 1.5 mm into the part, 3.5 mm below R; a Φ6 drill 5 mm, 7 mm below R.
#[test]
fn a_lost_spot_drilling_leaves_the_drills_diameter() {
    let machine = format!(
        "{FIXED}[[tool]]\nnumber = 1\ndiameter = 10.0\n[[tool]]\nnumber = 2\ndiameter = 6.0\n[[tool]]\nnumber = 3\n\
        diameter = 6.2\n"
    );
    let program = |spots: &str, last: &str| {
        format!(
            "O1\nG90 G54 G0 X0 Y0\nT1 M6\nG43 H1 Z50.\nG98 G81 {spots} Z-1.5 R2. F100\nG80\nT2 M6\nG43 H2 Z50.\n\
            G98 G81 X10. Y0 Z-5. R2. F80\nX20.\nG80\n{last}G0 Z50.\nM30\n"
        )
    };
    let both = program("X10. Y0 Z-1.5 R2. F100\nX20.", "");
    let one = program("X10. Y0", "");
    assert_eq!(
        effect_texts(&found_by(&machine, &both, &one)),
        [
            "hole-tool: hole 2: no longer made by T1, in total by T2 | move-lost: a rapid to X20.0000 is removed (4 moves \
          of its block) | move-lost: a rapid to X10.0000 is removed"
        ]
    );
    assert_eq!(
        texts(&found_by(&machine, &one, &both)),
        ["hole-tool: hole 2: also made by T1, in total by T1 and T2"]
    );
    // A reamer stops above the drill's bottom and makes the diameter all the same.
    let reamed = program("X10. Y0", "T3 M6\nG43 H3 Z50.\nG98 G85 X10. Y0 Z-4.5 R2. F50\nG80\n");
    assert_eq!(
        effect_texts(&found_by(&machine, &reamed, &one)),
        [
            "hole-diameter: hole 1: Φ6 instead of Φ6.2, no longer made by T3, in total by T1 and T2 | tool: tool T3 is \
          removed | move-lost: a rapid to X10.0000 is removed (5 moves of its block)"
        ]
    );
}

/// The holes or moves are in other blocks: the reader is led to the one that is written otherwise.
#[test]
fn a_lone_entry_names_the_block_that_was_edited() {
    let old = "O1\n#1=25.\nG90 G54 G0 X0 Y0\nT1 M6\nG43 H1 Z50.\nG98 G83 X10. Y0 Z-#1 R2. Q5. F100\nX20.\nG80\nG0 Z50.\nM30\n";
    for (from, to, code) in [
        ("#1=25.", "#1=26.", "hole-depth"),
        ("T1 M6", "T2 M6", "hole-tool"),
        ("G90 G54 G0 X0 Y0", "G90 G55 G0 X0 Y0", "work-system"),
    ] {
        let new = old.replace(from, to);
        for (old, new, wanted) in [(old, new.as_str(), [from, to]), (&new, old, [to, from])] {
            let found = found(old, new);
            assert_eq!(found.len(), 1, "{found:?}");
            assert_eq!((&*found[0].code, blocks(&found[0])), (code, wanted.map(Some)));
        }
    }
    // A hole more is the call's.
    let rows = "O1\nG90 G54 G0 X0 Y0 Z50.\nG65 P2 K2.\nM30\nO2\n#1=0\nWHILE[#1 LT #6]DO1\nG81 X[10.*#1] Z-5. R2. F100\n#1=#1+1\nEND1\nG80\nM99\n";
    let more = found(rows, &rows.replace("K2.", "K3."));
    assert_eq!(texts(&more), ["hole-added: a hole added: at 20.000 0.000 2.000, fed 7.000 mm"]);
    assert_eq!(blocks(&more[0]), [Some("G65 P2 K2."), Some("G65 P2 K3.")]);
}

/// Holes 20 apart, each of them spotted and drilled; a shift by 20 leads each to the place of the next.
#[test]
fn a_shift_by_the_pitch_moves_all_holes() {
    let program = |shift: &str, end: &str| {
        let tool = |number: u32, z: u32| {
            format!(
                "T{number} M6\nG43 H{number} Z50.\nG98 G81 X10. Y0 Z-{z}. R2. F100\nX30.\nX50.\nX70.\nG80\n"
            )
        };
        format!("O1\nG90 G54 G17\nG0 X0 Y0\n{shift}{}{}G0 Z50.\n{end}M30\n", tool(1, 1), tool(2, 9))
    };
    let (old, new) = (program("", ""), program("G52 X20.\n", "G52 X0\n"));
    assert_eq!(told(&old, &new), ["hole-moved: holes 1, 2, 3, 4: moved by +20.0000 +0.0000 +0.0000 mm"]);
    assert_eq!(told(&new, &old), ["hole-moved: holes 1, 2, 3, 4: moved by -20.0000 +0.0000 +0.0000 mm"]);
    // Left in force, the next program finds it.
    let left = effects(&old, &program("G52 X20.\n", ""));
    assert_eq!(
        left,
        [
            "hole-moved: holes 1, 2, 3, 4: moved by +20.0000 +0.0000 +0.0000 mm | move-shifted: moves end at a different \
          point: X +20.0000 (24 rapids, 8 feeds) | work-offset: G52 X ends as 20 instead of 0"
        ]
    );
    // Positions that are written otherwise are holes lost and added: three stay where they were.
    let row =
        |positions: &str| format!("O1\nG90 G54 G0 X0 Y0 Z50.\nG81 Z-5. R2. F100 K0\n{positions}G80\nM30\n");
    assert_eq!(
        told(&row("X10.\nX30.\nX50.\nX70.\n"), &row("X30.\nX50.\nX70.\nX90.\n")),
        [
            "hole-lost: hole 1: lost, at 10.000 0.000 2.000, fed 7.000 mm",
            "hole-added: a hole added: at 90.000 0.000 2.000, fed 7.000 mm"
        ]
    );
}

/// H3 holds 5 mm less than H2, all Z of the tool are 5 mm more: the machine does what it did. The pecks are 5 mm
/// apart as well.
#[test]
fn another_length_that_all_moves_make_up_for_is_told_once_with_them() {
    let program = |length: u32, up: i32| {
        format!(
            "O1\nG10 L10 P2 R90.\nG10 L10 P3 R85.\nG90 G54 G17\nG0 X0 Y0\nT2 M6\nG43 H{length} Z{}.\n\
            G98 G83 X10. Y0 Z{}. R{}. Q5. F100\nX30.\nG80\nM30\n",
            50 + up,
            up - 25,
            up + 2
        )
    };
    let machine = format!("{FIXED}[[tool]]\nnumber = 2\nlength = 90.0\n");
    let (old, new) = (program(2, 0), program(3, 5));
    let entry = |now: u32, was: u32, lengths: [f64; 2], by: &str| {
        let unchanged = "the machine position is unchanged because of another length offset";
        // Two holes of six pecks.
        format!(
            "tool-length: G43 H{now} instead of G43 H{was} (39 moves) | tool-length: tool length offset Z {:.4} instead \
             of tool length offset Z {:.4} | move-shifted: moves end at a different point: Z {by} as programmed; \
             {unchanged} (27 rapids, 12 feeds)",
            lengths[0], lengths[1]
        )
    };
    let found = effect_texts(&found_by(&machine, &old, &new));
    assert_eq!(found, [entry(3, 2, [85.0, 90.0], "+5.0000")]);
    let back = effect_texts(&found_by(&machine, &new, &old));
    assert_eq!(back, [entry(2, 3, [90.0, 85.0], "-5.0000")]);
}

/// T2 has taken over the length that T3 puts in force again: T3's G43 does what it did.
#[test]
fn a_length_that_is_in_force_already_is_not_lost() {
    let old = "O1\nG10 L10 P2 R90.\nG10 L10 P3 R85.\nG90 G54 G0 X0 Y0\nT2 M6\nG43 H2 Z50.\nG98 G81 X10. Y0 Z-9. R2. F100\nG80\n\
        T3 M6\nG43 H3 Z50.\nG98 G81 X30. Y0 Z-9. R2. F100\nG80\nM30\n";
    let entries = found(old, &old.replace("G43 H2", "G43 H3"));
    assert!(
        entries.iter().all(|one| !one.message.contains("tool length offset Z 85.0000 is")),
        "{entries:#?}"
    );
    assert!(entries[0].message.contains("G43 H3 instead of G43 H2"), "{entries:#?}");
}

/// Behind G91, X10. is where it was, X20. 10 mm farther, and X0 Y0 goes nowhere.
#[test]
fn what_one_lost_or_new_word_or_block_does_is_one_entry() {
    let program = |block: &str| {
        format!("O1\nG90 G54 G0 X0 Y0 Z50.\nG91 Z5.\n{block}\nG1 X20. F100\nY5.\nG0 X0 Y0\nM30\n")
    };
    for (with, without, named) in
        [("G90\nX10.", "X10.", ["G90", ""]), ("G90 X10.", "X10.", ["G90 X10.", "X10."])]
    {
        let (old, new) = (program(with), program(without));
        let found = found(&old, &new);
        let wanted = "move-shifted: a feed ends at a different point: X +10.0000 (2 moves) | move-lost: a rapid to \
                      X0.0000 Y0.0000 is removed | mode: the program ends in G91 instead of G90";
        assert_eq!(effect_texts(&found), [wanted]);
        assert_eq!(blocks(&found[0]), named.map(|block| Some(block).filter(|block| !block.is_empty())));
        let back = self::found(&new, &old);
        assert_eq!(back.len(), 1, "{back:#?}");
        assert_eq!(
            blocks(&back[0]),
            [named[1], named[0]].map(|block| Some(block).filter(|block| !block.is_empty()))
        );
    }
    // Two words of one block are one entry with all effects of both.
    assert_eq!(
        effects(&program("G90 X10."), &program("X11.")),
        [
            "move-shifted: a rapid ends at a different point: X +1.0000 | move-shifted: a feed ends at a different \
             point: X +11.0000 (2 moves) | move-lost: a rapid to X0.0000 Y0.0000 is removed | mode: the program ends \
             in G91 instead of G90"
        ]
    );
}
