//! Effect of a block of words on the marks: codes, moves, cycles, offsets, calls.
use super::super::data::Register;
use super::super::words::{computed_row, count};
use super::possible_motion::PossibleMotion;
use super::{Block, LOCALS, Marks, OutsideValue, Slice};
use crate::registers::Registers;
use gcode_lang::motion::SpindleDirection;
use gcode_lang::program::g_codes::{self, Effect, GCodeRow, OneShot};
use gcode_lang::program::m_codes::{self, MCodeEffect};
use gcode_lang::program::modes::{
    CutterSide, Distance, Length, ModalGroup, Motion, Plane, Polar, WorkSystem,
};
use gcode_lang::program::{ArgumentLocals, CallCode, CallOp, CallTarget, LoweredWord, WordOperand, Words};

/// One word with the marks of its value.
#[derive(Clone, Copy)]
pub(super) struct MarkedWord {
    pub(super) letter: u8,
    pub(super) marks: Marks,
    /// Value; `None` for vacant, with which the word counts as absent.
    pub(super) value: Option<f64>,
}

impl MarkedWord {
    /// Returns true if another outside value neither changes the word nor removes it.
    pub(super) fn is_fixed(&self) -> bool {
        self.marks.is_none() && self.value.is_some()
    }
}

/// Modes that a block has in force.
pub(super) struct BlockModes {
    pub(super) motion: Motion,
    pub(super) plane: Plane,
    pub(super) distance: Distance,
    pub(super) length: Length,
    pub(super) cutter: CutterSide,
    /// G16 or G68 is in force or begins.
    pub(super) uses_plane: bool,
    pub(super) work: WorkSystem,
    pub(super) is_in_cycle: bool,
    pub(super) begins_cycle: bool,
    pub(super) one_shot: Option<OneShot>,
}

impl BlockModes {
    /// Returns true if axis words cut.
    fn cuts(&self) -> bool {
        self.is_in_cycle || self.motion != Motion::Rapid
    }
}

impl Slice {
    pub(super) fn follow_words(&mut self, block: &Block<'_>, words: &Words) {
        if self.follow_plain_move(block, words) {
            return;
        }
        let data = &block.registers.data;
        let mut guard = Marks::NONE;
        if let Some((switch, _)) = words.form_if_skipped() {
            let switch = (*switch).max(1);
            let value = Some(f64::from(u8::from(data.is_skip_on(switch))));
            guard = self.outside(OutsideValue::BlockSkip(switch), value, block.flow, block.op);
            let motion = PossibleMotion::of(block.registers).behind_words(block.registers, words);
            self.add_possible_words(block.registers, words, guard, motion);
        }
        if block.registers.state.transform.is_identity() {
            self.machine.transform = Marks::NONE;
        }
        let words = data.words_not_skipped(words).0;
        let mut list: Vec<MarkedWord> = Vec::with_capacity(words.list.len());
        for word in &words.list {
            let marked = self.marked_word(block, words, word, guard);
            self.block_marks |= marked.marks;
            list.push(marked);
        }
        let modes = self.follow_g_codes(block, words, &list);
        self.is_in_cycle = modes.is_in_cycle;
        self.is_rapid = !modes.is_in_cycle
            && modes.motion == Motion::Rapid
            && !modes.one_shot.is_some_and(OneShot::is_skip);
        if !modes.is_in_cycle || modes.one_shot.is_some() {
            self.leave_cycle(block, &modes);
        }
        self.follow_power_on_modes(block, &list, &modes);
        self.follow_codes(&list, guard);
        self.follow_m_codes(block, words, &list);
        self.follow_offsets(block, &list, &modes);
        self.follow_axes(block, &list, &modes);
        self.follow_computed_axes(block, words);
        if let Some(call) = words.call() {
            self.follow_call(block, words, call);
        }
    }

    /// Marks all axes with the number in `AX[#510]=40.`, behind the words of the block: another number is another axis.
    fn follow_computed_axes(&mut self, block: &Block<'_>, words: &Words) {
        for axis in words.list.iter().filter_map(|word| words.axis(word.axis?)) {
            let marks = self.operand_marks(block, axis);
            self.machine.axes.iter_mut().for_each(|one| *one |= marks);
            self.further |= marks;
        }
    }

