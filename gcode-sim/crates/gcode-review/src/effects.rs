//! Equal differences, counted as one effect of an edit.
use std::borrow::Cow;
use std::cell::OnceCell;
use std::collections::BTreeMap;

use super::align::Alignment;
use super::block_location::BlockLocation;
use super::change::Effect;
use super::descriptions::{coordinates, describe, point, short, shown_key};
use super::differences::{Difference, StepDifference};
use super::edits::{Causes, Edits};
use super::effect_groups::{EditSet, EffectGroup, Numbers, RepeatedBlocks, block_key};
use super::entries::CausedEffect;
use super::hole_groups::name_holes;
use super::kinds;
use super::modal_conditions::ModalAspect;
use super::redundant_commands::is_speed_alone;
use super::steps::{Step, StepKind, difference, near, with_article};
use gcode_lang::diag::FindingKind;
use gcode_lang::motion::{MAX_AXES, Position};

/// Description of one difference, from which its group begins.
struct Description {
    kind: &'static FindingKind,
    /// Name of the step.
    name: &'static str,
    text: String,
    numbers: Numbers,
    /// Numbers of the blocks in the records; `None` for the blocks of the steps.
    block_numbers: Option<[Option<usize>; 2]>,
}

impl Description {
    fn new(kind: &'static FindingKind, step: &Step<'_>, text: String) -> Self {
        Self { kind, name: step.kind.name(), text, numbers: Numbers::None, block_numbers: None }
    }
}

/// More shifts of one edit than this are one effect, by up to the largest.
const MOST_SHIFTS: usize = 4;

/// Largest number of pairs of feeds, and of displacements, whose groups are found without their sentences.
const MOST_KEYS: usize = 4096;

/// All groups, in the order of their first differences.
pub(super) struct Effects<'a> {
    all: Vec<EffectGroup>,
    by_text: BTreeMap<(&'static str, String), usize>,
    /// Groups of differences of feeds by the bits of the feeds, old and new: those of [`MOST_KEYS`] pairs.
    by_rates: BTreeMap<[u64; 2], usize>,
    /// Groups of moves that end at another point by [`shown_key`] of the displacement: those of [`MOST_KEYS`] keys.
    by_shifts: BTreeMap<[i64; MAX_AXES], usize>,
    /// By kind, and the numbers of the blocks, old and new, from 1.
    by_blocks: BTreeMap<(u8, u32, u32), u32>,
    alignment: Alignment<'a>,
    edits: &'a Edits<'a>,
    causes: Causes<'a>,
    /// Effects that are not of steps, and the number of those before these.
    others: Vec<CausedEffect>,
    before_steps: Option<usize>,
    /// The last difference of feeds, and its group.
    last_feed: Option<([u64; 2], [Option<usize>; 2], usize)>,
    repeated: [OnceCell<RepeatedBlocks>; 2],
}

impl<'a> Effects<'a> {
    pub(super) fn new(alignment: Alignment<'a>, edits: &'a Edits<'a>) -> Self {
        Self {
            all: Vec::new(),
            by_text: BTreeMap::new(),
            by_rates: BTreeMap::new(),
            by_shifts: BTreeMap::new(),
            by_blocks: BTreeMap::new(),
            alignment,
            edits,
            causes: Causes::new(edits, alignment.records),
            others: Vec::new(),
            before_steps: None,
            last_feed: None,
            repeated: Default::default(),
        }
    }

    /// Adds a difference. Those of steps are grouped by their sentences; feeds, speeds and unpaired moves by their
    /// blocks as well.
    pub(super) fn add(&mut self, difference: Difference) {
        match difference {
            Difference::Run(effect) => self.others.push((self.causes.of(&effect), effect)),
            Difference::Holes(holes) => {
                self.others.push((self.causes.of_holes(&holes), holes.effect));
            }
            Difference::Step(kind, steps) => {
                self.before_steps = self.before_steps.or(Some(self.others.len()));
                self.add_step(&kind, steps);
            }
        }
    }

