//! Sets of outside values, and the set on which each variable, axis and mode of a control depends.
use std::collections::BTreeMap;
use std::ops::{BitOr, BitOrAssign};

use gcode_lang::motion::MAX_AXES;
use gcode_lang::program::modes::{GroupSet, ModalGroup};

/// Set of outside values by their index. All values from the last index on share it, which adds dependences and loses none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Marks(u128);

impl Marks {
    /// Index that all values from it on share.
    pub const LAST_INDEX: usize = 127;

    /// No outside value.
    pub const NONE: Self = Self(0);

    pub(super) fn of(index: usize) -> Self {
        Self(1 << index.min(Self::LAST_INDEX))
    }

    /// Returns true for the empty set.
    pub fn is_none(self) -> bool {
        self.0 == 0
    }

    /// Returns true if `other` has all values of this set, none of which shares the last index.
    pub(super) fn is_within(self, other: Self) -> bool {
        self.0 & !other.0 == 0 && !self.contains(Self::LAST_INDEX)
    }

    /// Returns true if the set contains the value with this index.
    pub fn contains(self, index: usize) -> bool {
        self.0 >> index.min(Self::LAST_INDEX) & 1 == 1
    }
}

impl BitOr for Marks {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl BitOrAssign for Marks {
    fn bitor_assign(&mut self, other: Self) {
        self.0 |= other.0;
    }
}

impl FromIterator<Self> for Marks {
    fn from_iter<I: IntoIterator<Item = Self>>(all: I) -> Self {
        all.into_iter().fold(Self::NONE, BitOr::bitor)
    }
}

/// Number of locals with #0.
pub(super) const LOCALS: usize = 34;

/// Marks of the variables.
#[derive(Clone, Debug, Default)]
pub(super) struct VariableMarks {
    /// Locals of the current level and commons, by place; empty marks beyond the end.
    places: Vec<Marks>,
    /// Places that a block has written.
    written: Vec<bool>,
    /// Locals of the callers' levels.
    outer: Vec<[Marks; LOCALS]>,
    /// System variables that a block has written.
    system: BTreeMap<u32, Marks>,
    /// Marks of computed numbers of written variables: another number would have written any of them.
    any: Marks,
}

impl VariableMarks {
    pub(super) fn get(&self, place: usize) -> Marks {
        self.places.get(place).copied().unwrap_or_default() | self.any
    }

    pub(super) fn is_written(&self, place: usize) -> bool {
        self.written.get(place).copied().unwrap_or_default()
    }

    fn slot(&mut self, place: usize) -> &mut Marks {
        if self.places.len() <= place {
            self.places.resize(place + 1, Marks::NONE);
        }
        &mut self.places[place]
    }

    /// Sets the marks of a written variable.
    pub(super) fn set(&mut self, place: usize, marks: Marks) {
        *self.slot(place) = marks;
        if place < LOCALS && !self.outer.is_empty() {
            return;
        }
        if self.written.len() <= place {
            self.written.resize(place + 1, false);
        }
        self.written[place] = true;
    }

    /// Adds marks to a variable that might have been written.
    pub(super) fn add(&mut self, place: usize, marks: Marks) {
        *self.slot(place) |= marks;
    }

    /// Returns the marks of a system variable that a block has written.
    pub(super) fn system(&self, number: u32) -> Option<Marks> {
        self.system.get(&number).map(|marks| *marks | self.any)
    }

    pub(super) fn set_system(&mut self, number: u32, marks: Marks) {
        self.system.insert(number, marks);
    }

    pub(super) fn add_to_any(&mut self, marks: Marks) {
        self.any |= marks;
    }

    /// Returns the number of macro levels above the main program.
    pub(super) fn level(&self) -> usize {
        self.outer.len()
    }

    pub(super) fn push_level(&mut self, locals: [Marks; LOCALS]) {
        let callers = std::array::from_fn(|local| self.places.get(local).copied().unwrap_or_default());
        self.outer.push(callers);
        self.set_locals(locals);
    }

    pub(super) fn pop_level(&mut self) {
        if let Some(callers) = self.outer.pop() {
            self.set_locals(callers);
        }
    }

