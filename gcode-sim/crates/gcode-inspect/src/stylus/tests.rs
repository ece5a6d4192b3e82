//! An edge finder's ball round a sphere and an ellipsoid: readings worked out by hand.
use super::*;
use crate::findings::PATH_NOT_READ;
use crate::holes::event_script::EventScript;
use gcode_lang::alarm::kinds::LIMIT;
use gcode_lang::units::Deg;

const SPHERE: Surface = Surface::Ellipsoid { a: 100.0, b: 100.0 };

fn followed(machine: &Machine, surface: Surface, script: &EventScript) -> StylusReadings {
    let mut stylus = Stylus::new(machine, surface, 3.0);
    script.emit_to(&mut stylus);
    stylus.finish()
}

/// Down to the top of a sphere of 100 and along a chord of the ball's path, a sphere of 103: from 10° beside the pole to
/// 10° on the other side.
fn over_the_top() -> EventScript {
    let (x, y) = (103.0 * Deg(10.0).sin(), 103.0 * Deg(10.0).cos());
    let at = |x: f64, y: f64| format!("X{x} Y{y}");
    EventScript::new().rapid(&at(-x, 200.0)).feed(&at(-x, y)).feed(&at(x, y)).feed(&at(x, 200.0))
}

/// The chord is nearest in its middle: 103·cos 10° = 101.4352, which is 1.5648 too near. Approach and retract cross the
/// surface at 10° to its normal and aren't read.
#[test]
fn a_chord_is_read_where_it_is_nearest() {
    let found = followed(&Machine::default(), SPHERE, &over_the_top());
    let [pass] = found.passes.as_slice() else { panic!("{found:?}") };
    let (least, greatest) = pass.extremes().unwrap();
    assert!((least.value - (103.0 * Deg(10.0).cos() - 103.0)).abs() < 1e-9, "{least:?}");
    assert!(least.ball_centre.x.abs() < 1e-9 && greatest.value.abs() < 1e-9, "{greatest:?}");
    assert!((pass.length() - 206.0 * Deg(10.0).sin()).abs() < 1e-9 && pass.backtraces.len() == 1);
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
        assert!(
            (reading.ball_centre.x - x).abs() < 1e-9,
            "it stands where the program believes: {reading:?}"
        );
    }
    assert!(readings[0].value > 0.028 && readings[readings.len() - 1].value < 0.012);
}

#[test]
fn what_crosses_the_surface_or_is_far_from_it_is_no_reading() {
    let script = EventScript::new()
        .rapid("X0 Y200")
        .feed("Y103")
        .feed("Y200")
        .feed("X50")
        .rapid("X-5 Y103.1")
        .rapid("X5");
    let found = followed(&Machine::default(), SPHERE, &script);
    assert!(found.passes.is_empty() && found.findings.is_empty(), "{found:?}");
}

/// The table turns a sphere that stands 0.3 out of its axis under a ball that stands still.
#[test]
fn a_turning_table_is_read_as_well() {
    let mut machine = Machine::default();
    machine.part.shift.x = 0.3;
    let script = EventScript::new().rapid("X200 Y0").rapid("X103").feed("B180").rapid("X200");
    let found = followed(&machine, SPHERE, &script);
    let (least, greatest) = found.passes[0].extremes().unwrap();
    // At B 0 the part is 0.3 nearer, at B 180 it is 0.3 farther away.
    assert!(
        (least.value + 0.3).abs() < 1e-4 && (greatest.value - 0.3).abs() < 1e-4,
        "{least:?} {greatest:?}"
    );
    assert_eq!(least.path_length, 0.0);
}

/// What is told of a way in feeds from a rapid place above the sphere, and how many feeds have a reading.
fn told(feeds: &[&str]) -> (Vec<String>, usize) {
    let begin = EventScript::new().rapid("X-20 Y110");
    let script = feeds.iter().fold(begin, |script, words| script.feed(words)).rapid("Y200");
    let found = followed(&Machine::default(), SPHERE, &script);
    let codes = found.findings.iter().map(|finding| finding.code().into_owned());
    (codes.collect(), found.passes.iter().map(|pass| pass.backtraces.len()).sum())
}

/// The path of the ball is a sphere of 103; these points lie on it, but for what a name says.
#[test]
fn a_feed_of_the_path_without_a_reading_is_told() {
    let on = |x: f64| format!("X{x} Y{}", libm::sqrt(103.0 * 103.0 - x * x));
    let [a, b, c, d] = [-20.0, -10.0, 0.0, 10.0].map(on);
    let (far_b, far_c) = ("X-12 Y122", "X0 Y123");
    let lost_sign = b.replace('Y', "Y-");
    let path_not_read = vec!["path-not-read".to_owned()];
    let into_part = vec!["ball-into-part".to_owned()];
    for (feeds, wanted) in [
        // The first feed goes to the surface, and the retract may be fed.
        (vec![&*a, &b, &c, &d], (vec![], 3)),
        (vec![&a, &b, &c, "X0 Y150"], (vec![], 2)),
        // 20 mm off: one point, two points, those at the beginning, those at the end.
        (vec![&a, far_b, &c, &d], (path_not_read.clone(), 1)),
        (vec![&a, far_b, far_c, &d], (path_not_read.clone(), 0)),
        (vec![far_b, far_c, &c, &d], (path_not_read.clone(), 1)),
        (vec![&a, &b, far_b, far_c], (path_not_read.clone(), 1)),
        // 8 mm deep in the middle and at the end; a Y that has lost its sign.
        (vec![&a, &b, "X0 Y95", &d], (into_part.clone(), 1)),
        (vec![&a, &b, "X0 Y95"], (into_part.clone(), 1)),
        (vec![&a, &lost_sign, &c, &d], (into_part.clone(), 1)),
        (vec!["X-20 Y90"], (into_part.clone(), 0)),
    ] {
        let found = told(&feeds);
        // A path of which nothing was read at all is told by the command.
        let none = found.1 == 0 && wanted.1 == 0 && found.0.is_empty();
        assert!(found == wanted || none, "{feeds:?}: {found:?}, and {wanted:?} is wanted");
    }
}

