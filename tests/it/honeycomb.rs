//! The emitted honeycomb programs on the control: random jobs, faults in the macro, blocks counted.
use gcode_gen::check::{CheckedPackage, check};
use gcode_gen::families;
use gcode_inspect::verify::{Answer, Verdict};
use gcode_lang::motion::Position;
use gcode_tests::bench::{Bench, alarm, example};
use gcode_tests::expect::Recorder;
use proptest::prelude::*;

/// A small job: diameter 100, pitch 20, length 90: 9 rows of each group, 5 and 4 holes.
const SMALL: &str = include_str!("../suite/macro/a_honeycomb_refuses_wrong_arguments/job.toml");

fn changed(changes: &[(&str, &str)]) -> String {
    changes.iter().fold(SMALL.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    })
}

fn checked(text: &str) -> CheckedPackage {
    let bench = Bench::of(text);
    check(&bench.job, &bench.package).unwrap()
}

/// The verdict on a job's programs, after a change of the macro by hand.
fn verdict(text: &str, changes: &[(&str, &str)]) -> Verdict {
    let mut bench = Bench::of(text);
    for (from, to) in changes {
        let mut programs = bench.package.programs.iter_mut();
        let program = programs.find(|program| program.text.contains(from)).expect(from);
        program.text = program.text.replace(from, to);
    }
    check(&bench.job, &bench.package).unwrap().verdict.into_holes().unwrap()
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
fn jobs_of_every_kind_pass() {
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
        &[
            ("diameter = 100.0", "diameter = 20.0"),
            ("length = 90.0", "length = 3.0"),
            ("pitch = 20.0", "pitch = 0.45"),
            ("diameter = 5.0\ndepth = 12.0", "diameter = 0.3\ndepth = 1.0"),
        ],
        &[("depth = 12.0", "depth = 12.0\nnumber = 12\nspeed = 700\nfeed = 33.3\npeck = 0.7")],
    ] {
        let text = changed(changes);
        assert_eq!(checked(&text).refusals, Vec::<String>::new(), "{text}");
    }
}

