//! What is a hole and what isn't, on runs written down by hand.
use nalgebra::Point3;

use super::event_script::EventScript;
use super::{DrilledHole, HoleExtraction, HoleExtractor};
use crate::machine::{Head, HeadKind, Machine, Tool};
use gcode_lang::alarm::kinds::LIMIT;
use gcode_lang::motion::{EventKind, StopKind};
use gcode_part::Surface;

fn extract(machine: &Machine, surface: Option<Surface>, script: &EventScript) -> HoleExtraction {
    let mut extractor = HoleExtractor::new(machine).with_surface(surface);
    script.emit_to(&mut extractor);
    extractor.finish()
}

/// The holes one a line, rounded, and the findings' codes.
fn told(extracted: &HoleExtraction) -> String {
    let hole = |h: &DrilledHole| {
        let numbers = h.entry.iter().chain(h.axis.iter()).chain([&h.depth]);
        let numbers: Vec<_> = numbers.map(|v| format!("{:.3}", v + 0.0).replace("-0.000", "0.000")).collect();
        format!("{}{}", numbers.join(" "), h.tool.map_or(String::new(), |t| format!(" T{t}")))
    };
    let holes = extracted.holes.iter().map(hole);
    holes.chain(extracted.findings.iter().map(|f| f.code().into_owned())).collect::<Vec<_>>().join("\n")
}

fn check(script: &EventScript, expected: &str) {
    assert_eq!(told(&extract(&Machine::default(), None, script)), expected);
}

#[test]
fn a_feed_in_and_a_rapid_out_make_a_hole() {
    check(
        &EventScript::new().rapid("X5 Y6 Z2").feed("Z-10").rapid("Z2"),
        "5.000 6.000 2.000 0.000 0.000 1.000 12.000",
    );
}

#[test]
fn a_hole_may_be_fed_out_of_as_boring_does() {
    check(
        &EventScript::new().rapid("X5 Z2").feed("Z-10").feed("Z2").rapid("X9"),
        "5.000 0.000 2.000 0.000 0.000 1.000 12.000",
    );
}

/// The part turned by B = 90° about +y: what the tool does along machine x happens along the part's z.
#[test]
fn the_hole_lies_where_the_tool_went_on_the_part() {
    let script = EventScript::new().rapid("X120 Y7 B90").feed("X90").rapid("X120").rapid("B0");
    check(&script, "0.000 7.000 120.000 0.000 0.000 1.000 30.000");
}

/// As G83 does: out to R after each peck, back in by rapid to just above the depth reached.
#[test]
fn pecks_are_one_hole() {
    let script = EventScript::new()
        .rapid("Z50")
        .rapid("Z2")
        .feed("Z-3")
        .rapid("Z2")
        .rapid("Z-2.5")
        .feed("Z-6")
        .rapid("Z2")
        .rapid("Z-5.5")
        .feed("Z-8")
        .rapid("Z50");
    check(&script, "0.000 0.000 2.000 0.000 0.000 1.000 10.000");
}

#[test]
fn pecks_fed_from_the_r_level_are_one_hole_too() {
    let script = EventScript::new().rapid("Z2").feed("Z-3").rapid("Z2").feed("Z-6").rapid("Z50").rapid("X7");
    check(&script, "0.000 0.000 2.000 0.000 0.000 1.000 8.000");
}

#[test]
fn the_same_depth_twice_is_a_hole_twice() {
    let one = "0.000 0.000 2.000 0.000 0.000 1.000 5.000";
    let staying = EventScript::new().rapid("Z2").feed("Z-3").rapid("Z2").feed("Z-3").rapid("Z2");
    check(&staying, &format!("{one}\n{one}"));
    let coming_back = EventScript::new()
        .rapid("Z2")
        .feed("Z-3")
        .rapid("Z2")
        .rapid("X9")
        .rapid("X0")
        .feed("Z-3")
        .rapid("Z2");
    check(&coming_back, &format!("{one}\n{one}"));
    let a_turn_later =
        EventScript::new().rapid("X2 Z2").feed("Z-3").rapid("Z2").rapid("B360").feed("Z-3").rapid("Z2");
    check(&a_turn_later, &format!("{one}\n{one}").replace("0.000 0.000 2.000", "2.000 0.000 2.000"));
}