    /// Returns the effects with their edits.
    pub(super) fn finish(mut self) -> Vec<CausedEffect> {
        self.join_shifts();
        let groups = std::mem::take(&mut self.all);
        let effect = |group: EffectGroup| {
            let blocks = self.blocks(group.block_numbers);
            let effect = Effect::new(group.kind, self.message(&group), blocks);
            (group.causes.all.into_iter().map(|edit| edit as usize).collect(), effect)
        };
        let of_steps: Vec<CausedEffect> = groups.into_iter().map(effect).collect();
        let index = self.before_steps.unwrap_or(self.others.len());
        self.others.splice(index..index, of_steps);
        self.others
    }

    fn add_step(&mut self, kind: &StepDifference, steps: [Option<usize>; 2]) {
        let feed = self.feed(kind, steps);
        if let (Some(feed), Some((rates, blocks, group))) = (feed, self.last_feed)
            && feed == (rates, blocks)
        {
            self.all[group].counts[0].1 += 1;
            return;
        }
        if let Some(feed) = feed
            && let Some(group) = self.by_rates.get(&feed.0).copied()
        {
            return self.join_feed(group, feed, steps);
        }
        let shift = self.shift(kind);
        if let (Some(key), StepDifference::EndPoint(shift)) = (shift, kind)
            && let Some(group) = self.by_shifts.get(&key).copied()
        {
            return self.join_shift(group, shift, steps);
        }
        let group = self.group_of_difference(kind, steps);
        let (is_direct, blocks) = (group.is_direct, group.block_numbers);
        let is_speed = matches!(group.numbers, Numbers::Speeds { .. });
        let is_of_block = ["feed", "move-added", "move-lost"].contains(&group.kind.code) || is_speed;
        let has_block_key = is_of_block || group.kind == &kinds::SPINDLE;
        let block_numbers = has_block_key.then(|| block_key(group.kind, group.block_numbers));
        let text = (group.kind.code, group.text.clone());
        let of_block = || {
            let known = *self.by_blocks.get(&block_numbers.filter(|_| is_of_block)?)? as usize;
            (!is_speed || self.all[known].numbers == group.numbers).then_some(known)
        };
        let known = self.by_text.get(&text).copied().or_else(of_block);
        let number = known.unwrap_or(self.all.len());
        self.by_text.entry(text).or_insert(number);
        // Blocks that make one step each have no other difference.
        if let Some(key) = block_numbers.filter(|_| self.is_repeated(blocks)) {
            self.by_blocks.entry(key).or_insert(number as u32);
        }
        match known {
            Some(known) => self.all[known].join(group),
            None => self.all.push(group),
        }
        if let Some((rates, _)) = feed {
            if self.by_rates.len() == MOST_KEYS {
                self.by_rates.clear();
            }
            self.by_rates.insert(rates, number);
        }
        if let Some(key) = shift {
            if self.by_shifts.len() == MOST_KEYS {
                self.by_shifts.clear();
            }
            self.by_shifts.insert(key, number);
        }
        // Another one of the same blocks has the same edits, unless these depend on the steps.
        self.last_feed = feed.filter(|_| is_direct).map(|(rates, blocks)| (rates, blocks, number));
    }

    /// Adds a difference of feeds to the group of those before it with the same feeds.
    fn join_feed(
        &mut self,
        group: usize,
        (rates, blocks): ([u64; 2], [Option<usize>; 2]),
        steps: [Option<usize>; 2],
    ) {
        if self.is_repeated(blocks) {
            self.by_blocks.entry(block_key(&kinds::FEED, blocks)).or_insert(group as u32);
        }
        let (causes, is_direct) = self.causes_of_difference(&self.all[group].numbers, blocks, steps);
        self.all[group].join_same(causes, is_direct);
        self.last_feed = is_direct.then_some((rates, blocks, group));
    }

    /// Returns the key of the displacement of a move that ends at another point.
    fn shift(&self, kind: &StepDifference) -> Option<[i64; MAX_AXES]> {
        let StepDifference::EndPoint(shift) = kind else { return None };
        shown_key(shift, self.alignment.tolerance)
    }

