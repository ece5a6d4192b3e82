//! Macro statements: assignments, branches and loops. They never tell the machine anything, but for #3000 and #3006.
use super::Executor;
use super::eval::{Checked, RoundingTarget, at, index, integer};
use super::loop_detection::LoopDetector;
use super::notes::Note;
use super::vars::{Value, VariableClass};
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::{Backtrace, EventKind, EventSink, StopKind};
use gcode_lang::program::{Assign, OpIndex, Operand, Program, Slot, Statement, Target};
use gcode_lang::source::{Span, Spanned};

/// No control has numbers beyond this for alarms of its programs.
const MOST_RAISED: u16 = 4095;

impl Executor {
    /// An assignment of what code gives, in the loop over the blocks itself.
    #[inline(always)]
    pub(super) fn compute(&mut self, Assign { place, code }: &Assign) -> Checked<()> {
        let value = self.evaluate(code, RoundingTarget::Increment)?;
        self.vars.set_free(*place, value);
        Ok(())
    }

    /// As [`Executor::compute`], elsewhere.
    #[inline(never)]
    pub(super) fn compute_apart(&mut self, compute: &Assign) -> Checked<()> {
        self.compute(compute)
    }

    /// Does one statement. The frame already stands at the next block; jumps change that. What the turns of most loops
    /// consist of is done in the loop over the blocks itself.
    #[inline(always)]
    pub(super) fn statement<S: EventSink>(
        &mut self,
        program: &Program,
        statement: &Statement,
        watch: &mut LoopDetector,
        sink: &mut S,
    ) -> Checked<()> {
        match statement {
            Statement::While { condition, number, end } => {
                let holds = self.evaluate_condition(condition)?;
                self.begin_iteration(*number, *end, holds);
            }
            Statement::End { number, start } => {
                self.end_iteration(*number, *start)?;
                watch.jumped(self);
            }
            _ => return self.any_statement(program, statement, watch, sink),
        }
        Ok(())
    }

    /// As [`Executor::statement`], away from the loop over the blocks.
    #[inline(never)]
    pub(super) fn any_statement<S: EventSink>(
        &mut self,
        program: &Program,
        statement: &Statement,
        watch: &mut LoopDetector,
        sink: &mut S,
    ) -> Checked<()> {
        let next = self.frame.next;
        match statement {
            Statement::Compute(compute) => self.compute_apart(compute)?,
            Statement::Assign { target, target_span, value, text } => {
                let slot = at(self.target(target), *target_span)?;
                let value = self.operand(value)?;
                self.write(slot, value, text.as_deref(), *target_span, sink)?;
            }
            Statement::Several(assignments) => {
                for one in assignments {
                    self.any_statement(program, one, watch, sink)?;
                }
            }
            Statement::Goto(to) => self.goto(program, to)?,
            Statement::IfGoto { condition, to } => {
                if self.evaluate_condition(condition)? {
                    self.goto(program, to)?;
                }
            }
            Statement::IfThen { condition, then } => {
                if self.evaluate_condition(condition)? {
                    // An assignment or a GOTO: lowering lets nothing else stand here.
                    return self.any_statement(program, then, watch, sink);
                }
            }
            Statement::While { condition, number, end } => {
                let holds = self.evaluate_condition(condition)?;
                self.begin_iteration(*number, *end, holds);
            }
            Statement::Do { number, end } => self.begin_iteration(*number, *end, true),
            Statement::End { number, start } => self.end_iteration(*number, *start)?,
            Statement::SetNames { first, names } => self.name_variables(first, names)?,
            Statement::Print { kind, parts } => self.print(*kind, parts, self.block)?,
            Statement::OpenOutput => self.open_output(true),
            Statement::CloseOutput => self.open_output(false),
            Statement::Alarm(alarm) => return Err(alarm.clone()),
        }
        if self.frame.next < next {
            watch.jumped(self);
        }
        Ok(())
    }

    /// The DO or WHILE of a loop, `end` the operation of its END.
    #[inline]
    fn begin_iteration(&mut self, number: u8, end: OpIndex, goes_on: bool) {
        let frame = &mut self.frame;
        let open = &mut frame.loops[usize::from(number) - 1];
        if goes_on {
            *open = Some((frame.next - 1, end));
        } else {
            *open = None;
            frame.jump(end + 1);
        }
    }

    /// The END of a loop, `start` the operation of its DO or WHILE.
    #[inline]
    fn end_iteration(&mut self, number: u8, start: OpIndex) -> Checked<()> {
        let open = self.frame.loops[usize::from(number) - 1];
        if open.is_none_or(|(first, _)| first != start) {
            return Err(Alarm::MissingDo { number }.at(self.block));
        }
        self.frame.next = start;
        Ok(())
    }

