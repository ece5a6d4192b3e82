//! The alignment programs on parts that are misplaced by amounts they don't know: what they find, and what the correction achieves.
use std::fmt::Write;

use nalgebra::{Point3, Rotation3, Translation3, Vector3};
use proptest::prelude::*;

use gcode_gen::check::Programs;
use gcode_inspect::machine::{Frame, Placement};
use gcode_inspect::verify::{Answer, Tolerances, Verdict};
use gcode_lang::units::Deg;
use gcode_part::NominalPart;
use gcode_session::{Run, simulate};
use gcode_tests::bench::{Bench, alarm, example, marks, placement, value};
use gcode_tests::{root, workspace};

/// The run-out's result: shift in x and z, tilt about x and z.
fn found(run: &Run) -> [f64; 4] {
    assert_eq!(alarm(run), None);
    [580, 581, 582, 583].map(|number| value(run, number))
}

fn near(found: [f64; 4], [x, _, z]: [f64; 3], [about_x, _, about_z]: [f64; 3]) -> bool {
    let off = |index: usize, real: f64| (found[index] - real).abs();
    off(0, x).max(off(1, z)) < 0.01 && off(2, about_x).max(off(3, about_z)) < 0.004
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Whatever hides: shifts to 0.3 mm along all axes, tilts to 0.3° about all axes, either sense of the rotary, any
    /// letter, any increment, a dome or a slender part.
    #[test]
    fn the_run_out_is_found_from_probing_alone(
        shift in prop::array::uniform3(-0.3..0.3),
        tilt in prop::array::uniform3(-0.3..0.3),
        (letter, sign) in (prop::sample::select(vec!["A", "B", "C"]), prop::sample::select(vec![1, -1])),
        increment in prop::sample::select(vec!["IS-A", "IS-B", "IS-C"]),
        dialect in prop::sample::select(vec!["fanuc-31i", "fanuc-0i-f", "haas-ngc"]),
        (from, to) in (-60.0..-20.0f64, 20.0..60.0f64),
        (a, b) in prop::sample::select(vec![("1158.8", "724.3"), ("700.0", "1500.0")]),
    ) {
        let job = example("alignment")
            .replace("letter = \"B\", sign = 1", &format!("letter = \"{letter}\", sign = {sign}"))
            .replace("increment = \"IS-B\"", &format!("increment = \"{increment}\""))
            .replace("dialect = \"fanuc-31i\"", &format!("dialect = \"{dialect}\""))
            .replace("e_radius = 812.4", "e_radius = 512.4")
            .replace("a = 1158.8", &format!("a = {a}"))
            .replace("b = 724.3", &format!("b = {b}"))
            .replace("[-25.0, 25.0, 11]", &format!("[{from:.3}, {to:.3}, 9]"));
        let found = found(&Bench::of(&job).run(8210, &placement(shift, tilt), &[]));
        prop_assert!(near(found, shift, tilt), "{:?} where {:?} {:?} is", found, shift, tilt);
    }

    /// The pair of a search through all of them here, whatever the candidates are; and its length's difference.
    #[test]
    fn the_chord_is_the_one_that_a_search_finds(
        scatter in prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), 20),
        count in 1usize..=10,
    ) {
        let model = [[812.4, 516.49, 0.0], [318.0, 696.5, 0.0]];
        let bench = Bench::example("alignment", &[&format!("candidates = 10 => candidates = {count}")]);
        let points: Vec<[f64; 3]> = scatter
            .iter()
            .enumerate()
            .map(|(index, by)| std::array::from_fn(|axis| model[index / 10][axis] + by[axis]))
            .collect();
        let variables: Vec<_> = (501..).zip(points.iter().flatten().copied()).collect();
        let run = bench.run(8200, &Placement::default(), &variables);
        prop_assert_eq!(alarm(&run), None);
        // The model's chord by the ellipse's equation.
        let y = |x: f64| 724.3 * (1.0 - x * x / (1158.8 * 1158.8)).sqrt();
        let chord = Point3::new(812.4, y(812.4), 0.0) - Point3::new(318.0, y(318.0), 0.0);
        let mut best = (0, 0, f64::INFINITY);
        for e in 0..count {
            for f in 0..count {
                let difference =
                    (Point3::from(points[e]) - Point3::from(points[10 + f])).norm() - chord.norm();
                if difference.abs() < best.2.abs() {
                    best = (e + 1, f + 1, difference);
                }
            }
        }
        prop_assert_eq!((value(&run, 570), value(&run, 571)), (best.0 as f64, best.1 as f64));
        prop_assert!((value(&run, 572) - best.2).abs() < 1e-7);
    }
}