    fn marked_word(
        &mut self,
        block: &Block<'_>,
        words: &Words,
        word: &LoweredWord,
        guard: Marks,
    ) -> MarkedWord {
        let mut marks = guard;
        match &word.value {
            WordOperand::Variable { slot, .. } => marks |= self.variable_marks(block, slot.number()),
            WordOperand::Code(place) => marks |= self.code_marks(block, words.code(*place)),
            WordOperand::Literal(_) | WordOperand::Number(_) | WordOperand::G(..) => {}
        }
        if let Some(axis) = word.axis.and_then(|place| words.axis(place)) {
            marks |= self.operand_marks(block, axis);
        }
        let evaluate = |registers: &Registers| registers.evaluate_word(words, word).ok().flatten();
        let value = block.registers.without_side_effects(evaluate).map(|raw| raw.value());
        MarkedWord { letter: word.letter, marks, value }
    }

    fn follow_g_codes(&mut self, block: &Block<'_>, words: &Words, list: &[MarkedWord]) -> BlockModes {
        let state = &block.registers.state;
        let control = self.branches.marks();
        let mut modes = BlockModes {
            motion: state.modal.motion,
            plane: state.modal.plane,
            distance: state.modal.distance,
            length: state.modal.length,
            cutter: state.modal.cutter,
            uses_plane: state.modal.polar == Polar::On || state.transform.rotation.is_some(),
            work: state.modal.work,
            is_in_cycle: state.modal.cycle.is_some(),
            begins_cycle: false,
            one_shot: None,
        };
        for (word, marked) in words.list.iter().zip(list).filter(|(word, _)| word.letter == b'G') {
            let Some(row) = row_of(block, words, word) else {
                // A vacant code is none; another value is any code.
                self.follow_other_code(marked.marks);
                continue;
            };
            // G#5 with a code that #4003 had before is one of the same group.
            let is_restored = matches!(word.value, WordOperand::Variable { .. })
                && marked.marks.is_within(self.power_on_modes)
                && !matches!(row.effect, Effect::Motion(_) | Effect::Cycle(_));
            if !marked.marks.is_none() && !is_restored {
                // Another value is another code.
                self.follow_other_code(marked.marks);
            }
            if let Some(group) = row.effect.group() {
                self.machine.settle_group(group, control | marked.marks);
            }
            let was_cutting = modes.cuts();
            if let Effect::Motion(_) | Effect::Cycle(_) = row.effect {
                let may_change = modes.is_in_cycle
                    || !self.machine.in_cycle.is_none()
                    || matches!(row.effect, Effect::Cycle(Some(_)));
                self.machine.in_cycle = if may_change { control | marked.marks } else { Marks::NONE };
            }
            modes.uses_plane |= matches!(row.effect, Effect::Rotation(_) | Effect::Polar(_));
            match row.effect {
                Effect::Motion(motion) => {
                    (modes.is_in_cycle, modes.motion) = (false, motion);
                    self.machine.cycle = control | marked.marks;
                }
                Effect::Cycle(None) => {
                    modes.is_in_cycle = false;
                    self.machine.cycle = control | marked.marks;
                }
                Effect::Cycle(Some(_)) => (modes.is_in_cycle, modes.begins_cycle) = (true, true),
                Effect::Plane(plane) => modes.plane = plane,
                Effect::Distance(distance) => modes.distance = distance,
                Effect::Length(length) => modes.length = length,
                Effect::Cutter(side) => modes.cutter = side,
                Effect::Work(number) => modes.work = WorkSystem::Standard(number),
                Effect::NumberedWork(number) => modes.work = WorkSystem::Additional(number),
                Effect::AdditionalWork => {
                    let place = list.iter().find(|word| word.letter == b'P');
                    self.machine.settle_group(
                        ModalGroup::Work,
                        control | place.map_or(Marks::NONE, |word| word.marks),
                    );
                    if let Some(number) = place.and_then(|word| word.value) {
                        modes.work = WorkSystem::Additional(number as u16);
                    }
                }
                Effect::Scaling(_) | Effect::Rotation(_) | Effect::Mirror(_) => {
                    // A centre that is left out is the current position.
                    let position: Marks = self.machine.axes.iter().copied().collect();
                    let words: Marks = list.iter().map(|word| word.marks).collect();
                    self.machine.transform |= position | words | control;
                }
                Effect::OneShot(one) => modes.one_shot = Some(one),
                _ => {}
            }
            if modes.cuts() != was_cutting {
                self.machine.cutting |= control;
            }
            // The code ends a cycle too.
            if matches!(row.effect, Effect::Motion(_)) && control.is_none() {
                self.machine.cutting = marked.marks;
            }
        }
        modes
    }

