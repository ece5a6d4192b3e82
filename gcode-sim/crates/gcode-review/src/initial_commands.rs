//! What a program commands first, and what of it moves rely on without: a mode, a place, an offset that it finds as it was left.
use super::align::StepPair;
use super::change::Effect;
use super::first_command::{CommandKind, FirstCommand};
use super::modal_conditions::ModalAspect;
use super::record::Record;
use gcode_control::{Modal, modal_code};

/// What the old revision commands before moves that both make, and the new one doesn't.
pub(super) fn compare(old: &Record, new: &Record, links: &[StepPair]) -> Vec<Effect> {
    let (Some(was), Some(is)) = (&old.begun, &new.begun) else { return Vec::new() };
    let moves = moves_of_both(old, new, links);
    let mut groups: Vec<MissingCommands<'_>> = Vec::new();
    for begun in was.iter().filter(|begun| is_power_on_default(begun)) {
        let later = is.iter().find(|other| (other.what, &other.name) == (begun.what, &begun.name));
        let until = later.map_or(usize::MAX, |later| later.moves);
        let relies = |pair: &&SharedMove| {
            begun.moves <= pair.before.0
                && pair.before.1 < until
                && !is_already_reported(begun, old, new, pair, links)
        };
        let relying: Vec<&SharedMove> = moves.iter().filter(relies).collect();
        let Some(first) = relying.first() else { continue };
        let of_block = |group: &&mut MissingCommands<'_>| {
            let known = group.all[0];
            (known.what, known.place) == (begun.what, begun.place) && group.first.steps == first.steps
        };
        match groups.iter_mut().find(of_block) {
            Some(group) => group.all.push(begun),
            None => groups.push(MissingCommands { all: vec![begun], first: **first, moves: relying.len() }),
        }
    }
    groups.iter().map(|group| group.change(old, new)).collect()
}

/// A move that both revisions make.
#[derive(Clone, Copy)]
struct SharedMove {
    /// Its steps.
    steps: (usize, usize),
    /// It goes to the same place in the same way.
    is_same: bool,
    /// How many moves come before it.
    before: (usize, usize),
}

fn moves_of_both(old: &Record, new: &Record, links: &[StepPair]) -> Vec<SharedMove> {
    let mut before = (0, 0);
    let mut pairs = Vec::new();
    for link in links {
        let (i, j) = link.sides();
        let is_move =
            |record: &Record, step: Option<usize>| step.is_some_and(|step| record.steps[step].is_move());
        let moves = (is_move(old, i), is_move(new, j));
        if let (Some(i), Some(j), (true, true)) = (i, j, moves) {
            pairs.push(SharedMove { steps: (i, j), is_same: matches!(link, StepPair::Same(..)), before });
        }
        before = (before.0 + usize::from(moves.0), before.1 + usize::from(moves.1));
    }
    pairs
}

/// A mode that a run finds in force by itself: without any other code the moves themselves are others.
fn is_power_on_default(begun: &FirstCommand) -> bool {
    let group = begun.name.parse().ok();
    let found = group.and_then(|group| Modal::default().code(group)).map(modal_code);
    begun.what != CommandKind::Mode || found.as_ref() == Some(&begun.text)
}

/// Another entry says so: the code in force is another one, or what else the block did is gone.
fn is_already_reported(
    begun: &FirstCommand,
    old: &Record,
    new: &Record,
    pair: &SharedMove,
    links: &[StepPair],
) -> bool {
    let (i, j) = pair.steps;
    match begun.what {
        CommandKind::Mode => {
            let of_group = |aspect: &ModalAspect| format!("{:02}", aspect.group()) == begun.name;
            let aspect = ModalAspect::ALL.into_iter().find(of_group);
            aspect.is_some_and(|aspect| old.under(i).word(aspect).text != new.under(j).word(aspect).text)
        }
        // Where it ends elsewhere, that is told.
        CommandKind::Axis | CommandKind::Offset if !pair.is_same => true,
        CommandKind::Axis => {
            let is_of_block =
                |link: &&StepPair| link.sides().0.is_some_and(|i| old.steps[i].place == begun.place);
            links.iter().filter(is_of_block).any(|link| !matches!(link, StepPair::Same(..)))
        }
        CommandKind::Offset => false,
    }
}

/// What is gone with one block.
struct MissingCommands<'a> {
    all: Vec<&'a FirstCommand>,
    first: SharedMove,
    moves: usize,
}

impl MissingCommands<'_> {
    fn change(&self, old: &Record, new: &Record) -> Effect {
        let names: Vec<&str> = self.all.iter().map(|begun| begun.text.as_str()).collect();
        let one = names.len() == 1;
        let names = match names.as_slice() {
            [before @ .., last] if !before.is_empty() => format!("{} and {last}", before.join(", ")),
            _ => names.concat(),
        };
        let is = if one { "is" } else { "are" };
        let first = match (self.first.before.0, self.moves) {
            (0, _) => "the first move".to_owned(),
            (_, 1) => "1 move".to_owned(),
            (_, n) => format!("{n} moves"),
        };
        let message = match self.all[0].what {
            CommandKind::Mode => format!(
                "{names} {is} no longer commanded before {first}: the program now depends on the previous \
                 program's modes"
            ),
            CommandKind::Axis => {
                format!("{names} {is} no longer positioned before {first}: the start position is undefined")
            }
            CommandKind::Offset => {
                format!(
                    "{names} {is} no longer written before {first}: the program now depends on the value \
                     left by the previous program"
                )
            }
        };
        Effect::new("start", message)
            .with_old(old.places.get(self.all[0].place))
            .with_new(new.places.get(new.steps[self.first.steps.1].place))
    }
}
