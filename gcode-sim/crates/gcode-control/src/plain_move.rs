//! Plain moves: blocks of axis words, G00 or G01 and F while no mode makes more of them. Most steps of a block have no
//! effect on them, and they change little of the state.
use std::hint::cold_path;

use super::executor::Executor;
use super::linear_motion::{CoordinateBasis, SquaredTravel};
use super::registers::Registers;
use super::state::RigidTapping;
use super::variables::Value;
use super::words::MAX_G_CODES;
use gcode_lang::motion::{AxisIndex, EventKind, EventSink, MAX_AXES, Position};
use gcode_lang::program::g_codes::Effect;
use gcode_lang::program::modes::{CutterSide, Motion, Polar};
use gcode_lang::program::{LoweredWord, Op, Slot, WordOperand, Words};
use gcode_lang::units::MmPerMin;

/// Axes that a block names.
#[derive(Clone, Copy)]
struct AxisSet {
    /// Axes as bits, axis 1 the lowest.
    axes: u8,
    /// Axis after the last of them.
    end: AxisIndex,
    /// The words are in the order of the axes.
    is_ascending: bool,
}

impl AxisSet {
    const NONE: Self = Self { axes: 0, end: 0, is_ascending: true };

    /// Adds an axis; `None` if it is named twice.
    #[inline(always)]
    fn add(&mut self, axis: AxisIndex) -> Option<()> {
        if axis < self.end {
            cold_path();
            if self.axes >> axis & 1 == 1 {
                return None;
            }
            self.is_ascending = false;
        } else {
            self.end = axis + 1;
        }
        self.axes |= 1 << axis;
        Some(())
    }

    fn iter(self) -> impl Iterator<Item = AxisIndex> {
        (0..MAX_AXES).filter(move |axis| self.axes >> axis & 1 == 1)
    }
}

/// Words of a plain move.
struct PlainMove {
    motion: Motion,
    /// F, if commanded.
    f: Option<f64>,
    named: AxisSet,
    travel: SquaredTravel,
}

/// End point of the named axes, apart from [`PlainMove`] so that the compiler keeps that in registers.
#[derive(Default)]
struct PlainEndpoint {
    programmed: Position,
    machine: Position,
}

impl Executor {
    /// Executes a plain move; `None` for any other block, and nothing has changed. A block that raises an alarm is none: the
    /// steps of a block locate the alarm.
    #[inline(never)]
    pub(super) fn plain_move<S: EventSink>(&mut self, op: &Op, words: &Words, sink: &mut S) -> Option<()> {
        let basis = self.registers.plain_basis.as_ref()?;
        // A block has at most that number of G codes; one with fewer words can't exceed it.
        if !words.is_plain() || words.list.len() > MAX_G_CODES || !self.flow.modal_calls.is_empty() {
            return None;
        }
        let state = &*self.registers.state;
        let mut endpoint = PlainEndpoint::default();
        let mut resolved_move = PlainMove {
            motion: state.modal.motion,
            f: None,
            named: AxisSet::NONE,
            travel: SquaredTravel::default(),
        };
        self.registers.resolve_plain(words, basis, &mut resolved_move, &mut endpoint)?;
        if !resolved_move.named.is_ascending {
            // Sums in the order of the axes have the same bits for any order of the words.
            resolved_move.travel = self.registers.data.squared_travel(
                resolved_move.named.iter(),
                &state.machine_position,
                &endpoint.machine,
            );
        }
        let f = resolved_move.f.unwrap_or(state.modal_words.f);
        let (rate, seconds) = match resolved_move.motion {
            Motion::Rapid => (
                MmPerMin::ZERO,
                self.registers.data.rapid_seconds_of(
                    resolved_move.named.iter(),
                    &state.machine_position,
                    &endpoint.machine,
                ),
            ),
            Motion::Linear => self
                .registers
                .data
                .travel_time(state, f, resolved_move.travel, resolved_move.f.is_some())
                .ok()?,
            Motion::Clockwise | Motion::Counterclockwise | Motion::Thread => return None,
        };

        let state = &mut *self.registers.state;
        for axis in resolved_move.named.iter() {
            (state.programmed_position[axis], state.machine_position[axis]) =
                (endpoint.programmed[axis], endpoint.machine[axis]);
        }
        state.modal.motion = resolved_move.motion;
        if resolved_move.f.is_some() {
            (state.modal_words.f, state.modal_words.mode_of_f) = (f, state.modal.feed_mode);
        }
        state.modal_words.n = op.number.unwrap_or(state.modal_words.n);
        self.record_work_use(self.registers.state.modal.work, resolved_move.named.axes);
        let to = &self.registers.state.machine_position;
        match resolved_move.motion {
            _ if !resolved_move.travel.is_some() => {}
            _ if !sink.is_active() => self.count_move(seconds),
            Motion::Rapid => self.emit(&EventKind::Rapid { to: *to }, seconds, sink),
            // Arcs and threads have returned.
            Motion::Linear | Motion::Clockwise | Motion::Counterclockwise | Motion::Thread => {
                self.emit(&EventKind::Feed { to: *to, rate }, seconds, sink)
            }
        }
        Some(())
    }
}