    /// Applies the marks of the number of a code, of which another one may change anything.
    fn follow_other_code(&mut self, marks: Marks) {
        if !marks.is_none() {
            self.machine.add_to_all(marks);
            self.machine.rest |= marks;
            self.further |= marks;
        }
    }

    /// Follows F, S, T, H and D.
    fn follow_codes(&mut self, list: &[MarkedWord], guard: Marks) {
        let control = self.branches.marks() | guard;
        for word in list.iter().filter(|word| b"FSTHD".contains(&word.letter)) {
            let before = if word.is_fixed() { Marks::NONE } else { self.machine.code(word.letter) };
            self.machine.set_code(word.letter, before | word.marks | control);
        }
    }

    fn follow_m_codes(&mut self, block: &Block<'_>, words: &Words, list: &[MarkedWord]) {
        let settings = &block.registers.data.settings;
        let control = self.branches.marks();
        let mut turns = block.registers.state.spindle != SpindleDirection::Off;
        let mut stop = None;
        for (word, marked) in words.list.iter().zip(list).filter(|(word, _)| word.letter == b'M') {
            self.follow_other_code(marked.marks);
            let raw = block.registers.without_side_effects(|registers| registers.evaluate_word(words, word));
            let Some(code) = raw.ok().flatten().and_then(|raw| count(raw, b'M').ok()) else { continue };
            let effect = m_codes::find(code, settings.codes);
            turns |= matches!(effect, Some(MCodeEffect::SpindleForward | MCodeEffect::SpindleReverse));
            match effect {
                Some(
                    MCodeEffect::SpindleForward
                    | MCodeEffect::SpindleReverse
                    | MCodeEffect::SpindleStop
                    | MCodeEffect::Orient,
                ) => {
                    self.machine.spindle = control | marked.marks;
                }
                Some(effect @ (MCodeEffect::Stop | MCodeEffect::OptionalStop)) => {
                    let stops = effect == MCodeEffect::Stop || settings.stops_at_m01;
                    stop = stops.then_some(code).or(stop);
                }
                Some(MCodeEffect::RigidTapping) => self.machine.spindle |= control | marked.marks,
                Some(MCodeEffect::ToolChange) => self.machine.tool = self.machine.code(b'T') | control,
                // The operator's key, and the input, may be any.
                Some(MCodeEffect::OperatorInput | MCodeEffect::JumpByInput) => {
                    let marks = self.outside(OutsideValue::Auxiliary(code), None, block.flow, block.op);
                    self.machine.rest |= marks;
                }
                // An output may drive anything, unless the code is declared.
                Some(MCodeEffect::Output { .. }) => {
                    let output = list.iter().find(|word| word.letter == b'P');
                    if let Some(number) = output.and_then(|word| word.value) {
                        let marks = control | output.map_or(Marks::NONE, |word| word.marks) | marked.marks;
                        self.variables.set_system(12_000 + number as u32, marks);
                    }
                    if settings.declared_codes.find(b'M', 10 * code).is_none() {
                        let marks = self.outside(OutsideValue::Auxiliary(code), None, block.flow, block.op);
                        self.machine.rest |= marks;
                    }
                }
                None if settings.declared_codes.find(b'M', 10 * code).is_some()
                    || m_codes::is_auxiliary(code, settings.codes) => {}
                None if settings.code_calls.find_call(b'M', 10 * code).is_none()
                    && !self.stated.codes.contains(&code) =>
                {
                    let marks = self.outside(OutsideValue::Auxiliary(code), None, block.flow, block.op);
                    self.machine.rest |= marks;
                }
                _ => {}
            }
        }
        // The machine builder decides whether a spindle that turns goes on behind a stop.
        if let Some(code) = stop.filter(|_| turns && !settings.undocumented.stop_stops_spindle) {
            let marks = self.outside(OutsideValue::Auxiliary(code), None, block.flow, block.op);
            self.machine.spindle |= marks;
        }
    }

