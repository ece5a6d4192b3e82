//! Tests of renames, right and refused ones.
use crate::testing::{fixture, fixture_on};
use gcode_lang::control::{Dialect, Settings};

fn renamed(text: &str, new: &str) -> String {
    let fixture = fixture(text);
    let edits = fixture.project.rename(fixture.file, fixture.offset, new).unwrap();
    fixture.edited(&edits)
}

fn refused(text: &str, new: &str) -> String {
    let fixture = fixture(text);
    fixture.project.rename(fixture.file, fixture.offset, new).unwrap_err().reason
}

#[test]
fn a_local_changes_in_its_program_alone() {
    assert_eq!(
        renamed("O1\n#$01=5.\nX[#1*2] Y#11\nIF[#1 GT 3]GOTO 5\nN5 M30\nO2\n#1=2\nM99\n", "#7"),
        "O1\n#7=5.\nX[#7*2] Y#11\nIF[#7 GT 3]GOTO 5\nN5 M30\nO2\n#1=2\nM99\n"
    );
    assert_eq!(renamed("O1\nDPRNT[A#1[44]]\n#$01=2\nM30\n", "9"), "O1\nDPRNT[A#9[44]]\n#9=2\nM30\n");
}

#[test]
fn a_local_changes_with_the_letters_that_set_it() {
    let text = "O1\nG65 P2 A1. R5.\nM30\nO2\nX#$018\nM99\n";
    assert_eq!(renamed(text, "#19"), "O1\nG65 P2 A1. S5.\nM30\nO2\nX#19\nM99\n");
    assert_eq!(renamed(text, "#5"), "O1\nG65 P2 A1. J5.\nM30\nO2\nX#5\nM99\n", "J alone is #5");
    assert!(refused(text, "#30").contains("#30 has no letter"), "{}", refused(text, "#30"));
    assert!(refused(text, "#1").contains("#1 is in use"));
    let sets = "O1\nG65 P2 I1. R5.\nM30\nO2\nX#$018\nM99\n";
    assert!(refused(sets, "#4").contains("#4 is in use"));
    let second = "O1\nG65 P2 J1. R5.\nM30\nO2\nX#$018\nM99\n";
    assert!(refused(second, "#4").contains("would set other variables"), "I behind J is #7");
    let every = "O1\nG66.1 P2\nR5.\nM30\nO2\n#$018=5\nX#18\nM99\n";
    assert!(refused(every, "#19").contains("words of all blocks"), "{}", refused(every, "#19"));
    assert!(refused("O2\nX#$018\nM99\n", "#19").contains("argument R"), "unknown callers");
    assert_eq!(renamed("O2\n#$018=5\nX#18\nM99\n", "#19"), "O2\n#19=5\nX#19\nM99\n");
}

#[test]
fn a_subprogram_shares_the_locals_of_its_caller() {
    assert_eq!(
        renamed("O1\n#$01=5\nM98 P2\nM30\nO2\nX#1\nM99\n", "#2"),
        "O1\n#2=5\nM98 P2\nM30\nO2\nX#2\nM99\n"
    );
    assert!(refused("O1\n#$01=5\nM98 P77\nM30\n", "#2").contains("O0077, which shares the local variables"));
}

#[test]
fn a_common_changes_in_all_files() {
    let text = "//- O1.nc\nO1\n#$0101=5\nG65 P2 A#101\nM30\n//- O2.nc\nO2\nX[#101+#1] Y#1010\nM99\n";
    assert_eq!(renamed(text, "#102"), "O1\n#102=5\nG65 P2 A#102\nM30\nO2\nX[#102+#1] Y#1010\nM99\n");
    assert!(refused(text, "#7").contains("#7 is a local variable"));
    assert!(refused(text, "#5001").contains("not such a variable"));
    assert!(refused(text, "#34").contains("not such a variable"));
    let reason = "#500 keeps its value when the power is off, #101 doesn't: write #100 to #199";
    assert_eq!(refused(text, "#500"), reason);
    let reason = "#500 keeps its value when the power is off, #150 doesn't: write #500 to #999";
    assert_eq!(refused("O1\n#$0500=5\nM30\n", "#150"), reason);
    assert!(refused(text, "X").contains("write a variable"));
}

