//! Assumptions: every outside value that touches a hole is listed, in every output, and can be denied.
use std::fmt::Write as _;
use std::path::Path;

use gcode_control::{Limits, Outcome};
use gcode_inspect::machine::Machine;
use gcode_lang::program::NoLibrary;
use gcode_part::Assumption;
use gcode_session::{Request, simulate};
use gcode_tests::programs::run_line;
use proptest::prelude::*;
use serde_json::{Value, json};

/// Three holes; #510, vacant, counts as absent: Y of the second stays 20.
const PROGRAM: &str = "O0001\nG90 G54 G17 G21 G98\nS1000 M03\nG00 X0. Y0.\nZ50.\nG81 X10. Y20. Z-10. R2. F100.\n\
                       X30. Y#510\nX50. Y20.\nG80\nZ50.\nM30\n";

/// Three holes of a plate.
const REFERENCE: &str =
    "id,x,y,z,i,j,k,depth,diameter\na,10,20,0,0,0,1,10,6\nb,30,20,0,0,0,1,10,6\nc,50,20,0,0,0,1,10,6\n";

/// Runs a line in a folder and returns its standard output and its exit code.
fn run(line: &str, place: &Path) -> (String, i32) {
    let done = run_line(line, place);
    (String::from_utf8(done.stdout).unwrap(), done.status.code().unwrap())
}

fn run_json(line: &str, place: &Path) -> (Value, i32) {
    let (text, code) = run(line, place);
    (serde_json::from_str(&text).unwrap(), code)
}

/// Writes a program and the reference to a new folder.
fn folder(program: &str) -> tempfile::TempDir {
    let place = tempfile::tempdir().unwrap();
    std::fs::write(place.path().join("O1.nc"), program).unwrap();
    std::fs::write(place.path().join("r.csv"), REFERENCE).unwrap();
    place
}

#[test]
fn every_output_lists_the_value_and_the_hole_that_it_decides() {
    let place = folder(PROGRAM);
    let place = place.path();
    let expected = |hole: &str| json!([{"what": "#510", "value": null, "place": {"program": "O0001", "line": 7}, "decides": [hole]}]);
    let (verdict, code) = run_json("gcode-sim verify O1.nc --reference r.csv --format json", place);
    assert_eq!((&verdict["assumptions"], &verdict["verdict"], code), (&expected("b"), &json!("pass"), 0));
    let (holes, code) = run_json("gcode-sim holes O1.nc --format json", place);
    assert_eq!((&holes["assumptions"], code), (&expected("2"), 0));
    let (state, code) = run_json("gcode-sim run O1.nc --format json", place);
    assert_eq!((&state["assumptions"], code), (&expected("2"), 0));

    let line = "#510 = vacant (O0001 line 7) decides hole";
    for (command, expected) in [
        ("gcode-sim verify O1.nc --reference r.csv", format!("assumes  {line} b\n")),
        ("gcode-sim holes O1.nc", format!("assumes  {line} 2\n")),
        ("gcode-sim run O1.nc", format!("assumes    {line} 2\n")),
    ] {
        let (text, code) = run(command, place);
        assert!(text.contains(&expected) && code == 0, "{command}: {text}");
    }
    assert_eq!(run("gcode-sim verify O1.nc --reference r.csv --page O1.html", place).1, 0);
    let page = std::fs::read_to_string(place.join("O1.html")).unwrap();
    assert!(page.contains(&format!("Assumes {line} b")), "the page");
    assert_eq!(run("gcode-sim holes O1.nc --page O1.html", place).1, 0);
    let page = std::fs::read_to_string(place.join("O1.html")).unwrap();
    assert!(page.contains(&format!("Assumes {line} 2")), "the page without a reference");
}

/// The list of holes that a program makes is a reference as it stands.
#[test]
fn a_list_of_holes_with_assumptions_is_a_reference() {
    let place = folder(PROGRAM);
    let (list, _) = run("gcode-sim holes O1.nc --format json", place.path());
    std::fs::write(place.path().join("list.json"), list).unwrap();
    assert_eq!(run("gcode-sim verify O1.nc --reference list.json", place.path()).1, 0);
}