/// An endless loop over one hole: every pass after the first is one too many, and there is an end to keeping them.
#[test]
fn a_loop_over_one_hole_ends_with_the_limit_of_passes() {
    let machine = Machine::default();
    let mut extractor = HoleExtractor::new(&machine);
    extractor.max_passes = 500;
    EventScript::new().rapid("X9 Z2").rapid("X0").emit_to(&mut extractor);
    let once = EventScript::new().feed("Z-3").rapid("Z2").rapid("X9").rapid("X0");
    for _ in 0..505 {
        once.emit_to(&mut extractor);
    }
    let found = extractor.finish();
    assert_eq!(found.holes.len(), 500);
    assert!(found.holes.iter().all(|hole| hole.first_on_line == 0 && (hole.depth - 5.0).abs() < 1e-9));
    let [limit] = &found.findings[..] else { panic!("{:?}", found.findings) };
    assert_eq!((limit.kind, limit.severity), (&LIMIT, gcode_lang::diag::Severity::Alarm));
}

#[test]
fn two_tools_on_one_line_are_one_hole_as_deep_as_the_deeper() {
    let script = EventScript::new()
        .tool(1)
        .rapid("X1 Z5")
        .feed("Z-12")
        .rapid("Z5")
        .rapid("X80")
        .feed("Z-12")
        .rapid("Z5")
        .tool(2)
        .rapid("X1.004 Z2")
        .feed("Z-10")
        .rapid("Z5");
    check(
        &script,
        "1.004 0.000 2.000 0.000 0.000 1.000 14.000 T2\n80.000 0.000 5.000 0.000 0.000 1.000 17.000 T1",
    );
}

/// A countersink is larger, but it doesn't make the hole.
#[test]
fn the_largest_tool_that_goes_deep_finishes_the_hole() {
    let tool = |number, diameter| Tool { number, length: None, diameter: Some(diameter) };
    let machine = Machine { tools: vec![tool(1, 6.0), tool(2, 5.9), tool(3, 20.0)], ..Machine::default() };
    let script = EventScript::new()
        .tool(2)
        .rapid("Z2")
        .feed("Z-15")
        .rapid("Z2")
        .tool(1)
        .feed("Z-14")
        .rapid("Z2")
        .tool(3)
        .feed("Z-1")
        .rapid("Z2");
    let found = extract(&machine, None, &script);
    assert_eq!(told(&found), "0.000 0.000 2.000 0.000 0.000 1.000 17.000 T1");
    assert_eq!(found.holes[0].diameter, Some(6.0));
}

#[test]
fn a_feed_that_is_not_retraced_is_no_hole_and_is_told() {
    check(
        &EventScript::new().rapid("Z2").feed("X50").feed("Z-5").rapid("Z2"),
        "50.000 0.000 2.000 0.000 0.000 1.000 7.000\nfeed-without-retract",
    );
    check(&EventScript::new().rapid("Z2").feed("Z-5").rapid("X50"), "feed-without-retract");
}

#[test]
fn a_feed_outwards_that_a_rapid_goes_on_with_is_no_hole_and_is_told() {
    check(&EventScript::new().rapid("Z-5 X9").feed("Z2").rapid("Z50"), "rapid-beyond-cut");
    let out_of_the_ball = EventScript::new()
        .rapid("X150")
        .feed("X150 Y150")
        .rapid("Y200")
        .rapid("X20")
        .feed("Y150")
        .rapid("Y250");
    assert_eq!(on_the_ball(out_of_the_ball), "20.000 200.000 0.000 0.000 1.000 0.000 50.000");
}

