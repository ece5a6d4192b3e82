//! Positions of holes on a part that is misplaced.
use nalgebra::{Point3, Vector3};
use proptest::prelude::*;

use gcode_gen::check::check;
use gcode_inspect::machine::{Machine, Placement};
use gcode_inspect::verify::{Tolerances, Verdict};
use gcode_lang::program::NoLibrary;
use gcode_lang::units::Deg;
use gcode_part::Reference;
use gcode_part::{Hole, HoleList, Unit};
use gcode_session::{Request, simulate};
use gcode_tests::bench::Bench;

/// One axial hole at radius `r` with its mouth at height `y` and 15 deep, drilled at each angle of B.
fn drilled(r: f64, y: f64, angles: &[f64], machine: &Machine, reference: &Reference) -> Verdict {
    let mut text = format!("O1\nG90 G21\nS1500 M3\nG0 Y{:.3}\nX{r:.3}\n", y + 50.0);
    for b in angles {
        text.push_str(&format!(
            "B{b:.3}\nG0 Y{:.3}\nG1 Y{:.3} F10.\nG0 Y{:.3}\n",
            y + 2.0,
            y - 15.0,
            y + 50.0
        ));
    }
    text.push_str("M30\n");
    let request = Request::new("O1.nc", text.into_bytes(), machine.clone());
    let done = simulate(&request, &mut NoLibrary, None).unwrap();
    done.verify(reference, Tolerances::of(reference, Some(1.0)), &request)
}

/// The holes of [`drilled`] on a part in its place.
fn nominal(r: f64, y: f64, angles: &[f64]) -> Reference {
    let hole = |b: &f64| Hole {
        id: None,
        entry: [r * Deg(*b).cos(), y, r * Deg(*b).sin()],
        axis: [0.0, 1.0, 0.0],
        depth: 15.0,
        diameter: None,
        ..Hole::default()
    };
    Reference::of_list(HoleList {
        unit: Unit::Mm,
        holes: angles.iter().map(hole).collect(),
        stock: None,
        assumptions: None,
        stopped: None,
    })
    .unwrap()
}

fn misplaced(lines: &str) -> Machine {
    Machine::parse(&format!("[part]\n{lines}\n")).unwrap()
}

fn phis(lines: &str, angles: &[f64]) -> Vec<f64> {
    let machine = misplaced(lines);
    let verdict = drilled(300.0, 320.0, angles, &machine, &nominal(300.0, 320.0, angles));
    assert_eq!(verdict.holes.len(), angles.len(), "{:?}", verdict.missing);
    verdict.holes.iter().map(|hole| hole.position_deviation).collect()
}

fn near(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-9, "{found} is not {expected}");
    }
}

/// Φ is twice the distance, wherever on the part the hole is, and for both signs.
#[test]
fn a_part_shifted_by_0_05_puts_every_hole_out_by_0_1() {
    for shift in ["[0.05, 0, 0]", "[-0.05, 0, 0]", "[0, 0, 0.05]", "[0, 0, -0.05]", "[0.03, 0, -0.04]"] {
        near(&phis(&format!("shift = {shift}"), &[0.0, 90.0, 180.0, 270.0]), &[0.1; 4]);
    }
}

/// Along the hole a shift changes the depth: the part stands 0.05 higher, so the drill goes 0.05 deeper.
#[test]
fn a_part_shifted_along_the_hole_changes_its_depth() {
    for (shift, deeper) in [("0.05", 0.05), ("-0.05", -0.05)] {
        let machine = misplaced(&format!("shift = [0, {shift}, 0]"));
        let verdict = drilled(300.0, 320.0, &[0.0, 180.0], &machine, &nominal(300.0, 320.0, &[0.0, 180.0]));
        for hole in &verdict.holes {
            assert!(hole.position_deviation < 1e-9 && (hole.depth_error - deeper).abs() < 1e-9, "{hole:?}");
        }
    }
}