    /// Adds a move that ends at another point to the group of those before it with the same displacement.
    fn join_shift(&mut self, group: usize, shift: &Position, steps: [Option<usize>; 2]) {
        let records = self.alignment.records;
        let lists = [0, 1].map(|side| Some((&records[side].steps, steps[side]?)));
        let block_numbers = lists.map(|list| list.map(|(list, step)| list.block_number(step)));
        let numbers = shift_numbers(shift, self.is_compensated(steps));
        let (causes, is_direct) = self.causes_of_difference(&numbers, block_numbers, steps);
        let [old, new] = lists.map(|list| list.map(|(list, step)| list.kind(step)));
        let name = new.or(old).map_or("move", StepKind::name);
        self.all[group].join_numbers(numbers, causes, is_direct);
        self.all[group].count(name, 1);
    }

    /// Returns true if two moves end at the same machine position.
    fn is_compensated(&self, steps: [Option<usize>; 2]) -> bool {
        let [old, new] =
            [0, 1].map(|side| Some(self.alignment.records[side].steps.machine_end(steps[side]?)));
        old.zip(new).is_some_and(|(old, new)| near(&old, &new, self.alignment.tolerance))
    }

    /// Returns true if one of two blocks makes several steps, or sets a word of several.
    fn is_repeated(&self, blocks: [Option<usize>; 2]) -> bool {
        let repeated = |side: usize| {
            let record = self.alignment.records[side];
            self.repeated[side].get_or_init(|| RepeatedBlocks::of(&record.steps, record.blocks.len()))
        };
        (0..2).any(|side| blocks[side].is_some_and(|block| repeated(side).contains(block)))
    }

    /// Returns the rates and the blocks of a difference of feeds.
    fn feed(
        &self,
        kind: &StepDifference,
        steps: [Option<usize>; 2],
    ) -> Option<([u64; 2], [Option<usize>; 2])> {
        let StepDifference::Feed { was, is } = kind else { return None };
        let side = |side: usize| Some(self.alignment.records[side].steps.editable_at(steps[side]?));
        Some(([was.to_bits(), is.to_bits()], [side(0), side(1)]))
    }

    /// Returns the group of one difference.
    fn group_of_difference(&self, kind: &StepDifference, steps: [Option<usize>; 2]) -> EffectGroup {
        let [old, new] = &self.alignment.steps(steps);
        let Some(step) = old.as_ref().or(new.as_ref()) else { unreachable!("a difference has a step") };
        let described = match (kind, old.as_ref().zip(new.as_ref())) {
            (StepDifference::Condition(aspect), _) => self.describe_condition(*aspect, step, steps),
            (StepDifference::EndPoint(shift), _) => {
                self.describe_end_point(shift, new.as_ref().unwrap_or(step), self.is_compensated(steps))
            }
            (StepDifference::MoveKind, Some((old, new))) => {
                let text = format!("{} instead of {}", new.kind.one(), old.kind.one());
                Description { name: "move", ..Description::new(&kinds::MOVE_KIND, step, text) }
            }
            (StepDifference::ArcShape(text), _) => {
                Description::new(&kinds::MOVE_ARC, new.as_ref().unwrap_or(step), text.clone())
            }
            (StepDifference::Feed { was, is }, _) => describe_feed(step, *was, *is),
            (StepDifference::Shifted(word), _) => {
                let text = format!("{} is executed {word} than before", self.describe_command(steps));
                Description::new(change(step), step, text)
            }
            (_, Some((old, new))) => self.describe_replacement(kind, old, new),
            (_, None) => self.describe_unpaired(step, steps),
        };
        let Description { kind, name, text, numbers, block_numbers } = described;
        let mut block_numbers =
            block_numbers.unwrap_or([old, new].map(|step| step.as_ref().map(|step| step.block_number)));
        let is_tool = kind == &kinds::TOOL && old.is_some() && new.is_some();
        if matches!(numbers, Numbers::Factor { .. } | Numbers::Speeds { .. }) || is_tool {
            block_numbers = [old, new].map(|step| step.as_ref().map(Step::editable_at));
        }
        let (causes, is_direct) = self.causes_of_difference(&numbers, block_numbers, steps);
        let counts = vec![(name, 1)];
        EffectGroup { kind, text, counts, varies: false, numbers, causes, is_direct, block_numbers }
    }