/// Each end point is rounded: the way out isn't exactly on the line that the way in drew.
#[test]
fn rounded_points_stay_on_their_line() {
    let script = EventScript::new()
        .rapid("X100.033 Y200.057")
        .feed("X99 Y198.268")
        .feed("X92.533 Y187.067")
        .rapid("X125.033 Y243.358");
    let found = extract(&Machine::default(), None, &script);
    assert_eq!((found.holes.len(), found.findings.len()), (1, 0), "{}", told(&found));
    assert!((found.holes[0].depth - 15.0).abs() < 0.01);
}

#[test]
fn an_arc_and_a_turning_table_make_no_hole() {
    let script = EventScript::new().rapid("X50 Y5").feed("X40 B30").rapid("X50");
    check(&script, "feed-no-hole");
}

#[test]
fn the_head_set_by_the_operator_gives_the_axis() {
    let machine = Machine::default();
    // 30° from x towards y: the feed goes 20 mm along (cos 30°, sin 30°).
    let script =
        EventScript::new().head(30.0).rapid("X100 Y100").feed("X82.679 Y90").rapid("X100 Y100").rapid("B5");
    let found = extract(&machine, None, &script);
    assert_eq!(told(&found), "100.000 100.000 0.000 0.866 0.500 0.000 20.000");
}

#[test]
fn a_feed_beside_the_tool_is_a_finding_and_the_hole_has_the_tools_axis() {
    let script =
        EventScript::new().head(30.7).rapid("X100 Y100").feed("X82.679 Y90").rapid("X100 Y100").rapid("B5");
    let found = extract(&Machine::default(), None, &script);
    assert_eq!(found.findings.len(), 1);
    // The rounded end point stands at 29.9993°, 0.7007° away; 20·sin 0.7007° = 0.2446.
    let said = &found.findings[0].message;
    assert!(
        said.starts_with("the feed direction is 0.701° off the tool axis, limit 0.05°: 0.245 mm sideways"),
        "{said}"
    );
    let axis = found.holes[0].axis;
    assert!((axis.y / axis.x - 0.593_759).abs() < 1e-4, "tan 30.7°");
    let bottom = found.holes[0].entry - axis.into_inner() * found.holes[0].depth;
    assert!(
        (bottom - Point3::new(82.679, 90.0, 0.0)).norm() < 1e-9,
        "the deepest point is where the tip was"
    );
}

#[test]
fn a_head_nobody_has_set_is_an_error() {
    let machine = Machine { head: Head::new(HeadKind::Manual { start: None }, 0.0), ..Machine::default() };
    let script = EventScript::new().rapid("Z2").feed("Z-5").rapid("Z2");
    let found = extract(&machine, None, &script);
    assert!(told(&found).ends_with("head-not-set"), "{}", told(&found));
}

#[test]
fn a_message_about_something_else_sets_no_head() {
    let named = vec![(140, 30.0)];
    let ask = |text: &str| {
        let stop =
            EventKind::Stop { kind: StopKind::Message, text: text.to_owned(), variables: named.clone() };
        told(&extract(
            &Machine::default(),
            None,
            &EventScript::new().with(stop).rapid("Z2").feed("Z-5").rapid("Z2"),
        ))
    };
    let drilled = "0.000 0.000 2.000 0.000 0.000 1.000 7.000";
    assert_eq!(ask("GO AHEAD, SEE #140"), drilled);
    assert_ne!(ask("TURN HEAD: #140"), drilled);
}

#[test]
fn a_message_that_names_no_angle_leaves_the_head_as_it_is() {
    use gcode_lang::motion::{EventKind, StopKind};
    let message = EventKind::Stop { kind: StopKind::Message, text: "SET HEAD".into(), variables: vec![] };
    check(&EventScript::new().with(message), "head-message-unclear");
}

#[test]
fn the_spindle_must_turn() {
    let script = EventScript::default().rapid("Z2").feed("Z-5").rapid("Z2");
    check(&script, "0.000 0.000 2.000 0.000 0.000 1.000 7.000\nspindle-stopped");
}