#[test]
fn a_variable_that_cannot_be_followed_is_refused() {
    for (text, reason) in [
        ("O1\n#$01=5\n#[#2+3]=1\nM30\n", "O0001 line 3 accesses #[#2+3], which may be #1"),
        ("O1\n#$01=5\nX#[#2]\nM30\n", "may be #1"),
        ("O1\n#$0500=5\n#501=1\nM30\n", "#501 is in use: O0001 line 3"),
        ("O1\n#$0100=5\nX#[99+1]\nM30\n", "spells #100 as #[99+1]"),
        ("O1\n#$05001=1\n", "system variable"),
        ("O1\n#$00=1\n", "vacant variable"),
        ("O1\nSETVN 500[A,B]\n#$0501=1\nM30\n", "may name the variable"),
        ("O1\nX#[$0#2]\n", "may be #2"),
        ("O1\nG0 $0X1.\n", "no variable"),
    ] {
        let found = refused(text, "#501");
        let found = if found.contains(reason) { found } else { refused(text, "#7") };
        assert!(found.contains(reason), "{text}: {found}");
    }
}

#[test]
fn input_of_an_operator_sets_a_variable() {
    let mut settings = Settings::default();
    settings.apply_dialect(Dialect::HaasNgc);
    let fixture = fixture_on("O1\nM109 P501\nIF[#$0501 EQ 89]GOTO 5\nN5 M30\n", settings);
    let edits = fixture.project.rename(fixture.file, fixture.offset, "#502").unwrap();
    assert_eq!(fixture.edited(&edits), "O1\nM109 P502\nIF[#502 EQ 89]GOTO 5\nN5 M30\n");
}

#[test]
fn a_sequence_number_changes_with_its_jumps() {
    assert_eq!(
        renamed("O1\nGOTO $010\nN10 IF[#1 EQ 1]GOTO10\nM97 P10\nN100\nM30\nO2\nN10 M99\n", "N20"),
        "O1\nGOTO 20\nN20 IF[#1 EQ 1]GOTO20\nM97 P20\nN100\nM30\nO2\nN10 M99\n"
    );
    assert_eq!(renamed("O1\n$0N10 G0\nM99 P10\n", "20"), "O1\nN20 G0\nM99 P20\n");
    assert_eq!(
        renamed("O1\nM98 P2 Q5\nN7 M30\nO2\n$0N5 X1.\nM99 P7\n", "N6"),
        "O1\nM98 P2 Q6\nN7 M30\nO2\nN6 X1.\nM99 P7\n"
    );
    assert_eq!(
        renamed("O1\nM98 P2\nN$07 M30\nN5\nO2\nN5 X1.\nM99 P7\n", "N8"),
        "O1\nM98 P2\nN8 M30\nN5\nO2\nN5 X1.\nM99 P8\n"
    );
}

#[test]
fn a_sequence_number_that_cannot_be_followed_is_refused() {
    for (text, reason) in [
        ("O1\nN$010\nGOTO#1\n", "by GOTO#1"),
        ("O2\nN$010 M99\nO1\nM98 P2 Q#1\n", "by Q#1"),
        ("O1\nM98 P#1 Q#2\nN$010\n", "by Q#2"),
        ("O1\nN$010\nM99 P#2\n", "by M99 P#2"),
        ("O1\nN$010\nM98 P2\nM30\nO2\nM99 P#2\n", "by M99 P#2"),
        ("O1\nN$010\nN20\n", "N20 is in use"),
        ("O1\nN$010\nN10\n", "more than once"),
        ("O1\nN$010\nGOTO 20\nM30\n", "which is missing, would find it"),
        ("O1\nGOTO $010\n", "N10 is not in O0001"),
        ("O1\nN$010 #1=#4114\n", "reads #4114"),
        ("O1\nN$010\nIF[#1 EQ]GOTO 10\n", "cannot be read"),
        ("O1\nM98 P2\nN7\nO3\nM98 P2\nN7\nO2\nM99 P$07\n", "several programs call this one"),
    ] {
        let found = refused(text, "N20");
        assert!(found.contains(reason), "{text}: {found}");
    }
    assert!(refused("O1\nN$010\n", "N100000000").contains("out of range"));
    assert_eq!(renamed("O1\nN$010\nO2\nGOTO#1\n", "N20"), "O1\nN20\nO2\nGOTO#1\n", "another program");
    let called = "O1\nN$010 M98 P2\nM30\nO2\nGOTO#1\nM99\n";
    assert_eq!(renamed(called, "N20"), called.replace("N$010", "N20"), "in the called program alone");
}

