//! Blocks of words of a symbolic run: the control plans them with a known number in the place of every term.
use super::super::control::Control;
use super::super::evaluation::RoundingTarget;
use super::super::executor::Executor;
use super::super::functions::ExecResult;
use super::super::outcome::Outcome;
use super::SymbolicRun;
use super::expression::Evaluation;
use super::oracle::{Halt, Oracle, Symbolic};
use super::statements::Place;
use super::term::{SymbolicValue, Term, TermOperation, Terms, Test};
use gcode_lang::program::{Library, LoweredWord, WordOperand, WordUse, Words};
use gcode_lang::syntax::ast::{Function, Relation};

/// Terms of a block's words that the control plans with another number.
#[derive(Debug, Default)]
pub(super) struct BlockTerms {
    /// Axis words, by letter.
    pub(super) axes: Vec<(u8, Term)>,
    pub(super) feed: Option<Term>,
    /// I, J, K, R and Q of an arc or of a canned cycle, by letter.
    pub(super) lengths: Vec<(u8, Term)>,
    /// Spindle speed, a whole number.
    pub(super) speed: Option<Term>,
}

impl BlockTerms {
    pub(super) fn is_none(&self) -> bool {
        self.axes.is_empty() && self.lengths.is_empty() && self.feed.is_none() && self.speed.is_none()
    }
}

impl SymbolicRun {
    /// Executes a block of words.
    pub(super) fn follow_words<T: Terms>(
        &mut self,
        words: &Words,
        number: Option<u32>,
        is_conditional: bool,
        place: Place,
        oracle: &mut Oracle<'_, T>,
        library: &mut impl Library,
    ) -> Symbolic<Option<Outcome>> {
        let executor = &self.control.executor;
        let mut planned = words.clone();
        let mut halt = None;
        let mut is_known = true;
        // A known value can be computed from terms, as 0 times one; the control would compute it again.
        let mut is_computed = false;
        planned.for_each_word(|role, word| {
            if halt.is_some() {
                return;
            }
            is_computed |= matches!(word.value, WordOperand::Code(_));
            match executor.word_value(words, role, word, oracle) {
                Ok(Some(term)) => {
                    is_known &= term.number().is_some();
                    word.value = WordOperand::Number(term.stored());
                }
                Ok(None) => {}
                Err(reason) => halt = Some(reason),
            }
        });
        if let Some(halt) = halt {
            return Err(halt);
        }
        let has_terms = executor.registers.has_terms_in_state();
        let is_special = executor.registers.state.is_in_parameter_input
            || executor
                .flow
                .triggered_call()
                .is_some_and(|call| executor.flow.modal_calls[call].is_every_block);
        if is_known && !is_computed && !has_terms && !is_conditional {
            return Ok(self.control.step(library, &mut ()));
        }
        if is_special {
            return Err(Halt::unfollowed("a block of G10 L52 or under G66.1"));
        }
        self.plan_terms(planned, number, place, oracle, library)
    }

    /// Plans a block whose words are terms, and carries it out.
    fn plan_terms<T: Terms>(
        &mut self,
        mut words: Words,
        number: Option<u32>,
        place: Place,
        oracle: &mut Oracle<'_, T>,
        library: &mut impl Library,
    ) -> Symbolic<Option<Outcome>> {
        let Control { executor, plan, block_words, .. } = &mut self.control;
        // A code that calls a program takes all words as arguments.
        let calls_by_code = !executor.registers.data.settings.code_calls.is_empty() && {
            plan.reset(&executor.registers.state);
            let planned = executor.planner(&words, block_words).plan_macro_call_by_code(plan);
            planned.map_err(|_| Halt::unfollowed("a block of which a code may call a program"))?
        };
        let mut terms = BlockTerms::default();
        if !calls_by_code {
            terms = executor.replace_terms(&mut words, oracle)?;
        }
        if !terms.is_none() || executor.registers.has_terms_in_state() {
            return self.move_by_terms(&words, &terms, number, place, oracle, library);
        }
        plan.reset(&executor.registers.state);
        executor.plan_words(&words, block_words, plan)?;
        plan.state.modal_words.n = number.unwrap_or(plan.state.modal_words.n);
        executor.begin(place);
        self.carry_out(library)
    }

    /// Carries out the plan of the current block.
    pub(super) fn carry_out(&mut self, library: &mut impl Library) -> Symbolic<Option<Outcome>> {
        let result: ExecResult<()> = self.control.execute_plan(library, &mut ());
        result?;
        Ok(self.take_end())
    }
}

