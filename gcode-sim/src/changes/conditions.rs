//! What moves are made under: offsets, compensation, cycles and modes as a program calls them, whatever the tables hold
//! of them. H2 where H1 was is a change, though both are 0 in a run without a table.
use std::collections::BTreeSet;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Change;
use super::align::Link;
use super::record::Record;
use super::steps::{Kind, Step, difference};
use crate::exec::State;
use crate::motion::MAX_AXES;
use crate::program::modes::WorkSystem;

/// One of the things that are in force.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Aspect {
    /// G54 to G59, G54.1 with its P.
    System,
    /// G43 or G44 with H, G49.
    Length,
    /// G41 or G42 with D, G40.
    Cutter,
    /// G61 to G64.
    Path,
    /// G98, G99; only where a cycle is in force.
    Level,
    /// With its Q.
    Cycle,
}

impl Aspect {
    pub(super) const ALL: [Self; 6] =
        [Self::System, Self::Length, Self::Cutter, Self::Path, Self::Level, Self::Cycle];

    /// What a change of it is called.
    fn code(self) -> &'static str {
        match self {
            Self::System => "work-system",
            Self::Length => "tool-length",
            Self::Cutter => "cutter-side",
            Self::Path => "path-mode",
            Self::Level => "return-level",
            Self::Cycle => "cycle",
        }
    }

    fn read(self, state: &State) -> String {
        let modal = &state.modal;
        let group = |number| {
            let code = modal.code(number).unwrap_or_default();
            if code.is_multiple_of(10) {
                format!("G{:02}", code / 10)
            } else {
                format!("G{}.{}", code / 10, code % 10)
            }
        };
        let with = |number, off: u32, letter: char, value: u32| match modal.code(number) == Some(off) {
            true => group(number),
            false => format!("{} {letter}{value}", group(number)),
        };
        match (self, modal.cycle, state.drilling.q) {
            (Self::System, ..) => match modal.work {
                WorkSystem::Standard(_) => group(14),
                WorkSystem::Additional(number) => format!("G54.1 P{number}"),
            },
            (Self::Length, ..) => with(8, 490, 'H', state.codes.h),
            (Self::Cutter, ..) => with(7, 400, 'D', state.codes.d),
            (Self::Path, ..) => group(15),
            (Self::Level | Self::Cycle, None, _) => String::new(),
            (Self::Level, Some(_), _) => group(10),
            (Self::Cycle, Some(_), Some(q)) => format!("{} Q{q}", group(9)),
            (Self::Cycle, Some(_), None) => group(9),
        }
    }
}

/// What is in force while a step is made.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Condition(pub [Word; 6]);

/// One of them as a program writes it, and the block that has put it in force, by its number in the record.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Word {
    /// Empty for none.
    pub text: String,
    pub place: Option<usize>,
}

impl Condition {
    /// Before the first block: no block has put it in force.
    pub(super) fn at_power_on() -> Self {
        let state = State::default();
        Self(Aspect::ALL.map(|aspect| Word { text: aspect.read(&state), place: None }))
    }

    pub(super) fn word(&self, aspect: Aspect) -> &Word {
        &self.0[aspect as usize]
    }

    pub(super) fn set(&mut self, aspect: Aspect, word: Word) {
        self.0[aspect as usize] = word;
    }

    /// As a block leaves it: what is as before keeps the block that put it in force.
    pub(super) fn follow(&self, state: &State, place: usize) -> Self {
        let mut next = self.clone();
        for aspect in Aspect::ALL {
            let text = aspect.read(state);
            if next.word(aspect).text != text {
                next.set(aspect, Word { text, place: Some(place) });
            }
        }
        next
    }
}

/// What is in force at the steps of both records.
pub(super) struct Conditions<'a> {
    old: &'a Record,
    new: &'a Record,
}

/// Moves of which one thing differs alike.
struct Group<'a> {
    aspect: Aspect,
    was: &'a Word,
    is: &'a Word,
    moves: usize,
    /// The first of them.
    first: (usize, usize),
}

impl<'a> Conditions<'a> {
    pub(super) fn new(old: &'a Record, new: &'a Record) -> Self {
        Self { old, new }
    }

    /// One entry for each thing that moves of both are made under differently.
    pub(super) fn changes(&self, links: &[Link]) -> Vec<Change> {
        self.groups(links).into_iter().map(|group| self.change(&group)).collect()
    }

