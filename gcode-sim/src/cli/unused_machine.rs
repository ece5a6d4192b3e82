//! Warns of an unused machine file: `--machine` is easily forgotten, and another machine makes other holes.
use super::conditions::ProgramArguments;
use super::output;
use gcode_inspect::holes::HoleExtraction;
use gcode_inspect::machine::Machine;
use gcode_lang::control::{Dialect, Increment};
use gcode_session::files::MACHINE_FILE;
use gcode_session::{Request, Run};

/// Prints a note if no machine file is used and the program's comments name one.
pub(super) fn warn_unused_machine(arguments: &ProgramArguments, request: &Request) {
    if arguments.conditions.machine.is_none() && head(&request.bytes).is_some() {
        let why = "the program's comments name a machine file, and none is used: give --machine MACHINE.toml";
        output::print_message(&format!("note: {why}\n"));
    }
}

/// Prints a note if a program makes holes by linear axes alone and no machine file states the head and the axes.
pub(super) fn warn_missing_machine(
    arguments: &ProgramArguments,
    bytes: &[u8],
    (run, holes): (&Run, &HoleExtraction),
) {
    let control = &run.control;
    let axes = &control.settings().axes;
    let uncommanded = control.unknown_axes().uncommanded;
    let is_rotary_used = (0..axes.len()).any(|axis| axes.is_rotary(axis) && uncommanded >> axis & 1 == 0);
    let is_stated = arguments.conditions.machine.is_some() || head(bytes).is_some();
    if is_stated || is_rotary_used || holes.holes.is_empty() {
        return;
    }
    output::print_message(&format!(
        "note: no machine file: the head and the rotary axes are unknown; gcode-sim new machine --kind 3-axis -o \
         {MACHINE_FILE} writes one for a machine without rotary axes\n"
    ));
}

/// Prints a note on the rotary axes that a program commands and that carry nothing, if no machine file is used.
pub(super) fn warn_unused_axes(arguments: &ProgramArguments, machine: &Machine, run: &Run) {
    let control = &run.control;
    let axes = &control.settings().axes;
    let uncommanded = control.unknown_axes().uncommanded | machine.used_axes();
    // G28 without axes commands all that a machine has: whether it has these is unknown.
    let is_named = |axis: &usize| names_axis(run, axes.letter(*axis));
    let is_commanded = |axis: &usize| axes.is_rotary(*axis) && uncommanded >> axis & 1 == 0;
    let unused = (0..axes.len()).filter(is_commanded).filter(is_named);
    let unused = axes.names(unused.fold(0, |bits, axis| bits | 1 << axis));
    if arguments.conditions.machine.is_none() && !unused.is_empty() {
        output::print_message(&format!(
            "note: {unused}: commanded, and moves neither part nor tool without a machine file: gcode-sim new machine --kind \
             4th-axis (or trunnion, head-table, head-head) writes one\n"
        ));
    }
}

/// Returns true if a text of the run has an axis letter before a value.
fn names_axis(run: &Run, letter: char) -> bool {
    let value = |byte: &u8| byte.is_ascii_digit() || b"#[.+- ".contains(byte);
    let is_word = |pair: &[u8]| pair[0].eq_ignore_ascii_case(&(letter as u8)) && value(&pair[1]);
    run.control.memory().sources().iter().any(|(_, source)| source.bytes.windows(2).any(is_word))
}

/// Prints a warning if the program's head names another control than `check` assumes.
pub(super) fn warn_unused_control(arguments: &ProgramArguments, request: &Request) {
    if arguments.conditions.machine.is_some() {
        return;
    }
    let Some(head) = head(&request.bytes) else { return };
    let settings = &request.settings;
    let mut differ = Vec::new();
    if let Some(dialect) = named(&head, &Dialect::ALL).filter(|dialect| *dialect != settings.dialect) {
        differ.push(format!("{}, {} is assumed", dialect.name(), settings.dialect.name()));
    }
    if let Some(increment) = named(&head, &Increment::ALL).filter(|named| *named != settings.increment) {
        let assumed = settings.increment;
        differ.push(format!(
            "{}, {} is assumed ({} mm and degrees, not {})",
            increment.name(),
            assumed.name(),
            assumed.size(),
            increment.size()
        ));
    }
    if !differ.is_empty() {
        let differ = differ.join("; ");
        output::print_message(&format!(
            "warning: the program's head gives {differ}: give --machine {MACHINE_FILE}\n"
        ));
    }
}

/// Returns the line that names a machine file, in capitals; an emitted program begins with `(CONTROL
/// FANUC-31I, INCREMENT IS-B, MACHINE FILE MACHINE.TOML)`.
fn head(program: &[u8]) -> Option<String> {
    const TOP: usize = 65_536;
    let top = String::from_utf8_lossy(&program[..program.len().min(TOP)]).to_ascii_uppercase();
    top.lines().find(|line| line.contains("MACHINE FILE")).map(str::to_owned)
}

/// Returns the value whose name is a word of the line.
fn named<T: Copy>(line: &str, all: &[(&str, T)]) -> Option<T> {
    let is_word = |name: &str| {
        let mut words = line.split(|c: char| !c.is_ascii_alphanumeric() && c != '-');
        words.any(|word| word.eq_ignore_ascii_case(name))
    };
    all.iter().find(|(name, _)| is_word(name)).map(|(_, one)| *one)
}
