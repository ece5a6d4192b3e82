//! The emitted pin-hole programs on the control: edited by hand, called wrongly, with the printed equation, counted.
use std::path::Path;

use gcode_control::Outcome;
use gcode_gen::check::{Programs, check};
use gcode_gen::families;
use gcode_gen::package::Package;
use gcode_inspect::machine::Machine;
use gcode_inspect::verify::{Answer, Tolerances, Verdict};
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{Event, EventKind, EventSink, Position};
use gcode_part::NominalPart;
use gcode_part::job::Job;
use gcode_session::{Request, Run, run, simulate};

/// The main job of the examples.
fn melon() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/melon-mould/job.toml");
    std::fs::read_to_string(path).unwrap()
}

fn job(text: &str) -> Job {
    Job::parse(text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// The package of a job with the text of its programs changed by hand: O-number, line's mark, from, to.
fn edited(text: &str, changes: &[(u32, &str, &str, &str)]) -> Package {
    let mut package = families::emit(&job(text));
    for (number, mark, from, to) in changes {
        let program = package.programs.iter_mut().find(|program| program.number == *number).unwrap();
        let mut found = false;
        let lines = program.text.lines().map(|line| match line.contains(mark) && line.contains(from) {
            true => {
                found = true;
                line.replace(from, to)
            }
            false => line.to_owned(),
        });
        let changed = lines.collect::<Vec<_>>().join("\n");
        program.text = changed + "\n";
        assert!(found, "no line with {mark} and {from} in O{number}");
    }
    package
}

fn verdict(package: &Package, reference: &str) -> Verdict {
    check(&job(reference), package).unwrap().verdict.into_holes().unwrap()
}

#[test]
fn r_changed_by_hand_moves_the_hole_to_its_right_new_place() {
    for (from, to) in [("1100.", "987.654"), ("420.", "0."), ("760.", "1124.")] {
        let package = edited(&melon(), &[(8100, "G65", &format!("R{from}"), &format!("R{to}"))]);
        let wanted = melon().replace(&format!("radius = {from}0"), &format!("radius = {to}0"));
        assert_ne!(wanted, melon());
        let verdict = verdict(&package, &wanted);
        assert_eq!(verdict.verdict, Answer::Pass, "R{to}: {:?}", verdict.findings);
        assert_eq!(self::verdict(&package, &melon()).verdict, Answer::Fail, "the old places are wrong now");
    }
}

/// Who forgets the head's call gets another setting of the head, not a hole at a wrong angle.
#[test]
fn r_changed_in_the_holes_calls_alone_sets_the_head_again() {
    let package = edited(&melon(), &[(8100, "(HOLE 5)", "R1100.", "R900.")]);
    let wanted = melon();
    let (before, last) = wanted.rsplit_once("radius = 1100.0").unwrap();
    let verdict = verdict(&package, &format!("{before}radius = 900.0{last}"));
    assert_eq!(verdict.verdict, Answer::Pass, "{:?}", verdict.findings);

    let stops = |package: &Package| ran(package, |_| {}).control.stops().len();
    assert_eq!(stops(&edited(&melon(), &[])), 6, "three radii with two tools");
    assert_eq!(stops(&package), 8, "and the changed hole with each tool");
}

fn ran(package: &Package, change: impl Fn(&mut Request)) -> Run {
    let main = package.main().unwrap();
    let machine = Machine::parse(&package.machine).unwrap();
    let mut request = Request::new("O8100.nc", main.text.as_bytes(), machine);
    change(&mut request);
    run(&request, &mut Programs(package), &mut ()).unwrap()
}

/// Equation (8) as printed has √(1 − r²/a²)/b, a number in 1/mm: every hole lies far too low.
#[test]
fn the_printed_equation_8_fails() {
    let right = "#2*SQRT[[#1-#18]*[#1+#18]]/#1";
    let printed = "SQRT[1-#18*#18/[#1*#1]]/#2";
    let package = edited(&melon(), &[(8101, "#24=", right, printed), (8102, "#24=", right, printed)]);
    let checked = check(&job(&melon()), &package).unwrap();
    assert!(checked.refusals.concat().contains("rapid through the part"), "{}", checked.refusals.concat());
    let verdict = checked.verdict.into_holes().unwrap();
    assert_eq!(verdict.verdict, Answer::Fail);
    assert_eq!(verdict.missing, ["1", "2", "3", "4", "5"], "no hole is anywhere near its place");
}

#[test]
fn a_table_that_turns_the_other_way_fails() {
    let mut package = families::emit(&job(&melon()));
    package.machine = package.machine.replace("sign = 1", "sign = -1");
    assert_eq!(verdict(&package, &melon()).verdict, Answer::Fail);
}

/// The smallest job on the machine of the paper, without a machine file, and on controls whose angles
/// count from −180 to 180.
#[test]
fn neither_the_machine_file_nor_the_range_of_atan_changes_the_verdict() {
    let text = melon();
    let reference = NominalPart::from_job(&job(&text)).unwrap().into_holes().unwrap();
    let package = families::emit(&job(&text));
    let main = package.main().unwrap();
    for machine in [Machine::default(), Machine::parse(&package.machine).unwrap()] {
        for signed in [false, true] {
            let mut request = Request::new("O8100.nc", main.text.as_bytes(), machine.clone());
            request.settings.returns_signed_angles = signed;
            let done = simulate(&request, &mut Programs(&package), reference.surface).unwrap();
            let verdict = done.verify(&reference, Tolerances::of(&reference, None), &machine);
            assert_eq!(verdict.verdict, Answer::Pass, "{:?}", verdict.findings);
            assert_eq!(verdict.holes.len(), 5);
        }
    }
}

/// A tool that is longer than the one before by more than V must not stand in the part when it comes.
#[test]
fn a_longer_tool_comes_clear_of_the_part() {
    let longer = melon()
        .replace("radius = 420.0", "radius = 0.0")
        .replacen("length = 0.0", "length = 120.0", 1)
        .replacen("length = 0.0", "length = 180.0", 1);
    let upright = longer.replace("\"normal\"", "\"axial\"");
    assert!(upright.contains("length = 120.0") && upright.contains("length = 180.0"));
    // Of all holes the first alone, at the pole, where the part is highest.
    let first = upright.match_indices("[[hole]]").nth(1).unwrap().0;
    let job = job(&upright[..first]);
    let checked = check(&job, &families::emit(&job)).unwrap();
    assert_eq!(checked.refusals, Vec::<String>::new());
}

/// At the equator an axial hole leaves the part again on the other side of it.
#[test]
fn a_hole_through_a_steep_flank_is_there() {
    let steep = melon().replace("radius = 420.0", "radius = 1158.7");
    let job = job(&steep);
    let checked = check(&job, &families::emit(&job)).unwrap();
    assert_eq!(checked.refusals, Vec::<String>::new());
}

/// A control manages about a thousand macro blocks a second and stands still meanwhile.
#[test]
fn one_more_hole_costs_16_blocks_of_arithmetic() {
    let package = families::emit(&job(&melon()));
    let mut longer = package.clone();
    let main = &mut longer.programs[0].text;
    let call = main.lines().rfind(|line| line.contains("(HOLE 5)")).unwrap().to_owned();
    *main = main.replace(&call, &format!("{call}\n{}", call.replace("W15.2885", "W30.")));
    let blocks = ran(&longer, |_| {}).control.blocks() - ran(&package, |_| {}).control.blocks();
    let (call, title, moves_and_modes, back) = (1, 1, 8, 1);
    assert_eq!(blocks - call - title - moves_and_modes - back, 16, "25 are allowed");
}

/// The nearest and lowest point that a rapid may touch: controls move each axis at its own rate, so a rapid is
/// anywhere in the rectangle between its ends.
struct Rectangles {
    at: Position,
    a: f64,
    b: f64,
    /// The tool has come up from where the simulator's machine begins, in the middle of the part.
    begun: bool,
    lowest: f64,
    rapids: u32,
}

impl EventSink for Rectangles {
    fn event(&mut self, event: &Event<'_>) {
        let to = match &event.kind {
            EventKind::Rapid { to } => {
                let (x, y) = (self.at[0].min(to[0]), self.at[1].min(to[1]));
                if self.begun {
                    self.rapids += 1;
                    // Beside the part at x < 0 never, above it always.
                    self.lowest =
                        self.lowest.min((x.max(0.0) / self.a).powi(2) + (y.max(0.0) / self.b).powi(2));
                }
                self.begun = true;
                to
            }
            EventKind::Feed { to, .. } => to,
            _ => return,
        };
        self.at = *to;
    }
}

#[test]
fn no_rapid_can_touch_the_part_whatever_path_it_takes() {
    // Radii up and down, axial ones among them: the head stays at 90 degrees while the radius changes.
    for (a, b) in [(1158.8, 724.3), (300.0, 900.0), (500.0, 500.0)] {
        let mut text = melon();
        text = text[..text.find("[[hole]]").unwrap()]
            .replace("1158.8", &a.to_string())
            .replace("724.3", &b.to_string());
        for (id, radius) in [0.9, 0.1, 0.95, 0.0, 0.5].iter().enumerate() {
            for (axis, azimuth) in [("axial", 30.0), ("normal", -200.0)] {
                text.push_str(&format!(
                    "[[hole]]\nid = \"{id}{axis}\"\nradius = {}\nazimuth = {azimuth}\naxis = \"{axis}\"\ndiameter = 6\ndepth = 15\n",
                    radius * a
                ));
            }
        }
        let package = families::emit(&job(&text));
        let mut calls: Vec<String> = Vec::new();
        // The same calls in an order nobody would choose.
        let main = &package.programs[0].text;
        let mut text = String::from("O1\nG21\nG90 G94\n");
        calls.extend(main.lines().filter(|line| line.contains("P8101")).map(str::to_owned));
        let half = calls.len() / 2;
        for index in 0..half {
            text.push_str(&format!("{}\n", calls[(index * 7) % half].split_once(' ').unwrap().1));
        }
        text.push_str("M30\n");
        let mut sink = Rectangles { at: Position::default(), a, b, begun: false, lowest: 9.0, rapids: 0 };
        let request = Request::new("O1.nc", text.as_bytes(), Machine::default());
        let done = run(&request, &mut Programs(&package), &mut sink).unwrap();
        assert!(matches!(done.outcome, Outcome::End), "{:?}", done.outcome);
        assert!(sink.rapids > 40, "{} rapids", sink.rapids);
        assert!(sink.lowest > 1.0, "a rapid of a = {a}, b = {b} can reach {} of the surface", sink.lowest);
    }
}

const CALL: &str = "G65 P8101 A100. B80. C2. D15. E200. F10. H0. Q0. R50. U1. V50. W20.";
const HEAD: &str = "G65 P8102 A100. B80. H0. Q0. R50. V50.";

/// Runs one call with one word replaced and answers with the alarm's number and text.
fn refused(before: &str, call: &str, from: &str, to: &str) -> (u16, String) {
    let changed = call.replacen(&format!(" {from}"), to, 1);
    assert_ne!(changed, call, "{from} is not in the call");
    let package = families::emit(&job(&melon()));
    let text = format!("O1\n{before}\n{changed}\nM30\n");
    let request = Request::new("O1.nc", text.as_bytes(), Machine::default());
    let done = run(&request, &mut Programs(&package), &mut ()).unwrap();
    assert_eq!(done.control.moves(), 0, "{changed} moves something before it is refused");
    match done.outcome {
        Outcome::Alarm(stopped) => match stopped.alarm {
            Alarm::UserAlarm { number, text, .. } => (number, text),
            other => panic!("{changed}: {other}"),
        },
        other => panic!("{changed} is not refused: {other:?}"),
    }
}

#[test]
fn a_hole_is_refused_on_the_control_with_a_number_and_a_text() {
    let cases: &[(&str, &str, u16, &str)] = &[
        ("A100.", "", 1, "A MISSING OR NOT POSITIVE"),
        ("A100.", " A-1.", 1, "A MISSING OR NOT POSITIVE"),
        ("B80.", "", 2, "B MISSING OR NOT POSITIVE"),
        ("B80.", " B0.", 2, "B MISSING OR NOT POSITIVE"),
        ("C2.", "", 3, "C MISSING OR NOT POSITIVE"),
        ("C2.", " C-2.", 3, "C MISSING OR NOT POSITIVE"),
        ("D15.", "", 4, "D MISSING OR NOT POSITIVE"),
        ("D15.", " D0.", 4, "D MISSING OR NOT POSITIVE"),
        ("D15.", " D-15.", 4, "D MISSING OR NOT POSITIVE"),
        ("E200.", "", 5, "E MISSING OR NOT POSITIVE"),
        ("F10.", "", 6, "F MISSING OR NOT POSITIVE"),
        ("F10.", " F0.", 6, "F MISSING OR NOT POSITIVE"),
        ("R50.", "", 7, "R MISSING"),
        ("R50.", " R-.001", 8, "R NEGATIVE"),
        ("R50.", " R100.001", 9, "R LARGER THAN A"),
        ("W20.", "", 10, "W MISSING"),
        ("U1.", "", 11, "U MUST BE 1. OR -1."),
        ("U1.", " U.5", 11, "U MUST BE 1. OR -1."),
        ("H0.", "", 12, "H MUST BE 0. OR 1."),
        ("H0.", " H2.", 12, "H MUST BE 0. OR 1."),
        ("Q0.", "", 13, "Q MISSING OR NEGATIVE"),
        ("Q0.", " Q-1.", 13, "Q MISSING OR NEGATIVE"),
        ("V50.", "", 14, "V MUST NOT BE BELOW C"),
        ("V50.", " V1.9", 14, "V MUST NOT BE BELOW C"),
    ];
    for (from, to, number, text) in cases {
        assert_eq!(refused("G21", CALL, from, to), (*number, (*text).to_owned()), "{from} -> {to}");
    }
    for before in ["G20", "G43 H1"] {
        let (number, text) = refused(before, CALL, "W20.", " W21.");
        assert_eq!((number, text.as_str()), (15, "NEEDS G21 G40 G49 G94"), "{before}");
    }
}

#[test]
fn a_head_setting_is_refused_on_the_control_with_a_number_and_a_text() {
    let cases: &[(&str, &str, u16, &str)] = &[
        ("A100.", "", 21, "A MISSING OR NOT POSITIVE"),
        ("B80.", " B-1.", 22, "B MISSING OR NOT POSITIVE"),
        ("R50.", "", 23, "R MISSING"),
        ("R50.", " R-1.", 24, "R NEGATIVE"),
        ("R50.", " R101.", 25, "R LARGER THAN A"),
        ("H0.", "", 26, "H MUST BE 0. OR 1."),
        ("H0.", " H.5", 26, "H MUST BE 0. OR 1."),
        ("Q0.", "", 27, "Q MISSING OR NEGATIVE"),
        ("V50.", "", 28, "V MISSING OR NOT POSITIVE"),
    ];
    for (from, to, number, text) in cases {
        assert_eq!(refused("G21", HEAD, from, to), (*number, (*text).to_owned()), "{from} -> {to}");
    }
    assert_eq!(refused("G20", HEAD, "V50.", " V51.").0, 29);
}

/// Another O8102 in the control, from another maker: the hole is not drilled at its angle.
#[test]
fn a_hole_is_refused_where_the_head_does_not_come_to_its_angle() {
    let mut package = families::emit(&job(&melon()));
    let head = package.programs.iter_mut().find(|program| program.number == 8102).unwrap();
    head.text = "O8102\n#141=12.\nM99\n".to_owned();
    let request = Request::new("O1.nc", format!("O1\nG21\n{CALL}\nM30\n").into_bytes(), Machine::default());
    let done = run(&request, &mut Programs(&package), &mut ()).unwrap();
    let Outcome::Alarm(stopped) = done.outcome else { panic!("{:?}", done.outcome) };
    let Alarm::UserAlarm { number, text, .. } = stopped.alarm else { panic!("{}", stopped.alarm) };
    assert_eq!((number, text.as_str()), (16, "HEAD NOT AT ANGLE FOR R"));
    assert_eq!(done.control.moves(), 0);
}

/// Half an increment of 0.01 degrees over 150 mm is 0.013 mm: rounding, not another angle.
#[test]
fn a_deep_hole_does_not_mistake_the_rounding_of_its_head_for_another_angle() {
    let text = melon().replace("IS-B", "IS-A").replace("depth = 15.0", "depth = 150.0");
    let done = ran(&families::emit(&job(&text)), |_| {});
    assert!(matches!(done.outcome, Outcome::End), "{:?}", done.outcome);
    assert_eq!(done.control.stops().len(), 6, "no setting of the head is repeated");
}

/// The caller's modes and feed come back; the macro's own variables are its own.
#[test]
fn a_call_leaves_the_callers_modes_feed_and_locals() {
    let text = format!(
        "O1\nG21\nG90 G94 G01 F77.\n#1=5.\nG91\n{CALL}\n#100=#4001\n#101=#4003\n#102=#4109\n#103=#1\n#104=#24\nM30\n"
    );
    let request = Request::new("O1.nc", text.into_bytes(), Machine::default());
    let package = families::emit(&job(&melon()));
    let done = run(&request, &mut Programs(&package), &mut ()).unwrap();
    let found: Vec<_> = done.control.variables().filter(|(number, _)| (100..140).contains(number)).collect();
    assert_eq!(found, [(100, 1.0), (101, 91.0), (102, 77.0), (103, 5.0)], "#104 stays vacant");
}
