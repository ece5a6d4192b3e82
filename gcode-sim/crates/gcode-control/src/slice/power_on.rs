//! What a control has at the start of a run, and a program may rely on: modes that no block has commanded, positions that no
//! block has made known.
use super::super::data::system_index;
use super::reads::POSITIONS;
use super::words::{BlockModes, MarkedWord};
use super::{Block, Marks, OutsideValue, Slice};
use gcode_lang::motion::MAX_AXES;
use gcode_lang::program::g_codes::OneShot;
use gcode_lang::program::modes::{CutterSide, GroupSet, ModalGroup, Motion};

/// Number of the modal groups of G codes in #4001….
const GROUP_NUMBERS: std::ops::RangeInclusive<u32> = 1..=22;

/// Groups without a state that is off: after the last job any of their codes may hold.
pub const KEPT_GROUPS: [ModalGroup; 5] =
    [ModalGroup::Unit, ModalGroup::Distance, ModalGroup::Plane, ModalGroup::ReturnTo, ModalGroup::Work];

impl Slice {
    /// Returns the marks of the state of a modal group; one that no block has commanded is an outside value. What power-on
    /// switches off is off: only a read of its code rests on that.
    fn mode_marks(&mut self, block: &Block<'_>, group: ModalGroup) -> Marks {
        if self.machine.is_settled(GroupSet::of(&[group])) {
            return self.machine.group(group);
        }
        let mode = OutsideValue::PowerOnMode(block.registers.state.modal.code_in(group));
        let marks = self.outside(mode, None, block.flow, block.op);
        self.power_on_modes |= marks;
        let marks = marks | self.machine.group(group);
        if KEPT_GROUPS.contains(&group) {
            self.machine.settle_group(group, marks);
        }
        marks
    }

    /// Follows the modes of power-on that a block makes use of: unit, G90 or G91, plane, return level of cycles, and on
    /// a machine with work offsets the active one.
    pub(super) fn follow_power_on_modes(
        &mut self,
        block: &Block<'_>,
        list: &[MarkedWord],
        modes: &BlockModes,
    ) {
        let settings = &block.registers.data.settings;
        let is_rotary =
            |letter: u8| settings.axes.find(letter).is_some_and(|axis| settings.axes.is_rotary(axis));
        let is_place = |letter: u8| settings.axes.find(letter).is_some() || b"IJKR".contains(&letter);
        let mut places = list.iter().map(|word| word.letter).filter(|letter| is_place(*letter)).peekable();
        // The end of G28 and G30 depends on no mode.
        if places.peek().is_none() || modes.one_shot.is_some_and(OneShot::moves_to_reference) {
            return;
        }
        let is_on_machine = modes.one_shot == Some(OneShot::MachineCoordinateSystem);
        let is_arc =
            !modes.is_in_cycle && matches!(modes.motion, Motion::Clockwise | Motion::Counterclockwise);
        let is_in_plane = modes.is_in_cycle && settings.drills_by_plane
            || is_arc
            || modes.uses_plane
            || modes.cutter != CutterSide::Off;
        for (group, is_used) in [
            (ModalGroup::Unit, places.any(|letter| !is_rotary(letter))),
            (ModalGroup::Distance, !is_on_machine),
            (ModalGroup::Plane, is_in_plane),
            (ModalGroup::ReturnTo, modes.is_in_cycle),
            (ModalGroup::Work, !is_on_machine && !self.stated.work_systems.is_empty()),
        ] {
            if is_used {
                self.mode_marks(block, group);
            }
        }
    }

    /// Returns true if a move of nothing but numbers makes use of no mode of power-on.
    pub(super) fn are_modes_settled(&self) -> bool {
        let groups: &[ModalGroup] = match self.stated.work_systems.is_empty() {
            true => &[ModalGroup::Unit, ModalGroup::Distance],
            false => &[ModalGroup::Unit, ModalGroup::Distance, ModalGroup::Work],
        };
        self.machine.is_settled(GroupSet::of(groups))
    }

    /// Returns the marks of #4001…: a modal code, or a word that stays in force.
    pub(super) fn modal_marks(&mut self, block: &Block<'_>, number: u32) -> Marks {
        let item = number % 200;
        let letter = match item {
            107 => b'D',
            109 => b'F',
            111 => b'H',
            119 => b'S',
            120 => b'T',
            _ => {
                let group = if item == 130 { ModalGroup::Work.number() } else { item };
                let group = ModalGroup::of(group).filter(|_| GROUP_NUMBERS.contains(&group));
                let marks = group.map_or(Marks::NONE, |group| self.mode_marks(block, group));
                return marks | self.machine.rest;
            }
        };
        match self.machine.is_commanded(letter) {
            true => self.machine.code(letter),
            false => self.outside_variable(block, number) | self.machine.code(letter),
        }
    }

    /// Returns the marks of #5001…; the position of an axis that no block has made known is an outside value.
    pub(super) fn position_marks(&mut self, block: &Block<'_>, number: u32) -> Marks {
        let (range, axis) = ((number - 5001) / POSITIONS, ((number - 5001) % POSITIONS) as usize);
        if axis >= block.registers.data.settings.axes.len().min(MAX_AXES) {
            return Marks::NONE;
        }
        let mut marks = self.machine.axes[axis]
            | self.machine.returned
            | self.machine.coordinates(axis)
            | self.machine.length;
        let state = &block.registers.state;
        let unknown = state.unknown_on_machine();
        let is_among = |axes: u8| axes >> axis & 1 == 1;
        let is_known = match range {
            // Machine coordinates of a place on the part rest on the work offset.
            1 => {
                let with_offset = block.registers.data.set_offsets.axes(system_index(state.modal.work));
                is_among(unknown.at_machine_position) || is_among(with_offset & !unknown.all())
            }
            // Tool length offset.
            4 => true,
            _ => !is_among(unknown.all()),
        };
        if !is_known {
            marks |= self.outside_variable(block, number);
        }
        if range == 3 { marks | self.machine.skip_position } else { marks }
    }
}