    /// Returns the edits that cause a difference, and whether its blocks are part of them.
    fn causes_of_difference(
        &self,
        numbers: &Numbers,
        block_numbers: [Option<usize>; 2],
        steps: [Option<usize>; 2],
    ) -> (EditSet, bool) {
        let records = self.alignment.records;
        let edit = self.edits.of_numbers(records, block_numbers);
        if let Numbers::Moves { .. } = numbers {
            let of_steps = [0, 1].map(|side| Some(records[side].steps.block_number(steps[side]?)));
            let cause = edit.or_else(|| self.edits.cause_of_numbers(records, of_steps, steps));
            return (cause.into_iter().collect(), false);
        }
        let is_direct = self.edits.is_single() || edit.is_some();
        let cause = edit.or_else(|| self.edits.cause_of_numbers(records, block_numbers, steps));
        (cause.into_iter().collect(), is_direct)
    }

    /// Describes a move under another modal condition; its blocks are those that set the condition.
    fn describe_condition(
        &self,
        aspect: ModalAspect,
        step: &Step<'_>,
        steps: [Option<usize>; 2],
    ) -> Description {
        let words = [0, 1].map(|side| Some(self.alignment.records[side].under(steps[side]?).word(aspect)));
        let [before, now] = words.map(|word| word.map_or("", |word| &word.text));
        let name = if aspect == ModalAspect::Cycle { "cycle " } else { "" };
        let text = format!("{name}{now} instead of {before}");
        let old = steps[0].into_iter().collect();
        Description {
            numbers: Numbers::Moves { aspect, old, first_new: steps[1].unwrap_or(0) },
            block_numbers: Some(words.map(|word| word?.block_number)),
            ..Description::new(aspect.row().1, step, text)
        }
    }

    /// Describes a move that ends at another point.
    fn describe_end_point(&self, shift: &Position, step: &Step<'_>, is_compensated: bool) -> Description {
        let Alignment { tolerance, .. } = self.alignment;
        let text = coordinates(shift, self.alignment.axes(), tolerance, true);
        Description {
            numbers: shift_numbers(shift, is_compensated),
            ..Description::new(&kinds::MOVE_SHIFTED, step, text)
        }
    }

    /// Describes a command in place of another.
    fn describe_replacement(&self, kind: &StepDifference, old: &Step<'_>, new: &Step<'_>) -> Description {
        let axes = self.alignment.axes();
        let text = format!("{} instead of {}", describe(new.kind, axes), describe(old.kind, axes));
        let numbers = match kind {
            StepDifference::Speed { was, is } => Numbers::Speeds { old: *was, new: *is },
            _ => Numbers::None,
        };
        Description { numbers, ..Description::new(change(old), old, text) }
    }

    /// Describes a move or a command that only one run has.
    fn describe_unpaired(&self, step: &Step<'_>, steps: [Option<usize>; 2]) -> Description {
        let (verb, kind_of_move) = match steps[0] {
            Some(_) => ("is removed", &kinds::MOVE_LOST),
            None => ("is added", &kinds::MOVE_ADDED),
        };
        if step.is_move() {
            let text = format!("{} to {} {verb}", step.kind.one(), point(step, self.alignment.axes()));
            Description { name: "move", ..Description::new(kind_of_move, step, text) }
        } else {
            Description::new(change(step), step, format!("{} {verb}", self.describe_command(steps)))
        }
    }

    fn blocks(&self, block_numbers: [Option<usize>; 2]) -> [Option<Cow<'a, BlockLocation>>; 2] {
        [0, 1].map(|side| Some(self.alignment.records[side].blocks.location(block_numbers[side]?)))
    }

