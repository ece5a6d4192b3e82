//! Macro statements: assignments, branches, loops and prints. Only #3000 and #3006 emit an event.
use super::evaluation::RoundingTarget;
use super::executor::Executor;
use super::functions::{ExecResult, integer, locate, variable_number};
use super::loop_detection::LoopDetector;
use super::notes::Note;
use super::registers::Registers;
use super::variables::{Value, VariableClass};
use gcode_lang::alarm::Alarm;
use gcode_lang::control::Settings;
use gcode_lang::motion::{Event, EventKind, EventSink, StopKind};
use gcode_lang::program::{Assign, OpIndex, Operand, PrintPart, Program, Slot, Statement};
use gcode_lang::source::{Span, Spanned};
use gcode_lang::syntax::ast::PrintKind;
use gcode_lang::units::{POWERS, round_scaled};

/// Largest alarm number of a program on any control.
const MAX_ALARM_NUMBER: u16 = 4095;

impl Executor {
    /// Assigns the result of code; inlined into the loop over the blocks.
    #[inline(always)]
    pub(super) fn execute_assignment(&mut self, Assign { variable, code }: &Assign) -> ExecResult<()> {
        let value = self.registers.evaluate(code, RoundingTarget::Increment)?;
        self.registers.variables.set_direct(*variable, value);
        Ok(())
    }

    /// Assigns as [`Executor::execute_assignment`], out of line.
    #[inline(never)]
    pub(super) fn execute_assignment_out_of_line(&mut self, assign: &Assign) -> ExecResult<()> {
        self.execute_assignment(assign)
    }

