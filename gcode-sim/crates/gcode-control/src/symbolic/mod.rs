//! Run of a program whose variables are terms: all values of their ranges at once.
//!
//! [`SymbolicRun`] executes the operations of a [`Control`], block by block. Everything that doesn't depend on the ranges is
//! done by the control itself: calls, modes, tables, words. A variable that depends on them holds a [`Term`], and the
//! expressions that read it become nodes of the caller's [`Terms`]. Where the answer to a question isn't the same for all
//! values, [`SymbolicRun::advance`] returns the question and changes nothing; the caller follows each answer, from a
//! [`Snapshot`] on. What isn't followed is reported by name: a result never rests on it in silence.
mod arcs;
mod bits;
mod cycles;
mod expression;
mod functions;
mod join;
mod moves;
mod oracle;
mod positions;
mod statements;
mod term;
#[cfg(test)]
mod tests;
mod words;

pub use self::oracle::Halt;
pub use self::term::{Formula, Term, TermOperation, Terms, Test};

use self::expression::Evaluation;
use self::oracle::{Oracle, Symbolic};
use self::statements::Place;
use super::control::{Control, max_moves};
use super::executor::Executor;
use super::flow::CallFrame;
use super::loop_detection::LoopDetector;
use super::outcome::{AlarmStop, Limits, Outcome, RunEnd};
use super::variables::{Value, VariableClass};
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::AxisIndex;
use gcode_lang::program::{Bytecode, Library, Memory, OpBody, OpKind, Operation, Statement};

/// Run whose variables are terms.
#[derive(Debug)]
pub struct SymbolicRun {
    control: Control,
}

/// Variables with their values; a value that isn't followed is `None`.
type NamedTerms = Vec<(u32, Option<Term>)>;

/// State of a run between two blocks.
#[derive(Clone, Debug)]
pub struct Snapshot(Box<Executor>);

/// Result of [`SymbolicRun::advance`].
#[derive(Clone, Debug)]
pub enum Advance {
    /// The block is executed, with this number of answers.
    Next(usize),
    /// The run has ended, with this number of answers.
    End(Outcome, usize),
    /// The block needs the answer to a question; nothing has changed.
    Fork(Test),
    /// The block does something with the ranges that isn't followed; nothing has changed.
    Unfollowed(String),
}

impl SymbolicRun {
    /// Returns the run of a control that has not begun.
    pub fn new(mut control: Control) -> Self {
        control.executor.state_start(&mut ());
        // Only the control's own run counts moves.
        control.executor.log.max_moves = u64::MAX;
        Self { control }
    }

    /// Sets a local or common variable to a term.
    ///
    /// # Errors
    /// The alarm of a variable that the control lacks, or that is neither local nor common.
    pub fn set_term(&mut self, number: u32, term: Term) -> Result<(), Alarm> {
        let variables = &mut self.control.executor.registers.variables;
        match variables.classify(number) {
            VariableClass::Local(index) | VariableClass::Common(index) => {
                variables.set(index, Value::Number(term.stored()));
                Ok(())
            }
            VariableClass::Vacant => Err(Alarm::WriteProtected { number }),
            VariableClass::System => Err(Alarm::NoSuchVariable { number: i64::from(number) }),
        }
    }

    /// Returns the state, to which [`SymbolicRun::restore`] returns.
    pub fn snapshot(&self) -> Snapshot {
        Snapshot(Box::new(self.control.executor.clone()))
    }

    /// Returns to a state.
    pub fn restore(&mut self, snapshot: &Snapshot) {
        self.control.executor = (*snapshot.0).clone();
        self.control.loop_detector = LoopDetector::default();
        self.control.reopen();
    }

    /// Returns the control, whose variables hold terms.
    pub fn control(&self) -> &Control {
        &self.control
    }

    /// Returns to the main program's locals, as they are reported at the end of a run.
    pub fn leave_calls(&mut self) {
        let variables = &mut self.control.executor.registers.variables;
        while variables.level() > 0 {
            variables.pop_level();
        }
    }

