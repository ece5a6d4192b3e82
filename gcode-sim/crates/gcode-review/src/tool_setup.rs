//! Tool changes, lengths, spindle and coolant that come or go together with a pass of a hole, and which of them a cut relied on
//! that both revisions make.
use std::collections::{BTreeMap, BTreeSet};

use super::align::StepPair;
use super::change::Effect;
use super::descriptions::describe;
use super::modal_conditions::ModalAspect;
use super::record::{BlockLocation, Record};
use super::steps::{StepKind, UnsimulatedKind, near};
use gcode_lang::motion::{Axes, Position, SpindleDirection};

/// Spindle, coolant and tool length of `untold` steps that are otherwise now at a cut of both revisions: one effect for each step
/// that has made it so, with its link. Where H is another as well, the conditions tell it.
pub(super) fn relied_on_changes(
    links: &[StepPair],
    untold: impl Fn(usize) -> bool,
    (old, new): (&Record, &Record),
    tolerance: f64,
) -> Vec<(usize, Effect)> {
    if !(0..links.len()).any(&untold) {
        return Vec::new();
    }
    let is_named = CutState::is_named(old, new);
    let (mut before, mut now) = (CutState::default(), CutState::default());
    let mut all: Vec<ReliedOnStep> = Vec::new();
    for (k, link) in links.iter().enumerate() {
        let (i, j) = link.sides();
        i.into_iter().for_each(|i| before.follow(&old.steps[i].kind, k, is_named));
        j.into_iter().for_each(|j| now.follow(&new.steps[j].kind, k, is_named));
        let (Some(i), Some(j)) = (i, j) else { continue };
        if old.steps[i].kind.rate().is_none() {
            continue;
        }
        let untold = |(was, is): LinkPair| was.filter(|k| untold(*k)).or(is.filter(|k| untold(*k)));
        // Where a head leans otherwise the same tool's length lies otherwise.
        let words = (old.under(i).word(ModalAspect::Length), new.under(j).word(ModalAspect::Length));
        let is_alike = matches!(link, StepPair::Same(..)) && words.0.text == words.1.text;
        let length = if is_alike { before.length(&now, untold, &old.axes, tolerance) } else { None };
        let found = [length, before.spindle(&now, untold), before.coolant(&now, untold)];
        for (link, code, text) in found.into_iter().flatten() {
            match all.iter_mut().find(|known| (known.link, known.code) == (link, code)) {
                Some(known) => known.moves += 1,
                None => all.push(ReliedOnStep { link, code, text, first: new.steps[j].place, moves: 1 }),
            }
        }
    }
    all.iter().map(|relied| (relied.link, relied.effect(links[relied.link], old, new))).collect()
}

/// A step that cuts relied on, or that they are made under now.
struct ReliedOnStep {
    link: usize,
    code: &'static str,
    /// Where M06 does what, and what is in force at the first of these cuts, before and now.
    text: [String; 3],
    /// The block of that cut in the new revision.
    first: usize,
    moves: usize,
}

impl ReliedOnStep {
    fn effect(&self, link: StepPair, old: &Record, new: &Record) -> Effect {
        let (was, is) = link.sides();
        let (was, is) = (was.map(|i| &old.steps[i]), is.map(|j| &new.steps[j]));
        let what = was.or(is).map(|step| describe(&step.kind, &old.axes)).unwrap_or_default();
        let gone = if is.is_some() { "is added" } else { "is removed" };
        let [whether, before, now] = &self.text;
        let counted = if self.moves == 1 { String::new() } else { format!(" ({} moves)", self.moves) };
        let cut = new.places.get(self.first).map(name).unwrap_or_default();
        let message = format!("{what} {gone}: {whether}{cut} is cut with {now} instead of {before}{counted}");
        Effect::new(self.code, message)
            .with_old(was.and_then(|step| old.places.get(step.place)))
            .with_new(is.and_then(|step| new.places.get(step.place)))
    }
}

/// `O0100:10 N210`.
fn name(place: &BlockLocation) -> String {
    let digits = place.block.strip_prefix('N').unwrap_or_default();
    let digits: String = digits.chars().take_while(char::is_ascii_digit).collect();
    let number = if digits.is_empty() { digits } else { format!(" N{digits}") };
    format!("{}:{}{number}", place.program, place.line)
}

/// The links of the steps that have put something in force, old and new; none for what is so at power-on.
type LinkPair = (Option<usize>, Option<usize>);

/// What a step is made with, each with the link of the step that has made it so.
#[derive(Clone, Default)]
pub(super) struct CutState {
    /// Where M06 stops the spindle, and where it turns on: a record doesn't say which, and machines are not alike.
    turning: [SpindleState; 2],
    /// By M code; one for all where they aren't known.
    flows: BTreeMap<Option<u32>, (bool, usize)>,
    length: (Position, Option<usize>),
}

