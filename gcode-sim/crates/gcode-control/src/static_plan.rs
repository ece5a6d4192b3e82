//! Plan of a single block without a run, for the alarms that its words raise whatever the program has done before.
use std::mem::discriminant;

use super::executor::Executor;
use super::plan::BlockPlan;
use super::state::CycleState;
use super::words::{BlockWords, DIRECT_DRAWING, WordNumber, count};
use gcode_lang::alarm::{Alarm, LocatedAlarm};
use gcode_lang::control::Settings;
use gcode_lang::program::cycles::Cycle;
use gcode_lang::program::modes::{CutterSide, Mirror, Motion, Rotation, Scaling};
use gcode_lang::program::{LoweredWord, WordOperand, Words};
use gcode_lang::source::Span;

/// Modes that decide which words a block takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModesInForce {
    /// Group 01.
    pub motion: Motion,
    /// Canned cycle.
    pub cycle: Option<&'static Cycle>,
    /// True if the depth of a peck is commanded.
    pub has_pecks: bool,
    /// Modes that are certainly on.
    pub certain: CertainModes,
}

/// Modes that rule out codes, each true if it is on wherever the program came from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CertainModes {
    /// G68.
    pub rotation: bool,
    /// G51.
    pub scaling: bool,
    /// G51.1, or G101 of a Haas.
    pub mirror: bool,
    /// G41 or G42.
    pub cutter: bool,
}

impl CertainModes {
    /// None is certainly on.
    pub const NONE: Self = Self { rotation: false, scaling: false, mirror: false, cutter: false };
}

/// A control at power-on that plans blocks and executes none.
#[derive(Debug)]
pub struct StaticPlanner {
    executor: Executor,
    plan: BlockPlan,
    words: BlockWords,
}

/// Number that stands for any computed value. Words other than axes are tried without a value too.
const ANY_NUMBER: f64 = 1.0;

impl StaticPlanner {
    /// Creates the planner of a control with these settings.
    pub fn new(settings: Settings) -> Self {
        let mut executor = Executor::new(settings);
        let state = &mut executor.registers.state;
        (state.modal_words.f, state.modal_words.s) = (1.0, 1.0);
        Self { executor, plan: BlockPlan::default(), words: BlockWords::default() }
    }

    /// Returns the alarm that a block raises in each of some modes, whatever values its computed words have; `None` if one
    /// of them lets it pass, or if it depends on more than the words and these modes.
    pub fn certain_alarm(
        &mut self,
        words: &Words,
        block: Span,
        modes: impl Iterator<Item = ModesInForce>,
    ) -> Option<LocatedAlarm> {
        let modes: Vec<ModesInForce> = modes.collect();
        let without = modes.iter().map(|modes| ModesInForce { certain: CertainModes::NONE, ..*modes });
        self.alarm_in_each(words, block, without).or_else(|| {
            let has_certain = modes.iter().any(|modes| modes.certain != CertainModes::NONE);
            has_certain.then(|| self.alarm_in_each(words, block, modes.into_iter())).flatten()
        })
    }

    /// Returns the alarm that a block raises in each of some modes, as [`StaticPlanner::certain_alarm`] does.
    fn alarm_in_each(
        &mut self,
        words: &Words,
        block: Span,
        modes: impl Iterator<Item = ModesInForce>,
    ) -> Option<LocatedAlarm> {
        let mut certain = None;
        for modes in modes {
            // If a word's value decides which alarm it is, another mixture of words may raise none.
            let with_values = self.alarm(words, block, modes, Some(ANY_NUMBER))?;
            let without_values = self.alarm(words, block, modes, None)?;
            let kinds = [&with_values, &without_values].map(|alarm| discriminant(&alarm.node));
            if kinds[0] != kinds[1] || !depends_on_words_alone(&without_values.node) {
                return None;
            }
            certain = Some(without_values);
        }
        certain
    }

