//! Spindle, coolant and tool length at cuts: which added or removed command changes them at a cut of both
//! revisions.
use std::collections::{BTreeMap, BTreeSet};

use super::align::Alignment;
use super::block_location::BlockLocation;
use super::change::Effect;
use super::descriptions::describe;
use super::kinds;
use super::modal_conditions::ModalAspect;
use super::record::Record;
use super::steps::{StepKind, UnsimulatedKind, near};
use gcode_lang::diag::FindingKind;
use gcode_lang::motion::{Axes, Position, SpindleDirection};

/// Returns the links of free steps that change spindle, coolant or tool length at cuts of both revisions, with one
/// effect each. If H differs as well, that is a difference of modal conditions.
pub(super) fn relied_on_changes(
    alignment: &Alignment<'_>,
    is_free: impl Fn(usize) -> bool,
) -> Vec<(usize, Effect)> {
    let Alignment { records: [old, new], links, tolerance } = *alignment;
    if !links.unpaired().any(|(k, _)| is_free(k)) {
        return Vec::new();
    }
    let is_named = CutState::is_named(old, new);
    let mut states = [CutState::default(), CutState::default()];
    let mut all: Vec<ReliedOnChange> = Vec::new();
    // The differences of the last cut of both, until a command follows.
    let mut last: Option<((usize, usize, bool), Vec<usize>)> = None;
    for (k, link) in links.iter().enumerate() {
        let sides = link.sides();
        let kinds = [0, 1].map(|side| Some(alignment.records[side].steps.kind(sides[side]?)));
        for (kind, state) in kinds.into_iter().zip(&mut states) {
            let command = kind.filter(|kind| !kind.is_move());
            command.into_iter().for_each(|kind| state.follow(kind, k, is_named));
            last = last.filter(|_| command.is_none());
        }
        let [Some(i), Some(j)] = sides else { continue };
        if old.steps.kind(i).rate().is_none() {
            continue;
        }
        let under = (old.steps.condition(i), new.steps.condition(j), link.is_same());
        if let Some((of, known)) = &last
            && *of == under
        {
            known.iter().for_each(|known| all[*known].cuts += 1);
            continue;
        }
        let free = |set_by: LinkPair| set_by.into_iter().flatten().find(|k| is_free(*k));
        let [before, now] = &states;
        // At another tilt of the head the same length has another direction.
        let is_same_h =
            old.under(i).word(ModalAspect::Length).text == new.under(j).word(ModalAspect::Length).text;
        let is_alike = link.is_same() && is_same_h;
        let length = if is_alike { before.length(now, free, &old.axes, tolerance) } else { None };
        let found = [length, before.spindle(now, free), before.coolant(now, free)];
        let numbers = found.into_iter().flatten().map(|(link, kind, text)| {
            let known = all.iter().position(|one| (one.link, one.kind) == (link, kind));
            let number = known.unwrap_or_else(|| {
                all.push(ReliedOnChange { link, kind, text, first_cut: j, cuts: 0 });
                all.len() - 1
            });
            all[number].cuts += 1;
            number
        });
        last = Some((under, numbers.collect()));
    }
    let effects = all.into_iter().filter_map(|ReliedOnChange { link, kind, text, first_cut, cuts }| {
        let sides = links.get(link)?.sides();
        let what = alignment.step(links.get(link)?).map(|step| describe(step.kind, &old.axes));
        let change = if sides[1].is_some() { "is added" } else { "is removed" };
        let [whether, before, now] = text;
        let count = if cuts == 1 { String::new() } else { format!(" ({cuts} moves)") };
        let (what, cut) = (what.unwrap_or_default(), name(&new.block(first_cut)));
        let message = format!("{what} {change}: {whether}{cut} is cut with {now} instead of {before}{count}");
        Some((link, Effect::new(kind, message, alignment.blocks(sides))))
    });
    effects.collect()
}

/// A command that changes spindle, coolant or tool length at cuts.
struct ReliedOnChange {
    link: usize,
    kind: &'static FindingKind,
    /// The machines that have the difference, and the values before and now at the first cut.
    text: [String; 3],
    /// Number of the first cut in the new run.
    first_cut: usize,
    cuts: usize,
}

/// Formats a block as `O0100:10 N210`.
fn name(location: &BlockLocation) -> String {
    let digits = location.block.strip_prefix('N').unwrap_or_default();
    let digits: String = digits.chars().take_while(char::is_ascii_digit).collect();
    let number = if digits.is_empty() { digits } else { format!(" N{digits}") };
    format!("{}:{}{number}", location.program, location.line)
}

/// Links of the steps that set a value, old and new; `None` for a value at power-on.
type LinkPair = [Option<usize>; 2];

/// Spindle, coolant and tool length at a step, each with the link of the step that set it.
#[derive(Clone, Default)]
pub(super) struct CutState {
    /// On a machine whose M06 stops the spindle, and on one whose M06 does not: a record does not say which it is.
    spindles: [SpindleState; 2],
    /// By M code; one for all if a record does not have them.
    flows: BTreeMap<Option<u32>, (bool, usize)>,
    length: (Position, Option<usize>),
}

