//! Effect of axis words on the marks: moves, canned cycles, zero shifts, G10.
use super::super::data::{Register, system_index};
use super::super::registers::Registers;
use super::words::{BlockModes, MarkedWord};
use super::{Block, Marks, OutsideValue, Slice};
use gcode_lang::control::Settings;
use gcode_lang::motion::AxisIndex;
use gcode_lang::program::g_codes::{MeasuringCode, OneShot};
use gcode_lang::program::modes::{Distance, Length, ModalGroup, Motion, Plane, Polar, WorkSystem};
use gcode_lang::program::{LoweredWord, WordOperand, Words};

/// Returns true if a canned cycle can drill along the axis of this letter.
pub(super) fn is_drilling(settings: &Settings, plane: Plane, letter: u8) -> bool {
    let letters: &[u8] = match plane {
        _ if !settings.drills_by_plane => b"Z",
        Plane::Xy => b"ZW",
        Plane::Zx => b"YV",
        Plane::Yz => b"XU",
    };
    letters.contains(&letter)
}

/// Words of a cycle that stay in force.
#[derive(Clone, Copy)]
struct CycleWords {
    /// Marks of Z, R and all others but those of the place.
    levels: Marks,
    has_levels: bool,
    /// Marks of the words that decide whether and how often the block cuts along its axis.
    cut: Marks,
    /// Marks of the number of repeats.
    repeats: Marks,
    /// Marks of the words that decide whether the block drills; `None` if it surely does.
    place: Option<Marks>,
}

impl CycleWords {
    /// Returns the marks of the level behind a block: of the one before it, where the block need not drill.
    fn returned_before(&self, before: Marks) -> Marks {
        match self.place {
            None if self.repeats.is_none() => Marks::NONE,
            place => before | self.repeats | place.unwrap_or_default(),
        }
    }
}

impl Slice {
    /// Follows the length offset where G28, G30 or G53 moves its axis and so may cancel it.
    fn follow_cancelled_length(&mut self, block: &Block<'_>, list: &[MarkedWord], modes: &BlockModes) {
        let is_on_machine = modes.one_shot == Some(OneShot::MachineCoordinateSystem);
        let is_along_tool = list.iter().any(|word| word.letter == b'Z') && modes.length != Length::Off;
        if !is_along_tool || !modes.one_shot.is_some_and(OneShot::moves_on_machine) {
            return;
        }
        let undocumented = &block.registers.data.settings.undocumented;
        if is_on_machine && modes.distance == Distance::Incremental && !undocumented.g53_moves_in_g91 {
            return;
        }
        self.machine.length |= self.branches.marks();
        if is_on_machine && block.registers.data.settings.assumes_restored_length() {
            let marks = self.outside(OutsideValue::RestoredLength, Some(1.0), block.flow, block.op);
            self.restored_length = marks;
        }
    }

    pub(super) fn follow_axes(&mut self, block: &Block<'_>, list: &[MarkedWord], modes: &BlockModes) {
        let settings = &block.registers.data.settings;
        let axes = &settings.axes;
        let control = self.branches.marks();
        let others: Marks = list.iter().map(|word| word.marks).collect();
        let named = || list.iter().filter_map(|word| Some((axes.find(word.letter)?, *word)));
        if block.registers.state.is_in_parameter_input {
            self.machine.rest |= others | control;
        }
        self.follow_cancelled_length(block, list, modes);
        match modes.one_shot {
            None | Some(OneShot::SingleDirection | OneShot::Skip | OneShot::Measure(_)) => {
                let repeats = list.iter().find(|word| word.letter == b'L').filter(|_| settings.repeats_moves);
                if let Some(repeats) = repeats {
                    named().for_each(|(axis, _)| self.machine.axes[axis] |= repeats.marks);
                }
            }
            // The start, the end and the offset decide.
            Some(OneShot::ToolOffset(_)) => {
                let offset = self.tool_offset_marks(block, list);
                named().for_each(|(axis, word)| self.machine.axes[axis] |= word.marks | offset | control);
                return;
            }
            Some(OneShot::Reference | OneShot::SecondReference) => {
                for (axis, word) in named() {
                    let before = if word.is_fixed() { Marks::NONE } else { self.machine.axes[axis] };
                    self.machine.axes[axis] = before | word.marks | control;
                }
                return;
            }
            Some(OneShot::MachineCoordinateSystem) => {
                for (axis, word) in named() {
                    let before = if word.is_fixed() { Marks::NONE } else { self.machine.axes[axis] };
                    self.machine.axes[axis] =
                        before | word.marks | control | self.machine.group(ModalGroup::Distance);
                }
                return;
            }
            Some(OneShot::SetLocalCoordinateSystem) => {
                for (axis, word) in named() {
                    let before = if word.is_fixed() { Marks::NONE } else { self.machine.shifts[axis] };
                    self.machine.shifts[axis] = before | word.marks | control;
                    // Where no later block commands the axis, the shift is left to the next start.
                    self.further |= word.marks;
                }
                return;
            }
            Some(OneShot::SetWorkCoordinateSystem | OneShot::PresetWorkCoordinateSystem) => {
                for (axis, _) in axes.iter() {
                    let position = self.machine.axes[axis] | self.machine.length;
                    self.machine.shifts[axis] |= position | others | control;
                }
                return;
            }
            Some(OneShot::DataInput) => {
                return self.follow_data_input(block, list, modes.distance, others | control);
            }
            Some(
                OneShot::Dwell | OneShot::RetractPoint | OneShot::DataInputEnd | OneShot::CheckReference,
            ) => return,
            Some(
                OneShot::FromReference
                | OneShot::StraightRapid
                | OneShot::ToolAxis { .. }
                | OneShot::CornerArc
                | OneShot::Cylinder
                | OneShot::WrappedAxis
                | OneShot::Engraving
                | OneShot::CirclePocket(_)
                | OneShot::Pocket
                | OneShot::AskewTapping { .. }
                | OneShot::BoltHoles(_),
            ) => {
                let all: Marks = self.machine.axes.iter().copied().collect();
                self.machine.axes.iter_mut().for_each(|axis| *axis |= all | others | control);
                self.further |= others;
            }
        }
        let is_level = |word: &MarkedWord| {
            b"RPQIJKL".contains(&word.letter) || is_drilling(settings, modes.plane, word.letter)
        };
        let marks_of = |is_one: &dyn Fn(&MarkedWord) -> bool| {
            list.iter().filter(|word| is_one(word)).map(|word| word.marks).collect::<Marks>()
        };
        let words = CycleWords {
            levels: marks_of(&is_level),
            has_levels: modes.begins_cycle || list.iter().any(is_level),
            cut: marks_of(&|word| !b"PQ".contains(&word.letter) && is_level(word)),
            repeats: marks_of(&|word| b"KL".contains(&word.letter)),
            place: match named().any(|(_, word)| word.is_fixed()) {
                true => None,
                false => Some(named().map(|(_, word)| word.marks).collect()),
            },
        };
        self.follow_move(block, named(), modes, words);
    }

