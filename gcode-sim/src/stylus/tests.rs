//! An edge finder's ball round a sphere and an ellipsoid: readings worked out by hand.
use super::*;
use crate::holes::script::Script;
use crate::units::Deg;

const SPHERE: Surface = Surface::Ellipsoid { a: 100.0, b: 100.0 };

fn followed(machine: &Machine, surface: Surface, script: &Script) -> Followed {
    let mut stylus = Stylus::new(machine, surface, 3.0);
    script.play(&mut stylus);
    stylus.finish()
}

/// Down to the top of a sphere of 100 and along a chord of the ball's path, a sphere of 103: from 10° beside the pole to
/// 10° on the other side.
fn over_the_top() -> Script {
    let (x, y) = (103.0 * Deg(10.0).sin(), 103.0 * Deg(10.0).cos());
    let at = |x: f64, y: f64| format!("X{x} Y{y}");
    Script::new().rapid(&at(-x, 200.0)).feed(&at(-x, y)).feed(&at(x, y)).feed(&at(x, 200.0))
}

/// The chord is nearest in its middle: 103·cos 10° = 101.4352, which is 1.5648 too near. Approach and retract cross the
/// surface at 10° to its normal and aren't read.
#[test]
fn a_chord_is_read_where_it_is_nearest() {
    let found = followed(&Machine::default(), SPHERE, &over_the_top());
    let [pass] = found.passes.as_slice() else { panic!("{found:?}") };
    let (least, greatest) = pass.extremes().unwrap();
    assert!((least.value - (103.0 * Deg(10.0).cos() - 103.0)).abs() < 1e-9, "{least:?}");
    assert!(least.at.x.abs() < 1e-9 && greatest.value.abs() < 1e-9, "{greatest:?}");
    assert!((pass.length() - 206.0 * Deg(10.0).sin()).abs() < 1e-9 && pass.places.len() == 1);
}

/// The part stands 0.05 farther in x and 0.02 lower than the program believes: on the right its surface comes nearer. At the
/// ends of the chord its centre is (±17.886 − 0.05, 101.435 + 0.02) away.
#[test]
fn a_misplaced_part_is_read_as_it_stands() {
    let mut machine = Machine::default();
    machine.part.shift = nalgebra::Vector3::new(0.05, -0.02, 0.0);
    let found = followed(&machine, SPHERE, &over_the_top());
    let readings = &found.passes[0].readings;
    let (x, y) = (103.0 * Deg(10.0).sin(), 103.0 * Deg(10.0).cos());
    for (reading, x) in [(readings[0], -x), (readings[readings.len() - 1], x)] {
        let expected = libm::hypot(x - 0.05, y + 0.02) - 103.0;
        assert!((reading.value - expected).abs() < 1e-9, "{reading:?} is not {expected}");
        assert!((reading.at.x - x).abs() < 1e-9, "it stands where the program believes: {reading:?}");
    }
    assert!(readings[0].value > 0.028 && readings[readings.len() - 1].value < 0.012);
}

#[test]
fn what_crosses_the_surface_or_is_far_from_it_is_no_reading() {
    let script =
        Script::new().rapid("X0 Y200").feed("Y103").feed("Y200").feed("X50").rapid("X-5 Y103.1").rapid("X5");
    let found = followed(&Machine::default(), SPHERE, &script);
    assert!(found.passes.is_empty() && found.findings.is_empty(), "{found:?}");
}

/// The table turns a sphere that stands 0.3 out of its axis under a ball that stands still.
#[test]
fn a_turning_table_is_read_as_well() {
    let mut machine = Machine::default();
    machine.part.shift.x = 0.3;
    let script = Script::new().rapid("X200 Y0").rapid("X103").feed("B180").rapid("X200");
    let found = followed(&machine, SPHERE, &script);
    let (least, greatest) = found.passes[0].extremes().unwrap();
    // At B 0 the part is 0.3 nearer, at B 180 it is 0.3 farther away.
    assert!(
        (least.value + 0.3).abs() < 1e-4 && (greatest.value - 0.3).abs() < 1e-4,
        "{least:?} {greatest:?}"
    );
    assert_eq!(least.along, 0.0);
}
