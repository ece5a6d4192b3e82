//! G10: offsets, variables and parameters that a program writes.
use super::data::{Register, STANDARD_SYSTEMS, parameter_bit, system_index};
use super::functions::ExecResult;
use super::notes::Note;
use super::plan::{BlockPlan, TableWrite};
use super::planner::Planner;
use super::variables::{Value, VariableClass};
use super::words::WordNumber;
use gcode_lang::alarm::{Alarm, LocatedAlarm};
use gcode_lang::control::{
    Dialect, OffsetMemory, ParameterError, ParameterId, Settings, changes_motion, is_without_effect,
};
use gcode_lang::program::g_codes::{Effect, OneShot};
use gcode_lang::program::modes::{Distance, WorkSystem};

impl Planner<'_> {
    /// G10: L2 and L20 work offsets, L10 to L13 tool offsets, L50 and L52 parameters, L85 variables.
    pub(super) fn plan_data_input(&self, plan: &mut BlockPlan) -> ExecResult<()> {
        let p = self.words.count(b'P')?;
        let l = self.words.count(b'L')?.ok_or_else(|| self.format_alarm("L is missing"))?;
        let missing_p = |what| move || self.format_alarm(what);
        match l {
            3 | 14 | 50 | 52 | 85 if !self.data.settings.allows_parameter_input => {
                Err(self.format_alarm(&format!("L{l} is not available")))
            }
            2 | 20 => self.plan_work_offset(l, p.ok_or_else(missing_p("P is missing"))? as usize, plan),
            1 | 10..=13 => self.plan_tool_offset(l, p.ok_or_else(missing_p("P is missing"))?, plan),
            21 | 23 if Dialect::FANUC.contains(&self.data.settings.codes) => {
                self.plan_part_error(l, p.ok_or_else(missing_p("P is missing"))?, plan)
            }
            50 | 52 => {
                plan.state.is_in_parameter_input = true;
                Ok(())
            }
            85 => self.plan_punched_variable(p.ok_or_else(missing_p("P, the variable, is missing"))?, plan),
            3 => Err(self.not_simulated("G10 L3 (tool life management)")),
            14 => Err(self.not_simulated("G10 L14 (tool geometry)")),
            _ => Err(self.format_alarm(&format!("L{l} is not available"))),
        }
    }

    fn format_alarm(&self, what: &str) -> LocatedAlarm {
        Alarm::G10Format { what: what.to_owned() }.located_at(self.block)
    }

    /// L2 P0 to P6, L20 P1 and up: work offsets.
    fn plan_work_offset(&self, l: u32, p: usize, plan: &mut BlockPlan) -> ExecResult<()> {
        let offsets = &self.data.offsets.work;
        let (first, number) = if l == 2 { (0, p + 1) } else { (STANDARD_SYSTEMS, p) };
        let end = if l == 2 { STANDARD_SYSTEMS } else { offsets.len() };
        if number == 0 || first + number > end {
            return Err(Alarm::OffsetNumber { number: p as i64 }.located_at(self.block));
        }
        let system = first + number - 1;
        if !self.names_axis() {
            plan.notes.push(Note::NoAxis(100));
        }
        for (axis, _) in self.data.settings.axes.iter() {
            let Some(value) = self.axis_dimension(axis, &plan.state)? else { continue };
            let value = self.table_value(plan, offsets[system][axis], value)?;
            // The zero of G54 is the part's whatever it was.
            let is_set = plan.state.modal.distance == Distance::Absolute
                || system == system_index(WorkSystem::default());
            plan.writes.push(TableWrite::Work { system, axis, value, is_set });
        }
        Ok(())
    }

    /// Returns the new value of an offset: G91 adds to the old one.
    pub(super) fn table_value(&self, plan: &BlockPlan, old: f64, value: f64) -> ExecResult<f64> {
        let is_incremental = plan.state.modal.distance == Distance::Incremental;
        let value = self.data.remove_residue(if is_incremental { old + value } else { value });
        self.locate(self.data.check_offset_range(value))
    }

    /// L1 and L10 to L13: tool offsets.
    fn plan_tool_offset(&self, l: u32, number: u32, plan: &mut BlockPlan) -> ExecResult<()> {
        let memory = self.data.settings.offset_memory;
        let is_known = match l {
            10 => memory != OffsetMemory::A,
            12 | 13 => memory == OffsetMemory::C,
            _ => true,
        };
        if !is_known {
            return Err(self.format_alarm(&format!("L{l} is not available in this tool offset memory")));
        }
        let register = self.data.table(Register::of_data_input(l));
        let old = self.locate(self.data.offsets.tool(register, number))?;
        if number == 0 {
            return Err(Alarm::OffsetNumber { number: 0 }.located_at(self.block));
        }
        let value = self.dimension(b'R', &plan.state)?.ok_or_else(|| self.format_alarm("R is missing"))?;
        let value = self.table_value(plan, old, value)?;
        plan.writes.push(TableWrite::Tool { register, number, value });
        Ok(())
    }

    /// L85: a variable, from the bits of its value.
    fn plan_punched_variable(&self, number: u32, plan: &mut BlockPlan) -> ExecResult<()> {
        if !matches!(self.registers.variables.classify(number), VariableClass::Common(_)) {
            return Err(Alarm::NoSuchVariable { number: i64::from(number) }.located_at(self.words.span(b'P')));
        }
        let missing = || self.format_alarm("L85 needs sixteen digits in brackets");
        let bits = self.words.punched_value.ok_or_else(missing)?;
        let value = match f64::from_bits(bits) {
            value if value.is_finite() => Value::Number(value),
            // All bits set are a vacant variable.
            _ if bits == u64::MAX => Value::Vacant,
            _ => return Err(self.format_alarm("the digits are not a number")),
        };
        plan.writes.push(TableWrite::Variable { number, value });
        Ok(())
    }

    /// Plans a block between G10 L52 and G11: `N_ R_`, with P for an axis and Q for a bit.
    pub(super) fn plan_parameter(&self, number: Option<u32>, plan: &mut BlockPlan) -> ExecResult<()> {
        let format_alarm =
            |what: &str| Alarm::ParameterFormat { what: what.to_owned() }.located_at(self.block);
        let mut codes = self.words.g_codes();
        match (codes.next(), codes.next()) {
            (None, _) => {}
            (Some(code), None) if code.effect == Effect::OneShot(OneShot::DataInputEnd) => {
                plan.state.is_in_parameter_input = false;
                return match self.words.first_unused_word() {
                    None if self.lowered_words.call().is_none() => Ok(()),
                    _ => Err(format_alarm("words in a block with G11")),
                };
            }
            _ => return Err(format_alarm("another G code before G11")),
        }
        if !self.words.m_codes.is_empty() || self.lowered_words.call().is_some() {
            return Err(format_alarm("an M code before G11"));
        }
        let number = number.and_then(|number| u16::try_from(number).ok());
        let number =
            number.ok_or_else(|| format_alarm("N, the parameter's number, is missing or too large"))?;
        let (raw, _) = self.words.get(b'R').ok_or_else(|| format_alarm("R is missing"))?;
        let axis = self.words.count(b'P')?.map(|axis| self.data.axis_of(f64::from(axis)));
        let axis = axis.transpose().map_err(|_| format_alarm("P is not an axis"))?;
        let bit = self.words.count(b'Q')?.map(|bit| parameter_bit(f64::from(bit)));
        let bit = bit.map(|bit| bit.ok_or_else(|| format_alarm("Q is not 0 to 7"))).transpose()?;
        if self.words.first_unused_word().is_some() {
            return Err(format_alarm("other words than N P Q R"));
        }
        let id = ParameterId { number, bit, axis };
        if let WordNumber::Literal(literal) = raw
            && literal.places.is_none()
            && literal.digits != 0
            && Settings::is_length_parameter(id)
        {
            let what = format!("R without a decimal point for parameter {number}, a length");
            return Err(Alarm::NotSimulated { what }.located_at(self.words.span(b'R')));
        }
        let value = raw.value();
        if self.data.settings.clone().set_parameter(id, value) != Err(ParameterError::MissingBit) {
            return self.write_parameter(id, value, plan);
        }
        // A byte: the digits of R are its bits, bit 0 the last.
        let mut bits = value;
        for bit in 0..8 {
            self.write_parameter(ParameterId { bit: Some(bit), ..id }, bits % 10.0, plan)?;
            bits = (bits / 10.0).trunc();
        }
        if bits != 0.0 {
            return Err(format_alarm("the parameter has eight bits"));
        }
        Ok(())
    }

    /// Plans the value of a parameter; one that the simulator does not know is stored for PRM.
    fn write_parameter(&self, id: ParameterId, value: f64, plan: &mut BlockPlan) -> ExecResult<()> {
        let fault = match self.data.settings.clone().set_parameter(id, value) {
            Ok(()) => {
                plan.writes.push(TableWrite::Parameter { id, value, has_no_effect: false });
                return Ok(());
            }
            Err(ParameterError::ReadOnly) => {
                return Err(self.not_simulated(format!("a change of parameter {}", id.number)));
            }
            Err(ParameterError::Unknown)
                if changes_motion(id.number) && (id.bit.is_none() || value != 0.0) =>
            {
                return Err(self.not_simulated(format!("a change of parameter {}", id.number)));
            }
            Err(ParameterError::Unknown | ParameterError::MissingBit) => {
                let note = if is_without_effect(id.number) {
                    Note::ParameterWithoutEffect(id.number)
                } else {
                    Note::ParameterUnsimulated(id.number)
                };
                if !plan.notes.contains(&note) {
                    plan.notes.push(note);
                }
                plan.writes.push(TableWrite::Parameter { id, value, has_no_effect: true });
                return Ok(());
            }
            Err(ParameterError::MissingAxis) => "P, the axis, is missing",
            Err(ParameterError::UnexpectedAxis) => "the parameter has no axis P",
            Err(ParameterError::UnexpectedBit) => "the parameter has no bit Q",
            Err(ParameterError::InvalidValue) => "the value is not allowed for this parameter",
        };
        Err(Alarm::ParameterFormat { what: fault.to_owned() }.located_at(self.block))
    }
}
