//! A run that goes back: from the last checkpoint before the place it executes the same blocks again.
//!
//! A position is a number of executed blocks. Changes from outside, a variable that is set or a block that is chosen, are
//! recorded with their position, and every later pass makes them again when it arrives there. A change at a position drops the
//! recorded changes behind it: from there on the run is another one.
use super::checkpoints::{Checkpoints, PlacedCheckpoint, SHORTEST_GAP};
use gcode_control::{Control, Outcome, Value};
use gcode_lang::alarm::Alarm;
use gcode_lang::motion::EventSink;
use gcode_lang::program::{Library, Memory, Program};
use gcode_lang::source::Span;
use gcode_lang::syntax::ast::ProgramName;

/// Number of blocks after which a run asks whether it is interrupted.
const INTERRUPTION_INTERVAL: u64 = 1024;

/// Change of a control between two blocks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Change {
    /// Assignment to a variable, with the locals of a macro level.
    Assign { level: usize, number: u32, value: Value },
    /// Choice of the next block, in the program at work.
    Jump { to: Span },
}

#[derive(Clone, Copy, Debug)]
struct RecordedChange {
    position: u64,
    change: Change,
}

/// Event sink that knows at which position of the run its events happen.
pub(crate) trait PositionedSink: EventSink {
    /// Called before the block at a position is executed.
    fn begin_block(&mut self, position: u64);
}

/// Run that goes forwards and backwards.
pub(crate) struct ReversibleRun {
    control: Control,
    library: Box<dyn Library>,
    checkpoints: Checkpoints,
    changes: Vec<RecordedChange>,
    /// Number of changes that are made, the first of the recorded ones.
    made_changes: usize,
    position: u64,
    has_entered: bool,
    next_block: Option<Span>,
    revision: u64,
}

impl ReversibleRun {
    /// Begins a run.
    pub(crate) fn new(control: Control, library: Box<dyn Library>) -> Self {
        Self::with_gap(control, library, SHORTEST_GAP)
    }

    /// Begins a run whose checkpoints near the present are so many blocks and moves apart.
    pub(crate) fn with_gap(mut control: Control, library: Box<dyn Library>, gap: u64) -> Self {
        let start = PlacedCheckpoint::new((0, 0), 0, true, control.checkpoint());
        let next_block = control.next_block();
        Self {
            control,
            library,
            checkpoints: Checkpoints::new(start, gap),
            changes: Vec::new(),
            made_changes: 0,
            position: 0,
            has_entered: true,
            next_block,
            revision: 0,
        }
    }

    /// Returns the control, whose next block is lowered.
    pub(crate) fn control(&self) -> &Control {
        &self.control
    }

    /// Returns true if a program is loaded, or the library has it.
    pub(crate) fn has_program(&mut self, name: &ProgramName) -> bool {
        let mut loaded = self.control.memory().programs().iter();
        loaded.any(|program| program.name == *name)
            || match name {
                ProgramName::Number(number) => self.library.program(*number).is_some(),
                ProgramName::Name(name) => self.library.named(name).is_some(),
                ProgramName::Unnamed => false,
            }
    }

    /// Returns true if a program, loaded or in the library, has a sequence number. Without a name it is the main program.
    pub(crate) fn has_number(&mut self, name: Option<&ProgramName>, number: u32) -> bool {
        let has = |program: &Program| program.find_number(number, 0).is_some();
        let memory = self.control.memory();
        let Some(name) = name else { return has(memory.get(memory.main())) };
        let mut loaded = memory.programs().iter().filter(|program| program.name == *name).peekable();
        if loaded.peek().is_some() {
            return loaded.any(has);
        }
        let text = match name {
            ProgramName::Number(number) => self.library.program(*number),
            ProgramName::Name(name) => self.library.named(name),
            ProgramName::Unnamed => None,
        };
        text.is_some_and(|(file, bytes)| {
            let mut memory = Memory::default();
            memory.load(file, bytes);
            memory.programs().iter().any(has)
        })
    }

    /// Returns the number of executed blocks.
    pub(crate) fn position(&self) -> u64 {
        self.position
    }

    /// Returns true at the start of the run and where the block before has led into a called program, or to its next pass.
    pub(crate) fn has_entered(&self) -> bool {
        self.has_entered
    }

    /// Returns the next block; `None` behind the last one of a program.
    pub(crate) fn next_block(&self) -> Option<Span> {
        self.next_block
    }

    /// Returns a number that every change increases.
    pub(crate) fn revision(&self) -> u64 {
        self.revision
    }

    fn work(&self) -> u64 {
        self.position + self.control.moves()
    }

