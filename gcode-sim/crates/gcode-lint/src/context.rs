//! Programs under check, each with its text, blocks, control flow and calls.
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Mutex, OnceLock};

use gcode_control::static_eval::VariableTable;
use gcode_control::static_plan::StaticPlanner;
use gcode_lang::alarm::{Alarm, LocatedAlarm, remedy};
use gcode_lang::control::Settings;
use gcode_lang::diag::{Diagnostic, FindingKind, Severity};
use gcode_lang::motion::Backtrace;
use gcode_lang::program::g_codes::{self, Effect, GCodeRow};
use gcode_lang::program::{
    CallCode, LoweredWord, Memory, Op, OpIndex, OpKind, Program, ProgramId, Statement, WordOperand, Words,
};
use gcode_lang::source::{SourceId, Span, Spanned};
use gcode_lang::syntax::{BlockMarks, KnownBlocks, ast};

use super::ControlKnowledge;
use super::block_marks::READS_COMMONS_ALONE;
use super::calls::{self, CallSite};
use super::components::strongly_connected_components;
use super::control_flow::ControlFlowGraph;
use super::locals::States;
use super::piece::Piece;
use super::possible_modes::PossibleModes;
use super::possible_units::PossibleUnits;
pub(crate) use super::role::Role;
use super::variables::{self, VariableRead};

/// Note of a finding that is none on a control with another option.
pub const CONTROL_ASSUMED: &str = "no file states the control: an option or the machine builder may give it";

/// Input of a rule.
#[derive(Debug)]
pub(crate) struct CheckContext<'a> {
    pub memory: &'a Memory,
    pub settings: &'a Settings,
    pub knowledge: ControlKnowledge,
    pub variables: VariableTable<'a>,
    pub units: Vec<ProgramUnit<'a>>,
    /// Names of all rules, as valid in CHECK-OFF.
    pub rules: Vec<&'static str>,
    unit_indices: BTreeMap<ProgramId, usize>,
    /// Files for calculator-type input, see the rule `missing-point`.
    pub calculator_files: OnceLock<BTreeSet<SourceId>>,
    /// A program may call a macro modally, see the rule `refused-words`.
    pub may_call_modally: OnceLock<bool>,
    /// A planner of single blocks that no rule uses now: there is none per program.
    pub planner: Mutex<Option<StaticPlanner>>,
}

/// What rules want to know of the blocks of a program that are left out of a check.
#[derive(Clone, Debug, Default)]
pub(crate) struct LeftOutBlocks {
    /// Their sequence numbers, in the order of the blocks.
    pub numbers: Vec<LeftOutNumber>,
    /// How many calls are left out for the one of the block at an offset.
    pub calls: BTreeMap<u32, usize>,
    /// Number of their lengths and angles other than 0 that have a decimal point.
    pub points: usize,
}

/// Sequence number of a block that is left out of a check.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeftOutNumber {
    pub number: u32,
    pub block: Span,
}

/// Program that is lowered, with the trees of its blocks and its calls.
#[derive(Debug)]
pub(crate) struct LoadedProgram {
    pub id: ProgramId,
    pub blocks: Vec<ast::Block>,
    /// Marks of the blocks, see `block_marks`.
    pub marks: Vec<BlockMarks>,
    pub calls: Vec<CallSite>,
    /// Piece of a longer program.
    pub piece: Option<Piece>,
    /// Units that blocks of the program command which are not here: those before a piece.
    pub other_units: PossibleUnits,
}

impl LoadedProgram {
    /// Lowers a program. The known blocks are those of the first text.
    pub(super) fn new(
        memory: &mut Memory,
        id: ProgramId,
        known: &mut KnownBlocks,
        settings: &Settings,
    ) -> Self {
        let mut none = KnownBlocks::default();
        let is_first = memory.get(id).span.source == SourceId(0);
        let known = if is_first { known } else { &mut none };
        let blocks = memory.lower_with_trees(id, known);
        let marks = blocks.iter().map(|block| known.marks(block.span.start)).collect();
        Self {
            id,
            blocks,
            marks,
            calls: calls::call_sites(memory.get(id), settings),
            piece: None,
            other_units: PossibleUnits::default(),
        }
    }
}