impl Executor {
    /// Returns the value of a word that isn't written as a number; `None` for any other, and for a vacant value.
    fn word_value<T: Terms>(
        &self,
        words: &Words,
        role: WordUse,
        word: &LoweredWord,
        oracle: &mut Oracle<'_, T>,
    ) -> Symbolic<Option<Term>> {
        let mut evaluation = Evaluation::new(&self.registers, oracle);
        if let Some(axis) = word.axis.and_then(|axis| words.axis(axis))
            && let SymbolicValue::Term(Term::Node(_)) = evaluation.operand(axis)?
        {
            return Err(Halt::unfollowed("the axis number of AX[…]"));
        }
        let rounds = match role {
            WordUse::Argument => RoundingTarget::Whole,
            WordUse::Plain | WordUse::Count => RoundingTarget::Increment,
        };
        let value = match word.value {
            WordOperand::Variable { slot, span } => evaluation.load(slot, span)?,
            WordOperand::Code(index) => evaluation.run_code(words.code(index), rounds)?,
            WordOperand::Number(_) | WordOperand::Literal(_) | WordOperand::G(..) => return Ok(None),
        };
        match value {
            SymbolicValue::Vacant => Ok(None),
            SymbolicValue::Term(term) => Ok(Some(term)),
            SymbolicValue::Truth(_) => Err(Halt::unfollowed("a condition as a word")),
        }
    }

    /// Replaces the terms of a block's words by numbers with which the control can plan it; returns those of axis words, F
    /// and S. Whole numbers are ways of their own, arguments stay terms.
    fn replace_terms<T: Terms>(&self, words: &mut Words, oracle: &mut Oracle<'_, T>) -> Symbolic<BlockTerms> {
        let mut terms = BlockTerms::default();
        let mut halt = None;
        let settings = &self.registers.data.settings;
        words.for_each_word(|role, word| {
            let WordOperand::Number(stored) = word.value else { return };
            let Some(term @ Term::Node(_)) = Term::of(stored) else { return };
            if halt.is_some() || role == WordUse::Argument {
                return;
            }
            let planned = match word.letter {
                letter if word.comma => Err(Halt::unfollowed(format!(",{}", char::from(letter)))),
                b'G' => tenths(term, oracle),
                b'P' if role == WordUse::Plain && settings.dwell_in_seconds => {
                    Err(Halt::unfollowed("P of a dwell in seconds"))
                }
                _ if role == WordUse::Count => oracle.pin(term),
                b'M' | b'T' | b'H' | b'D' | b'N' | b'L' | b'P' => oracle.pin(term),
                b'S' => speed(term, oracle, &mut terms),
                b'F' => {
                    terms.feed = Some(term);
                    Ok(100.0)
                }
                letter if settings.axes.find(letter).is_some() && word.axis.is_none() => {
                    terms.axes.push((letter, term));
                    Ok(0.0)
                }
                letter @ (b'I' | b'J' | b'K' | b'R' | b'Q') => {
                    terms.lengths.push((letter, term));
                    // Neither an arc nor a peck without length.
                    Ok(1.0)
                }
                letter => Err(Halt::unfollowed(format!("{} in this block", char::from(letter)))),
            };
            match planned {
                Ok(number) => word.value = WordOperand::Number(number),
                Err(reason) => halt = Some(reason),
            }
        });
        halt.map_or(Ok(terms), Err)
    }
}

/// Returns a computed G code, which is rounded to one decimal.
fn tenths<T: Terms>(term: Term, oracle: &mut Oracle<'_, T>) -> Symbolic<f64> {
    let product = oracle.terms.node(TermOperation::Multiply, [term, Term::Number(10.0)]);
    Ok(oracle.pin(product)? / 10.0)
}

/// Returns a spindle speed with which the control plans the block.
fn speed<T: Terms>(term: Term, oracle: &mut Oracle<'_, T>, terms: &mut BlockTerms) -> Symbolic<f64> {
    let whole = oracle.terms.node(TermOperation::Function(Function::Round), [term, term]);
    if oracle.ask(Test::Compare(Relation::Lt, whole, Term::Number(0.0)))? {
        return Ok(-1.0);
    }
    if oracle.ask(Test::Compare(Relation::Gt, whole, Term::Number(99_999.0)))? {
        return Ok(100_000.0);
    }
    if oracle.ask(Test::Compare(Relation::Lt, whole, Term::Number(1.0)))? {
        return Ok(0.0);
    }
    terms.speed = Some(whole);
    Ok(1.0)
}
