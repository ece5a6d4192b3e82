//! Holes, passes of them and cuts that are made at another time: one entry, at the block that was moved, with what
//! the cut is made with otherwise because of that.
use gcode_review::Change;
use gcode_tests::changes::{effects, find_changes, messages};

/// The lines of an entry, before and now.
fn lines(change: &Change) -> [Option<u32>; 2] {
    [&change.old, &change.new].map(|side| side.as_ref().map(|at| at.line))
}

/// T1 spots, T2 drills and T3 reams four holes, each of them by its own list of positions: X30 stands in lines 8, 16
/// and 24.
fn reamed(lists: [&str; 3]) -> String {
    let tool = |number: usize, cycle: &str| {
        format!(
            "T{number} M6\nG43 H{number} Z50.\nS900 M3\nG98 {cycle} X10. Y0 F100\n{}\nG80\n",
            lists[number - 1]
        )
    };
    let cycles = ["G81 Z-1. R2.", "G83 Z-25. R2. Q5.", "G85 Z-20. R2."];
    let all: String = cycles.iter().enumerate().map(|(k, cycle)| tool(k + 1, cycle)).collect();
    format!("O1\nG90 G54 G17\nG0 X0 Y0\n{all}G0 Z50.\nM30\n")
}

const LIST: &str = "X30.\nX60.\nX100.";
const SWAPPED: &str = "X60.\nX30.\nX100.";

#[test]
fn passes_in_another_order_are_one_entry_at_their_own_block() {
    let old = reamed([LIST; 3]);
    assert_eq!(messages(&old, &old), [""; 0]);
    for tool in 0..3 {
        let mut lists = [LIST; 3];
        lists[tool] = SWAPPED;
        let found = find_changes(&old, &reamed(lists));
        let number = tool + 1;
        let message =
            format!("hole 2: pass {number} of 3, by T{number}, made in a different order, after hole 3");
        assert_eq!(found.len(), 1, "{found:#?}");
        assert_eq!((&*found[0].code, &found[0].message), ("hole-order", &message));
        let line = 8 + 8 * tool as u32;
        assert_eq!(lines(&found[0]), [Some(line), Some(line + 1)]);
    }
    // The hole with all its passes.
    let found = find_changes(&old, &reamed([SWAPPED; 3]));
    assert_eq!(found.len(), 1, "{found:#?}");
    assert_eq!(found[0].message, "hole 2: made in a different order, after hole 3");
    assert_eq!(lines(&found[0]), [Some(8), Some(9)]);
    // Spotted and reamed in the new order, drilled in the old one.
    assert_eq!(
        messages(&old, &reamed([SWAPPED, LIST, SWAPPED])),
        ["hole-order: hole 2: passes 1 and 3 of 3, by T1 and T3, made in a different order, after hole 3"]
    );
}

#[test]
fn a_tool_that_begins_with_another_hole_says_so() {
    let last_first = reamed([LIST, LIST, LIST]).replace(
        "G85 Z-20. R2. X10. Y0 F100\nX30.\nX60.\nX100.",
        "G85 Z-20. R2. X100. Y0 F100\nX10.\nX30.\nX60.",
    );
    assert_eq!(
        messages(&reamed([LIST; 3]), &last_first),
        ["hole-order: hole 4: pass 3 of 3, by T3, made in a different order, first of T3"]
    );
}

/// Two holes with S900 and coolant, two with S500 and none; the second one comes to the last two.
#[test]
fn a_hole_made_at_another_time_is_told_with_what_it_is_made_with_then() {
    let program = |first: &str, then: &str| {
        format!(
            "O1\nG90 G54 G17 G98\nG0 X0 Y0 Z50.\nS900 M3\nM8\nG81 X10. Y0 Z-5. R2. F100\n{first}G80\nS500\nM9\n\
            G81 X50. Y0 Z-5. R2. F80\n{then}G80\nG0 Z50.\nM5\nM30\n"
        )
    };
    let (early, late) = (program("X30.\n", "X70.\n"), program("", "X30.\nX70.\n"));
    assert_eq!(
        messages(&early, &late),
        ["hole-order: hole 2: made in a different order, after hole 3, with F80 instead of F100, M03 S500 \
          instead of M03 S900, coolant off instead of M08"]
    );
    assert_eq!(
        messages(&late, &early),
        ["hole-order: hole 3: made in a different order, after hole 1, with F100 instead of F80, M03 S900 \
          instead of M03 S500, M08 instead of coolant off"]
    );
}

