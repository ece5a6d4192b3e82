//! The steps of a run in little memory. A step is put together when it is read.
use std::collections::BTreeMap;

use super::kind_numbers::KindNumbers;
use super::positions::Positions;
use super::runs::{CountingRuns, Runs};
use super::steps::{Step, StepKind, difference};
use gcode_lang::motion::{Position, UnknownAxes};

/// Steps by their numbers.
#[derive(Clone, Debug, Default)]
pub(super) struct StepList {
    /// Actions without their end points; moves of one kind and feed share one.
    kinds: Vec<StepKind>,
    shared: BTreeMap<(u8, u64), u32>,
    of_step: KindNumbers,
    /// Axis positions after each step.
    at: Positions,
    /// Tool length offset of each step.
    lengths: Runs<Position>,
    /// Work zero of each step; 0 in an accepted result, which does not record it.
    zeros: Runs<Position>,
    /// Axes whose position on the part is unknown after each step; none in an accepted result, which does not record them.
    unknown: Runs<UnknownAxes>,
    block_numbers: CountingRuns,
    set_by: Runs<Option<u32>>,
    conditions: Runs<u32>,
}

/// A step as it is appended to a list: its start is the end of the one before it.
#[derive(Clone, Debug)]
pub(super) struct NewStep {
    pub kind: StepKind,
    /// Axis positions after it, in machine coordinates.
    pub at: Position,
    /// Tool length offset in force.
    pub length: Position,
    /// Zero of the work coordinate system in force, in machine coordinates.
    pub zero: Position,
    /// Axes whose position on the part is unknown after it.
    pub unknown: UnknownAxes,
    pub block_number: usize,
    pub set_by: Option<usize>,
    pub condition: usize,
}

impl StepList {
    /// Appends a step.
    pub(super) fn push(&mut self, step: NewStep) {
        let NewStep { kind, at, length, zero, unknown, block_number, set_by, condition } = step;
        let kind = self.kind_number(kind);
        self.of_step.push(kind);
        self.at.push(at);
        self.lengths.push(length);
        self.zeros.push(zero);
        self.unknown.push(unknown);
        self.block_numbers.push(block_number);
        self.set_by.push(set_by.map(|number| number as u32));
        self.conditions.push(condition as u32);
    }

    fn kind_number(&mut self, kind: StepKind) -> u32 {
        let shared = match &kind {
            StepKind::Rapid => Some((0, 0)),
            StepKind::Feed(rate) => Some((1, rate.to_bits())),
            StepKind::Probe(rate) => Some((2, rate.to_bits())),
            _ => None,
        };
        let new = self.kinds.len() as u32;
        let number = shared.map_or(new, |key| *self.shared.entry(key).or_insert(new));
        if number == new {
            self.kinds.push(kind);
        }
        number
    }

    pub(super) fn len(&self) -> usize {
        self.at.len()
    }

    /// Returns a step.
    ///
    /// # Panics
    /// If the list has no step with this number.
    pub(super) fn at(&self, number: usize) -> Step<'_> {
        let length = self.lengths.get(number);
        let at = self.at.get(number);
        let before = number.checked_sub(1).map_or_else(Position::default, |before| self.at.get(before));
        self.step(number, (&before, &at), length)
    }

    fn step(&self, number: usize, (before, at): (&Position, &Position), length: &Position) -> Step<'_> {
        Step {
            kind: self.kind(number),
            from: difference(before, length),
            to: difference(at, length),
            at: *at,
            block_number: self.block_number(number),
            set_by: self.set_by.get(number).map(|number| number as usize),
            condition: self.condition(number),
        }
    }

    /// Returns the axis positions after a step without the tool length offset.
    pub(super) fn end(&self, number: usize) -> Position {
        difference(&self.at.get(number), self.lengths.get(number))
    }

    /// Returns the axis positions after a step, in machine coordinates.
    pub(super) fn machine_end(&self, number: usize) -> Position {
        self.at.get(number)
    }

    /// Returns what a step does.
    pub(super) fn kind(&self, number: usize) -> &StepKind {
        &self.kinds[self.of_step.get(number) as usize]
    }

    pub(super) fn is_move(&self, number: usize) -> bool {
        self.kind(number).is_move()
    }

    /// Returns the axis positions after a step in its work coordinates, as the position display of a control shows them.
    pub(super) fn displayed(&self, number: usize) -> Position {
        difference(&difference(&self.at.get(number), self.lengths.get(number)), self.zeros.get(number))
    }

    /// Returns the axes whose position on the part is unknown after a step.
    pub(super) fn unknown_after(&self, number: usize) -> UnknownAxes {
        *self.unknown.get(number)
    }

    /// Returns the number of the block of a step.
    pub(super) fn block_number(&self, number: usize) -> usize {
        self.block_numbers.get(number)
    }

    /// Returns the block to edit for another tool, speed or feed of a step.
    pub(super) fn editable_at(&self, number: usize) -> usize {
        self.set_by.get(number).map_or_else(|| self.block_number(number), |number| number as usize)
    }

    /// Returns the number of the modal conditions of a step.
    pub(super) fn condition(&self, number: usize) -> usize {
        *self.conditions.get(number) as usize
    }

    /// Iterates over what the steps do.
    pub(super) fn kinds(&self) -> impl DoubleEndedIterator<Item = &StepKind> + ExactSizeIterator {
        (0..self.len()).map(|number| self.kind(number))
    }

    /// Iterates over the different actions.
    pub(super) fn all_kinds(&self) -> impl Iterator<Item = &StepKind> {
        self.kinds.iter()
    }

    /// Iterates over all steps.
    pub(super) fn iter(&self) -> impl Iterator<Item = Step<'_>> {
        (0..self.len()).scan(Position::default(), |before, number| {
            let at = self.at.get(number);
            let step = self.step(number, (before, &at), self.lengths.get(number));
            *before = at;
            Some(step)
        })
    }

    /// Returns the steps of which a function of their numbers and actions is true. A step left out may be no move.
    #[must_use]
    pub(super) fn filtered(&self, is_kept: impl Fn(usize, &StepKind) -> bool) -> Self {
        let mut kept = Self::default();
        for (number, step) in self.iter().enumerate().filter(|(number, step)| is_kept(*number, step.kind)) {
            kept.push(NewStep {
                kind: step.kind.clone(),
                at: step.at,
                length: *self.lengths.get(number),
                zero: *self.zeros.get(number),
                unknown: self.unknown_after(number),
                block_number: step.block_number,
                set_by: step.set_by,
                condition: step.condition,
            });
        }
        kept.shrink();
        kept
    }

    pub(super) fn shrink(&mut self) {
        self.kinds.shrink_to_fit();
        self.block_numbers.shrink();
        self.set_by.shrink();
        self.conditions.shrink();
    }
}
