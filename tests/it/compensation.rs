//! Properties of cutter compensation and corner words: the tool's centre keeps the radius, and no move stays pending.
use std::fmt::Write;

use gcode_control::Outcome;
use gcode_lang::control::Settings;
use gcode_lang::motion::{EventKind, Position};
use gcode_tests::expect::{self, Ran, Recorder};
use proptest::prelude::*;

type Point = (f64, f64);

#[derive(Clone, Copy, Debug)]
enum PathPart {
    Line(Point, Point),
    /// From, centre, sweep in radians.
    Arc(Point, Point, f64),
}

impl PathPart {
    fn at(&self, part: f64) -> Point {
        match *self {
            Self::Line(from, to) => (from.0 + (to.0 - from.0) * part, from.1 + (to.1 - from.1) * part),
            Self::Arc(from, centre, sweep) => {
                let (sine, cosine) = (f64::sin(sweep * part), f64::cos(sweep * part));
                let (x, y) = (from.0 - centre.0, from.1 - centre.1);
                (centre.0 + x * cosine - y * sine, centre.1 + x * sine + y * cosine)
            }
        }
    }

    /// The distance of a point, and whether the nearest point is inside the way.
    fn distance(&self, point: Point) -> (f64, bool) {
        let ends = f64::hypot(point.0 - self.at(0.0).0, point.1 - self.at(0.0).1)
            .min(f64::hypot(point.0 - self.at(1.0).0, point.1 - self.at(1.0).1));
        match *self {
            Self::Line(from, to) => {
                let (x, y) = (to.0 - from.0, to.1 - from.1);
                let part = ((point.0 - from.0) * x + (point.1 - from.1) * y) / (x * x + y * y);
                let across = ((point.1 - from.1) * x - (point.0 - from.0) * y).abs() / f64::hypot(x, y);
                if (0.0..=1.0).contains(&part) { (across, true) } else { (ends, false) }
            }
            Self::Arc(from, centre, sweep) => {
                let radius = f64::hypot(from.0 - centre.0, from.1 - centre.1);
                let (x, y) = (point.0 - centre.0, point.1 - centre.1);
                let (a, b) = (from.0 - centre.0, from.1 - centre.1);
                let turn = f64::atan2(a * y - b * x, a * x + b * y);
                let inside = turn * sweep >= 0.0 && turn.abs() <= sweep.abs();
                if inside { ((f64::hypot(x, y) - radius).abs(), true) } else { (ends, false) }
            }
        }
    }
}

/// A run: its outcome, the machine's end position, its events, and its moves in X and Y with the lines of their blocks.
struct PlaneRun {
    outcome: Outcome,
    position: Position,
    recorder: Recorder,
    moves: Vec<(usize, PathPart)>,
}

fn run(text: &str, settings: &Settings) -> PlaneRun {
    let Ran { control, outcome, recorder } = expect::run_on(text.as_bytes(), settings.clone(), 500);
    let mut at = (0.0, 0.0);
    let moves = recorder.0.iter().filter_map(|(block, kind, _)| {
        let line = control.memory().sources().line_column(*block).line as usize;
        let from = at;
        let (to, part) = match kind {
            EventKind::Rapid { to } | EventKind::Feed { to, .. } => {
                (to, PathPart::Line(from, (to[0], to[1])))
            }
            EventKind::Arc { to, arc, .. } => (to, PathPart::Arc(from, arc.centre, arc.sweep.to_rad())),
            _ => return None,
        };
        at = (to[0], to[1]);
        Some((line, part))
    });
    PlaneRun { moves: moves.collect(), outcome, position: control.machine_position(), recorder }
}

/// Corners of a convex contour, counterclockwise, on a circle of 50 to 90 mm; and how far each side bulges: the part
/// of its half sweep in what the corners leave.
fn contours() -> impl Strategy<Value = (Vec<Point>, Vec<f64>)> {
    let side = (1.0..3.0_f64, 0.0..0.4_f64, any::<bool>());
    (50.0..90.0_f64, prop::collection::vec(side, 3..9)).prop_map(|(radius, sides)| {
        let whole: f64 = sides.iter().map(|(part, ..)| part).sum();
        let mut angle = 0.0;
        let mut corners = Vec::new();
        let mut bulges = Vec::new();
        for (part, bulge, round) in &sides {
            let at = |v: f64| (v * 1000.0).round() / 1000.0;
            corners.push((at(radius * f64::cos(angle)), at(radius * f64::sin(angle))));
            let turn = std::f64::consts::TAU * part / whole;
            // A flatter arc would have more digits in R than an address takes.
            bulges.push(if *round && *bulge > 0.05 { bulge * (turn / 2.0).min(1.5) } else { 0.0 });
            angle += turn;
        }
        (corners, bulges)
    })
}

