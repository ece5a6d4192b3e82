//! Law of virtual planes: by the forward kinematics of the machine the tip is on the programmed line or arc of the part.
use gcode_control::Outcome;
use gcode_inspect::machine::{AxisMotion, Machine, Setup};
use gcode_lang::control::Settings;
use gcode_lang::motion::Position;
use gcode_tests::expect::run_on;
use nalgebra::{Point3, Vector2};
use proptest::prelude::*;

/// Largest deviation between the ends of pieces: setting CHORDS, mm.
const CHORDS: f64 = 0.001;

fn written(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}

/// A table about one axis, and a tool along Z.
fn machine(letter: &str, turns: &str, sign: i32) -> Machine {
    let text = format!(
        "[[table]]\nletter = \"{letter}\"\nturns = {turns}\nsign = {sign}\ncentre = [0.0, 0.0, 0.0]\n\
         [head]\nkind = \"fixed\"\ndirection = [0.0, 0.0, 1.0]\npivot = 0.0\n"
    );
    Machine::parse(&text).unwrap()
}

/// Path that a block has on the surface.
#[derive(Clone, Copy, Debug)]
enum Path {
    Line(Vector2<f64>, Vector2<f64>),
    /// Centre and radius.
    Arc(Vector2<f64>, f64),
}

impl Path {
    fn deviation(self, point: Vector2<f64>) -> f64 {
        match self {
            Self::Line(from, to) => {
                let along = to - from;
                let t = ((point - from).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
                (point - (from + along * t)).norm()
            }
            Self::Arc(centre, radius) => ((point - centre).norm() - radius).abs(),
        }
    }
}

/// Runs a program and checks the moves of its last blocks, one for each path with its end; `develop` takes the tip on the part to
/// the surface, on which points at a `period` in y are one.
fn check(
    machine: &Machine,
    program: &str,
    paths: &[(Path, Vector2<f64>)],
    develop: impl Fn(Point3<f64>) -> Vector2<f64>,
    period: f64,
) -> Result<(), TestCaseError> {
    let settings =
        Settings { axes: machine.axes.clone(), kinematics: machine.kinematics(), ..Settings::default() };
    let ran = run_on(program.as_bytes(), settings, 1000);
    prop_assert!(matches!(ran.outcome, Outcome::End), "{:?}\n{program}", ran.outcome);
    let setup = Setup::default();
    let tip = |at: &Position| develop(machine.forward(at, &setup).tip);
    let turns =
        |point: Vector2<f64>| (-9..=9).map(move |turn| point + Vector2::new(0.0, f64::from(turn) * period));
    let least = |path: &Path, point| turns(point).map(|p| path.deviation(p)).fold(f64::INFINITY, f64::min);
    // Blocks with moves, each with its positions.
    let mut blocks: Vec<(usize, Vec<Position>)> = Vec::new();
    for (span, kind, _) in &ran.recorder.0 {
        let Some(to) = kind.end() else { continue };
        match blocks.last_mut() {
            Some((start, ends)) if *start == span.start as usize => ends.push(*to),
            _ => blocks.push((span.start as usize, vec![*to])),
        }
    }
    let first = blocks.len() - paths.len();
    let mut from = *blocks[first - 1].1.last().unwrap();
    for ((_, ends), (path, goal)) in blocks[first..].iter().zip(paths) {
        for to in ends {
            let piece = AxisMotion { from: &from, to, arc: None };
            for share in [0.2, 0.5, 0.8] {
                let deviation = least(path, tip(&piece.position(share)));
                prop_assert!(deviation < CHORDS + 1e-6, "{deviation} beside {path:?}\n{program}");
            }
            let deviation = least(path, tip(to));
            prop_assert!(deviation < 1e-6, "{deviation} at an end beside {path:?}\n{program}");
            from = *to;
        }
        let end = tip(&from);
        prop_assert!(turns(end).any(|end| (end - goal).norm() < 1e-6), "{end} is not {goal}\n{program}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn polar_interpolation_cuts_lines_and_circles_on_the_part(
        start in 5.0..80.0_f64,
        angle in -400.0..400.0_f64,
        goals in prop::collection::vec((prop::array::uniform2(-80.0..80.0_f64), prop::array::uniform2(-30.0..30.0_f64)), 1..4),
    ) {
        let machine = machine("C", "[0.0, 0.0, 1.0]", -1);
        let (start, angle) = (written(start), written(angle));
        let mut program = format!("O1\nG90 G01 X{start:.3} Y0 Z0 C{angle:.3} F500\nG12.1\n");
        let mut paths = Vec::new();
        let mut at = Vector2::new(start, 0.0);
        for (goal, centre) in goals {
            let [goal, centre] = [goal, centre].map(|point| Vector2::from(point.map(written)));
            prop_assume!((goal - at).norm() > 0.01 && centre.norm() > 0.01);
            program += &format!("G01 X{:.3} C{:.3}\n", goal.x, goal.y);
            paths.push((Path::Line(at, goal), goal));
            program += &format!("G03 X{:.3} C{:.3} I{:.3} J{:.3}\n", goal.x, goal.y, centre.x, centre.y);
            paths.push((Path::Arc(goal + centre, centre.norm()), goal));
            at = goal;
        }
        program += "M30\n";
        // The plane turns with the table, which stands at `angle` when it begins.
        let (sine, cosine) = (-angle).to_radians().sin_cos();
        check(&machine, &program, &paths, |tip| {
            Vector2::new(tip.x * cosine - tip.y * sine, tip.x * sine + tip.y * cosine)
        }, 0.0)?;
    }

    #[test]
    fn cylindrical_interpolation_cuts_lines_and_arcs_on_the_cylinder(
        radius in 5.0..100.0_f64,
        sign in prop_oneof![Just(1), Just(-1)],
        goals in prop::collection::vec((prop::array::uniform2(-80.0..80.0_f64), 1.0..3.0_f64, any::<bool>()), 1..4),
    ) {
        let machine = machine("A", "[1.0, 0.0, 0.0]", sign);
        let radius = written(radius);
        let mut program = format!("O1\nG90 G01 X0 Y0 Z{radius:.3} A0 F500\nG17 G07.1 A{radius:.3}\n");
        let mut paths = Vec::new();
        let mut at = Vector2::new(0.0, 0.0);
        for (goal, factor, is_clockwise) in goals {
            let [x, a] = goal.map(written);
            let goal = Vector2::new(x, a.to_radians() * radius);
            let chord = goal - at;
            prop_assume!(chord.norm() > 0.1);
            let arc_radius = written(chord.norm() / 2.0 * factor + 0.01);
            let height = (arc_radius * arc_radius - chord.norm_squared() / 4.0).sqrt();
            let left = Vector2::new(-chord.y, chord.x) / chord.norm() * height;
            let centre = at + chord / 2.0 + if is_clockwise { -left } else { left };
            let code = if is_clockwise { "G02" } else { "G03" };
            program += &format!("{code} X{x:.3} A{a:.3} R{arc_radius:.3}\n");
            paths.push((Path::Arc(centre, arc_radius), goal));
            at = goal;
        }
        program += "G01 X1. A1.\nM30\n";
        let last = Vector2::new(1.0, 1.0_f64.to_radians() * radius);
        prop_assume!((last - at).norm() > 0.01);
        paths.push((Path::Line(at, last), last));
        // A positive angle turns the part by its sign, and the tool the other way round it.
        let side = -f64::from(sign);
        check(&machine, &program, &paths, |tip| {
            Vector2::new(tip.x, -side * f64::atan2(tip.y, tip.z) * radius)
        }, std::f64::consts::TAU * radius)?;
    }
}
