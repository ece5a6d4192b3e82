//! Points of the chord that the probe touched correct y and nothing else; and a run-out that is broken off leaves no result.
use gcode_control::{Limits, Outcome};
use gcode_inspect::machine::Placement;
use gcode_tests::alignment::{Bench, alarm, placement, vacant, value};

/// By hand, to first order: at x the part stands higher by y, by δ·x·(1 − b²/a²) for a tilt δ about z, and by dx·(b²/a²)·x/Y for a
/// shift along x, with Y the height there. The straight line through E and F leaves nothing of the tilt at x = 0. Of dx = 0.05 it
/// leaves (0.1784·812.4 − 0.6145·318)/494.4·0.05 = −0.0051, for (b²/a²)·x/Y is 0.6145 at E and 0.1784 at F. z and the turns about x
/// and y have no first order in the plane z = 0. What rounding to 0.001 leaves is less than 0.0005.
#[test]
fn touched_points_correct_y_and_nothing_else() {
    let bench = Bench::of(&[]);
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
        let run = bench.run(8200, &placement(shift, tilt), &[]);
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
    for (f, expected) in [("f_radius = 665.0", Some(3072)), ("f_radius = 664.0", None)] {
        let run = Bench::of(&[("f_radius = 318.0", f)]).run(8200, &Placement::default(), &[]);
        assert_eq!(alarm(&run), expected, "{f}");
        assert_eq!(run.control.stops().is_empty(), expected.is_some(), "{f}");
        assert!((501..=560).chain([578]).all(|number| vacant(&run, number)), "touched points are used once");
    }
}

/// Yesterday's results of both passes are gone from the start, and what a fit has found so far is none.
#[test]
fn a_run_out_that_is_broken_off_leaves_nothing() {
    let bench = Bench::of(&[]);
    let yesterday: Vec<_> = (580..586).chain(590..596).map(|number| (number, 0.25)).collect();
    let off = placement([0.2, 0.0, -0.1], [0.1, 0.0, 0.2]);
    let whole = bench.run(8210, &off, &yesterday);
    assert!((580..586).chain(590..596).all(|number| !vacant(&whole, number)));
    // The first pass ends behind half of the blocks; 22 readings of 12 blocks are done after 400 at most, then four rounds of the fit.
    let all = whole.control.blocks();
    for part in [0.05, 0.1, 0.2, 0.3, 0.4, 0.45] {
        let blocks = (all as f64 * part) as u64;
        let run = Bench { limits: Limits { blocks }, ..bench.clone() }.run(8210, &off, &yesterday);
        assert!(matches!(run.outcome, Outcome::Limit), "{:?}", run.outcome);
        assert!((580..586).chain(590..596).all(|number| vacant(&run, number)), "{blocks} of {all}");
    }
    // In the second pass the first one's stand, and none of its own.
    let blocks = (all as f64 * 0.8) as u64;
    let run = Bench { limits: Limits { blocks }, ..bench }.run(8210, &off, &yesterday);
    assert!((580..586).all(|number| vacant(&run, number)));
    assert!((590..596).all(|number| !vacant(&run, number)));
}
