//! Passes of a hole that aren't its last, and what leads to them and back: a changed pilot is told at its hole, and nothing is
//! told with it that it doesn't explain.
use gcode_inspect::machine::Machine;
use gcode_tests::changes::{effects, find_changes_on, messages};

/// T1 makes both holes 4 mm deep, T2 the first of them to its end at 12 mm.
const PART: &str = "O1\nG90 G54 G0 X0 Y0\nT1 M6\nG43 H1 Z50.\nG98 G81 X10. Y0 Z-4. R2. F100\nX20. Z-4.\nG80\n\
    T2 M6\nG43 H2 Z50.\nG98 G83 X10. Y0 Z-12. R2. Q5. F80\nG80\nG0 Z50.\nM30\n";

fn changed(from: &str, to: &str) -> Vec<String> {
    assert_eq!(PART.matches(from).count(), 1, "{from}");
    messages(PART, &PART.replace(from, to))
}

#[test]
fn a_pilot_elsewhere_is_told_at_its_hole() {
    assert_eq!(
        changed("G81 X10. Y0", "G81 X10.01 Y0"),
        ["hole-pass: hole 1: pass 1 of 2, by T1, ends at a different point: X +0.0100"]
    );
    assert_eq!(
        changed("Z-4. R2. F100", "Z-4.01 R2. F100"),
        ["hole-pass: hole 1: pass 1 of 2, by T1, 0.0100 mm deeper"]
    );
    // The last pass alone: that is the hole, and it is off its pilot now.
    assert_eq!(
        changed("G83 X10. Y0", "G83 X10.01 Y0"),
        ["hole-moved: hole 1: moved by +0.0100 +0.0000 +0.0000 mm, pass 1 of 2, by T1, is unchanged"]
    );
    // Deeper than the hole is finished: both are told, in one entry.
    assert_eq!(
        changed("Z-4. R2. F100", "Z-13. R2. F100"),
        ["hole-depth: hole 1: 1.0000 mm deeper, pass 1 of 2, by T1, 9.0000 mm deeper"]
    );
}

/// Both tools go where the hole is now; a pilot that goes elsewhere than its hole is told with it.
#[test]
fn a_pilot_that_goes_with_its_hole_is_not_told_again() {
    let both = PART.replace("X10. Y0", "X10.01 Y0");
    assert_eq!(messages(PART, &both), ["hole-moved: hole 1: moved by +0.0100 +0.0000 +0.0000 mm"]);
    let apart = PART.replace("G81 X10. Y0", "G81 X10.03 Y0").replace("G83 X10. Y0", "G83 X10.01 Y0");
    assert_eq!(
        messages(PART, &apart),
        ["hole-moved: hole 1: moved by +0.0100 +0.0000 +0.0000 mm, pass 1 of 2, by T1, ends at a different \
          point: X +0.0300"]
    );
}

/// The way to the next hole goes by where this one is now, though no block says so anew.
#[test]
fn a_rapid_back_to_where_the_other_program_stands_is_told_with_what_leads_away() {
    let old = "O1\nG90 G54 G0 X0 Y0 Z50.\nG0 Y5.\nX10.\nZ2.\nG1 Z-5. F100\nG0 Z50.\nX30.\nM30\n";
    let there_and_back = old.replace("G0 Y5.\n", "G0 Y5.\nX-40.\nX0\n");
    assert_eq!(messages(old, &there_and_back), ["move-added: a rapid to X-40.0000 is added"]);
    assert_eq!(messages(&there_and_back, old), ["move-lost: a rapid to X-40.0000 is removed"]);
}

/// Out of the hole and back to its bottom by rapid: both are told, however often the bottom was there before.
#[test]
fn a_rapid_back_to_where_a_feed_has_led_is_told() {
    let old = "O1\nG90 G54 G0 X0 Y0 Z50.\nG0 X10.\nZ2.\nG1 Z-5. F100\nX15.\nG0 Z50.\nM30\n";
    let new = old.replace("Z-5. F100\n", "Z-5. F100\nG0 Z20.\nZ-5.\nG1 ");
    assert_eq!(
        effects(old, &new),
        ["move-added: a rapid to Z20.0000 is added | move-added: a rapid to Z-5.0000 is added"]
    );
}

