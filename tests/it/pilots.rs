//! Passes of a hole that aren't its last, and what leads to them and back: a changed pilot is told at its hole, and nothing is
//! told with it that it doesn't explain.
use gcode_sim::changes::{Revision, changes};
use gcode_sim::machine::Machine;
use gcode_sim::program::NoLibrary;
use gcode_sim::session::Request;

/// What is different, as `code: message`.
fn told(old: &str, new: &str) -> Vec<String> {
    let record = |text: &str| {
        let request = Request::new("O1.nc", text.as_bytes().to_vec(), Machine::default());
        Revision::of(&request, &mut NoLibrary, None).unwrap().record
    };
    let found = changes(&record(old), &record(new), 0.0001);
    found.iter().map(|change| format!("{}: {}", change.code, change.message)).collect()
}

/// T1 makes both holes 4 mm deep, T2 the first of them to its end at 12 mm.
const PART: &str = "O1\nG90 G54 G0 X0 Y0\nT1 M6\nG43 H1 Z50.\nG98 G81 X10. Y0 Z-4. R2. F100\nX20. Z-4.\nG80\n\
    T2 M6\nG43 H2 Z50.\nG98 G83 X10. Y0 Z-12. R2. Q5. F80\nG80\nG0 Z50.\nM30\n";

fn changed(from: &str, to: &str) -> Vec<String> {
    assert_eq!(PART.matches(from).count(), 1, "{from}");
    told(PART, &PART.replace(from, to))
}

#[test]
fn a_pilot_elsewhere_is_told_at_its_hole() {
    assert_eq!(
        changed("G81 X10. Y0", "G81 X10.01 Y0"),
        ["hole-pass: hole 1: pass 1 of 2, by T1, ends elsewhere, by X +0.0100"]
    );
    assert_eq!(
        changed("Z-4. R2. F100", "Z-4.01 R2. F100"),
        ["hole-pass: hole 1: pass 1 of 2, by T1, 0.0100 mm deeper"]
    );
    // The last pass alone: that is the hole.
    assert_eq!(
        changed("G83 X10. Y0", "G83 X10.01 Y0"),
        ["hole-moved: hole 1: moved by +0.0100 +0.0000 +0.0000 mm"]
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
    assert_eq!(told(PART, &both), ["hole-moved: hole 1: moved by +0.0100 +0.0000 +0.0000 mm"]);
    let apart = PART.replace("G81 X10. Y0", "G81 X10.03 Y0").replace("G83 X10. Y0", "G83 X10.01 Y0");
    assert_eq!(
        told(PART, &apart),
        [
            "hole-moved: hole 1: moved by +0.0100 +0.0000 +0.0000 mm, pass 1 of 2, by T1, ends elsewhere, by X +0.0300"
        ]
    );
}

/// The way to the next hole goes by where this one is now, though no block says so anew.
#[test]
fn a_rapid_back_to_where_the_other_program_stands_is_told_with_what_leads_away() {
    let old = "O1\nG90 G54 G0 X0 Y0 Z50.\nG0 Y5.\nX10.\nZ2.\nG1 Z-5. F100\nG0 Z50.\nX30.\nM30\n";
    let there_and_back = old.replace("G0 Y5.\n", "G0 Y5.\nX-40.\nX0\n");
    assert_eq!(told(old, &there_and_back), ["move-added: a rapid to X-40.0000 is new"]);
    assert_eq!(told(&there_and_back, old), ["move-lost: a rapid to X-40.0000 is no longer there"]);
}

/// Out of the hole and back to its bottom by rapid: both are told, however often the bottom was there before.
#[test]
fn a_rapid_back_to_where_a_feed_has_led_is_told() {
    let old = "O1\nG90 G54 G0 X0 Y0 Z50.\nG0 X10.\nZ2.\nG1 Z-5. F100\nX15.\nG0 Z50.\nM30\n";
    let new = old.replace("Z-5. F100\n", "Z-5. F100\nG0 Z20.\nZ-5.\nG1 ");
    let found = told(old, &new);
    assert_eq!(found, ["move-added: a rapid to Z20.0000 is new", "move-added: a rapid to Z-5.0000 is new"]);
}

/// Two words of one block: the low R level isn't told with the moved hole.
#[test]
fn of_two_words_each_effect_is_an_entry() {
    let found = changed("G81 X10. Y0 Z-4. R2.", "G81 X10.01 Y0 Z-4. R-2.");
    assert!(found.len() > 1, "{found:?}");
    let one = changed("G81 X10. Y0 Z-4. R2.", "G81 X10. Y0 Z-4. R-2.");
    assert_eq!(one.len(), 1, "{one:?}");
}