#[test]
fn a_value_that_the_program_sets_or_the_user_states_is_named_as_it_is() {
    // The program sets #510 before it reads it.
    let place = folder(&PROGRAM.replace("S1000 M03", "S1000 M03 \n#510=20."));
    let (verdict, code) =
        run_json("gcode-sim verify O1.nc --reference r.csv --deny assumptions --format json", place.path());
    assert_eq!((&verdict["assumptions"], code), (&json!([]), 0));
    // --set is an assumption too: nothing in the program sets it.
    let place = folder(PROGRAM);
    let (verdict, code) =
        run_json("gcode-sim verify O1.nc --reference r.csv --set #510=20 --format json", place.path());
    let found = &verdict["assumptions"][0];
    assert_eq!(
        (&found["what"], &found["value"], &found["decides"], code),
        (&json!("#510"), &json!(20.0), &json!(["b"]), 0)
    );
}

/// The holes are 25.4 times too far in inches.
#[test]
fn the_unit_of_power_on_is_an_assumption_unless_it_is_stated() {
    let program = PROGRAM.replace(" G21", "").replace("S1000 M03", "S1000 M03 \n#510=20.");
    let place = folder(&program);
    let verify = |flags: &str| {
        let line = format!("gcode-sim verify O1.nc --reference r.csv --format json{flags}");
        let (verdict, code) = run_json(&line, place.path());
        let assumed: Vec<_> = verdict["assumptions"].as_array().unwrap().iter().collect();
        (assumed.iter().map(|one| one["what"].as_str().unwrap().to_owned()).collect::<Vec<_>>(), code)
    };
    assert_eq!(verify(""), (vec!["G21".to_owned()], 0));
    assert_eq!(verify(" --control INI=0"), (vec![], 0));
    assert_eq!(verify(" --control INI=1"), (vec![], 1));
    for (unit, code) in [("metric", 0), ("inch", 1)] {
        let machine = format!("[control]\nunit = \"{unit}\"\n");
        std::fs::write(place.path().join("m.toml"), machine).unwrap();
        assert_eq!(verify(" --machine m.toml"), (vec![], code), "{unit}");
    }
}

#[test]
fn a_denied_assumption_fails_everywhere() {
    let place = folder(PROGRAM);
    let place = place.path();
    let line = "gcode-sim verify O1.nc --reference r.csv --deny assumptions";
    let (verdict, code) = run_json(&format!("{line} --format json"), place);
    assert_eq!((&verdict["verdict"], code), (&json!("fail"), 1));
    let summary = "1 assumption is denied; 3 of 3 holes in tolerance; not checked: diameters, the tool's length \
                   (no length offset), head angles, motion beside the holes (no stock)";
    assert_eq!(verdict["summary"], summary);
    assert_eq!(verdict["findings"][0]["code"], "assumption");
    let (text, code) = run(line, place);
    assert!(text.contains(&format!("FAIL     {summary}\n")), "{text}");
    assert_eq!(code, 1);
    let (sarif, code) = run_json(&format!("{line} --format sarif"), place);
    assert_eq!(sarif["runs"][0]["results"][0]["ruleId"], "assumption");
    assert_eq!(code, 1);
    let (drawn, code) = run_json(
        "gcode-sim render O1.nc --reference r.csv --deny assumptions -o O1.png --size 480x360 --format json",
        place,
    );
    assert_eq!((&drawn["summary"], code), (&verdict["summary"], 1));
    for command in ["holes O1.nc", "run O1.nc", "render O1.nc -o O1.png --size 480x360"] {
        assert_eq!(run(&format!("gcode-sim {command} --deny assumptions"), place).1, 1, "{command}");
    }
}

#[test]
fn an_alarm_stands_before_denied_assumptions() {
    let place = folder(&PROGRAM.replace("M30", "#1=1/0\nM30"));
    let line = "gcode-sim verify O1.nc --reference r.csv --deny assumptions --format json";
    let (verdict, code) = run_json(line, place.path());
    let summary = verdict["summary"].as_str().unwrap();
    let start = "alarm PS0112 in O0001 line 11: division by zero; 1 assumption is denied; ";
    assert!(summary.starts_with(start), "{summary}");
    assert_eq!(code, 3);
}

#[test]
fn a_program_without_assumptions_passes_where_they_are_denied() {
    let place = folder(&PROGRAM.replace("Y#510", "Y[10.*2.]"));
    for command in [
        "verify O1.nc --reference r.csv",
        "holes O1.nc",
        "run O1.nc",
        "render O1.nc -o O1.png --size 480x360",
    ] {
        let line = format!("gcode-sim {command} --deny assumptions");
        assert_eq!(run(&line, place.path()).1, 0, "{command}");
    }
}