/// One program under check.
#[derive(Debug)]
pub(crate) struct ProgramUnit<'a> {
    pub id: ProgramId,
    /// Blocks as written: the tree keeps comments and decimal points.
    pub blocks: Vec<ast::Block>,
    /// Operations; block and operation have the same index.
    pub program: &'a Program,
    pub flow: ControlFlowGraph,
    pub calls: Vec<CallSite>,
    /// Callers, each as the index of the unit and of its call.
    pub callers: Vec<(usize, usize)>,
    /// The first block, and the blocks at which calls with Q start.
    pub entry_blocks: Vec<OpIndex>,
    /// True for each reachable block.
    pub is_reached: Vec<bool>,
    /// True if a path leads beyond the last block.
    pub reaches_end: bool,
    /// True for each target behind a piece to which a reachable block jumps.
    pub reached_far: Vec<bool>,
    pub role: Role,
    /// Modes before each block, see `modes`.
    pub modes: OnceLock<Vec<Option<PossibleModes>>>,
    /// Marks of the blocks from the check before, see `block_marks`.
    pub marks: Vec<BlockMarks>,
    /// Marks of the blocks from this check.
    pub new_marks: OnceLock<Vec<BlockMarks>>,
    /// Variables that each block reads, see `variables`.
    reads: Vec<OnceLock<Box<[VariableRead]>>>,
    components: OnceLock<Vec<usize>>,
    /// States without arguments, see `vacancy`.
    pub states_without_arguments: OnceLock<States>,
    pub left_out: LeftOutBlocks,
    /// Piece of a longer program, of which the other blocks are not here.
    pub piece: Option<Piece>,
    other_units: PossibleUnits,
    commanded_units: OnceLock<PossibleUnits>,
}

impl<'a> CheckContext<'a> {
    pub(super) fn new(
        memory: &'a Memory,
        (settings, knowledge): (&'a Settings, ControlKnowledge),
        programs: Vec<LoadedProgram>,
        rules: Vec<&'static str>,
    ) -> Self {
        let unit_indices = programs.iter().enumerate().map(|(unit, program)| (program.id, unit)).collect();
        let units = programs.into_iter().map(|program| ProgramUnit::new(memory, program)).collect();
        let variables = VariableTable::new(settings);
        let mut context = Self {
            memory,
            settings,
            knowledge,
            variables,
            units,
            rules,
            unit_indices,
            calculator_files: OnceLock::new(),
            may_call_modally: OnceLock::new(),
            planner: Mutex::new(None),
        };
        context.link_calls();
        context
    }

    /// Returns the programs again.
    pub(super) fn into_loaded(self) -> Vec<LoadedProgram> {
        let units = self.units.into_iter();
        let loaded =
            |ProgramUnit { id, blocks, mut marks, new_marks, calls, piece, other_units, .. }: ProgramUnit<
                '_,
            >| {
                let new = new_marks.into_inner().into_iter().flatten();
                marks.iter_mut().zip(new).for_each(|(marks, new)| *marks |= new);
                LoadedProgram { id, blocks, marks, calls, piece, other_units }
            };
        units.map(loaded).collect()
    }

    /// Links callers and called programs, adds the return targets of calls and computes reachability.
    fn link_calls(&mut self) {
        for caller in 0..self.units.len() {
            for site in 0..self.units[caller].calls.len() {
                let call = &self.units[caller].calls[site];
                let block = call.block;
                let is_own = call.is_of_own_program();
                let own = (is_own && call.start.is_some()).then_some(caller);
                let Some(called) = self.called_unit(call).or(own) else {
                    self.units[caller].flow.block_successors[block].jumps_anywhere = true;
                    continue;
                };
                let (program, start) = (self.units[caller].program, call.start);
                let unit = &mut self.units[called];
                unit.entry_blocks.extend(start.and_then(|number| unit.program.find_number(number, 0)));
                if !is_own {
                    unit.callers.push((caller, site));
                }
                let exits_anywhere =
                    unit.flow.block_successors.iter().any(|found| found.is_exit && found.jumps_anywhere);
                let returns = unit.flow.jumps.iter().filter(|jump| jump.is_return);
                let targets: Vec<_> =
                    returns.filter_map(|jump| program.find_number(jump.number, 0)).collect();
                let successors = &mut self.units[caller].flow.block_successors[block];
                successors.jumps.extend(targets);
                successors.jumps_anywhere |= exits_anywhere;
            }
        }
        for unit in &mut self.units {
            unit.role = unit.piece.as_ref().map_or_else(|| unit.determine_role(), |piece| piece.role);
            unit.is_reached = unit.flow.reachable(&unit.entry_blocks);
            let far = unit.flow.far_nodes();
            unit.reached_far = unit.is_reached[far].to_vec();
            unit.is_reached.truncate(unit.program.ops().len() + 1);
            unit.reaches_end = unit.is_reached.pop().unwrap_or_default();
        }
    }

    /// Returns findings for those alarms of reading that `selects` accepts.
    ///
    /// A reachable block raises an alarm of reading if its text is unreadable, or if this control refuses syntax that others
    /// accept.
    pub(crate) fn reading_findings(
        &self,
        unit: &ProgramUnit<'_>,
        kind: &'static FindingKind,
        selects: impl Fn(&Alarm) -> bool,
    ) -> Vec<Diagnostic> {
        let written = unit
            .reached_ops()
            .filter_map(|(block, op)| Some((block, written_alarm(op.kind())?.clone())))
            .filter(|(_, alarm)| selects(&alarm.node))
            .map(|(block, alarm)| self.alarm_finding(unit, kind, block, &alarm));
        let refused = unit.reached_ops().filter_map(|(block, op)| {
            let syntax = op.dialect_syntax().iter().find(|syntax| !syntax.node.is_accepted(self.settings))?;
            Some((block, syntax.node.alarm().located_at(syntax.span)))
        });
        let refused = refused
            .filter(|(_, alarm)| selects(&alarm.node))
            .map(|(block, alarm)| self.unless_optional(self.alarm_finding(unit, kind, block, &alarm)));
        written.chain(refused).collect()
    }

    /// Converts an alarm to a finding with its number, sentence and remedy.
    pub(crate) fn alarm_finding(
        &self,
        unit: &ProgramUnit<'_>,
        kind: &'static FindingKind,
        block: OpIndex,
        alarm: &Spanned<Alarm>,
    ) -> Diagnostic {
        let row = alarm.node.row();
        let help = remedy(&alarm.node, alarm.span, self.memory.sources());
        let finding = unit.finding(kind, block, format!("{}: {}", row.code, row.message));
        // A limit of the simulator is no fault of the program.
        let severity = match alarm.node {
            Alarm::NotSimulated { .. }
            | Alarm::WordNotSimulated(_)
            | Alarm::CodeInMode(..)
            | Alarm::FeedOfOtherMode(..) => Severity::Note,
            _ => finding.severity,
        };
        Diagnostic { help, severity, ..finding.with_span(alarm.span) }
    }

    /// Makes a finding that options of the control may remove a note if the control is assumed.
    pub(crate) fn unless_optional(&self, finding: Diagnostic) -> Diagnostic {
        self.knowledge.unless_optional(finding)
    }

    /// Returns the index of the called program if it is under check.
    pub(crate) fn called_unit(&self, call: &CallSite) -> Option<usize> {
        let id = call.target.find(self.memory, call.folder.as_ref())?;
        self.unit_indices.get(&id).copied()
    }

    /// Returns the row of a G code written as a number; `None` if this control lacks the code, or for another word.
    pub(crate) fn g_code_row(&self, word: &LoweredWord) -> Option<&'static GCodeRow> {
        match word.value {
            WordOperand::G(code, found) => g_codes::row_on(code, found, self.settings),
            WordOperand::Literal(_)
            | WordOperand::Number(_)
            | WordOperand::Variable { .. }
            | WordOperand::Code(_) => None,
        }
    }

