//! Stubs: called programs of M99 alone, in place of macros that only the machine has.
use super::Run;
use gcode_lang::program::{CallCode, OpKind, Program, ProgramId};

/// Returns the programs that the run has called and that do nothing, as `O9811`, in the order loaded.
pub(super) fn called_stubs(run: &Run) -> Vec<String> {
    let memory = run.control.memory();
    let main = memory.main();
    let is_stub = |id: &ProgramId| *id != main && returns_at_once(memory.get(*id));
    memory.ids().filter(is_stub).map(|id| memory.get(id).label()).collect()
}

/// Returns true if the program has been executed and its first block with words is M99. A block is lowered when the run
/// reaches it.
fn returns_at_once(program: &Program) -> bool {
    let executed = (0..program.block_count()).map_while(|index| program.op(index));
    let mut blocks = executed.skip_while(|op| matches!(op.kind(), OpKind::Empty));
    blocks.next().is_some_and(|op| match op.kind() {
        OpKind::Words(words) => {
            let is_return = words.call().is_some_and(|call| matches!(call.kind, CallCode::Return));
            is_return && words.list.is_empty() && op.skip().is_none()
        }
        _ => false,
    })
}