#[test]
fn parameter_numbers_are_no_sequence_numbers() {
    let text = "O1\nG10 L52\nN10 R1\nG11\n$0N10 G0\nGOTO 10\n";
    assert_eq!(renamed(text, "N20"), "O1\nG10 L52\nN10 R1\nG11\nN20 G0\nGOTO 20\n");
}

#[test]
fn a_program_changes_with_its_calls() {
    assert_eq!(
        renamed(
            "//- O1.nc\nO1\nG65 P8101 A1.\nM98 P58101\nM98 P8101 L2\nG66 P08101\nM30\n//- O8101.nc\nO$08101(T)\nM99\n",
            "O8102"
        ),
        "O1\nG65 P8102 A1.\nM98 P58102\nM98 P8102 L2\nG66 P08102\nM30\nO8102(T)\nM99\n"
    );
    assert_eq!(renamed("O1\nG65 P2 X..5\nO$02\n", "7"), "O1\nG65 P7 X..5\nO0007\n", "before unreadable text");
    assert_eq!(renamed("O1\nM98 P$02\nM30\nO0002\nM99\n", "7"), "O1\nM98 P7\nM30\nO0007\nM99\n");
}

#[test]
fn a_program_that_cannot_be_followed_is_refused() {
    for (text, reason) in [
        ("O1\nG65 P#1\nM30\nO$02\nM99\n", "calls a program whose number is computed"),
        ("O1\nM98 P$02\nM30\n", "O0002 is not in the project"),
        ("O$02\nM99\nO3\nM99\n", "O0003 is in use"),
        ("O$02\nM99\nO2\nM99\n", "more than once"),
        ("O$02\n#1=#4115\nM99\n", "reads #4115"),
        ("O1\nG65 X..5 P2\nM30\nO$02\nM99\n", "cannot be read"),
        ("O1\nM98 P3\nM30\nO$02\nM99\n", "which is missing, and would find it"),
    ] {
        let found = refused(text, "O3");
        assert!(found.contains(reason), "{text}: {found}");
    }
    let found = refused("O1\nM98 P2\nM30\nO$02\nM99\n", "O12345");
    assert!(found.contains("read differently"), "O2345 once: {found}");
    let mut settings = Settings::default();
    settings.code_calls.set_parameter(6071, 6).unwrap();
    let fixture = fixture_on("O1\nM6\nM30\nO$09001\nM99\n", settings);
    let found = fixture.project.rename(fixture.file, fixture.offset, "O9100").unwrap_err();
    assert!(found.reason.contains("by M6"), "{found}");
}

#[test]
fn what_can_be_renamed_is_known_before() {
    let prepared = |text: &str| {
        let fixture = fixture(text);
        let target = fixture.project.prepare_rename(fixture.file, fixture.offset);
        target.map(|target| (target.placeholder, fixture.text(fixture.file, target.range)))
    };
    assert_eq!(prepared("O1\nX#1$0\n#1=2\nM30\n").unwrap(), ("#1".into(), "#1".into()));
    assert_eq!(prepared("O1\nN5\nGOTO 5$0\n").unwrap(), ("N5".into(), "5".into()));
    assert_eq!(prepared("O1\nG65 P$01\n").unwrap(), ("O0001".into(), "P1".into()));
    assert!(prepared("O1\nGOTO#1\nN$05\n").is_err());
}