/// The five holes of the main example on a misplaced part, with Y of G54.
fn five_holes(part: Placement, zero: f64) -> Verdict {
    let bench = Bench::example("melon-mould", &[]);
    let mut request = bench.request(8100);
    request.machine.part = part;
    request.variables.push((5222, zero));
    let reference = NominalPart::from_job(&bench.job).unwrap().into_holes().unwrap();
    let done = simulate(&request, &mut Programs(&bench.package), reference.surface).unwrap();
    done.verify(&reference, Tolerances::of(&reference, Some(0.1)), &request)
}

/// What is left of a misplacement when the part is moved back by what was found: R'⁻¹·(R·p + d − d'), written out with
/// rotations about the axes, none of them the program's.
fn corrected(shift: [f64; 3], tilt: [f64; 3], found: [f64; 4]) -> Placement {
    let about = |axis, degrees: f64| Rotation3::from_axis_angle(&axis, Deg(degrees).to_rad());
    let frame = |shift: [f64; 3], [x, y, z]: [f64; 3]| {
        let turn = about(Vector3::z_axis(), z) * about(Vector3::y_axis(), y) * about(Vector3::x_axis(), x);
        Frame::from_parts(Translation3::from(Vector3::from(shift)), turn)
    };
    let [x, z, about_x, about_z] = found;
    let left = frame([x, 0.0, z], [about_x, 0.0, about_z]).inverse() * frame(shift, tilt);
    let (about_x, about_y, about_z) = left.rotation.euler_angles();
    let shift = left.translation.vector;
    let tilt = [about_x, about_y, about_z].map(|angle| Deg::from_rad(angle).0);
    let part = placement(shift.into(), tilt);
    assert!((part.frame().to_homogeneous() - left.to_homogeneous()).norm() < 1e-9, "the same motion");
    part
}

/// Before alignment the holes are out of position, after the run-out and the chord they are within Φ0.1. The run-out alone isn't enough for
/// a part that stands too high or too low: O8200 touches it and corrects Y of the work offset. The positions are those of the table in
/// docs/methods/alignment.md.
#[test]
fn the_five_holes_are_in_tolerance_after_the_correction_alone() {
    let bench = Bench::example("alignment", &[]);
    let mut rows: Vec<String> = (1..=5).map(|id| format!("| {id} |")).collect();
    for (shift, tilt) in [
        ([0.3, 0.25, -0.2], [0.15, 0.0, -0.3]),
        ([-0.25, -0.3, 0.3], [-0.3, 0.0, 0.2]),
        ([0.06, 0.0, 0.0], [0.0, 0.0, 0.0]),
    ] {
        let before = five_holes(placement(shift, tilt), 0.0);
        assert_eq!(before.verdict, Answer::Fail, "{shift:?} {tilt:?}");
        let found = found(&bench.run(8210, &placement(shift, tilt), &[]));
        let part = corrected(shift, tilt, found);
        let run_out = five_holes(part, 0.0);
        let enough = if shift[1] == 0.0 { Answer::Pass } else { Answer::Fail };
        assert_eq!(run_out.verdict, enough, "{shift:?} {tilt:?}: {:?}", run_out.worst);
        let chord = bench.run(8200, &part, &[]);
        assert_eq!(alarm(&chord), None);
        assert!((value(&chord, 574) - shift[1]).abs() < 0.001, "{}", value(&chord, 574));
        let after = five_holes(part, value(&chord, 5222));
        assert_eq!(after.verdict, Answer::Pass, "{found:?}: {:?}", after.worst);
        assert_eq!(after.holes.len(), 5);
        assert!(after.worst.unwrap() < 0.05, "{found:?}: {:?}", after.worst);
        for (row, after) in rows.iter_mut().zip(&after.holes) {
            // A hole that is far off matches no nominal one.
            for verdict in [&before, &run_out] {
                let hole = verdict.holes.iter().find(|hole| hole.id == after.id);
                let phi =
                    hole.map_or("not there".to_owned(), |hole| format!("{:.3}", hole.position_deviation));
                row.push_str(&format!(" {phi} |"));
            }
            row.push_str(&format!(" {:.3} |", after.position_deviation));
        }
    }
    rows.iter().for_each(|row| on_the_page(row));
}

