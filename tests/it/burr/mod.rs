//! Burrs from job to verdict: random jobs, both forms of the program, how many moves there are, what the macro refuses.
mod sample_jobs;

use gcode_gen::check::{Programs, check};
use gcode_inspect::machine::Machine;
use gcode_inspect::verify::Answer;
use gcode_inspect::verify::flutes::FluteVerdict;
use gcode_lang::motion::{EventKind, Position};
use gcode_lang::units::{Deg, ln};
use gcode_part::NominalPart;
use gcode_session::{Request, grind};
use gcode_tests::bench::{Bench, alarm};
use gcode_tests::expect::Recorder;
use proptest::prelude::*;

use self::sample_jobs::{Wish, example, wishes};

/// The example with two flutes, for tests that don't depend on their number.
fn two_flutes() -> Wish {
    Wish { flutes: 2, ..example() }
}

/// The verdict on the emitted programs, which must pass.
fn passed(wish: &Wish) -> FluteVerdict {
    let bench = wish.bench();
    let checked = check(&bench.job, &bench.package).unwrap();
    assert!(checked.refusals.is_empty(), "{}\n{}", checked.refusals.concat(), wish.text());
    let verdict = checked.verdict.into_flutes().unwrap();
    assert!(verdict.verdict == Answer::Pass);
    verdict
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn a_random_burr_is_ground_as_specified(wish in wishes()) {
        let verdict = passed(&wish);
        prop_assert_eq!(verdict.flutes, wish.flutes as usize);
        prop_assert!(verdict.surface_deviation.unwrap() <= wish.chord_error + 1e-6);
        let (slow, fast) = (verdict.speed_min.unwrap(), verdict.speed_max.unwrap());
        prop_assert!(190.0 < slow && fast < 210.0, "{slow} {fast}");
        let (least, most) = (verdict.helix_min.unwrap(), verdict.helix_max.unwrap());
        if wish.law == "constant-helix" {
            prop_assert!((least - wish.helix).abs() < 0.3 && (most - wish.helix).abs() < 0.3, "{least} {most}");
        } else {
            // The flute begins at B's angle and grows steeper, tan β over the cosine of the distance, over which the angle is measured.
            let flat = if wish.helix < 0.0 { most } else { least };
            let way = Deg::from_rad(verdict.gauge / (wish.diameter / 2.0)).0.min(80.0);
            let steepest = Deg::atan2(Deg(wish.helix.abs()).tan(), Deg(way).cos()).0;
            let most = 3.0 + steepest - wish.helix.abs();
            prop_assert!((flat.abs() - wish.helix.abs()).abs() < most && flat * wish.helix > 0.0, "{flat}: {most}");
        }
    }
}

fn grind_flutes(bench: &Bench) -> FluteVerdict {
    let NominalPart::Flutes(flutes) = NominalPart::from_job(&bench.job).unwrap() else {
        panic!("a burr has flutes")
    };
    let request = bench.request(8400);
    grind(&request, &mut Programs(&bench.package), &flutes).unwrap().verify(&request)
}

/// The verdict on an emitted program in which `from` is replaced.
fn replaced(from: &str, to: &str) -> FluteVerdict {
    let mut bench = two_flutes().bench();
    for program in &mut bench.package.programs {
        program.text = program.text.replace(from, to);
    }
    grind_flutes(&bench)
}

/// On the cylinder the contact's way is 19/cos 20° mm, and X, A go 19 and 66.036°: G94 takes 68.7/(200/20.219) min, in
/// which 200 mm/min take 0.1011.
#[test]
fn the_wheels_rotation_and_speed_along_the_flute_count() {
    let cases = [
        ("S3000 M03", "S3000 M03", Answer::Pass, None),
        ("S3000 M03", "S3000", Answer::Fail, Some("spindle-stopped")),
        ("S3000 M03", "S0 M03", Answer::Fail, Some("spindle-stopped")),
        ("M08", "M08\nM05", Answer::Fail, Some("spindle-stopped")),
        ("S3000 M03", "S3000\nM63", Answer::Pass, Some("spindle-stopped")),
        ("S3000 M03", "S3000 M04", Answer::Pass, Some("wheel-reversed")),
        ("G93\n", "G94\n", Answer::Fail, Some("flute-speed")),
        ("F200. ", "F20000. ", Answer::Fail, Some("flute-speed")),
        ("F200. ", "F160. ", Answer::Pass, None),
    ];
    for (from, to, answer, code) in cases {
        let verdict = replaced(from, to);
        let expected: Vec<_> = verdict.findings.iter().map(|finding| &*finding.code).collect();
        assert!(verdict.verdict == answer && expected == Vec::from_iter(code), "{to}: {expected:?}");
    }
    let slow = replaced("G93\n", "G94\n").speed_min.unwrap();
    let wanted = 20.219 / (66.036f64.hypot(19.0) / (200.0 / 20.219));
    assert!((slow - wanted).abs() < 0.01, "{slow} {wanted}");
}

