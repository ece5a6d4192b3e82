//! The emitted honeycomb programs on the control: random jobs, called wrongly, with faults put in, counted.
use std::path::Path;

use gcode_control::Outcome;
use gcode_gen::check::{Programs, check};
use gcode_gen::families;
use gcode_gen::package::Package;
use gcode_inspect::machine::Machine;
use gcode_inspect::verify::{Answer, Verdict};
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{Event, EventKind, EventSink, Position};
use gcode_part::job::Job;
use gcode_session::{Request, Run, run};
use proptest::prelude::*;

/// A small job: diameter 100, pitch 20, length 90: 9 rows of each group, 5 and 4 holes.
const SMALL: &str = r#"family = "honeycomb"
[control]
dialect = "fanuc-31i"
increment = "IS-B"
[machine]
rotary = { letter = "B", sign = 1 }
[tolerance]
position = 0.1
[cylinder]
diameter = 100.0
length = 90.0
[pattern]
pitch = 20.0
metric = "arc"
[drill]
diameter = 5.0
depth = 12.0
"#;

fn job(text: &str) -> Job {
    Job::parse(text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn changed(changes: &[(&str, &str)]) -> String {
    changes.iter().fold(SMALL.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    })
}

/// The verdict on a job's programs, after a change of the macro by hand.
fn verdict(text: &str, changes: &[(&str, &str)]) -> Verdict {
    let job = job(text);
    let mut package = families::emit(&job);
    for (from, to) in changes {
        let program = package.programs.iter_mut().find(|program| program.text.contains(from)).expect(from);
        program.text = program.text.replace(from, to);
    }
    check(&job, &package).unwrap().verdict.into_holes().unwrap()
}

fn ran(package: &Package, sink: &mut impl EventSink) -> Run {
    let main = package.main().unwrap();
    let machine = Machine::parse(&package.machine).unwrap();
    run(&Request::new("O8300.nc", main.text.as_bytes(), machine), &mut Programs(package), sink).unwrap()
}

/// π·100/(20·√3) = 9.07 rows; π·100/18/cos 30° = 20.153; 90/20.153 = 4.47: 5 holes in even rows, and with half a pitch
/// off, 3.97: 4 in odd ones.
#[test]
fn the_small_job_counted_by_hand() {
    let verdict = verdict(SMALL, &[]);
    assert_eq!((verdict.verdict, verdict.holes.len()), (Answer::Pass, 9 * 5 + 9 * 4));
    let neighbours = verdict.neighbours.unwrap();
    assert!((neighbours.nominal - 20.153_326_3).abs() < 1e-6, "{}", neighbours.nominal);
    // Even rows without their ends; of odd ones the inner two have both neighbours in the row.
    assert_eq!((neighbours.with_six, neighbours.with_six_nominal), (9 * 3 + 9 * 2, 45));
}

#[test]
fn every_kind_of_job_holds() {
    for changes in [
        &[("sign = 1", "sign = -1")][..],
        &[("\"arc\"", "\"chord\"")],
        &[("pitch = 20.0", "divisions = 7")],
        &[("pitch = 20.0", "divisions = 2"), ("\"arc\"", "\"chord\"")],
        &[("depth = 12.0", "depth = 15.0")],
        &[("depth = 12.0", "depth = 15.1")],
        &[("length = 90.0", "length = 9.0")],
        &[("length = 90.0", "length = 0.5")],
        &[("diameter = 100.0", "diameter = 100.0\nouter = 110.0\nbore = 90.0")],
        &[("IS-B", "IS-C"), ("fanuc-31i", "haas-ngc")],
        &[("fanuc-31i", "fanuc-0i-f"), ("letter = \"B\"", "letter = \"A\"")],
        &[("sign = 1 }", "sign = 1 }\nclamp = { on = 10, off = 11 }\nclearance = 0.5\nretract = 0.5")],
        &[("depth = 12.0", "depth = 12.0\nnumber = 12\nspeed = 700\nfeed = 33.3\npeck = 0.7")],
    ] {
        let text = changed(changes);
        let checked = check(&job(&text), &families::emit(&job(&text))).unwrap();
        assert_eq!(checked.refusals, Vec::<String>::new(), "{text}");
    }
}

/// 53 rows at the coarsest increment: half of 0.01° is 0.022 mm at 250 mm, Φ0.044.
#[test]
fn a_coarse_increment_spoils_a_large_cylinder_and_the_refusal_says_so() {
    let text = changed(&[
        ("IS-B", "IS-A"),
        ("diameter = 100.0", "diameter = 500.0"),
        ("position = 0.1", "position = 0.03"),
        ("pitch = 20.0", "pitch = 17.0"),
    ]);
    let checked = check(&job(&text), &families::emit(&job(&text))).unwrap();
    assert!(checked.refusals.concat().contains("use a finer increment or a wider tolerance"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn a_random_job_closes(
        (diameter, wall) in (20.0..400.0f64, 0.0..5.0f64),
        (divisions, pitched, chord, sign) in (2u32..40, any::<bool>(), any::<bool>(), any::<bool>()),
        (length, depth, drill) in (0.1..9.0f64, 0.05..0.4f64, 0.2..0.5f64),
    ) {
        // Lengths in pitches, depths in radii, so that what is asked for is possible.
        let pitch = 3.627 * diameter / 2.0 / f64::from(divisions);
        let spacing = if pitched { format!("pitch = {pitch:.4}") } else { format!("divisions = {divisions}") };
        let outer = diameter + 2.0 * wall;
        let text = changed(&[
            ("sign = 1", if sign { "sign = 1" } else { "sign = -1" }),
            ("diameter = 100.0", &format!("diameter = {diameter:.3}\nouter = {outer:.3}")),
            ("pitch = 20.0", &spacing),
            ("\"arc\"", if chord { "\"chord\"" } else { "\"arc\"" }),
            ("length = 90.0", &format!("length = {:.3}", length * pitch)),
            ("diameter = 5.0", &format!("diameter = {:.3}", (drill * pitch).max(0.02))),
            ("depth = 12.0", &format!("depth = {:.3}", (depth * diameter / 2.0).max(0.1))),
        ]);
        let job = job(&text);
        let checked = check(&job, &families::emit(&job)).unwrap();
        prop_assert!(checked.refusals.is_empty(), "{}\n{text}", checked.refusals.concat());
        let verdict = checked.verdict.into_holes().unwrap();
        let (worst, rounding) = (verdict.worst.unwrap(), verdict.rounding.unwrap());
        prop_assert!(worst <= rounding + 1e-6, "Φ{worst} where rounding explains Φ{rounding}\n{text}");
        let neighbours = verdict.neighbours.unwrap();
        prop_assert_eq!(neighbours.with_six, neighbours.with_six_nominal);
        // Both ends of a distance may be rounded; the chord of a step of the rotary is shorter on the pitch's diameter.
        for extreme in [neighbours.min, neighbours.max].into_iter().flatten() {
            prop_assert!((extreme.distance - neighbours.nominal).abs() <= rounding + 1e-6, "{extreme:?}\n{text}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// The macro rounds a quotient; the reference tries counts and measures. Where a count changes into the next they
    /// have to change together, in both metrics.
    #[test]
    fn generator_and_reference_count_the_rows_alike(
        (divisions, over) in (2u32..60, prop_oneof![-0.001..0.001f64, -0.5..0.5f64]),
        (diameter, chord) in (20.0..400.0f64, any::<bool>()),
    ) {
        // Nearer to the half than the pitch's last printed digit, either count is right.
        prop_assume!(1e-4 < over.abs());
        // So many rows of each group, and a half: 2·cos 30° of the pitch each.
        let pitch = std::f64::consts::PI * diameter / (3f64.sqrt() * (f64::from(divisions) + 0.5 + over));
        let text = changed(&[
            ("diameter = 100.0", &format!("diameter = {diameter:?}")),
            ("pitch = 20.0", &format!("pitch = {pitch:?}")),
            ("\"arc\"", if chord { "\"chord\"" } else { "\"arc\"" }),
            ("length = 90.0", &format!("length = {:?}", 0.65 * pitch)),
            ("diameter = 5.0", &format!("diameter = {:?}", 0.2 * pitch)),
            ("depth = 12.0", &format!("depth = {:?}", 0.05 * diameter)),
        ]);
        let verdict = verdict(&text, &[]);
        // One hole in every row: half a pitch on there is room for one more, a whole pitch on there is not.
        let rows = 2 * (divisions + u32::from(0.0 <= over));
        prop_assert_eq!(verdict.holes.len(), rows as usize, "{}", text);
        prop_assert_eq!(verdict.missing.len() + verdict.extra.len(), 0, "{}", text);
    }
}

fn codes(verdict: &Verdict) -> Vec<&str> {
    let mut codes: Vec<_> = verdict.findings.iter().map(|f| &*f.code).collect();
    codes.dedup();
    codes
}

#[test]
fn a_fault_in_the_macro_is_named() {
    let faults = [
        ("#18 LT 2*#14", "#18 LT #14", "row-missing", "rows 9 to 17 are missing"),
        ("ROUND[3.14159265", "FUP[3.14159265", "row-angle", "18° apart, nominal 20.0000°"),
        ("#15=180/#14", "#15=FIX[178/#14]", "row-angle", "right for a diameter of 105.26 mm"),
        ("*#16/2 (WHERE", "*0 (WHERE", "row-group", "no row is staggered: all 18 rows begin at x 0.000"),
        ("#18=#18+1", "#18=#18+2", "row-group", "all 9 rows begin at x 0.000"),
        ("/[2*#14]/COS[30.]", "/[2*#14]/COS[31.]", "row-pitch", "the holes of a row are 20.36"),
        ("#18*#15]", "#18*[#15+.5]]", "row-angle", "20.5° apart, nominal 20.0000°"),
    ];
    for (from, to, code, told) in faults {
        let verdict = verdict(SMALL, &[(from, to)]);
        assert_eq!(verdict.verdict, Answer::Fail, "{from} -> {to}");
        let found = verdict.findings.iter().filter(|f| f.code == code);
        let words: Vec<_> = found.map(|f| format!("{} {}", f.message, f.notes.join(" "))).collect();
        assert!(words.concat().contains(told), "{from} -> {to}: {:?} {words:?}", codes(&verdict));
    }
}

/// A hole beside the cylinder, 60 off its axis, is in no row; what the others' rows say is still said.
#[test]
fn a_hole_that_misses_the_cylinder_takes_no_advice_away() {
    let fault = ("#15=180/#14", "#15=FIX[178/#14]");
    let aside = ("G80\n", "G80\nG81 X10. Y60. Z-60. R2. F60.\nG80\n");
    let verdict = verdict(SMALL, &[fault, aside]);
    assert!(!verdict.extra.is_empty(), "{:?}", codes(&verdict));
    let told: Vec<_> = verdict.findings.iter().filter(|f| f.code == "row-angle").collect();
    assert!(told.len() == 1 && told[0].notes.concat().contains("105.26"), "{told:?}");
}

const CALL: &str = "G65 P8301 A5. B20. C2. D100. E0. F60. H0. I100. J0. Q5. U1. V50. X90. Z12.";

/// Runs one call of the macro, changed, and answers with the alarm's number and text.
fn called(changes: &[(&str, &str)], modes: &str) -> (u32, String) {
    let call = changes.iter().fold(CALL.to_owned(), |call, (from, to)| {
        assert!(call.contains(from), "{from}");
        call.replace(from, to)
    });
    let package = families::emit(&job(SMALL));
    let text = format!("O1\nG21 G17 G40 G80 G90 G94\n{modes}\n{call}\nM30\n");
    let machine = Machine::parse(&package.machine).unwrap();
    let mut moves = Count(0);
    let done =
        run(&Request::new("O1.nc", text.as_bytes(), machine), &mut Programs(&package), &mut moves).unwrap();
    match &done.outcome {
        Outcome::Alarm(stopped) => match &stopped.alarm {
            Alarm::UserAlarm { number, text, .. } => {
                assert_eq!(moves.0, 0, "moved before the alarm: {call}");
                (u32::from(*number), text.to_string())
            }
            other => panic!("{call}: {other:?}"),
        },
        other => panic!("{call}: {other:?}"),
    }
}

struct Count(u32);

impl EventSink for Count {
    fn event(&mut self, event: &Event<'_>) {
        self.0 += u32::from(matches!(event.kind, EventKind::Rapid { .. } | EventKind::Feed { .. }));
    }
}

/// What is changed in the call, and the alarm it must raise.
type Case = (&'static [(&'static str, &'static str)], u32, &'static str);

#[test]
fn the_macro_refuses_what_cannot_be_before_anything_moves() {
    let cases: [Case; 27] = [
        (&[(" A5.", "")], 31, "A MISSING OR NOT POSITIVE"),
        (&[("C2.", "C0.")], 32, "C MISSING OR NOT POSITIVE"),
        (&[(" D100.", "")], 33, "D MISSING OR NOT POSITIVE"),
        (&[("F60.", "F-60.")], 34, "F MISSING OR NOT POSITIVE"),
        (&[("Q5.", "Q0.")], 35, "Q MISSING OR NOT POSITIVE"),
        (&[(" X90.", "")], 36, "X MISSING OR NOT POSITIVE"),
        (&[("Z12.", "Z-12.")], 37, "Z MISSING OR NOT POSITIVE"),
        (&[("I100.", "I99.")], 38, "I MISSING OR BELOW D"),
        (&[(" J0.", "")], 39, "J MUST BE FROM 0. TO D"),
        (&[("J0.", "J101.")], 39, "J MUST BE FROM 0. TO D"),
        (&[("Z12.", "Z50.")], 40, "Z REACHES THE AXIS"),
        (&[("V50.", "V1.9")], 41, "V MUST NOT BE BELOW C"),
        (&[("U1.", "U0.")], 42, "U MUST BE 1. OR -1."),
        (&[(" H0.", "")], 43, "H MUST BE 0. OR 1."),
        (&[("H0.", "H2.")], 43, "H MUST BE 0. OR 1."),
        (&[(" B20.", "")], 44, "B MISSING OR NEGATIVE"),
        (&[("B20.", "B-20.")], 44, "B MISSING OR NEGATIVE"),
        (&[(" E0.", "")], 45, "E MISSING OR NEGATIVE"),
        (&[("B20.", "B0."), ("E0.", "E8.5")], 46, "E NOT A WHOLE NUMBER"),
        (&[("E0.", "E9.")], 47, "ONE OF B AND E MUST BE 0."),
        (&[("B20.", "B0.")], 47, "ONE OF B AND E MUST BE 0."),
        (&[("B20.", "B130.")], 48, "FEWER THAN 2 ROWS FIT"),
        (&[("B20.", "B0."), ("E0.", "E1.")], 48, "FEWER THAN 2 ROWS FIT"),
        (&[("A5.", "A21.")], 49, "HOLES WOULD OVERLAP"),
        (&[("B20.", "B4.9")], 49, "HOLES WOULD OVERLAP"),
        (&[("B20.", "B6."), ("Z12.", "Z20.")], 49, "HOLES WOULD OVERLAP"),
        (&[("B20.", "B60."), ("Z12.", "Z49.")], 49, "HOLES WOULD OVERLAP"),
    ];
    for (changes, number, text) in cases {
        assert_eq!(called(changes, ""), (number, text.to_owned()), "{changes:?}");
    }
    for modes in ["G20", "G18", "G41 D1", "G95", "G99 G81 Z-1. R1. F10. K0"] {
        assert_eq!(called(&[], modes), (50, "NEEDS G17 G21 G40 G80 G94".to_owned()), "{modes}");
    }
}

/// What the job's reference refuses, the macro refuses too, and what one of them lets pass, the other does.
#[test]
fn generator_and_macro_refuse_the_same() {
    for (pitch, depth) in [(6.0, 20.0), (60.0, 49.0), (6.0, 5.0), (20.0, 12.0)] {
        let [p, z] = [format!("{pitch:?}"), format!("{depth:?}")];
        let text =
            changed(&[("pitch = 20.0", &format!("pitch = {p}")), ("depth = 12.0", &format!("depth = {z}"))]);
        let refused = check(&job(&text), &families::emit(&job(&text))).is_err();
        let done = ran(&families::emit(&job(&text)), &mut ());
        assert_eq!(!matches!(done.outcome, Outcome::End), refused, "pitch {pitch} depth {depth}");
    }
}

/// How far above the surface the drill is while the rotary turns.
struct Turns {
    at: Position,
    lowest: f64,
    turns: u32,
}

impl EventSink for Turns {
    fn event(&mut self, event: &Event<'_>) {
        let to = match &event.kind {
            EventKind::Rapid { to } | EventKind::Feed { to, .. } => to,
            _ => return,
        };
        if to[4] != self.at[4] {
            self.turns += 1;
            self.lowest = self.lowest.min(self.at[2]).min(to[2]);
        }
        self.at = *to;
    }
}

#[test]
fn the_rotary_turns_only_while_the_drill_is_clear() {
    for start in ["", "G00 Z5.", "G00 Z200."] {
        let mut package = families::emit(&job(SMALL));
        let call = package.programs[0].text.lines().find(|line| line.contains("P8301")).unwrap().to_owned();
        package.programs[0].text = package.programs[0].text.replace(&call, &format!("{start}\n{call}"));
        let mut sink = Turns { at: Position::default(), lowest: f64::INFINITY, turns: 0 };
        assert!(matches!(ran(&package, &mut sink).outcome, Outcome::End));
        assert_eq!(sink.turns, 17, "18 rows, the first at B0");
        assert!(sink.lowest >= 50.0, "{start}: {}", sink.lowest);
    }
}

/// A control manages about a thousand macro blocks a second.
#[test]
fn a_hole_costs_four_blocks_and_a_row_ten() {
    let blocks = |changes: &[(&str, &str)]| {
        let text = changed(changes);
        ran(&families::emit(&job(&text)), &mut ()).control.blocks()
    };
    // Even rows end at 80.6 and 100.8, odd ones at 90.7 either way.
    let holes =
        blocks(&[("length = 90.0", "length = 101.0")]) - blocks(&[("length = 90.0", "length = 91.0")]);
    assert_eq!(holes, 9 * 4, "one more in every even row");
    // One division more is two rows, the even one with one hole.
    let divided = |divisions: &str| blocks(&[("length = 90.0", "length = 0.5"), ("pitch = 20.0", divisions)]);
    assert_eq!(divided("divisions = 10") - divided("divisions = 9"), 2 * 10 + 4);
}

/// The example's D changed by hand closes on another cylinder.
#[test]
fn a_diameter_changed_at_the_machine_closes_again() {
    let other = changed(&[("diameter = 100.0", "diameter = 130.0")]);
    let mut package = families::emit(&job(SMALL));
    package.programs[0].text = package.programs[0].text.replace("D100.", "D130.").replace("I100.", "I130.");
    package.machine = package.machine.replace("-50.0", "-65.0");
    let verdict = check(&job(&other), &package).unwrap().verdict.into_holes().unwrap();
    assert_eq!(verdict.verdict, Answer::Pass, "{:?}", verdict.findings);
}

#[test]
fn the_new_job_is_the_example() {
    let family = families::ALL.iter().find(|family| family.name == "honeycomb").unwrap();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/honeycomb/job.toml");
    assert_eq!(std::fs::read_to_string(path).unwrap(), family.new_job);
}
