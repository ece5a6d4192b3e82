//! One verdict: text, JSON, SARIF, picture, page and exit codes of a run all state the same.
use std::path::Path;

use gcode_control::Limits;
use gcode_draw::HoleStatus;
use gcode_inspect::machine::Machine;
use gcode_inspect::verify::Tolerances;
use gcode_lang::program::NoLibrary;
use gcode_part::NominalPart;
use gcode_session::{Request, simulate};
use gcode_sim::report::top;
use gcode_tests::programs::run_line;
use gcode_tests::workspace;
use serde_json::Value;

/// The expected conclusion of a program.
struct Expected {
    answer: &'static str,
    outcome: &'static str,
    /// Start of the summary.
    summary: &'static str,
    exit: i32,
}

/// More blocks than any of these programs has.
const MANY: u64 = 1000;

/// Two holes of a plate.
const REFERENCE: &str = "id,x,y,z,i,j,k,depth,diameter\n1,10,20,0,0,0,1,10,6\n2,30,20,0,0,0,1,10,6\n";

/// Drills both holes; `before` stands before the first, `between` before the second.
fn program(before: &str, first: &str, between: &str) -> String {
    format!(
        "O0001\nG90 G54 G17 G21 G98\nG00 X0. Y0.\nZ50.\n{before}\nG81 {first} Y20. Z-10. R2. F100.\n{between}\nX30.\n\
         G80\nZ50.\nM30\n"
    )
}

/// Runs a line in a folder and returns its standard output and its exit code.
fn run(line: &str, place: &Path) -> (String, i32) {
    let done = run_line(line, place);
    (String::from_utf8(done.stdout).unwrap(), done.status.code().unwrap())
}

/// Compares all outputs for the program `O1.nc` in a folder with the expected conclusion.
fn compare(place: &Path, arguments: &str, expected: &Expected) {
    let Expected { answer, outcome, summary, exit } = expected;
    let (json, code) = run(&format!("gcode-sim verify {arguments} --format json"), place);
    let json: Value = serde_json::from_str(&json).unwrap();
    let words = json["summary"].as_str().unwrap();
    assert_eq!(json["verdict"].as_str().unwrap(), answer.to_lowercase());
    assert_eq!(json["outcome"], *outcome);
    assert!(words.starts_with(summary), "{words}");
    assert_eq!(code, *exit);

    let (text, code) = run(&format!("gcode-sim verify {arguments}"), place);
    let lines: Vec<&str> =
        text.lines().filter(|line| line.starts_with("PASS") || line.starts_with("FAIL")).collect();
    assert_eq!(lines, [format!("{answer}     {words}")], "{text}");
    assert_eq!(code, *exit);

    let (sarif, code) = run(&format!("gcode-sim verify {arguments} --format sarif"), place);
    let sarif: Value = serde_json::from_str(&sarif).unwrap();
    let invocation = &sarif["runs"][0]["invocations"][0];
    assert_eq!(invocation["exitCodeDescription"], format!("{answer}: {words}"));
    assert_eq!(invocation["exitCode"], *exit);
    assert_eq!(invocation["executionSuccessful"], true);
    assert_eq!(code, *exit);

    let (drawn, code) =
        run(&format!("gcode-sim render {arguments} -o O1.png --size 480x360 --format json"), place);
    let drawn: Value = serde_json::from_str(&drawn).unwrap();
    assert_eq!([&drawn["verdict"], &drawn["summary"]], [&json["verdict"], &json["summary"]]);
    assert_eq!(code, *exit, "render ends as verify does");
}

/// Returns the line of the picture for a program, with its status.
fn drawn_verdict(program: &str, max_blocks: u64) -> (HoleStatus, String) {
    let machine = Machine::default();
    let mut request = Request::new("O1.nc", program.as_bytes(), machine.clone());
    request.limits = Limits { blocks: max_blocks };
    let reference = NominalPart::parse(REFERENCE).unwrap().into_holes().unwrap();
    let simulation = simulate(&request, &mut NoLibrary, None).unwrap();
    let verdict = simulation.verify(&reference, Tolerances::of(&reference, None), &request);
    top::of_verdict("O1.nc", &simulation, &reference, &verdict, &machine).verdict.unwrap()
}

/// Compares the picture's words and the page's head too, which only holes have.
fn compare_holes(program: &str, max_blocks: u64, expected: &Expected) {
    let (status, line) = drawn_verdict(program, max_blocks);
    assert_eq!(status == HoleStatus::Good, expected.answer == "PASS");
    assert!(line.starts_with(&format!("{}: {}", expected.answer, expected.summary)), "{line}");
    let flags = format!("--max-blocks {max_blocks}");
    let place = tempfile::tempdir().unwrap();
    std::fs::write(place.path().join("O1.nc"), program).unwrap();
    std::fs::write(place.path().join("r.csv"), REFERENCE).unwrap();
    let arguments = format!("O1.nc --reference r.csv {flags}");
    compare(place.path(), &arguments, expected);
    let (_, code) = run(&format!("gcode-sim verify {arguments} --page O1.html"), place.path());
    assert_eq!(code, expected.exit);
    let page = std::fs::read_to_string(place.path().join("O1.html")).unwrap();
    let (class, other) = if expected.answer == "PASS" { ("yes", "no") } else { ("no", "yes") };
    let start = format!("<p class=\"answer {class}\">{}, {}", expected.answer, expected.summary);
    assert!(page.contains(&start), "{start}");
    assert!(!page.contains(&format!("<p class=\"answer {other}\">")), "one answer alone");
}