/// The burr's end 0.02 too far from the C axis in Y: off by 0.02·(1 − cos 85°) at the tip, below.
#[test]
fn a_wrong_offset_is_named_as_the_cause() {
    let verdict = replaced("J-15. ", "J-15.02 ");
    let expected = verdict.findings.iter().find(|finding| finding.code == "flute-surface").unwrap();
    let deepest = 0.02 * (1.0 - Deg(85.0).cos());
    assert!((verdict.surface_deviation.unwrap() - deepest).abs() < 0.002, "{expected:?}");
    assert!(
        expected.notes[0].contains("X40.000 Y-15.020 from the C axis instead of X40 Y-15"),
        "{expected:?}"
    );
    let verdict = replaced("I40. ", "I40.03 ");
    let expected = verdict.findings.iter().find(|finding| finding.code == "flute-surface").unwrap();
    assert!(expected.notes[0].contains("X40.030 Y-15.000 from the C axis"), "{expected:?}");
}

/// Every rapid and feed of a burr's program: whether it is a rapid, its end, its seconds.
fn moves(wish: &Wish) -> Vec<(bool, Position, f64)> {
    let mut recorder = Recorder::default();
    assert_eq!(alarm(&wish.bench().run_to(8400, &mut recorder)), None);
    let moves = recorder.0.into_iter().filter_map(|(_, kind, seconds)| match kind {
        EventKind::Rapid { to } => Some((true, to, seconds)),
        EventKind::Feed { to, .. } => Some((false, to, seconds)),
        _ => None,
    });
    moves.collect()
}

/// The control computes the very points that the generator writes out, and as fast.
#[test]
fn both_forms_make_the_same_moves() {
    let arcs = Wish { profile: Some((14.0 / 6.0, 4.0 / 6.0)), ..two_flutes() };
    let published = Wish { law: "published", signs: [-1, 1, -1, 1, -1], flutes: 3, ..arcs.clone() };
    // Where the speed along the flute is what keeps moves short.
    let steady = Wish { offset: [-69.4, 34.9], diameter: 4.5, chord_error: 0.009, ..arcs.clone() };
    for wish in [two_flutes(), arcs, published, steady] {
        let (computed, written) = (moves(&wish), moves(&Wish { form: "moves", ..wish.clone() }));
        assert_eq!(computed.len(), written.len());
        for (one, other) in computed.iter().zip(&written) {
            assert_eq!(one.0, other.0);
            let apart = one.1.0.iter().zip(&other.1.0).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            // A C that falls halfway between two increments may go either way, and A after it.
            assert!(apart < 0.005, "{one:?} {other:?}");
            // An F that is written out has three places.
            assert!((one.2 - other.2).abs() < 1e-3, "{one:?} {other:?}");
        }
    }
}

/// The longest move from C on whose contact strays less than `error` from the loxodrome on a ball of 6 mm: written out
/// for this test, with the distance across the flute taken on the surface.
fn longest(c: f64, end: f64, error: f64) -> f64 {
    let (radius, tan) = (6.0, Deg(20.0).tan());
    let [x, y] = example().offset;
    let turn = |c: f64| tan * ln(Deg(45.0 + c / 2.0).tan());
    let strays = |to: f64| {
        (1..20).any(|n| {
            let t = f64::from(n) / 20.0;
            let mix = |f: &dyn Fn(f64) -> f64| f(c) + (f(to) - f(c)) * t;
            let now = c + (to - c) * t;
            let (sin, cos) = (Deg(now).sin(), Deg(now).cos());
            // Where the centre is, less where it ought to be.
            let dx = mix(&|c| -(x * Deg(c).cos() - y * Deg(c).sin())) + x * cos - y * sin;
            let dy = mix(&|c| -(x * Deg(c).sin() + y * Deg(c).cos())) + x * sin + y * cos;
            let around = radius * cos * (mix(&turn) - turn(now));
            let across = dx * Deg(20.0).sin() - around * Deg(20.0).cos();
            (dy * dy + across * across).sqrt() > error
        })
    };
    let (mut fits, mut too_long) = (c, (c + 20.0).min(end));
    if !strays(too_long) {
        return too_long;
    }
    for _ in 0..60 {
        let middle = (fits + too_long) / 2.0;
        if strays(middle) { too_long = middle } else { fits = middle }
    }
    fits
}

