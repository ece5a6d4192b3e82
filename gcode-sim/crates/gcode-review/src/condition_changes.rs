//! Moves that are made under something else than before. H2 where H1 was is a change, though both are 0 in a run without
//! a table.
use std::collections::BTreeSet;

use super::align::StepPair;
use super::change::Change;
use super::end_state::mode;
use super::groups::STAYS;
use super::hole_groups::named;
use super::modal_conditions::{ModalAspect, ModalSetting};
use super::record::Record;
use super::steps::{Step, StepKind, difference};
use gcode_lang::motion::MAX_AXES;

/// What is in force at the steps of both records, and where it differs.
pub(super) struct Conditions<'a> {
    old: &'a Record,
    new: &'a Record,
    groups: Vec<ConditionGroup<'a>>,
}

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

impl<'a> Conditions<'a> {
    pub(super) fn new(old: &'a Record, new: &'a Record, links: &[StepPair]) -> Self {
        Self { old, new, groups: groups(old, new, links) }
    }

    /// One entry for each thing that moves of both are made under differently, and the groups of G codes of which these
    /// entries say what the next program finds.
    pub(super) fn changes(&self) -> (Vec<Change>, BTreeSet<u32>) {
        let groups = &self.groups;
        let stay = groups.iter().filter(|group| self.stays(group)).map(|group| group.aspect.group());
        (groups.iter().map(|group| self.change(group)).collect(), stay.collect())
    }

    /// The codes of a group are in force at the ends as well.
    fn stays(&self, group: &ConditionGroup<'_>) -> bool {
        let code = |word: &ModalSetting| word.text.split(' ').next().map(str::to_owned);
        let (was, is) = (code(group.was), code(group.is));
        let left = |record| mode(record, group.aspect.group());
        was != is && (left(self.old), left(self.new)) == (was, is)
    }

    /// What explains that a cycle's strokes and lengths that are put in force are others: the words before and now.
    pub(super) fn strokes(&self) -> Strokes {
        let mut strokes = Strokes::default();
        for group in self.groups.iter().filter(|group| is_reported_once(group.aspect)) {
            strokes.old.insert((group.aspect, group.was.text.clone()));
            strokes.new.insert((group.aspect, group.is.text.clone()));
        }
        strokes
    }

    fn change(&self, group: &ConditionGroup<'_>) -> Change {
        let ConditionGroup { aspect, was, is, moves, first: (i, j) } = group;
        let counted = if moves.len() == 1 { "1 move".to_owned() } else { format!("{} moves", moves.len()) };
        let alike = || {
            let (before, now) = (length(&self.old.steps[*i]), length(&self.new.steps[*j]));
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
            ModalAspect::Cycle => format!(" ({})", self.holes(&was.text, moves)),
            ModalAspect::System | ModalAspect::Cutter | ModalAspect::Path => format!(" ({counted})"),
        };
        let what = match aspect {
            ModalAspect::Cycle => "cycle ",
            _ => "",
        };
        let stays = if self.stays(group) { STAYS } else { "" };
        let message = format!("{what}{} instead of {}{more}{stays}", is.text, was.text);
        let at =
            |record: &'a Record, word: &ModalSetting| word.place.and_then(|place| record.places.get(place));
        Change::new(aspect.code(), message).with_old(at(self.old, was)).with_new(at(self.new, is))
    }

    /// The holes of the old revision that some moves of a cycle make: how many, where they are all that the cycle makes.
    fn holes(&self, cycle: &str, moves: &[usize]) -> String {
        let is_of = |step: &usize| self.old.under(*step).word(ModalAspect::Cycle).text == cycle;
        let with = |is_it: &dyn Fn(&usize) -> bool| -> Vec<usize> {
            let feeds = self.old.feeds.iter().enumerate();
            feeds.filter(|(_, feeds)| feeds.iter().any(is_it)).map(|(hole, _)| hole).collect()
        };
        let all = with(&is_of);
        let these = with(&|step| moves.binary_search(step).is_ok());
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

fn is_reported_once(aspect: ModalAspect) -> bool {
    matches!(aspect, ModalAspect::Cycle | ModalAspect::Level | ModalAspect::Length)
}

/// What is told once for all strokes of a cycle, and for a length and its end.
#[derive(Default)]
pub(super) struct Strokes {
    old: BTreeSet<(ModalAspect, String)>,
    new: BTreeSet<(ModalAspect, String)>,
}

impl Strokes {
    pub(super) fn is_any(&self) -> bool {
        !(self.old.is_empty() && self.new.is_empty())
    }

    /// A step is different because its cycle is, or the length that it puts in force or ends.
    pub(super) fn explain(&self, link: &StepPair, old: &Record, new: &Record) -> bool {
        let is_in = |known: &BTreeSet<(ModalAspect, String)>, record: &Record, step: usize| {
            let text = |aspect: ModalAspect| record.under(step).word(aspect).text.clone();
            let is_known = |aspect: ModalAspect| known.contains(&(aspect, text(aspect)));
            if matches!(record.steps[step].kind, StepKind::Length(_)) {
                let is_any = known.iter().any(|(aspect, _)| *aspect == ModalAspect::Length);
                return is_any && (is_known(ModalAspect::Length) || text(ModalAspect::Length) == "G49");
            }
            is_known(ModalAspect::Cycle) || is_known(ModalAspect::Level) && record.steps[step].is_rapid()
        };
        let (i, j) = link.sides();
        self.is_any()
            && i.is_none_or(|i| is_in(&self.old, old, i))
            && j.is_none_or(|j| is_in(&self.new, new, j))
    }
}

/// The tool length offset that a step is made with, axis by axis.
fn length(step: &Step) -> [f64; MAX_AXES] {
    difference(&step.at, &step.to).0
}
