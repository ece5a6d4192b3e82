//! Steps of one block that come or go together: one cause is one entry.
use super::align::StepPair;
use super::steps::{Category, Step, StepKind, UnsimulatedKind};

/// T and S that come or go with an M code of their block.
pub(super) fn steps_with_m_code<'a>(
    links: &'a [StepPair],
    old: &'a [Step],
    new: &'a [Step],
) -> impl Iterator<Item = usize> + use<'a> {
    let step = |link: &StepPair| match *link {
        StepPair::Lost(i) => Some((false, &old[i])),
        StepPair::Added(j) => Some((true, &new[j])),
        StepPair::Same(..) | StepPair::Changed(..) => None,
    };
    let is_with = move |k: &usize| {
        let Some((is_new, called)) = step(&links[*k]) else { return false };
        let mut of_block = links[k + 1..]
            .iter()
            .map_while(step)
            .take_while(|(side, step)| *side == is_new && step.place == called.place);
        let is_code = |step: &Step| {
            matches!(step.kind.category(), Category::Auxiliary | Category::Silent(UnsimulatedKind::MCode))
        };
        matches!(called.kind, StepKind::Silent(UnsimulatedKind::Tool | UnsimulatedKind::Speed, _))
            && of_block.any(|(_, step)| is_code(step))
    };
    (0..links.len()).filter(is_with)
}

/// What a block says that moves nothing, where its moves are others or the spindle is: one cause is one entry.
pub(super) fn steps_with_moves<'a>(
    links: &'a [StepPair],
    old: &'a [Step],
    new: &'a [Step],
) -> impl Iterator<Item = usize> + use<'a> {
    let places = |link: &StepPair| {
        let (i, j) = link.sides();
        (i.map(|i| old[i].place), j.map(|j| new[j].place))
    };
    let step = |link: &StepPair| {
        let (i, j) = link.sides();
        i.map(|i| &old[i]).or(j.map(|j| &new[j]))
    };
    let is_said = move |k: &usize| {
        let (was, is) = places(&links[*k]);
        let is_of_block = |link: &&StepPair| {
            let (before, now) = places(link);
            was.is_some() && before == was || is.is_some() && now == is
        };
        let is_other = |link: &StepPair| {
            let is_such = |step: &Step| matches!(step.kind.category(), Category::Move | Category::Spindle);
            !matches!(link, StepPair::Same(..)) && step(link).is_some_and(is_such)
        };
        step(&links[*k]).is_some_and(|step| is_of_moves(&step.kind))
            && links[..*k].iter().rev().take_while(is_of_block).any(is_other)
    };
    (0..links.len()).filter(is_said)
}

/// Reference positions, G60 and M19 act by what they move.
fn is_of_moves(kind: &StepKind) -> bool {
    let StepKind::Silent(UnsimulatedKind::GCode | UnsimulatedKind::Path | UnsimulatedKind::MCode, text) =
        kind
    else {
        return false;
    };
    let code = text.split(' ').next();
    code.is_some_and(|code| code == "M19" || gcode_lang::program::g_codes::shows_in_moves(code))
}
