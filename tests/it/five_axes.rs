//! Law of tilted planes: on every machine with two rotary axes the control's machine coordinates lead, by the forward kinematics
//! of the machine, to the tip and the direction that the program states.
use gcode_control::Outcome;
use gcode_inspect::machine::{AxisMotion, Machine, Setup};
use gcode_lang::control::Settings;
use gcode_lang::motion::{EventKind, Position};
use gcode_tests::expect::{Ran, run_on};
use nalgebra::{Point3, Rotation3, Unit, Vector3};
use proptest::prelude::*;

/// A machine with both rotary axes on the table, one on each side, or both on the head.
#[derive(Clone, Debug)]
struct Arrangement {
    on_head: usize,
    directions: [[f64; 3]; 2],
    signs: [f64; 2],
    centres: [[f64; 3]; 2],
    pivot: f64,
    origin: [f64; 3],
    /// Work offsets of the rotary axes of the table.
    zeros: [f64; 2],
}

/// Orthogonal or nutating: A with B or C, B with C, or C with an axis between y and z.
fn directions() -> impl Strategy<Value = [[f64; 3]; 2]> {
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    prop_oneof![
        Just([x, z]),
        Just([y, z]),
        Just([x, y]),
        (20.0..70.0_f64).prop_map(move |lean| [[0.0, lean.to_radians().sin(), lean.to_radians().cos()], z]),
    ]
}

fn arrangement() -> impl Strategy<Value = Arrangement> {
    let sign = || prop_oneof![Just(1.0), Just(-1.0)];
    let point = || prop::array::uniform3(-200.0..200.0);
    let signs = (sign(), sign()).prop_map(|(a, b)| [a, b]);
    let zeros = prop::array::uniform2(-30.0..30.0);
    (0..3_usize, directions(), signs, [point(), point()], 0.0..300.0, point(), zeros).prop_map(
        |(on_head, mut directions, signs, centres, pivot, origin, zeros)| {
            // The axis along z is next to the part, or next to the slides.
            if on_head == 2 {
                directions.swap(0, 1);
            }
            Arrangement { on_head, directions, signs, centres, pivot, origin, zeros }
        },
    )
}

impl Arrangement {
    fn machine(&self) -> Machine {
        let link = |index: usize, section: &str| {
            format!(
                "[[{section}]]\nletter = \"{}\"\nturns = {:?}\nsign = {}\ncentre = {:?}\n",
                ["A", "C"][index],
                self.directions[index],
                self.signs[index],
                self.centres[index]
            )
        };
        let tables: String = (self.on_head..2).map(|index| link(index, "table")).collect();
        let heads: String = (0..self.on_head).map(|index| link(index, "head.axis")).collect();
        let head = match heads.as_str() {
            "" => {
                format!("[head]\nkind = \"fixed\"\ndirection = [0.0, 0.0, 1.0]\npivot = {:?}\n", self.pivot)
            }
            _ => format!("[head]\nkind = \"axes\"\npivot = {:?}\n{heads}", self.pivot),
        };
        let text = format!("{tables}{head}[part]\norigin = {:?}\n", self.origin);
        let text = if tables.is_empty() { format!("table = []\n{text}") } else { text };
        Machine::parse(&text).unwrap_or_else(|error| panic!("{error}\n{text}"))
    }

    /// Positions of the rotary axes at their work zeros.
    fn rotary_zero(&self, machine: &Machine) -> Position {
        let mut zero = Position::default();
        for index in self.on_head..2 {
            zero[machine.axes.find(b"AC"[index]).unwrap()] = written(self.zeros[index]);
        }
        zero
    }
}

/// A machine with its work offsets set.
struct SetUp {
    machine: Machine,
    /// Positions of the rotary axes at their work zeros.
    zero: Position,
    /// Work zero of the slides: the part's origin with the table at its work zeros.
    work: Vector3<f64>,
    pivot: f64,
}

impl SetUp {
    fn of(arrangement: &Arrangement) -> Self {
        let machine = arrangement.machine();
        let zero = arrangement.rotary_zero(&machine);
        let origin = machine.part_frame(&zero) * Point3::origin() + Vector3::z() * arrangement.pivot;
        Self { machine, zero, work: origin.coords.map(written), pivot: arrangement.pivot }
    }

