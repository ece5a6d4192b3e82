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

/// A program with the conditions of its run, and its expected conclusion.
#[derive(Clone, Copy, Default)]
struct Row<'r> {
    program: &'r str,
    flags: &'r str,
    answer: &'r str,
    outcome: &'r str,
    /// Start of the summary.
    summary: &'r str,
    exit: i32,
}

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
fn compare(place: &Path, arguments: &str, expected: &Row<'_>) {
    let Row { answer, outcome, summary, exit, .. } = expected;
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
fn drawn_verdict(Row { program, flags, .. }: &Row<'_>) -> (HoleStatus, String) {
    let mut request = Request::new("O1.nc", program.as_bytes(), Machine::default());
    match flags.split_once(' ') {
        Some(("--max-blocks", blocks)) => request.limits = Limits { blocks: blocks.parse().unwrap() },
        Some(("--control", setting)) => {
            let (key, value) = setting.split_once('=').unwrap();
            request.settings.set(key, value).unwrap();
        }
        Some(("--deny", _)) => request.denies_assumptions = true,
        _ => {}
    }
    let reference = NominalPart::parse(REFERENCE).unwrap().into_holes().unwrap();
    let simulation = simulate(&request, &mut NoLibrary, None).unwrap();
    let verdict = simulation.verify(&reference, Tolerances::of(&reference, None), &request);
    top::of_verdict("O1.nc", &simulation, &reference, &verdict, &request.machine).verdict.unwrap()
}

/// Compares the picture's words and the page's head too, which only holes have.
fn compare_holes(row: &Row<'_>) {
    let (status, line) = drawn_verdict(row);
    assert_eq!(status == HoleStatus::Good, row.answer == "PASS", "{line}");
    assert!(line.starts_with(&format!("{}: {}", row.answer, row.summary)), "{line}");
    let place = tempfile::tempdir().unwrap();
    std::fs::write(place.path().join("O1.nc"), row.program).unwrap();
    std::fs::write(place.path().join("r.csv"), REFERENCE).unwrap();
    let arguments = format!("O1.nc --reference r.csv {}", row.flags);
    compare(place.path(), &arguments, row);
    let (_, code) = run(&format!("gcode-sim verify {arguments} --page O1.html"), place.path());
    assert_eq!(code, row.exit);
    let page = std::fs::read_to_string(place.path().join("O1.html")).unwrap();
    let (class, other) = if row.answer == "PASS" { ("yes", "no") } else { ("no", "yes") };
    let start = format!("<p class=\"answer {class}\">{}, {}", row.answer, row.summary);
    assert!(page.contains(&start), "{start}");
    assert!(!page.contains(&format!("<p class=\"answer {other}\">")), "one answer alone");
}

/// The lines of the program: 6 drills the first hole, 8 the second, 11 ends it.
#[test]
fn each_conclusion_is_the_same_everywhere() {
    let right = &program("S1000 M03", "X10.", "");
    let pass = Row { program: right, answer: "PASS", outcome: "end", ..Row::default() };
    let fail = Row { answer: "FAIL", exit: 1, ..pass };
    let stopped = Row { answer: "FAIL", outcome: "alarm", exit: 3, ..pass };
    let aside = &program("S1000 M03", "X10.2", "");
    let standing = &program("", "X10.", "");
    let one_hole = &program("S1000 M03", "X10.", "M30");
    let twice = &program("S1000 M03", "X10.", "X10.");
    let divided = &program("S1000 M03", "X10.", "#1=1/0");
    let divided_late = &right.replace("M30", "#1=1/0\nM30");
    let common = &right.replace("X30.", "X[30.+#510]");
    let endless = &right.replace("M30\n", "");
    let cut_off = &format!("%\n{endless}");
    for row in [
        // Nothing judges what the default machine doesn't know.
        Row { summary: "2 of 2 holes in tolerance; not checked: diameters, ", ..pass },
        // Φ0.4 of Φ0.1.
        Row { program: aside, summary: "1 of 2 holes in tolerance", ..fail },
        Row { program: one_hole, summary: "1 of 2 holes in tolerance, 1 missing", ..fail },
        Row { program: "O0001\nM30\n", summary: "0 of 2 holes in tolerance, 2 missing", ..fail },
        Row {
            program: standing,
            summary: "a feed with the spindle stopped (2 times); 2 of 2 holes in tolerance",
            ..fail
        },
        Row {
            program: twice,
            summary: "2 of 2 holes in tolerance; warnings: hole-twice; not checked: ",
            ..pass
        },
        Row { program: common, summary: "2 of 2 holes in tolerance; assumes #510; not checked: ", ..pass },
        Row {
            program: common,
            flags: "--deny assumptions",
            summary: "1 assumption is denied; 2 of 2 holes in tolerance; not checked: ",
            ..fail
        },
        Row {
            program: endless,
            summary: "the program ends without M02, M30 or M99; 2 of 2 holes in tolerance",
            ..fail
        },
        Row {
            program: cut_off,
            summary: "alarm PS5010 in O0001 line 11: the program ends without ",
            ..stopped
        },
        Row {
            program: divided,
            summary: "alarm PS0112 in O0001 line 7: division by zero; 1 of 2 holes in tolerance, 1 missing",
            ..stopped
        },
        Row {
            program: divided_late,
            summary: "alarm PS0112 in O0001 line 11: division by zero; 2 of 2 holes in tolerance",
            ..stopped
        },
        // The second hole is beyond the stroke.
        Row { flags: "--control 1320=X25", summary: "alarm OT0500 in O0001 line 8: ", ..stopped },
        Row {
            flags: "--max-blocks 6",
            outcome: "limit",
            summary: "the program has not ended after 6 blocks and ",
            ..stopped
        },
    ] {
        compare_holes(&row);
    }
}

/// The sheet of a job states what `verify` states of its programs.
#[test]
fn a_sheet_states_the_verdict() {
    let place = tempfile::tempdir().unwrap();
    let place = place.path();
    for line in [
        "gcode-gen new pin-holes -o job.toml",
        "gcode-gen emit job.toml --out nc",
        "gcode-gen sheet job.toml -o sheet.html",
    ] {
        assert_eq!(run(line, place).1, 0, "{line}");
    }
    let line = "gcode-sim verify nc/O8100.nc --machine nc/machine.toml --reference job.toml --format json";
    let verdict: Value = serde_json::from_str(&run(line, place).0).unwrap();
    let sheet = std::fs::read_to_string(place.join("sheet.html")).unwrap();
    let words = verdict["summary"].as_str().unwrap();
    assert!(
        sheet.contains(&format!("<b>PASS. Predicted by simulation, not measured. </b>{words}")),
        "{words}"
    );
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
    let failed = Some((HoleStatus::Bad, format!("FAIL: {sentence}")));
    assert_eq!(top::of_holes("O1.nc", &simulation, &machine, &[]).verdict, failed);
}

/// Flutes have the same conclusion in every output.
#[test]
fn a_verdict_on_flutes_is_the_same_everywhere() {
    let folder = workspace().join("tests/suite/verify");
    let pass = Row { answer: "PASS", outcome: "end", summary: "4 of 4 flutes ground", ..Row::default() };
    let fail = Row { answer: "FAIL", outcome: "end", exit: 1, ..Row::default() };
    for (case, expected) in [("four_flutes_of_a_burr_pass", pass), ("a_missing_flute_is_counted", fail)] {
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

/// A page shows holes. A burr that is named is refused; one that the project names for the program is left out, and said.
#[test]
fn a_page_leaves_out_the_burr_of_a_project() {
    let place = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(place.path().join(name), text).unwrap();
    let burr = std::fs::read_to_string(workspace().join("tests/suite/verify/burr.toml")).unwrap();
    write("burr.toml", &burr);
    write("O1.nc", &program("S1000 M03", "X10.", ""));
    let page = |arguments: &str| {
        let done = run_line(&format!("gcode-sim page O1.nc -o O1.html {arguments}"), place.path());
        (String::from_utf8(done.stderr).unwrap(), done.status.code().unwrap())
    };
    let (text, code) = page("--reference burr.toml");
    assert_eq!(code, 2);
    assert!(text.contains("the reference is a burr: omit the reference"), "{text}");
    write("gcode.toml", "[references]\n\"O1.nc\" = \"burr.toml\"\n");
    let (text, code) = page("");
    assert_eq!(code, 0, "{text}");
    assert!(text.contains("is a burr: the page has no verdict"), "{text}");
    assert!(!std::fs::read_to_string(place.path().join("O1.html")).unwrap().contains("class=\"answer"));
}

/// A blank of 100 by 70 by 8, of which the program may mill a strip 5 wide along x = 0.
const BLANK: &str = "[head]\nkind = \"fixed\"\ndirection = [0, 0, 1]\n\n[[tool]]\nnumber = 1\nkind = \"end-mill\"\n\
                     diameter = 10\nlength = 100\n\n[stock]\nkind = \"box\"\nmin = [-5, -5, -8]\nmax = [95, 65, 0]\n\n\
                     [[stock.pocket]]\nkind = \"box\"\nmin = [-20, -20, -10]\nmax = [0, 80, 0]\n";

/// Mills along x = -5 with the mill of 10, up to the wall x = 0, and goes back by `back` inside the strip.
fn milled_strip(back: &str) -> String {
    format!(
        "O0001\nG90 G54 G17 G21\nT1 M06\nS3000 M03\nG00 G43 H1 Z50.\nX-5. Y-15.\nZ2.\nG01 Z-8. F300.\nY75.\n{back}\nG00 Z50.\nM30\n"
    )
}

/// Without a reference `verify` judges the motion in the stated stock; every output and every command states the same.
#[test]
fn a_verdict_on_motion_alone_is_the_same_everywhere() {
    let judged = "the motion in the stated stock is judged, no hole is compared (no reference)";
    let pass = Row { answer: "PASS", outcome: "end", ..Row::default() };
    let fail = Row { answer: "FAIL", exit: 1, ..pass };
    let milled = |lines: &str| format!("{judged}; not checked: the shape of the milling (O0001 {lines})");
    let beside = format!("a feed outside the stated pockets; {judged}");
    let rapid = format!("a rapid through the part (2 times); {judged}");
    let alarm = format!("alarm PS0112 in O0001 line 10: division by zero; {judged}");
    for row in [
        Row { program: &milled_strip("X-15."), summary: &milled("line 9"), ..pass },
        // The mill reaches to x = 1 at x = -4.
        Row { program: &milled_strip("G01 X-4. Y50."), summary: &beside, ..fail },
        // Across at Z-8. into the metal, and up through it.
        Row { program: &milled_strip("G00 X50. Y30."), summary: &rapid, ..fail },
        Row { program: &milled_strip("#1=1/0"), summary: &alarm, outcome: "alarm", exit: 3, ..fail },
    ] {
        let place = tempfile::tempdir().unwrap();
        std::fs::write(place.path().join("O1.nc"), row.program).unwrap();
        std::fs::write(place.path().join("machine.toml"), BLANK).unwrap();
        compare(place.path(), "O1.nc", &row);
        let heading = format!("{}, {}", row.answer, row.summary);
        for line in ["gcode-sim verify O1.nc --page O1.html", "gcode-sim page O1.nc -o O1.html"] {
            assert_eq!(run(line, place.path()).1, row.exit, "{line}");
            let page = std::fs::read_to_string(place.path().join("O1.html")).unwrap();
            assert!(page.contains(&heading), "{line}: {heading}");
        }
        assert_eq!(run("gcode-sim sheet O1.nc -o sheet.html", place.path()).1, row.exit);
        let sheet = std::fs::read_to_string(place.path().join("sheet.html")).unwrap();
        // On the sheet the summary is a sentence.
        let (first, rest) = row.summary.split_at(1);
        let summary = format!("{}{rest}", first.to_uppercase());
        let answer = format!("<b>{}. </b>Predicted by simulation, not measured. {summary}", row.answer);
        assert!(sheet.contains(&answer), "{answer}");
    }
}

/// Without a reference a program that makes a hole fails, and has a picture and a page without a verdict; without a stock nothing
/// can be judged.
#[test]
fn without_a_reference_a_stock_is_required_and_no_hole_passes() {
    let drilled = milled_strip("G00 Z50.\nX40. Y30.\nG98 G81 Z-3. R2. F90.\nG80");
    let place = tempfile::tempdir().unwrap();
    std::fs::write(place.path().join("O1.nc"), drilled).unwrap();
    std::fs::write(place.path().join("machine.toml"), BLANK).unwrap();
    let (text, code) = run("gcode-sim verify O1.nc", place.path());
    assert!(
        text.contains("\nFAIL     1 hole that no reference has; the motion in the stated stock "),
        "{text}"
    );
    assert_eq!(code, 1);
    let (drawn, code) = run("gcode-sim render O1.nc -o O1.png --size 480x360 --format json", place.path());
    let drawn: Value = serde_json::from_str(&drawn).unwrap();
    assert_eq!((&drawn["verdict"], code), (&Value::Null, 0));

    let (head, _) = BLANK.split_once("[stock]").unwrap();
    std::fs::write(place.path().join("machine.toml"), head).unwrap();
    let done = run_line("gcode-sim verify O1.nc", place.path());
    let message = String::from_utf8(done.stderr).unwrap();
    assert_eq!(done.status.code(), Some(2));
    assert!(message.contains("error: no reference: give --reference REF"), "{message}");
    assert!(message.contains("state [stock] in the machine file"), "{message}");
}
