//! Steps of one block that come or go together: one cause is one entry.
use super::align::Link;
use super::steps::{Category, Kind, Quiet, Step};

/// T and S that come or go with an M code of their block.
pub(super) fn with_code<'a>(
    links: &'a [Link],
    old: &'a [Step],
    new: &'a [Step],
) -> impl Iterator<Item = usize> + use<'a> {
    let step = |link: &Link| match *link {
        Link::Lost(i) => Some((false, &old[i])),
        Link::Added(j) => Some((true, &new[j])),
        Link::Same(..) | Link::Changed(..) => None,
    };
    let is_with = move |k: &usize| {
        let Some((is_new, called)) = step(&links[*k]) else { return false };
        let mut of_block = links[k + 1..]
            .iter()
            .map_while(step)
            .take_while(|(side, step)| *side == is_new && step.place == called.place);
        let is_code = |step: &Step| {
            matches!(step.kind.category(), Category::Auxiliary | Category::Silent(Quiet::MCode))
        };
        matches!(called.kind, Kind::Silent(Quiet::Tool | Quiet::Speed, _))
            && of_block.any(|(_, step)| is_code(step))
    };
    (0..links.len()).filter(is_with)
}

/// What a block says that moves nothing, where its moves are others or the spindle is: one cause is one entry.
pub(super) fn with_moves<'a>(
    links: &'a [Link],
    old: &'a [Step],
    new: &'a [Step],
) -> impl Iterator<Item = usize> + use<'a> {
    let places = |link: &Link| {
        let (i, j) = link.sides();
        (i.map(|i| old[i].place), j.map(|j| new[j].place))
    };
    let step = |link: &Link| {
        let (i, j) = link.sides();
        i.map(|i| &old[i]).or(j.map(|j| &new[j]))
    };
    let is_said = move |k: &usize| {
        let (was, is) = places(&links[*k]);
        let is_of_block = |link: &&Link| {
            let (before, now) = places(link);
            was.is_some() && before == was || is.is_some() && now == is
        };
        let is_other = |link: &Link| {
            let is_such = |step: &Step| matches!(step.kind.category(), Category::Move | Category::Spindle);
            !matches!(link, Link::Same(..)) && step(link).is_some_and(is_such)
        };
        step(&links[*k]).is_some_and(|step| is_of_moves(&step.kind))
            && links[..*k].iter().rev().take_while(is_of_block).any(is_other)
    };
    (0..links.len()).filter(is_said)
}

/// Reference positions, G60 and M19 act by what they move.
fn is_of_moves(kind: &Kind) -> bool {
    let Kind::Silent(Quiet::GCode | Quiet::Path | Quiet::MCode, text) = kind else { return false };
    let code = text.split(' ').next();
    code.is_some_and(|code| ["G27", "G28", "G29", "G30", "G60", "M19"].contains(&code))
}
