//! Places at which a long program is divided into pieces: no loop and no near jump leads across.
use std::ops::Range;

use gcode_lang::alarm::Alarm;
use gcode_lang::program::{Memory, OpIndex, OpKind, Program, ProgramId, Statement};

use super::control_flow::ControlFlowGraph;

/// Numbers of blocks that decide how a program is checked.
#[derive(Clone, Copy, Debug)]
pub(super) struct PieceSizes {
    /// Most blocks of a program that is checked as a whole.
    pub whole: usize,
    /// Blocks of a piece before its end is sought.
    pub piece: usize,
    /// Blocks among which the end of a piece is sought at a time.
    pub window: usize,
}

impl PieceSizes {
    pub(super) const USUAL: Self = Self { whole: 100_000, piece: 20_000, window: 500 };
}

/// Number of windows in which the end of a piece is sought.
const MAX_WINDOWS: usize = 20;

/// Returns the end of the piece that begins at a block: no loop and no jump near it leads across. `None` if there is none.
pub(super) fn piece_end(
    memory: &mut Memory,
    (id, whole): (ProgramId, &Program),
    first: OpIndex,
    sizes: PieceSizes,
) -> Option<OpIndex> {
    let count = whole.block_count();
    let wanted = first + sizes.piece;
    if count <= wanted + sizes.window {
        return Some(count);
    }
    for window in 0..MAX_WINDOWS {
        let from = wanted + window * sizes.window;
        let candidates = from..(from + sizes.window).min(count);
        if candidates.is_empty() {
            return Some(count);
        }
        let near = candidates.start.saturating_sub(sizes.window).max(first)
            ..(candidates.end + sizes.window).min(count);
        let crossed = crossed_places(memory, (id, whole), near.clone());
        let is_end = |place: &OpIndex| !crossed[place - near.start] && !whole.is_in_loop(*place);
        if let Some(end) = candidates.into_iter().find(is_end) {
            return Some(end);
        }
    }
    Some(count).filter(|count| *count <= first + 2 * sizes.whole)
}

/// Returns, for each of some blocks, whether a jump among them leads across its start or to it, or a loop begins there.
fn crossed_places(
    memory: &mut Memory,
    (id, whole): (ProgramId, &Program),
    blocks: Range<OpIndex>,
) -> Vec<bool> {
    memory.replace(id, whole.part(blocks.clone()));
    let part = memory.lower_program(id);
    let mut crossed: Vec<bool> = (part.ops().iter())
        .map(|op| match op.kind() {
            OpKind::Statement(Statement::While { .. } | Statement::Do { .. }) => true,
            // A loop whose other end is not in the part.
            OpKind::Alarm(alarm) => {
                matches!(
                    alarm.node,
                    Alarm::MissingEnd { .. } | Alarm::MissingDo { .. } | Alarm::LoopNumber { .. }
                )
            }
            _ => false,
        })
        .collect();
    for jump in ControlFlowGraph::new(part, &[]).jumps {
        let from = blocks.start + jump.block;
        let Some(to) = whole.find_number(jump.number, if jump.is_return { 0 } else { from + 1 }) else {
            continue;
        };
        // A piece may jump to one far behind it.
        if blocks.end <= to {
            continue;
        }
        // The first block of a piece may be no target either.
        let across = if from < to { from + 1..to + 1 } else { to..from + 1 };
        let (start, end) = (across.start.max(blocks.start), across.end.min(blocks.end));
        if start < end {
            crossed[start - blocks.start..end - blocks.start].fill(true);
        }
    }
    crossed
}

/// Returns the blocks behind a piece to which it jumps, and the blocks that do, each with the index of its target.
pub(super) fn far_jumps(
    part: &Program,
    (whole, blocks): (&Program, Range<OpIndex>),
) -> (Vec<OpIndex>, Vec<(OpIndex, usize)>) {
    let mut targets = Vec::new();
    let mut jumps = Vec::new();
    for jump in ControlFlowGraph::new(part, &[]).jumps.iter().filter(|jump| !jump.is_return) {
        let target = whole.find_number(jump.number, blocks.start + jump.block + 1);
        let Some(target) = target.filter(|target| blocks.end <= *target) else { continue };
        let place = targets.iter().position(|known| *known == target).unwrap_or_else(|| {
            targets.push(target);
            targets.len() - 1
        });
        jumps.push((jump.block, place));
    }
    (targets, jumps)
}
