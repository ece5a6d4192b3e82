//! Moves that are made under something else than before. H2 where H1 was is a change, though both are 0 in a run without
//! a table.
use super::align::StepPair;
use super::change::Effect;
use super::edits::Edits;
use super::entries::CausedEffect;
use super::hole_groups::named;
use super::modal_conditions::{ModalAspect, ModalSetting};
use super::record::{BlockLocation, Record};
use super::steps::{Step, difference};
use gcode_lang::motion::MAX_AXES;

/// Moves of which one thing differs alike.
struct ConditionGroup<'a> {
    aspect: ModalAspect,
    was: &'a ModalSetting,
    is: &'a ModalSetting,
    /// By their numbers in the old run.
    moves: Vec<usize>,
    /// The first of them.
    first: (usize, usize),
}

/// One effect for each thing that moves of both runs are made under differently.
pub(super) fn condition_changes(
    (old, new): (&Record, &Record),
    links: &[StepPair],
    edits: &Edits,
) -> Vec<CausedEffect> {
    let groups = groups(old, new, links);
    groups.iter().map(|group| (group.causes(old, new, edits), group.effect(old, new))).collect()
}

impl ConditionGroup<'_> {
    /// The edit that has put it in force, else the one that the first move comes from.
    fn causes(&self, old: &Record, new: &Record, edits: &Edits) -> Vec<usize> {
        let (i, j) = self.first;
        let places = [old.places.get(old.steps[i].place), new.places.get(new.steps[j].place)];
        let set = edits.of(self.set_by(old, new));
        set.or_else(|| edits.cause(places, [Some(i), Some(j)])).into_iter().collect()
    }

    /// The blocks that have put it in force.
    fn set_by<'a>(&self, old: &'a Record, new: &'a Record) -> [Option<&'a BlockLocation>; 2] {
        [
            self.was.place.and_then(|place| old.places.get(place)),
            self.is.place.and_then(|place| new.places.get(place)),
        ]
    }

    fn effect(&self, old: &Record, new: &Record) -> Effect {
        let Self { aspect, was, is, moves, first: (i, j) } = self;
        let counted = if moves.len() == 1 { "1 move".to_owned() } else { format!("{} moves", moves.len()) };
        let alike = || {
            let (before, now) = (length(&old.steps[*i]), length(&new.steps[*j]));
            let far = |values: &[f64]| values.iter().any(|value| value.abs() > 1e-9);
            let apart: Vec<f64> = before.iter().zip(now).map(|(a, b)| a - b).collect();
            match (far(&before), far(&apart)) {
                (_, true) => "",
                (false, false) => ", both 0 here",
                (true, false) => ", equal here",
            }
        };
        let more = match aspect {
            ModalAspect::Length => format!("{} ({counted})", alike()),
            ModalAspect::Level if is.text == "G99" => {
                format!(": the rapids between holes run at the R level ({counted})")
            }
            ModalAspect::Level => {
                format!(": the rapids between holes run at the initial level ({counted})")
            }
            ModalAspect::Cycle => format!(" ({})", self.holes(old)),
            ModalAspect::System | ModalAspect::Cutter | ModalAspect::Path => format!(" ({counted})"),
        };
        let what = match aspect {
            ModalAspect::Cycle => "cycle ",
            _ => "",
        };
        let message = format!("{what}{} instead of {}{more}", is.text, was.text);
        let [was, is] = self.set_by(old, new);
        Effect::new(aspect.code(), message).with_old(was).with_new(is)
    }

    /// The holes of the old revision that some moves of a cycle make: how many, where they are all that the cycle makes.
    fn holes(&self, old: &Record) -> String {
        let is_of = |step: &usize| old.under(*step).word(ModalAspect::Cycle).text == self.was.text;
        let with = |is_it: &dyn Fn(&usize) -> bool| -> Vec<usize> {
            let feeds = old.feeds.iter().enumerate();
            feeds.filter(|(_, feeds)| feeds.iter().any(is_it)).map(|(hole, _)| hole).collect()
        };
        let all = with(&is_of);
        let these = with(&|step| self.moves.binary_search(step).is_ok());
        match all.len() {
            _ if !these.is_empty() && these != all => named(&these),
            1 => "1 hole".to_owned(),
            n => format!("{n} holes"),
        }
    }
}

fn groups<'a>(old: &'a Record, new: &'a Record, links: &[StepPair]) -> Vec<ConditionGroup<'a>> {
    let mut groups: Vec<ConditionGroup<'a>> = Vec::new();
    for link in links {
        let (Some(i), Some(j)) = link.sides() else { continue };
        if !old.steps[i].is_move() {
            continue;
        }
        for aspect in ModalAspect::ALL {
            let (was, is) = (old.under(i).word(aspect), new.under(j).word(aspect));
            // Where one of them isn't in a cycle, its holes are told.
            if was.text == is.text || was.text.is_empty() || is.text.is_empty() {
                continue;
            }
            let alike = |g: &&mut ConditionGroup<'_>| {
                g.aspect == aspect && g.was.text == was.text && g.is.text == is.text
            };
            match groups.iter_mut().find(alike) {
                Some(group) => group.moves.push(i),
                None => groups.push(ConditionGroup { aspect, was, is, moves: vec![i], first: (i, j) }),
            }
        }
    }
    groups
}

/// The tool length offset that a step is made with, axis by axis.
fn length(step: &Step) -> [f64; MAX_AXES] {
    difference(&step.at, &step.to).0
}