    /// Executes one statement. The frame already points to the next block; jumps change that. The statements of most loops
    /// are inlined into the loop over the blocks.
    #[inline(always)]
    pub(super) fn execute_statement<S: EventSink>(
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
            _ => return self.execute_statement_out_of_line(program, statement, loop_detector, sink),
        }
        Ok(())
    }

    /// Executes a statement as [`Executor::execute_statement`], out of line.
    #[inline(never)]
    pub(super) fn execute_statement_out_of_line<S: EventSink>(
        &mut self,
        program: &Program,
        statement: &Statement,
        loop_detector: &mut LoopDetector,
        sink: &mut S,
    ) -> ExecResult<()> {
        let next = self.flow.frame.next;
        match statement {
            Statement::AssignDirect(assign) => self.execute_assignment_out_of_line(assign)?,
            Statement::Assign { target, target_span, value, text } => {
                let slot = locate(self.registers.resolve_target(target), *target_span)?;
                let value = self.registers.operand(value)?;
                self.write(slot, value, text.as_deref(), *target_span, sink)?;
            }
            Statement::Assignments(assignments) => {
                self.assign_all(program, assignments, loop_detector, sink)?;
            }
            Statement::Goto(to) => self.goto(program, to)?,
            Statement::IfGoto { condition, to } => {
                if self.registers.evaluate_condition(condition)? {
                    self.goto(program, to)?;
                }
            }
            Statement::IfThen { condition, then } => {
                if self.registers.evaluate_condition(condition)? {
                    // An assignment or a GOTO: lowering accepts nothing else.
                    return self.execute_statement_out_of_line(program, then, loop_detector, sink);
                }
            }
            Statement::While { condition, number, end } => {
                let is_true = self.registers.evaluate_condition(condition)?;
                self.begin_iteration(*number, *end, is_true);
            }
            Statement::Do { number, end } => self.begin_iteration(*number, *end, true),
            Statement::End { number, start } => self.end_iteration(*number, *start)?,
            Statement::SetNames { first, names } => self.name_variables(first, names)?,
            Statement::Print { kind, parts } => self.print(*kind, parts)?,
            Statement::OpenOutput => self.registers.panel.is_output_open = true,
            Statement::CloseOutput => self.registers.panel.is_output_open = false,
            Statement::Alarm(alarm) => return Err(alarm.clone()),
        }
        if self.flow.frame.next < next {
            loop_detector.record_jump(self);
        }
        Ok(())
    }

    /// Executes the assignments of one block in their order, each with the values that the earlier ones have written; an
    /// alarm takes all of them back.
    #[inline(never)]
    fn assign_all<S: EventSink>(
        &mut self,
        program: &Program,
        assignments: &[Statement],
        loop_detector: &mut LoopDetector,
        sink: &mut S,
    ) -> ExecResult<()> {
        let before = self.registers.clone();
        let stops = self.log.stops.len();
        let mut deferred = DeferredEvents::default();
        let mut assign = |one| self.execute_statement_out_of_line(program, one, loop_detector, &mut deferred);
        let result = assignments.iter().try_for_each(&mut assign);
        if result.is_err() {
            let block_effects = std::mem::take(&mut self.registers.block_effects);
            self.registers = Registers { block_effects, ..before };
            self.log.stops.truncate(stops);
        } else {
            deferred.0.iter().for_each(|kind| self.pass_on(kind, 0.0, sink));
        }
        result
    }

    /// Executes the DO or WHILE of a loop; `end` is the operation of its END.
    #[inline]
    pub(super) fn begin_iteration(&mut self, number: u8, end: OpIndex, is_true: bool) {
        let frame = &mut self.flow.frame;
        let open = &mut frame.loops[usize::from(number) - 1];
        if is_true {
            *open = Some((frame.next - 1, end));
        } else {
            *open = None;
            frame.jump(end + 1);
        }
    }

    /// Executes the END of a loop; `start` is the operation of its DO or WHILE.
    #[inline]
    pub(super) fn end_iteration(&mut self, number: u8, start: OpIndex) -> ExecResult<()> {
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
        let number = locate(integer(self.registers.operand(&to.node)?.number()), to.span)?;
        self.jump_to_number(program, number, to.span)
    }

    /// Jumps to a sequence number, which `span` shows.
    pub(super) fn jump_to_number(&mut self, program: &Program, number: i64, span: Span) -> ExecResult<()> {
        let undocumented = &self.registers.data.settings.undocumented;
        let next = self.flow.frame.next;
        let missing = |number| match undocumented.missing_target_is_78 {
            true => Alarm::SequenceNumberNotFound { number }.located_at(span),
            false => Alarm::JumpTargetNotFound { number }.located_at(span),
        };
        if undocumented.minus_searches_up && (-99_999_999..0).contains(&number) {
            let number = number.unsigned_abs() as u32;
            let target = program.find_number_above(number, next).ok_or_else(|| missing(number))?;
            self.flow.frame.jump(target);
            return Ok(());
        }
        if !(1..=99_999_999).contains(&number) {
            return Err(Alarm::SequenceNumberRange { number }.located_at(span));
        }
        let number = number as u32;
        let from = if undocumented.goto_takes_first_number { 0 } else { next };
        let target = program.find_number(number, from).ok_or_else(|| missing(number))?;
        self.note_ambiguous_jump(program, number, target);
        self.flow.frame.jump(target);
        Ok(())
    }

    /// Notes a jump whose target differs between controls, or that goes into a loop.
    pub(super) fn note_ambiguous_jump(&mut self, program: &Program, number: u32, target: OpIndex) {
        if program.is_duplicate_number(number) {
            self.log.note(Note::DuplicateNumber(number), self.flow.block);
        }
        let open = self.flow.frame.loops;
        if let Some(number) = program.loop_entered(target, &open) {
            self.log.note(Note::JumpIntoLoop(number), self.flow.block);
        }
    }

    pub(super) fn write<S: EventSink>(
        &mut self,
        slot: Slot,
        value: Value,
        text: Option<&[u8]>,
        span: Span,
        sink: &mut S,
    ) -> ExecResult<()> {
        match slot {
            Slot::Free(index) => self.registers.variables.set_direct(index, value.into()),
            Slot::Other(number) => self.write_other(number, value, text, span, sink)?,
        }
        Ok(())
    }

    /// Writes a variable that isn't local or common on every control.
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
            VariableClass::Local(index) | VariableClass::Common(index) => {
                self.registers.variables.set(index, value)
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

    /// Returns the alarm of `#3000=n(TEXT)`; a number beyond those of the manual is displayed as it is or out of range.
    fn user_alarm(&mut self, value: f64, text: String) -> Alarm {
        let out_of_range = Alarm::OutOfRange { function: "#3000".into(), value };
        let settings = &self.registers.data.settings;
        let (base, max) = (settings.macro_alarm_base, settings.macro_alarm_max);
        let number = integer(value).ok().and_then(|number| u16::try_from(number).ok());
        let Some(number) = number.filter(|number| *number <= MAX_ALARM_NUMBER) else { return out_of_range };
        if number > max {
            if !settings.undocumented.shows_large_alarm_numbers {
                return out_of_range;
            }
            self.log.note(Note::LargeAlarmNumber { number, max }, self.flow.block);
        }
        let has_no_base = base != 3000;
        Alarm::UserAlarm { number: if has_no_base { number + base } else { number }, text, has_no_base }
    }

    /// Stops at `#3006=1(TEXT)` with the text and the variables it names, vacant ones excepted.
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
            let backtrace = self.flow.backtrace();
            return self.registers.lookahead.push_pending(stop, backtrace);
        }
        self.emit(&stop, 0.0, sink);
    }
}

/// Events of the assignments of one block, until all of them are executed; only #3006 has one.
#[derive(Default)]
struct DeferredEvents(Vec<EventKind>);

impl EventSink for DeferredEvents {
    fn event(&mut self, event: &Event<'_>) {
        self.0.push(event.kind.clone());
    }
}

fn comment_text(text: Option<&[u8]>) -> String {
    text.map_or_else(String::new, |bytes| String::from_utf8_lossy(bytes).trim().to_owned())
}

