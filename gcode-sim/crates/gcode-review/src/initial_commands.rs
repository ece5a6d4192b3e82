//! Commands that the new revision no longer gives before moves of both: modal codes, axis positions and offsets
//! that it finds as the previous program left them.
use super::align::Alignment;
use super::change::{Effect, grouped};
use super::first_command::{CommandKind, FirstCommand};
use super::kinds;
use super::links::StepPair;
use super::modal_conditions::ModalAspect;
use gcode_control::{Modal, modal_code};

/// Returns one effect for each block with such commands.
pub(super) fn compare(alignment: &Alignment<'_>) -> Vec<Effect> {
    let [old, new] = alignment.records;
    let (Some(was), Some(is)) = (&old.first_commands, &new.first_commands) else { return Vec::new() };
    let mut commands: Vec<MissingCommand<'_>> = was
        .iter()
        .filter(|command| is_power_on_default(command))
        .map(|command| MissingCommand::new(command, is, alignment))
        .collect();
    for_each_shared_move(alignment, |shared| {
        commands.iter_mut().for_each(|command| command.add(shared, alignment));
    });
    let missing = commands.iter().filter_map(|missing| {
        let (command, first) = (missing.command, missing.first?);
        Some(((command.what, command.block_number, first.steps), (command, first, missing.count)))
    });
    let effect = |((what, block_number, [_, new_step]), all): ((CommandKind, usize, [usize; 2]), Vec<_>)| {
        let blocks = [old.blocks.location(block_number), new.block(new_step)];
        Effect::new(&kinds::START, message(what, &all), blocks.map(Some))
    };
    grouped(missing).into_iter().map(effect).collect()
}

/// A move that both revisions make.
#[derive(Clone, Copy)]
struct SharedMove {
    steps: [usize; 2],
    /// Both end at the same point and are of the same kind.
    is_same: bool,
    /// Numbers of moves before it.
    before: [usize; 2],
}

fn for_each_shared_move(alignment: &Alignment<'_>, mut each: impl FnMut(SharedMove)) {
    let mut before = [0, 0];
    for link in alignment.links.iter() {
        let sides = link.sides();
        let is_move =
            |side: usize| sides[side].is_some_and(|step| alignment.records[side].steps.is_move(step));
        let moves = [0, 1].map(is_move);
        if let ([true, true], [Some(i), Some(j)]) = (moves, sides) {
            each(SharedMove { steps: [i, j], is_same: link.is_same(), before });
        }
        before = [0, 1].map(|side| before[side] + usize::from(moves[side]));
    }
}

/// A first command of the old revision, and the moves that rely on it in the new one.
struct MissingCommand<'a> {
    command: &'a FirstCommand,
    /// Number of moves of the new revision before the same command.
    until: usize,
    /// The modal condition that a mode is.
    aspect: Option<ModalAspect>,
    /// Another effect of the block of an axis command is lost.
    has_other_effect: bool,
    first: Option<SharedMove>,
    count: usize,
}

impl<'a> MissingCommand<'a> {
    fn new(command: &'a FirstCommand, others: &[FirstCommand], alignment: &Alignment<'_>) -> Self {
        let later = others.iter().find(|other| (other.what, &other.name) == (command.what, &command.name));
        let of_group = |aspect: &ModalAspect| format!("{:02}", aspect.row().0) == command.name;
        let is_mode = command.what == CommandKind::Mode;
        let steps = &alignment.records[0].steps;
        let is_of_block = |(_, link): (usize, StepPair)| {
            link.sides()[0].is_some_and(|i| steps.block_number(i) == command.block_number)
        };
        Self {
            command,
            until: later.map_or(usize::MAX, |later| later.moves),
            aspect: ModalAspect::ALL.into_iter().find(|aspect| is_mode && of_group(aspect)),
            has_other_effect: command.what == CommandKind::Axis
                && alignment.links.differences().any(is_of_block),
            first: None,
            count: 0,
        }
    }

    /// Adds a move if it relies on the command.
    fn add(&mut self, shared: SharedMove, alignment: &Alignment<'_>) {
        let is_between = self.command.moves <= shared.before[0] && shared.before[1] < self.until;
        if is_between && !self.is_already_reported(&shared, alignment) {
            self.first = self.first.or(Some(shared));
            self.count += 1;
        }
    }

    /// Returns true if another difference reports the command: the active code differs, or another effect of its block
    /// is lost.
    fn is_already_reported(&self, shared: &SharedMove, alignment: &Alignment<'_>) -> bool {
        let ([old, new], [i, j]) = (alignment.records, shared.steps);
        match self.command.what {
            CommandKind::Mode => self
                .aspect
                .is_some_and(|aspect| old.under(i).word(aspect).text != new.under(j).word(aspect).text),
            CommandKind::Axis => !shared.is_same || self.has_other_effect,
            CommandKind::Offset => !shared.is_same,
        }
    }
}

/// Returns true unless a modal code differs from that of power-on: without it the moves or the final modes differ.
fn is_power_on_default(command: &FirstCommand) -> bool {
    let group = command.name.parse().ok();
    let default = group.and_then(|group| Modal::default().code(group)).map(modal_code);
    command.what != CommandKind::Mode || default.as_ref() == Some(&command.text)
}

/// Formats the missing commands of one block, each with the first move and the number of moves that rely on it.
fn message(what: CommandKind, all: &[(&FirstCommand, SharedMove, usize)]) -> String {
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