/// A tool length is an assumption unless the machine file states it.
#[test]
fn a_machine_file_states_tool_lengths_and_work_offsets() {
    let place = folder(
        &PROGRAM.replace("Y#510", "Y20.").replace("G54", "G55").replace("Z50.\nG81", "G43 H1 Z50.\nG81"),
    );
    let place = place.path();
    let machine = "[head]\nkind = \"fixed\"\ndirection = [0.0, 0.0, 1.0]\n";
    std::fs::write(place.join("bare.toml"), machine).unwrap();
    let stated = format!(
        "{machine}[offsets]\nG55 = {{ X = 0.0, Y = 0.0, Z = 0.0 }}\n[[tool]]\nnumber = 1\ndiameter = 6.0\nlength = 100.0\n"
    );
    std::fs::write(place.join("stated.toml"), stated).unwrap();
    let line = |machine: &str| format!("gcode-sim holes O1.nc --machine {machine}.toml --format json");
    let (bare, _) = run_json(&line("bare"), place);
    let names: Vec<&Value> = bare["assumptions"].as_array().unwrap().iter().map(|one| &one["what"]).collect();
    assert_eq!(names, ["G55", "H1"]);
    let (stated, _) = run_json(&line("stated"), place);
    assert_eq!(stated["assumptions"], json!([]));
}

/// A comment does not hide a block skip, and a sign does not hide a computed H.
#[test]
fn comments_and_signs_do_not_hide_an_outside_value() {
    for (block, expected) in
        [("(R=5) /X30. Y20.", "/"), ("(A[3) /X30. Y20.", "/"), ("G43 H-#1 X30. Y20.", "H3")]
    {
        let program = PROGRAM.replace("X30. Y#510", block).replace("S1000", "#1=-3\nS1000");
        let place = folder(&program);
        let (holes, _) = run_json("gcode-sim holes O1.nc --format json", place.path());
        assert_eq!(holes["assumptions"][0]["what"], expected, "{block}: {holes}");
    }
}

/// With another value the run drills a hole that this run does not.
#[test]
fn a_value_that_keeps_the_run_from_a_hole_is_listed() {
    let program = "O1\nG90 G54 G17 G21 G98\nS1000 M03\nG00 X0. Y0.\nZ50.\nIF[#510NE1]GOTO9\nG81 X10. Y20. Z-10. R2. F100.\n\
                   G80\nN9 Z50.\nM30\n";
    let place = folder(program);
    let (holes, _) = run_json("gcode-sim holes O1.nc --format json", place.path());
    let expected =
        json!([{"what": "#510", "value": null, "place": {"program": "O0001", "line": 6}, "decides": []}]);
    assert_eq!((&holes["holes"], &holes["assumptions"]), (&json!([]), &expected));
    let (text, _) = run("gcode-sim holes O1.nc", place.path());
    assert!(text.contains("decides what is cut"), "{text}");
}

/// `test` states what `verify` does: hole b depends on #510, which is denied.
#[test]
fn a_case_of_test_lists_its_assumptions_and_fails_where_they_are_denied() {
    let place = folder(PROGRAM);
    let place = place.path();
    std::fs::rename(place.join("r.csv"), place.join("reference.csv")).unwrap();
    assert_eq!(run("gcode-sim test . --accept", place).1, 0);
    let (verdict, _) = run_json("gcode-sim verify O1.nc --reference reference.csv --format json", place);
    let (report, code) = run_json("gcode-sim test . --format json", place);
    let case = &report["cases"][0];
    assert_eq!((&case["verdict"]["assumptions"], code), (&verdict["assumptions"], 0));
    let line = format!("PASS: {}", verdict["summary"].as_str().unwrap());
    assert_eq!(case["verdict"]["summary"], line);
    let (text, _) = run("gcode-sim test .", place);
    assert!(text.contains("\nassumes  .: #510 = ") || text.starts_with("assumes  .: #510 = "), "{text}");
    let (report, code) = run_json("gcode-sim test . --deny assumptions --format json", place);
    assert_eq!((&report["cases"][0]["against"]["code"], code), (&json!("assumption"), 1));
    // Without a reference too, once its loss is accepted.
    std::fs::remove_file(place.join("reference.csv")).unwrap();
    assert_eq!(run("gcode-sim test .", place).1, 1);
    assert_eq!(run("gcode-sim test . --accept", place).1, 0);
    assert_eq!(run("gcode-sim test .", place).1, 0);
    assert_eq!(run("gcode-sim test . --deny assumptions", place).1, 1);
    std::fs::write(place.join("O1.nc"), PROGRAM.replace("Y#510", "Y20.")).unwrap();
    assert_eq!(run("gcode-sim test . --accept --deny assumptions", place).1, 0);
}