    /// Follows a block of nothing but numbers for axes in a plain mode; returns false for any other.
    pub(super) fn follow_plain_move(&mut self, block: &Block<'_>, words: &Words) -> bool {
        let Registers { data, state, .. } = block.registers;
        let modal = &state.modal;
        let is_plain = |word: &LoweredWord| {
            matches!(word.value, WordOperand::Number(_) | WordOperand::Literal(_))
                && word.axis.is_none()
                && data.settings.axes.find(word.letter).is_some()
        };
        let is_plain_mode = modal.cycle.is_none()
            && modal.plane == Plane::Xy
            && modal.distance == Distance::Absolute
            && modal.polar == Polar::Off
            && modal.work == WorkSystem::default()
            && self.open_axes(data, modal.work) == 0
            && data.set_offsets.axes(0) == 0
            && state.transform.is_identity()
            && state.virtual_plane.is_none()
            && !state.is_in_parameter_input
            && data.settings.code_calls.is_empty();
        if !is_plain_mode
            || !self.are_modes_settled()
            || !self.machine.cutting.is_none()
            || words.call().is_some()
            || words.form_if_skipped().is_some()
            || !words.list.iter().all(is_plain)
        {
            return false;
        }
        self.is_rapid = modal.motion == Motion::Rapid;
        self.machine.transform = Marks::NONE;
        let marks = self.branches.marks() | self.machine.coordinate_system();
        for word in &words.list {
            if let Some(axis) = data.settings.axes.find(word.letter) {
                let length = if word.letter == b'Z' { self.machine.length } else { Marks::NONE };
                self.machine.axes[axis] = marks | self.machine.shifts[axis] | length;
            }
        }
        true
    }

