//! Spindle, coolant and tool length that are commanded where they are in force already: one command more or fewer
//! does nothing.
use super::align::StepPair;
use super::steps::{Category, Step, StepKind};
use gcode_lang::motion::{Position, SpindleDirection};

/// Lost and new ones, where both revisions go on with what they say.
pub(super) fn redundant_commands<'a>(
    links: &'a [StepPair],
    old: &'a [Step],
    new: &'a [Step],
) -> impl Iterator<Item = usize> + use<'a> {
    // How many steps of each are behind every link.
    let counts = links.iter().scan((0, 0), |(i, j), link| {
        let sides = link.sides();
        (*i, *j) = (sides.0.map_or(*i, |step| step + 1), sides.1.map_or(*j, |step| step + 1));
        Some((*i, *j))
    });
    let is_repeated = move |(k, (i, j)): &(usize, (usize, usize))| {
        let step = match links[*k] {
            StepPair::Lost(i) => &old[i],
            StepPair::Added(j) => &new[j],
            StepPair::Same(..) | StepPair::Changed(..) => return false,
        };
        let said = ModalCommand::of(&step.kind);
        said.is_some_and(|said| [(old, *i), (new, *j)].iter().all(|(steps, at)| said.is_in_force(steps, *at)))
    };
    counts.enumerate().filter(is_repeated).map(|(k, _)| k)
}

/// Whether the spindle turns the same way already where a step says a speed: its block may say S alone.
pub(super) fn is_speed_alone(steps: &[Step], at: usize) -> bool {
    let StepKind::Spindle(turning, _) = steps[at].kind else { return false };
    let before = steps[..at].iter().rev().take_while(|step| !interrupts(step));
    let before = before.map(|step| &step.kind).find(|kind| kind.category() == Category::Spindle);
    turning != SpindleDirection::Off
        && matches!(before, Some(StepKind::Spindle(other, _)) if *other == turning)
}

/// Whether a step says what is in force before it.
pub(super) fn is_redundant(steps: &[Step], at: usize) -> bool {
    ModalCommand::of(&steps[at].kind).is_some_and(|said| said.is_last(&steps[..at]))
}

/// What a step puts in force.
#[derive(Clone, Copy, PartialEq)]
enum ModalCommand {
    Spindle(SpindleDirection, f64),
    Coolant(bool, Option<u32>),
    Length(Position),
}

impl ModalCommand {
    fn of(kind: &StepKind) -> Option<Self> {
        match *kind {
            StepKind::Spindle(turning, speed) => Some(Self::Spindle(turning, speed)),
            StepKind::Coolant(on, code) => Some(Self::Coolant(on, code)),
            StepKind::Length(offset) => Some(Self::Length(offset)),
            _ => None,
        }
    }

    /// Whether it is so after the first steps, and what is commanded before the machine does anything else.
    fn is_in_force(self, steps: &[Step], at: usize) -> bool {
        let at_once = steps[at..].iter().take_while(|step| !interrupts(step) && !step.is_move());
        let at = at + at_once.count();
        self.is_last(&steps[..at])
    }

    fn is_last(self, steps: &[Step]) -> bool {
        let is_length = matches!(self, Self::Length(_));
        let before = steps.iter().rev().take_while(|step| is_length || !interrupts(step));
        let is_alike = |other: &Self| std::mem::discriminant(other) == std::mem::discriminant(&self);
        before.filter_map(|step| Self::of(&step.kind)).find(is_alike) == Some(self)
    }
}

/// A tool change, a stop, or an M code of the machine builder's: some stop spindle and coolant.
fn interrupts(step: &Step) -> bool {
    matches!(step.kind, StepKind::Tool(_))
        || matches!(step.kind.category(), Category::Stop | Category::Auxiliary)
}
