//! The ellipse program of an alignment: the ball's distance from the surface along the emitted path, the count of moves, and the
//! reading on a misplaced part.
use gcode_gen::check::Programs;
use gcode_inspect::holes::HoleExtractor;
use gcode_inspect::machine::{Machine, Placement};
use gcode_lang::control::Increment;
use gcode_lang::program::NoLibrary;
use gcode_lang::units::{Deg, Mm};
use gcode_part::{Surface, tilted_ellipsoid};
use gcode_session::{Request, StylusRun, read_stylus, run};
use gcode_tests::bench::{Bench, alarm, value};
use gcode_tests::expect::Recorder;
use nalgebra::Vector3;

/// An ellipsoid, the ends of the path, the ball, the chord error, the control.
#[derive(Clone, Copy)]
struct Path {
    a: f64,
    b: f64,
    from: f64,
    to: f64,
    radius: f64,
    chord_error: f64,
    dialect: &'static str,
    increment: &'static str,
}

const MELON: Path = Path {
    a: 1158.8,
    b: 724.3,
    from: 318.0,
    to: 812.4,
    radius: 3.0,
    chord_error: 0.002,
    dialect: "fanuc-31i",
    increment: "IS-B",
};

impl Path {
    fn bench(&self) -> Bench {
        let Self { a, b, from, to, radius, chord_error, dialect, increment } = self;
        let text = format!(
            "family = \"alignment\"\n\
             control = {{ dialect = \"{dialect}\", increment = \"{increment}\" }}\n\
             machine = {{ rotary = {{ letter = \"B\", sign = 1 }} }}\n\
             surface = {{ kind = \"ellipsoid\", a = {a:?}, b = {b:?} }}\n\
             probe = {{ radius = {radius:?} }}\n\
             sine_table = {{ length = 200.0, phi = 38.5, gauge_blocks = \"metric-87\" }}\n\
             chord = {{ e_radius = 3.0, f_radius = 2.0, circle = 0.1, candidates = 10 }}\n\
             runout = {{ heights = [1.0, 2.0], angles = [-25.0, 25.0, 11] }}\n\
             ellipse = {{ from = {from:?}, to = {to:?}, chord_error = {chord_error:?} }}\n"
        );
        Bench::of(&text)
    }

    fn surface(&self) -> Surface {
        Surface::Ellipsoid { a: self.a, b: self.b }
    }

    /// What is read on a part that is shifted and tilted about z.
    fn read(&self, shift: [f64; 3], tilt: f64) -> StylusRun {
        let bench = self.bench();
        let mut request = bench.request(8220);
        request.machine.part.shift = Vector3::from(shift);
        request.machine.part.tilt[2] = Deg(tilt);
        read_stylus(&request, &mut Programs(&bench.package), self.surface(), self.radius).unwrap()
    }
}

/// The points of the path, where the ball is fed from contact to contact.
fn points(path: &Path) -> Vec<[f64; 2]> {
    let mut recorder = Recorder::default();
    let ran = path.bench().run_to(8220, &mut recorder);
    assert_eq!(alarm(&ran), None);
    recorder.moves().filter(|(kind, _)| *kind == 'F').map(|(_, to)| [to[0], to[1]]).collect()
}

/// The distance of a point outside from the ellipse, by trying: the least of the distances to points of it, ever closer
/// together.
fn distance(path: &Path, [x, y]: [f64; 2]) -> f64 {
    let far = |t: f64| f64::hypot(path.a * Deg(t).cos() - x, path.b * Deg(t).sin() - y);
    let (mut low, mut high) = (-5.0, 95.0);
    for _ in 0..100 {
        let (one, other) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if far(one) < far(other) { high = other } else { low = one }
    }
    far((low + high) / 2.0)
}

const PATHS: [Path; 7] = [
    MELON,
    Path { from: 812.4, to: 318.0, ..MELON },
    // From the pole to the equator and back, on a flat and on a tall body.
    Path { a: 300.0, b: 120.0, from: 0.0, to: 300.0, chord_error: 0.01, ..MELON },
    Path { a: 120.0, b: 300.0, from: 120.0, to: 0.0, chord_error: 0.01, dialect: "haas-ngc", ..MELON },
    // A sphere, and a ball that is larger than the part.
    Path { a: 50.0, b: 50.0, from: 0.0, to: 50.0, radius: 80.0, chord_error: 0.001, ..MELON },
    Path {
        a: 40.0,
        b: 4.0,
        from: 0.0,
        to: 40.0,
        chord_error: 0.5,
        increment: "IS-A",
        dialect: "fanuc-0i-f",
        ..MELON
    },
    Path { from: 1158.8, to: 1100.0, chord_error: 0.000_3, increment: "IS-C", ..MELON },
];

/// At twenty places of every move the ball is nowhere farther off its distance than the chord error allows, rounding included.
#[test]
fn the_ball_keeps_its_distance_between_the_points_too() {
    for path in PATHS {
        let points = points(&path);
        for pair in points.windows(2) {
            for part in (0..=20).map(|n| f64::from(n) / 20.0) {
                let at = [0, 1].map(|i| pair[0][i] + (pair[1][i] - pair[0][i]) * part);
                let off = distance(&path, at) - path.radius;
                assert!(off.abs() <= path.chord_error, "{off} at {at:?}, a {} b {}", path.a, path.b);
            }
        }
        // It begins and ends over the specified x: there the normal goes through the point of the surface.
        for (at, x) in [(points[0], path.from), (points[points.len() - 1], path.to)] {
            let y = path.b * (1.0 - (x / path.a) * (x / path.a)).sqrt();
            let far = f64::hypot(at[0] - x, at[1] - y);
            let rounding = if path.increment == "IS-A" { 0.01 } else { 0.001 };
            assert!((far - path.radius).abs() < rounding, "{far} from ({x}, {y})");
        }
    }
}

