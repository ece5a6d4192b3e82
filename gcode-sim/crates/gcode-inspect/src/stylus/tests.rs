//! Readings of an edge finder round a sphere and an ellipsoid, computed by hand.
use super::*;
use crate::findings::{PATH_NOT_READ, START_UNKNOWN};
use crate::holes::event_script::EventScript;
use crate::machine::{Head, HeadKind};
use gcode_lang::motion::Position;
use gcode_lang::units::{Deg, MmPerMin};
use gcode_part::Surface;

const SPHERE: Surface = Surface::Ellipsoid { a: 100.0, b: 100.0 };

fn readings(machine: &Machine, script: &EventScript) -> StylusReadings {
    let mut stylus = Stylus::new(machine, SPHERE, 3.0);
    script.emit_to(&mut stylus);
    stylus.finish()
}

fn rapids(machine: &Machine, script: &EventScript) -> Vec<String> {
    let mut rapids = RapidChecker::new(machine, SPHERE, 3.0);
    script.emit_to(&mut rapids);
    rapids.finish().into_iter().map(|finding| finding.message).collect()
}

/// Returns the default machine with the part shifted from its nominal position.
fn shifted(x: f64, y: f64) -> Machine {
    let mut machine = Machine::default();
    (machine.part.shift.x, machine.part.shift.y) = (x, y);
    machine
}

/// Feeds to the path of the ball round a sphere of 100, a sphere of 103, and along a chord of it: from 10° on one side of
/// the pole to 10° on the other.
fn over_the_top() -> EventScript {
    let (x, y) = (103.0 * Deg(10.0).sin(), 103.0 * Deg(10.0).cos());
    EventScript::new().then(&format!("rapid X-{x} Y200; feed Y{y}; feed X{x}; feed Y200"))
}

/// The chord is nearest in its middle: 103·cos 10° = 101.4352 is 1.5648 too near. Approach and retract cross the surface at
/// 10° to its normal and have no readings.
#[test]
fn a_chord_is_read_where_it_is_nearest() {
    let found = readings(&Machine::default(), &over_the_top());
    let [pass] = found.passes.as_slice() else { panic!("{found:?}") };
    let (least, greatest) = pass.extremes().unwrap();
    assert!((least.value - (103.0 * Deg(10.0).cos() - 103.0)).abs() < 1e-9, "{least:?}");
    assert!(least.ball_centre.x.abs() < 1e-9 && greatest.value.abs() < 1e-9, "{greatest:?}");
    assert!((pass.length() - 206.0 * Deg(10.0).sin()).abs() < 1e-9 && pass.backtraces.len() == 1);
}

/// The part is 0.05 farther in x and 0.02 lower than nominal: on the right its surface is nearer. At the ends of the chord
/// its centre is (±17.886 − 0.05, 101.435 + 0.02) away.
#[test]
fn a_misplaced_part_is_read_at_its_actual_position() {
    let found = readings(&shifted(0.05, -0.02), &over_the_top());
    let readings = &found.passes[0].readings;
    let (first, last) = (readings[0], readings[readings.len() - 1]);
    let (x, y) = (103.0 * Deg(10.0).sin(), 103.0 * Deg(10.0).cos());
    for (reading, x) in [(first, -x), (last, x)] {
        let expected = libm::hypot(x - 0.05, y + 0.02) - 103.0;
        assert!((reading.value - expected).abs() < 1e-9, "{reading:?} is not {expected}");
        assert!((reading.ball_centre.x - x).abs() < 1e-9, "the nominal position: {reading:?}");
    }
    assert!(first.value > 0.028 && last.value < 0.012);
}

#[test]
fn motion_across_the_surface_or_far_from_it_has_no_readings() {
    let steps = "rapid X0 Y200; feed Y103; feed Y200; feed X50; rapid X-5 Y103.1; rapid X5";
    let found = readings(&Machine::default(), &EventScript::new().then(steps));
    assert!(found.passes.is_empty() && found.findings.is_empty(), "{found:?}");
}

/// The table rotates a sphere 0.3 off its axis under a stationary ball.
#[test]
fn a_rotating_table_is_read() {
    let script = EventScript::new().then("rapid X200 Y0; rapid X103; feed B180; rapid X200");
    let found = readings(&shifted(0.3, 0.0), &script);
    let (least, greatest) = found.passes[0].extremes().unwrap();
    // At B 0 the part is 0.3 nearer, at B 180 it is 0.3 farther away.
    assert!(
        (least.value + 0.3).abs() < 1e-4 && (greatest.value - 0.3).abs() < 1e-4,
        "{least:?} {greatest:?}"
    );
    assert_eq!(least.path_length, 0.0);
}

