//! Stubs: called programs of M99 alone, in place of macros that only the machine has.
use super::Run;
use gcode_lang::program::{CallCode, OpKind, Program, ProgramId};
use gcode_lint::programs_called_by_others;

/// Returns the programs that the run has called and that do nothing, as `O9811`, in the order loaded.
pub(super) fn called_stubs(run: &Run) -> Vec<String> {
    let memory = run.control.memory();
    let main = memory.get(memory.main());
    let is_stub = |id: &ProgramId| *id != memory.main() && returns_at_once(memory.get(*id));
    let stubs: Vec<ProgramId> = memory.ids().filter(is_stub).collect();
    if stubs.is_empty() {
        return Vec::new();
    }
    // A program of a library is loaded by its call; one of the main program's file stands there in any case.
    let mut reloaded = memory.reload();
    let called = programs_called_by_others(&mut reloaded, run.control.settings());
    let called: Vec<String> = called.into_iter().map(|id| reloaded.get(id).label()).collect();
    let is_called =
        |program: &Program| program.span.source != main.span.source || called.contains(&program.label());
    let programs = stubs.into_iter().map(|id| memory.get(id)).filter(|program| is_called(program));
    programs.map(Program::label).collect()
}

/// Returns true if the first block with words is M99. A block that neither the run nor a check has reached is not lowered.
fn returns_at_once(program: &Program) -> bool {
    let lowered = (0..program.block_count()).map_while(|index| program.op(index));
    let mut blocks = lowered.skip_while(|op| matches!(op.kind(), OpKind::Empty));
    blocks.next().is_some_and(|op| match op.kind() {
        OpKind::Words(words) => {
            let is_return = words.call().is_some_and(|call| matches!(call.kind, CallCode::Return));
            is_return && words.list.is_empty() && op.skip().is_none()
        }
        _ => false,
    })
}