    /// Evaluates a condition in the current state; `answers` are those to the questions that its functions ask, and to later
    /// ones. Returns the number of answers used too.
    ///
    /// # Errors
    /// [`Halt`]: a further question, the alarm of a function, or a value that isn't followed.
    pub fn condition<T: Terms>(
        &self,
        code: &Bytecode,
        terms: &mut T,
        answers: &[bool],
    ) -> Result<(Formula, usize), Halt> {
        let mut oracle = Oracle::new(terms, answers);
        let formula = Evaluation::new(&self.control.executor.registers, &mut oracle).condition(code)?;
        Ok((formula, answers.len() - oracle.unused()))
    }

    /// Decides a condition in the current state. Returns the number of answers used too.
    ///
    /// # Errors
    /// [`Halt`] as of [`SymbolicRun::condition`].
    pub fn decide<T: Terms>(
        &self,
        code: &Bytecode,
        terms: &mut T,
        answers: &[bool],
    ) -> Result<(bool, usize), Halt> {
        let mut oracle = Oracle::new(terms, answers);
        let is_true = Evaluation::new(&self.control.executor.registers, &mut oracle).is_true(code)?;
        Ok((is_true, answers.len() - oracle.unused()))
    }

    /// Returns a local or common variable: `None` if it is vacant.
    ///
    /// # Errors
    /// [`Halt::Unfollowed`] for a value that isn't followed.
    pub fn variable(&self, number: u32) -> Result<Option<Term>, Halt> {
        let value = self.control.variable(number).map_err(|_| Halt::unfollowed(format!("#{number}")))?;
        let Some(stored) = value.as_number() else { return Ok(None) };
        Term::of(stored).map(Some).ok_or_else(|| Halt::unfollowed(format!("#{number}")))
    }

    /// Returns the machine position of an axis; `None` if it isn't followed.
    pub fn machine_position(&self, axis: AxisIndex) -> Option<Term> {
        Term::of(self.control.executor.registers.state.machine_position[axis])
    }

    /// Returns the text of the last operator stop and the variables that it names; a value that isn't followed is `None`.
    pub fn last_stop(&self) -> Option<(&str, NamedTerms)> {
        let stop = self.control.stops().last()?;
        let term = |(number, stored): &(u32, f64)| (*number, Term::of(*stored));
        Some((stop.text.as_str(), stop.variables.iter().map(term).collect()))
    }

    /// Returns true if the run has made more moves than a run with these limits.
    pub fn exceeds_moves(&self, limits: Limits) -> bool {
        self.control.executor.log.moves > max_moves(limits)
    }

    /// Runs to the end, when every variable is a known number.
    pub fn run_numbers(&mut self, limits: Limits, library: &mut impl Library) -> Outcome {
        self.control.run(limits, library, &mut ())
    }

    /// Executes the next block; `answers` are those to its questions, in their order, and to later ones.
    pub fn advance<T: Terms>(
        &mut self,
        terms: &mut T,
        answers: &[bool],
        library: &mut impl Library,
    ) -> Advance {
        let mut oracle = Oracle::new(terms, answers);
        let blocks = self.control.executor.log.blocks;
        let result = self.execute(&mut oracle, library);
        let used = answers.len() - oracle.unused();
        match result {
            Ok(None) => Advance::Next(used),
            Ok(Some(outcome)) => Advance::End(outcome, used),
            Err(Halt::Fork(test)) => Advance::Fork(test),
            Err(Halt::Alarm(alarm)) => {
                // A block that raises an alarm counts as begun.
                self.control.executor.log.blocks = blocks + 1;
                let backtrace = self.control.executor.flow.backtrace();
                let stop = AlarmStop { alarm: alarm.node, span: alarm.span, backtrace };
                Advance::End(Outcome::Alarm(stop), used)
            }
            Err(Halt::Unfollowed(what)) => Advance::Unfollowed(what),
        }
    }