/// The path of the ball is a sphere of 103; the points are on it unless their name says otherwise.
#[test]
fn feeds_of_the_path_without_a_reading_are_reported() {
    let on = |x: f64| format!("X{x} Y{}", libm::sqrt(103.0 * 103.0 - x * x));
    let [a, b, c, d] = &[-20.0, -10.0, 0.0, 10.0].map(on);
    let (far_b, far_c) = ("X-12 Y122", "X0 Y123");
    let wrong_sign = b.replace('Y', "Y-");
    // The feeds after a rapid to X-20 Y110, the codes, and the number of feeds with readings.
    for (feeds, code, read) in [
        // The first feed goes to the surface, and the retract may be a feed.
        (vec![&**a, b, c, d], None, 3),
        (vec![a, b, c, "X0 Y150"], None, 2),
        // 20 mm off: one point, two points, those at the start, those at the end.
        (vec![a, far_b, c, d], Some("path-not-read"), 1),
        // A path without any reading is reported by the command.
        (vec![a, far_b, far_c, d], None, 0),
        (vec![far_b, far_c, c, d], Some("path-not-read"), 1),
        (vec![a, b, far_b, far_c], Some("path-not-read"), 1),
        // 8 mm deep in the middle and at the end; a Y with the wrong sign.
        (vec![a, b, "X0 Y95", d], Some("ball-into-part"), 1),
        (vec![a, b, "X0 Y95"], Some("ball-into-part"), 1),
        (vec![a, &wrong_sign, c, d], Some("ball-into-part"), 1),
        (vec!["X-20 Y90"], Some("ball-into-part"), 0),
    ] {
        let begin = EventScript::new().rapid("X-20 Y110");
        let script = feeds.iter().fold(begin, |script, words| script.feed(words)).rapid("Y200");
        let found = readings(&Machine::default(), &script);
        let codes: Vec<_> = found.findings.iter().map(|finding| finding.kind.code).collect();
        let feeds_read: usize = found.passes.iter().map(|pass| pass.backtraces.len()).sum();
        assert_eq!((codes, feeds_read), (code.into_iter().collect(), read), "{feeds:?}");
    }
}

/// The ball is fed past the part before a contact, after one, or between two: that feed may belong to the path, so it is
/// reported if there is a path.
#[test]
fn feeds_past_the_part_are_reported_if_there_is_a_path() {
    let (x, y) = (103.0 * Deg(10.0).sin(), 103.0 * Deg(10.0).cos());
    let over =
        |script: EventScript| script.then(&format!("rapid X-{x} Y200; feed Y{y}; feed X{x}; rapid Y200"));
    let after = over(EventScript::new()).feed("X50");
    let before = over(EventScript::new().then("rapid X0 Y200; feed X50; rapid Y210"));
    for (script, passes_before, passes) in [(before, 0, 1), (after.clone(), 1, 1), (over(after), 1, 2)] {
        let found = readings(&Machine::default(), &script);
        let [finding] = found.findings.as_slice() else { panic!("{:?}", found.findings) };
        assert_eq!(finding.kind, &PATH_NOT_READ);
        let [gap] = found.gaps.as_slice() else { panic!("{:?}", found.gaps) };
        assert_eq!((gap.passes_before, found.passes.len()), (passes_before, passes));
    }
}