    fn follow_move(
        &mut self,
        block: &Block<'_>,
        named: impl Iterator<Item = (AxisIndex, MarkedWord)>,
        modes: &BlockModes,
        words: CycleWords,
    ) {
        let registers = block.registers;
        let data = &registers.data;
        let control = self.branches.marks();
        let settings = &data.settings;
        let drills = |axis: AxisIndex| is_drilling(settings, modes.plane, settings.axes.letter(axis) as u8);
        let open_axes = self.open_axes(data, modes.work);
        // Only --set can have set the external offset.
        let shifted_axes = data.set_offsets.axes(0) & !self.set_offsets.axes(0);
        let drilling = settings.axes.iter().filter(|(axis, _)| modes.is_in_cycle && drills(*axis));
        let drilling = drilling.fold(0, |bits, (axis, _)| bits | 1 << axis);
        let is_cut = modes.is_in_cycle
            || modes.one_shot.is_some_and(OneShot::is_skip)
            || modes.one_shot.is_none() && modes.motion != Motion::Rapid;
        if is_cut {
            self.further |= words.cut;
        }
        let changes_length = modes.length != registers.state.modal.length;
        let (mut moved, mut moved_axes) = (Marks::NONE, 0_u32);
        for (axis, word) in named {
            moved_axes |= 1 << axis;
            if !is_cut {
                // In another mode the rapid is a cut.
                self.further |= self.machine.cutting;
            }
            let placed = drilling | 1 << axis;
            let mut work = Marks::NONE;
            if open_axes & placed != 0 {
                work = self.open_offset_marks(block, modes.work, open_axes & placed);
            }
            if shifted_axes & placed != 0 {
                work |= self.outside(OutsideValue::ExternalOffset, None, block.flow, block.op);
            }
            let mut marks = word.marks | control | work | self.machine.coordinates(axis);
            if word.letter == b'Z' || drills(axis) {
                marks |= self.machine.length;
            }
            let is_incremental = modes.distance == Distance::Incremental;
            if is_incremental || !word.is_fixed() || modes.is_in_cycle && drills(axis) {
                marks |= self.machine.axes[axis];
            }
            if !modes.is_in_cycle && drills(axis) {
                // In a cycle the word is the depth, and the axis returns.
                marks |= self.machine.in_cycle;
            }
            if modes.is_in_cycle && is_incremental {
                marks |= words.repeats;
            }
            self.machine.axes[axis] = marks;
            moved |= marks;
        }
        if modes.one_shot.is_some_and(OneShot::is_skip) {
            let signal = match self.stated.has_part {
                true => Marks::NONE,
                false => self.outside(OutsideValue::SkipSignal, None, block.flow, block.op),
            };
            self.machine.skip_position = moved | signal;
            for (axis, marks) in self.machine.axes.iter_mut().enumerate() {
                if changes_length || moved_axes >> axis & 1 == 1 {
                    *marks |= signal;
                }
            }
            match modes.one_shot {
                Some(OneShot::Measure(MeasuringCode::WorkZero | MeasuringCode::WorkCentre)) => {
                    self.machine.work_table |= moved | signal | words.cut;
                }
                Some(OneShot::Measure(_)) => self.machine.tool_table |= moved | signal | words.cut,
                _ => {}
            }
        }
        if modes.is_in_cycle {
            let drilling = || settings.axes.iter().map(|(axis, _)| axis).filter(|axis| drills(*axis));
            self.machine.returned = words.returned_before(self.machine.returned)
                | control
                | self.machine.group(ModalGroup::ReturnTo);
            if words.has_levels {
                let initial: Marks = drilling().map(|axis| self.machine.axes[axis]).collect();
                let is_first = modes.begins_cycle
                    && registers.state.modal.cycle.is_none()
                    && self.machine.in_cycle.is_none();
                let before = if is_first { Marks::NONE } else { self.machine.cycle };
                self.machine.cycle = before | words.levels | initial | control;
            }
            for axis in drilling() {
                self.machine.axes[axis] |= self.machine.cycle;
            }
        }
        let mixes = !registers.state.transform.is_identity()
            || registers.state.virtual_plane.is_some()
            || registers.state.modal.polar == Polar::On
            || !self.machine.transform.is_none();
        if mixes {
            let all: Marks = self.machine.axes.iter().copied().collect();
            self.machine.axes.iter_mut().for_each(|axis| *axis = all);
        }
    }

    /// Marks the drilling axes with what decides the level at which a cycle has left them, or whether the block still drills.
    pub(super) fn leave_cycle(&mut self, block: &Block<'_>, modes: &BlockModes) {
        let settings = &block.registers.data.settings;
        let marks = std::mem::take(&mut self.machine.returned) | self.machine.in_cycle;
        if marks.is_none() {
            return;
        }
        for (axis, letter) in settings.axes.iter() {
            if is_drilling(settings, modes.plane, letter as u8) {
                self.machine.axes[axis] |= marks;
            }
        }
    }

    /// Follows G10.
    fn follow_data_input(
        &mut self,
        block: &Block<'_>,
        list: &[MarkedWord],
        distance: Distance,
        marks: Marks,
    ) {
        let is_absolute = distance == Distance::Absolute;
        let value = |letter: u8| list.iter().find(|word| word.letter == letter).and_then(|word| word.value);
        let number = value(b'P').map(|number| number as u32);
        match (value(b'L').map(|l| l as u32), number) {
            (Some(l @ (2 | 20)), number) => {
                self.machine.work_table |= marks;
                let system = match (l, number) {
                    (2, Some(number)) => number as usize,
                    (_, Some(number)) => system_index(WorkSystem::Additional(number as u16)),
                    (_, None) => system_index(block.registers.state.modal.work),
                };
                let axes = &block.registers.data.settings.axes;
                let named = list.iter().filter(|word| word.value.is_some());
                let named = named.filter_map(|word| axes.find(word.letter));
                let axes = named.fold(0, |bits, axis| bits | 1 << axis);
                // G91 adds to what stood there before; the zero of G54 is the part's whatever it was.
                if is_absolute || system == system_index(WorkSystem::default()) {
                    self.set_offsets.add(system, axes);
                }
            }
            (Some(l @ (1 | 10..=13)), Some(number)) => {
                self.machine.tool_table |= marks;
                if is_absolute {
                    let table = block.registers.data.table(Register::of_data_input(l));
                    self.set_tools[table as usize].insert(number);
                }
            }
            (Some(85), Some(number)) => self.write(block.registers, number, marks),
            _ => self.machine.rest |= marks,
        }
    }
}