    /// Iterates over the rows of a block's G codes, see [`CheckContext::g_code_row`].
    pub(crate) fn g_code_rows(&self, words: &Words) -> impl Iterator<Item = &'static GCodeRow> {
        words.list.iter().filter_map(|word| self.g_code_row(word))
    }

    /// Returns true if `is_effect` accepts the effect of one of a block's G codes on this control.
    pub(crate) fn has_effect(&self, words: &Words, is_effect: impl Fn(Effect) -> bool) -> bool {
        self.g_code_rows(words).any(|row| is_effect(row.effect))
    }

    /// Returns true if a block has a word of one of the control's axes.
    pub(crate) fn names_axis(&self, words: &Words) -> bool {
        words.list.iter().any(|word| self.settings.axes.find(word.letter).is_some())
    }
}

/// Returns true if a block commands F, beside the arguments of a call.
pub(crate) fn has_feed_word(words: &Words) -> bool {
    words.list.iter().any(|word| word.letter == b'F')
}

fn written_alarm(kind: &OpKind) -> Option<&LocatedAlarm> {
    match kind {
        OpKind::Alarm(alarm) => Some(alarm),
        OpKind::Statement(Statement::IfThen { then, .. }) => match &**then {
            Statement::Alarm(alarm) => Some(alarm),
            _ => None,
        },
        _ => None,
    }
}

