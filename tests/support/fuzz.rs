//! Properties of any bytes: the bodies of the fuzz targets and of the test that replays their corpus.
use gcode_control::{Control, Limits};
use gcode_inspect::holes::HoleExtractor;
use gcode_inspect::machine::Machine;
use gcode_lang::control::Settings;
use gcode_lang::program::{Memory, NoLibrary};
use gcode_lang::source::SourceId;
use gcode_lang::syntax::{parse, print};

/// Reading never fails, and what was read prints as something that prints the same again.
pub fn reader(bytes: &[u8]) {
    for program in parse(SourceId(0), bytes) {
        let text = print(&program);
        let again: Vec<u8> = parse(SourceId(0), &text).iter().flat_map(print).collect();
        assert!(
            text == again,
            "{}\nprints as\n{}",
            String::from_utf8_lossy(&text),
            String::from_utf8_lossy(&again)
        );
    }
}

/// A run ends in an end, an alarm or a limit, and twice in the same one with the same state.
pub fn run(bytes: &[u8]) {
    assert_eq!(end_state(bytes), end_state(bytes));
}

fn end_state(bytes: &[u8]) -> String {
    let machine = Machine::default();
    let mut memory = Memory::default();
    memory.load("case", bytes);
    let mut control = Control::new(memory, Settings::default());
    let mut extractor = HoleExtractor::new(&machine);
    let outcome = control.run(Limits { blocks: 2_000 }, &mut NoLibrary, &mut extractor);
    let variables: Vec<_> = control.variables().collect();
    let extracted = extractor.finish();
    format!(
        "{outcome:?} {:?} {variables:?} {} {:?} {} holes {} findings",
        control.machine_position(),
        control.blocks(),
        control.seconds(),
        extracted.holes.len(),
        extracted.findings.len()
    )
}