    /// Returns the blocks that set the work offsets and the length of H1, and G90 G21.
    fn offsets(&self, length: f64) -> String {
        format!(
            "#5221={:.3}\n#5222={:.3}\n#5223={:.3}\n#5224={:.3}\n#5226={:.3}\n#11001={length:.3}\nG90 G21\n",
            self.work.x, self.work.y, self.work.z, self.zero[3], self.zero[5]
        )
    }

    /// Returns the point of the part at coordinates of the work, with the table at its work zeros.
    fn on_part(&self, point: Vector3<f64>) -> Point3<f64> {
        let placed = Point3::from(point + self.work) - Vector3::z() * self.pivot;
        self.machine.part_frame(&self.zero).inverse_transform_point(&placed)
    }
}

/// Rounds to the digits of a program.
fn written(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0
}

/// Returns the set-up of the tool with the last length offset of a run.
fn last_setup(ran: &Ran) -> Setup {
    let mut offsets = ran.recorder.0.iter().filter_map(|(_, kind, _)| match kind {
        EventKind::ToolLength { offset, .. } => Some(*offset),
        _ => None,
    });
    Setup { offset: offsets.next_back().unwrap(), ..Setup::default() }
}

fn run(machine: &Machine, program: &str) -> Ran {
    let settings = Settings { kinematics: machine.kinematics(), ..Settings::default() };
    run_on(program.as_bytes(), settings, 1000)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn the_tip_and_the_tool_are_where_the_plane_says(
        arrangement in arrangement(),
        (i, j, k) in (-180.0..180.0_f64, 5.0..85.0_f64, -180.0..180.0_f64),
        plane in prop::array::uniform3(-100.0..100.0_f64),
        point in prop::array::uniform3(-100.0..100.0_f64),
        length in 10.0..250.0_f64,
        side in 0..3_u32,
    ) {
        let set_up = SetUp::of(&arrangement);
        let SetUp { machine, zero, .. } = &set_up;
        let [px, py, pz] = plane.map(written);
        let [x, y, z] = point.map(written);
        let (i, j, k, length) = (written(i), written(j), written(k), written(length));
        let program = format!(
            "O1\n{}\
             G68.2 X{px:.3} Y{py:.3} Z{pz:.3} I{i:.3} J{j:.3} K{k:.3}\nG53.1 P{side}\nG43 H1 G00 X{x:.3} Y{y:.3} Z{z:.3}\n\
             G81 X{x:.3} Y{y:.3} Z{:.3} R{z:.3} F100\nG80\nG00 X0 Y0 Z{z:.3}\nM30\n",
            set_up.offsets(length), z - 20.0
        );
        let ran = run(machine, &program);
        if let Outcome::Alarm(stopped) = &ran.outcome {
            // A nutating axis doesn't reach every direction, and with P1 or P2 both solutions may have one sign.
            prop_assert_eq!(stopped.alarm.code().to_string(), "PS5459");
            let is_square = arrangement.directions.iter().all(|direction| direction.contains(&1.0));
            prop_assert!(side != 0 || !is_square, "{program}");
            return Ok(());
        }
        let euler = Rotation3::from_axis_angle(&Vector3::z_axis(), i.to_radians())
            * Rotation3::from_axis_angle(&Vector3::x_axis(), j.to_radians())
            * Rotation3::from_axis_angle(&Vector3::z_axis(), k.to_radians());
        let in_work = |point: Vector3<f64>| Vector3::new(px, py, pz) + euler * point;
        let axis = machine.part_frame(zero).rotation.inverse_transform_unit_vector(
            &Unit::new_normalize(euler * Vector3::z()),
        );
        let setup = last_setup(&ran);
        let moves: Vec<_> = ran.recorder.moves().map(|(_, at)| *at).collect();
        // The last four: to the point, down, back, and to the axis of the plane.
        let goals = [[x, y, z], [x, y, z - 20.0], [x, y, z], [0.0, 0.0, z]].map(|p| set_up.on_part(in_work(Vector3::from(p))));
        for (at, goal) in moves[moves.len() - 4..].iter().zip(goals) {
            let pose = machine.forward(at, &setup);
            prop_assert!((pose.tip - goal).norm() < 1e-6, "{} is not {goal}\n{program}", pose.tip);
            let found = pose.axis.unwrap();
            prop_assert!((found.into_inner() - axis.into_inner()).norm() < 1e-6, "{found:?} is not {axis:?}");
        }
    }

    #[test]
    fn the_tip_moves_straight_on_the_part_while_the_axes_turn(
        arrangement in arrangement(),
        from in prop::array::uniform3(-100.0..100.0_f64),
        to in prop::array::uniform3(-100.0..100.0_f64),
        angles in prop::array::uniform4(-179.0..179.0_f64),
        length in 10.0..250.0_f64,
    ) {
        let set_up = SetUp::of(&arrangement);
        let machine = &set_up.machine;
        let ([x, y, z], [u, v, w], [a, c, e, g]) = (from.map(written), to.map(written), angles);
        let program = format!(
            "O1\n{}\
             G43.4 H1\nG00 X{x:.3} Y{y:.3} Z{z:.3} A{a:.3} C{c:.3}\nM00\n\
             G01 X{u:.3} Y{v:.3} Z{w:.3} A{e:.3} C{g:.3} F1000\nM30\n",
            set_up.offsets(length)
        );
        let ran = run(machine, &program);
        prop_assert!(matches!(ran.outcome, Outcome::End), "{:?}\n{program}", ran.outcome);
        let [start, end] = [[x, y, z], [u, v, w]].map(|point| set_up.on_part(Vector3::from(point)));
        let mut offset = Position::default();
        offset[2] = written(length);
        let setup = Setup { offset, ..Setup::default() };
        let along = end - start;
        let aside = |tip: Point3<f64>| {
            let t = ((tip - start).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            (tip - (start + along * t)).norm()
        };
        let mut last = None;
        for (kind, at) in ran.recorder.moves() {
            if let (Some(from), 'F') = (last, kind) {
                let chord = AxisMotion { from: &from, to: at, arc: None };
                let middle = machine.forward(&chord.position(0.5), &setup);
                prop_assert!(aside(middle.tip) < 0.001, "{}\n{program}", aside(middle.tip));
                let tip = machine.forward(at, &setup).tip;
                prop_assert!(aside(tip) < 1e-6, "{}\n{program}", aside(tip));
            }
            last = Some(*at);
        }
        let at = last.unwrap();
        prop_assert!((machine.forward(&at, &setup).tip - end).norm() < 1e-6);
    }

    #[test]
    fn the_tip_stays_on_the_part_while_the_axes_turn_to_a_plane(
        arrangement in arrangement(),
        (i, j, k) in (-180.0..180.0_f64, 5.0..85.0_f64, -180.0..180.0_f64),
        point in prop::array::uniform3(-100.0..100.0_f64),
        length in 10.0..250.0_f64,
    ) {
        let machine = arrangement.machine();
        let zero = arrangement.rotary_zero(&machine);
        let [x, y, z] = point;
        let program = format!(
            "O1\n#5224={:.3}\n#5226={:.3}\n#11001={length:.3}\nG90 G21\nG43 H1 G00 X{x:.3} Y{y:.3} Z{z:.3}\n\
             G68.2 X0 Y0 Z0 I{i:.3} J{j:.3} K{k:.3}\nG53.6\nM30\n",
            zero[3], zero[5]
        );
        let ran = run(&machine, &program);
        if matches!(ran.outcome, Outcome::Alarm(_)) {
            return Ok(());
        }
        let mut offset = Position::default();
        offset[2] = written(length);
        let setup = Setup { offset, ..Setup::default() };
        let moves: Vec<_> = ran.recorder.moves().map(|(_, at)| *at).collect();
        let tip = machine.forward(&moves[0], &setup).tip;
        for pair in moves.windows(2) {
            let chord = AxisMotion { from: &pair[0], to: &pair[1], arc: None };
            let middle = machine.forward(&chord.position(0.5), &setup).tip;
            prop_assert!((middle - tip).norm() < 0.001, "{}\n{program}", (middle - tip).norm());
            let end = machine.forward(&pair[1], &setup).tip;
            prop_assert!((end - tip).norm() < 1e-6, "{}\n{program}", (end - tip).norm());
        }
    }

    #[test]
    fn a_plane_from_the_tool_has_the_tool_as_its_z(
        arrangement in arrangement(),
        angles in prop::array::uniform2(-170.0..170.0_f64),
        plane in prop::array::uniform3(-100.0..100.0_f64),
        point in prop::array::uniform3(-100.0..100.0_f64),
        turn in -180.0..180.0_f64,
        length in 10.0..250.0_f64,
    ) {
        let set_up = SetUp::of(&arrangement);
        let machine = &set_up.machine;
        let ([px, py, pz], [x, y, z], [a, c]) = (plane.map(written), point.map(written), angles);
        let program = format!(
            "O1\n{}\
             G00 A{a:.3} C{c:.3}\nG68.3 X{px:.3} Y{py:.3} Z{pz:.3} R{turn:.3}\nG43 H1 G00 X0 Y0 Z0\nX{x:.3} Y{y:.3} Z{z:.3}\nM30\n",
            set_up.offsets(length)
        );
        let ran = run(machine, &program);
        prop_assert!(matches!(ran.outcome, Outcome::End), "{:?}\n{program}", ran.outcome);
        let setup = last_setup(&ran);
        let moves: Vec<_> = ran.recorder.moves().map(|(_, at)| *at).collect();
        let [at_origin, at_point] = [moves[moves.len() - 2], moves[moves.len() - 1]].map(|at| machine.forward(&at, &setup));
        let goal = set_up.on_part(Vector3::new(px, py, pz));
        prop_assert!((at_origin.tip - goal).norm() < 1e-6, "{} is not {goal}\n{program}", at_origin.tip);
        let way = at_point.tip - at_origin.tip;
        prop_assert!((way.norm() - Vector3::new(x, y, z).norm()).abs() < 1e-6);
        prop_assert!((way.dot(&at_point.axis.unwrap()) - z).abs() < 1e-6, "{program}");
    }
}

/// Every cycle on a plane that is turned by 90 degrees about X makes the moves of the same cycle in G17, turned with it: on a
/// trunnion the table turns and the path keeps its directions, under a fork head the plane's Y is Z and its Z is -Y.
#[test]
fn every_cycle_of_a_tilted_plane_makes_the_moves_of_the_cycle() {
    let trunnion = include_str!("../suite/control/tilted_planes_on_a_trunnion/machine.toml");
    let fork = include_str!("../suite/control/tilted_planes_under_a_fork_head/machine.toml");
    let about_x = Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2);
    let cycles = [
        "G73 X3. Y4. Z-6. R1. Q2.",
        "G74 X3. Y4. Z-6. R1.",
        "G76 X3. Y4. Z-6. R1. Q0.5",
        "G81 X3. Y4. Z-6. R1.",
        "G82 X3. Y4. Z-6. R1. P500",
        "G83 X3. Y4. Z-6. R1. Q2.",
        "G84 X3. Y4. Z-6. R1.",
        "G85 X3. Y4. Z-6. R1.",
        "G86 X3. Y4. Z-6. R1.",
        "G87 X3. Y4. Z-2. R-6. Q0.5",
        "G89 X3. Y4. Z-6. R1. P500",
    ];
    for (machine, turned) in [(trunnion, Rotation3::identity()), (fork, about_x)] {
        let machine = Machine::parse(machine).unwrap();
        for cycle in cycles {
            for level in ["G98", "G99"] {
                let path = |plane: &str| {
                    let text = format!(
                        "O1\nG90 G21 G17 S500 M3\n{plane}G00 X0 Y0 Z20.\n{level} {cycle} F100\nX20. Y5.\nG80\nM30\n"
                    );
                    let ran = run(&machine, &text);
                    assert!(matches!(ran.outcome, Outcome::End), "{text}: {:?}", ran.outcome);
                    let moves =
                        ran.recorder.moves().map(|(kind, at)| (kind, Vector3::new(at[0], at[1], at[2])));
                    moves.collect::<Vec<_>>()
                };
                let (flat, tilted) = (path(""), path("G68.2 X0 Y0 Z0 I0 J90. K0\nG53.1\n"));
                let tilted = &tilted[tilted.len() - flat.len()..];
                for (a, b) in flat.iter().zip(tilted) {
                    let expected = turned * (a.1 - flat[0].1);
                    let found = b.1 - tilted[0].1;
                    assert!(
                        a.0 == b.0 && (found - expected).norm() < 1e-9,
                        "{level} {cycle}: {found} is not {expected}"
                    );
                }
                assert!(flat.len() > 6, "{level} {cycle}: {flat:?}");
            }
        }
    }
}