/// The angle of the third flute depends on #510, those of the others don't.
#[test]
fn an_assumption_decides_a_flute() {
    let suite = gcode_tests::workspace().join("tests/suite/verify");
    let program = std::fs::read_to_string(suite.join("four_flutes_of_a_burr_pass/case.nc")).unwrap();
    let reads = program.replace("#5=#1*90\n", "#5=#1*90\nIF[#1 EQ 2]THEN #5=#5+#510\n");
    assert_ne!(program, reads);
    let place = folder(&program);
    let place = place.path();
    std::fs::write(place.join("O2.nc"), reads).unwrap();
    let file = |name: &str| suite.join(name).display().to_string();
    let flags = format!("--machine {} --reference {}", file("grinder.toml"), file("burr.toml"));
    let expected =
        json!([{"what": "#510", "value": null, "place": {"program": "O8400", "line": 8}, "decides": ["3"]}]);
    let summary = "4 of 4 flutes ground";
    for (name, assumptions, words, denied) in
        [("O1", json!([]), summary.to_owned(), 0), ("O2", expected, format!("{summary}; assumes #510"), 1)]
    {
        let (verdict, code) = run_json(&format!("gcode-sim verify {name}.nc {flags} --format json"), place);
        assert_eq!((&verdict["assumptions"], &verdict["summary"], code), (&assumptions, &json!(words), 0));
        let (text, _) = run(&format!("gcode-sim verify {name}.nc {flags}"), place);
        let line = "assumes  #510 = vacant (O8400 line 8) decides flute 3\n";
        assert_eq!(text.contains(line), denied == 1, "{text}");
        for command in ["verify", "render -o b.png --size 480x360"] {
            let line = format!("gcode-sim {command} {name}.nc {flags} --deny assumptions");
            assert_eq!(run(&line, place).1, denied, "{line}");
        }
    }
}

/// A block or two of a program: its kind, and what chooses its numbers.
type Choice = (u8, u8, u8, u8);

/// Returns a number that may depend on #510.
fn number(choice: u8) -> String {
    match choice % 7 {
        0 => "#100".to_owned(),
        1 => "#101".to_owned(),
        2 => "#510".to_owned(),
        3 => "[#510*7.]".to_owned(),
        4 => "[#100+#101]".to_owned(),
        _ => format!("{}.", 5 * (choice / 7 % 5)),
    }
}

/// Returns a program that drills, and reads #510 and a block skip.
fn program(choices: &[Choice]) -> String {
    let mut text = String::from(
        "O1\nG90 G54 G17 G21 G98 S1000 M03\nG0 X0. Y0. Z20. B0\n#100=0\n#101=10.\n#102=40.\n#103=18.\nG81 X60. Y60. Z-5. R2. F100.\n",
    );
    let mut labels: Vec<(usize, usize)> = Vec::new();
    for (index, (kind, a, b, c)) in choices.iter().enumerate() {
        let (first, second, small) = (number(*a), number(*b), c % 4);
        // No two blocks lead to the same place, where their holes would be one.
        let place = |number: &str| format!("[{number}*100.+{index}*1.37]");
        let (x, y) = (place(&first), place(&second));
        let lines = match kind % 24 {
            0 => format!("#100={first}"),
            1 => format!("#101={first}"),
            2 => format!("G81 X{x} Y{y} Z-5. R2. F100."),
            3 => format!("X{x}"),
            4 => format!("Y{y}"),
            5 => "G80".to_owned(),
            6 => format!("G0 X{x} Y{y} Z20."),
            7 => "G91 X50.\nG90".to_owned(),
            8 | 9 => {
                labels.push((index + 1 + usize::from(small), 100 + index));
                format!("IF[{first}GT{small}.]GOTO{}", 100 + index)
            }
            10 => {
                format!("#1=0\nWHILE[#1LT{first}]DO1\n#1=#1+1\n#102=#102+1\nX[#102*100.+{index}*1.37]\nEND1")
            }
            11 => format!("G65 P2 A{x} B{y}"),
            12 => "M98 P3".to_owned(),
            13 => format!("/X{x}"),
            14 => format!("IF[{first}EQ{small}.]THEN #100={second}"),
            15 => format!("G52 X[{first}*100.]"),
            16 => "G1 Z-4. F100.\nG0 Z20.".to_owned(),
            17 => format!("G81 X{x} Y5. Z-[3.+{second}] R2. F100."),
            18 => format!("#[100+#510]={second}"),
            19 => format!("#[100+{}]={second}", small % 2),
            20 => format!("G68 X0. Y0. R{first}"),
            21 => "G69".to_owned(),
            22 => format!("G91 X50. K{first}\nG90"),
            _ => format!("G99 G82 X{x} R[{second}+1.] Z-6. P100 F100.\n/2 Y9.\nG98"),
        };
        _ = writeln!(text, "{lines}");
        for (_, label) in labels.iter().filter(|(at, _)| *at == index) {
            _ = writeln!(text, "N{label}");
        }
    }
    for (_, label) in labels.iter().filter(|(at, _)| choices.len() <= *at) {
        _ = writeln!(text, "N{label}");
    }
    text.push_str(
        "G80\nM30\nO2\nG0 X#1 Y#2 Z20.\nG81 X#1 Z-6. R2. F100.\nG80\nM99\nO3\n#101=#101+5.\n#103=#103+0.6\nX[#101*100.+#103] Y5.\nM99\n",
    );
    text
}

