//! A run: block by block to the end, to an alarm, or to a limit.
use std::sync::atomic::Ordering;

use super::block_effects::RunEnd;
use super::checked::ExecResult;
use super::control::Control;
use super::observer::Observer;
use super::outcome::{AlarmStop, Limits, Outcome};
use gcode_lang::motion::EventSink;
use gcode_lang::program::Library;

/// A run ends after so many moves, and so many for every block that it may execute: a cycle with K or with small
/// pecks is one block, and a loop round it must end as well.
const MIN_MOVE_LIMIT: u64 = 1_000_000;

const MOVES_PER_BLOCK: u64 = 20;

/// [`super::Progress`] is told after so many blocks.
const PROGRESS_INTERVAL: u64 = 4096;

impl Control {
    /// Runs to the end, to an alarm, or to a limit.
    pub fn run<S: EventSink>(&mut self, limits: Limits, library: &mut impl Library, sink: &mut S) -> Outcome {
        self.run_observed(limits, library, sink, &mut ())
    }

    /// As [`Control::run`], with somebody who looks on from block to block.
    pub fn run_observed<S: EventSink>(
        &mut self,
        limits: Limits,
        library: &mut impl Library,
        sink: &mut S,
        observer: &mut impl Observer,
    ) -> Outcome {
        if let Some(outcome) = self.final_outcome() {
            return outcome;
        }
        self.loop_detector.reset();
        self.executor.log.max_moves = limits.blocks.saturating_mul(MOVES_PER_BLOCK).max(MIN_MOVE_LIMIT);
        while self.executor.log.blocks < limits.blocks
            && self.executor.log.moves <= self.executor.log.max_moves
        {
            if self.executor.log.blocks.is_multiple_of(PROGRESS_INTERVAL) && self.is_cancelled() {
                break;
            }
            let until =
                limits.blocks.min((self.executor.log.blocks / PROGRESS_INTERVAL + 1) * PROGRESS_INTERVAL);
            while self.executor.log.blocks < until {
                observer.before_block(self);
                let until = if observer.is_active() { self.executor.log.blocks + 1 } else { until };
                let result = self.execute_block(until, library, sink);
                if !self.is_uneventful(&result)
                    && let Some(outcome) = self.conclude(result, sink)
                {
                    observer.after_block(self);
                    return *outcome;
                }
                observer.after_block(self);
            }
        }
        self.outcome = Some(Outcome::Limit);
        Outcome::Limit
    }

    /// Tells who watches how far the run is; whether it should end.
    pub fn is_cancelled(&self) -> bool {
        self.progress.as_ref().is_some_and(|progress| {
            progress.blocks.store(self.executor.log.blocks, Ordering::Relaxed);
            progress.cancel.load(Ordering::Relaxed)
        })
    }

    /// Does one block; `Some` when the run is over. A block that alarms has changed nothing.
    pub fn step<S: EventSink>(&mut self, library: &mut impl Library, sink: &mut S) -> Option<Outcome> {
        if let Some(outcome) = self.final_outcome() {
            return Some(outcome);
        }
        self.executor.log.max_moves = u64::MAX;
        let result = self.execute_block(self.executor.log.blocks + 1, library, sink);
        self.conclude(result, sink).map(|outcome| *outcome)
    }

    /// How the run ended, if it can't go on; a limit is no end.
    fn final_outcome(&self) -> Option<Outcome> {
        self.outcome.clone().filter(|outcome| !matches!(outcome, Outcome::Limit))
    }

    /// Whether a block has ended nothing and has nothing to tell, as most.
    #[inline(always)]
    fn is_uneventful(&self, result: &ExecResult<()>) -> bool {
        result.is_ok() && self.executor.registers.block_effects.is_none()
    }

    /// Takes note of what a block has to tell, and of the end of the run.
    #[inline(never)]
    fn conclude<S: EventSink>(&mut self, mut result: ExecResult<()>, sink: &mut S) -> Option<Box<Outcome>> {
        let (note, over) = self.executor.registers.block_effects.take();
        if over == Some(RunEnd::ProgramEnd)
            && let Err(alarm) = self.executor.finish_lookahead(sink)
        {
            result = Err(alarm);
        }
        if let Some(note) = note {
            self.executor.log.note(note, self.executor.flow.block);
        }
        let outcome = match result {
            Ok(()) => match over? {
                RunEnd::ProgramEnd => Outcome::End,
                RunEnd::EndlessLoop | RunEnd::MoveLimit => Outcome::Limit,
            },
            Err(alarm) => {
                self.executor.finish_before_alarm(&alarm, sink);
                let place = self.executor.flow.backtrace();
                Outcome::Alarm(AlarmStop { alarm: alarm.node, span: alarm.span, backtrace: place })
            }
        };
        // What was told at the end may have left something behind as well.
        self.executor.registers.block_effects.take();
        self.outcome = Some(outcome.clone());
        Some(Box::new(outcome))
    }
}