/// By hand: the part is turned by δ about z at B = 0. At B = 0 the drill stops at machine (300, 305, 0), on the part at
/// (300·c + 305·s, 305·c − 300·s), and its axis is (s, c, 0) there: it meets the plane y = 320 a further
/// (320 − that y)·s/c on. At B = 180 the drill stands at the part's −300, before the tilt.
#[test]
fn a_part_tilted_by_a_tenth_of_a_degree_puts_holes_out_by_hand_computed_amounts() {
    for tilt in [0.1, -0.1] {
        let (s, c) = (Deg(tilt).sin(), Deg(tilt).cos());
        let phi = |x: f64| {
            let off = |y: f64| {
                let (deepest_x, deepest_y) = (x * c + 305.0 * s, 305.0 * c - x * s);
                (deepest_x + (y - deepest_y) * s / c - x).abs()
            };
            2.0 * off(320.0).max(off(305.0))
        };
        near(&phis(&format!("tilt = [0, 0, {tilt}]"), &[0.0, 180.0]), &[phi(300.0), phi(-300.0)]);
    }
    // The numbers themselves: about 2·320·0.1° in rad = 1.117 at either side.
    near(&[(phis("tilt = [0, 0, 0.1]", &[0.0])[0] * 1e3).round()], &[1118.0]);
    // About x the same happens to the hole at 90°, and not to sideways ones but by their height.
    let about_x = phis("tilt = [0.1, 0, 0]", &[90.0, 270.0]);
    assert!(about_x.iter().all(|phi| (phi - 1.117).abs() < 0.002), "{about_x:?}");
}

/// About y a tilt is an azimuth: 0.1° at r = 300 is a chord of 2·300·sin 0.05°.
#[test]
fn a_part_turned_about_y_is_out_by_the_chord() {
    let chord = 2.0 * 300.0 * Deg(0.05).sin();
    near(&phis("tilt = [0, 0.1, 0]", &[0.0, 72.0, 180.0]), &[2.0 * chord; 3]);
    near(&phis("tilt = [0, -0.1, 0]", &[0.0]), &[2.0 * chord]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn holes_on_a_misplaced_part_are_right_against_a_reference_moved_alike(
        (r, y) in (0.0..900.0, -200.0..700.0),
        shift in prop::array::uniform3(-2.0..2.0),
        tilt in prop::array::uniform3(-0.1..0.1),
        first in -180.0..180.0f64,
    ) {
        let round = |v: f64| (v * 1000.0).round() / 1000.0;
        let (r, y): (f64, f64) = (round(r), round(y));
        let angles = if r < 1.0 { vec![round(first)] } else { vec![round(first), round(first + 137.0)] };
        let part = Placement { shift: Vector3::from(shift), tilt: tilt.map(Deg), ..Placement::default() };
        let moved = part.frame().inverse();
        let mut reference = nominal(r, y, &angles);
        for hole in &mut reference.holes {
            hole.entry = (moved * Point3::from(hole.entry)).coords.into();
            hole.axis = (moved.rotation * Vector3::from(hole.axis)).into();
        }
        let machine = Machine { part, ..Machine::default() };
        let verdict = drilled(r, y, &angles, &machine, &reference);
        prop_assert_eq!(verdict.holes.len(), angles.len());
        for hole in &verdict.holes {
            prop_assert!(hole.position_deviation < 1e-8 && hole.depth_error.abs() < 1e-8, "{:?}", hole);
        }
    }
}

/// The holes that a machine with errors drills are out of position and straight: no finding on a sideways move.
#[test]
fn a_machine_with_errors_moves_the_holes_and_has_no_other_finding() {
    let bench = Bench::example("melon-mould", &[]);
    let mut worst = Vec::new();
    for seed in 0..8 {
        let errors = format!(
            "[errors.linear]\nx = {{ uniform = 0.01 }}\ny = {{ normal = 0.005 }}\nseed = {seed}\n\
             [errors.rotary]\nindex = {{ normal = 0.001 }}\ncentre.x = {{ normal = 0.005 }}\ntilt.z = {{ normal = 0.001 }}\nseed = {seed}\n\
             [errors.head]\nangle = {{ normal = 0.005 }}\nseed = {seed}\n"
        );
        let bench = bench.clone().with_machine(&format!("\n{errors}"));
        let verdict = || check(&bench.job, &bench.package).unwrap().verdict.into_holes().unwrap();
        let found = verdict();
        let other: Vec<_> = found
            .diagnostics
            .iter()
            .filter(|finding| !["hole-position", "holes-alike"].contains(&finding.kind.code))
            .collect();
        assert!(other.is_empty(), "{other:?}");
        assert_eq!(found.holes.len(), 5);
        assert_eq!(found.worst, verdict().worst, "the same seed is the same machine");
        worst.push(found.worst.unwrap());
    }
    assert!(worst.iter().all(|phi| (0.005..0.3).contains(phi)), "{worst:?}");
    worst.dedup();
    assert_eq!(worst.len(), 8, "each seed is another machine");
}