/// Link of the free step that makes a difference, its kind, the machines that have it, and the values before and
/// now.
type SetupDifference = (usize, &'static FindingKind, [String; 3]);

/// State of a spindle.
#[derive(Clone, Default)]
struct SpindleState {
    direction: (SpindleDirection, Option<usize>),
    speed: (f64, Option<usize>),
}

impl SpindleState {
    /// Returns the steps that make it different from `now`.
    fn difference(&self, now: &Self) -> Option<LinkPair> {
        let is_other_speed = (self.speed.0 - now.speed.0).abs() > 1e-9;
        if self.direction.0 != now.direction.0 {
            Some([self.direction.1, now.direction.1])
        } else if self.direction.0 != SpindleDirection::Off && is_other_speed {
            Some([self.speed.1, now.speed.1])
        } else {
            None
        }
    }

    fn text(&self) -> String {
        match self.direction.0 {
            SpindleDirection::Off => "the spindle stopped".to_owned(),
            direction => describe(&StepKind::Spindle(direction, self.speed.0), &Axes::default()),
        }
    }
}

impl CutState {
    /// Returns true if both records have the M codes of coolant.
    pub(super) fn is_named(old: &Record, new: &Record) -> bool {
        let mut kinds = old.steps.all_kinds().chain(new.steps.all_kinds());
        !kinds.any(|kind| matches!(kind, StepKind::Coolant(_, None)))
    }

    /// Applies a step.
    pub(super) fn follow(&mut self, kind: &StepKind, link: usize, is_named: bool) {
        match kind {
            StepKind::Tool(_) => self.spindles[0].direction = (SpindleDirection::Off, Some(link)),
            StepKind::Spindle(direction, speed) => {
                for spindle in &mut self.spindles {
                    spindle.direction = (*direction, Some(link));
                    if *direction != SpindleDirection::Off {
                        spindle.speed = (*speed, Some(link));
                    }
                }
            }
            // A spindle that M06 has not stopped changes its speed at once.
            StepKind::Silent(UnsimulatedKind::Speed, text) => {
                if let Some(Ok(speed)) = text.strip_prefix('S').map(str::parse) {
                    self.spindles[1].speed = (speed, Some(link));
                }
            }
            StepKind::Length(offset) => self.length = (**offset, Some(link)),
            StepKind::Coolant(true, code) => {
                self.flows.insert(code.filter(|_| is_named), (true, link));
            }
            StepKind::Coolant(false, _) => {
                self.flows.values_mut().for_each(|flow| *flow = (false, link));
            }
            StepKind::Rapid
            | StepKind::Feed(_)
            | StepKind::Arc(..)
            | StepKind::Probe(_)
            | StepKind::Dwell(_)
            | StepKind::Auxiliary(_)
            | StepKind::Stop(..)
            | StepKind::Silent(..) => {}
        }
    }

    /// Returns differences of spindle and coolant: the machines that have them, and the values before and now.
    pub(super) fn others(&self, now: &Self) -> impl Iterator<Item = [String; 3]> + use<> {
        let any = |set_by: LinkPair| set_by.into_iter().flatten().next().or(Some(0));
        let found = [self.spindle(now, any), self.coolant(now, any)];
        found.into_iter().flatten().map(|(_, _, text)| text)
    }

    fn length(
        &self,
        now: &Self,
        free: impl Fn(LinkPair) -> Option<usize>,
        axes: &Axes,
        tolerance: f64,
    ) -> Option<SetupDifference> {
        let is_other = !near(&self.length.0, &now.length.0, tolerance);
        let link = free(is_other.then_some([self.length.1, now.length.1])?)?;
        let text = |state: &Self| describe(&StepKind::Length(Box::new(state.length.0)), axes);
        Some((link, &kinds::TOOL_LENGTH, [String::new(), text(self), text(now)]))
    }

    fn spindle(&self, now: &Self, free: impl Fn(LinkPair) -> Option<usize>) -> Option<SetupDifference> {
        let set_by = [0, 1].map(|k| self.spindles[k].difference(&now.spindles[k]));
        let (k, link) = (0..2).find_map(|k| Some((k, free(set_by[k]?)?)))?;
        let whether = match set_by.map(|set_by| set_by.is_some()) {
            [true, false] => "if M06 stops the spindle, ",
            [false, true] => "if M06 keeps the spindle running, ",
            _ => "",
        };
        let text = [whether.to_owned(), self.spindles[k].text(), now.spindles[k].text()];
        Some((link, &kinds::SPINDLE, text))
    }

    fn coolant(&self, now: &Self, free: impl Fn(LinkPair) -> Option<usize>) -> Option<SetupDifference> {
        let codes: BTreeSet<Option<u32>> = self.flows.keys().chain(now.flows.keys()).copied().collect();
        let link = codes.iter().find_map(|code| {
            let flows = [self, now].map(|state| state.flows.get(code).copied());
            let [was, is] = flows.map(|flow| flow.is_some_and(|(is_on, _)| is_on));
            if was == is { None } else { free(flows.map(|flow| Some(flow?.1))) }
        })?;
        Some((link, &kinds::COOLANT, [String::new(), self.flowing(), now.flowing()]))
    }

    fn flowing(&self) -> String {
        let on = self.flows.iter().filter(|(_, (is_on, _))| *is_on);
        let codes: Vec<String> =
            on.map(|(code, _)| describe(&StepKind::Coolant(true, *code), &Axes::default())).collect();
        if codes.is_empty() { "coolant off".to_owned() } else { codes.join(" and ") }
    }
}
