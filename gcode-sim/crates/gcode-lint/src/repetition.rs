//! Repeated moves, left out of a check: they tell no rule anything that an earlier move of the same form does not.
//!
//! A long file consists of moves of axis words with decimal points. No rule depends on their values and comments, only on the form
//! of a block (its letters and its code) and the modes in which it stands. In a run of moves one block of each form in each mode
//! stands for all of them, and the last block for the end of the run. If a rule finds something at such a block, or a jump
//! may lead to a sequence number that is left out, all blocks are checked. The rule of repeated sequence numbers knows those
//! that are left out.
use std::collections::{BTreeMap, BTreeSet};

use gcode_lang::control::Settings;
use gcode_lang::diag::Diagnostic;
use gcode_lang::program::{CallOp, CallTarget, Memory, Op, OpIndex, OpKind, Program, ProgramId, WordOperand};
use gcode_lang::source::SourceId;
use gcode_lang::syntax::KnownBlocks;

use super::context::{LeftOutNumber, LoadedProgram};
use super::{literal, rules};

/// Programs under check of which repeated moves are left out.
#[derive(Debug, Default)]
pub(super) struct Repetitions {
    /// The whole programs.
    programs: Vec<(ProgramId, Program)>,
    /// Blocks that stand for others, by text and offset.
    stand_ins: BTreeSet<(SourceId, u32)>,
    /// A block within a run has a sequence number.
    has_numbers: bool,
    /// Sequence numbers that are left out, by program.
    numbers: BTreeMap<ProgramId, Vec<LeftOutNumber>>,
}

/// Form of a move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct MoveForm {
    /// G00 to G03 of the block, in tenths.
    code: Option<u32>,
    /// Letters of the other words as bits, A the lowest.
    letters: u32,
    /// Letters whose numbers have a decimal point.
    pointed: u32,
    has_number: bool,
}

/// What the moves of a run before a block have set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
struct MoveModes {
    code: Option<u32>,
    has_feed: bool,
}

/// A run of moves.
#[derive(Debug, Default)]
struct MoveRun {
    modes: MoveModes,
    /// The last block has a sequence number.
    is_numbered: bool,
    /// The first block of each form in each mode, as its offset.
    first: BTreeMap<(MoveModes, MoveForm), u32>,
    /// The last block and its offset, if it is left out.
    last_left_out: Option<(OpIndex, u32)>,
}

impl Repetitions {
    /// Replaces a program in memory by one without its repeated moves.
    pub(super) fn leave_out(&mut self, memory: &mut Memory, id: ProgramId, settings: &Settings) {
        // A code or an address that calls a program may make a call of a move.
        if !settings.code_calls.is_empty() {
            return;
        }
        let program = memory.get(id);
        let source = program.span.source;
        let mut is_left_out = vec![false; program.block_count()];
        let mut run = MoveRun::default();
        let mut numbers: Vec<(OpIndex, LeftOutNumber)> = Vec::new();
        program.visit_number_blocks(|block, read| {
            let op = read.filter(|(_, comment)| !is_read_by_rule(comment)).map(|(op, _)| op);
            let form = op.and_then(|op| MoveForm::of(op, settings).zip(Some(op)));
            let Some((form, op)) = form else {
                self.end_run(&std::mem::take(&mut run), source, &mut is_left_out);
                return;
            };
            let start = op.span.start;
            // A jump may lead to a number; where all blocks have one, no jump is likely.
            if form.has_number && !run.is_numbered {
                self.end_run(&std::mem::take(&mut run), source, &mut is_left_out);
            }
            self.has_numbers |= form.has_number && run.is_numbered;
            run.is_numbered = form.has_number;
            let first = *run.first.entry((run.modes, form)).or_insert(start);
            // A block that changes the mode stays: the rest would be judged in another one.
            let keeps_mode = form.code.is_none() || form.code == run.modes.code;
            is_left_out[block] = keeps_mode && first != start;
            run.last_left_out = None;
            if is_left_out[block] {
                self.stand_ins.insert((source, first));
                run.last_left_out = Some((block, start));
                let numbered = op.number.map(|number| (block, LeftOutNumber { number, block: op.span }));
                numbers.extend(numbered);
            }
            run.modes = run.modes.after(form);
        });
        self.end_run(&run, source, &mut is_left_out);
        if is_left_out.contains(&true) {
            let left_out = numbers.into_iter().filter(|(block, _)| is_left_out[*block]);
            self.numbers.insert(id, left_out.map(|(_, number)| number).collect());
            let short = program.without(&is_left_out);
            self.programs.push((id, memory.replace(id, short)));
        }
    }

    /// Keeps the last block of a run.
    fn end_run(&mut self, run: &MoveRun, source: SourceId, is_left_out: &mut [bool]) {
        if let Some((block, start)) = run.last_left_out {
            is_left_out[block] = false;
            self.stand_ins.insert((source, start));
        }
    }

