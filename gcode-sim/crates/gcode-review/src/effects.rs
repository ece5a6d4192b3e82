//! Equal differences, counted as one effect of an edit.
use std::collections::BTreeMap;

use super::align::Alignment;
use super::change::Effect;
use super::descriptions::{coordinates, describe, point, short};
use super::differences::{Difference, StepDifference};
use super::edits::{Causes, Edits};
use super::entries::CausedEffect;
use super::hole_groups::named;
use super::kinds;
use super::modal_conditions::ModalAspect;
use super::redundant_commands::is_speed_alone;
use super::steps::{StepKind, difference, near, with_article};
use gcode_lang::diag::FindingKind;
use gcode_lang::motion::{MAX_AXES, Position};

/// Differences with one sentence, or those that one edit makes of moves.
struct Group {
    kind: &'static FindingKind,
    /// The difference without its count.
    text: String,
    /// Names of the steps that differ, and the number of each.
    counts: Vec<(&'static str, usize)>,
    /// Others have other numbers than the first.
    varies: bool,
    numbers: Numbers,
    /// Numbers of its edits, and whether its blocks are part of them.
    causes: Vec<usize>,
    is_direct: bool,
    /// Numbers of the first blocks in the records.
    places: [Option<usize>; 2],
}

/// Numbers that a group collects.
#[derive(PartialEq)]
enum Numbers {
    None,
    /// Largest deviation of each axis, and whether all machine positions are unchanged.
    Shift {
        most: Position,
        is_compensated: bool,
    },
    /// Smallest and largest ratio of feeds.
    Factor(f64, f64),
    /// Spindle speeds before and now.
    Speeds(f64, f64),
    /// Moves under another condition by their numbers in the old run, and the first in the new run.
    Moves(ModalAspect, Vec<usize>, usize),
}

/// More shifts of one edit than this are one effect, by up to the largest.
const MOST_SHIFTS: usize = 4;

/// All groups, in the order of their first differences.
pub(super) struct Effects<'a> {
    all: Vec<Group>,
    by_text: BTreeMap<(&'static str, String), usize>,
    by_places: BTreeMap<(&'static str, [Option<usize>; 2]), usize>,
    alignment: Alignment<'a>,
    edits: &'a Edits,
}

impl<'a> Effects<'a> {
    /// Returns the effects of differences with their edits. Differences of steps are grouped by their sentences;
    /// feeds, speeds and unpaired moves by their blocks as well.
    pub(super) fn of(
        differences: Vec<Difference>,
        alignment: Alignment<'a>,
        edits: &'a Edits,
    ) -> Vec<CausedEffect> {
        let causes = Causes::new(edits, alignment.records);
        let (by_text, by_places) = Default::default();
        let mut groups = Self { all: Vec::new(), by_text, by_places, alignment, edits };
        let mut effects: Vec<CausedEffect> = Vec::new();
        let mut of_steps = None;
        for difference in differences {
            match difference {
                Difference::Run(effect) => effects.push((causes.of(&effect), effect)),
                Difference::Holes(holes) => effects.push((causes.of_holes(&holes), holes.effect)),
                Difference::Step(kind, steps) => {
                    of_steps = of_steps.or(Some(effects.len()));
                    groups.add(&kind, steps);
                }
            }
        }
        groups.join_shifts();
        let effect = |group: &Group| {
            let effect = Effect::new(group.kind, groups.message(group), groups.blocks(group.places));
            (group.causes.clone(), effect)
        };
        let place = of_steps.unwrap_or(effects.len());
        effects.splice(place..place, groups.all.iter().map(effect));
        effects
    }

    fn add(&mut self, kind: &StepDifference, steps: [Option<usize>; 2]) {
        let group = self.group(kind, steps);
        let is_speed = matches!(group.numbers, Numbers::Speeds(..));
        let is_of_block = ["feed", "move-added", "move-lost"].contains(&group.kind.code) || is_speed;
        let (text, places) = ((group.kind.code, group.text.clone()), (group.kind.code, group.places));
        let of_block = || {
            let known = *self.by_places.get(&places).filter(|_| is_of_block)?;
            (!is_speed || self.all[known].numbers == group.numbers).then_some(known)
        };
        let known = self.by_text.get(&text).copied().or_else(of_block);
        let number = known.unwrap_or(self.all.len());
        self.by_text.entry(text).or_insert(number);
        self.by_places.entry(places).or_insert(number);
        match known {
            Some(known) => self.all[known].join(group),
            None => self.all.push(group),
        }
    }

    /// Returns the group of one difference.
    fn group(&self, kind: &StepDifference, steps: [Option<usize>; 2]) -> Group {
        let Alignment { records, tolerance, .. } = self.alignment;
        let axes = self.alignment.axes();
        let [was, is] = self.alignment.steps(steps);
        let Some(step) = was.or(is) else { unreachable!("a difference has a step") };
        let mut numbers = Numbers::None;
        let mut what = step.kind.name();
        let mut places = [was, is].map(|step| step.map(|step| step.place));
        let change = || step.kind.change().unwrap_or(&kinds::MOVE_SHIFTED);
        let (kind, text) = match (kind, was.zip(is)) {
            (StepDifference::Condition(aspect), _) => {
                let words = [0, 1].map(|side| Some(records[side].under(steps[side]?).word(*aspect)));
                let [before, now] = words.map(|word| word.map_or("", |word| &word.text));
                let name = if *aspect == ModalAspect::Cycle { "cycle " } else { "" };
                places = words.map(|word| word?.place);
                numbers = Numbers::Moves(*aspect, steps[0].into_iter().collect(), steps[1].unwrap_or(0));
                (aspect.row().1, format!("{name}{now} instead of {before}"))
            }
            (StepDifference::EndPoint(shift), both) => {
                what = is.unwrap_or(step).kind.name();
                let is_compensated = both.is_some_and(|(was, is)| near(&was.at, &is.at, tolerance));
                let most = Position(shift.0.map(f64::abs));
                numbers = Numbers::Shift { most, is_compensated };
                (&kinds::MOVE_SHIFTED, coordinates(shift, axes, tolerance, true))
            }
            (StepDifference::MoveKind, Some((was, is))) => {
                what = "move";
                (&kinds::MOVE_KIND, format!("{} instead of {}", is.kind.one(), was.kind.one()))
            }
            (StepDifference::ArcShape(text), _) => {
                what = is.unwrap_or(step).kind.name();
                (&kinds::MOVE_ARC, text.clone())
            }
            (StepDifference::Feed { was, is }, _) => {
                what = "move";
                numbers = Numbers::Factor(is / was, is / was);
                (&kinds::FEED, format!("feed F{} instead of F{}", short(*is), short(*was)))
            }
            (StepDifference::Shifted(word), _) => {
                (change(), format!("{} is executed {word} than before", self.called(steps)))
            }
            (_, Some((was, is))) => {
                if let StepDifference::Speed { was, is } = kind {
                    numbers = Numbers::Speeds(*was, *is);
                }
                let [is, before] = [is, was].map(|step| describe(&step.kind, axes));
                (change(), format!("{is} instead of {before}"))
            }
            (_, None) => {
                let (whether, of_moves) = match was {
                    Some(_) => ("is removed", &kinds::MOVE_LOST),
                    None => ("is added", &kinds::MOVE_ADDED),
                };
                if step.is_move() {
                    what = "move";
                    (of_moves, format!("{} to {} {whether}", step.kind.one(), point(step, axes)))
                } else {
                    (change(), format!("{} {whether}", self.called(steps)))
                }
            }
        };
        let is_tool = kind == &kinds::TOOL && was.is_some() && is.is_some();
        if matches!(numbers, Numbers::Factor(..) | Numbers::Speeds(..)) || is_tool {
            places = [was, is].map(|step| step.map(|step| step.editable_at()));
        }
        let mut causes = self.edits.cause(self.blocks(places), steps);
        let mut is_direct = self.edits.is_single() || self.edits.of(self.blocks(places)).is_some();
        if let Numbers::Moves(..) = numbers {
            let set = self.edits.of(self.blocks(places));
            causes = set.or_else(|| self.edits.cause(self.alignment.blocks(steps), steps));
            is_direct = false;
        }
        let causes = causes.into_iter().collect();
        Group { kind, text, counts: vec![(what, 1)], varies: false, numbers, causes, is_direct, places }
    }

    fn blocks(&self, places: [Option<usize>; 2]) -> [Option<&'a super::record::BlockLocation>; 2] {
        [0, 1].map(|side| self.alignment.records[side].places.get(places[side]?))
    }

    /// Describes a command of either run; if the spindle turns already, its speed alone.
    fn called(&self, steps: [Option<usize>; 2]) -> String {
        let side = usize::from(steps[0].is_none());
        let (steps, step) = (&self.alignment.records[side].steps, steps[side].unwrap_or(0));
        match &steps[step].kind {
            StepKind::Spindle(_, speed) if is_speed_alone(steps, step) => format!("S{speed}"),
            kind => describe(kind, self.alignment.axes()),
        }
    }

    /// Joins many shifts of one edit, or of the same blocks if no edit contains them.
    fn join_shifts(&mut self) {
        let mut alike: BTreeMap<_, Vec<usize>> = BTreeMap::new();
        let shifts = self.all.iter().enumerate().filter(|(_, group)| group.kind == &kinds::MOVE_SHIFTED);
        for (number, group) in shifts {
            let places = if group.is_direct { [None, None] } else { group.places };
            let edit = group.causes.first().filter(|_| group.is_direct).copied();
            alike.entry((edit, places)).or_default().push(number);
        }
        let many = alike.into_values().filter(|numbers| MOST_SHIFTS < numbers.len());
        let into: BTreeMap<usize, usize> = many
            .flat_map(|numbers| numbers[1..].iter().map(|number| (*number, numbers[0])).collect::<Vec<_>>())
            .collect();
        let mut kept: BTreeMap<usize, Group> = BTreeMap::new();
        for (number, group) in std::mem::take(&mut self.all).into_iter().enumerate() {
            match into.get(&number).and_then(|first| kept.get_mut(first)) {
                Some(first) => first.join(group),
                None => _ = kept.insert(number, group),
            }
        }
        self.all = kept.into_values().collect();
    }

    fn message(&self, group: &Group) -> String {
        let text = &group.text;
        let counts = || -> String {
            let counts: Vec<String> = group.counts.iter().map(|(what, n)| format!("{n} {what}s")).collect();
            counts.join(", ")
        };
        match (&group.numbers, group.varies, &group.counts[..]) {
            (Numbers::Moves(aspect, moves, first), ..) => {
                format!("{text}{}", self.under_condition(*aspect, moves, *first))
            }
            (Numbers::Shift { most, is_compensated }, varies, counts) => {
                let Alignment { tolerance, .. } = self.alignment;
                let most = || format!("up to {}", coordinates(most, self.alignment.axes(), tolerance, false));
                let by = if varies { most() } else { text.clone() };
                let as_programmed = if *is_compensated {
                    " as programmed; the machine position is unchanged because of another length offset"
                } else {
                    ""
                };
                shifted(counts, &format!("{by}{as_programmed}"))
            }
            (Numbers::Factor(least, most), true, _) => {
                let by = match (most - least).abs() <= 1e-6 * most.abs() {
                    true => "the same factor".to_owned(),
                    false => format!("factors of {least:.4} to {most:.4}"),
                };
                format!("{text} ({}, all by {by})", counts())
            }
            (Numbers::Speeds(was, is), true, _) => format!("S{is} instead of S{was} ({})", counts()),
            (_, true, _) => format!("{text} ({} of its block)", counts()),
            (_, false, [(_, 1)]) => text.clone(),
            (_, false, _) => format!("{text} ({})", counts()),
        }
    }

    /// Describes the moves that are made under another condition.
    fn under_condition(&self, aspect: ModalAspect, moves: &[usize], first: usize) -> String {
        let [old, new] = self.alignment.records;
        let count = if moves.len() == 1 { "1 move".to_owned() } else { format!("{} moves", moves.len()) };
        match aspect {
            ModalAspect::Length => {
                let offsets =
                    [&old.steps[moves[0]], &new.steps[first]].map(|step| difference(&step.at, &step.to));
                let is_zero = |offset| near(offset, &Position::default(), 1e-9);
                let alike = match (is_zero(&offsets[0]), near(&offsets[0], &offsets[1], 1e-9)) {
                    (_, false) => "",
                    (true, true) => ", both 0 here",
                    (false, true) => ", equal here",
                };
                format!("{alike} ({count})")
            }
            ModalAspect::Level => {
                let is_r_level = new.under(first).word(aspect).text == "G99";
                let level = if is_r_level { "R point" } else { "initial" };
                format!(": the rapids between holes run at the {level} level ({count})")
            }
            ModalAspect::Cycle => format!(" ({})", self.holes_of_cycle(moves)),
            ModalAspect::System | ModalAspect::Cutter | ModalAspect::Path => format!(" ({count})"),
        }
    }

    /// Names the holes of the old revision that some moves of a cycle make, or counts them if the cycle makes no
    /// others.
    fn holes_of_cycle(&self, moves: &[usize]) -> String {
        let old = self.alignment.records[0];
        let cycle = |step: usize| &old.under(step).word(ModalAspect::Cycle).text;
        let with = |is_it: &dyn Fn(&usize) -> bool| -> Vec<usize> {
            (0..old.feeds.len()).filter(|hole| old.feeds[*hole].iter().any(is_it)).collect()
        };
        let all = with(&|step| cycle(*step) == cycle(moves[0]));
        let these = with(&|step| moves.binary_search(step).is_ok());
        match all.len() {
            _ if !these.is_empty() && these != all => named(&these),
            1 => "1 hole".to_owned(),
            n => format!("{n} holes"),
        }
    }
}

impl Group {
    fn join(&mut self, other: Self) {
        self.varies |= self.text != other.text;
        match (self.is_direct, other.is_direct) {
            (true, true) => {
                for edit in other.causes {
                    if !self.causes.contains(&edit) {
                        self.causes.push(edit);
                    }
                }
            }
            (false, true) => (self.causes, self.is_direct) = (other.causes, true),
            (_, false) => {}
        }
        match (&mut self.numbers, other.numbers) {
            (
                Numbers::Shift { most, is_compensated },
                Numbers::Shift { most: others, is_compensated: is_other },
            ) => {
                (0..MAX_AXES).for_each(|axis| most[axis] = most[axis].max(others[axis]));
                *is_compensated &= is_other;
            }
            (Numbers::Factor(least, most), Numbers::Factor(low, high)) => {
                (*least, *most) = (least.min(low), most.max(high));
            }
            (Numbers::Moves(_, moves, _), Numbers::Moves(_, more, _)) => moves.extend(more),
            _ => {}
        }
        for (what, times) in other.counts {
            match self.counts.iter_mut().find(|(known, _)| *known == what) {
                Some((_, count)) => *count += times,
                None => self.counts.push((what, times)),
            }
        }
    }
}

/// Formats that moves end at a different point.
fn shifted(counts: &[(&'static str, usize)], text: &str) -> String {
    match counts {
        [(what, 1)] => format!("{} ends at a different point: {text}", with_article(what)),
        [(what, n)] => format!("{} ends at a different point: {text} ({n} moves)", with_article(what)),
        _ => {
            let each = |(what, n): &(&str, usize)| match n {
                1 => with_article(what),
                _ => format!("{n} {what}s"),
            };
            let each: Vec<String> = counts.iter().map(each).collect();
            format!("moves end at a different point: {text} ({})", each.join(", "))
        }
    }
}