    fn set_locals(&mut self, locals: [Marks; LOCALS]) {
        for (local, marks) in locals.into_iter().enumerate() {
            *self.slot(local) = marks;
        }
    }
}

/// Number of modal groups, #4000 + n, with an unused one for 0.
const GROUPS: usize = 24;

/// Marks of positions, modes and tables.
#[derive(Clone, Debug, Default)]
pub(super) struct MachineMarks {
    pub(super) axes: [Marks; MAX_AXES],
    /// Shifts of G52 and G92.
    pub(super) shifts: [Marks; MAX_AXES],
    groups: [Marks; GROUPS],
    /// Groups whose state a block has commanded, or is an outside value that is recorded.
    settled: GroupSet,
    /// F, S, T, H and D.
    codes: [Marks; 26],
    /// Those of them that a block has commanded, as bits.
    commanded: u32,
    /// Whether axis words cut, by code 01 and by the canned cycle.
    pub(super) cutting: Marks,
    /// Whether a canned cycle is in force.
    pub(super) in_cycle: Marks,
    /// Levels and pecks of the canned cycle.
    pub(super) cycle: Marks,
    /// Level at which the last block of the cycle has left the drilling axis, until a block of no cycle starts from there.
    pub(super) returned: Marks,
    /// Mirror, scaling, rotation and tilted plane.
    pub(super) transform: Marks,
    /// Tool in the spindle.
    pub(super) tool: Marks,
    /// Tool length offset.
    pub(super) length: Marks,
    /// Cutter radius.
    pub(super) radius: Marks,
    pub(super) spindle: Marks,
    /// Work offsets that blocks have written.
    pub(super) work_table: Marks,
    /// Tool offsets that blocks have written.
    pub(super) tool_table: Marks,
    /// End of the last G31.
    pub(super) skip_position: Marks,
    /// Effects on everything from now on.
    pub(super) rest: Marks,
}

/// Groups that decide where a programmed point is: plane, distance, unit, scaling, work offset, rotation, polar, mirror, dynamic
/// offset.
const COORDINATE_GROUPS: [ModalGroup; 9] = [
    ModalGroup::Plane,
    ModalGroup::Distance,
    ModalGroup::Unit,
    ModalGroup::Scaling,
    ModalGroup::Work,
    ModalGroup::Rotation,
    ModalGroup::Polar,
    ModalGroup::Mirror,
    ModalGroup::DynamicOffset,
];

impl MachineMarks {
    pub(super) fn group(&self, group: ModalGroup) -> Marks {
        self.groups[group.number() as usize]
    }

    pub(super) fn add_to_group(&mut self, group: ModalGroup, marks: Marks) {
        self.groups[group.number() as usize] |= marks;
    }

    /// Sets the marks of the state that a block commands, or that is an outside value.
    pub(super) fn settle_group(&mut self, group: ModalGroup, marks: Marks) {
        self.settled.insert(group);
        self.groups[group.number() as usize] = marks;
    }

    pub(super) fn is_settled(&self, groups: GroupSet) -> bool {
        groups.without(self.settled).is_empty()
    }

    pub(super) fn code(&self, letter: u8) -> Marks {
        self.codes[usize::from(letter - b'A')]
    }

    /// Sets the marks of the word that a block commands.
    pub(super) fn set_code(&mut self, letter: u8, marks: Marks) {
        self.commanded |= 1 << (letter - b'A');
        self.codes[usize::from(letter - b'A')] = marks;
    }

    pub(super) fn add_to_code(&mut self, letter: u8, marks: Marks) {
        self.codes[usize::from(letter - b'A')] |= marks;
    }

    pub(super) fn is_commanded(&self, letter: u8) -> bool {
        self.commanded >> (letter - b'A') & 1 == 1
    }

    /// Returns the marks of the coordinate system of an axis.
    pub(super) fn coordinates(&self, axis: usize) -> Marks {
        self.coordinate_system() | self.shifts[axis]
    }

    /// Returns the marks of what the coordinate systems of all axes have in common.
    pub(super) fn coordinate_system(&self) -> Marks {
        let groups: Marks = COORDINATE_GROUPS.into_iter().map(|group| self.group(group)).collect();
        groups | self.transform | self.work_table
    }

    /// Returns the marks of a motion from or to the current position, without those of the feed.
    pub(super) fn motion(&self) -> Marks {
        let modes: Marks = self.axes.iter().chain(&self.groups).copied().collect();
        let codes: Marks = b"ST".iter().map(|letter| self.code(*letter)).collect();
        modes
            | codes
            | self.cycle
            | self.transform
            | self.tool
            | self.length
            | self.radius
            | self.spindle
            | self.rest
    }

    /// Adds marks to everything.
    pub(super) fn add_to_all(&mut self, marks: Marks) {
        let Self { axes, shifts, groups, codes, .. } = self;
        for one in axes.iter_mut().chain(shifts).chain(groups).chain(codes) {
            *one |= marks;
        }
        for one in [
            &mut self.cutting,
            &mut self.cycle,
            &mut self.in_cycle,
            &mut self.returned,
            &mut self.transform,
            &mut self.tool,
            &mut self.length,
            &mut self.radius,
            &mut self.spindle,
            &mut self.work_table,
            &mut self.tool_table,
            &mut self.skip_position,
        ] {
            *one |= marks;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_beyond_the_last_index_share_it() {
        let marks = Marks::of(3) | Marks::of(400);
        assert!(marks.contains(3) && marks.contains(127) && marks.contains(500) && !marks.contains(4));
        assert!(Marks::NONE.is_none() && !marks.is_none());
    }

    #[test]
    fn a_call_hides_the_marks_of_the_callers_locals() {
        let mut variables = VariableMarks::default();
        variables.set(1, Marks::of(0));
        variables.push_level([Marks::NONE; LOCALS]);
        assert!(variables.get(1).is_none());
        variables.pop_level();
        assert_eq!(variables.get(1), Marks::of(0));
    }
}
