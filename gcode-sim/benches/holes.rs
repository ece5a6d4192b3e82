//! Time of a run of a program with many holes, and of their verification. Both should grow little more than in
//! proportion to the number of holes.
use std::fmt::Write as _;
use std::sync::Arc;

use divan::counter::ItemsCount;
use gcode_inspect::machine::Machine;
use gcode_inspect::verify::{Answer, Tolerances};
use gcode_lang::program::NoLibrary;
use gcode_part::job::Job;
use gcode_part::{EntryPlanes, Hole, Metal, NominalPart, Reference, Surface};
use gcode_session::{Request, Simulation, simulate};

fn main() {
    divan::main();
}

/// Rows of both groups, and holes in each.
const SIZES: [(u32, u32); 3] = [(20, 50), (100, 100), (200, 500)];

/// A honeycomb, and a program that drills its holes one by one with G81.
struct Case {
    request: Request,
    reference: Reference,
}

impl Case {
    fn new((rows, along): (u32, u32)) -> Self {
        let job = Job::parse(&job(rows, along)).expect("the job is valid");
        let machine = Machine::from_job(&job).expect("the job has a machine");
        let nominal = NominalPart::from_job(&job).expect("the job has a part");
        let reference = nominal.into_holes().expect("the part has holes");
        assert_eq!(reference.holes.len() as u32, rows * along);
        let program = program(&reference, along as usize);
        let mut request = Request::new("O1.nc", program.into_bytes(), machine);
        request.process_limits = reference.process_limits.clone();
        Self { request, reference }
    }

    fn simulate(&self) -> Simulation {
        simulate(&self.request, &mut NoLibrary, self.reference.metal(None)).expect("there is a program")
    }

    fn passes(&self, simulation: &Simulation) -> bool {
        let tolerances = Tolerances::of(&self.reference, None);
        let verdict = simulation.verify(&self.reference, tolerances, &self.request);
        verdict.verdict == Answer::Pass && verdict.holes.len() == self.reference.holes.len()
    }
}

/// Returns a job with holes about 10 mm apart, in rows of `along` holes each.
fn job(rows: u32, along: u32) -> String {
    let diameter = f64::from(rows) * 10.0 * 0.75f64.sqrt() / std::f64::consts::PI;
    let length = 10.0 * (f64::from(along) - 0.25);
    let divisions = rows / 2;
    format!(
        r#"family = "honeycomb"
[control]
dialect = "fanuc-31i"
increment = "IS-B"
[machine]
rotary = {{ letter = "B", sign = 1 }}
clearance = 2.0
retract = 50.0
[cylinder]
diameter = {diameter}
length = {length}
[pattern]
divisions = {divisions}
metric = "arc"
[drill]
diameter = 5.0
depth = 3.0
number = 1
speed = 1000
feed = 60.0
peck = 5.0
[tolerance]
position = 0.1
depth = 0.1
"#
    )
}

fn program(reference: &Reference, along: usize) -> String {
    let mut text = "O1\nG21 G17 G40 G49 G54 G80 G90 G94\nT1 M06\nS1000 M03\nG43 H1 Z50.\n".to_owned();
    let rows = reference.holes.len() / along;
    for (row, holes) in reference.holes.chunks(along).enumerate() {
        let turn = 360.0 * row as f64 / rows as f64;
        write!(text, "G80 G0 B{turn:.3}\nG98 G81 Z-3. R2. F60. K0\n").expect("a string can be written to");
        for hole in holes {
            writeln!(text, "X{:.3} Y0.", hole.entry[0]).expect("a string can be written to");
        }
    }
    text + "G80\nM30\n"
}

/// Runs the program and extracts the holes.
#[divan::bench(args = SIZES, sample_count = 5, sample_size = 1)]
fn extract(bencher: divan::Bencher<'_, '_>, size: (u32, u32)) {
    let case = Case::new(size);
    bencher.counter(ItemsCount::new(case.reference.holes.len())).bench_local(|| case.simulate());
}

/// Verifies the holes against the reference, with their neighbours.
#[divan::bench(args = SIZES, sample_count = 5, sample_size = 1)]
fn verify(bencher: divan::Bencher<'_, '_>, size: (u32, u32)) {
    let case = Case::new(size);
    let simulation = case.simulate();
    assert!(case.passes(&simulation), "the program drills the nominal holes");
    bencher.counter(ItemsCount::new(case.reference.holes.len())).bench_local(|| case.passes(&simulation));
}