/// Two words of one block: the low R level stands beside the moved hole.
#[test]
fn of_two_words_each_effect_is_told() {
    let both = PART.replace("G81 X10. Y0 Z-4. R2.", "G81 X10.01 Y0 Z-4. R-2.");
    assert_eq!(
        effects(PART, &both),
        [
            "hole-pass: hole 1: pass 1 of 2, by T1, ends at a different point: X +0.0100 | move-shifted: moves end at a \
          different point: X +0.0100 (2 rapids, a feed) | move-shifted: a rapid ends at a different point: X +0.0100 \
          Z -4.0000 | move-shifted: a rapid ends at a different point: Z -4.0000"
        ]
    );
    let one = PART.replace("G81 X10. Y0 Z-4. R2.", "G81 X10. Y0 Z-4. R-2.");
    assert_eq!(effects(PART, &one), ["move-shifted: a rapid ends at a different point: Z -4.0000 (2 moves)"]);
}

/// T1 drills 25 mm deep, T2 taps 18 mm of it: what the tap does is told whatever else happens to the hole.
const TAPPED: &str = "O1\nG90 G54 G0 X0 Y0\nT1 M6\nG43 H1 Z50.\nS900 M3\nG98 G83 X10. Y0 Z-25. R2. Q5. F100\nG80\n\
    T2 M6\nG43 H2 Z50.\nS300 M3\nG98 G84 X10. Y0 Z-18. R5. F300\nG80\nG0 Z50.\nM30\n";

#[test]
fn a_pass_above_the_holes_bottom_is_told_whatever_else_is_different() {
    let told = |edits: &[(&str, &str)]| {
        let new = edits.iter().fold(TAPPED.to_owned(), |text, (from, to)| text.replace(from, to));
        messages(TAPPED, &new)
    };
    let shorter = ("Z-18.", "Z-12.");
    assert_eq!(told(&[shorter]), ["hole-pass: hole 1: pass 2 of 2, by T2, 6.0000 mm less deep"]);
    assert_eq!(
        told(&[shorter, ("X10.", "X10.01")]),
        ["hole-moved: hole 1: moved by +0.0100 +0.0000 +0.0000 mm, pass 2 of 2, by T2, ends at a different \
          point: X +0.0100 Z +6.0000"]
    );
    assert_eq!(
        told(&[shorter, ("Z-25.", "Z-25.5")]),
        ["hole-depth: hole 1: 0.5000 mm deeper, pass 2 of 2, by T2, 6.0000 mm less deep"]
    );
    assert_eq!(
        told(&[("Z-18.", "Z-18.5"), ("Z-25.", "Z-25.5")]),
        ["hole-depth: hole 1: 0.5000 mm deeper"],
        "both by the same"
    );
}

/// What each pass does is told: which ones a moved hole has left behind, and by how much each of them is elsewhere.
#[test]
fn passes_that_stay_and_passes_that_go_elsewhere_are_told_apart() {
    let told = |drill: &str, tap: &str| {
        let new =
            TAPPED.replace("G83 X10.", &format!("G83 {drill}")).replace("G84 X10.", &format!("G84 {tap}"));
        messages(TAPPED, &new).concat()
    };
    let moved = |mm: &str| format!("hole-moved: hole 1: moved by +{mm} +0.0000 +0.0000 mm");
    let goes =
        |pass: u32, mm: &str| format!(", pass {pass} of 2, by T{pass}, ends at a different point: X +{mm}");
    assert_eq!(told("X10.01", "X10.01"), moved("0.0100"));
    assert_eq!(told("X10.", "X10.01"), moved("0.0100") + &goes(2, "0.0100"));
    assert_eq!(
        told("X10.01", "X10."),
        "hole-pass: hole 1".to_owned() + &goes(1, "0.0100").replacen(',', ":", 1)
    );
    assert_eq!(told("X10.01", "X10.02"), moved("0.0200") + &goes(1, "0.0100") + &goes(2, "0.0200"));
}

/// An arc's end moves with its contour; its sense, radius and centre are told beside that.
#[test]
fn an_arc_that_is_reshaped_is_told_whatever_its_ends_do() {
    let old = "O1\nG90 G54 G0 X0 Y0\nZ5.\nG1 Z-1. F100\nG1 X20.\nG2 X30. Y10. R10.\nG1 Y19.\nG0 Z5.\nM30\n";
    let codes = |edits: &[(&str, &str)]| {
        let new = edits.iter().fold(old.to_owned(), |text, (from, to)| text.replace(from, to));
        let of = |text: &str| text.split(':').next().unwrap().to_owned();
        effects(old, &new).iter().flat_map(|entry| entry.split(" | ")).map(of).collect::<Vec<_>>()
    };
    let deeper = ("Z-1.", "Z-1.01");
    assert_eq!(codes(&[deeper]), ["move-shifted"]);
    for shape in [("R10.", "R12."), ("R10.", "R-10."), ("G2", "G3")] {
        assert_eq!(codes(&[shape]), ["move-arc"], "{shape:?}");
        assert_eq!(codes(&[shape, deeper]), ["move-arc", "move-shifted"], "{shape:?}");
        assert!(codes(&[shape, ("G54", "G54 G52 X1. Y2.")]).contains(&"move-arc".to_owned()), "{shape:?}");
    }
}

