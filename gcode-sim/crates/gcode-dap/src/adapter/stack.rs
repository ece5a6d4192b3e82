//! The stack: the program at work, its callers, each with its block.
use super::program_files::BlockSite;
use super::{Adapter, Answer, Host, THREAD, body, check_thread};
use crate::protocol::arguments;
use crate::protocol::bodies::{StackFrame, StackTrace, Thread, Threads};
use gcode_control::StackedProgram;

/// Block that the client may choose as the next one.
#[derive(Clone, Debug)]
pub(super) struct GotoTarget {
    /// Canonical path of the file.
    pub(super) path: String,
    pub(super) site: BlockSite,
}

/// Frames are numbered from the main program, 1, upwards: a frame keeps its number while its program is at work.
const MAIN_FRAME: i64 = 1;

impl<H: Host> Adapter<H> {
    pub(super) fn threads(&mut self) -> Answer {
        let label = |session: &super::Session| {
            let memory = session.debuggee.control().memory();
            memory.programs().get(memory.main().0 as usize).map(|program| program.label())
        };
        let name = self.session.as_ref().and_then(label).unwrap_or_else(|| "control".to_owned());
        body(Threads { threads: vec![Thread { id: THREAD, name }] })
    }

    pub(super) fn stack_trace(&mut self, arguments: &arguments::StackTrace) -> Answer {
        check_thread(arguments.thread_id)?;
        let frames = self.frames()?;
        let total_frames = frames.len();
        let start = usize::try_from(arguments.start_frame.unwrap_or_default()).unwrap_or_default();
        // 0 levels are all of them.
        let levels = arguments.levels.and_then(|levels| usize::try_from(levels).ok());
        let levels = levels.filter(|levels| *levels > 0).unwrap_or(total_frames);
        let stack_frames = frames.into_iter().skip(start).take(levels).collect();
        body(StackTrace { stack_frames, total_frames })
    }

    /// Returns all frames, innermost first.
    pub(super) fn frames(&mut self) -> Result<Vec<StackFrame>, String> {
        let control = self.standing()?.debuggee.control();
        let stack = control.call_stack();
        let memory = control.memory();
        let numbered = |one: &StackedProgram| {
            let program = memory.get(one.program);
            let block = program.block_texts().index_at(one.block.start).and_then(|index| program.op(index));
            let number = block.and_then(|op| op.number).map(|number| format!(" N{number}"));
            program.label() + &number.unwrap_or_default()
        };
        let named: Vec<_> = stack.iter().map(|one| (numbered(one), one.block)).collect();
        let count = named.len() as i64;
        let frame = |(index, (name, block)): (usize, (String, _))| {
            let (source, line, column) = match self.place(block) {
                Some((source, line, column)) => (Some(source), line, column),
                None => (None, 0, 0),
            };
            StackFrame { id: MAIN_FRAME + count - 1 - index as i64, name, source, line, column }
        };
        Ok(named.into_iter().enumerate().map(frame).collect())
    }

    /// Returns the stack and the index of a frame in it; the innermost without a frame.
    pub(super) fn frame_index(&mut self, frame: Option<i64>) -> Result<(Vec<StackedProgram>, usize), String> {
        let stack = self.standing()?.debuggee.control().call_stack();
        let Some(frame) = frame else { return Ok((stack, 0)) };
        let above_main = frame.checked_sub(MAIN_FRAME).and_then(|above| usize::try_from(above).ok());
        let index = above_main.and_then(|above| stack.len().checked_sub(above.checked_add(1)?));
        let index = index.ok_or_else(|| format!("there is no frame {frame}"))?;
        Ok((stack, index))
    }

    /// Returns the macro level of a frame.
    pub(super) fn level_of_frame(&mut self, frame: Option<i64>) -> Result<usize, String> {
        let (stack, index) = self.frame_index(frame)?;
        Ok(stack[index].level)
    }
}