/// Two pockets' outlines, beginning and ending at their first corner.
const LEFT: &str = "G0 X10. Y10.\nZ2.\nG1 Z-1. F100\nX40.\nY20.\nX10.\nY10.\nG0 Z50.\n";
const RIGHT: &str = "G0 X60. Y10.\nZ2.\nG1 Z-2. F100\nX90.\nY30.\nX60.\nY10.\nG0 Z50.\n";

/// Lines 1 to 4 stand before `first`.
fn milled(first: &str, between: &str, then: &str) -> String {
    format!("O1\nG90 G54 G17\nG0 X0 Y0 Z50.\nS900 M3\n{first}{between}{then}M5\nM30\n")
}

#[test]
fn swapped_sections_are_one_entry() {
    let found = find_changes(&milled(LEFT, "", RIGHT), &milled(RIGHT, "", LEFT));
    assert_eq!(found.len(), 1, "{found:#?}");
    let message = "8 moves are executed later than before, the first a rapid to X10.0000 Y10.0000";
    assert_eq!((&*found[0].code, &*found[0].message), ("move-order", message));
    assert_eq!(lines(&found[0]), [Some(5), Some(13)]);
    // In reverse order, two of three sections change places with one.
    let last = RIGHT.replace("Y10.", "Y50.").replace("Y30.", "Y70.");
    assert_eq!(
        messages(&milled(LEFT, RIGHT, &last), &milled(&last, RIGHT, LEFT)),
        ["move-order: 16 moves in 2 places are executed in a different order, the first a rapid to \
          X10.0000 Y10.0000, later"]
    );
    // What is milled twice and once less is no other order.
    let twice = milled(LEFT, LEFT, RIGHT);
    let codes: Vec<_> =
        self::find_changes(&twice, &milled(LEFT, "", RIGHT)).into_iter().map(|one| one.code).collect();
    assert!(!codes.is_empty() && codes.iter().all(|code| code == "move-lost"), "{codes:?}");
}

/// Tool, spindle and coolant that come with the section aren't told again; what stays where it was is, at the cuts.
#[test]
fn a_section_is_told_with_what_it_is_made_with_then() {
    let tool =
        |number: u32, section: &str| format!("T{number} M6\nS{number}00 M3\nG43 H{number} Z50.\n{section}");
    let (left, right) = (tool(3, LEFT), tool(4, RIGHT));
    assert_eq!(
        messages(&milled(&left, "", &right), &milled(&right, "", &left)),
        ["move-order: 8 moves are executed later than before, the first a rapid to X10.0000 Y10.0000"]
    );
    // The sections change places, their tools don't.
    let others = effects(&milled(&left, "", &right), &milled(&tool(3, RIGHT), "", &tool(4, LEFT)));
    let order: Vec<_> = others
        .iter()
        .flat_map(|entry| entry.split(" | "))
        .filter(|one| one.starts_with("move-order: "))
        .collect();
    assert!(
        order.iter().any(|entry| {
            entry.ends_with(", with T4 instead of T3, G43 H4 instead of G43 H3, M03 S400 instead of M03 S300")
        }),
        "{others:#?}"
    );
    let between = "S500\nM8\n";
    assert_eq!(
        effects(&milled(LEFT, between, RIGHT), &milled(RIGHT, between, LEFT)),
        [
            "move-order: 8 moves are executed later than before, the first a rapid to X10.0000 Y10.0000, with M03 S500 \
          instead of M03 S900, M08 instead of coolant off | spindle: S500 is executed later than before | coolant: \
          M08 is executed later than before"
        ]
    );
}
