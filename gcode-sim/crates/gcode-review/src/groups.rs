//! Differences that say the same or have one cause, told once with how often.
use super::cause::{Cause, cause};
use super::change::Change;
use super::descriptions::{coordinates, short};
use super::record::Record;
use super::steps::{Step, near};
use gcode_lang::motion::{MAX_AXES, Position};

/// Of a mode that is another one at the end as well.
pub(super) const STAYS: &str = ", also for the next program";

/// Differences of one kind that say the same.
struct Group {
    code: &'static str,
    /// What is different, without how often.
    text: String,
    /// What it is that is different, "move", "dwell", and how often; of moves that go elsewhere each kind.
    counts: Vec<(&'static str, usize)>,
    /// How many times as fast a move is, at least and at most; of moves that end elsewhere nothing.
    factors: Option<(f64, f64)>,
    /// Of a spindle that turns as fast as that, before and now.
    speeds: Option<(f64, f64)>,
    /// Those behind the first say other numbers: of moves with one cause or from one block.
    varies: bool,
    /// The next program finds it so.
    stays: bool,
    /// Of moves that end elsewhere as programmed: the machine stands where it stood.
    is_made_up: bool,
    /// By how much each axis ends elsewhere at most, without signs.
    most: Position,
    cause: Option<Cause>,
    old: Option<usize>,
    new: Option<usize>,
}

/// All of them, in the order in which they first came up.
pub(super) struct Groups<'a> {
    all: Vec<Group>,
    old: &'a Record,
    new: &'a Record,
    tolerance: f64,
}

/// The steps that something is told of, before and now.
pub(super) type StepRefs<'a> = (Option<&'a Step>, Option<&'a Step>);

impl<'a> Groups<'a> {
    pub(super) fn new(old: &'a Record, new: &'a Record, tolerance: f64) -> Self {
        Self { all: Vec::new(), old, new, tolerance }
    }

    /// One difference more: `what` it is that is different, and how.
    pub(super) fn add(&mut self, code: &'static str, what: &'static str, text: String, sides: StepRefs<'_>) {
        let place = |step: Option<&Step>| step.map(|step| step.place);
        let places = (place(sides.0), place(sides.1));
        let is_alone = matches!(code, "move-added" | "move-lost");
        let is_same = |group: &&mut Group| {
            group.code == code && (group.text == text || is_alone && (group.old, group.new) == places)
        };
        match self.all.iter_mut().find(is_same) {
            Some(group) => {
                group.varies |= group.text != text;
                group.count(what);
            }
            None => self.begin(code, what, text, sides, None),
        }
    }

    /// A move that ends elsewhere by `shift`. One that is there once only has no cause of its own.
    /// Gives the group's number for what is carried on from there.
    pub(super) fn add_shift(&mut self, what: &'static str, shift: &Position, sides: StepRefs<'_>) -> usize {
        let text = coordinates(shift, &self.old.axes, self.tolerance, true);
        let places = sides.0.zip(sides.1).map(|(old, new)| (old.place, new.place));
        let cause = places.map(|(old, new)| cause(&self.old.places[old], &self.new.places[new]));
        let shifts = || self.all.iter().enumerate().filter(|(_, group)| group.code == "move-shifted");
        let same = shifts().find(|(_, group)| group.text == text);
        let found =
            same.or_else(|| shifts().find(|(_, group)| group.cause.is_some() && group.cause == cause));
        let found = found.map(|(place, _)| place);
        let place = found.unwrap_or(self.all.len());
        match found {
            Some(place) => self.all[place].count(what),
            None => self.begin("move-shifted", what, text.clone(), sides, None),
        }
        let group = &mut self.all[place];
        if group.cause.is_none() {
            group.cause = cause;
        }
        group.varies |= group.text != text;
        group.is_made_up &=
            sides.0.zip(sides.1).is_some_and(|(old, new)| near(&old.at, &new.at, self.tolerance));
        for axis in 0..MAX_AXES {
            group.most[axis] = group.most[axis].max(shift[axis].abs());
        }
        place
    }

    /// A move that ends elsewhere because one of a group does, and no axis of its own.
    pub(super) fn carry(&mut self, group: usize, what: &'static str, shift: &Position) {
        let text = coordinates(shift, &self.old.axes, self.tolerance, true);
        let group = &mut self.all[group];
        group.varies |= group.text != text;
        group.count(what);
    }

    /// The spindle at another speed, whichever way it turns: a tapping cycle turns it back.
    pub(super) fn tell_speed(&mut self, was: f64, is: f64, text: String, (old, new): (&Step, &Step)) {
        let places = (Some(old.editable_at()), Some(new.editable_at()));
        let is_alike = |group: &&mut Group| {
            group.speeds == Some((was, is)) && (group.text == text || (group.old, group.new) == places)
        };
        match self.all.iter_mut().find(is_alike) {
            Some(group) => {
                if group.text != text {
                    group.text = format!("S{is} instead of S{was}");
                }
                group.count(old.kind.name());
            }
            None => {
                self.begin("spindle", old.kind.name(), text, (Some(old), Some(new)), None);
                self.all.last_mut().into_iter().for_each(|group| {
                    (group.speeds, group.old, group.new) = (Some((was, is)), places.0, places.1);
                });
            }
        }
    }

