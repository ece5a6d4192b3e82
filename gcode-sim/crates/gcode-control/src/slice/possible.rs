//! Effects of operations that outside values decide, whether the run executes them or not.
use super::moves::is_drilling;
use super::possible_motion::PossibleMotion;
use super::{Marks, Slice};
use crate::registers::Registers;
use gcode_lang::motion::SpindleDirection;
use gcode_lang::program::g_codes::Effect;
use gcode_lang::program::m_codes::{self, MCodeEffect};
use gcode_lang::program::modes::{ModalGroup, Motion, Plane};
use gcode_lang::program::{AssignmentTarget, OpKind, Slot, Statement, WordOperand, Words};

impl Slice {
    /// Adds the marks of a condition to everything that an assignment under it can write.
    pub(super) fn add_possible_assignment(
        &mut self,
        registers: &Registers,
        statement: &Statement,
        marks: Marks,
    ) {
        match statement {
            Statement::AssignDirect(assign) => self.variables.add(usize::from(assign.variable), marks),
            Statement::Assign { target: AssignmentTarget::Slot(Slot::Free(place)), .. } => {
                self.variables.add(usize::from(*place), marks);
            }
            Statement::Assign { target: AssignmentTarget::Slot(slot), .. } => {
                self.add_to_variable(registers, slot.number(), marks);
            }
            Statement::Assign { .. } => {
                self.variables.add_to_any(marks);
                self.machine.add_to_all(marks);
            }
            Statement::Assignments(all) => {
                all.iter().for_each(|one| self.add_possible_assignment(registers, one, marks));
            }
            Statement::IfThen { then, .. } => self.add_possible_assignment(registers, then, marks),
            _ => {}
        }
    }

    /// Adds the marks of a condition to everything that an operation under it can change; `motion` is in force before it, and
    /// afterwards behind it.
    pub(super) fn add_possible_effects(
        &mut self,
        registers: &Registers,
        kind: &OpKind,
        marks: Marks,
        motion: &mut PossibleMotion,
    ) {
        match kind {
            OpKind::Empty | OpKind::Alarm(_) => {}
            OpKind::AssignDirect(assign) => self.variables.add(usize::from(assign.variable), marks),
            OpKind::Statement(statement) => self.add_possible_assignment(registers, statement, marks),
            OpKind::Words(words) => {
                *motion = motion.behind_words(registers, words);
                self.add_possible_words(registers, words, marks, *motion);
            }
            OpKind::If { then, .. } => {
                let before = *motion;
                self.add_possible_effects(registers, then, marks, motion);
                *motion = motion.or(before);
            }
        }
    }

    /// Adds the marks of a condition to everything that a block of words under it can change; `motion` is in force in the
    /// block.
    pub(super) fn add_possible_words(
        &mut self,
        registers: &Registers,
        words: &Words,
        marks: Marks,
        motion: PossibleMotion,
    ) {
        let settings = &registers.data.settings;
        if words.call().is_some() || !settings.code_calls.is_empty() || words.punched_value().is_some() {
            self.variables.add_to_any(marks);
            self.machine.add_to_all(marks);
            self.machine.rest |= marks;
            self.further |= marks;
            return;
        }
        // A rapid cuts nothing; another code of the block may make its axis words more than a move.
        let is_rapid = !motion.cuts()
            && words.list.iter().all(|word| match &word.value {
                WordOperand::G(_, found) => found.row_for(settings.codes).is_some_and(|row| {
                    matches!(row.effect, Effect::Motion(_) | Effect::Distance(_) | Effect::Cycle(None))
                }),
                _ => word.letter != b'G',
            });
        if motion.drills() {
            // The block leaves the drilling axis at another level.
            self.machine.returned |= marks;
        }
        for word in &words.list {
            if let Some(axis) = settings.axes.find(word.letter) {
                self.machine.axes[axis] |= marks;
                if !is_rapid {
                    self.further |= marks;
                }
                let planes = [Plane::Xy, Plane::Zx, Plane::Yz];
                if planes.into_iter().any(|plane| is_drilling(settings, plane, word.letter)) {
                    self.machine.cycle |= marks;
                }
                continue;
            }
            match (word.letter, &word.value) {
                (b'G', WordOperand::G(_, found)) => {
                    let row = found.row_for(settings.codes);
                    let begins_cut = row.is_some_and(|row| match row.effect {
                        Effect::Motion(motion) => motion != Motion::Rapid,
                        Effect::Cycle(cycle) => cycle.is_some(),
                        _ => false,
                    });
                    if begins_cut {
                        self.machine.cutting |= marks;
                    }
                    let may_drill = registers.state.modal.cycle.is_some() || !self.machine.in_cycle.is_none();
                    match row.map(|row| &row.effect) {
                        Some(Effect::Cycle(Some(_))) => self.machine.in_cycle |= marks,
                        Some(Effect::Cycle(None) | Effect::Motion(_)) if may_drill => {
                            self.machine.in_cycle |= marks;
                        }
                        _ => {}
                    }
                    match row.and_then(|row| row.effect.group()) {
                        Some(group) => {
                            self.machine.add_to_group(group, marks);
                            self.machine.cycle |= marks;
                            if group == ModalGroup::Length {
                                self.machine.length |= marks;
                            }
                        }
                        None => self.machine.add_to_all(marks),
                    }
                }
                (b'M', WordOperand::Literal(number)) => {
                    self.add_possible_code(registers, number.value(), marks)
                }
                (b'M', WordOperand::Number(number)) => self.add_possible_code(registers, *number, marks),
                (b'G' | b'M', _) => {
                    self.machine.add_to_all(marks);
                    self.machine.rest |= marks;
                }
                (letter @ (b'F' | b'S' | b'T' | b'H' | b'D'), _) => {
                    self.machine.add_to_code(letter, marks);
                    self.machine.length |= marks;
                    self.machine.radius |= marks;
                }
                _ => self.machine.cycle |= marks,
            }
        }
    }

    /// Adds marks to what an M code can change.
    fn add_possible_code(&mut self, registers: &Registers, code: f64, marks: Marks) {
        match m_codes::find(code as u32, registers.data.settings.codes) {
            Some(
                MCodeEffect::SpindleForward
                | MCodeEffect::SpindleReverse
                | MCodeEffect::SpindleStop
                | MCodeEffect::Orient
                | MCodeEffect::RigidTapping,
            ) => self.machine.spindle |= marks,
            Some(MCodeEffect::ToolChange) => self.machine.tool |= marks,
            Some(MCodeEffect::CoolantOn | MCodeEffect::CoolantOff | MCodeEffect::NoEffect) => {}
            // At most the spindle stops; one that the block starts itself has the marks already.
            Some(MCodeEffect::Stop | MCodeEffect::OptionalStop) => {
                if registers.state.spindle != SpindleDirection::Off {
                    self.machine.spindle |= marks;
                }
            }
            Some(_) => self.machine.add_to_all(marks),
            None if self.stated.codes.contains(&(code as u32)) => {}
            None => self.machine.rest |= marks,
        }
    }
}