    fn groups(&self, links: &[Link]) -> Vec<Group<'a>> {
        let mut groups: Vec<Group<'a>> = Vec::new();
        for link in links {
            let (Some(i), Some(j)) = link.sides() else { continue };
            if !self.old.steps[i].is_move() {
                continue;
            }
            for aspect in Aspect::ALL {
                let (was, is) = self.words(aspect, i, j);
                // Where one of them isn't in a cycle, its holes are told.
                if was.text == is.text || was.text.is_empty() || is.text.is_empty() {
                    continue;
                }
                let alike =
                    |g: &&mut Group<'_>| g.aspect == aspect && g.was.text == was.text && g.is.text == is.text;
                match groups.iter_mut().find(alike) {
                    Some(group) => group.moves += 1,
                    None => groups.push(Group { aspect, was, is, moves: 1, first: (i, j) }),
                }
            }
        }
        groups
    }

    fn words(&self, aspect: Aspect, i: usize, j: usize) -> (&'a Word, &'a Word) {
        (self.old.under(i).word(aspect), self.new.under(j).word(aspect))
    }

    /// What explains that a cycle's strokes and lengths that are put in force are others: the words before and now.
    pub(super) fn strokes(&self, links: &[Link]) -> Strokes {
        let mut strokes = Strokes::default();
        for group in self.groups(links).iter().filter(|group| is_told_once(group.aspect)) {
            strokes.old.insert((group.aspect, group.was.text.clone()));
            strokes.new.insert((group.aspect, group.is.text.clone()));
        }
        strokes
    }

    fn change(&self, group: &Group<'_>) -> Change {
        let Group { aspect, was, is, moves, first: (i, j) } = group;
        let counted = if *moves == 1 { "1 move".to_owned() } else { format!("{moves} moves") };
        let alike = || {
            let (before, now) = (length(&self.old.steps[*i]), length(&self.new.steps[*j]));
            let far = |values: &[f64]| values.iter().any(|value| value.abs() > 1e-9);
            let apart: Vec<f64> = before.iter().zip(now).map(|(a, b)| a - b).collect();
            match (far(&before), far(&apart)) {
                (_, true) => "",
                (false, false) => ", both 0 here",
                (true, false) => ", both alike here",
            }
        };
        let more = match aspect {
            Aspect::Length => format!("{} ({counted})", alike()),
            Aspect::Level if is.text == "G99" => {
                format!(": the rapids from hole to hole run at the R level ({counted})")
            }
            Aspect::Level => format!(": the rapids from hole to hole run at the initial level ({counted})"),
            Aspect::Cycle => match self.holes(&was.text) {
                1 => " (1 hole)".to_owned(),
                n => format!(" ({n} holes)"),
            },
            Aspect::System | Aspect::Cutter | Aspect::Path => format!(" ({counted})"),
        };
        let what = match aspect {
            Aspect::Cycle => "cycle ",
            _ => "",
        };
        let message = format!("{what}{} instead of {}{more}", is.text, was.text);
        let at = |record: &'a Record, word: &Word| word.place.and_then(|place| record.places.get(place));
        Change::new(aspect.code(), message).once_at(at(self.old, was)).now_at(at(self.new, is))
    }

    /// How many holes of the old revision a cycle makes.
    fn holes(&self, cycle: &str) -> usize {
        let is_of = |step: &usize| self.old.under(*step).word(Aspect::Cycle).text == cycle;
        self.old.feeds.iter().filter(|feeds| feeds.iter().any(is_of)).count()
    }
}

fn is_told_once(aspect: Aspect) -> bool {
    matches!(aspect, Aspect::Cycle | Aspect::Level | Aspect::Length)
}

/// What is told once for all strokes of a cycle, and for a length and its end.
#[derive(Default)]
pub(super) struct Strokes {
    old: BTreeSet<(Aspect, String)>,
    new: BTreeSet<(Aspect, String)>,
}

impl Strokes {
    /// A step is different because its cycle is, or the length that it puts in force or ends.
    pub(super) fn explain(&self, link: &Link, old: &Record, new: &Record) -> bool {
        let is_in = |known: &BTreeSet<(Aspect, String)>, record: &Record, step: usize| {
            let text = |aspect: Aspect| record.under(step).word(aspect).text.clone();
            let is_known = |aspect: Aspect| known.contains(&(aspect, text(aspect)));
            if matches!(record.steps[step].kind, Kind::Length(_)) {
                let is_any = known.iter().any(|(aspect, _)| *aspect == Aspect::Length);
                return is_any && (is_known(Aspect::Length) || text(Aspect::Length) == "G49");
            }
            is_known(Aspect::Cycle) || is_known(Aspect::Level) && record.steps[step].is_rapid()
        };
        let (i, j) = link.sides();
        !(self.old.is_empty() && self.new.is_empty())
            && i.is_none_or(|i| is_in(&self.old, old, i))
            && j.is_none_or(|j| is_in(&self.new, new, j))
    }
}

/// The tool length offset that a step is made with, axis by axis.
fn length(step: &Step) -> [f64; MAX_AXES] {
    difference(&step.at, &step.to).0
}