    /// Executes one block; returns the outcome if that ends the run. Then the position is still that of the block.
    pub(crate) fn step(&mut self, sink: &mut impl EventSink) -> Option<Outcome> {
        let work = self.work();
        if self.checkpoints.is_due(work) {
            let (place, state) = ((self.position, work), self.control.checkpoint());
            self.checkpoints.add(PlacedCheckpoint::new(place, self.made_changes, self.has_entered, state));
        }
        let (depth, passes) = (self.control.call_depth(), self.control.passes_left());
        if let Some(outcome) = self.control.step(&mut self.library.as_mut(), sink) {
            return Some(outcome);
        }
        self.position += 1;
        let is_next_pass = || self.control.call_depth() == depth && self.control.passes_left() < passes;
        self.has_entered = self.control.call_depth() > depth || is_next_pass();
        self.arrive();
        None
    }

    /// Makes the changes recorded for this position and lowers the next block.
    fn arrive(&mut self) {
        while let Some(recorded) = self.changes.get(self.made_changes)
            && recorded.position == self.position
        {
            // It was possible here before.
            _ = make(&mut self.control, recorded.change);
            self.made_changes += 1;
        }
        self.next_block = self.control.next_block();
    }

    /// Makes a change here and records it; a refused one leaves everything as it is.
    pub(crate) fn change(&mut self, change: Change) -> Result<(), ChangeRefusal> {
        make(&mut self.control, change)?;
        self.changes.truncate(self.made_changes);
        self.changes.push(RecordedChange { position: self.position, change });
        self.made_changes += 1;
        self.revision += 1;
        self.checkpoints.rewind(self.position);
        self.next_block = self.control.next_block();
        Ok(())
    }

    /// Returns true if a block was chosen as the next one here.
    pub(crate) fn has_jumped_here(&self) -> bool {
        self.last_jump().is_some_and(|jump| self.changes[jump].position == self.position)
    }

    fn last_jump(&self) -> Option<usize> {
        let made = &self.changes[..self.made_changes];
        made.iter().rposition(|recorded| matches!(recorded.change, Change::Jump { .. }))
    }

    /// Drops the last choice of a block here and the changes behind it. Returns false without one.
    pub(crate) fn undo_jump(&mut self) -> bool {
        let Some(jump) = self.last_jump().filter(|_| self.has_jumped_here()) else { return false };
        let position = self.position;
        self.changes.truncate(jump);
        self.revision += 1;
        // The checkpoint of this position may have the choice.
        self.checkpoints.rewind(position.saturating_sub(1));
        self.go_back_to(position);
        true
    }

    /// Goes to an earlier position, or to this one as it was before the block that has ended the run.
    pub(crate) fn go_back_to(&mut self, position: u64) {
        let checkpoint = self.checkpoints.rewind(position);
        self.control.restore(&checkpoint.state);
        (self.position, self.made_changes) = (checkpoint.position, checkpoint.changes);
        self.has_entered = checkpoint.has_entered;
        self.arrive();
        while self.position < position && self.step(&mut ()).is_none() {}
    }

    /// Returns the position of the last checkpoint before a position.
    pub(crate) fn checkpoint_before(&self, position: u64) -> u64 {
        self.checkpoints.position_before(position)
    }

    /// Runs another control from the start with the changes of this run, up to a number of blocks. Returns false if it is
    /// interrupted before its end.
    pub(crate) fn run_again(
        &mut self,
        mut control: Control,
        blocks: u64,
        sink: &mut impl PositionedSink,
        is_interrupted: &dyn Fn() -> bool,
    ) -> bool {
        let mut changes = self.changes.iter().peekable();
        for position in 0..blocks {
            if position.is_multiple_of(INTERRUPTION_INTERVAL) && is_interrupted() {
                return false;
            }
            while let Some(recorded) = changes.next_if(|recorded| recorded.position == position) {
                _ = make(&mut control, recorded.change);
            }
            sink.begin_block(position);
            if control.step(&mut self.library.as_mut(), sink).is_some() {
                break;
            }
        }
        true
    }
}

/// Reason why a change is not made.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ChangeRefusal {
    /// The alarm of the assignment.
    Alarm(Alarm),
    /// The block is not one of the program at work.
    OtherProgram,
}

fn make(control: &mut Control, change: Change) -> Result<(), ChangeRefusal> {
    match change {
        Change::Assign { level, number, value } => {
            control.assign(level, number, value).map_err(ChangeRefusal::Alarm)
        }
        Change::Jump { to } if control.jump_to(to) => Ok(()),
        Change::Jump { .. } => Err(ChangeRefusal::OtherProgram),
    }
}
