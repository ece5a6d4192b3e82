//! Holes and findings of runs written by hand.
use nalgebra::Point3;

use super::event_script::EventScript;
use super::{DrilledHole, HoleExtraction, HoleExtractor};
use crate::machine::{Head, HeadKind, Machine, Tool};
use gcode_lang::alarm::kinds::LIMIT;
use gcode_part::Surface;

fn extract(machine: &Machine, surface: Option<Surface>, script: &EventScript) -> HoleExtraction {
    let mut extractor = HoleExtractor::new(machine).with_surface(surface);
    script.emit_to(&mut extractor);
    extractor.finish()
}

/// Returns the holes, one per line as `entry, axis, depth`, and the codes of the findings.
fn summary(extraction: &HoleExtraction) -> String {
    let triple = |v: [f64; 3]| v.map(|v| ((v * 1e3).round() / 1e3 + 0.0).to_string()).join(" ");
    let hole = |h: &DrilledHole| {
        let tool = h.tool.map_or(String::new(), |tool| format!(", T{tool}"));
        let depth = (h.depth * 1e3).round() / 1e3;
        format!("{}, {}, {depth}{tool}", triple(h.entry.coords.into()), triple(h.axis.into_inner().into()))
    };
    let holes = extraction.holes.iter().map(hole);
    holes.chain(extraction.findings.iter().map(|f| f.code().into_owned())).collect::<Vec<_>>().join("\n")
}

/// Checks cases of three parts: a name, the steps, and the expected holes and findings.
fn check(surface: Option<Surface>, cases: &str) {
    for case in cases.trim().split("\n\n") {
        let (name, rest) = case.split_once('\n').unwrap();
        let (steps, expected) = rest.split_once('\n').unwrap_or((rest, ""));
        let script = EventScript::new().then(steps.trim());
        assert_eq!(summary(&extract(&Machine::default(), surface, &script)), expected, "{name}");
    }
}

#[test]
fn passes_along_one_line_make_one_hole() {
    check(
        None,
        "
a feed in and a rapid out make a hole
rapid X5 Y6 Z2; feed Z-10; rapid Z2
5 6 2, 0 0 1, 12

a feed out ends a bored hole
rapid X5 Z2; feed Z-10; feed Z2; rapid X9
5 0 2, 0 0 1, 12

the part is rotated by B = 90° about +y: motion along machine x is along the part's z
rapid X120 Y7 B90; feed X90; rapid X120; rapid B0
0 7 120, 0 0 1, 30

G83 retracts to R after each peck, and returns by rapid to just above the depth reached
rapid Z50; rapid Z2; feed Z-3; rapid Z2; rapid Z-2.5; feed Z-6; rapid Z2; rapid Z-5.5; feed Z-8; rapid Z50
0 0 2, 0 0 1, 10

pecks are fed from the R point level
rapid Z2; feed Z-3; rapid Z2; feed Z-6; rapid Z50; rapid X7
0 0 2, 0 0 1, 8

the same depth a second time, without leaving the line
rapid Z2; feed Z-3; rapid Z2; feed Z-3; rapid Z2
0 0 2, 0 0 1, 5
0 0 2, 0 0 1, 5

the same pecks a second time, without leaving the line
rapid Z2; feed Z-3; rapid Z2; rapid Z-2.5; feed Z-6; rapid Z2; feed Z-3; rapid Z2; rapid Z-2.5; feed Z-6; rapid Z2
0 0 2, 0 0 1, 8
0 0 2, 0 0 1, 8

the same pecks a second time and deeper
rapid Z2; feed Z-3; rapid Z2; feed Z-6; rapid Z2; feed Z-3; rapid Z2; feed Z-6; rapid Z2; feed Z-9; rapid Z2
0 0 2, 0 0 1, 11

the same depth three times
rapid Z2; feed Z-3; rapid Z2; feed Z-3; rapid Z2; feed Z-3; rapid Z2
0 0 2, 0 0 1, 5
0 0 2, 0 0 1, 5
0 0 2, 0 0 1, 5

the same depth a second time, after leaving the line
rapid Z2; feed Z-3; rapid Z2; rapid X9; rapid X0; feed Z-3; rapid Z2
0 0 2, 0 0 1, 5
0 0 2, 0 0 1, 5

the same depth a second time, after a revolution of B
rapid X2 Z2; feed Z-3; rapid Z2; rapid B360; feed Z-3; rapid Z2
2 0 2, 0 0 1, 5
2 0 2, 0 0 1, 5

two tools on one line make one hole as deep as the deeper
tool 1; rapid X1 Z5; feed Z-12; rapid Z5; rapid X80; feed Z-12; rapid Z5; tool 2; rapid X1.004 Z2; feed Z-10; rapid Z5
1.004 0 2, 0 0 1, 14, T2
80 0 5, 0 0 1, 17, T1

a feed across, then a hole
rapid Z2; feed X50; feed Z-5; rapid Z2
50 0 2, 0 0 1, 7

a feed without retract is no hole
rapid Z2; feed Z-5; rapid X50
feed-without-retract

a rapid continues a feed outwards
rapid Z-5 X9; feed Z2; rapid Z50
rapid-beyond-cut

a feed during which the table rotates is no hole
rapid X50 Y5; feed X40 B30; rapid X50
feed-no-hole

the operator sets the head to 30° from x towards y: the feed goes 20 mm along (cos 30°, sin 30°)
head 30; rapid X100 Y100; feed X82.679 Y90; rapid X100 Y100; rapid B5
100 100 0, 0.866 0.5 0, 20

axes that carry nothing are reported once per block
rapid A5; rapid C7
axis-carries-nothing
axis-carries-nothing",
    );
}