impl Executor {
    /// Prints one line of DPRNT or BPRNT.
    fn print(&mut self, kind: PrintKind, parts: &[PrintPart]) -> ExecResult<()> {
        let span = self.flow.block;
        if self.registers.data.settings.print_needs_open && !self.registers.panel.is_output_open {
            let what = "DPRNT without POPEN before it".into();
            return Err(Alarm::MacroFormat { what }.located_at(span));
        }
        let mut line = Vec::new();
        for part in parts {
            match part {
                // An asterisk stands for a space: reading the statement drops its own spaces.
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
                    if !locate(printed, span)? {
                        self.registers.block_effects.record_note(Note::DigitsLost);
                    }
                }
            }
        }
        self.log.printed_bytes += line.len() + 1;
        if self.log.printed_bytes > MAX_PRINTED_BYTES {
            return Err(Alarm::NotSimulated { what: "more than 64 MB of output".into() }.located_at(span));
        }
        self.log.printed.push(line);
        Ok(())
    }
}

/// Largest output of a run; a loop that prints must not fill the memory.
const MAX_PRINTED_BYTES: usize = 64 << 20;

/// Prints `#n[ab]`: a sign or a blank, a digits before the point and b after it; PRT (6001#1) omits blanks.
///
/// A control prints only the lower digits of a number with more than a before its point; returns true if all are printed.
fn decimal(
    number: f64,
    whole: u8,
    decimals: u8,
    settings: &Settings,
    line: &mut Vec<u8>,
) -> Result<bool, Alarm> {
    if !(1..=settings.print_digits).contains(&usize::from(whole + decimals)) {
        return Err(Alarm::PrintFormat);
    }
    let scaled = round_scaled(number.abs(), POWERS[usize::from(decimals)]);
    if scaled > 1e15 {
        return Err(Alarm::IntegerOverflow);
    }
    let unit = 10_u64.pow(u32::from(decimals));
    let scaled = scaled as u64;
    let width = usize::from(whole);
    let mut whole_digits = (scaled / unit).to_string();
    let mut is_complete = true;
    if whole_digits.len() > width && !settings.print_expands {
        is_complete = whole_digits.drain(..whole_digits.len() - width).all(|digit| digit == '0');
    }
    let negative = number < 0.0 && scaled > 0;
    if negative {
        line.push(b'-');
    } else if !settings.omits_print_blanks {
        line.push(b' ');
    }
    if !settings.omits_print_blanks {
        line.extend(std::iter::repeat_n(b' ', width.saturating_sub(whole_digits.len())));
    }
    line.extend(whole_digits.bytes());
    if decimals > 0 {
        let fraction = scaled % unit;
        line.push(b'.');
        line.extend(format!("{fraction:0width$}", width = usize::from(decimals)).bytes());
    }
    Ok(is_complete)
}

/// Prints `#n[d]`: the value × 10^d as two words, the highest byte first.
fn binary(number: f64, decimals: u8, line: &mut Vec<u8>) -> Result<(), Alarm> {
    let scaled = round_scaled(number, POWERS[usize::from(decimals)]);
    if !(-2_147_483_648.0..=2_147_483_647.0).contains(&scaled) {
        return Err(Alarm::IntegerOverflow);
    }
    line.extend((scaled as i32).to_be_bytes());
    Ok(())
}

/// Returns a printed line as text, with the bytes of BPRNT in hexadecimal.
pub fn printable(line: &[u8]) -> String {
    line.iter()
        .map(|byte| match byte {
            b' '..=b'~' => char::from(*byte).to_string(),
            byte => format!("\\x{byte:02X}"),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn printed(number: f64, whole: u8, decimals: u8, settings: &Settings) -> String {
        let mut line = Vec::new();
        decimal(number, whole, decimals, settings, &mut line).unwrap();
        String::from_utf8(line).unwrap()
    }

    #[test]
    fn dprnt_prints_as_the_manual_shows() {
        // Operator's manual, DPRNT: #2 = 128.47398 as [53], #5 = -91.2 as [53], #30 = 123.456 as [20].
        let mut settings = Settings::default();
        assert_eq!(printed(128.47398, 5, 3, &settings), "   128.474");
        assert_eq!(printed(-91.2, 5, 3, &settings), "-   91.200");
        assert_eq!(printed(123.456, 2, 0, &settings), " 23");
        settings.omits_print_blanks = true;
        assert_eq!(printed(128.47398, 5, 3, &settings), "128.474");
        assert_eq!(printed(-91.2, 5, 3, &settings), "-91.200");
    }

    #[test]
    fn bprnt_prints_two_words_with_the_highest_byte_first() {
        // Operator's manual, BPRNT: #100 = 0.40956 as [3] is 410, #101 = -1638.4 as [3] is -1638400.
        let mut line = Vec::new();
        binary(0.40956, 3, &mut line).unwrap();
        binary(-1638.4, 3, &mut line).unwrap();
        assert_eq!(line, [0x00, 0x00, 0x01, 0x9A, 0xFF, 0xE7, 0x00, 0x00]);
    }
}
