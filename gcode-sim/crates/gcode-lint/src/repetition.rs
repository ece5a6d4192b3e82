//! Repeated moves and macro calls, left out of a check: they tell no rule anything that an earlier block of the same form does not.
//!
//! A long file consists of moves of axis words, or of calls, with decimal points. No rule depends on their values and comments,
//! only on the form of a block (its letters, its code, the called program) and the modes in which it stands. In a run of such
//! blocks one of each form in each mode stands for all of them, and the last move and the last call of each program for the end
//! of the run. A block to which its program jumps stays. If a rule finds something at a block that stands for others, or another
//! program may lead to a sequence number that is left out, all blocks are checked. The rule of repeated sequence numbers knows
//! those that are left out.
use std::collections::{BTreeMap, BTreeSet};

use gcode_lang::control::Settings;
use gcode_lang::diag::Diagnostic;
use gcode_lang::program::{LoweredWord, Memory, NumberBlock, OpIndex, Program, ProgramId, WordOperand};
use gcode_lang::source::SourceId;
use gcode_lang::syntax::KnownBlocks;

use super::context::{LeftOutBlocks, LeftOutNumber, LoadedProgram};
use super::jump_targets::JumpTargets;
use super::{literal, rules};

/// Programs under check of which repeated blocks are left out.
#[derive(Debug, Default)]
pub(super) struct Repetitions {
    /// The whole programs.
    programs: Vec<(ProgramId, Program)>,
    /// Blocks that stand for others, by text and offset.
    stand_ins: BTreeSet<(SourceId, u32)>,
    /// One of them has a finding.
    stand_for_found: bool,
    /// What is left out, by program.
    left_out: BTreeMap<ProgramId, LeftOutBlocks>,
}

/// What the blocks of a run do with the modes of motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum ModeSetter {
    /// G00 to G03, in tenths.
    Motion(u32),
    /// G65 of a program, which may set every mode.
    Call(u32),
}

/// Form of a move or of a macro call.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct BlockForm {
    setter: Option<ModeSetter>,
    /// Letters of the words with numbers as bits, A the lowest.
    letters: u32,
    /// Letters whose numbers have a decimal point.
    pointed: u32,
    has_number: bool,
}

/// Most mode setters of a run: another one begins the next run.
const MAX_SETTERS: usize = 6;

/// What the blocks of a run before a block have set: each setter once, in the order of its last block.
///
/// To set a mode twice is to set it the second time: no earlier block of the same setter matters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
struct RunModes {
    setters: [Option<ModeSetter>; MAX_SETTERS],
    has_feed: bool,
}

/// A run of moves and calls.
#[derive(Debug, Default)]
struct BlockRun {
    modes: RunModes,
    /// The last block has a sequence number.
    is_numbered: bool,
    /// The first block of each form in each mode, as its offset.
    first: BTreeMap<(RunModes, BlockForm), u32>,
    /// The last move, and the last call of each program: those that are left out.
    last_left_out: BTreeMap<Option<u32>, LeftOutBlock>,
    /// How many calls are left out for each that stands for them.
    calls: BTreeMap<u32, usize>,
    /// Number of lengths and angles with a decimal point that are left out.
    points: usize,
}

/// Block that is left out, and the one that stands for it.
#[derive(Clone, Copy, Debug)]
struct LeftOutBlock {
    index: OpIndex,
    start: u32,
    first: u32,
    points: usize,
}