    /// Follows tool length and cutter radius.
    fn follow_offsets(&mut self, block: &Block<'_>, list: &[MarkedWord], modes: &BlockModes) {
        let registers = block.registers;
        let control = self.branches.marks();
        let number_of = |letter: u8, modal: u32| {
            let word = list.iter().find(|word| word.letter == letter);
            word.and_then(|word| word.value).map_or(modal, |value| value as u32)
        };
        let h = number_of(b'H', registers.state.modal_words.h);
        match modes.length {
            Length::Off => {
                self.restored_length = Marks::NONE;
                self.machine.length = control | self.machine.group(ModalGroup::Length);
            }
            _ if registers.state.modal.length != modes.length
                || list.iter().any(|word| word.letter == b'H') =>
            {
                let marks = self.machine.code(b'H') | self.machine.tool_table | control;
                self.restored_length = Marks::NONE;
                self.machine.length = marks | self.length_marks(block, h);
            }
            _ => {
                let stays = modes.one_shot.is_some_and(OneShot::moves_on_machine);
                let is_along_tool = |word: &MarkedWord| word.letter == b'Z';
                let moves_along = list.iter().any(is_along_tool)
                    || modes.is_in_cycle
                    || !registers.state.transform.is_identity();
                if moves_along && !stays {
                    self.machine.length |= std::mem::take(&mut self.restored_length);
                }
            }
        }
        let d = number_of(b'D', registers.state.modal_words.d);
        let begins =
            registers.state.modal.cutter != modes.cutter || list.iter().any(|word| word.letter == b'D');
        let mills_circle = matches!(modes.one_shot, Some(OneShot::CirclePocket(_)));
        match modes.cutter {
            CutterSide::Off if !mills_circle => self.machine.radius = control,
            _ if begins || mills_circle => {
                let mut marks = self.machine.code(b'D') | self.machine.tool_table | control;
                marks |= self.radius_marks(block, d);
                let settings = &registers.data.settings;
                if d != 0
                    && settings.assumes_radius_offsets()
                    && self.is_tool_set(&registers.data, Register::DGeometry, d)
                {
                    marks |= self.outside(OutsideValue::DiameterOffsets, Some(0.0), block.flow, block.op);
                }
                self.machine.radius = marks;
            }
            _ => {}
        }
    }

    /// Returns the marks of the offset of G45 to G48.
    pub(super) fn tool_offset_marks(&mut self, block: &Block<'_>, list: &[MarkedWord]) -> Marks {
        let data = &block.registers.data;
        let modal = &block.registers.state.modal_words;
        let is_h = data.settings.tool_offset_is_h;
        let (letter, modal) = if is_h { (b'H', modal.h) } else { (b'D', modal.d) };
        let word = list.iter().find(|word| word.letter == letter).and_then(|word| word.value);
        let number = word.map_or(modal, |value| value as u32);
        let marks = self.machine.code(letter) | self.machine.tool_table;
        marks | if is_h { self.length_marks(block, number) } else { self.radius_marks(block, number) }
    }

    fn follow_call(&mut self, block: &Block<'_>, words: &Words, call: &CallOp) {
        let control = self.branches.marks();
        let mut marks_of = |word: &LoweredWord| self.marked_word(block, words, word, Marks::NONE).marks;
        let mut decides = Marks::NONE;
        if let CallTarget::Number(word) = &call.target {
            decides |= marks_of(word);
        }
        for word in call.repeats.iter().chain(&call.start) {
            decides |= marks_of(word);
        }
        let arguments: Vec<(u8, Marks)> =
            call.arguments.iter().map(|word| (word.letter, marks_of(word))).collect();
        self.leave(decides);
        match call.kind {
            CallCode::Macro => {
                let mut locals = [control; LOCALS];
                let mut letters = ArgumentLocals::new(block.registers.data.settings.reads_ijk_plainly, false);
                for (letter, marks) in arguments {
                    if let Ok(Some(local)) = letters.next(letter) {
                        locals[local] |= marks;
                    }
                }
                self.arguments = Some(locals);
            }
            CallCode::AfterMoves | CallCode::EveryBlock => {
                self.modal_arguments |=
                    arguments.into_iter().map(|(_, marks)| marks).collect::<Marks>() | control;
            }
            CallCode::Cancel | CallCode::Subprogram | CallCode::File | CallCode::Local | CallCode::Return => {
            }
        }
    }
}

/// Returns the row of a G word.
fn row_of(block: &Block<'_>, words: &Words, word: &LoweredWord) -> Option<&'static GCodeRow> {
    let settings = &block.registers.data.settings;
    match &word.value {
        WordOperand::G(code, found) => g_codes::row_on(*code, *found, settings),
        _ => {
            let raw = block.registers.without_side_effects(|registers| registers.evaluate_word(words, word));
            computed_row(raw.ok().flatten()?, settings).ok()
        }
    }
}
