//! G10: offsets, parameters and variables that a program writes.
use super::checked::{ExecResult, locate};
use super::offsets::Register;
use super::plan::{BlockPlan, TableWrite};
use super::planner::Planner;
use super::variables::{Value, VariableClass};
use super::words::BlockWords;
use gcode_lang::alarm::Alarm;
use gcode_lang::program::modes::Distance;
use gcode_lang::source::Span;

impl Planner<'_> {
    /// G10: L2 and L20 work offsets, L10 to L13 tool offsets, L50 and L52 parameters, L85
    /// variables.
    pub(super) fn plan_data_input(
        &self,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
        span: Span,
    ) -> ExecResult<()> {
        let format = |what: &str| format(what).located_at(span);
        let p = block_words.count(b'P')?;
        let l = block_words.count(b'L')?.ok_or_else(|| format("L is missing"))?;
        match l {
            3 | 14 | 50 | 52 | 85 if !self.data.settings.allows_parameter_input => {
                Err(format(&format!("L{l} is not available")))
            }
            2 | 20 => {
                self.plan_work_offset(l, p.ok_or_else(|| format("P is missing"))?, block_words, plan, span)
            }
            1 | 10..=13 => {
                self.plan_tool_offset(l, p.ok_or_else(|| format("P is missing"))?, block_words, plan, span)
            }
            50 | 52 => {
                plan.state.is_in_parameter_input = true;
                Ok(())
            }
            85 => {
                let number = p.ok_or_else(|| format("P, the variable, is missing"))?;
                self.plan_punched_variable(number, block_words, plan, span)
            }
            3 => Err(Alarm::NotSimulated { what: "G10 L3 (tool life management)".into() }.located_at(span)),
            14 => Err(Alarm::NotSimulated { what: "G10 L14 (tool geometry)".into() }.located_at(span)),
            _ => Err(format(&format!("L{l} is not available"))),
        }
    }

    /// L2 P0 to P6, L20 P1 and up: work offsets.
    fn plan_work_offset(
        &self,
        l: u32,
        p: u32,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
        span: Span,
    ) -> ExecResult<()> {
        let p = p as usize;
        let is_incremental = plan.state.modal.distance == Distance::Incremental;
        let system = match l {
            2 if p <= 6 => p,
            20 if (1..=self.data.offsets.additional.len()).contains(&p) => 6 + p,
            _ => return Err(Alarm::OffsetNumber { number: p as i64 }.located_at(span)),
        };
        for (axis, letter) in self.data.settings.axes.iter() {
            let Some(value) = self.data.dimension(block_words, letter as u8, &plan.state)? else { continue };
            let old = if is_incremental { self.data.offsets.work(system)[axis] } else { 0.0 };
            plan.writes.push(TableWrite::Work {
                system,
                axis,
                value: locate(self.data.check_offset_range(self.data.remove_residue(old + value)), span)?,
            });
        }
        Ok(())
    }

    /// L1 and L10 to L13: tool offsets.
    fn plan_tool_offset(
        &self,
        l: u32,
        number: u32,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
        span: Span,
    ) -> ExecResult<()> {
        let register = match l {
            10 => Register::HGeometry,
            12 => Register::DGeometry,
            13 => Register::DWear,
            _ => Register::HWear,
        };
        let is_incremental = plan.state.modal.distance == Distance::Incremental;
        let old = locate(self.data.offsets.tool(register, number), span)?;
        if number == 0 {
            return Err(Alarm::OffsetNumber { number: 0 }.located_at(span));
        }
        let value = self
            .data
            .dimension(block_words, b'R', &plan.state)?
            .ok_or_else(|| format("R is missing").located_at(span))?;
        let value = locate(
            self.data.check_offset_range(self.data.remove_residue(if is_incremental {
                old + value
            } else {
                value
            })),
            span,
        )?;
        plan.writes.push(TableWrite::Tool { register, number, value });
        Ok(())
    }

    /// L85: a variable, from the bits of its value.
    fn plan_punched_variable(
        &self,
        number: u32,
        block_words: &BlockWords,
        plan: &mut BlockPlan,
        span: Span,
    ) -> ExecResult<()> {
        if !matches!(self.registers.variables.classify(number), VariableClass::Common(_)) {
            return Err(
                Alarm::NoSuchVariable { number: i64::from(number) }.located_at(block_words.span(b'P'))
            );
        }
        let bits = block_words
            .punched_value
            .ok_or_else(|| format("L85 needs sixteen digits in brackets").located_at(span))?;
        let value = match f64::from_bits(bits) {
            value if value.is_finite() => Value::Number(value),
            // All bits set are a vacant variable.
            _ if bits == u64::MAX => Value::Vacant,
            _ => return Err(format("the digits are not a number").located_at(span)),
        };
        plan.writes.push(TableWrite::Variable { number, value });
        Ok(())
    }
}

pub(super) fn format(what: &str) -> Alarm {
    Alarm::G10Format { what: what.to_owned() }
}
