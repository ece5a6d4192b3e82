//! Differences that say the same, counted as one effect of an edit.
use std::collections::BTreeMap;

use super::change::Effect;
use super::descriptions::{code, coordinates, describe, point, short};
use super::differences::{Difference, DifferenceKind};
use super::edits::Edits;
use super::entries::CausedEffect;
use super::record::Record;
use super::redundant_commands::is_speed_alone;
use super::steps::{Step, StepKind, near};
use gcode_lang::motion::{MAX_AXES, Position};

/// Differences that say the same, or that one edit makes of moves.
struct Group {
    code: &'static str,
    /// What is different, without how often.
    text: String,
    /// What it is that is different, "move", "dwell", and how often; of moves that end elsewhere each kind.
    counts: Vec<(&'static str, usize)>,
    /// The others say other numbers than the first.
    varies: bool,
    numbers: Numbers,
    /// Its edits, and whether its blocks are of one of them.
    causes: Vec<usize>,
    is_direct: bool,
    /// The blocks of the first, by their numbers in the records.
    places: [Option<usize>; 2],
}

/// What a group counts besides.
#[derive(PartialEq)]
enum Numbers {
    None,
    /// By how much each axis ends elsewhere at most, without signs; and whether the machine stands where it stood everywhere.
    Shift {
        most: Position,
        is_compensated: bool,
    },
    /// How many times as fast a move is, at least and at most.
    Factor(f64, f64),
    /// The spindle's speed before and now.
    Speeds(f64, f64),
}

/// So many shifts of one edit are told one by one; more than that are one, by up to the largest.
const MOST_SHIFTS: usize = 4;

/// All groups, in the order in which they first came up.
pub(super) struct Effects<'a> {
    all: Vec<Group>,
    by_text: BTreeMap<(&'static str, String), usize>,
    by_places: BTreeMap<(&'static str, [Option<usize>; 2]), usize>,
    records: [&'a Record; 2],
    edits: &'a Edits,
    tolerance: f64,
}

impl<'a> Effects<'a> {
    pub(super) fn new(records: [&'a Record; 2], edits: &'a Edits, tolerance: f64) -> Self {
        let (by_text, by_places) = Default::default();
        Self { all: Vec::new(), by_text, by_places, records, edits, tolerance }
    }

    /// Counts a difference with those that say the same; feeds, speeds, and moves of one run alone, with those of their blocks.
    pub(super) fn add(&mut self, difference: &Difference) {
        let group = self.group(difference);
        let (text, places) = ((group.code, group.text.clone()), (group.code, group.places));
        let is_of_block = matches!(group.code, "feed" | "move-added" | "move-lost")
            || matches!(group.numbers, Numbers::Speeds(..));
        let of_block = || {
            let known = *self.by_places.get(&places).filter(|_| is_of_block)?;
            let is_alike =
                !matches!(group.numbers, Numbers::Speeds(..)) || self.all[known].numbers == group.numbers;
            is_alike.then_some(known)
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

    /// A group of one difference.
    fn group(&self, Difference { kind, steps }: &Difference) -> Group {
        let [old, new] = self.records;
        let (was, is) = (steps[0].map(|i| &old.steps[i]), steps[1].map(|j| &new.steps[j]));
        let mut numbers = Numbers::None;
        let Some(step) = is.or(was) else { unreachable!("a difference has a step") };
        let mut what = step.kind.name();
        let (code, text) = match (kind, was, is) {
            (DifferenceKind::EndPoint(way), ..) => {
                let is_compensated =
                    was.zip(is).is_some_and(|(was, is)| near(&was.at, &is.at, self.tolerance));
                let mut most = *way;
                (0..MAX_AXES).for_each(|axis| most[axis] = way[axis].abs());
                numbers = Numbers::Shift { most, is_compensated };
                ("move-shifted", coordinates(way, &old.axes, self.tolerance, true))
            }
            (DifferenceKind::MoveKind, Some(was), Some(is)) => {
                what = "move";
                ("move-kind", format!("{} instead of {}", is.kind.one(), was.kind.one()))
            }
            (DifferenceKind::ArcShape(text), ..) => ("move-arc", text.clone()),
            (DifferenceKind::Feed { was, is }, ..) => {
                what = "move";
                numbers = Numbers::Factor(is / was, is / was);
                ("feed", format!("feed F{} instead of F{}", short(*is), short(*was)))
            }
            (DifferenceKind::Shifted(word), Some(was), _) => {
                let command = self.called(0, steps[0]).unwrap_or_default();
                what = was.kind.name();
                (code(&was.kind), format!("{command} is executed {word} than before"))
            }
            (_, Some(was), Some(is)) => {
                what = was.kind.name();
                if let DifferenceKind::Speed { was, is } = kind {
                    numbers = Numbers::Speeds(*was, *is);
                }
                let [is, before] = [is, was].map(|step| describe(&step.kind, &old.axes));
                (code(&was.kind), format!("{is} instead of {before}"))
            }
            (_, was, _) => {
                let is_lost = was.is_some();
                let whether = if is_lost { "is removed" } else { "is added" };
                if step.is_move() {
                    what = "move";
                    let code = if is_lost { "move-lost" } else { "move-added" };
                    (code, format!("{} to {} {whether}", step.kind.one(), point(step, &old.axes)))
                } else {
                    let command = if is_lost { self.called(0, steps[0]) } else { self.called(1, steps[1]) };
                    (code(&step.kind), format!("{} {whether}", command.unwrap_or_default()))
                }
            }
        };
        let is_paired = was.is_some() && is.is_some();
        let is_set =
            matches!(numbers, Numbers::Factor(..) | Numbers::Speeds(..)) || code == "tool" && is_paired;
        let place = |step: &Step| if is_set { step.editable_at() } else { step.place };
        let places = [was.map(place), is.map(place)];
        let blocks = [0, 1].map(|side| places[side].and_then(|place| self.records[side].places.get(place)));
        let causes = self.edits.cause(blocks, *steps).into_iter().collect();
        let is_direct = self.edits.is_single() || self.edits.of(blocks).is_some();
        Group { code, text, counts: vec![(what, 1)], varies: false, numbers, causes, is_direct, places }
    }

    /// What a command says: where the spindle turns already, its speed alone.
    fn called(&self, side: usize, step: Option<usize>) -> Option<String> {
        let (record, step) = (self.records[side], step?);
        Some(match record.steps[step].kind {
            StepKind::Spindle(_, speed) if is_speed_alone(&record.steps, step) => format!("S{speed}"),
            ref kind => describe(kind, &self.records[0].axes),
        })
    }

    pub(super) fn finish(mut self) -> Vec<CausedEffect> {
        self.join_shifts();
        let effect = |group: &Group| {
            let [old, new] = [0, 1].map(|side| self.records[side].places.get(group.places[side]?));
            Effect::new(group.code, self.message(group)).with_old(old).with_new(new)
        };
        self.all.iter().map(|group| (group.causes.clone(), effect(group))).collect()
    }

    /// Makes one of many shifts that come from one edit, or of the same blocks where none is theirs.
    fn join_shifts(&mut self) {
        let mut alike: BTreeMap<_, Vec<usize>> = BTreeMap::new();
        for (number, group) in self.all.iter().enumerate().filter(|(_, group)| group.code == "move-shifted") {
            let places = if group.is_direct { [None, None] } else { group.places };
            let edit = group.causes.first().filter(|_| group.is_direct).copied();
            alike.entry((edit, places)).or_default().push(number);
        }
        alike.retain(|_, numbers| MOST_SHIFTS < numbers.len());
        let into: BTreeMap<usize, usize> = alike
            .into_values()
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
        let counted = || -> String {
            let counted: Vec<String> = group.counts.iter().map(|(what, n)| format!("{n} {what}s")).collect();
            counted.join(", ")
        };
        match (&group.numbers, group.varies, &group.counts[..]) {
            (Numbers::Shift { most, is_compensated }, varies, counts) => {
                let most =
                    || format!("up to {}", coordinates(most, &self.records[0].axes, self.tolerance, false));
                let by = if varies { most() } else { text.clone() };
                let as_programmed = if *is_compensated {
                    " as programmed; the machine position is unchanged because of another length offset"
                } else {
                    ""
                };
                shifted(counts, &format!("{by}{as_programmed}"))
            }
            (Numbers::Factor(least, most), true, _) => {
                let is_one = (most - least).abs() <= 1e-6 * most.abs();
                let by = match is_one {
                    true => "the same factor".to_owned(),
                    false => format!("factors of {least:.4} to {most:.4}"),
                };
                format!("{text} ({}, all by {by})", counted())
            }
            (Numbers::Speeds(was, is), true, _) => format!("S{is} instead of S{was} ({})", counted()),
            (_, true, _) => format!("{text} ({} of its block)", counted()),
            (_, false, [(_, 1)]) => text.clone(),
            (_, false, _) => format!("{text} ({})", counted()),
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

/// Moves that end elsewhere, by `text`.
fn shifted(counts: &[(&'static str, usize)], text: &str) -> String {
    match counts {
        [(what, 1)] => format!("{} ends at a different point: {text}", one(what)),
        [(what, n)] => format!("{} ends at a different point: {text} ({n} moves)", one(what)),
        _ => {
            let each = |(what, n): &(&str, usize)| match n {
                1 => one(what),
                _ => format!("{n} {what}s"),
            };
            let each: Vec<String> = counts.iter().map(each).collect();
            format!("moves end at a different point: {text} ({})", each.join(", "))
        }
    }
}

/// With its article.
fn one(what: &str) -> String {
    format!("{} {what}", if what.starts_with('a') { "an" } else { "a" })
}