#[test]
fn a_pass_is_a_pass_everywhere() {
    let expected = Expected { answer: "PASS", outcome: "end", summary: "2 of 2 holes in tolerance", exit: 0 };
    compare_holes(&program("S1000 M03", "X10.", ""), MANY, &expected);
}

/// The first hole is off by 0.2 mm: Φ0.4 of Φ0.1.
#[test]
fn a_hole_out_of_position_fails_everywhere() {
    let expected = Expected { answer: "FAIL", outcome: "end", summary: "1 of 2 holes in tolerance", exit: 1 };
    compare_holes(&program("S1000 M03", "X10.2", ""), MANY, &expected);
}

/// Both holes are in place; the spindle stands.
#[test]
fn an_error_in_the_motion_alone_fails_everywhere_and_comes_first() {
    let summary = "a feed with the spindle stopped (2 times); 2 of 2 holes in tolerance";
    let expected = Expected { answer: "FAIL", outcome: "end", summary, exit: 1 };
    compare_holes(&program("", "X10.", ""), MANY, &expected);
}

/// A division by zero stops the control in line 7, behind the first hole.
#[test]
fn an_alarm_is_in_every_output() {
    let summary = "alarm PS0112 in O0001 line 7: division by zero; 1 of 2 holes in tolerance, 1 missing";
    let expected = Expected { answer: "FAIL", outcome: "alarm", summary, exit: 3 };
    compare_holes(&program("S1000 M03", "X10.", "#1=1/0"), MANY, &expected);
}

/// Without a reference nothing is judged, but the list and the picture state that the run has not reached its end.
#[test]
fn an_alarm_is_in_a_list_and_in_a_picture_without_reference() {
    let sentence = "alarm PS0112 in O0001 line 7: division by zero; holes may be missing";
    let text = program("S1000 M03", "X10.", "#1=1/0");
    let place = tempfile::tempdir().unwrap();
    std::fs::write(place.path().join("O1.nc"), &text).unwrap();
    let (list, exit) = run("gcode-sim holes O1.nc", place.path());
    assert!(list.contains(&format!("1 hole, mm, in the part's frame\n{sentence}\n")) && exit == 3, "{list}");
    let (list, exit) = run("gcode-sim holes O1.nc --format json", place.path());
    let list: Value = serde_json::from_str(&list).unwrap();
    assert_eq!((&list["stopped"], exit), (&Value::from(sentence), 3));
    let (list, exit) = run("gcode-sim holes O1.nc --format csv", place.path());
    assert!(list.ends_with(&format!("\n# stopped: {sentence}\n")) && exit == 3, "{list}");
    std::fs::write(place.path().join("O1.csv"), list).unwrap();
    let (_, exit) = run("gcode-sim verify O1.nc --reference O1.csv", place.path());
    assert_eq!(exit, 2, "the list lacks holes");
    let (drawn, exit) = run("gcode-sim render O1.nc -o O1.png --size 480x360 --format json", place.path());
    let drawn: Value = serde_json::from_str(&drawn).unwrap();
    assert_eq!((&drawn["verdict"], &drawn["summary"], exit), (&"fail".into(), &sentence.into(), 3));
    let machine = Machine::default();
    let request = Request::new("O1.nc", text.as_bytes(), machine.clone());
    let simulation = simulate(&request, &mut NoLibrary, None).unwrap();
    assert_eq!(top::of_holes("O1.nc", &simulation, &machine, &[]).lines, [sentence]);
}

/// An alarm behind the last hole leaves all holes in place.
#[test]
fn an_alarm_behind_the_last_hole_fails_everywhere() {
    let summary = "alarm PS0112 in O0001 line 12: division by zero; 2 of 2 holes in tolerance";
    let expected = Expected { answer: "FAIL", outcome: "alarm", summary, exit: 3 };
    let program = program("S1000 M03", "X10.", "").replace("M30", "#1=1/0\nM30");
    compare_holes(&program.replace("\nX30.", "\n\nX30."), MANY, &expected);
}

/// The limit of seven blocks ends the run behind the first hole.
#[test]
fn a_limit_is_in_every_output() {
    let summary = "the program has not ended after 6 blocks and ";
    let expected = Expected { answer: "FAIL", outcome: "limit", summary, exit: 3 };
    compare_holes(&program("S1000 M03", "X10.", ""), 6, &expected);
}

/// Flutes have the same conclusion in every output.
#[test]
fn a_verdict_on_flutes_is_the_same_everywhere() {
    let folder = workspace().join("tests/suite/verify");
    for (case, expected) in [
        (
            "four_flutes_of_a_burr_pass",
            Expected { answer: "PASS", outcome: "end", summary: "4 of 4 flutes ground", exit: 0 },
        ),
        ("a_missing_flute_is_counted", Expected { answer: "FAIL", outcome: "end", summary: "", exit: 1 }),
    ] {
        let place = tempfile::tempdir().unwrap();
        let file = |name: &str| folder.join(name).display().to_string();
        let arguments = format!(
            "{} --machine {} --reference {}",
            file(&format!("{case}/case.nc")),
            file("grinder.toml"),
            file("burr.toml")
        );
        compare(place.path(), &arguments, &expected);
    }
}