    fn execute<T: Terms>(
        &mut self,
        oracle: &mut Oracle<'_, T>,
        library: &mut impl Library,
    ) -> Symbolic<Option<Outcome>> {
        let Control { memory, executor, loop_detector, .. } = &mut self.control;
        let CallFrame { program, next, .. } = executor.flow.frame;
        let Some((program, op)) = memory.get_mut(program).and_then(|program| program.lower_block(next))
        else {
            return Ok(self.control.step(library, &mut ()));
        };
        executor.flow.block = op.span;
        let place = Place { next, span: op.span };
        if let OpBody::Guarded(guarded) = op.body()
            && !matches!(executor.is_skipped_or_refused(guarded), Ok(false))
        {
            return Ok(self.control.step(library, &mut ()));
        }
        let mut kind = op.kind();
        let is_conditional = matches!(kind, OpKind::If { .. });
        if let OpKind::If { condition, then } = kind {
            if !Evaluation::new(&executor.registers, oracle).is_true(condition)? {
                executor.begin(place);
                if let Some(number) = op.number {
                    executor.registers.state.modal_words.n = number;
                }
                return Ok(None);
            }
            kind = then;
        }
        match kind {
            OpKind::AssignDirect(assign) => executor.assign_direct(assign, place, oracle)?,
            OpKind::Statement(Statement::Assignments(all)) => {
                let before = executor.clone();
                executor.begin(place);
                let mut assign = |one| executor.follow_statement(program, one, loop_detector, oracle);
                if let Err(halt) = all.iter().try_for_each(&mut assign) {
                    *executor = before;
                    return Err(halt);
                }
            }
            OpKind::Statement(statement) => {
                let before = executor.flow.frame.clone();
                let blocks = executor.log.blocks;
                executor.begin(place);
                if let Err(halt) = executor.follow_statement(program, statement, loop_detector, oracle) {
                    executor.flow.frame = before;
                    executor.log.blocks = blocks;
                    return Err(halt);
                }
            }
            OpKind::Words(words) => {
                let (words, number) = (words.clone(), op.number);
                return self.follow_words(&words, number, is_conditional, place, oracle, library);
            }
            OpKind::Empty | OpKind::Alarm(_) | OpKind::If { .. } if !is_conditional => {
                return Ok(self.control.step(library, &mut ()));
            }
            OpKind::Alarm(alarm) => return Err(alarm.clone().into()),
            OpKind::Empty | OpKind::If { .. } => executor.begin(place),
        }
        Ok(self.take_end())
    }

    /// Returns the end of the run that the last block has made.
    fn take_end(&mut self) -> Option<Outcome> {
        match self.control.executor.registers.block_effects.take().1? {
            RunEnd::ProgramEnd => Some(Outcome::End),
            RunEnd::EndlessLoop | RunEnd::MoveLimit => Some(Outcome::Limit),
        }
    }
}

/// Compiles a condition as a program writes it: `#100 LE 12.1`, `[#1 GT 0]AND[#2 LT 3]`.
///
/// # Errors
/// The alarm of the control that can't read it.
pub fn compile_condition(text: &str) -> Result<Bytecode, Alarm> {
    let mut memory = Memory::default();
    memory.load("condition", format!("O1\nIF[{text}]GOTO1\nN1M30\n").into_bytes());
    let refused = || Alarm::MacroFormat { what: format!("[{text}] is no condition") };
    let id = memory.find(1).ok_or_else(refused)?;
    match memory.lower_block(id, 0).map(|op| op.kind()) {
        // A value in the place of a condition compares nothing.
        Some(OpKind::Statement(Statement::IfGoto { condition, .. }))
            if condition.iter().any(|one| matches!(one.operation, Operation::Compare(..))) =>
        {
            Ok(condition.clone())
        }
        Some(OpKind::Alarm(alarm)) => Err(alarm.node.clone()),
        _ => Err(refused()),
    }
}
