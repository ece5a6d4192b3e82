//! What a program's text says of a verdict: work offsets that the machine file doesn't give, numbers without a point.
use super::Run;
use crate::check::{check_loaded, rules};
use crate::diag::Diagnostic;
use crate::machine::Machine;
use crate::motion::Place;
use crate::program::{Input, Memory, NoLibrary, OpKind};

/// `explain`: whether there is something that a slip may explain.
pub(super) fn slips(run: &Run, machine: &Machine, explain: bool) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    if names_another_offset(run.control.memory()) {
        found.extend(other_offsets(&mut loaded(run), machine));
    }
    if explain {
        let checked = check_loaded(loaded(run), run.control.settings(), &mut NoLibrary);
        let points = checked.findings.into_iter().filter(|finding| finding.code == rules::MISSING_POINT);
        found.extend(points.map(|mut finding| {
            finding.message = finding.message.replacen(" is ", " without a point is ", 1);
            finding
        }));
    }
    found
}

/// The programs of the run, loaded anew in the same order: places in them stay what they are.
fn loaded(run: &Run) -> Memory {
    let mut memory = Memory::default();
    for (_, source) in run.control.memory().sources().iter() {
        memory.load(source.name.clone(), source.bytes.clone());
    }
    memory
}

/// Whether the texts have G55 to G59, G54.1 or G154 anywhere: few do, and only those are read anew.
fn names_another_offset(memory: &Memory) -> bool {
    let other = |bytes: &[u8]| {
        let windows = bytes.windows(4);
        windows.into_iter().any(|window| {
            matches!(window, [b'G' | b'g', b'5', b'5'..=b'9', _] | [b'G' | b'g', b'1', b'5', b'4'])
                || matches!(window, [b'G' | b'g', b'5', b'4', b'.' | b'P' | b'p' | b' '])
        })
    };
    memory.sources().iter().any(|(_, source)| other(&source.bytes))
}

/// Blocks that go over to a work offset other than G54 of which the machine file says nothing: it counts as 0, as G54
/// does, so that the holes come out alike whichever is in effect.
fn other_offsets(memory: &mut Memory, machine: &Machine) -> Vec<Diagnostic> {
    let ids: Vec<_> = memory.ids().collect();
    let mut found = Vec::new();
    for id in ids {
        for op in memory.lowered(id).ops() {
            let OpKind::Words(words) = &op.kind else { continue };
            for word in &words.list {
                let Input::G(code @ (541 | 550 | 560 | 570 | 580 | 590 | 1540), _) = word.value else {
                    continue;
                };
                if machine.offsets.iter().any(|offset| offset.code * 10 == code) {
                    continue;
                }
                let place = Place { block: op.span, calls: None };
                found.push(finding(code, machine).at(place));
            }
        }
    }
    found
}

fn finding(code: u32, machine: &Machine) -> Diagnostic {
    let name = match code % 10 {
        0 => format!("G{}", code / 10),
        tenth => format!("G{}.{tenth}", code / 10),
    };
    let known: Vec<_> = machine.offsets.iter().map(|offset| format!("G{}", offset.code)).collect();
    let given = match known.as_slice() {
        [] => "no work offset; all count as zero here, and the holes come out as with G54".to_owned(),
        known => format!("{} only; this one counts as zero here", known.join(", ")),
    };
    let message = format!(
        "the program takes work offset {name}, of which nothing is known: the machine file gives {given}"
    );
    Diagnostic::warning("work-offset", message)
        .help("is it the offset that was set up? What it holds on the machine is not checked")
}