/// Through holes, in rows of 125.
const THROUGH: [usize; 3] = [4_000, 8_000, 16_000];

const DRILL: &str = r#"
table = []
[head]
kind = "fixed"
direction = [0.0, 0.0, 1.0]
[[tool]]
number = 1
length = 100.0
diameter = 5.0
kind = "drill"
"#;

/// Drills through holes of a list without diameters, and judges them from both sides.
#[divan::bench(args = THROUGH, sample_count = 5, sample_size = 1)]
fn through_holes(bencher: divan::Bencher<'_, '_>, count: usize) {
    let mut program = "O1\nG21 G17 G40 G49 G54 G80 G90 G94\nT1 M06\nS1500 M03\nG43 H1 Z50.\n\
                       G99 G81 X0. Y0. Z-15. R2. F100. K0\n"
        .to_owned();
    let mut list = "x,y,depth,through\n".to_owned();
    for (x, y) in (0..count).map(|hole| (hole % 125 * 10, hole / 125 * 10)) {
        writeln!(program, "X{x}. Y{y}.").expect("a string can be written to");
        writeln!(list, "{x},{y},10,true").expect("a string can be written to");
    }
    program.push_str("G80\nM30\n");
    let nominal = NominalPart::parse(&list).expect("a valid list");
    let reference = nominal.into_holes().expect("the part has holes");
    let machine = Machine::parse(DRILL).expect("the machine file is valid");
    let mut request = Request::new("O1.nc", program.into_bytes(), machine);
    request.process_limits = reference.process_limits.clone();
    let case = Case { request, reference };
    assert!(case.passes(&case.simulate()), "the program drills the nominal holes");
    bencher.counter(ItemsCount::new(count)).bench_local(|| case.passes(&case.simulate()));
}

/// Trochoidal loops in one pocket.
const LOOPS: [u32; 3] = [500, 1000, 2000];

const MILL: &str = r#"
table = []
[head]
kind = "fixed"
direction = [0.0, 0.0, 1.0]
[rapid]
straight = true
[[tool]]
number = 2
length = 100.0
diameter = 10.0
kind = "end-mill"
"#;

/// Returns a program with loops of twelve chords on a path of radius 4 along x, and rapids back over the floor.
fn loops(count: u32) -> String {
    let mut text = "O1\nG21 G17 G40 G49 G54 G80 G90 G94\nT2 M06\nS6000 M03\nG43 H2 Z50.\nG0 X20. Y20.\nZ2.\nG1 Z-9. F500.\n\
                    X102.\nX20.\n"
        .to_owned();
    for index in 0..count {
        let x = 20.0 + 80.0 * f64::from(index) / f64::from(count);
        for step in 1..=12 {
            let angle = gcode_lang::units::Deg(f64::from(step) * 30.0);
            let (x, y) = (x + 4.0 * angle.sin(), 24.0 - 4.0 * angle.cos());
            writeln!(text, "G1 X{x:.3} Y{y:.3}").expect("a string can be written to");
        }
        let next = x + 80.0 / f64::from(count);
        writeln!(text, "G0 Z-8.5\nX{next:.3}\nG1 Z-9.").expect("a string can be written to");
    }
    text + "G0 Z50.\nM30\n"
}

/// Compares the rapids of trochoidal milling with what the loops before have removed.
#[divan::bench(args = LOOPS, sample_count = 5, sample_size = 1)]
fn rapids_in_a_pocket(bencher: divan::Bencher<'_, '_>, count: u32) {
    let block = |min: [f64; 3], max: [f64; 3]| Surface::Block { min: min.into(), max: max.into() };
    let hole = Hole {
        entry: [3.0, 3.0, 0.0],
        axis: [0.0, 0.0, 1.0],
        depth: 10.0,
        diameter: Some(4.0),
        ..Hole::default()
    };
    let metal = Metal {
        body: Some(block([0.0, 0.0, -20.0], [120.0, 80.0, 0.0])),
        entries: Some(Arc::new(EntryPlanes::of(&[hole], 0.1))),
        pockets: vec![block([5.0, 5.0, -9.0], [115.0, 80.0, 0.0])],
        voids: Vec::new(),
    };
    let machine = Machine::parse(MILL).expect("the machine file is valid");
    let request = Request::new("O1.nc", loops(count).into_bytes(), machine);
    bencher
        .counter(ItemsCount::new(count))
        .bench_local(|| simulate(&request, &mut NoLibrary, metal.clone()).expect("there is a program"));
}