impl Registers {
    /// Resolves the words of a block; `None` if it isn't a plain move, or raises an alarm.
    #[inline(always)]
    fn resolve_plain(
        &self,
        words: &Words,
        basis: &CoordinateBasis,
        resolved_move: &mut PlainMove,
        endpoint: &mut PlainEndpoint,
    ) -> Option<()> {
        let state = &*self.state;
        for word in &words.list {
            if word.comma {
                return None;
            }
            let Some(axis) = self.data.settings.axes.find(word.letter) else {
                match &word.value {
                    WordOperand::G(_, found) => match found.row_for(self.data.settings.codes)?.effect {
                        Effect::Motion(code) => resolved_move.motion = code,
                        _ => return None,
                    },
                    _ if word.letter != b'F' || resolved_move.f.is_some() => return None,
                    _ => resolved_move.f = self.evaluate_feed(words, word)?,
                }
                continue;
            };
            let value = match &word.value {
                WordOperand::Literal(number) => {
                    self.data.literal_dimension(number, word.letter, &basis.measure)?
                }
                value => {
                    let value = match value {
                        WordOperand::Variable { slot: Slot::Free(variable), .. } => {
                            self.variables.get_free(*variable)
                        }
                        value => self.evaluate_axis_value(words, value)?,
                    };
                    let Value::Number(value) = value else { continue };
                    self.data.computed_dimension(value, word.letter, &basis.measure)?
                }
            };
            resolved_move.named.add(axis)?;
            let to = &mut endpoint.machine[axis];
            (endpoint.programmed[axis], *to) = self.data.axis_end(axis, value, state, basis);
            if to.abs() > basis.max_coordinate {
                return None;
            }
            resolved_move
                .travel
                .add(*to - state.machine_position[axis], self.data.settings.axes.is_rotary(axis));
        }
        // A word that makes an axis known has an event.
        (resolved_move.named.axes != 0 && resolved_move.named.axes & basis.learnable_axes == 0).then_some(())
    }

    /// Returns the value of an axis word that is neither a literal nor a variable that is stored directly; `None` for an alarm.
    #[inline(never)]
    fn evaluate_axis_value(&self, words: &Words, value: &WordOperand) -> Option<Value> {
        self.evaluate_operand(words, value).ok()
    }

    /// Returns F, `None` inside if it is vacant; `None` for an alarm.
    #[inline(never)]
    fn evaluate_feed(&self, words: &Words, word: &LoweredWord) -> Option<Option<f64>> {
        match self.evaluate_word(words, word).ok()? {
            Some(raw) => self.data.feed_of(&raw, &self.state).ok().map(Some),
            None => Some(None),
        }
    }

    /// Updates [`Registers::plain_basis`] after everything that can change whether the next block can be a plain move.
    pub(super) fn update_is_plain(&mut self) {
        self.plain_basis = self.is_plain().then(|| self.data.coordinate_basis(&self.state));
    }

    /// Returns true if no mode makes more of axis words than a move of those axes.
    fn is_plain(&self) -> bool {
        let modal = &self.state.modal;
        modal.cycle.is_none()
            && !self.state.is_in_parameter_input
            && self.state.rigid_tapping == RigidTapping::Off
            && modal.cutter == CutterSide::Off
            && modal.polar == Polar::Off
            && !self.state.is_turned()
            && self.state.end_before_transform.is_none()
            && self.lookahead.is_idle()
            && self.data.settings.code_calls.is_empty()
            && self.data.settings.stroke_limits.is_none()
            && self.is_at_programmed_point()
    }

    /// Returns true if the machine is at the programmed position, so that an axis that isn't named stays there.
    fn is_at_programmed_point(&self) -> bool {
        self.state.transform.is_identity()
            && self.data.settings.rollover_axes().next().is_none()
            && self.data.to_machine(&self.state, &self.state.programmed_position).0.map(f64::to_bits)
                == self.state.machine_position.0.map(f64::to_bits)
    }
}

#[cfg(test)]
mod tests {
    use proptest::collection::vec;
    use proptest::prelude::*;