/// The link of an untold step that makes it otherwise, its code, whether that is so on all machines, and what was in force and is.
type SetupDifference = (usize, &'static str, [String; 3]);

/// A spindle.
#[derive(Clone)]
struct SpindleState {
    sense: (SpindleDirection, Option<usize>),
    speed: (f64, Option<usize>),
}

impl Default for SpindleState {
    fn default() -> Self {
        Self { sense: (SpindleDirection::Off, None), speed: (0.0, None) }
    }
}

impl SpindleState {
    /// Who makes it otherwise than `now`.
    fn differs(&self, now: &Self) -> Option<LinkPair> {
        let is_other_speed = (self.speed.0 - now.speed.0).abs() > 1e-9;
        if self.sense.0 != now.sense.0 {
            Some((self.sense.1, now.sense.1))
        } else if self.sense.0 != SpindleDirection::Off && is_other_speed {
            Some((self.speed.1, now.speed.1))
        } else {
            None
        }
    }

    fn text(&self) -> String {
        match self.sense.0 {
            SpindleDirection::Off => "the spindle stopped".to_owned(),
            SpindleDirection::Clockwise => format!("M03 S{}", self.speed.0),
            SpindleDirection::Counterclockwise => format!("M04 S{}", self.speed.0),
        }
    }
}

impl CutState {
    /// Both revisions say by which M code coolant flows.
    pub(super) fn is_named(old: &Record, new: &Record) -> bool {
        let mut steps = old.steps.iter().chain(&new.steps);
        !steps.any(|step| matches!(step.kind, StepKind::Coolant(_, None)))
    }

    pub(super) fn follow(&mut self, kind: &StepKind, link: usize, is_named: bool) {
        match kind {
            StepKind::Tool(_) => self.turning[0].sense = (SpindleDirection::Off, Some(link)),
            StepKind::Spindle(turning, speed) => {
                for spindle in &mut self.turning {
                    spindle.sense = (*turning, Some(link));
                    if *turning != SpindleDirection::Off {
                        spindle.speed = (*speed, Some(link));
                    }
                }
            }
            // A spindle that M06 has not stopped takes it up at once.
            StepKind::Silent(UnsimulatedKind::Speed, text) => {
                if let Some(Ok(speed)) = text.strip_prefix('S').map(str::parse) {
                    self.turning[1].speed = (speed, Some(link));
                }
            }
            StepKind::Length(offset) => self.length = (*offset, Some(link)),
            StepKind::Coolant(true, code) => {
                self.flows.insert(code.filter(|_| is_named), (true, link));
            }
            StepKind::Coolant(false, _) => {
                self.flows.values_mut().for_each(|flow| *flow = (false, link));
            }
            _ => {}
        }
    }

    /// Spindle and coolant that are otherwise now: on which machines, and what was in force and is.
    pub(super) fn others(&self, now: &Self) -> impl Iterator<Item = [String; 3]> + use<> {
        let any = |(was, is): LinkPair| was.or(is).or(Some(0));
        let found = [self.spindle(now, any), self.coolant(now, any)];
        found.into_iter().flatten().map(|(_, _, text)| text)
    }

    fn length(
        &self,
        now: &Self,
        untold: impl Fn(LinkPair) -> Option<usize>,
        axes: &Axes,
        tolerance: f64,
    ) -> Option<SetupDifference> {
        let is_other = !near(&self.length.0, &now.length.0, tolerance);
        let link = untold(is_other.then_some((self.length.1, now.length.1))?)?;
        let text = |state: &Self| describe(&StepKind::Length(state.length.0), axes);
        Some((link, "tool-length", [String::new(), text(self), text(now)]))
    }

    fn spindle(&self, now: &Self, untold: impl Fn(LinkPair) -> Option<usize>) -> Option<SetupDifference> {
        let differs = |k: usize| self.turning[k].differs(&now.turning[k]);
        let differ = [differs(0), differs(1)];
        let found = differ.iter().enumerate().find_map(|(k, by)| Some((k, by.and_then(&untold)?)));
        let (k, link) = found?;
        let whether = match differ.map(|by| by.is_some()) {
            [true, false] => "if M06 stops the spindle, ",
            [false, true] => "if M06 keeps the spindle running, ",
            _ => "",
        };
        let words = [whether.to_owned(), self.turning[k].text(), now.turning[k].text()];
        Some((link, "spindle", words))
    }

    fn coolant(&self, now: &Self, untold: impl Fn(LinkPair) -> Option<usize>) -> Option<SetupDifference> {
        let codes: BTreeSet<Option<u32>> = self.flows.keys().chain(now.flows.keys()).copied().collect();
        let by = |code: &Option<u32>| {
            let (was, is) = (self.flows.get(code), now.flows.get(code));
            let flows = |flow: Option<&(bool, usize)>| flow.is_some_and(|(on, _)| *on);
            let is_other = flows(was) != flows(is);
            is_other.then(|| (was.map(|(_, link)| *link), is.map(|(_, link)| *link)))
        };
        let link = codes.iter().find_map(|code| untold(by(code)?))?;
        Some((link, "coolant", [String::new(), self.flowing(), now.flowing()]))
    }

    fn flowing(&self) -> String {
        let on = self.flows.iter().filter(|(_, (on, _))| *on);
        let codes: Vec<String> =
            on.map(|(code, _)| code.map_or("coolant on".to_owned(), |code| format!("M{code:02}"))).collect();
        if codes.is_empty() { "coolant off".to_owned() } else { codes.join(" and ") }
    }
}