/// Fails if docs/methods/alignment.md doesn't have this text.
pub(crate) fn on_the_page(text: &str) {
    let page = std::fs::read_to_string(workspace().join("docs/methods/alignment.md")).unwrap();
    assert!(page.contains(text), "docs/methods/alignment.md doesn't have\n{text}");
}

/// A second pass on the corrected part shows what is left: next to nothing.
#[test]
fn a_second_pass_shows_what_remains() {
    let (shift, tilt) = ([0.3, 0.0, -0.2], [0.15, 0.0, -0.3]);
    let bench = Bench::example("alignment", &[]);
    let first = bench.run(8210, &placement(shift, tilt), &[]);
    assert_eq!(value(&first, 590), value(&first, 580), "the part isn't corrected between the passes here");
    assert!(value(&first, 585) < 1e-5, "the fit leaves nothing: {}", value(&first, 585));
    let second = bench.run(8210, &corrected(shift, tilt, found(&first)), &[]);
    let left = found(&second);
    assert!(left.iter().all(|value| value.abs() < 1e-4), "{left:?}");
}

/// The standard deviations of the results with a noisy probe: the table of docs/methods/alignment.md.
#[test]
fn noise_of_the_probe_spreads_the_results_as_the_page_states() {
    let mut sums = [0.0; 4];
    let parts = 40;
    let bench = Bench::example("alignment", &[]);
    for seed in 0..parts {
        let noise = format!("\n[errors.probe]\nnoise = {{ normal = 0.001 }}\nseed = {seed}\n");
        let noisy = bench.clone().with_machine(&noise);
        let found = found(&noisy.run(8210, &placement([0.1, 0.0, 0.0], [0.0; 3]), &[]));
        for (sum, (found, real)) in sums.iter_mut().zip(found.into_iter().zip([0.1, 0.0, 0.0, 0.0])) {
            *sum += (found - real) * (found - real) / f64::from(parts);
        }
    }
    // The page's standard deviations, in mm and degrees; of forty parts they come out within a third.
    for (variance, page) in sums.into_iter().zip([0.001_0, 0.001_8, 0.000_21, 0.000_84]) {
        let ratio = variance.sqrt() / page;
        assert!((0.66..1.4).contains(&ratio), "{} where the page has {page}", variance.sqrt());
    }
}

/// A right-hand rotation about X by 0.2° takes the pole towards Z+ and lowers the side towards Z+: between supports 1 m apart in Z by
/// 1000·sin 0.2°, 20 times the 0.1745 of the set-up sheet. So the side towards Z+ gets the shim if #582 is above 0.
#[test]
fn the_set_up_sheet_shims_the_side_that_a_tilt_lowers() {
    for tilt in [0.2, -0.2] {
        let part = placement([0.0; 3], [tilt, 0.0, 0.0]);
        let [_, _, about_x, _] = found(&Bench::example("alignment", &[]).run(8210, &part, &[]));
        assert!((about_x - tilt).abs() < 0.004, "{about_x}");
        let stands = part.frame();
        let [top, towards, away] =
            [[0.0, 700.0, 0.0], [0.0, 0.0, 500.0], [0.0, 0.0, -500.0]].map(|p| stands * Point3::from(p));
        assert!(0.0 < top.z * about_x, "the top leans towards Z+ where #582 is above 0");
        let shim = away.y - towards.y;
        assert!((shim - tilt / 0.01 * 0.1745).abs() < 0.001, "{shim}");
    }
    let sheet = root().join("sheet/an_alignment_has_its_gauge_blocks/sheet.snap");
    let sheet = std::fs::read_to_string(sheet).unwrap();
    for words in [
        "#582 above 0: the top leans towards Z+, so shim the side towards Z+.",
        "is 0.1745 mm thick for each 0.01° and metre between the supports in Z",
    ] {
        assert!(sheet.contains(words), "{words}");
    }
}

