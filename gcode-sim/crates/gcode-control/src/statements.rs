//! Macro statements: assignments, branches and loops. They never tell the machine anything, but for #3000 and #3006.
use super::checked::{ExecResult, integer, locate, variable_number};
use super::evaluation::RoundingTarget;
use super::executor::Executor;
use super::loop_detection::LoopDetector;
use super::notes::Note;
use super::print::{MAX_PRINTED_BYTES, binary, decimal};
use super::variables::{Value, VariableClass};
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{EventKind, EventSink, StopKind};
use gcode_lang::program::{Assign, OpIndex, Operand, PrintPart, Program, Slot, Statement};
use gcode_lang::source::{Span, Spanned};
use gcode_lang::syntax::ast::PrintKind;

/// No control has numbers beyond this for alarms of its programs.
const MAX_ALARM_NUMBER: u16 = 4095;

impl Executor {
    /// An assignment of what code gives, in the loop over the blocks itself.
    #[inline(always)]
    pub(super) fn assign(&mut self, Assign { variable: place, code }: &Assign) -> ExecResult<()> {
        let value = self.registers.evaluate(code, RoundingTarget::Increment)?;
        self.registers.variables.set_free(*place, value);
        Ok(())
    }

    /// As [`Executor::assign`], elsewhere.
    #[inline(never)]
    pub(super) fn assign_out_of_line(&mut self, compute: &Assign) -> ExecResult<()> {
        self.assign(compute)
    }

    /// Does one statement. The frame already stands at the next block; jumps change that. What the turns of most loops
    /// consist of is done in the loop over the blocks itself.
    #[inline(always)]
    pub(super) fn statement<S: EventSink>(
        &mut self,
        program: &Program,
        statement: &Statement,
        loop_detector: &mut LoopDetector,
        sink: &mut S,
    ) -> ExecResult<()> {
        match statement {
            Statement::While { condition, number, end } => {
                let is_true = self.registers.evaluate_condition(condition)?;
                self.begin_iteration(*number, *end, is_true);
            }
            Statement::End { number, start } => {
                self.end_iteration(*number, *start)?;
                loop_detector.record_jump(self);
            }
            _ => return self.any_statement(program, statement, loop_detector, sink),
        }
        Ok(())
    }

    /// As [`Executor::statement`], away from the loop over the blocks.
    #[inline(never)]
    pub(super) fn any_statement<S: EventSink>(
        &mut self,
        program: &Program,
        statement: &Statement,
        loop_detector: &mut LoopDetector,
        sink: &mut S,
    ) -> ExecResult<()> {
        let next = self.flow.frame.next;
        match statement {
            Statement::AssignFree(compute) => self.assign_out_of_line(compute)?,
            Statement::Assign { target, target_span, value, text } => {
                let slot = locate(self.registers.resolve_target(target), *target_span)?;
                let value = self.registers.operand(value)?;
                self.write(slot, value, text.as_deref(), *target_span, sink)?;
            }
            Statement::Assignments(assignments) => {
                for one in assignments {
                    self.any_statement(program, one, loop_detector, sink)?;
                }
            }
            Statement::Goto(to) => self.goto(program, to)?,
            Statement::IfGoto { condition, to } => {
                if self.registers.evaluate_condition(condition)? {
                    self.goto(program, to)?;
                }
            }
            Statement::IfThen { condition, then } => {
                if self.registers.evaluate_condition(condition)? {
                    // An assignment or a GOTO: lowering lets nothing else stand here.
                    return self.any_statement(program, then, loop_detector, sink);
                }
            }
            Statement::While { condition, number, end } => {
                let is_true = self.registers.evaluate_condition(condition)?;
                self.begin_iteration(*number, *end, is_true);
            }
            Statement::Do { number, end } => self.begin_iteration(*number, *end, true),
            Statement::End { number, start } => self.end_iteration(*number, *start)?,
            Statement::SetNames { first, names } => self.name_variables(first, names)?,
            Statement::Print { kind, parts } => self.print(*kind, parts, self.flow.block)?,
            Statement::OpenOutput => self.set_output_open(true),
            Statement::CloseOutput => self.set_output_open(false),
            Statement::Alarm(alarm) => return Err(alarm.clone()),
        }
        if self.flow.frame.next < next {
            loop_detector.record_jump(self);
        }
        Ok(())
    }