    /// Describes a command of either run; if the spindle turns already, its speed alone.
    fn describe_command(&self, steps: [Option<usize>; 2]) -> String {
        let side = usize::from(steps[0].is_none());
        let (steps, step) = (&self.alignment.records[side].steps, steps[side].unwrap_or(0));
        match steps.kind(step) {
            StepKind::Spindle(_, speed) if is_speed_alone(steps, step) => format!("S{speed}"),
            kind => describe(kind, self.alignment.axes()),
        }
    }

    /// Joins many shifts of one edit, or of the same blocks if no edit contains them.
    fn join_shifts(&mut self) {
        let mut alike: BTreeMap<_, Vec<usize>> = BTreeMap::new();
        let shifts = self.all.iter().enumerate().filter(|(_, group)| group.kind == &kinds::MOVE_SHIFTED);
        for (number, group) in shifts {
            let blocks = if group.is_direct { [None, None] } else { group.block_numbers };
            let edit = group.causes.all.first().filter(|_| group.is_direct).copied();
            alike.entry((edit, blocks)).or_default().push(number);
        }
        let many = alike.into_values().filter(|numbers| MOST_SHIFTS < numbers.len());
        let into: BTreeMap<usize, usize> = many
            .flat_map(|numbers| numbers[1..].iter().map(|number| (*number, numbers[0])).collect::<Vec<_>>())
            .collect();
        let mut kept: BTreeMap<usize, EffectGroup> = BTreeMap::new();
        for (number, group) in std::mem::take(&mut self.all).into_iter().enumerate() {
            match into.get(&number).and_then(|first| kept.get_mut(first)) {
                Some(first) => first.join(group),
                None => _ = kept.insert(number, group),
            }
        }
        self.all = kept.into_values().collect();
    }

    fn message(&self, group: &EffectGroup) -> String {
        let text = &group.text;
        let counts = || -> String {
            let counts: Vec<String> = group.counts.iter().map(|(what, n)| format!("{n} {what}s")).collect();
            counts.join(", ")
        };
        match (&group.numbers, group.varies, &group.counts[..]) {
            (Numbers::Moves { aspect, old, first_new }, ..) => {
                format!("{text}{}", self.under_condition(*aspect, old, *first_new))
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
            (Numbers::Factor { smallest, largest }, true, _) => {
                let by = match (largest - smallest).abs() <= 1e-6 * largest.abs() {
                    true => "the same factor".to_owned(),
                    false => format!("factors of {smallest:.4} to {largest:.4}"),
                };
                format!("{text} ({}, all by {by})", counts())
            }
            (Numbers::Speeds { old, new }, true, _) => format!("S{new} instead of S{old} ({})", counts()),
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
                    [old.steps.at(moves[0]), new.steps.at(first)].map(|step| difference(&step.at, &step.to));
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
        let with = |is_member: &dyn Fn(&usize) -> bool| -> Vec<usize> {
            (0..old.feeds.len()).filter(|hole| old.feeds[*hole].iter().any(is_member)).collect()
        };
        let all = with(&|step| cycle(*step) == cycle(moves[0]));
        let these = with(&|step| moves.binary_search(step).is_ok());
        match all.len() {
            _ if !these.is_empty() && these != all => name_holes(&these),
            1 => "1 hole".to_owned(),
            n => format!("{n} holes"),
        }
    }
}

/// Returns the kind of a change of a command.
fn change(step: &Step<'_>) -> &'static FindingKind {
    step.kind.change().unwrap_or(&kinds::MOVE_SHIFTED)
}

fn shift_numbers(shift: &Position, is_compensated: bool) -> Numbers {
    Numbers::Shift { most: Position(shift.0.map(f64::abs)), is_compensated }
}

/// Describes a move with another feed, mm/min.
fn describe_feed(step: &Step<'_>, old: f64, new: f64) -> Description {
    let ratio = new / old;
    let text = format!("feed F{} instead of F{}", short(new), short(old));
    Description {
        name: "move",
        numbers: Numbers::Factor { smallest: ratio, largest: ratio },
        ..Description::new(&kinds::FEED, step, text)
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
