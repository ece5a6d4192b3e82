//! Joining alone, without a search for counterexamples.
use std::sync::Arc;
use std::time::Duration;

use gcode_control::Control;
use gcode_lang::control::Settings;
use gcode_lang::program::{Memory, NoLibrary};

use super::*;
use crate::request::Range;

/// Returns the claims that joining alone proves of a program, without any search for counterexamples.
fn proved(program: &str, range: &str, claims: &[&str]) -> Vec<bool> {
    let mut memory = Memory::default();
    memory.load("O1.nc", format!("O1\n{program}M30\n").into_bytes());
    let question = Question {
        ranges: vec![Range::parse(range).unwrap()],
        claims: claims.iter().map(|claim| Claim::parse(claim).unwrap()).collect(),
        max_blocks: 10_000,
        ..Question::default()
    };
    let domain = question.domain();
    let control = Control::new(memory, Settings::default());
    let mut tree = Tree::new(control, NoLibrary, Arc::new(question));
    let watch = Watch::new(&|| Duration::ZERO, Duration::from_secs(5));
    let proved = prove_joined(&mut tree, &domain, (1 << claims.len()) - 1, &watch);
    (0..claims.len()).map(|index| proved >> index & 1 == 1).collect()
}

const BISECTION: &str = "#3=0\n#4=2\n#5=0\nWHILE[#5 LT 12]DO1\n#6=[#3+#4]/2\nIF[#6*#6 LE #1]GOTO1\n#4=#6\nGOTO2\n\
                         N1 #3=#6\nN2 #5=#5+1\nEND1\n";

#[test]
fn joined_paths_keep_the_bracket_of_a_root() {
    // The last width is 2/2^12 = 0.000 488 281 25, and the sum of both ends is below 4.
    let claims = [
        "#3*#3 LE #1",
        "#4*#4 GT #1",
        "#4-#3 LE 0.000488282",
        "#4-#3 LE 0.000488281",
        "#1-#3*#3 LE 0.00195313",
        "#3*#3 LT #1",
        "#1-#3*#3 LE 0.0005",
        "#3 LE 1.97",
        "blocks LE 98",
        "blocks LE 70",
    ];
    let [holds, fails] = [true, false];
    let expected = [holds, holds, holds, fails, holds, fails, fails, fails, holds, fails];
    assert_eq!(proved(BISECTION, "#1=0..3.9", &claims), expected);
}

#[test]
fn a_bracket_that_is_left_at_an_end_of_the_range_is_not_proved() {
    // At #1 = 4 the upper end is 2 to the last turn, and 2·2 isn't above 4; at 5 the root isn't between the ends.
    assert_eq!(proved(BISECTION, "#1=0..4", &["#4*#4 GT #1", "#4*#4 GE #1"]), [false, true]);
    assert_eq!(proved(BISECTION, "#1=0..5", &["#4*#4 GE #1", "#3*#3 LE #1"]), [false, true]);
}

#[test]
fn an_alarm_on_one_joined_path_is_not_lost() {
    let program = "#3=0\n#4=#1\nWHILE[#3 LT 14]DO1\nIF[#4 GE 0.5]GOTO1\n#4=2*#4\nGOTO2\nN1 #4=2-2*#4\nN2 #3=#3+1\nEND1\n\
                   #5=SQRT[#4]\n#6=SQRT[0.999-#4]\n";
    assert_eq!(proved(program, "#1=0..1", &["no-alarm", "alarm PS0119"]), [false, true]);
    let safe = program.replace("0.999", "1");
    assert_eq!(proved(&safe, "#1=0..1", &["no-alarm", "#4 LE 1", "#4 LE 0.999"]), [true, true, false]);
}

#[test]
fn what_one_branch_alone_sets_is_not_joined() {
    let program = "#3=0\nWHILE[#3 LT 3]DO1\nIF[#1 GT #3]THEN #4=1\n#3=#3+1\nEND1\n";
    assert_eq!(proved(program, "#1=0..2", &["#4 EQ 1", "#4 EQ #0"]), [false, false]);
}

#[test]
fn a_root_that_one_path_never_computes_says_nothing_of_its_argument() {
    // From −5 on, each turn adds 0.25: after 12 turns #4 is −5 + 11·0.25 = −2.25.
    let program = "#3=0\n#5=#1\nWHILE[#3 LT 12]DO1\n#4=#5\nIF[#4 LT 0]GOTO1\nIF[SQRT[#4] GT 1.5]GOTO9\n\
                   N1 IF[#5 GE 1]GOTO2\n#5=#5+0.25\nGOTO3\nN2 #5=#5-0.75\nN3 #3=#3+1\nEND1\nN9\n";
    assert_eq!(proved(program, "#1=-5..1", &["#4 GE 0", "#4 GE -5", "#4 LE 1.25"]), [false, true, true]);
}
