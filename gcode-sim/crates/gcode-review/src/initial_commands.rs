//! Commands that the new revision no longer gives before moves of both: modal codes, axis positions and offsets
//! that it finds as the previous program left them.
use super::align::{Alignment, StepPair};
use super::change::{Effect, grouped};
use super::first_command::{CommandKind, FirstCommand};
use super::kinds;
use super::modal_conditions::ModalAspect;
use gcode_control::{Modal, modal_code};

/// Returns one effect for each block with such commands.
pub(super) fn compare(alignment: &Alignment<'_>) -> Vec<Effect> {
    let [old, new] = alignment.records;
    let (Some(was), Some(is)) = (&old.first_commands, &new.first_commands) else { return Vec::new() };
    let moves = moves_of_both(alignment);
    let missing = was.iter().filter(|command| is_power_on_default(command)).filter_map(|command| {
        let later = is.iter().find(|other| (other.what, &other.name) == (command.what, &command.name));
        let until = later.map_or(usize::MAX, |later| later.moves);
        let is_relying = |pair: &&SharedMove| {
            command.moves <= pair.before[0]
                && pair.before[1] < until
                && !is_already_reported(command, alignment, pair)
        };
        let relying: Vec<&SharedMove> = moves.iter().filter(is_relying).collect();
        let first = *relying.first()?;
        Some(((command.what, command.block_number, first.steps), (command, first, relying.len())))
    });
    let effect = |((what, block_number, steps), all): ((CommandKind, usize, _), Vec<_>)| {
        let message = message(what, &all);
        Effect::new(&kinds::START, message, [Some(&old.blocks[block_number]), alignment.blocks(steps)[1]])
    };
    grouped(missing).into_iter().map(effect).collect()
}

/// A move that both revisions make.
struct SharedMove {
    steps: [Option<usize>; 2],
    /// Both end at the same point and are of the same kind.
    is_same: bool,
    /// Numbers of moves before it.
    before: [usize; 2],
}

fn moves_of_both(alignment: &Alignment<'_>) -> Vec<SharedMove> {
    let mut before = [0, 0];
    let mut pairs = Vec::new();
    for link in alignment.links {
        let steps = link.sides();
        let moves = alignment.steps(steps).map(|step| step.is_some_and(|step| step.is_move()));
        if moves == [true, true] {
            pairs.push(SharedMove { steps, is_same: matches!(link, StepPair::Same(..)), before });
        }
        before = [0, 1].map(|side| before[side] + usize::from(moves[side]));
    }
    pairs
}

/// Returns true unless a modal code differs from that of power-on: without it the moves or the final modes differ.
fn is_power_on_default(command: &FirstCommand) -> bool {
    let group = command.name.parse().ok();
    let default = group.and_then(|group| Modal::default().code(group)).map(modal_code);
    command.what != CommandKind::Mode || default.as_ref() == Some(&command.text)
}

/// Returns true if another difference reports the command: the active code differs, or another effect of its block
/// is lost.
fn is_already_reported(command: &FirstCommand, alignment: &Alignment<'_>, pair: &SharedMove) -> bool {
    let [old, new] = alignment.records;
    match command.what {
        CommandKind::Mode => {
            let of_group = |aspect: &ModalAspect| format!("{:02}", aspect.row().0) == command.name;
            let [Some(i), Some(j)] = pair.steps else { return false };
            let aspect = ModalAspect::ALL.into_iter().find(of_group);
            aspect.is_some_and(|aspect| old.under(i).word(aspect).text != new.under(j).word(aspect).text)
        }
        CommandKind::Axis | CommandKind::Offset if !pair.is_same => true,
        CommandKind::Axis => alignment.links.iter().any(|link| {
            let is_of_block =
                link.sides()[0].is_some_and(|i| old.steps[i].block_number == command.block_number);
            is_of_block && !matches!(link, StepPair::Same(..))
        }),
        CommandKind::Offset => false,
    }
}

/// Formats the missing commands of one block, each with the first move and the number of moves that rely on it.
fn message(what: CommandKind, all: &[(&FirstCommand, &SharedMove, usize)]) -> String {
    let names: Vec<&str> = all.iter().map(|(command, ..)| command.text.as_str()).collect();
    let names = match names.as_slice() {
        [before @ .., last] if !before.is_empty() => format!("{} and {last} are", before.join(", ")),
        _ => format!("{} is", names.concat()),
    };
    let first = match (all[0].1.before[0], all[0].2) {
        (0, _) => "the first move".to_owned(),
        (_, 1) => "1 move".to_owned(),
        (_, n) => format!("{n} moves"),
    };
    let (verb, result) = match what {
        CommandKind::Mode => ("commanded", "the program now depends on the previous program's modes"),
        CommandKind::Axis => ("positioned", "the start position is undefined"),
        CommandKind::Offset => {
            ("written", "the program now depends on the value left by the previous program")
        }
    };
    format!("{names} no longer {verb} before {first}: {result}")
}