impl<'a> ProgramUnit<'a> {
    fn new(
        memory: &'a Memory,
        LoadedProgram { id, blocks, marks, calls, piece, other_units }: LoadedProgram,
    ) -> Self {
        let program = memory.get(id);
        let far_jumps = piece.as_ref().map_or(&[][..], |piece| &piece.far_jumps);
        let entries = piece.iter().flat_map(|piece| &piece.entries).map(|entry| entry.block);
        Self {
            id,
            reads: blocks.iter().map(|_| OnceLock::new()).collect(),
            blocks,
            marks,
            new_marks: OnceLock::new(),
            flow: ControlFlowGraph::new(program, far_jumps),
            calls,
            callers: Vec::new(),
            entry_blocks: std::iter::once(0).chain(entries).collect(),
            is_reached: Vec::new(),
            reaches_end: false,
            reached_far: Vec::new(),
            role: Role::Main,
            modes: OnceLock::new(),
            components: OnceLock::new(),
            states_without_arguments: OnceLock::new(),
            left_out: LeftOutBlocks::default(),
            piece,
            other_units,
            commanded_units: OnceLock::new(),
            program,
        }
    }

    fn determine_role(&self) -> Role {
        if !self.callers.is_empty() {
            return Role::Called;
        }
        Role::of_uncalled(self.program.number(), self.returns_or_ends())
    }

    /// Returns whether a block returns, and whether one ends the run.
    pub(crate) fn returns_or_ends(&self) -> (bool, bool) {
        let words =
            |(block, op): (usize, &'a Op)| Some((op.kind().words()?.call().map(|call| call.kind), block));
        let mut blocks = self.program.ops().iter().enumerate().filter_map(words);
        let returns = blocks.clone().any(|(call, _)| call == Some(CallCode::Return));
        let ends = blocks.any(|(call, block)| call.is_none() && self.flow.block_successors[block].is_exit);
        (returns, ends)
    }

    /// Returns the variables that a block reads; none of a block that is known to read commons alone.
    pub(crate) fn reads(&self, block: OpIndex) -> &[VariableRead] {
        if self.marks[block] & READS_COMMONS_ALONE != 0 {
            return &[];
        }
        self.reads[block].get_or_init(|| variables::block_reads(&self.blocks[block]).into())
    }

    /// Returns the units that the blocks of the program command, of a piece also the blocks before it.
    pub(crate) fn commanded_units(&self) -> PossibleUnits {
        *self.commanded_units.get_or_init(|| {
            let mut units = PossibleUnits::commanded_in(self.program);
            units |= self.other_units;
            units
        })
    }

    /// Returns the component of each node of the control flow, see `components`.
    pub(crate) fn components(&self) -> &[usize] {
        self.components.get_or_init(|| strongly_connected_components(&self.flow))
    }

    /// Returns true for an unreached block to which a jump in a comment leads, `(IF[#1 EQ 1]GOTO 50)`.
    pub(crate) fn is_jump_commented_out(&self, block: OpIndex) -> bool {
        let unreached = (0..=block).rev().take_while(|before| !self.is_reached[*before]);
        let Some(number) = unreached.filter_map(|before| self.op(before).number).next() else { return false };
        let jumps = |comment: &ast::Comment| {
            let text = String::from_utf8_lossy(&comment.text).to_ascii_uppercase();
            text.split("GOTO").skip(1).any(|behind| {
                let digits: String = behind.trim_start().chars().take_while(char::is_ascii_digit).collect();
                digits.parse() == Ok(number)
            })
        };
        self.blocks.iter().flat_map(|block| &block.comments).any(jumps)
    }

    /// Returns true if a block ends the program, returns or stops with its own alarm.
    pub(crate) fn has_exit(&self) -> bool {
        self.flow.block_successors.iter().any(|block| block.is_exit)
    }

    pub(crate) fn op(&self, block: OpIndex) -> &Op {
        &self.program.ops()[block]
    }

    /// Returns the call of a block. A block has at most one, and the calls are sorted by block.
    pub(crate) fn call_in(&self, block: OpIndex) -> Option<&CallSite> {
        let place = self.calls.binary_search_by_key(&block, |call| call.block).ok()?;
        self.calls.get(place)
    }

    pub(crate) fn reached_blocks(&self) -> impl Iterator<Item = (OpIndex, &ast::Block)> {
        self.blocks.iter().enumerate().filter(|(block, _)| self.is_reached[*block])
    }

    pub(crate) fn reached_ops(&self) -> impl Iterator<Item = (OpIndex, &'a Op)> {
        self.program.ops().iter().enumerate().filter(|(block, _)| self.is_reached[*block])
    }

    /// Iterates over the words of the blocks that are reached, those behind a condition too.
    pub(crate) fn reached_words(&self) -> impl Iterator<Item = (OpIndex, &'a Words)> {
        self.reached_ops().filter_map(|(block, op)| Some((block, op.kind().words()?)))
    }

    pub(crate) fn finding(
        &self,
        kind: &'static FindingKind,
        block: OpIndex,
        message: impl Into<String>,
    ) -> Diagnostic {
        Diagnostic::new(kind, message).with_backtrace(Backtrace { block: self.op(block).span, calls: None })
    }
}