/// 53 rows at the coarsest increment: half of 0.01° is 0.022 mm at 250 mm, Φ0.044.
#[test]
fn a_coarse_increment_spoils_a_large_cylinder_and_the_refusal_suggests_a_finer_one() {
    let text = changed(&[
        ("IS-B", "IS-A"),
        ("diameter = 100.0", "diameter = 500.0"),
        ("position = 0.1", "position = 0.03"),
        ("pitch = 20.0", "pitch = 17.0"),
    ]);
    assert!(checked(&text).refusals.concat().contains("use a finer increment or a wider tolerance"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn a_random_job_closes(
        (diameter, wall) in (20.0..400.0f64, 0.0..5.0f64),
        (divisions, pitched, chord, sign) in (2u32..40, any::<bool>(), any::<bool>(), any::<bool>()),
        (length, depth, drill) in (0.1..9.0f64, 0.05..0.4f64, 0.2..0.5f64),
    ) {
        // Lengths in pitches, depths in radii, so that every job is possible.
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
        let checked = checked(&text);
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

    /// The macro rounds a quotient; the reference tries counts and measures. Both change to the next count together, in both metrics.
    #[test]
    fn generator_and_reference_count_the_rows_alike(
        (divisions, over) in (2u32..60, prop_oneof![-0.001..0.001f64, -0.5..0.5f64]),
        (diameter, chord) in (20.0..400.0f64, any::<bool>()),
    ) {
        // Nearer to the half than the pitch's last printed digit, either count is right.
        prop_assume!(1e-4 < over.abs());
        // The rows of each group, and a half: 2·cos 30° of the pitch each.
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
    for (from, to, code, text) in faults {
        let verdict = verdict(SMALL, &[(from, to)]);
        assert_eq!(verdict.verdict, Answer::Fail, "{from} -> {to}");
        let found = verdict.findings.iter().filter(|f| f.code == code);
        let words: Vec<_> = found.map(|f| format!("{} {}", f.message, f.notes.join(" "))).collect();
        assert!(words.concat().contains(text), "{from} -> {to}: {:?} {words:?}", codes(&verdict));
    }
}

/// A hole beside the cylinder, 60 off its axis, is in no row; findings on the rows stay.
#[test]
fn a_hole_off_the_cylinder_hides_no_finding_on_the_rows() {
    let fault = ("#15=180/#14", "#15=FIX[178/#14]");
    let aside = ("G80\n", "G80\nG81 X10. Y60. Z-60. R2. F60.\nG80\n");
    let verdict = verdict(SMALL, &[fault, aside]);
    assert!(!verdict.extra.is_empty(), "{:?}", codes(&verdict));
    let found: Vec<_> = verdict.findings.iter().filter(|f| f.code == "row-angle").collect();
    assert!(found.len() == 1 && found[0].notes.concat().contains("105.26"), "{found:?}");
}

/// The job's reference and the macro refuse the same jobs.
#[test]
fn generator_and_macro_refuse_the_same() {
    for (pitch, depth) in [(6.0, 20.0), (60.0, 49.0), (6.0, 5.0), (20.0, 12.0)] {
        let [p, z] = [format!("pitch = {pitch:?}"), format!("depth = {depth:?}")];
        let bench = Bench::of(&changed(&[("pitch = 20.0", &p), ("depth = 12.0", &z)]));
        let is_refused = check(&bench.job, &bench.package).is_err();
        assert_eq!(alarm(&bench.run_to(8300, &mut ())).is_some(), is_refused, "{p} {z}");
    }
}

#[test]
fn the_rotary_turns_only_while_the_drill_is_clear() {
    for start in ["", "G00 Z5.;", "G00 Z200.;"] {
        let bench = Bench::of(SMALL);
        let text = &bench.package.program(8300).unwrap().text;
        let call = text.lines().find(|line| line.contains("P8301")).unwrap();
        let mut recorder = Recorder::default();
        let ran = bench.clone().edited(8300, &format!("{call} => {start}{call}")).run_to(8300, &mut recorder);
        assert_eq!(alarm(&ran), None);
        let positions = [vec![Position::default()], recorder.positions()].concat();
        let turns: Vec<_> = positions.windows(2).filter(|pair| pair[0][4] != pair[1][4]).collect();
        assert_eq!(turns.len(), 17, "18 rows, the first at B0");
        let lowest = turns.iter().map(|pair| pair[0][2].min(pair[1][2])).fold(f64::INFINITY, f64::min);
        assert!(lowest >= 50.0, "{start}: {lowest}");
    }
}

/// A control manages about a thousand macro blocks a second.
#[test]
fn a_hole_costs_four_blocks_and_a_row_ten() {
    let blocks =
        |changes: &[(&str, &str)]| Bench::of(&changed(changes)).run_to(8300, &mut ()).control.blocks();
    // Even rows end at 80.6 and 100.8, odd ones at 90.7 either way.
    let holes =
        blocks(&[("length = 90.0", "length = 101.0")]) - blocks(&[("length = 90.0", "length = 91.0")]);
    assert_eq!(holes, 9 * 4, "one more in every even row");
    // One division more is two rows, the even one with one hole.
    let divided = |divisions: &str| blocks(&[("length = 90.0", "length = 0.5"), ("pitch = 20.0", divisions)]);
    assert_eq!(divided("divisions = 10") - divided("divisions = 9"), 2 * 10 + 4);
}

/// D changed by hand closes on another cylinder.
#[test]
fn a_diameter_changed_at_the_machine_closes_again() {
    let other = Bench::of(&changed(&[("diameter = 100.0", "diameter = 130.0")]));
    let mut bench = Bench::of(SMALL).edited(8300, "D100. => D130.").edited(8300, "I100. => I130.");
    bench.package.machine = bench.package.machine.replace("-50.0", "-65.0");
    let verdict = check(&other.job, &bench.package).unwrap().verdict.into_holes().unwrap();
    assert_eq!(verdict.verdict, Answer::Pass, "{:?}", verdict.findings);
}

#[test]
fn the_new_job_is_the_example() {
    let family = families::ALL.iter().find(|family| family.name == "honeycomb").unwrap();
    assert_eq!(example("honeycomb"), family.new_job);
}