#[test]
fn motion_inside_a_known_surface_is_reported() {
    check(
        Some(Surface::Ellipsoid { a: 100.0, b: 100.0 }),
        "
a feed outwards in the air, then a hole in the part
rapid X150; feed X150 Y150; rapid Y200; rapid X20; feed Y150; rapid Y250
20 200 0, 0 1 0, 50

the start of a rapid before the tool has been outside is unknown
rapid Y150

a rapid through the part
rapid X-150; rapid X150 Y5
rapid-into-part

rapids round the part
rapid Y150; rapid X150; rapid B90

a rapid ends below the surface before the feed, and another leads out there
rapid Y150; rapid Y99.5; feed Y85; rapid Y150
0 99.5 0, 0 1 0, 14.5
rapid-into-part
rapid-into-part

a retract along the hole is no rapid through the part
rapid Y150; rapid Y102; feed Y95; rapid Y102; rapid Y95.5; feed Y85; rapid Y150; rapid X30; rapid B50
0 102 0, 0 1 0, 17

a rapid goes deeper than the pecks
rapid Y150; rapid Y102; feed Y95; rapid Y102; rapid Y94; feed Y85; rapid Y150
0 102 0, 0 1 0, 17
rapid-beyond-cut

the head is set half a revolution off, so that the shank would enter first
head 270; rapid Y150; feed Y85; rapid Y150
0 150 0, 0 -1 0, 65
feed-not-along-tool

a feed in the air without retract
rapid Y150; feed X40; rapid Y200",
    );
}

#[test]
fn a_table_that_rotates_with_the_tool_in_the_hole_is_an_error() {
    let codes = |steps: &str| {
        let surface = Some(Surface::Ellipsoid { a: 100.0, b: 100.0 });
        summary(&extract(&Machine::default(), surface, &EventScript::new().then(steps)))
    };
    let left = codes("rapid X20 Y150; rapid Y102; feed Y90; rapid Y96; rapid B30; rapid Y150");
    assert!(left.contains("leaves-hole-sideways") && left.contains("rapid-into-part"), "{left}");
    let stayed = codes("rapid X20 Y150; rapid Y102; feed Y90; rapid B30; rapid Y150");
    assert!(stayed.contains("feed-without-retract"), "{stayed}");
}

#[test]
fn an_endless_loop_over_one_hole_ends_at_the_limit_of_passes() {
    let machine = Machine::default();
    let mut extractor = HoleExtractor::new(&machine);
    extractor.strokes = super::strokes::Strokes::new(500);
    EventScript::new().then("rapid X9 Z2; rapid X0").emit_to(&mut extractor);
    let once = EventScript::new().then("feed Z-3; rapid Z2; rapid X9; rapid X0");
    for _ in 0..505 {
        once.emit_to(&mut extractor);
    }
    let found = extractor.finish();
    assert_eq!(found.holes.len(), 500);
    assert!(found.holes.iter().all(|hole| hole.first_on_line == 0 && (hole.depth - 5.0).abs() < 1e-9));
    let [limit] = &found.findings[..] else { panic!("{:?}", found.findings) };
    assert_eq!((limit.kind, limit.severity), (&LIMIT, gcode_lang::diag::Severity::Alarm));
}

