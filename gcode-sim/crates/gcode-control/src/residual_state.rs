//! What a run leaves behind for the next program: variables, modes, offsets, parameters, outputs and counters.
use super::control::Control;
use super::data::ControlData;
use super::offsets::{Offsets, Register};
use gcode_lang::control::ParameterId;
use gcode_lang::motion::Position;

/// Something that is no longer as it is when the control is switched on.
#[derive(Clone, Debug, PartialEq)]
pub struct ResidualValue {
    pub kind: ResidualKind,
    /// As the program or the screen calls it: `#500`, `G54 X`, `H5 geometry`.
    pub name: String,
    /// Lengths in mm, angles in degrees.
    pub value: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResidualKind {
    /// A common variable.
    Variable,
    Mode,
    WorkOffset,
    ToolOffset,
    /// Written by G10.
    Parameter,
    /// Output signals.
    Output,
    /// Parts made and wanted.
    Counter,
}

/// What a [`ResidualValue`] of the kind [`ResidualKind::Mode`] is called.
pub fn mode_name(group: u32) -> String {
    format!("the mode of group {group:02}")
}

impl Control {
    /// All that isn't vacant or 0; modes always.
    pub fn residual_values(&self) -> Vec<ResidualValue> {
        let executor = &self.executor;
        let mut all = Vec::new();
        let mut push = |kind, name: String, value: f64| all.push(ResidualValue { kind, name, value });
        for (number, value) in self.variables().filter(|(number, _)| *number >= 100) {
            push(ResidualKind::Variable, format!("#{number}"), value);
        }
        for group in 1..=22 {
            if let Ok(value) = executor.registers.read_variable(4000 + group) {
                push(ResidualKind::Mode, mode_name(group), value.number());
            }
        }
        let shifts = [
            ("G52".to_owned(), &executor.registers.state.local_offset),
            ("G92".to_owned(), &executor.registers.state.coordinate_shift),
        ];
        for (system, values) in executor.registers.data.offsets.systems().chain(shifts) {
            for (axis, letter) in
                executor.registers.data.settings.axes.iter().filter(|(axis, _)| values[*axis] != 0.0)
            {
                push(ResidualKind::WorkOffset, format!("{system} {letter}"), values[axis]);
            }
        }
        for (name, values) in executor.registers.data.offsets.tools() {
            for (number, value) in values.iter().enumerate().filter(|(_, value)| **value != 0.0) {
                push(ResidualKind::ToolOffset, name(number), *value);
            }
        }
        for (place, value) in &executor.registers.data.parameters {
            push(ResidualKind::Parameter, executor.registers.data.parameter_name(*place), *value);
        }
        if executor.registers.panel.outputs != 0 {
            push(ResidualKind::Output, "#1132".to_owned(), f64::from(executor.registers.panel.outputs));
        }
        for (number, value) in [3901, 3902].into_iter().zip(executor.registers.panel.part_counters) {
            push(ResidualKind::Counter, format!("#{number}"), value);
        }
        all
    }
}

impl ControlData {
    /// `parameter 3401#0`, `parameter 1320 X`.
    fn parameter_name(&self, place: ParameterId) -> String {
        let bit = place.bit.map(|bit| format!("#{bit}")).unwrap_or_default();
        let axis = place.axis.map(|axis| format!(" {}", self.settings.axes.letter(axis))).unwrap_or_default();
        format!("parameter {}{bit}{axis}", place.number)
    }
}

type ToolName = fn(usize) -> String;

impl Offsets {
    /// Every work coordinate system by its name.
    fn systems(&self) -> impl Iterator<Item = (String, &Position)> {
        let external = std::iter::once(("the external work offset".to_owned(), self.external()));
        let standard = self.standard().iter().enumerate().map(|(n, values)| (format!("G{}", 54 + n), values));
        let additional = self.additional.iter().enumerate();
        external.chain(standard).chain(additional.map(|(n, values)| (format!("G54.1 P{}", n + 1), values)))
    }

    /// Every table of tool offsets, and how one of its rows is called.
    fn tools(&self) -> [(ToolName, &[f64]); 4] {
        [
            (|n| format!("H{n} geometry"), self.table(Register::HGeometry)),
            (|n| format!("H{n} wear"), self.table(Register::HWear)),
            (|n| format!("D{n} geometry"), self.table(Register::DGeometry)),
            (|n| format!("D{n} wear"), self.table(Register::DWear)),
        ]
    }
}
