//! Conditions and jumps that outside values decide, and how long they do: to the block where both ways meet again.
//!
//! A way that ends in an alarm decides nothing: the control stops, and no hole is cut behind it.
use super::possible_motion::PossibleMotion;
use super::{Block, Marks, Slice};
use crate::control::Control;
use crate::flow::ProgramFlow;
use crate::functions::integer;
use crate::registers::Registers;
use gcode_lang::program::m_codes::ends_or_stops;
use gcode_lang::program::{
    AssignmentTarget, CallCode, OpIndex, OpKind, Operand, Program, ProgramId, Statement, WordOperand, Words,
};

/// Blocks between a jump and the place where both ways meet: longer stretches count as open to the end of the run.
const MAX_STRETCH: usize = 1000;

/// Blocks whose execution outside values decide.
#[derive(Clone, Debug, Default)]
pub(super) struct Branches {
    /// Open branches, the innermost last.
    open: Vec<Branch>,
    /// Marks that decide everything from now on.
    lasting: Marks,
    /// Marks of the condition of the current block.
    guard: Marks,
    /// Branch that the current block begins.
    request: Option<(Marks, Option<OpIndex>)>,
}

/// Blocks of one program up to the place where both ways meet.
#[derive(Clone, Debug)]
struct Branch {
    program: ProgramId,
    /// Number of callers.
    depth: usize,
    first: OpIndex,
    /// Operation at which both ways meet.
    end: OpIndex,
    marks: Marks,
}

impl Branches {
    /// Returns the marks of everything that decides whether the current block is executed.
    pub(super) fn marks(&self) -> Marks {
        self.open.iter().map(|branch| branch.marks).collect::<Marks>() | self.lasting | self.guard
    }

    /// Adds marks that decide everything from now on.
    pub(super) fn stay(&mut self, marks: Marks) {
        self.lasting |= marks;
    }

    /// Sets the marks of the condition of the current block, and returns those before.
    pub(super) fn set_guard(&mut self, marks: Marks) -> Marks {
        let outer = self.guard;
        self.guard = outer | marks;
        outer
    }

    /// Requests a branch from the current block to the target of its jump; `None` for an unknown target.
    pub(super) fn request_jump(&mut self, marks: Marks, target: Option<OpIndex>) {
        // The block of a condition inside another belongs to both.
        let outer = self.request.take().map_or(Marks::NONE, |(outer, _)| outer);
        self.request = Some((outer | marks, target));
    }

    /// Requests a branch for a loop; `end` is the operation of its END.
    pub(super) fn request_loop(&mut self, marks: Marks, end: OpIndex) {
        self.request_jump(marks, Some(end + 1));
    }

    /// Closes the branches that end before the next block.
    pub(super) fn enter(&mut self, flow: &ProgramFlow) {
        self.guard = Marks::NONE;
        self.request = None;
        let depth = flow.callers.len();
        while let Some(last) = self.open.last() {
            if last.depth < depth {
                return;
            }
            let is_inside = last.depth == depth
                && last.program == flow.frame.program
                && (last.first..last.end).contains(&flow.frame.next);
            if is_inside {
                return;
            }
            let has_met =
                last.depth == depth && last.program == flow.frame.program && flow.frame.next == last.end;
            if !has_met {
                // The run has left the stretch another way.
                self.lasting |= last.marks;
            }
            self.open.pop();
        }
    }
}

impl Block<'_> {
    /// Returns the operation to which a jump with a literal number leads.
    pub(super) fn jump_target(&self, to: &Operand) -> Option<OpIndex> {
        let Operand::Number(number) = to else { return None };
        literal_target(self.registers, self.program, *number, self.flow.frame.next + 1)
    }
}

/// Returns the operation of a literal sequence number; `None` where it depends on the control.
fn literal_target(registers: &Registers, program: &Program, number: f64, next: OpIndex) -> Option<OpIndex> {
    let number = u32::try_from(integer(number).ok()?).ok().filter(|number| *number != 0)?;
    let takes_first = registers.data.settings.undocumented.goto_takes_first_number;
    program.find_number(number, if takes_first { 0 } else { next })
}

impl Slice {
    /// Opens the branch that the current block has requested.
    pub(super) fn open_branch(&mut self, control: &mut Control) {
        let Some((marks, target)) = self.branches.request.take() else { return };
        let here = control.executor.flow.frame.next;
        let program = control.executor.flow.frame.program;
        let depth = control.executor.flow.callers.len();
        let Some(target) = target else { return self.leave(marks) };
        if leads_to_alarm(control, program, target) {
            return;
        }
        let (first, end) = if here < target { (here, target) } else { (target, here + 1) };
        if MAX_STRETCH < end - first || !is_closed(control, program, first, end) {
            return self.leave(marks);
        }
        let registers = &control.executor.registers;
        let Some(program_of) = control.memory.get_mut(program) else { return self.leave(marks) };
        let mut has_ways = target <= here;
        let mut of_ways = PossibleMotion::of_ways(registers);
        for index in first..end {
            let Some((_, op)) = program_of.lower_block(index) else { continue };
            of_ways = of_ways.behind(registers, op.kind());
            has_ways |= index != here && matches!(op.kind(), OpKind::Statement(one) if jumps(one));
        }
        let mut motion = if has_ways { of_ways } else { PossibleMotion::of(registers) };
        for index in first..end {
            let Some((_, op)) = program_of.lower_block(index) else { continue };
            let before = motion;
            self.add_possible_effects(registers, op.kind(), marks, &mut motion);
            if op.skip().is_some() {
                motion = motion.or(before);
            }
        }
        let same =
            self.branches.open.iter_mut().find(|open| {
                (open.program, open.depth, open.first, open.end) == (program, depth, first, end)
            });
        match same {
            Some(open) => open.marks |= marks,
            None => self.branches.open.push(Branch { program, depth, first, end, marks }),
        }
    }
}