    /// The DO or WHILE of a loop, `end` the operation of its END.
    #[inline]
    fn begin_iteration(&mut self, number: u8, end: OpIndex, is_true: bool) {
        let frame = &mut self.flow.frame;
        let open = &mut frame.loops[usize::from(number) - 1];
        if is_true {
            *open = Some((frame.next - 1, end));
        } else {
            *open = None;
            frame.jump(end + 1);
        }
    }

    /// The END of a loop, `start` the operation of its DO or WHILE.
    #[inline]
    fn end_iteration(&mut self, number: u8, start: OpIndex) -> ExecResult<()> {
        let open = self.flow.frame.loops[usize::from(number) - 1];
        if open.is_none_or(|(first, _)| first != start) {
            return Err(Alarm::MissingDo { number }.located_at(self.flow.block));
        }
        self.flow.frame.next = start;
        Ok(())
    }

    #[inline(never)]
    fn name_variables(&mut self, first: &Operand, names: &[String]) -> ExecResult<()> {
        let first = locate(variable_number(self.registers.operand(first)?), self.flow.block)?;
        locate(self.registers.variables.set_names(first, names), self.flow.block)
    }

    #[inline(never)]
    fn goto(&mut self, program: &Program, to: &Spanned<Operand>) -> ExecResult<()> {
        let value = self.registers.operand(&to.node)?.number();
        let number = integer(value).map_err(|alarm| alarm.located_at(to.span))?;
        if self.registers.data.settings.undocumented.minus_searches_up && (-99_999_999..0).contains(&number) {
            let target = program.find_number_above(number.unsigned_abs() as u32, self.flow.frame.next);
            let missing = || self.missing_target(number.unsigned_abs() as u32).located_at(to.span);
            let target = target.ok_or_else(missing)?;
            self.flow.frame.jump(target);
            return Ok(());
        }
        if !(1..=99_999_999).contains(&number) {
            return Err(Alarm::SequenceNumberRange { number }.located_at(to.span));
        }
        let number = number as u32;
        let from = if self.registers.data.settings.undocumented.goto_takes_first_number {
            0
        } else {
            self.flow.frame.next
        };
        let Some(target) = program.find_number(number, from) else {
            return Err(self.missing_target(number).located_at(to.span));
        };
        self.note_ambiguous_jump(program, number, target);
        self.flow.frame.jump(target);
        Ok(())
    }

    /// A jump that a control may take elsewhere, or that leads into a loop.
    pub(super) fn note_ambiguous_jump(&mut self, program: &Program, number: u32, target: OpIndex) {
        if program.is_duplicate_number(number) {
            self.log.note(Note::DuplicateNumber { number }, self.flow.block);
        }
        let open = self.flow.frame.loops;
        if let Some(number) = program.loop_entered(target, &open) {
            self.log.note(Note::JumpIntoLoop { number }, self.flow.block);
        }
    }

    fn missing_target(&self, number: u32) -> Alarm {
        match self.registers.data.settings.undocumented.missing_target_is_78 {
            true => Alarm::SequenceNumberNotFound { number },
            false => Alarm::JumpTargetNotFound { number },
        }
    }

    /// Writes a variable of any kind.
    pub(super) fn write<S: EventSink>(
        &mut self,
        slot: Slot,
        value: Value,
        text: Option<&[u8]>,
        span: Span,
        sink: &mut S,
    ) -> ExecResult<()> {
        match slot {
            Slot::Free(place) => self.registers.variables.set_free(place, value.into()),
            Slot::Other(number) => self.write_other(number, value, text, span, sink)?,
        }
        Ok(())
    }