/// A sphere of 100 is 15 mm farther out than nominal: a rapid to 10 mm before the ball's contact ends 5 mm in the part. One
/// that passes the pole at 101 deflects a ball of 3 by 2 mm. A head with its pivot 100 mm from the ball's centre is set by
/// hand to 0°: the ball is 100 mm beside the pivot towards −x, and a rapid of the pivot to x = 200 takes it to x = 100, 3 mm
/// in the sphere; at 90° it is 123.6 mm off.
#[test]
fn a_rapid_with_the_ball_into_the_part_is_reported() {
    let kind = HeadKind::Manual { start: Some(Deg(90.0)) };
    let tilting = Machine { head: Head::new(kind, 100.0), ..Machine::default() };
    for (machine, steps, deepest) in [
        (&shifted(15.0, 0.0), "rapid X150 Y0; rapid X113; rapid X150", Some("5.000")),
        (&shifted(15.0, 0.0), "rapid X150 Y0; rapid X119; rapid X150", None),
        (&Machine::default(), "rapid X-30 Y101; rapid X30", Some("2.000")),
        (&Machine::default(), "rapid X-30 Y103; rapid X30", None),
        (&tilting, "rapid X400 Y100; head 0; rapid X400 Y0; rapid X200", Some("3.000")),
        (&tilting, "rapid X400 Y100; head 90; rapid X400 Y0; rapid X200", None),
    ] {
        let found = rapids(machine, &EventScript::new().then(steps));
        assert_eq!(found.len(), usize::from(deepest.is_some()), "{steps}: {found:?}");
        assert!(deepest.is_none_or(|deepest| found[0].contains(deepest)), "{steps}: {found:?}");
    }
}

/// Half revolutions of the table under a ball 97 mm off the part take some hundred chords each, and an endless loop makes
/// any number of them.
#[test]
fn feeds_without_a_reading_end_at_the_limit_of_points() {
    let turns = |count: usize| {
        let begin = EventScript::new().rapid("X200 Y0");
        (0..count).fold(begin, |script, n| script.feed(if n % 2 == 0 { "B180" } else { "B0" }))
    };
    let machine = shifted(30.0, 0.0);
    let few = readings(&machine, &turns(10));
    assert!(few.findings.iter().all(|finding| finding.kind != &LIMIT), "{:?}", few.findings);
    let mut stylus = Stylus::new(&machine, SPHERE, 3.0);
    stylus.unread_points = MAX_UNREAD_POINTS - 1000;
    turns(20).emit_to(&mut stylus);
    let many = stylus.finish();
    let limits: Vec<_> = many.findings.iter().filter(|finding| finding.kind == &LIMIT).collect();
    assert_eq!(limits.len(), 1, "{limits:?}");
    assert!(limits[0].message.contains("no readings after this"), "{limits:?}");
}

/// Unknown axes in the order X Y Z A B C.
fn uncommanded(axes: u8) -> EventKind {
    EventKind::PositionUnknown { axes: UnknownAxes { uncommanded: axes, ..UnknownAxes::default() } }
}

fn unknown_starts(findings: &[Diagnostic]) -> Vec<&str> {
    findings.iter().filter(|f| f.kind == &START_UNKNOWN).map(|f| f.message.as_str()).collect()
}

/// Z is never commanded. A feed that begins at the unknown position is read there too.
#[test]
fn a_reading_with_an_axis_that_nothing_commands_is_an_error() {
    let (x, y) = (103.0 * Deg(10.0).sin(), 103.0 * Deg(10.0).cos());
    let path = |script: EventScript| {
        script.then(&format!("rapid X-{x} Y200; feed Y{y}")).then(&format!("feed X{x}; feed Y200"))
    };
    let all = EventScript::new().with(uncommanded(0b111));
    let without_z = readings(&Machine::default(), &path(all.clone().with(uncommanded(0b100))));
    let expected =
        "the part's surface is read with Z at an unknown position: no earlier block commands Z in G90";
    assert_eq!(unknown_starts(&without_z.findings), [expected]);
    assert_eq!(without_z.passes.len(), 1, "it is read all the same");
    let with_z = readings(&Machine::default(), &path(all.with(uncommanded(0))));
    assert_eq!(unknown_starts(&with_z.findings), [""; 0]);
}

/// Of a touch only the end counts: where the ball starts along its path does not matter.
#[test]
fn a_touch_with_an_axis_that_nothing_commands_is_an_error() {
    let machine = Machine::default();
    let touch = |end: u8| {
        let mut to = Position::default();
        to[1] = 103.0;
        let script = EventScript::new().with(uncommanded(0b111)).with(uncommanded(end));
        let script = script.with(EventKind::Skip { to, rate: MmPerMin(100.0), has_signal: true });
        let mut rapids = RapidChecker::new(&machine, SPHERE, 3.0);
        script.emit_to(&mut rapids);
        rapids.finish()
    };
    let expected =
        "the part is touched with X and Z at an unknown position: no earlier block commands X and Z in G90";
    assert_eq!(unknown_starts(&touch(0b101)), [expected]);
    assert_eq!(unknown_starts(&touch(0)), [""; 0]);
}