#[test]
fn axes_that_carry_nothing_are_told_once_a_block() {
    check(&EventScript::new().rapid("A5").rapid("C7"), "axis-carries-nothing\naxis-carries-nothing");
}

#[test]
fn a_tool_that_is_not_in_the_table_is_told() {
    let machine =
        Machine { tools: vec![Tool { number: 1, length: None, diameter: None }], ..Machine::default() };
    assert_eq!(told(&extract(&machine, None, &EventScript::new().tool(1).tool(5).tool(0))), "tool-unknown");
}

const BALL: Option<Surface> = Some(Surface::Ellipsoid { a: 100.0, b: 100.0 });

fn on_the_ball(script: EventScript) -> String {
    told(&extract(&Machine::default(), BALL, &script))
}

#[test]
fn a_rapid_through_the_part_is_an_error() {
    let home_first = EventScript::new().rapid("Y150");
    assert_eq!(on_the_ball(home_first), "", "where the tool stood before it was outside, nobody knows");
    let through = EventScript::new().rapid("X-150").rapid("X150 Y5");
    assert_eq!(on_the_ball(through), "rapid-into-part");
    let round = EventScript::new().rapid("Y150").rapid("X150").rapid("B90");
    assert_eq!(on_the_ball(round), "");
}

#[test]
fn a_rapid_to_below_the_surface_before_the_feed_is_an_error() {
    let script = EventScript::new().rapid("Y150").rapid("Y99.5").feed("Y85").rapid("Y150");
    assert_eq!(on_the_ball(script), "0.000 99.500 0.000 0.000 1.000 0.000 14.500\nrapid-into-part");
}

/// The head half a turn round: the shank would go in first.
#[test]
fn a_feed_into_the_part_against_the_tool_is_an_error() {
    let script = EventScript::new().head(270.0).rapid("Y150").feed("Y85").rapid("Y150");
    let said = on_the_ball(script);
    assert!(said.ends_with("feed-not-along-tool"), "{said}");
}

#[test]
fn drilling_and_coming_back_out_is_no_rapid_through_the_part() {
    let script = EventScript::new()
        .rapid("Y150")
        .rapid("Y102")
        .feed("Y95")
        .rapid("Y102")
        .rapid("Y95.5")
        .feed("Y85")
        .rapid("Y150")
        .rapid("X30")
        .rapid("B50");
    assert_eq!(on_the_ball(script), "0.000 102.000 0.000 0.000 1.000 0.000 17.000");
}

#[test]
fn a_rapid_deeper_than_the_pecks_have_cut_is_an_error() {
    let script = EventScript::new()
        .rapid("Y150")
        .rapid("Y102")
        .feed("Y95")
        .rapid("Y102")
        .rapid("Y94")
        .feed("Y85")
        .rapid("Y150");
    assert_eq!(on_the_ball(script), "0.000 102.000 0.000 0.000 1.000 0.000 17.000\nrapid-beyond-cut");
}

#[test]
fn turning_the_table_with_the_tool_in_the_hole_is_an_error() {
    let script = EventScript::new()
        .rapid("X20 Y150")
        .rapid("Y102")
        .feed("Y90")
        .rapid("Y96")
        .rapid("B30")
        .rapid("Y150");
    let said = on_the_ball(script);
    assert!(said.contains("leaves-hole-sideways") && said.contains("rapid-into-part"), "{said}");
}

#[test]
fn not_coming_out_at_all_is_an_error_where_the_surface_is_known() {
    let script = EventScript::new().rapid("X20 Y150").rapid("Y102").feed("Y90").rapid("B30").rapid("Y150");
    let said = on_the_ball(script);
    assert!(said.contains("feed-without-retract"), "{said}");
    let in_the_air = EventScript::new().rapid("Y150").feed("X40").rapid("Y200");
    assert_eq!(on_the_ball(in_the_air), "");
}