impl Repetitions {
    /// Replaces a program in memory by one without its repeated blocks.
    pub(super) fn leave_out(&mut self, memory: &mut Memory, id: ProgramId, settings: &Settings) {
        // A code or an address that calls a program may make a call of a move.
        if !settings.code_calls.is_empty() {
            return;
        }
        let program = memory.get(id);
        let mut repeated = RepeatedBlocks::of(program, settings, &JumpTargets::default());
        if !repeated.numbers.is_empty() && repeated.is_left_out.contains(&true) {
            let targets = JumpTargets::of(program, &repeated.others);
            if repeated.numbers.iter().any(|(_, of_run)| targets.has(of_run.number)) {
                repeated = RepeatedBlocks::of(program, settings, &targets);
            }
        }
        if repeated.is_left_out.contains(&true) {
            let short = program.without(&repeated.is_left_out);
            let numbers = repeated.numbers().collect();
            let RepeatedBlocks { stand_ins, calls, points, .. } = repeated;
            self.stand_ins.extend(stand_ins);
            self.left_out.insert(id, LeftOutBlocks { numbers, calls, points });
            self.programs.push((id, memory.replace(id, short)));
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

    /// Returns true if a block that is left out has a sequence number.
    pub(super) fn has_numbers(&self) -> bool {
        self.left_out.values().any(|left_out| !left_out.numbers.is_empty())
    }

    /// Returns true if a block of some programs may lead to a sequence number of another one that is left out.
    pub(super) fn are_targets(&self, memory: &Memory, programs: impl IntoIterator<Item = ProgramId>) -> bool {
        let targets = JumpTargets::between(memory, programs);
        let mut left_out = self.left_out.values().flat_map(|left_out| &left_out.numbers);
        left_out.any(|left_out| targets.has(left_out.number))
    }

    /// Returns true if one of the blocks that stand for others has a finding.
    pub(super) fn stand_for_found(&self) -> bool {
        self.stand_for_found
    }

    /// Notes findings; those about all blocks of a program know of what is left out.
    pub(super) fn note_found(&mut self, findings: &[Diagnostic]) {
        self.stand_for_found |= findings.iter().any(|finding| {
            let place = finding.backtrace.as_ref().map(|place| (place.block.source, place.block.start));
            finding.kind != rules::DOUBLED_N
                && finding.kind != rules::MISSING_PROGRAM
                && place.is_some_and(|place| self.stand_ins.contains(&place))
        });
    }

    /// Returns what is left out of a program.
    pub(super) fn left_out(&self, id: ProgramId) -> LeftOutBlocks {
        self.left_out.get(&id).cloned().unwrap_or_default()
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

/// Blocks of a program that repeat others.
#[derive(Debug, Default)]
struct RepeatedBlocks {
    is_left_out: Vec<bool>,
    /// Sequence numbers of the blocks of runs.
    numbers: Vec<(OpIndex, LeftOutNumber)>,
    /// Blocks that belong to no run.
    others: Vec<OpIndex>,
    /// Blocks that stand for others, by text and offset.
    stand_ins: BTreeSet<(SourceId, u32)>,
    /// How many calls are left out for the one of the block at an offset.
    calls: BTreeMap<u32, usize>,
    /// Number of lengths and angles with a decimal point that are left out.
    points: usize,
}

impl RepeatedBlocks {
    /// Finds the repeated blocks. One to which `targets` lead belongs to no run.
    fn of(program: &Program, settings: &Settings, targets: &JumpTargets) -> Self {
        let source = program.span.source;
        let mut found = Self { is_left_out: vec![false; program.block_count()], ..Self::default() };
        let mut run = BlockRun::default();
        program.visit_number_blocks(|block, read| {
            let is_target = |read: &NumberBlock<'_>| read.number.is_some_and(|number| targets.has(number));
            let read = read.filter(|read| !is_read_by_rule(read.comment) && !is_target(read));
            let form = read.and_then(|read| BlockForm::of(&read, settings).zip(Some(read)));
            let Some((form, NumberBlock { number, span, words, .. })) = form else {
                found.end_run(std::mem::take(&mut run), source);
                found.others.push(block);
                return;
            };
            // Another program may lead to a number; where all blocks have one, none is likely to.
            let begins_numbers = form.has_number && !run.is_numbered;
            let after = run.modes.after(form).filter(|_| !begins_numbers);
            let after = after.unwrap_or_else(|| {
                found.end_run(std::mem::take(&mut run), source);
                run.modes.after(form).unwrap_or_default()
            });
            run.is_numbered = form.has_number;
            let first = *run.first.entry((run.modes, form)).or_insert(span.start);
            // A block that changes the mode stays: the rest would be judged in another one.
            found.is_left_out[block] = after.setters == run.modes.setters && first != span.start;
            let called = form.called();
            run.last_left_out.remove(&called);
            if found.is_left_out[block] {
                found.stand_ins.insert((source, first));
                let points = form.points(words);
                run.points += points;
                let last = LeftOutBlock { index: block, start: span.start, first, points };
                run.last_left_out.insert(called, last);
                if called.is_some() {
                    *run.calls.entry(first).or_default() += 1;
                }
            }
            found.numbers.extend(number.map(|number| (block, LeftOutNumber { number, block: span })));
            run.modes = after;
        });
        found.end_run(run, source);
        found
    }

    /// Keeps the last blocks of a run.
    fn end_run(&mut self, mut run: BlockRun, source: SourceId) {
        for LeftOutBlock { index, start, first, points } in run.last_left_out.into_values() {
            self.is_left_out[index] = false;
            self.stand_ins.insert((source, start));
            run.calls.entry(first).and_modify(|count| *count -= 1);
            run.points -= points;
        }
        self.calls.append(&mut run.calls);
        self.points += run.points;
    }

    /// Returns the sequence numbers of the blocks that are left out.
    fn numbers(&self) -> impl Iterator<Item = LeftOutNumber> + '_ {
        let left_out = self.numbers.iter().filter(|(block, _)| self.is_left_out[*block]);
        left_out.map(|(_, number)| *number)
    }
}

/// Returns true for a comment that a rule may read: it turns rules off, or has a jump.
fn is_read_by_rule(comment: &[u8]) -> bool {
    const READ: [&[u8]; 2] = [b"CHECK-OFF", b"GOTO"];
    READ.iter().any(|word| comment.windows(word.len()).any(|part| part.eq_ignore_ascii_case(word)))
}

/// Arguments of a macro call that are lengths or angles, and those that a control takes as they are.
const ARGUMENTS: (&[u8], &[u8]) = (b"ABCIJKQRUVWXYZ", b"DEFHST");

impl BlockForm {
    /// Returns the form of a block of numbers that a rule does not judge by their values; `None` for any other block.
    fn of(block: &NumberBlock<'_>, settings: &Settings) -> Option<Self> {
        let form = Self { setter: None, letters: 0, pointed: 0, has_number: block.number.is_some() };
        match block.words {
            [LoweredWord { value: WordOperand::G(650, _), .. }, words @ ..] => form.of_call(words),
            words => form.of_move(words, settings),
        }
    }

    /// Adds the words of a move; `None` if it moves no axis, or has more than G00 to G03, axes, the words of an arc and F.
    fn of_move(mut self, words: &[LoweredWord], settings: &Settings) -> Option<Self> {
        let mut is_move = false;
        for word in words {
            if let WordOperand::G(code @ (0 | 10 | 20 | 30), _) = word.value
                && self.setter.is_none()
            {
                self.setter = Some(ModeSetter::Motion(code));
                continue;
            }
            let is_axis = settings.axes.find(word.letter).is_some();
            is_move |= is_axis;
            let is_plain = match word.letter {
                b'F' => literal::word_number(word).is_some_and(|feed| 0.0 < feed),
                letter => (is_axis || b"IJKR".contains(&letter)) && literal::without_point(word).is_none(),
            };
            self.add(word).filter(|()| is_plain)?;
        }
        is_move.then_some(self)
    }

    /// Adds the words of a macro call behind its code; `None` if it has more than the program's number and arguments.
    fn of_call(mut self, words: &[LoweredWord]) -> Option<Self> {
        let (measured, others) = ARGUMENTS;
        for word in words {
            self.add(word)?;
            match word.letter {
                b'P' => self.setter = Some(ModeSetter::Call(literal::word_count(word)?)),
                letter if measured.contains(&letter) && literal::without_point(word).is_none() => {}
                letter if others.contains(&letter) => {}
                _ => return None,
            }
        }
        self.setter.is_some().then_some(self)
    }

    /// Adds a word with a number; `None` for another one, and for a letter that the block has.
    fn add(&mut self, word: &LoweredWord) -> Option<()> {
        let WordOperand::Literal(number) = word.value else { return None };
        let letter = 1 << word.letter.checked_sub(b'A')?;
        let is_new = self.letters & letter == 0;
        self.letters |= letter;
        self.pointed |= if number.places.is_some() { letter } else { 0 };
        is_new.then_some(())
    }

    /// Returns the number of lengths and angles other than 0 with a decimal point among the words.
    fn points(self, words: &[LoweredWord]) -> usize {
        let is_measure = |letter: u8| match self.called() {
            Some(_) => ARGUMENTS.0.contains(&letter),
            None => letter != b'F',
        };
        let is_pointed = |word: &&LoweredWord| match word.value {
            WordOperand::Literal(number) => number.places.is_some() && number.digits > 0,
            _ => false,
        };
        words.iter().filter(|word| is_measure(word.letter)).filter(is_pointed).count()
    }

    /// Returns the program that the block calls.
    fn called(self) -> Option<u32> {
        match self.setter {
            Some(ModeSetter::Call(program)) => Some(program),
            Some(ModeSetter::Motion(_)) | None => None,
        }
    }
}

impl RunModes {
    /// Returns the modes behind a block; `None` if the run has too many setters.
    fn after(mut self, form: BlockForm) -> Option<Self> {
        let is_call = form.called().is_some();
        self.has_feed |= !is_call && form.letters & 1 << (b'F' - b'A') != 0;
        let Some(new) = form.setter else { return Some(self) };
        // All codes of motion set the same modes.
        let is_replaced = |old: ModeSetter| old == new || !is_call && matches!(old, ModeSetter::Motion(_));
        let kept = self.setters.into_iter().flatten().filter(|old| !is_replaced(*old));
        let mut setters = [None; MAX_SETTERS];
        let mut places = setters.iter_mut();
        for setter in kept.chain([new]) {
            *places.next()? = Some(setter);
        }
        Some(Self { setters, ..self })
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
        // Behind the first call X1. stands in modes that it may have set. The last call of each program and the last move stay.
        let calls = "O1\nX1.\nG65P2A1.\nG65P2A2.\nG65 P2A3. (A)\nX2.\nX3.\nG65P2A4.S5\nG65P2A5.\nX4.\nX5.\n";
        assert_eq!(left_out(calls), 3, "A3., X3. and X4.");
        let two = "O1\nG65P2A1.\nG65P3\nG65P2A1.\nG65P3\nG65P3\nG65P3\nG65P3\n";
        assert_eq!(left_out(two), 1, "a call of another program changes the modes");
        let others = [
            "G65P2A1",
            "G65P2L2",
            "G65P2L2A1.",
            "G65P2A1.A2.",
            "G65A1.",
            "G65P2M98",
            "G65P#1",
            "G66P2A1.",
            "M98P2",
            "M3G65P2",
        ];
        for call in others {
            assert_eq!(left_out(&format!("O1\n{}", format!("{call}\n").repeat(5))), 0, "{call}");
        }
        let targets = "GOTO10\nN20 G65P2\nN20 G65P2\nN20 G65P2\nN10 G65P2F1\nM30\nO2\nM99\n";
        assert_eq!(left_out(&format!("O1\n{targets}")), 0, "the run ends before N10: its last call stays");
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
        let calls = "(N[1-4]0 )?G65 ?P[23](A[0-9]\\.)?(X[0-9]\\.[0-9])?(F[1-9])?( ?\\(A\\))?";
        let others = "N9999 M9|M30|M99|G81Z-1\\.R1\\.|G80|#1=#2|IF\\[#1EQ#0\\]GOTO[1-4]0|GOTO[1-4]0|M98P2|M98P2Q20|WHILE\\[#1LT2\\]DO1|END1\
            |G10L52|G11|GOTO#1|M97P20|#1=2GOTO10|M99P#2|#3=#5021|\\(CHECK-OFF MISSING-FEED\\)|G20|G40 X1\\.|U5\\.|O2|M3M4|M99P20|X#1";
        let of = |pattern: &str| proptest::string::string_regex(pattern).unwrap();
        prop_oneof![6 => of(&moves), 3 => of(calls), 1 => of(others)]
    }

    /// Returns a macro that may set modes, read positions, stop, or not return.
    fn called() -> impl Strategy<Value = String> {
        let block = "G0X#24\\.|G1Z[1-2]\\.(F#9)?|G4P10|#101=#5041|M30|M0|G91|G81Z1\\.R1\\.|IF\\[#1EQ#0\\]THEN#3000=1|#2=#1\\*#24|M99P20\
            |G65P3|IF\\[#0EQ#0\\]GOTO20|N20";
        vec(proptest::string::string_regex(block).unwrap(), 0..3).prop_map(|blocks| blocks.join("\n"))
    }

    proptest! {
        #[test]
        fn a_check_without_repeated_moves_finds_what_a_check_of_all_blocks_finds(
            blocks in vec((block(), 1_usize..4), 1..25),
            has_feed in any::<bool>(),
            called in proptest::option::of(called()),
        ) {
            let blocks: String = blocks.iter().map(|(block, times)| format!("{block}\n").repeat(*times)).collect();
            let feed = if has_feed { "F100.\n" } else { "" };
            let called = called.map(|called| format!("M30\nO2\n{called}\nM99\nO3\nX1.\nM99\n")).unwrap_or_default();
            let text = format!("O1\n{feed}{blocks}{called}{END}");
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