/// Two holes are pecked by one cycle, and one of them by shorter pecks now.
#[test]
fn a_cycle_that_is_another_one_at_some_holes_names_them() {
    let old = "O1\nG90 G54 G0 X0 Y0 Z50.\nG98 G83 X10. Y0 Z-25. R2. Q5. F100\nX20.\nX30.\nG80\nM30\n";
    let new = old.replace("X20.\nX30.", "X20. Q4.\nX30. Q5.");
    assert_eq!(messages(old, &new), ["cycle: cycle G83 Q4 instead of G83 Q5 (hole 2)"]);
    assert_eq!(
        messages(old, &old.replace("Q5.", "Q4.")),
        ["cycle: cycle G83 Q4 instead of G83 Q5 (3 holes)"]
    );
}

/// What is told of spindle and coolant that a cut relied on, in the only entry.
fn state_messages(old: &str, new: &str) -> Vec<String> {
    let entries = effects(old, new);
    assert_eq!(entries.len(), 1, "{entries:#?}");
    let mut all: Vec<String> = entries[0].split(" | ").map(str::to_owned).collect();
    all.retain(|entry| {
        ["spindle: ", "coolant: "].iter().any(|code| entry.starts_with(code)) && entry.contains(" is cut ")
    });
    all
}

/// T1 spots two holes with S1500 M3 and M8; T2 drills them with what it says itself.
const SPOT: &str = "T1 M6\nS1500 M3\nG43 H1 Z50.\nM8\nG81 X10. Y0 Z-4. R2. F100\nX20.\nG80\n";

fn spot_and_drill(spindle: &str, coolant: &str) -> String {
    format!(
        "O1\nG90 G54 G98 G0 X0 Y0\n{SPOT}T2 M6\n{spindle}G43 H2 Z50.\n{coolant}G81 X10. Y0 Z-12. R2. F80\nX20.\nG80\n\
        G0 Z50.\nM9\nM5\nM30\n"
    )
}

fn without_spot(spindle: &str, coolant: &str) -> (Vec<String>, Vec<String>) {
    let old = spot_and_drill(spindle, coolant);
    let new = old.replace(SPOT, "");
    (state_messages(&old, &new), state_messages(&new, &old))
}

/// A tool that relied on the section that is deleted is told, and one that relies on a section that is new.
#[test]
fn spindle_and_coolant_that_a_later_tool_relied_on_are_told() {
    // T2 has its own: no cut relied on what goes with the spot drilling, whatever is in force behind it.
    assert_eq!(without_spot("S900 M3\n", "M8\n"), (vec![], vec![]));
    assert_eq!(without_spot("S1500 M3\n", "M8\n"), (vec![], vec![]));
    // M06 stops the spindle in this run: T2's drill stands in both. A machine whose M06 doesn't would have drilled.
    let (lost, added) = without_spot("", "M8\n");
    assert_eq!(
        lost,
        ["spindle: M03 S1500 is removed: if M06 keeps the spindle running, O0001:6 is cut with the spindle \
          stopped instead of M03 S1500 (2 moves)"]
    );
    assert_eq!(
        added,
        ["spindle: M03 S1500 is added: if M06 keeps the spindle running, O0001:13 is cut with M03 S1500 \
          instead of the spindle stopped (2 moves)"]
    );
    let coolant = "coolant: M08 is removed: O0001:6 is cut with coolant off instead of M08 (2 moves)";
    let (lost, added) = without_spot("S900 M3\n", "");
    assert_eq!(lost, [coolant]);
    assert_eq!(added, ["coolant: M08 is added: O0001:13 is cut with M08 instead of coolant off (2 moves)"]);
    let (both, _) = without_spot("", "");
    assert_eq!(
        both,
        [
            "spindle: M03 S1500 is removed: if M06 keeps the spindle running, O0001:5 is cut with the \
             spindle stopped instead of M03 S1500 (2 moves)",
            "coolant: M08 is removed: O0001:5 is cut with coolant off instead of M08 (2 moves)",
        ]
    );
}