    /// Puts the programs back that have more than `max_blocks` blocks and that `is_one` accepts. Returns them.
    pub(super) fn restore_long(
        &mut self,
        memory: &mut Memory,
        max_blocks: usize,
        is_one: impl Fn(ProgramId) -> bool,
    ) -> Vec<ProgramId> {
        let is_long = |(id, whole): &(ProgramId, Program)| max_blocks < whole.block_count() && is_one(*id);
        let (long, others) = std::mem::take(&mut self.programs).into_iter().partition(is_long);
        self.programs = others;
        let long: Vec<(ProgramId, Program)> = long;
        let put_back = |(id, whole)| {
            memory.replace(id, whole);
            id
        };
        long.into_iter().map(put_back).collect()
    }

    /// Returns true if a block within a run has a sequence number.
    pub(super) fn has_numbers(&self) -> bool {
        self.has_numbers
    }

    /// Returns true if one of the blocks that stand for others has a finding.
    pub(super) fn stand_for_found(&self, findings: &[Diagnostic]) -> bool {
        findings.iter().any(|finding| {
            let place = finding.backtrace.as_ref().map(|place| (place.block.source, place.block.start));
            finding.kind != rules::DOUBLED_N && place.is_some_and(|place| self.stand_ins.contains(&place))
        })
    }

    /// Returns the sequence numbers that are left out of a program, in the order of the blocks.
    pub(super) fn take_numbers(&mut self, id: ProgramId) -> Vec<LeftOutNumber> {
        self.numbers.remove(&id).unwrap_or_default()
    }

    /// Puts the whole programs back.
    pub(super) fn restore(self, memory: &mut Memory, settings: &Settings, programs: &mut [LoadedProgram]) {
        for (id, whole) in self.programs {
            memory.replace(id, whole);
            for program in programs.iter_mut().filter(|program| program.id == id) {
                let (blocks, marks) = (&mut program.blocks, &mut program.marks);
                let mut known = KnownBlocks::of((std::mem::take(blocks), std::mem::take(marks)));
                *program = LoadedProgram::new(memory, id, &mut known, settings);
            }
        }
    }
}

/// Returns true for a comment that a rule may read: it turns rules off, or has a jump.
fn is_read_by_rule(comment: &[u8]) -> bool {
    const READ: [&[u8]; 2] = [b"CHECK-OFF", b"GOTO"];
    READ.iter().any(|word| comment.windows(word.len()).any(|part| part.eq_ignore_ascii_case(word)))
}

impl MoveForm {
    /// Returns the form of a block of numbers; `None` if it moves no axis, has more than G00 to G03, axes, the words of an arc
    /// and F, or has a number that a rule may judge.
    fn of(op: &Op, settings: &Settings) -> Option<Self> {
        let OpKind::Words(words) = op.kind() else { return None };
        let mut form = Self { code: None, letters: 0, pointed: 0, has_number: op.number.is_some() };
        let mut is_move = false;
        for word in &words.list {
            let number = match word.value {
                WordOperand::G(code @ (0 | 10 | 20 | 30), _) if form.code.is_none() => {
                    form.code = Some(code);
                    continue;
                }
                WordOperand::Literal(number) => number,
                _ => return None,
            };
            let is_axis = settings.axes.find(word.letter).is_some();
            is_move |= is_axis;
            let is_plain = match word.letter {
                b'F' => number.digits != 0 && !number.negative,
                letter => (is_axis || b"IJKR".contains(&letter)) && literal::without_point(word).is_none(),
            };
            let letter = 1 << word.letter.checked_sub(b'A')?;
            if !is_plain || form.letters & letter != 0 {
                return None;
            }
            form.letters |= letter;
            form.pointed |= if number.places.is_some() { letter } else { 0 };
        }
        is_move.then_some(form)
    }
}

impl MoveModes {
    fn after(self, form: MoveForm) -> Self {
        let has_feed = form.letters & 1 << (b'F' - b'A') != 0;
        Self { code: form.code.or(self.code), has_feed: self.has_feed || has_feed }
    }
}

/// Returns true if a block of some programs may jump to a sequence number.
pub(super) fn have_jumps(memory: &Memory, programs: impl IntoIterator<Item = ProgramId>) -> bool {
    programs.into_iter().flat_map(|id| memory.get(id).ops()).any(|op| may_jump(op.kind()))
}

/// Returns true for a block that may jump to a sequence number, or call a program that does.
fn may_jump(kind: &OpKind) -> bool {
    let is_numbered = |call: &CallOp| call.start.is_some() || !matches!(call.target, CallTarget::None);
    match kind {
        OpKind::Words(words) => {
            let is_local_call =
                words.list.iter().any(|word| word.letter == b'M' && literal::word_count(word) == Some(97));
            is_local_call || words.call().is_some_and(is_numbered)
        }
        OpKind::Statement(_) | OpKind::If { .. } => true,
        OpKind::Empty | OpKind::AssignDirect(_) | OpKind::Alarm(_) => false,
    }
}