#[test]
fn numbers_are_given_anew_with_their_jumps() {
    let renumbered = |text: &str| {
        let fixture = fixture(text);
        let key = fixture.project.program_at(fixture.file, 0).unwrap();
        let edits = fixture.project.renumber(key, None, 10, 10);
        edits.map(|edits| fixture.edited(&edits)).map_err(|refusal| refusal.reason)
    };
    assert_eq!(
        renumbered("O1\nN1 G0\nN20 GOTO 30\nN30 IF[#1 EQ 1]GOTO1\nN0\nM30\nO2\nN1\n").unwrap(),
        "O1\nN10 G0\nN20 GOTO 30\nN30 IF[#1 EQ 1]GOTO10\nN0\nM30\nO2\nN1\n"
    );
    assert_eq!(renumbered("O1\nN1\nN1\nM30\n").unwrap(), "O1\nN10\nN20\nM30\n", "nothing jumps to them");
    assert!(renumbered("O1\nN1\nN1\nGOTO 1\n").unwrap_err().contains("several blocks"));
    assert!(renumbered("O1\nN1\nGOTO 10\n").unwrap_err().contains("missing"));
    assert!(renumbered("O1\nN1\nGOTO#1\n").unwrap_err().contains("any sequence number"));
    assert!(renumbered("O1\nG66.1 P9000\nN1\n").unwrap_err().contains("argument of every block"));
}

/// Refusal of a renumbering of the program with the cursor.
fn not_renumbered(text: &str) -> String {
    let fixture = fixture(text);
    let key = fixture.project.program_at(fixture.file, fixture.offset).unwrap();
    fixture.project.renumber(key, None, 10, 10).unwrap_err().reason
}

#[test]
fn a_number_to_which_a_shared_subprogram_returns_stays() {
    let others = "//- O101.nc\nO101\nM98 P200\nM30\nN50 M30\n//- O200.nc\nO200\nM99 P50\n";
    let text = format!("//- O100.nc\nO100\nM98 P200\nM30\nN5$00 M30\n{others}");
    let reason = "O0101, which calls O0200 too, returns to its own N50: O0200 line 2";
    assert_eq!(refused(&text, "N60"), reason);
    assert_eq!(not_renumbered(&text), reason);
    // N7 is in no M99 P: each of both programs may have it.
    let free =
        text.replace("N5$00 M30\n//- O101.nc", "N5 M0\nN50 M30\n//- O101.nc").replacen("N5 M0", "N$05 M0", 1);
    assert!(renamed(&free, "N7").contains("N7 M0\nN50 M30\n"), "{}", renamed(&free, "N7"));
}

#[test]
fn a_number_that_an_unknown_cycle_names_stays() {
    let text = "O1\nG18\nG71 U2. R1.\nG71 P15 Q25 U.5 F.2\nN$015 G0 X10.\nN25 G1 Z-30.\nN30 M30\n";
    let reason = "O0001 line 4 may refer to a sequence number by P15: G71 is not known to this control";
    assert_eq!(refused(text, "16"), reason);
    assert_eq!(not_renumbered(text), reason);
    let other = text.replace("$0", "").replace("N30", "N$030");
    assert!(renamed(&other, "40").contains("N40 M30"));
    assert!(refused(&other, "25").contains("Q25"), "a new number that the cycle names");
    let dwell = "O1\nG4 P15\nG83 Z-1. R1. Q15 F9.\nN$015 M30\n";
    assert_eq!(renamed(dwell, "16"), "O1\nG4 P15\nG83 Z-1. R1. Q15 F9.\nN16 M30\n", "no sequence numbers");
}

#[test]
fn a_variable_that_a_message_names_stays() {
    let text = "//- O1.nc\nO1\n#$0140=5.\nG65 P2\nM30\n//- O2.nc\nO2\nX#140\n#3006=1(HEAD TO #140)\nM99\n";
    let reason = "the message of O0002 line 3 names #140: change its text by hand first";
    assert_eq!(refused(text, "#150"), reason);
    let other = text.replace("TO #140", "TO #1401");
    assert!(renamed(&other, "#150").contains("X#150\n#3006=1(HEAD TO #1401)"));
}