    #[inline(never)]
    fn name_variables(&mut self, first: &Operand, names: &[String]) -> Checked<()> {
        let first = at(index(self.operand(first)?), self.block)?;
        at(self.set_names(first, names), self.block)
    }

    pub(super) fn target(&self, target: &Target) -> Result<Slot, Alarm> {
        match target {
            Target::Slot(slot) => Ok(*slot),
            Target::Computed(number) => {
                let value = self.operand(number).map_err(|alarm| alarm.node)?;
                index(value).map(Slot::of)
            }
        }
    }

    #[inline(never)]
    fn goto(&mut self, program: &Program, to: &Spanned<Operand>) -> Checked<()> {
        let value = self.operand(&to.node)?.number();
        let number = integer(value).map_err(|alarm| alarm.at(to.span))?;
        if self.settings.unsure.minus_searches_up && (-99_999_999..0).contains(&number) {
            let target = program.find_number_above(number.unsigned_abs() as u32, self.frame.next);
            let missing = || self.no_target(number.unsigned_abs() as u32).at(to.span);
            let target = target.ok_or_else(missing)?;
            self.frame.jump(target);
            return Ok(());
        }
        if !(1..=99_999_999).contains(&number) {
            return Err(Alarm::SequenceNumberRange { number }.at(to.span));
        }
        let number = number as u32;
        let from = if self.settings.unsure.first_stored_number { 0 } else { self.frame.next };
        let Some(target) = program.find_number(number, from) else {
            return Err(self.no_target(number).at(to.span));
        };
        self.note_ambiguous_jump(program, number, target);
        self.frame.jump(target);
        Ok(())
    }

    /// A jump that a control may take elsewhere, or that leads into a loop.
    pub(super) fn note_ambiguous_jump(&mut self, program: &Program, number: u32, target: OpIndex) {
        if program.has_twice(number) {
            self.notes.entry(Note::DoubledNumber { number }).or_insert(self.block);
        }
        let open = self.frame.loops;
        if let Some(number) = program.loop_entered(target, &open) {
            self.notes.entry(Note::JumpIntoLoop { number }).or_insert(self.block);
        }
    }

    fn no_target(&self, number: u32) -> Alarm {
        match self.settings.unsure.missing_target_is_78 {
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
    ) -> Checked<()> {
        match slot {
            Slot::Free(place) => self.vars.set_free(place, value.into()),
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
    ) -> Checked<()> {
        match self.vars.kind(number) {
            VariableClass::Local(place) | VariableClass::Common(place) => self.vars.set(place, value),
            VariableClass::Vacant => return Err(Alarm::WriteProtected { number }.at(span)),
            VariableClass::System if number == 3000 => {
                return Err(self.raised(value.number(), shown(text)).at(span));
            }
            VariableClass::System if number == 3006 => self.message(&shown(text), sink),
            VariableClass::System => {
                self.write_system(number, value.number()).map_err(|alarm| alarm.at(span))?
            }
        }
        Ok(())
    }

    /// `#3000=n(TEXT)`. A number beyond those that the manual names is shown as it is, or alarms by itself.
    fn raised(&mut self, value: f64, text: String) -> Alarm {
        let out_of_range = Alarm::OutOfRange { function: "#3000".into(), value };
        let (base, most) = (self.settings.macro_alarm_base, self.settings.macro_alarm_most);
        let number = integer(value).ok().and_then(|number| u16::try_from(number).ok());
        let Some(number) = number.filter(|number| *number <= MOST_RAISED) else { return out_of_range };
        if number > most {
            if !self.settings.unsure.large_alarm_numbers {
                return out_of_range;
            }
            self.notes.entry(Note::LargeAlarm { number, most }).or_insert(self.block);
        }
        let plain = base != 3000;
        Alarm::Raised { number: if plain { number + base } else { number }, text, plain }
    }

    /// `#3006=1(TEXT)`: the program waits, and the operator reads the text and the variables it names; a vacant
    /// one shows nothing.
    fn message<S: EventSink>(&mut self, text: &str, sink: &mut S) {
        let mut named = Vec::new();
        for part in text.split('#').skip(1) {
            let digits: String = part.chars().take_while(char::is_ascii_digit).collect();
            if let Some(number) = digits.parse().ok()
                && let Ok(Value::Number(value)) = self.read(number)
            {
                named.push((number, value));
            }
        }
        let text = text.to_owned();
        let stop = EventKind::Stop { kind: StopKind::Message, text, named };
        if self.ahead.waits() {
            let place = Backtrace { block: self.block, calls: self.frame.calls.clone() };
            return self.ahead.wait_behind(stop, place);
        }
        self.emit(&stop, 0.0, sink);
    }
}

/// A comment's bytes as a text for people.
fn shown(text: Option<&[u8]>) -> String {
    text.map_or_else(String::new, |bytes| String::from_utf8_lossy(bytes).trim().to_owned())
}