#[cfg(test)]
mod tests {
    use gcode_lang::program::NoLibrary;
    use proptest::collection::vec;
    use proptest::prelude::*;

    use super::super::context::CheckContext;
    use super::*;
    use crate::check;

    /// Text after the moves: shortly before the end of a text no block is read as numbers alone.
    const END: &str = "(THE END OF THE WHOLE PROGRAM)\n";

    /// Returns the findings of a check of all blocks.
    fn whole(text: &str, settings: &Settings) -> Vec<Diagnostic> {
        let mut memory = Memory::default();
        memory.load("O1.nc", text.as_bytes().to_vec());
        let programs: Vec<_> = memory.ids().collect();
        let load = |id| LoadedProgram::new(&mut memory, id, &mut KnownBlocks::default(), settings);
        let programs = programs.into_iter().map(load).collect();
        let knowledge = crate::ControlKnowledge::Stated;
        rules::findings(&CheckContext::new(&memory, (settings, knowledge), programs, rules::codes()))
    }

    fn left_out(text: &str) -> usize {
        let mut memory = Memory::default();
        memory.load("O1.nc", format!("{text}{END}").into_bytes());
        let id = memory.ids().next().unwrap();
        let blocks = memory.get(id).block_count();
        Repetitions::default().leave_out(&mut memory, id, &Settings::default());
        blocks - memory.get(id).block_count()
    }

    #[test]
    fn a_run_keeps_one_move_of_each_form_and_its_last() {
        let runs = "O1\nG90\nX1.\nX2.\nX3.Y1.\nX4.\nX5.Y2.\n";
        // The second and the fourth X; Y2. is the last.
        assert_eq!(left_out(&format!("{runs}M30\n")), 2);
        // Before G01 and after it, before F and after it: X2., X3., X6. and X9. are left out; X10. is the last.
        let modes = "O1\nX1.\nX2.\nX3.\nG1X4.\nX5.\nX6.\nX7.F9.\nX8.\nX9.\nX10.\n";
        assert_eq!(left_out(modes), 4);
        // Both G01 are kept: the moves behind each stand in its mode.
        let changes = "O1\nF9.\nG1X1.\nG2X2.R5.\nG1X3.\nG2X4.R5.\nG1X5.\nX6.\nX7.\nX8.\n";
        assert_eq!(left_out(changes), 1);
        assert_eq!(left_out("O1\nX1\nX2\nX3\n"), 0, "without a point");
        assert_eq!(left_out("O1\nX1.\nX2. (A)\nX3.(B) \nX4.\n"), 2, "comments are none of the form");
        let read = ["(CHECK-OFF MISSING-FEED)", "(IF[#1 EQ 1]goto 5)", "(A)(B)", "(A(B))", "(A", "(A) Y1."];
        for comment in read {
            let text = format!("O1\nX1.\nX2. {comment}\nX3.\n");
            assert_eq!(left_out(&text), 0, "{comment} ends the run");
        }
    }

    fn block() -> impl Strategy<Value = String> {
        let number = "-?[0-9]{1,2}\\.?[0-9]?";
        let moves = format!(
            "(N[1-4]0 ?)?(G0?[0-3])?(X{number})?(Y{number})?(I{number})?(R{number})?(F[0-9]0\\.?)?( ?\\(A\\) ?)?"
        );
        let others = "N9999 M9|M30|M99|G81Z-1\\.R1\\.|G80|#1=#2|IF\\[#1EQ#0\\]GOTO[1-4]0|GOTO[1-4]0|M98P2|M98P2Q20|WHILE\\[#1LT2\\]DO1|END1\
            |G10L52|G11|#3=#5021|\\(CHECK-OFF MISSING-FEED\\)|G20|G40 X1\\.|U5\\.|O2|M3M4|M99P20|X#1";
        let of = |pattern: &str| proptest::string::string_regex(pattern).unwrap();
        prop_oneof![6 => of(&moves), 1 => of(others)]
    }

    proptest! {
        #[test]
        fn a_check_without_repeated_moves_finds_what_a_check_of_all_blocks_finds(
            blocks in vec((block(), 1_usize..4), 1..25),
            has_feed in any::<bool>(),
        ) {
            let blocks: String = blocks.iter().map(|(block, times)| format!("{block}\n").repeat(*times)).collect();
            let feed = if has_feed { "F100.\n" } else { "" };
            let text = format!("O1\n{feed}{blocks}{END}");
            let settings = Settings::default();
            let short = check("O1.nc", text.as_bytes(), &settings, &mut NoLibrary).findings;
            let shown = |findings: &[Diagnostic]| {
                let each = findings.iter().map(|f| {
                    format!("{} {} {:?} {:?} {:?} {:?}", f.kind, f.message, f.backtrace, f.span, f.labels, f.help)
                });
                each.collect::<Vec<_>>()
            };
            prop_assert_eq!(shown(&short), shown(&whole(&text, &settings)), "{}", text);
        }
    }
}