    /// Writes a variable that is neither local nor common on every control.
    #[inline(never)]
    fn write_other<S: EventSink>(
        &mut self,
        number: u32,
        value: Value,
        text: Option<&[u8]>,
        span: Span,
        sink: &mut S,
    ) -> ExecResult<()> {
        match self.registers.variables.classify(number) {
            VariableClass::Local(place) | VariableClass::Common(place) => {
                self.registers.variables.set(place, value)
            }
            VariableClass::Vacant => return Err(Alarm::WriteProtected { number }.located_at(span)),
            VariableClass::System if number == 3000 => {
                return Err(self.user_alarm(value.number(), comment_text(text)).located_at(span));
            }
            VariableClass::System if number == 3006 => self.stop_with_message(&comment_text(text), sink),
            VariableClass::System => {
                self.registers.write_system(number, value.number()).map_err(|alarm| alarm.located_at(span))?
            }
        }
        Ok(())
    }

    /// `#3000=n(TEXT)`. A number beyond those that the manual names is shown as it is, or alarms by itself.
    fn user_alarm(&mut self, value: f64, text: String) -> Alarm {
        let out_of_range = Alarm::OutOfRange { function: "#3000".into(), value };
        let (base, most) =
            (self.registers.data.settings.macro_alarm_base, self.registers.data.settings.macro_alarm_max);
        let number = integer(value).ok().and_then(|number| u16::try_from(number).ok());
        let Some(number) = number.filter(|number| *number <= MAX_ALARM_NUMBER) else { return out_of_range };
        if number > most {
            if !self.registers.data.settings.undocumented.shows_large_alarm_numbers {
                return out_of_range;
            }
            self.log.note(Note::LargeAlarmNumber { number, max: most }, self.flow.block);
        }
        let has_no_base = base != 3000;
        Alarm::UserAlarm { number: if has_no_base { number + base } else { number }, text, has_no_base }
    }

    /// `#3006=1(TEXT)`: the program waits, and the operator reads the text and the variables it names; a vacant
    /// one shows nothing.
    fn stop_with_message<S: EventSink>(&mut self, text: &str, sink: &mut S) {
        let mut variables = Vec::new();
        for part in text.split('#').skip(1) {
            let digits: String = part.chars().take_while(char::is_ascii_digit).collect();
            if let Some(number) = digits.parse().ok()
                && let Ok(Value::Number(value)) = self.registers.read_variable(number)
            {
                variables.push((number, value));
            }
        }
        let text = text.to_owned();
        let stop = EventKind::Stop { kind: StopKind::Message, text, variables };
        if self.registers.lookahead.has_pending_move() {
            let place = self.flow.backtrace();
            return self.registers.lookahead.push_pending(stop, place);
        }
        self.emit(&stop, 0.0, sink);
    }
}

/// A comment's bytes as a text for people.
fn comment_text(text: Option<&[u8]>) -> String {
    text.map_or_else(String::new, |bytes| String::from_utf8_lossy(bytes).trim().to_owned())
}

impl Executor {
    pub(super) fn set_output_open(&mut self, is_open: bool) {
        self.registers.panel.is_output_open = is_open;
    }

    /// DPRNT and BPRNT: one line.
    pub(super) fn print(&mut self, kind: PrintKind, parts: &[PrintPart], span: Span) -> ExecResult<()> {
        if self.registers.data.settings.print_needs_open && !self.registers.panel.is_output_open {
            let what = "DPRNT without POPEN before it".into();
            return Err(Alarm::MacroFormat { what }.located_at(span));
        }
        let mut line = Vec::new();
        for part in parts {
            match part {
                // An asterisk stands for a space: the statement's own spaces are lost when it is read.
                PrintPart::Text(text) => {
                    line.extend(text.bytes().map(|b| if b == b'*' { b' ' } else { b }));
                }
                PrintPart::Value { value, whole, decimals } => {
                    let number = self.registers.operand(value)?.number();
                    let printed = match kind {
                        PrintKind::Decimal => {
                            decimal(number, *whole, *decimals, &self.registers.data.settings, &mut line)
                        }
                        PrintKind::Binary => binary(number, *decimals, &mut line).map(|()| true),
                    };
                    if !printed.map_err(|alarm| alarm.located_at(span))? {
                        self.registers.block_effects.record_note(Note::DigitsLost);
                    }
                }
            }
        }
        self.log.printed.bytes += line.len() + 1;
        if self.log.printed.bytes > MAX_PRINTED_BYTES {
            return Err(Alarm::NotSimulated { what: "more than 64 MB of output".into() }.located_at(span));
        }
        self.log.printed.lines.push(line);
        Ok(())
    }
}