/// A program once round a contour from the middle of its first side, compensated on one side; its first line is the
/// line number 6. The ways are those of its lines.
fn round(corners: &[Point], bulges: &[f64], outside: bool, radius: f64) -> (String, Vec<(usize, PathPart)>) {
    let count = corners.len();
    let middle = |a: Point, b: Point| {
        let at = |v: f64| (v * 500.0).round() / 1000.0;
        (at(a.0 + b.0), at(a.1 + b.1))
    };
    // The first side is straight, and begins and ends in its middle.
    let start = middle(corners[0], corners[1]);
    let mut points: Vec<(Point, f64)> = vec![(start, 0.0)];
    if outside {
        // Clockwise: the sides in the other order.
        points.push((corners[0], 0.0));
        points.extend((1..count).rev().map(|i| (corners[i], -bulges[i])));
    } else {
        points.extend((1..count).map(|i| (corners[i], if i == 1 { 0.0 } else { bulges[i - 1] })));
        points.push((corners[0], bulges[count - 1]));
    }
    points.push((start, 0.0));
    let away = if outside { 1.6 } else { 0.6 };
    let mut text = format!("O1\n#13001={radius}\nG0 X{:.3} Y{:.3}\n", start.0 * away, start.1 * away);
    write!(text, "G41 D1\nG1 X{:.3} Y{:.3} F1000\n", start.0, start.1).unwrap();
    let mut ways = Vec::new();
    for (place, pair) in points.windows(2).enumerate() {
        let (from, (to, half)) = (pair[0].0, pair[1]);
        let chord = f64::hypot(to.0 - from.0, to.1 - from.1);
        let way = if half == 0.0 {
            writeln!(text, "G1 X{:.3} Y{:.3}", to.0, to.1).unwrap();
            PathPart::Line(from, to)
        } else {
            let bend = (chord / 2.0 / f64::sin(half.abs()) * 1000.0).round() / 1000.0;
            let code = if half > 0.0 { 3 } else { 2 };
            writeln!(text, "G{code} X{:.3} Y{:.3} R{bend:.3}", to.0, to.1).unwrap();
            let height = (bend * bend - chord * chord / 4.0).sqrt() * half.signum();
            let (x, y) = ((to.0 - from.0) / chord, (to.1 - from.1) / chord);
            let centre = ((from.0 + to.0) / 2.0 - height * y, (from.1 + to.1) / 2.0 + height * x);
            PathPart::Arc(from, centre, 2.0 * f64::asin(chord / 2.0 / bend) * half.signum())
        };
        ways.push((6 + place, way));
    }
    write!(text, "G40 G1 X{:.3} Y{:.3}\nM30\n", start.0 * away, start.1 * away).unwrap();
    (text, ways)
}

const NOTHING: f64 = 1e-9;