/// Of one tool: no M06 lies between what is lost and the hole that relied on it.
#[test]
fn spindle_and_coolant_that_the_next_hole_of_the_same_tool_relied_on_are_told() {
    let program = |before: &str| {
        format!("O1\nG90 G54 G98 G0 X0 Y0 Z50.\nS800 M3\nG81 X10. Z-4. R2. F100\n{before}N9 X30.\nG80\nM30\n")
    };
    let old = program("S1500\nM7\nX20.\n");
    assert_eq!(
        state_messages(&old, &program("")),
        [
            "spindle: M03 S1500 is removed: O0001:5 N9 is cut with M03 S800 instead of M03 S1500",
            "coolant: M07 is removed: O0001:5 N9 is cut with coolant off instead of M07",
        ]
    );
    // Switched back before it: nothing relied on them.
    let old = program("S1500\nM7\nX20.\nS800\nM9\n");
    assert_eq!(state_messages(&old, &program("")), [""; 0]);
    // A hole is new, and the spindle stands behind it.
    assert_eq!(
        state_messages(&program(""), &program("X20.\nM5\n")),
        ["spindle: spindle stop is added: O0001:7 N9 is cut with the spindle stopped instead of M03 S800"]
    );
}

/// The same G43 H1 with another value: what is lost has written it, and it is written back at the end.
#[test]
fn a_tool_length_that_a_later_hole_relied_on_is_told() {
    let program = |between: &str, value: &str| {
        format!(
            "O1\nG90 G54 G98 G0 X0 Y0\nG10 L10 P1 R20.\nG43 H1 Z50.\nG81 X10. Z-4. R2. F100\n{between}X30.\nG80\n\
            G10 L10 P1 R{value}\nG49\nM30\n"
        )
    };
    let lost = "G80\nG10 L10 P1 R21.\nG43 H1\nG81 X20. Z-4. R2. F100\n";
    let found = effects(&program(lost, "20."), &program("", "20."));
    assert_eq!(found.len(), 1, "{found:#?}");
    let found: Vec<_> = found[0].split(" | ").filter(|entry| entry.starts_with("tool-length: ")).collect();
    assert_eq!(
        found,
        ["tool-length: tool length offset Z 21.0000 is removed: O0001:6 is cut with tool length offset Z \
          20.0000 instead of tool length offset Z 21.0000"]
    );
}

/// A tool's section is new, and the tool that is put back behind it isn't started again.
#[test]
fn a_spindle_that_a_new_tool_change_stops_is_told() {
    let program = |between: &str| {
        format!(
            "O1\nG90 G54 G98 G0 X0 Y0 Z50.\nT1 M6\nS800 M3\nG81 X10. Z-4. R2. F100\n{between}G81 X30. Z-4. R2. F100\nG80\nM30\n"
        )
    };
    let section = "G80\nT2 M6\nS800 M3\nG81 X20. Z-4. R2. F100\nG80\nT1 M6\n";
    assert_eq!(
        state_messages(&program(""), &program(section)),
        ["spindle: tool T1 is added: if M06 stops the spindle, O0001:12 is cut with the spindle stopped \
          instead of M03 S800"]
    );
    assert_eq!(state_messages(&program(""), &program(&format!("{section}M3\n"))), [""; 0]);
}

/// The pilot's tool is 80 mm long. Set 0.01 mm shorter and programmed 0.01 mm less deep, its tip ends where it did.
#[test]
fn a_pass_that_another_length_makes_up_for_says_so() {
    let machine = "[head]\nkind = \"fixed\"\ndirection = [0.0, 0.0, 1.0]\n[[tool]]\nnumber = 1\nlength = 80.0\n[[tool]]\nnumber = 2\nlength = 90.0\n";
    let old = format!("O1\nG10 L10 P1 R80.\nG10 L10 P2 R90.\n{}", PART.strip_prefix("O1\n").unwrap());
    let told = |edits: &[(&str, &str)]| {
        let new = edits.iter().fold(old.clone(), |text, (from, to)| text.replacen(from, to, 1));
        let found = find_changes_on(&Machine::parse(machine).unwrap(), &old, &new);
        let passes =
            found.iter().flat_map(|change| change.effects()).filter(|(code, _)| *code == "hole-pass");
        passes.map(|(_, message)| message.to_owned()).collect::<Vec<_>>()
    };
    let less = "hole 1: pass 1 of 2, by T1, 0.0100 mm less deep";
    assert_eq!(told(&[("Z-4. R2.", "Z-3.99 R2.")]), [less]);
    assert_eq!(
        told(&[("Z-4. R2.", "Z-3.99 R2."), ("R80.", "R79.99")]),
        [format!("{less} as programmed; its tip position is unchanged because of another length offset")]
    );
}