#[test]
fn there_are_as_few_moves_as_hold_the_chord_error() {
    let mut c = 0.0;
    let mut fewest = 1;
    while c < 85.0 {
        c = longest(c, 85.0, 0.0015);
        fewest += 1;
    }
    let found = passed(&two_flutes()).moves / 2;
    assert!(
        fewest <= found + 1 && found <= fewest + fewest / 20 + 2,
        "{found} moves where {fewest} would do"
    );
}

/// Forward kinematics decides: the same programs on a machine with one axis turned round grind no such burr.
#[test]
fn the_sign_of_each_axis_counts() {
    for letter in ["X", "Y", "A", "B", "C"] {
        let mut bench = two_flutes().bench();
        let (before, after) = bench.package.machine.split_once(&format!("letter = \"{letter}\"")).unwrap();
        let turned = after.replacen("sign = 1", "sign = -1", 1);
        bench.package.machine = format!("{before}letter = \"{letter}\"{turned}");
        assert!(grind_flutes(&bench).verdict == Answer::Fail, "the direction of {letter} doesn't count");
    }
}

#[test]
fn without_a_wheel_there_is_no_verdict() {
    let bench = example().bench();
    let NominalPart::Flutes(flutes) = NominalPart::from_job(&bench.job).unwrap() else {
        panic!("a burr has flutes")
    };
    let request = Request { machine: Machine::default(), ..bench.request(8400) };
    let error = grind(&request, &mut Programs(&bench.package), &flutes).unwrap_err().to_string();
    assert!(error.starts_with("the machine file has no [wheel]"), "{error}");
}

/// The verdict on a program with more blocks before its end, at C 0 with the wheel clear of the burr.
fn with(blocks: &str) -> FluteVerdict {
    grind_flutes(&two_flutes().bench().edited(8400, &format!("G00 C0. => G00 C0.;{blocks}")))
}

/// The blank stands `depth` above the tooth bottom at Y 0; the wheel goes along it from X -19 to X 0.
#[test]
fn a_wheel_in_the_blank_without_a_pass_is_reported() {
    let depth = example_depth();
    let below = |y: f64| format!("{:.3} mm below the blank surface", depth - y);
    let cases = [
        (
            "X-19.\nG01 Y0. F30.\nX0.\nG00 Y50.\n",
            format!("19.000 mm along the burr in the cut, {}", below(0.0)),
        ),
        ("X-19.\nG01 Y0. F30.\nC10.\nG00 Y50.\n", "along the burr in the cut".to_owned()),
        ("X-19.\nG01 Y50. F30.\nX-10. Y0.\nG00 Y50.\n", "along the burr in the cut".to_owned()),
        ("X-19.\nG01 Y0. F30.\nY3.\nG00 Y50.\n", format!("is fed {} where no pass begins", below(0.0))),
        ("X-19.\nG01 Y0. F30.\nG00 Y50.\n", format!("is fed {} where no pass begins", below(0.0))),
        ("X-19.\nG01 Y0. F30.\n", format!("is fed {} where no pass begins", below(0.0))),
        ("X-19.\nG01 Y-0.1 F30.\nG00 Y50.\n", "0.100 mm below the tooth bottom".to_owned()),
        ("X-19.\nY0.\nG00 Y50.\n", format!("rapid motion with the wheel in the blank, {}", "")),
    ];
    for (blocks, expected) in cases {
        let verdict = with(blocks);
        let found: Vec<_> = verdict.findings.iter().filter(|f| f.code == "wheel-into-burr").collect();
        assert!(
            found.iter().any(|f| f.message.contains(&expected)),
            "{blocks}: {:?}, not {expected}",
            verdict.findings
        );
    }
    // As near as may be without touching it, from end to end.
    let clear = format!("X-19.\nG01 Y{:.3} F30.\nX0.\nG00 Y50.\n", depth + 0.01);
    assert!(with(&clear).verdict == Answer::Pass, "{:?}", with(&clear).findings);
}

fn example_depth() -> f64 {
    let NominalPart::Flutes(wanted) = NominalPart::from_job(&example().bench().job).unwrap() else {
        panic!("a burr has flutes")
    };
    wanted.tooth_depth.max(wanted.surface_tolerance)
}