    use crate::{Control, Limits};
    use gcode_lang::control::{Settings, StrokeLimits};
    use gcode_lang::motion::{Event, EventSink, MAX_AXES};
    use gcode_lang::program::{Memory, NoLibrary};

    /// Emitted events.
    struct Events(Vec<String>);

    impl EventSink for Events {
        fn event(&mut self, event: &Event<'_>) {
            self.0.push(format!("{:?} {:?} {:?}", event.kind, event.seconds, event.block));
        }
    }

    fn run(text: &str, settings: Settings) -> (Vec<String>, bool) {
        let mut memory = Memory::default();
        memory.load("O1.nc", text.as_bytes().to_vec());
        let mut control = Control::new(memory, settings);
        let mut events = Events(Vec::new());
        let outcome = control.run(Limits { blocks: 500 }, &mut NoLibrary, &mut events);
        events.0.push(format!(
            "{outcome:?} {:?} {:?}",
            control.executor.registers.state, control.executor.log.notes
        ));
        (events.0, control.executor.registers.plain_basis.is_some())
    }

    fn settings() -> Settings {
        let mut settings = Settings::default();
        settings.rolls_over[4] = false;
        settings
    }

    /// Settings with stroke limits at infinity, with which no move is plain.
    fn never_plain() -> Settings {
        let no = [None; MAX_AXES];
        Settings { stroke_limits: Some(StrokeLimits { max: no, min: no }), ..settings() }
    }

    fn block() -> impl Strategy<Value = String> {
        let number = "-?[0-9]{1,2}(\\.[0-9]{0,5})?|#[1-3]|#500[13]";
        // Mostly in order and once each.
        let axes = format!(
            "(X({number}))?(Y({number}))?(Z({number}))?(A({number}))?(B({number}))?([XYZAB]({number}))?"
        );
        let moves = format!("(N[0-9]{{1,3}} )?(G0?[01]|G9[01]|G0|G1)?{axes}(F[1-9][0-9]{{1,2}})?");
        let others = "G9[01]|G2[01]|G5[45]|G52X[1-9]Y2\\.|G92X[0-9]\\.|G43H1|G49|G28Z0|G53X[0-9]|G10L2P1X0\\.[1-9]5|G10L10P1R1\\.5\
            |G81X1\\.Z-2\\.R1\\.F50|G80|G15|G16|G68X0Y0R30\\.|G69|G51X0Y0P2000|G50|G51\\.1X0|G50\\.1X0|G41D1|G40|G31Z-1\\.F50\
            |G0[23]X[1-9]\\.R20\\.|G9[345]|G17|G18|M3S900|M5|S500|#[1-3]=[0-9]\\.[0-9]{1,6}|#5221=[0-9]\\.5|#5203=1\\.5|G1X9\\.,R1\\.";
        let of = |pattern: &str| proptest::string::string_regex(pattern).unwrap();
        prop_oneof![4 => of(&moves), 1 => of(others)]
    }

    proptest! {
        #[test]
        fn a_plain_move_equals_the_steps_of_a_block(blocks in vec(block(), 1..40)) {
            let text = format!("O1\nG21 G90 G94 F100.\n{}\nM30\n", blocks.join("\n"));
            prop_assert_eq!(run(&text, settings()).0, run(&text, never_plain()).0, "{}", text);
        }
    }

    /// Without a centre for B, G51 leaves it unknown; after G50 the next absolute word makes it known.
    #[test]
    fn a_plain_move_makes_an_axis_known_that_counted_from_an_unknown_centre() {
        let text = "O1\nG51 X0 Y0 P2000\nB0\nG50\nA0\nB0\nM30\n";
        let (plain, stepped) = (run(text, settings()).0, run(text, never_plain()).0);
        assert_eq!(plain, stepped);
        let last = plain.iter().rfind(|event| event.contains("PositionUnknown"));
        assert!(last.is_some_and(|event| event.contains("shifted: 0")), "{last:?}");
    }

    #[test]
    fn modes_that_make_more_of_axis_words_exclude_plain_moves() {
        let is_plain = |text: &str| run(text, settings()).1;
        assert!(is_plain("G90 G0 X1.\n"));
        for more in
            ["G81 Z-1. R1. F50", "G16", "G68 X0 Y0 R30.", "G51 X0 Y0 P2000", "G51.1 X0", "G41 D1 G1 X5. F50"]
        {
            assert!(!is_plain(&format!("G90 G0 X1.\n{more}\n")), "{more}");
        }
        assert!(is_plain("G81 Z-1. R1. F50\nG80\n"), "after G80");
        assert!(!run("G90 G0 X1.\n", never_plain()).1);
    }
}