/// Both ends 0.9 aside, the way of azimuths that grow: by hand, tan = (812.4 + 318)·0.9/(812.4² + 318²) = 0.001 336 7, which is
/// 0.076 59°. A chord turned by that leaves 0.9 − 812.4·0.001 336 7 = −0.186 at E and +0.475 at F. E alone 0.9 aside is
/// 812.4·0.9/761 118 = 0.055 04°. X and Z of G54 stay, wherever the marks are.
#[test]
fn marks_correct_y_and_the_rotary_alone() {
    let aside = |of: std::ops::Range<u32>, axis: u32, by: f64| -> Vec<(u32, f64)> {
        let moved = |n: u32| of.contains(&n) && (n - 501) % 3 == axis;
        let one_each = |n: u32| if n < 531 { 501 + (n - 501) % 3 } else { 531 + (n - 531) % 3 };
        let marks = marks();
        let first = |n: u32| marks.iter().find(|(number, _)| *number == one_each(n)).unwrap().1;
        (501..561).map(|n| (n, first(n) + if moved(n) { by } else { 0.0 })).collect()
    };
    for (set, y, rotary) in [
        (aside(501..561, 2, 0.9), 0.0, 0.076_59),
        (aside(501..531, 2, 0.9), 0.0, 0.055_04),
        (aside(501..561, 2, -0.9), 0.0, -0.076_59),
        (aside(501..561, 0, 0.9), 0.0, 0.0),
        (aside(501..561, 1, -0.3), -0.3, 0.0),
    ] {
        for sign in [1.0, -1.0] {
            let bench = Bench::example("alignment", &[&format!("sign = 1 }} => sign = {sign} }}")]);
            let run = bench.run(8200, &Placement::default(), &set);
            assert_eq!(alarm(&run), None);
            assert!((value(&run, 574) - y).abs() < 1e-6, "{}", value(&run, 574));
            assert!((value(&run, 576) - sign * rotary).abs() < 2e-5, "{}", value(&run, 576));
            assert_eq!([5221, 5223].map(|number| value(&run, number)), [0.0; 2]);
            assert!(
                (value(&run, 5222) - y).abs() < 0.0006 && (value(&run, 5225) - sign * rotary).abs() < 0.0006
            );
        }
    }
}

/// By hand: with the zero of X too far out by w every point is w nearer to the axis, which the page's table has as −0.012 and +0.0014° for
/// 0.01. With the zero of Z off the ball touches a round part beside its middle: nothing of first order. With the zero of Y off the part
/// stands lower by w. Marks show all three with the sign that corrects them.
#[test]
fn a_wrong_work_zero_is_taken_for_the_part_as_the_page_states() {
    let bench = Bench::example("alignment", &[]);
    let good = Placement::default();
    let mut table = String::new();
    for (axis, name) in ["X", "Y", "Z"].into_iter().enumerate() {
        let zero = [(5221 + axis as u32, 0.05)];
        let run = bench.run(8210, &good, &zero);
        assert_eq!(alarm(&run), None, "{name}");
        let touched = bench.run(8200, &good, &zero);
        assert_eq!(alarm(&touched), None, "{name}");
        // What is typed in is read in the same work offset.
        let typed =
            marks().into_iter().map(|(n, v)| (n, if (n - 501) as usize % 3 == axis { v - 0.05 } else { v }));
        let marked = bench.run(8200, &good, &typed.chain(zero).collect::<Vec<_>>());
        assert_eq!(alarm(&marked), None, "{name}");
        let mut row = format!("| {name} |");
        for (number, places) in [(580, 3), (581, 3), (582, 4), (583, 4), (584, 3), (585, 4)] {
            let _ = write!(row, " {} |", figure(value(&run, number), places));
        }
        let by = [573, 574, 575].map(|number| figure(value(&marked, number), 3)).join(", ");
        let _ = writeln!(table, "{row} {} | {by} |", figure(value(&touched, 574), 3));
    }
    on_the_page(&table);
}

/// `+0.050`, `0`.
fn figure(value: f64, places: usize) -> String {
    let text = format!("{value:+.places$}");
    if text.trim_start_matches(['+', '-', '0', '.']).is_empty() { "0".to_owned() } else { text }
}

/// 200·sin 38.5° is 124.503 by the set of 87: 1.003 for the last digit, which leaves 123.5, and no block is as thick. At 0° no block is
/// needed, and the angle has no error.
#[test]
fn the_sine_table_program_names_the_gauge_blocks() {
    for (phi, words) in [
        ("38.5", "(BLOCKS 100 + 20 + 3.5 + 1.003)\n(THEY MAKE 0.10 SECONDS OF ARC TOO MUCH)\n"),
        ("0.0", "(NO BLOCKS, THE TABLE LIES FLAT)\n(AFTER O8210"),
    ] {
        let bench = Bench::example("alignment", &[&format!("phi = 38.5 => phi = {phi}")]);
        let text = &bench.package.program(8230).unwrap().text;
        assert!(text.contains(&format!("(GAUGE BLOCKS METRIC-87)\n{words}")), "{text}");
    }
}
