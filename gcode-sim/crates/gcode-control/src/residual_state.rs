//! State that a run leaves for the next program: variables, modes, offsets, parameters, outputs and counters.
use super::control::Control;
use super::data::{STANDARD_SYSTEMS, system_index};
use super::state::{Modal, State};
use gcode_lang::control::{Dialect, ParameterId};
use gcode_lang::program::modes::{DynamicOffset, GROUPS, ModalGroup, WorkSystem};

/// Value that is no longer as it is when the control is switched on.
#[derive(Clone, Debug, PartialEq)]
pub struct ResidualValue {
    /// Kind of the value.
    pub kind: ResidualKind,
    /// Name that the program or the screen has for it: `#500`, `G54 X`, `H5 geometry`.
    pub name: String,
    /// Value; lengths in mm, angles in degrees.
    pub value: f64,
}

/// Kind of a [`ResidualValue`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResidualKind {
    /// Common variable, or #4130 in an additional work coordinate system.
    Variable,
    /// G code in effect in a modal group.
    Mode,
    /// Work offset, or the offset of G52 or G92.
    WorkOffset,
    /// Tool offset.
    ToolOffset,
    /// Parameter that G10 has written.
    Parameter,
    /// Output signals.
    Output,
    /// Parts made and parts required.
    Counter,
}

/// Returns the name of a [`ResidualValue`] of the kind [`ResidualKind::Mode`].
pub fn mode_name(group: u32) -> String {
    format!("the mode of group {group:02}")
}

impl State {
    /// Returns the state at the start of a program behind another that has ended in the state `left`.
    fn behind(&self, left: &Self, keeps_modes: bool) -> Self {
        let State { g92_shift, unknown_g92_shift, .. } = *left;
        let shifted = Self { g92_shift, unknown_g92_shift, ..*self };
        if !keeps_modes {
            return shifted;
        }
        let Modal { unit, feed_mode, scaling, rotation, polar, mirror, .. } = left.modal;
        Self {
            modal: Modal { unit, feed_mode, scaling, rotation, polar, mirror, ..self.modal },
            transform: left.transform,
            polar: left.polar,
            g52_shift: left.g52_shift,
            ..shifted
        }
    }
}

impl Control {
    /// Takes over what another run has left for the next start: the tables of offsets, the shift of G92, and, on a control whose
    /// M30 keeps modes (3402#6 CLR and 1202#3 RLC at 0), G52, G16, G51, G51.1, G68, the unit and the mode of the feed.
    pub fn take_left_state(&mut self, left: &Self) {
        let keeps_modes = self.keeps_modes();
        let (own, left) = (&mut self.executor.registers, &left.executor.registers);
        own.data.offsets.clone_from(&left.data.offsets);
        own.data.set_offsets.clone_from(&left.data.set_offsets);
        *own.state = own.state.behind(&left.state, keeps_modes);
        own.update_after_offset_change();
    }

    /// Returns true if [`Self::take_left_state`] would change nothing but which offsets count as set.
    pub fn has_state_of(&self, left: &Self) -> bool {
        let (own, other) = (&self.executor.registers, &left.executor.registers);
        own.data.offsets == other.data.offsets
            && *own.state == own.state.behind(&other.state, self.keeps_modes())
    }

    fn keeps_modes(&self) -> bool {
        self.executor.registers.data.settings.dialect != Dialect::HaasNgc
    }