/// Largest number of blocks before an alarm at the target of a jump.
const MAX_REASONS: OpIndex = 100;

/// Returns true if the blocks from `target` on raise an alarm before anything moves, as one of several `IF … THEN #3000=1`
/// and a last `#3000=2`. The other way then decides nothing but the alarm.
fn leads_to_alarm(control: &mut Control, program: ProgramId, target: OpIndex) -> bool {
    for index in target..target + MAX_REASONS {
        let Some((_, op)) = control.memory.get_mut(program).and_then(|program| program.lower_block(index))
        else {
            return false;
        };
        if op.skip().is_some() {
            return false;
        }
        match op.kind() {
            OpKind::Alarm(_) => return true,
            OpKind::Statement(statement) if raises_alarm(statement) => return true,
            OpKind::Statement(statement) if !jumps(statement) => {}
            OpKind::Empty | OpKind::AssignDirect(_) => {}
            OpKind::Statement(_) | OpKind::Words(_) | OpKind::If { .. } => return false,
        }
    }
    false
}

fn raises_alarm(statement: &Statement) -> bool {
    match statement {
        Statement::Alarm(_) => true,
        Statement::Assign { target: AssignmentTarget::Slot(slot), .. } => slot.number() == 3000,
        _ => false,
    }
}

/// Returns true if every way through these operations leads to `end`, or to an alarm.
fn is_closed(control: &mut Control, program: ProgramId, first: OpIndex, end: OpIndex) -> bool {
    let Control { memory, executor, .. } = control;
    let registers = &executor.registers;
    (first..end).all(|index| {
        let Some((program, op)) = memory.get_mut(program).and_then(|program| program.lower_block(index))
        else {
            return false;
        };
        let stays = |to: OpIndex| (first..=end).contains(&to);
        let jump_stays = |to: &Operand| match to {
            Operand::Number(number) => {
                literal_target(registers, program, *number, index + 1).is_some_and(stays)
            }
            Operand::Variable { .. } | Operand::Code(_) => false,
        };
        stays_inside(op.kind(), &stays, &jump_stays)
    })
}

fn stays_inside(
    kind: &OpKind,
    stays: &impl Fn(OpIndex) -> bool,
    jump_stays: &impl Fn(&Operand) -> bool,
) -> bool {
    match kind {
        OpKind::Empty | OpKind::AssignDirect(_) | OpKind::Alarm(_) => true,
        OpKind::Words(_) => !leaves_block(kind),
        OpKind::If { then, .. } => stays_inside(then, stays, jump_stays),
        OpKind::Statement(statement) => statement_stays(statement, stays, jump_stays),
    }
}

fn statement_stays(
    statement: &Statement,
    stays: &impl Fn(OpIndex) -> bool,
    jump_stays: &impl Fn(&Operand) -> bool,
) -> bool {
    match statement {
        Statement::Assignments(all) => all.iter().all(|one| statement_stays(one, stays, jump_stays)),
        Statement::Goto(to) | Statement::IfGoto { to, .. } => jump_stays(&to.node),
        Statement::IfThen { then, .. } => statement_stays(then, stays, jump_stays),
        Statement::While { end, .. } | Statement::Do { end, .. } => stays(*end),
        Statement::End { start, .. } => stays(*start),
        Statement::Assign { .. }
        | Statement::AssignDirect(_)
        | Statement::Alarm(_)
        | Statement::SetNames { .. }
        | Statement::Print { .. }
        | Statement::OpenOutput
        | Statement::CloseOutput => true,
    }
}

/// Returns true if a statement can continue elsewhere than behind its block, or end the run.
pub(super) fn jumps(statement: &Statement) -> bool {
    !statement_stays(statement, &|_| false, &|_| false)
}

/// Returns true if an operation can continue elsewhere than behind its block, or end the run; a called program returns.
pub(super) fn leaves_block(kind: &OpKind) -> bool {
    match kind {
        OpKind::Empty | OpKind::AssignDirect(_) | OpKind::Alarm(_) => false,
        OpKind::Statement(statement) => jumps(statement),
        OpKind::If { then, .. } => leaves_block(then),
        OpKind::Words(words) => leaves_words(words),
    }
}

fn leaves_words(words: &Words) -> bool {
    let ends = |word: &gcode_lang::program::LoweredWord| match (word.letter, word.value) {
        (b'M', WordOperand::Literal(number)) => ends_run(number.value()),
        (b'M', WordOperand::Number(number)) => ends_run(number),
        (b'M', _) => true,
        _ => false,
    };
    words.call().is_some_and(|call| call.kind == CallCode::Return) || words.list.iter().any(ends)
}

/// Returns true for M02 and M30.
fn ends_run(code: f64) -> bool {
    ends_or_stops(code as u32) && !matches!(code as u32, 0 | 1)
}