/// The ball is fed past the part before a contact, after one, or between two: whether that way belongs to the path nothing
/// says, so it is told wherever there is a path.
#[test]
fn what_is_fed_past_the_part_is_told_wherever_a_path_is_read() {
    let over = |script: EventScript| {
        let x = 103.0 * Deg(10.0).sin();
        let y = 103.0 * Deg(10.0).cos();
        script.rapid(&format!("X{} Y200", -x)).feed(&format!("Y{y}")).feed(&format!("X{x}")).rapid("Y200")
    };
    let after = over(EventScript::new()).feed("X50");
    let before = over(EventScript::new().rapid("X0 Y200").feed("X50").rapid("Y210"));
    for (script, behind, passes) in [(before, 0, 1), (after.clone(), 1, 1), (over(after), 1, 2)] {
        let found = followed(&Machine::default(), SPHERE, &script);
        let [finding] = found.findings.as_slice() else { panic!("{:?}", found.findings) };
        assert_eq!(finding.kind, &PATH_NOT_READ);
        assert_eq!((found.gaps.len(), found.gaps[0].passes_before, found.passes.len()), (1, behind, passes));
    }
}

/// A sphere of 100 that stands 15 mm farther out than is believed: a rapid to 10 mm before the ball's contact ends 5 mm
/// in the part; and one that passes the pole at 101 pushes a ball of 3 in by 2 mm.
#[test]
fn a_rapid_with_the_ball_into_the_part_is_told() {
    let mut machine = Machine::default();
    machine.part.shift.x = 15.0;
    for (machine, ways, deepest) in [
        (&machine, vec!["X150 Y0", "X113", "X150"], Some("5.000")),
        (&machine, vec!["X150 Y0", "X119", "X150"], None),
        (&Machine::default(), vec!["X-30 Y101", "X30"], Some("2.000")),
        (&Machine::default(), vec!["X-30 Y103", "X30"], None),
    ] {
        let mut rapids = RapidChecker::new(machine, SPHERE, 3.0);
        let script = ways.iter().fold(EventScript::new(), |script, way| script.rapid(way));
        script.emit_to(&mut rapids);
        let found = rapids.finish();
        let told = found.iter().map(|finding| finding.message.as_str()).collect::<Vec<_>>().join("; ");
        assert_eq!(found.len(), usize::from(deepest.is_some()), "{ways:?}: {told}");
        assert!(deepest.is_none_or(|deepest| told.contains(deepest)), "{ways:?}: {told}");
    }
}

/// A head with its pivot 100 mm from the ball's centre, set by hand to 90° and to 0°: the ball hangs 100 mm below the pivot,
/// then 100 mm beside it towards −x. A rapid of the pivot to x = 200, y = 0 brings it to x = 100, with a ball of 3 that is 3 mm in a
/// sphere of 100; upright it would stand at (200, −100), 123.6 mm off.
#[test]
fn a_rapid_into_the_part_is_told_for_a_head_that_is_set_by_hand() {
    let kind = crate::machine::HeadKind::Manual { start: Some(Deg(90.0)) };
    let machine = Machine { head: crate::machine::Head::new(kind, 100.0), ..Machine::default() };
    for (angle, told) in [(0.0, Some("3.000")), (90.0, None)] {
        let script = EventScript::new().rapid("X400 Y100").head(angle).rapid("X400 Y0").rapid("X200");
        let mut rapids = RapidChecker::new(&machine, SPHERE, 3.0);
        script.emit_to(&mut rapids);
        let found: Vec<_> = rapids.finish().into_iter().map(|finding| finding.message).collect();
        assert_eq!(found.len(), usize::from(told.is_some()), "{angle}: {found:?}");
        assert!(told.is_none_or(|told| found[0].contains(told)), "{angle}: {found:?}");
    }
}

/// Half turns of the table under a ball 97 mm off the part: each is some hundred chords, and a loop that never ends makes any number
/// of them.
#[test]
fn feeds_without_a_reading_are_looked_at_so_long_and_no_longer() {
    let turns = |count: usize| {
        let begin = EventScript::new().rapid("X200 Y0");
        (0..count).fold(begin, |script, n| script.feed(if n % 2 == 0 { "B180" } else { "B0" }))
    };
    let mut machine = Machine::default();
    machine.part.shift.x = 30.0;
    let few = followed(&machine, SPHERE, &turns(10));
    assert!(few.findings.iter().all(|finding| finding.kind != &LIMIT), "{:?}", few.findings);
    let mut stylus = Stylus::new(&machine, SPHERE, 3.0);
    stylus.unread_points = MAX_UNREAD_POINTS - 1000;
    turns(20).emit_to(&mut stylus);
    let many = stylus.finish();
    let told: Vec<_> = many.findings.iter().filter(|finding| finding.kind == &LIMIT).collect();
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].message.contains("no readings after this"), "{told:?}");
}