    /// Returns all values that aren't vacant or 0, and all modes.
    pub fn residual_values(&self) -> Vec<ResidualValue> {
        let registers = &self.executor.registers;
        let (data, state) = (&registers.data, &registers.state);
        let axes = &data.settings.axes;
        let mut all = Vec::new();
        let mut push = |kind, name: String, value: f64| all.push(ResidualValue { kind, name, value });
        for (number, value) in self.variables().filter(|(number, _)| *number >= 100) {
            push(ResidualKind::Variable, format!("#{number}"), value);
        }
        // A dynamic work offset that is off is none, as a shift of 0.
        let is_off = |group| group == ModalGroup::DynamicOffset && state.modal.dynamic == DynamicOffset::Off;
        for group in GROUPS.iter().filter(|group| !is_off(**group)) {
            let code = state.code_in_force(*group);
            push(ResidualKind::Mode, mode_name(group.number()), f64::from(code) / 10.0);
        }
        if let WorkSystem::Additional(number) = state.modal.work {
            push(ResidualKind::Variable, "#4130".to_owned(), f64::from(number));
        }
        let system_name = |index| match index {
            0 => "the external work offset".to_owned(),
            _ if index < STANDARD_SYSTEMS => format!("G{}", 53 + index),
            _ => {
                let number = (index - system_index(WorkSystem::Additional(0))) as u16;
                WorkSystem::Additional(number).name(data.settings.dialect)
            }
        };
        let systems =
            data.offsets.work.iter().enumerate().map(|(index, values)| (system_name(index), values));
        let shifts = [("G52".to_owned(), &state.g52_shift), ("G92".to_owned(), &state.g92_shift)];
        for (system, values) in systems.chain(shifts) {
            for (axis, letter) in axes.iter().filter(|(axis, _)| values[*axis] != 0.0) {
                push(ResidualKind::WorkOffset, format!("{system} {letter}"), values[axis]);
            }
        }
        let tables = [("H", "geometry"), ("H", "wear"), ("D", "geometry"), ("D", "wear")];
        for ((letter, table), values) in tables.iter().zip(&data.offsets.tools) {
            for (number, value) in values.iter().enumerate().filter(|(_, value)| **value != 0.0) {
                push(ResidualKind::ToolOffset, format!("{letter}{number} {table}"), *value);
            }
        }
        for (ParameterId { number, bit, axis }, value) in &data.parameters {
            let bit = bit.map(|bit| format!("#{bit}")).unwrap_or_default();
            let axis = axis.map(|axis| format!(" {}", axes.letter(axis))).unwrap_or_default();
            push(ResidualKind::Parameter, format!("parameter {number}{bit}{axis}"), *value);
        }
        if registers.panel.outputs != 0 {
            push(ResidualKind::Output, "#1132".to_owned(), f64::from(registers.panel.outputs));
        }
        for (number, value) in [3901, 3902].into_iter().zip(registers.panel.part_counters) {
            push(ResidualKind::Counter, format!("#{number}"), value);
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Limits, Outcome, Value};
    use gcode_lang::control::{Dialect, Kinematics, Settings};
    use gcode_lang::program::g_codes::{Effect, find, name};
    use gcode_lang::program::modes::{Mirror, Rotation, Scaling};
    use gcode_lang::program::{Memory, NoLibrary};

    /// The control of a family after a program of one block.
    fn after(dialect: Dialect, block: &str) -> Control {
        let mut settings = Settings::default();
        settings.apply_dialect(dialect);
        let (table, head, direction) = (Vec::new(), Vec::new(), [0.0, 0.0, 1.0]);
        settings.kinematics = Some(Kinematics { table, head, direction, pivot: 0.0 });
        let mut memory = Memory::default();
        memory.load("O1.nc", format!("O1\n{block}\n").into_bytes());
        let mut control = Control::new(memory, settings);
        let outcome = control.run(Limits::default(), &mut NoLibrary, &mut ());
        assert!(matches!(outcome, Outcome::End), "{block} on {dialect:?}: {outcome:?}");
        control
    }

    #[test]
    fn every_modal_code_is_read_back_by_its_group_and_is_a_residual_value() {
        for dialect in Dialect::ALL_CONTROLS.iter().copied() {
            for row in (0..10_000).filter_map(|code| find(code).row_for(dialect)) {
                let Some(group) = row.group() else { continue };
                let (words, code) = match row.effect {
                    Effect::AdditionalWork => (" P1", 541),
                    Effect::NumberedWork(_) => ("", 541),
                    // A Haas takes P with a point, a Fanuc without one.
                    Effect::Scaling(Scaling::On) if dialect == Dialect::HaasNgc => (" P2.", row.code),
                    Effect::Scaling(Scaling::On) => (" P2000", row.code),
                    Effect::Mirror(mirror) => (if mirror == Mirror::On { " X0" } else { "" }, mirror.code()),
                    Effect::Rotation(Rotation::Off) => ("", Rotation::Off.code()),
                    Effect::Rotation(Rotation::Tilted) => (" X0 Y0 Z0 I0 J0 K0", row.code),
                    _ => ("", row.code),
                };
                let plane = match row.effect {
                    Effect::Rotation(Rotation::TiltedFurther) => "G68.2 J30.\n",
                    _ => "",
                };
                let (block, expected) = (format!("{plane}{}{words}", name(row.code)), f64::from(code) / 10.0);
                let control = after(dialect, &block);
                // A Haas has no number for G154, a Fanuc none for G54.2 and G54.4.
                let is_fixture = matches!(row.effect, Effect::UnstatedOffset(_));
                if (code != 541 || dialect != Dialect::HaasNgc) && !is_fixture {
                    assert_eq!(control.variable(4000 + group), Ok(Value::Number(expected)), "{block}");
                }
                let residual =
                    ResidualValue { kind: ResidualKind::Mode, name: mode_name(group), value: expected };
                let is_off = row.effect == Effect::DynamicOffset(DynamicOffset::Off);
                assert_eq!(control.residual_values().contains(&residual), !is_off, "{block} on {dialect:?}");
            }
        }
    }

    #[test]
    fn the_number_of_an_additional_work_coordinate_system_is_a_residual_value() {
        let number = |dialect, block| {
            let values = after(dialect, block).residual_values();
            values.into_iter().find(|value| value.name == "#4130").map(|value| value.value)
        };
        assert_eq!(number(Dialect::Fanuc31i, "G54"), None);
        assert_eq!(number(Dialect::Fanuc31i, "G54.1 P3"), Some(3.0));
        assert_eq!(number(Dialect::HaasNgc, "G154 P9"), Some(9.0));
        assert_eq!(number(Dialect::HaasNgc, "G112"), Some(3.0));
    }
}
