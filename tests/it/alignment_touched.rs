//! Points of the chord that the probe touched correct y and nothing else; and a run-out that is broken off leaves no result.
use std::path::Path;

use gcode_gen::check::Programs;
use gcode_gen::families;
use gcode_gen::package::Package;
use gcode_sim::alarm::Code;
use gcode_sim::exec::{Limits, Outcome};
use gcode_sim::holes::Extractor;
use gcode_sim::job::Job;
use gcode_sim::machine::{Machine, Placement};
use gcode_sim::part::surface::Surface;
use gcode_sim::session::{Request, Run, run};
use gcode_sim::units::Deg;

const BODY: Surface = Surface::Ellipsoid { a: 1158.8, b: 724.3 };

fn package(change: (&str, &str)) -> Package {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/alignment/job.toml");
    let text = std::fs::read_to_string(path).unwrap();
    assert!(text.contains(change.0), "{}", change.0);
    families::emit(&Job::parse(&text.replace(change.0, change.1)).unwrap())
}

fn ran(package: &Package, main: u32, part: &Placement, set: &[(u32, f64)], limits: Limits) -> Run {
    let machine = Machine { part: *part, ..Machine::parse(&package.machine).unwrap() };
    let text = package.program(main).unwrap().text.clone().into_bytes();
    let mut request = Request::new(format!("O{main}.nc"), text, machine);
    request.variables = set.to_vec();
    request.limits = limits;
    let mut probe = Extractor::new(&request.machine).with_surface(Some(BODY));
    run(&request, &mut Programs(package), &mut probe).unwrap()
}

fn standing(shift: [f64; 3], tilt: [f64; 3]) -> Placement {
    Placement { shift: shift.into(), tilt: tilt.map(Deg), ..Placement::default() }
}

fn vacant(run: &Run, number: u32) -> bool {
    run.control.variable(number).unwrap().is_vacant()
}

fn value(run: &Run, number: u32) -> f64 {
    run.control.variable(number).unwrap().number()
}

/// By hand, to first order: at x the part stands higher by y, by δ·x·(1 − b²/a²) for a tilt δ about z, and by dx·(b²/a²)·x/Y for a
/// shift along x, with Y the height there. The straight line through E and F leaves nothing of the tilt at x = 0. Of dx = 0.05 it
/// leaves (0.1784·812.4 − 0.6145·318)/494.4·0.05 = −0.0051, for (b²/a²)·x/Y is 0.6145 at E and 0.1784 at F. z and the turns about x
/// and y have no first order in the plane z = 0. What rounding to 0.001 leaves is less than 0.0005.
#[test]
fn touched_points_correct_y_and_nothing_else() {
    let package = package(("candidates = 10", "candidates = 10"));
    for (shift, tilt, y) in [
        ([0.0; 3], [0.0; 3], 0.0),
        ([0.0; 3], [0.0, 0.0, 0.0018], 0.0),
        ([0.0; 3], [0.0, 0.0, 0.004], 0.0),
        ([0.0; 3], [0.0, 0.0, -0.008], 0.0),
        ([0.05, 0.0, 0.0], [0.0; 3], -0.0051),
        ([-0.05, 0.0, 0.0], [0.0; 3], 0.0051),
        ([0.0, 0.3, 0.0], [0.0; 3], 0.3),
        ([0.0, -0.3, 0.0], [0.0; 3], -0.3),
        ([0.01, 0.12, -0.01], [0.004, 0.3, -0.004], 0.119),
    ] {
        let run = ran(&package, 8200, &standing(shift, tilt), &[], Limits::default());
        assert!(matches!(run.outcome, Outcome::End), "{:?}", run.outcome);
        assert_eq!([570, 571].map(|number| value(&run, number)), [1.0; 2], "{shift:?} {tilt:?}");
        assert_eq!([573, 575, 576].map(|number| value(&run, number)), [0.0; 3], "{shift:?} {tilt:?}");
        let found = value(&run, 574);
        assert!((found - y).abs() < 0.0005, "{found} is not {y}, {shift:?} {tilt:?}");
        // X, Y, Z and B of G54: nothing but Y, to the increment.
        assert_eq!([5221, 5223, 5225].map(|number| value(&run, number)), [0.0; 3]);
        assert!((value(&run, 5222) - found).abs() < 0.0006, "{shift:?} {tilt:?}");
        assert!((501..=560).chain([578]).all(|number| vacant(&run, number)));
    }
}

/// More than ten: 812.4 + 665 is 10.02 times 812.4 − 665, 812.4 + 664 is 9.95 times 812.4 − 664.
#[test]
fn a_chord_too_short_to_tell_y_is_an_alarm_before_the_stop() {
    for (f, alarm) in [("f_radius = 665.0", true), ("f_radius = 664.0", false)] {
        let run = ran(&package(("f_radius = 318.0", f)), 8200, &Placement::default(), &[], Limits::default());
        assert_eq!(run.control.stops().is_empty(), alarm, "{f}");
        match &run.outcome {
            Outcome::Alarm(stopped) => assert_eq!((stopped.alarm.row().code, alarm), (Code::Mc(3072), true)),
            _ => assert!(!alarm, "{f}"),
        }
    }
}

/// Yesterday's results of both passes are gone from the start, and what a fit has found so far is none.
#[test]
fn a_run_out_that_is_broken_off_leaves_nothing() {
    let package = package(("candidates = 10", "candidates = 10"));
    let yesterday: Vec<_> = (580..586).chain(590..596).map(|number| (number, 0.25)).collect();
    let off = standing([0.2, 0.0, -0.1], [0.1, 0.0, 0.2]);
    let whole = ran(&package, 8210, &off, &yesterday, Limits::default());
    assert!((580..586).chain(590..596).all(|number| !vacant(&whole, number)));
    // The first pass ends behind half of the blocks; 22 readings of 12 blocks are done after 400 at most, then four rounds of the fit.
    let all = whole.control.blocks();
    for part in [0.05, 0.1, 0.2, 0.3, 0.4, 0.45] {
        let blocks = (all as f64 * part) as u64;
        let run = ran(&package, 8210, &off, &yesterday, Limits { blocks });
        assert!(matches!(run.outcome, Outcome::Limit), "{:?}", run.outcome);
        assert!((580..586).chain(590..596).all(|number| vacant(&run, number)), "{blocks} of {all}");
    }
    // In the second pass the first one's stand, and none of its own.
    let run = ran(&package, 8210, &off, &yesterday, Limits { blocks: (all as f64 * 0.8) as u64 });
    assert!((580..586).all(|number| vacant(&run, number)));
    assert!((590..596).all(|number| !vacant(&run, number)));
}
