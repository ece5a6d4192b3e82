//! Plan of a single block without a run, for the alarms that its words raise whatever the program has done before.
use std::mem::discriminant;

use super::executor::Executor;
use super::kinematics::{Alignment, Matrix};
use super::plan::BlockPlan;
use super::plane::{Plane, Tilt};
use super::plane_codes::PLANE_IN_TIP_CONTROL;
use super::state::CycleState;
use super::tip_control::TIP_IN_PLANE;
use super::tool_axis::NO_PLANE;
use super::words::{BlockWords, DIRECT_DRAWING, WordNumber, count};
use gcode_lang::alarm::{Alarm, LocatedAlarm};
use gcode_lang::control::Settings;
use gcode_lang::motion::AxisIndex;
use gcode_lang::program::cycles::Cycle;
use gcode_lang::program::modes::{CutterSide, FeedMode, Length, Mirror, Motion, Rotation, Scaling};
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
    /// G68.2, G68.3, G68.4, or G268 of a Haas.
    pub plane: bool,
    /// G53.1 or G53.6, or G253 of a Haas, in that plane.
    pub aligned: bool,
    /// True if no plane is set: G69 has ended it, or nothing has begun one.
    pub level: bool,
    /// G43.4 or G43.5, or G234 of a Haas.
    pub tip: bool,
    /// G93.
    pub inverse_time: bool,
}

impl CertainModes {
    /// None is certainly on.
    pub const NONE: Self = Self {
        rotation: false,
        scaling: false,
        mirror: false,
        cutter: false,
        plane: false,
        aligned: false,
        level: false,
        tip: false,
        inverse_time: false,
    };
    /// Those at power-on.
    pub const POWER_ON: Self = Self { level: true, ..Self::NONE };

    /// Returns those that are certain on two paths.
    pub fn join(self, other: Self) -> Self {
        Self {
            rotation: self.rotation & other.rotation,
            scaling: self.scaling & other.scaling,
            mirror: self.mirror & other.mirror,
            cutter: self.cutter & other.cutter,
            plane: self.plane & other.plane,
            aligned: self.aligned & other.aligned,
            level: self.level & other.level,
            tip: self.tip & other.tip,
            inverse_time: self.inverse_time & other.inverse_time,
        }
    }
}

/// A control at power-on that plans blocks and executes none.
#[derive(Debug)]
pub struct StaticPlanner {
    executor: Executor,
    /// X, Y and Z.
    slides: Option<[AxisIndex; 3]>,
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
        let slides = executor.registers.data.linear_axes();
        Self { executor, slides, plan: BlockPlan::default(), words: BlockWords::default() }
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
            if kinds[0] != kinds[1] || !depends_on_words_alone(&without_values.node, modes.certain) {
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
        let CertainModes { rotation, scaling, mirror, cutter, plane, aligned, level: _, tip, inverse_time } =
            modes.certain;
        state.modal.rotation = match (plane, rotation) {
            (true, _) => Rotation::Tilted,
            (false, true) => Rotation::On,
            (false, false) => Rotation::Off,
        };
        state.modal.length = if tip { Length::TipByAngles } else { Length::Off };
        state.transform.tilt = self.slides.filter(|_| plane).map(|axes| Tilt {
            axes,
            plane: Plane { origin: [0.0; 3], matrix: Matrix::IDENTITY },
            alignment: aligned.then(|| Alignment::level(&Matrix::IDENTITY, [0.0; 3])),
            is_nested: false,
        });
        state.modal.scaling = if scaling { Scaling::On } else { Scaling::Off };
        state.modal.mirror = if mirror { Mirror::On } else { Mirror::Off };
        state.modal.cutter = if cutter { CutterSide::Left } else { CutterSide::Off };
        state.modal.feed_mode = if inverse_time { FeedMode::InverseTime } else { FeedMode::PerMinute };
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

/// Returns true for an alarm that no value, offset, position or other mode than these of the control decides.
fn depends_on_words_alone(alarm: &Alarm, certain: CertainModes) -> bool {
    match alarm {
        Alarm::ToolAxisCode(NO_PLANE) => return certain.level,
        Alarm::NotSimulated { what } => {
            let certain = [DIRECT_DRAWING, PLANE_IN_TIP_CONTROL, TIP_IN_PLANE];
            return certain.iter().any(|certain| what.ends_with(certain));
        }
        _ => {}
    }
    matches!(
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
            | Alarm::OffsetNumber { .. }
            | Alarm::TooManyArgumentSets
            | Alarm::LookAheadFormat
            | Alarm::TNotAllowed
            | Alarm::TwoMacroCalls
            | Alarm::TwoSubprogramCalls
            | Alarm::SkipSignals { .. }
            | Alarm::SkipTorque
            | Alarm::ToolAxisCode(_)
    )
}