/// Turns of a helix in solid metal.
const TURNS: [u32; 3] = [50, 100, 200];

/// Returns a program with a helix of radius 8 down to 50 mm, wider than the hole by 2 mm.
fn helix(turns: u32) -> String {
    let mut text = "O1\nG21 G17 G40 G49 G54 G80 G90 G94\nT2 M06\nS6000 M03\nG43 H2 Z50.\nG0 X60. Y40.\nZ1.\nG1 Z0. F500.\nX68.\n"
        .to_owned();
    for turn in 1..=turns {
        let depth = 50.0 * f64::from(turn) / f64::from(turns);
        writeln!(text, "G3 I-8. Z-{depth:.4}").expect("a string can be written to");
    }
    text + "G3 I-8.\nG1 X60.\nG0 Z50.\nM30\n"
}

/// Judges each turn by what the turns above it have removed.
#[divan::bench(args = TURNS, sample_count = 5, sample_size = 1)]
fn turns_of_a_helix(bencher: divan::Bencher<'_, '_>, count: u32) {
    bencher.counter(ItemsCount::new(count)).bench_local(|| simulate_in_block(helix(count)));
}

/// Holes drilled in pecks of 0.1 mm.
const PECKED: [u32; 3] = [50, 100, 200];

/// Drills holes of 500 pecks each in solid metal.
#[divan::bench(args = PECKED, sample_count = 5, sample_size = 1)]
fn pecks(bencher: divan::Bencher<'_, '_>, count: u32) {
    let mut text =
        "O1\nG21 G17 G40 G49 G54 G80 G90 G94\nT2 M06\nS6000 M03\nG43 H2 Z50.\nG0 X60. Y40.\n".to_owned();
    for _ in 0..count {
        text.push_str("G83 X60. Y40. Z-50. R2. Q0.1 F200.\nG83 X61.\n");
    }
    text.push_str("G80\nM30\n");
    bencher.counter(ItemsCount::new(count)).bench_local(|| simulate_in_block(text.clone()));
}

/// Runs a program on a block of 120 × 80 × 60 with one hole of Φ22 in it.
fn simulate_in_block(program: String) -> Simulation {
    let hole = Hole {
        entry: [60.0, 40.0, 0.0],
        axis: [0.0, 0.0, 1.0],
        depth: 50.0,
        diameter: Some(22.0),
        ..Hole::default()
    };
    let body = Surface::Block { min: [0.0, 0.0, -60.0].into(), max: [120.0, 80.0, 0.0].into() };
    let entries = Some(Arc::new(EntryPlanes::of(&[hole], 0.1)));
    let machine = Machine::parse(MILL).expect("the machine file is valid");
    let request = Request::new("O1.nc", program.into_bytes(), machine);
    simulate(
        &request,
        &mut NoLibrary,
        Metal { body: Some(body), entries, pockets: Vec::new(), voids: Vec::new() },
    )
    .expect("there is a program")
}

/// Passes side by side, each 3 mm beside the one before, and rapids among them.
const PASSES: [(u32, u32); 3] = [(16, 250), (32, 500), (64, 1000)];

/// Returns numbers from 0 to 1 that look random.
fn spread(start: u32) -> impl Iterator<Item = f64> {
    std::iter::successors(Some(start), |last| Some(last.wrapping_mul(1_664_525).wrapping_add(1_013_904_223)))
        .map(|number| f64::from(number) / f64::from(u32::MAX))
}

/// Returns a program that mills a pocket in straight passes, and moves through it in rapids of three axes.
fn passes((passes, rapids): (u32, u32)) -> String {
    let mut text = "O1\nG21 G17 G40 G49 G54 G80 G90 G94\nT2 M06\nS6000 M03\nG43 H2 Z50.\nG0 X20. Y20.\nZ1.\nG1 Z-5. F500.\n"
        .to_owned();
    for pass in 0..passes {
        let (x, y) = (if pass % 2 == 0 { 380 } else { 20 }, 20 + 3 * pass);
        writeln!(text, "G1 Y{y}.\nX{x}.").expect("a string can be written to");
    }
    let mut numbers = spread(7);
    let width = f64::from(3 * (passes - 1));
    for _ in 0..rapids {
        let [x, y, z] = std::array::from_fn(|_| numbers.next().unwrap_or_default());
        let (x, y, z) = (21.0 + 358.0 * x, 20.0 + width * y, -4.9 * z);
        writeln!(text, "G0 X{x:.1} Y{y:.1} Z{z:.2}").expect("a string can be written to");
    }
    text + "G0 Z50.\nM30\n"
}