/// The least count: a chord of a curve with radius of curvature ρ that strays by e is √(8·ρ·e) long, so that no path has
/// fewer moves than the integral of √(ρ/(8·e)) over the angle of the normal; ρ = a²b²/h³ + r.
#[test]
fn no_path_has_fewer_moves() {
    for path in PATHS {
        let Path { a, b, radius, .. } = path;
        let increment = match path.increment {
            "IS-A" => 0.01,
            "IS-B" => 0.001,
            _ => 0.0001,
        };
        let angle = |x: f64| Deg::atan2(a * ((a - x) * (a + x)).sqrt(), b * x).0;
        let (from, to) = (angle(path.from), angle(path.to));
        let steps = 2000;
        let width = Deg((to - from).abs() / f64::from(steps)).to_rad();
        let sum: f64 = (0..steps)
            .map(|n| {
                let t = Deg(from + (to - from) * (f64::from(n) + 0.5) / f64::from(steps));
                let h = f64::hypot(a * t.cos(), b * t.sin());
                let bend = a * a * b * b / (h * h * h) + radius;
                (bend / (8.0 * (path.chord_error - 0.75 * increment))).sqrt() * width
            })
            .sum();
        // From contact to contact; the last feed is the last move.
        let moves = points(&path).len() - 1;
        let least = sum.ceil();
        assert!((moves as f64) < 1.02 * least + 2.0, "{moves} moves, {least} would do for a {a} b {b}");
    }
}

/// The modes are back, and the program runs on a second call from where it ended.
#[test]
fn the_program_ends_clear_of_the_part_with_the_modes_it_found() {
    let bench = MELON
        .bench()
        .edited(8220, "N70 M30 => #500=#4001;#501=#4003;#502=#5001;#503=#5002;M30")
        .edited(8220, "G90 G94 => G91 G94")
        .edited(8220, "N50 B0. => G90 B0.;G91");
    let ran = bench.run(8220, &Placement::default(), &[]);
    assert_eq!(alarm(&ran), None);
    let value = |number: u32| value(&ran, number);
    assert_eq!((value(500), value(501)), (0.0, 91.0));
    let end = [value(502), value(503)];
    assert!((distance(&MELON, end) - 50.0 - 3.0).abs() < 0.002, "{end:?}");
}

/// A part that is shifted by s and tilted by δ about z has its surface moved along the normal by n·s + δ·(x·n_y − y·n_x);
/// the ball gets that much nearer, up to what bends over so short a way.
#[test]
fn the_reading_on_a_misplaced_part_is_its_displacement_along_the_normal() {
    for (shift, tilt) in [
        ([0.05, 0.0, 0.0], 0.0),
        ([0.0, -0.04, 0.0], 0.0),
        ([0.0, 0.0, 0.3], 0.0),
        ([0.0; 3], 0.01),
        ([0.0; 3], -0.01),
        ([0.03, -0.02, 0.1], 0.005),
    ] {
        let following = MELON.read(shift, tilt);
        let readings = &following.readings.passes[0].readings;
        assert!(readings.len() > 500);
        for reading in readings {
            let [x, y, _]: [f64; 3] = reading.ball_centre.coords.into();
            let normal = MELON.surface().nearest(&reading.ball_centre).normal;
            let moved = normal.x * shift[0] + normal.y * shift[1];
            let turned = Deg(tilt).to_rad() * (x * normal.y - y * normal.x);
            let off = reading.value + moved + turned;
            assert!(off.abs() < 0.002 + 1e-4, "{off} beyond {moved} and {turned} at {reading:?}");
        }
    }
}

/// The indicator of figure 5 by its formula, and the machine's own ball of radius 0 sent against the tilted part along x.
#[test]
fn the_machine_finds_the_reading_of_the_formula_of_figure_5() {
    for tilt in [1.0, -1.0, 0.3] {
        let text = format!("[probe]\nradius = 0.0001\n[part]\ntilt = [0.0, 0.0, {tilt:?}]\n");
        let machine = Machine::parse(&text).unwrap();
        let program = b"O1\nG21 G90 G94 G00 X1500. Y200.\nG31 X1000. F100.\n#500=#5061\nM30\n%\n";
        let mut request = Request::new("O1.nc", program.as_slice(), machine);
        request.settings.increment = Increment::IsC;
        let surface = MELON.surface();
        let mut probe = HoleExtractor::new(&request.machine).with_surface(Some(surface));
        let ran = run(&request, &mut NoLibrary, &mut probe).unwrap();
        let x = value(&ran, 500);
        let indicated = tilted_ellipsoid(Mm(1158.8), Mm(724.3), Mm(200.0), Deg(tilt)).unwrap();
        // The ball's radius, and half an increment.
        let expected = indicated.radius + indicated.change;
        assert!((x - expected.0).abs() < 3e-4, "{x} is not {expected}");
    }
}