    /// A move at another feed. Those of one block say the same: of G93 each is another.
    pub(super) fn add_feed(&mut self, was: f64, is: f64, (old, new): (&Step, &Step)) {
        let text = format!("feed F{} instead of F{}", short(is), short(was));
        let factor = is / was;
        let is_alike = |group: &&mut Group| {
            let is_place = group.old == Some(old.editable_at()) && group.new == Some(new.editable_at());
            group.code == "feed" && (group.text == text || is_place)
        };
        match self.all.iter_mut().find(is_alike) {
            Some(group) => {
                group.varies |= group.text != text;
                group.factors = group.factors.map(|(least, most)| (least.min(factor), most.max(factor)));
                group.count("move");
            }
            None => self.begin("feed", "move", text, (Some(old), Some(new)), Some((factor, factor))),
        }
    }

    fn begin(
        &mut self,
        code: &'static str,
        what: &'static str,
        text: String,
        (old, new): StepRefs<'_>,
        factors: Option<(f64, f64)>,
    ) {
        // What is there once only stands in its own block.
        let is_said = code == "feed" || code == "tool" && old.is_some() && new.is_some();
        let place =
            |step: Option<&Step>| step.map(|step| if is_said { step.editable_at() } else { step.place });
        let counts = vec![(what, 1)];
        let (old, new) = (place(old), place(new));
        self.all.push(Group {
            code,
            text,
            counts,
            factors,
            speeds: None,
            varies: false,
            stays: false,
            is_made_up: true,
            most: Position::default(),
            cause: None,
            old,
            new,
        });
    }

    /// Where a difference says this, it says it of the next program as well.
    pub(super) fn stays(&mut self, code: &str, text: &str) -> bool {
        let found = self.all.iter_mut().find(|group| group.code == code && group.text == text);
        found.map(|group| group.stays = true).is_some()
    }

    /// All moves that end elsewhere in one, for they have one cause.
    pub(super) fn join_shifts(&mut self) {
        let mut others = Vec::with_capacity(self.all.len());
        let mut first: Option<usize> = None;
        for group in std::mem::take(&mut self.all) {
            match first.filter(|_| group.code == "move-shifted") {
                Some(place) => Group::join(&mut others[place], group),
                None => {
                    if group.code == "move-shifted" {
                        first = Some(others.len());
                    }
                    others.push(group);
                }
            }
        }
        self.all = others;
    }

    pub(super) fn changes(self) -> Vec<Change> {
        let (old, new, tolerance) = (self.old, self.new, self.tolerance);
        self.all.into_iter().map(|group| group.change(old, new, tolerance)).collect()
    }
}

impl Group {
    fn join(&mut self, other: Self) {
        self.varies |= other.varies || other.text != self.text;
        self.is_made_up &= other.is_made_up;
        for axis in 0..MAX_AXES {
            self.most[axis] = self.most[axis].max(other.most[axis]);
        }
        for (what, times) in other.counts {
            (0..times).for_each(|_| self.count(what));
        }
    }

    fn count(&mut self, what: &'static str) {
        match self.counts.iter_mut().find(|(known, _)| *known == what) {
            Some((_, count)) => *count += 1,
            None => self.counts.push((what, 1)),
        }
    }

    fn change(self, old: &Record, new: &Record, tolerance: f64) -> Change {
        let message = match self.code {
            "move-shifted" if self.varies => {
                self.shifted(&format!("up to {}", coordinates(&self.most, &old.axes, tolerance, false)))
            }
            "move-shifted" => self.shifted(&self.text),
            _ => self.counted() + if self.stays { STAYS } else { "" },
        };
        Change::new(self.code, message)
            .with_old(self.old.and_then(|place| old.places.get(place)))
            .with_new(self.new.and_then(|place| new.places.get(place)))
    }

    fn counted(&self) -> String {
        let counted: Vec<String> = self.counts.iter().map(|(what, n)| format!("{n} {what}s")).collect();
        match (self.varies, &self.counts[..]) {
            (true, _) if let Some((least, most)) = self.factors => {
                let is_one = (most - least).abs() <= 1e-6 * most.abs();
                let by = if is_one {
                    "the same factor".to_owned()
                } else {
                    format!("factors of {least:.4} to {most:.4}")
                };
                format!("{} ({}, all by {by})", self.text, counted.join(", "))
            }
            (true, _) => format!("{} ({} of its block)", self.text, counted.join(", ")),
            (false, [(_, 1)]) => self.text.clone(),
            (false, _) => format!("{} ({})", self.text, counted.join(", ")),
        }
    }

    /// Moves that end elsewhere, by `text`.
    fn shifted(&self, text: &str) -> String {
        let made_up = if self.is_made_up {
            " as programmed; the machine position is unchanged because of another length offset"
        } else {
            ""
        };
        let text = format!("{text}{made_up}");
        let first = match (self.old, self.new) {
            (None, Some(_)) => ", the first added",
            (Some(_), None) => ", the first removed",
            _ => "",
        };
        match self.counts[..] {
            [(what, 1)] => format!("{} ends at a different point: {text}", one(what)),
            [(what, n)] => format!("{} ends at a different point: {text} ({n} moves{first})", one(what)),
            _ => {
                let each = |(what, n): &(&str, usize)| match n {
                    1 => one(what),
                    _ => format!("{n} {what}s"),
                };
                let each: Vec<String> = self.counts.iter().map(each).collect();
                format!("moves end at a different point: {text} ({}{first})", each.join(", "))
            }
        }
    }
}

/// With its article.
fn one(what: &str) -> String {
    format!("{} {what}", if what.starts_with('a') { "an" } else { "a" })
}