/// Compares the path with the contour: never nearer than the radius, and beside its own segments exactly there.
fn keeps_the_radius(
    text: &str,
    ways: &[(usize, PathPart)],
    radius: f64,
    tolerance: f64,
) -> Result<(), TestCaseError> {
    let PlaneRun { outcome, moves, .. } = run(text, &Settings::default());
    prop_assert!(matches!(outcome, Outcome::End), "{outcome:?}\n{text}");
    let (first, last) = (ways[0].0, ways[ways.len() - 1].0);
    for (line, way) in moves.iter().filter(|(line, _)| (first..=last).contains(line)) {
        for step in 1..40 {
            let point = way.at(f64::from(step) / 40.0);
            // The first side and the last are one line, but for rounding.
            let near = ways.iter().filter(|(own, _)| own == line || line.abs_diff(*own) + first != last);
            let nearest = near.map(|(_, way)| way.distance(point).0).fold(f64::MAX, f64::min);
            prop_assert!(nearest > radius - tolerance, "line {line}: {nearest} at {point:?}\n{text}");
            let own = ways.iter().filter(|(own, _)| own == line).map(|(_, way)| way.distance(point));
            let (beside, inside) = own.fold((f64::MAX, false), |a, b| if b.0 < a.0 { b } else { a });
            prop_assert!(!inside || (beside - radius).abs() < tolerance, "line {line}: {beside}\n{text}");
        }
    }
    for (line, _) in ways {
        prop_assert!(moves.iter().any(|(own, _)| own == line), "line {line} isn't there\n{text}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(300) })]

    #[test]
    fn round_a_convex_polygon_the_centre_keeps_the_radius(
        (corners, _) in contours(), outside in any::<bool>(), radius in 1_u32..3000
    ) {
        let radius = f64::from(radius) / 1000.0;
        let straight = vec![0.0; corners.len()];
        let (text, ways) = round(&corners, &straight, outside, radius);
        keeps_the_radius(&text, &ways, radius, NOTHING)?;
    }

    /// The centre of an arc by R and the arc's start are kept in hundredths of the increment, each at most half the
    /// diagonal of 0.00001 mm off. The start's distance from the centre feels both, and the centre's place counts once
    /// more beside the contour: at most three times 0.0000071 mm.
    #[test]
    fn round_a_contour_with_arcs_the_centre_keeps_the_radius(
        (corners, bulges) in contours(), outside in any::<bool>(), radius in 1_u32..3000
    ) {
        let radius = f64::from(radius) / 1000.0;
        let (text, ways) = round(&corners, &bulges, outside, radius);
        keeps_the_radius(&text, &ways, radius, 2.13e-5)?;
    }

    /// Compensation keeps its distance from the path that the corner words make without compensation.
    #[test]
    fn round_corners_by_words_the_centre_keeps_the_radius(
        (corners, _) in contours(), outside in any::<bool>(), radius in 1_u32..1000,
        more in 0_u32..1000, cut in any::<bool>()
    ) {
        let radius = f64::from(radius) / 1000.0;
        let straight = vec![0.0; corners.len()];
        let (text, ways) = round(&corners, &straight, outside, radius);
        let last = ways[ways.len() - 1].0;
        let word = if cut { format!(",C{:.3}", 4.0 * radius) } else { format!(",R{:.3}", radius + f64::from(more) / 1000.0) };
        let lines = text.lines().enumerate().map(|(place, line)| {
            let corner = (6..last).contains(&(place + 1));
            format!("{line}{}\n", if corner { &word } else { "" })
        });
        let text: String = lines.collect();
        let shaped = run(&text.replace("G41 D1", "G40"), &Settings::default());
        prop_assert!(matches!(shaped.outcome, Outcome::End), "{:?}\n{text}", shaped.outcome);
        let ways: Vec<_> = shaped.moves.into_iter().filter(|(line, _)| (6..=last).contains(line)).collect();
        keeps_the_radius(&text, &ways, radius, NOTHING)?;
    }

    /// G41 with a radius of 0 makes the moves of G40.
    #[test]
    fn a_radius_of_0_changes_nothing((corners, bulges) in contours(), outside in any::<bool>()) {
        let (text, _) = round(&corners, &bulges, outside, 0.0);
        let with = run(&text, &Settings::default());
        let without = run(&text.replace("G41 D1", "G40"), &Settings::default());
        prop_assert_eq!(with.moves.len(), without.moves.len());
        for ((line, way), (other, plain)) in with.moves.iter().zip(&without.moves) {
            prop_assert_eq!(line, other);
            let (a, b) = (way.at(1.0), plain.at(1.0));
            prop_assert!(f64::hypot(a.0 - b.0, a.1 - b.1) < NOTHING);
        }
    }
}

/// One block of a program that compensates, most of them right.
fn blocks() -> impl Strategy<Value = String> {
    let number = || (-30_000..30_000_i32).prop_map(|n| format!("{:.3}", f64::from(n) / 1000.0));
    let straight = prop::sample::select(vec!["G0", "G1", "", "", "G1 G90", "G1 G91"]);
    let side = prop::sample::select(vec!["", "", "", "", "G41 ", "G42 ", "G40 ", "D2 ", "D1 ", "D0 "]);
    let corner = prop::sample::select(vec!["", "", "", "", ",R0.5", ",C0.7", ",R3."]);
    prop_oneof![
        6 => (straight, side, number(), number(), corner).prop_map(|(code, side, x, y, corner)| format!("{side}{code} X{x} Y{y} {corner}")),
        2 => (number(), number(), number(), any::<bool>()).prop_map(|(x, y, r, clockwise)| format!("G{} X{x} Y{y} R{r}", if clockwise { 2 } else { 3 })),
        1 => number().prop_map(|i| format!("G3 I{i} J1. Z-1.")),
        4 => prop::sample::select(vec![
            "Z1.", "Z-2.", "M8", "G4 P10", "M00", "#1=#5021", "#3006=1(WAIT)", "G39", "G39 I1. J1.", "G40", "G41",
            "G28 Z0", "G91 G28 X1.", "G53 X5. Y5.", "G81 X3. Z-5. R1.", "G80", "M98 P2", "G65 P2 A1.", "X1.",
            "G40 G1 X1. Y2. I1. J3.", "G51.1 X0", "G50.1", "G68 X0 Y0 R30.", "G69", "G18", "G17", "N5", "#13002=1.",
            "G40 G80 G69 G17 G90 G0 X40. Y40.",
        ]).prop_map(str::to_owned),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(3000) })]

    /// Every program runs the same every time, and the tool is at the end of its last move.
    #[test]
    fn no_move_stays_pending_at_the_end(
        blocks in prop::collection::vec(blocks(), 1..25), radius in 0..3000_i32, type_b in any::<bool>(), read in 3..6_usize
    ) {
        let head = format!("O1\n#13001={}.\n#13002=0.8\nF500\nG41 D1 G1 X5. Y-5.\n", f64::from(radius) / 1000.0);
        let text = format!("{}{}\nM30\nO2\n#2=#2+1\nM99\n", head.replace(".\n#13002", "\n#13002"), blocks.join("\n"));
        let settings = Settings { starts_up_by_type_b: type_b, lookahead_blocks: read, ..Settings::default() };
        let (one, other) = (run(&text, &settings), run(&text, &settings));
        prop_assert_eq!(format!("{:?}", one.outcome), format!("{:?}", other.outcome));
        prop_assert_eq!(&one.recorder, &other.recorder);
        let last = one.recorder.positions().last().copied().unwrap_or_default();
        for axis in 0..3 {
            let apart = one.position[axis] - last[axis];
            prop_assert!(apart.abs() < 1e-6, "axis {axis}: {apart}, {:?}\n{text}", one.outcome);
        }
    }
}