/// The countersink is larger, but too shallow to make the hole.
#[test]
fn the_largest_deep_tool_finishes_the_hole() {
    let tool = |number, diameter| Tool { number, diameter: Some(diameter), ..Tool::default() };
    let machine = Machine { tools: vec![tool(1, 6.0), tool(2, 5.9), tool(3, 20.0)], ..Machine::default() };
    let steps =
        "tool 2; rapid Z2; feed Z-15; rapid Z2; tool 1; feed Z-14; rapid Z2; tool 3; feed Z-1; rapid Z2";
    let found = extract(&machine, None, &EventScript::new().then(steps));
    assert_eq!(summary(&found), "0 0 2, 0 0 1, 17, T1");
    assert_eq!(found.holes[0].diameter, Some(6.0));
}

/// Each end point is rounded: the retract is not exactly on the line of the feed.
#[test]
fn rounded_points_stay_on_their_line() {
    let steps = "rapid X100.033 Y200.057; feed X99 Y198.268; feed X92.533 Y187.067; rapid X125.033 Y243.358";
    let found = extract(&Machine::default(), None, &EventScript::new().then(steps));
    assert_eq!((found.holes.len(), found.findings.len()), (1, 0), "{}", summary(&found));
    assert!((found.holes[0].depth - 15.0).abs() < 0.01);
}

#[test]
fn a_feed_off_the_tool_axis_is_a_finding_and_the_hole_has_the_tool_axis() {
    let steps = "head 30.7; rapid X100 Y100; feed X82.679 Y90; rapid X100 Y100; rapid B5";
    let found = extract(&Machine::default(), None, &EventScript::new().then(steps));
    assert_eq!(found.findings.len(), 1);
    // The rounded end point is at 29.9993°, 0.7007° off; 20·sin 0.7007° = 0.2446.
    let message = &found.findings[0].message;
    let expected = "the feed direction is 0.701° off the tool axis, limit 0.05°: 0.245 mm sideways";
    assert!(message.starts_with(expected), "{message}");
    let axis = found.holes[0].axis;
    assert!((axis.y / axis.x - 0.593_759).abs() < 1e-4, "tan 30.7°");
    let bottom = found.holes[0].bottom();
    assert!((bottom - Point3::new(82.679, 90.0, 0.0)).norm() < 1e-9, "the programmed end point: {bottom}");
}

const DRILLED: &str = "0 0 2, 0 0 1, 7";

#[test]
fn a_feed_needs_a_set_head_a_rotating_spindle_and_a_known_tool() {
    let drill = "rapid Z2; feed Z-5; rapid Z2";
    let unset = Machine { head: Head::new(HeadKind::Manual { start: None }, 0.0), ..Machine::default() };
    let one_tool = Machine {
        tools: vec![Tool { number: 1, length: None, diameter: None, ..Tool::default() }],
        ..Machine::default()
    };
    for (machine, script, expected) in [
        (&unset, EventScript::new().then(drill), format!("{DRILLED}\nhead-not-set")),
        (&Machine::default(), EventScript::default().then(drill), format!("{DRILLED}\nspindle-stopped")),
        (&one_tool, EventScript::new().then("tool 1; tool 5; tool 0"), "tool-unknown".to_owned()),
    ] {
        assert_eq!(summary(&extract(machine, None, &script)), expected);
    }
}

#[test]
fn only_a_message_about_the_head_with_one_angle_sets_the_head() {
    let after = |text: &str, variables| {
        let script = EventScript::new().message(text, variables).then("rapid Z2; feed Z-5; rapid Z2");
        summary(&extract(&Machine::default(), None, &script))
    };
    assert_eq!(after("GO AHEAD, SEE #140", vec![(140, 30.0)]), DRILLED);
    assert_ne!(after("TURN HEAD: #140", vec![(140, 30.0)]), DRILLED);
    assert_eq!(after("SET HEAD", vec![]), format!("{DRILLED}\nhead-message-unclear"));
}