    /// Returns the alarm of a block in some modes, with a number for each computed word or without these words.
    fn alarm(
        &mut self,
        words: &Words,
        block: Span,
        modes: ModesInForce,
        number: Option<f64>,
    ) -> Option<LocatedAlarm> {
        let state = &mut self.executor.registers.state;
        (state.modal.motion, state.modal.cycle) = (modes.motion, modes.cycle);
        let CertainModes { rotation, scaling, mirror, cutter } = modes.certain;
        state.modal.rotation = if rotation { Rotation::On } else { Rotation::Off };
        state.modal.scaling = if scaling { Scaling::On } else { Scaling::Off };
        state.modal.mirror = if mirror { Mirror::On } else { Mirror::Off };
        state.modal.cutter = if cutter { CutterSide::Left } else { CutterSide::Off };
        state.cycle = CycleState { q: modes.has_pecks.then_some(ANY_NUMBER), ..CycleState::default() };
        self.executor.flow.block = block;
        self.words.clear();
        for word in &words.list {
            if let Err(alarm) = self.put(word, number)? {
                return Some(alarm.located_at(word.span));
            }
        }
        self.plan.reset(&self.executor.registers.state);
        self.executor.planner(words, &self.words).plan_block(None, &mut self.plan).err()
    }

    /// Adds a word to those of the block; `None` if its value decides which block it is.
    fn put(&mut self, word: &LoweredWord, number: Option<f64>) -> Option<Result<(), Alarm>> {
        let settings = &self.executor.registers.data.settings;
        let raw = match word.value {
            WordOperand::Literal(literal) => Some(WordNumber::Literal(literal)),
            WordOperand::Number(number) => Some(WordNumber::Computed(number)),
            WordOperand::G(_, found) => {
                return Some(Ok(self.words.put_g(found.row_for(settings.codes)?).ok()?));
            }
            WordOperand::Variable { .. } | WordOperand::Code(_) => {
                let is_axis = settings.axes.find(word.letter).is_some();
                number.or(is_axis.then_some(ANY_NUMBER)).map(WordNumber::Computed)
            }
        };
        let is_literal = matches!(raw, Some(WordNumber::Literal(_)));
        match word.letter {
            _ if word.axis.is_some() => None,
            b'G' | b'M' if !is_literal => None,
            _ if word.comma => Some(raw.map_or(Ok(()), |raw| self.words.put_corner(word, raw))),
            b'M' => {
                let code = match count(raw?, b'M') {
                    Ok(code) => code,
                    Err(alarm) => return Some(Err(alarm)),
                };
                Some(self.words.put_m(code, word.span, settings))
            }
            letter => {
                if let Some(raw) = raw {
                    self.words.present_letters |= 1 << (letter - b'A');
                    self.words.values[usize::from(letter - b'A')] = (raw, word.span);
                }
                Some(Ok(()))
            }
        }
    }
}

/// Returns true for an alarm that no value, offset, position or other mode of the control decides.
fn depends_on_words_alone(alarm: &Alarm) -> bool {
    let is_direct_drawing = matches!(alarm, Alarm::NotSimulated { what } if what == DIRECT_DRAWING);
    is_direct_drawing
        || matches!(
            alarm,
            Alarm::WordNotSimulated(_)
                | Alarm::CodeInMode(..)
                | Alarm::CodeInScaling(_)
                | Alarm::SkipInCompensation
                | Alarm::ToolOffsetInCompensation
                | Alarm::NoCycle(_)
                | Alarm::IllegalPoint { .. }
                | Alarm::IllegalMinus { .. }
                | Alarm::TwoSigns { .. }
                | Alarm::TooManyDigits(_)
                | Alarm::ImproperAddress { .. }
                | Alarm::MissingWord { .. }
                | Alarm::NoPeckDepth
                | Alarm::NoRadiusOrCentre
                | Alarm::ReferenceReturnInCycle
                | Alarm::ReferenceReturnP { .. }
                | Alarm::CornerInThread
                | Alarm::CornerWords
                | Alarm::ScaleRate { .. }
                | Alarm::G10Format { .. }
                | Alarm::TooManyArgumentSets
                | Alarm::LookAheadFormat
                | Alarm::TNotAllowed
                | Alarm::TwoMacroCalls
                | Alarm::TwoSubprogramCalls
                | Alarm::SkipSignals { .. }
                | Alarm::SkipTorque
        )
}