/// Sixteen whole turns in one block: the samples must not all be at the same place.
#[test]
fn whole_turns_in_one_block_are_followed() {
    let verdict = with("X-19.\nG01 Y0. F30.\nG91 A5760.\nG90 G00 Y50.\n");
    assert!(verdict.findings.iter().any(|f| f.code == "flute-helix"), "{:?}", verdict.findings);
}

/// 2500 turns round 12 mm are 94 m, 1.9 million points of 0.05 mm; round 242 mm 1900 m, 7.6 million of 0.25 mm.
#[test]
fn moves_without_measure_end_in_a_finding() {
    for (blocks, expected) in [
        ("X-19.\nG01 Y0. F30.\nG91 A900000.\nG90 G00 Y50.\n", "more than 4750"), // 2·40·(19 + 8.901)/cos 20°/0.05
        ("Y100.\nG91 A900000.\nG90\n", "more than 400000 points of the wheel's path"),
    ] {
        let verdict = with(blocks);
        assert!(verdict.verdict == Answer::Fail);
        let found: Vec<_> = verdict.findings.iter().filter(|f| f.code == "limit").collect();
        assert!(
            found.len() == 1 && found[0].message.starts_with(expected),
            "{blocks}: {:?}",
            verdict.findings
        );
    }
}

#[test]
fn the_motion_from_the_start_is_listed_as_not_checked() {
    let verdict = passed(&two_flutes());
    let expected = "rapid motion up to where the wheel is first clear of the blank (1 move)";
    assert!(verdict.not_checked.iter().any(|line| line.starts_with(expected)), "{:?}", verdict.not_checked);
}

/// A deviation by the whole chord error tilts a narrowing flute too much: the moves are computed for less.
#[test]
fn near_the_tip_moves_are_shorter_for_the_helix_angle() {
    let control = ("haas-ngc", "IS-C");
    let ball = Wish { control, diameter: 9.434, cylinder: 0.0, helix: 23.5, form: "moves", ..two_flutes() };
    let ball = Wish { tip_angle: 10.69, chord_error: 0.009_486, offset: [-12.242, 51.782], ..ball };
    let published = Wish { law: "published", diameter: 4.0, helix: 11.18, tip_angle: 8.0, ..ball.clone() };
    let small =
        Wish { control: ("fanuc-31i", "IS-C"), chord_error: 0.002, flutes: 1, form: "loop", ..published };
    for wish in [ball, Wish { offset: [5.968_188_615_992_388, 66.869_309_878_016_95], ..small }] {
        assert!(passed(&wish).helix_error.unwrap() <= 0.3);
    }
}

/// With an increment of 0.001 mm the least chord error leaves 0.0005 mm to stray by, which over 0.5 mm is 0.057°.
#[test]
fn a_control_too_coarse_for_the_helix_angle_is_refused() {
    let text = format!("{}[tolerance]\nhelix = 0.05\n", two_flutes().text());
    let bench = Bench::of(&text);
    let Err(error) = check(&bench.job, &bench.package) else { panic!("nothing is refused") };
    let error = error.to_string();
    assert!(error.starts_with("the helix angle cannot be kept within 0.05°"), "{error}");
    assert!(error.contains("control.increment = \"IS-C\", if the control has it"), "{error}");
}

/// A length that is the nose's but for the last bit leaves no cylinder: no move of no length, at a feed without end.
#[test]
fn a_cylinder_of_less_than_an_increment_is_none() {
    let nose = Wish { cylinder: 0.0, profile: Some((2.636492154445089, 0.711623293272912)), ..example() };
    for form in ["moves", "loop"] {
        passed(&Wish { diameter: 6.01912604312952, flutes: 1, helix: 5.0, form, ..nose.clone() });
        passed(&Wish { cylinder: 0.000_4, flutes: 1, form, ..example() });
    }
}

/// A small burr without a cylinder, of a single flute: its one pass is seen, with the radii in mm and in parts of its own.
#[test]
fn one_flute_without_a_cylinder_is_ground() {
    let small = Wish { diameter: 4.0, cylinder: 0.0, flutes: 1, helix: 5.0, tip_angle: 8.0, ..example() };
    let written = Wish { form: "moves", chord_error: 0.005, ..small };
    for profile in [(2.6245 / 2.0, 0.6516 / 2.0), (2.6245, 0.6516)] {
        assert_eq!(passed(&Wish { profile: Some(profile), ..written.clone() }).flutes, 1);
    }
}