/// Compares rapids with passes that they all cross.
#[divan::bench(args = PASSES, sample_count = 5, sample_size = 1)]
fn rapids_across_passes(bencher: divan::Bencher<'_, '_>, size: (u32, u32)) {
    let metal = Metal {
        body: Some(Surface::Block { min: [0.0, 0.0, -20.0].into(), max: [400.0, 300.0, 0.0].into() }),
        entries: Some(Arc::new(EntryPlanes::of(&[hole_beside()], 0.1))),
        pockets: vec![Surface::Block { min: [0.0, 0.0, -5.0].into(), max: [400.0, 230.0, 1.0].into() }],
        voids: Vec::new(),
    };
    let machine = MILL.replace("straight = true", "rates = { X = 24000.0, Y = 24000.0, Z = 18000.0 }");
    let machine = Machine::parse(&machine.replace("diameter = 10.0", "diameter = 3.0"))
        .expect("the machine file is valid");
    let request = Request::new("O1.nc", passes(size).into_bytes(), machine);
    bencher
        .counter(ItemsCount::new(size.1))
        .bench_local(|| simulate(&request, &mut NoLibrary, metal.clone()).expect("there is a program"));
}

/// Chords that cross each other in one pocket.
const CHORDS: [u32; 3] = [1_250, 2_500, 5_000];

/// Follows chords through what all chords before them have removed.
#[divan::bench(args = CHORDS, sample_count = 5, sample_size = 1)]
fn chords_across_each_other(bencher: divan::Bencher<'_, '_>, count: u32) {
    let mut text = "O1\nG21 G17 G40 G49 G54 G80 G90 G94\nT2 M06\nS6000 M03\nG43 H2 Z50.\nG0 X20. Y20.\nZ1.\nG1 Z-3. F500.\n"
        .to_owned();
    let mut numbers = spread(11);
    for _ in 0..count {
        let [x, y] = std::array::from_fn(|_| numbers.next().unwrap_or_default());
        writeln!(text, "X{:.1} Y{:.1}", 20.0 + 360.0 * x, 20.0 + 190.0 * y)
            .expect("a string can be written to");
    }
    text.push_str("G0 Z50.\nM30\n");
    let metal = Metal {
        body: Some(Surface::Block { min: [0.0, 0.0, -20.0].into(), max: [400.0, 300.0, 0.0].into() }),
        entries: Some(Arc::new(EntryPlanes::of(&[hole_beside()], 0.1))),
        pockets: vec![Surface::Block { min: [0.0, 0.0, -5.0].into(), max: [400.0, 230.0, 1.0].into() }],
        voids: Vec::new(),
    };
    let machine = Machine::parse(MILL).expect("the machine file is valid");
    let request = Request::new("O1.nc", text.into_bytes(), machine);
    bencher
        .counter(ItemsCount::new(count))
        .bench_local(|| simulate(&request, &mut NoLibrary, metal.clone()).expect("there is a program"));
}

/// Returns a hole beside all milling.
fn hole_beside() -> Hole {
    Hole {
        entry: [50.0, 250.0, 0.0],
        axis: [0.0, 0.0, 1.0],
        depth: 10.0,
        diameter: Some(8.0),
        ..Hole::default()
    }
}

/// Holes of a list.
const ROWS: [usize; 3] = [25_000, 50_000, 100_000];

/// Reads a list of holes as CSV.
#[divan::bench(args = ROWS, sample_count = 5, sample_size = 1)]
fn read_list(bencher: divan::Bencher<'_, '_>, count: usize) {
    let mut text = "id,x,y,z,depth,diameter\n".to_owned();
    for row in 0..count {
        writeln!(text, "{row},{},{},0,10,6", row % 400 * 8, row / 400 * 8)
            .expect("a string can be written to");
    }
    bencher.counter(ItemsCount::new(count)).bench_local(|| NominalPart::parse(&text).expect("a valid list"));
}