/// Holes of a run: entry and bottom in µm.
type Made = Vec<[i64; 6]>;

/// Returns true if a run makes this hole, or goes on below it: another block then drills there too.
fn has_hole(made: &Made, points: &[i64; 6]) -> bool {
    let is_deeper =
        |other: &[i64; 6]| points[..2] == other[..2] && points[2] <= other[2] && other[5] < points[5];
    made.iter().any(|other| points == other || is_deeper(other))
}

/// Returns the holes of a run that comes to its end, and what it assumes.
fn holes(text: &str, variable: Option<f64>, skips: bool) -> Option<(Made, Vec<Assumption>)> {
    let mut request = Request::new("O1.nc", text.as_bytes(), Machine::default());
    request.variables.extend(variable.map(|value| (510, value)));
    request.settings.skip_switches[0] = skips;
    request.limits = Limits { blocks: 5000 };
    let simulation = simulate(&request, &mut NoLibrary, None).unwrap();
    if !matches!(simulation.run.outcome, Outcome::End) {
        return None;
    }
    let made = simulation.extracted.holes.iter().map(|hole| {
        let (entry, bottom) = (hole.entry, hole.bottom());
        let points = [entry.x, entry.y, entry.z, bottom.x, bottom.y, bottom.z];
        points.map(|value| (value * 1000.0).round() as i64)
    });
    let made = made.collect();
    let assumed = simulation.dependencies(&request).numbered(&simulation.run);
    Some((made, assumed.into_iter().map(|(assumption, _)| assumption).collect()))
}

proptest! {
    /// A hole that another value of #510 or another position of the switch changes is listed for it.
    #[test]
    fn a_hole_that_a_value_touches_is_listed(
        choices in prop::collection::vec(any::<Choice>(), 1..14),
        value in prop::option::of(0u8..4),
        other in prop::option::of(0u8..4),
        skips in any::<bool>(),
        switches in any::<bool>(),
    ) {
        let text = program(&choices);
        let (value, other) = (value.map(f64::from), other.map(f64::from));
        let Some((made, assumed)) = holes(&text, value, skips) else { return Ok(()) };
        let (what, changed) = match switches {
            true => ("/", holes(&text, value, !skips)),
            false => ("#510", holes(&text, other, skips)),
        };
        let Some((changed, _)) = changed else { return Ok(()) };
        let found = assumed.iter().find(|one| one.what == what);
        let decides = found.map(|one| one.decides.as_slice()).unwrap_or_default();
        for (index, hole) in made.iter().enumerate() {
            let is_listed = decides.contains(&(index + 1).to_string());
            prop_assert!(is_listed || has_hole(&changed, hole), "hole {} of\n{text}", index + 1);
        }
        let has_more = changed.iter().any(|hole| !has_hole(&made, hole));
        prop_assert!(found.is_some() || !has_more, "further holes of\n{text}");
    }
}
