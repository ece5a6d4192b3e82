//! Properties of the control: it never panics, and it runs the same program the same way every time.
use gcode_control::{Control, Limits, Outcome};
use gcode_lang::control::Settings;
use gcode_lang::motion::Axes;
use gcode_lang::program::{Memory, NoLibrary};
use gcode_tests::expect::{self, Recorder};
use proptest::prelude::*;

fn run(program: &[u8], settings: &Settings) -> (String, Recorder) {
    let ran = expect::run_on(program, settings.clone(), 500);
    (format!("{:?}", ran.outcome), ran.recorder)
}

/// Pieces that real blocks are made of, right and wrong ones.
const PIECES: &[&str] = &[
    "\n", "\n", "\n", "\n", "G", "G0", "G1", "G2", "G3", "G4", "G10", "G16", "G17", "G18", "G19", "G20",
    "G28", "G31", "G39", "G40", "G41", "G42", "G43", "G49", "G51", "G51.1", "G52", "G53", "G54.1", "G65",
    "G66", "G67", "G68", "G68.2", "G73", "G76", "G80", "G81", "G83", "G87", "G90", "G91", "G92", "G93",
    "G95", "G99", "M3", "M6", "M98", "M99", "M30", "P", "P1", "P2", "L2", "L20", "X", "X1.", "X-0.001",
    "Y#1", "Z-5.", "B400.", "R2.", "R-3", "I1.", "J-1.", "K3", "Q0.5", "F100", "S1000", "T1", "H1", "D1",
    "N10", "N20", "GOTO10", "GOTO#2", "IF[", "]GOTO20", "]THEN", "WHILE[", "]DO1", "DO2", "END1", "END2",
    "#1", "#100", "#[", "#5221", "#4001", "#11001", "#13001", ",R0.5", ",C0.5", "D1X9.", "Y9.", "=", "+",
    "-", "*", "/", "MOD", "AND", "[", "]", "SQRT[", "ATAN[", "]/[", "POW[", ",", "EQ", "LT", "#0", "0", "1",
    "99999999", "0.5", "1e9", "(TEXT)", "O1", "O2", "%", "/", " ",
];

fn programs() -> impl Strategy<Value = String> {
    let piece = prop::sample::select(PIECES);
    prop::collection::vec(piece, 0..60).prop_map(|pieces| format!("O1\n{}", pieces.concat()))
}

fn settings() -> impl Strategy<Value = Settings> {
    (any::<bool>(), any::<bool>(), prop::option::of(0.0..1.0)).prop_map(
        |(calculator_input, rolls, skip_signal)| {
            let mut settings =
                Settings { uses_calculator_input: calculator_input, skip_signal, ..Settings::default() };
            settings.rolls_over[4] = rolls;
            settings
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(2000) })]

    #[test]
    fn a_run_never_panics_and_is_the_same_every_time(program in programs(), settings in settings()) {
        prop_assert_eq!(run(program.as_bytes(), &settings), run(program.as_bytes(), &settings));
    }

    #[test]
    fn any_bytes_run_to_an_end(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        run(&bytes, &Settings::default());
    }
}

/// Each pass of the loop is two blocks and 20,000 moves.
#[test]
fn a_loop_round_a_cycle_with_many_holes_ends_by_its_moves() {
    let mut memory = Memory::default();
    memory.load("case.nc", "O1\nG99 G0 Z1.\nN1 G91 G81 X1. R0 Z-2. F100 K9999\nGOTO 1\n".as_bytes());
    let mut control = Control::new(memory, Settings::default());
    let outcome = control.run(Limits { blocks: 40_000 }, &mut NoLibrary, &mut ());
    assert!(matches!(outcome, Outcome::Limit));
    assert!(control.blocks() < 200, "{} blocks", control.blocks());
}

/// U is the fourth axis, V the fifth and W the sixth: #5021 and following are their positions.
#[test]
fn axes_of_other_letters_move_return_and_have_their_variables() {
    let program =
        "O1\nG90 G00 X5. U3. V2.\n#100=#5024\nG91 G28 U0\n#101=#5024\nG90 G01 W4. F100\n#102=#5026\nM30\n";
    let settings = Settings { axes: Axes::new("XYZUVW").unwrap(), ..Settings::default() };
    expect::run_on(program.as_bytes(), settings, 100)
        .must("end=normal; #100=3; #101=0; #102=4; mach.X=5; mach.V=2");
    expect::run_on(program.as_bytes(), Settings::default(), 100).must("alarm=PS0009");
}
