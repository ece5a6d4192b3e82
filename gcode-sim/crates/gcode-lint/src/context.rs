//! Programs under check, each with its text, blocks, control flow and calls.
use std::collections::{BTreeMap, BTreeSet};

use gcode_lang::control::Settings;
use gcode_lang::diag::{Diagnostic, FindingKind, Severity};
use gcode_lang::motion::Backtrace;
use gcode_lang::program::{CallCode, Memory, Op, OpIndex, OpKind, Program, ProgramId};
use gcode_lang::source::{SourceId, Span};
use gcode_lang::syntax::{self, ast};

use super::calls::{self, CallSite};
use super::control_flow::ControlFlowGraph;

/// Input of a rule.
#[derive(Debug)]
pub(crate) struct CheckContext<'a> {
    pub memory: &'a Memory,
    pub settings: &'a Settings,
    pub units: Vec<ProgramUnit<'a>>,
    /// Names of all rules, as valid in CHECK-OFF.
    pub rules: Vec<&'static str>,
    unit_indices: BTreeMap<ProgramId, usize>,
}

/// One program under check.
#[derive(Debug)]
pub(crate) struct ProgramUnit<'a> {
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
    pub role: Role,
}

/// Way in which a program is entered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// Started by the operator: all locals are vacant.
    Main,
    /// Called only by the programs under check.
    Called,
    /// Returns but has no caller under check: called by unknown programs.
    Resident,
}

impl<'a> CheckContext<'a> {
    pub(super) fn new(
        memory: &'a Memory,
        settings: &'a Settings,
        programs: &[ProgramId],
        rules: Vec<&'static str>,
    ) -> Self {
        let places = programs.iter().enumerate().map(|(unit, id)| (*id, unit)).collect();
        let mut trees = trees(memory, programs);
        let units = programs
            .iter()
            .map(|id| {
                let program = memory.get(*id);
                ProgramUnit {
                    blocks: trees.remove(id).unwrap_or_default(),
                    flow: ControlFlowGraph::new(program),
                    calls: calls::call_sites(program, settings),
                    callers: Vec::new(),
                    entry_blocks: vec![0],
                    is_reached: Vec::new(),
                    role: Role::Main,
                    program,
                }
            })
            .collect();
        let mut subject = Self { memory, settings, units, rules, unit_indices: places };
        subject.link_calls();
        subject
    }

    /// Links callers and called programs, adds the return targets of calls and computes reachability.
    fn link_calls(&mut self) {
        for caller in 0..self.units.len() {
            for site in 0..self.units[caller].calls.len() {
                let call = &self.units[caller].calls[site];
                let block = call.block;
                // M98 Q alone starts in the same program.
                let own = call.target == calls::CalledProgramName::Missing && call.start.is_some();
                let Some(called) = self.called_unit(call).or(own.then_some(caller)) else {
                    self.units[caller].flow.add_return_anywhere(block);
                    continue;
                };
                if let Some(number) = call.start {
                    let start = self.units[called].program.find_number(number, 0);
                    self.units[called].entry_blocks.extend(start);
                }
                let returns = &self.units[called].flow;
                let anywhere =
                    returns.block_successors.iter().any(|ways| ways.is_exit && ways.jumps_anywhere);
                let numbers: Vec<u32> =
                    returns.jumps.iter().filter(|jump| jump.is_return).map(|jump| jump.number).collect();
                let to: Vec<_> =
                    numbers.iter().filter_map(|n| self.units[caller].program.find_number(*n, 0)).collect();
                if !own {
                    self.units[called].callers.push((caller, site));
                }
                self.units[caller].flow.add_return_targets(block, to);
                if anywhere {
                    self.units[caller].flow.add_return_anywhere(block);
                }
            }
        }
        for unit in &mut self.units {
            unit.role = unit.determine_role();
            unit.is_reached = unit.flow.reachable(unit.entry_blocks.iter().copied());
        }
    }

    /// Returns the index of the called program if it is under check.
    pub(crate) fn called_unit(&self, call: &CallSite) -> Option<usize> {
        let id = call.target.find(self.memory)?;
        self.unit_indices.get(&id).copied()
    }
}

/// Returns the trees of programs, read again from their texts, because lowering does not keep them.
fn trees(memory: &Memory, programs: &[ProgramId]) -> BTreeMap<ProgramId, Vec<ast::Block>> {
    let programs: BTreeSet<_> = programs.iter().collect();
    let mut ids: BTreeMap<SourceId, Vec<ProgramId>> = BTreeMap::new();
    for id in memory.ids() {
        ids.entry(memory.get(id).span.source).or_default().push(id);
    }
    let mut found = BTreeMap::new();
    for (source, ids) in ids {
        let read = syntax::parse(source, &memory.sources().get(source).bytes);
        let wanted = ids.into_iter().zip(read).filter(|(id, _)| programs.contains(id));
        found.extend(wanted.map(|(id, tree)| (id, tree.blocks)));
    }
    found
}

impl ProgramUnit<'_> {
    fn determine_role(&self) -> Role {
        if !self.callers.is_empty() {
            return Role::Called;
        }
        let returns = self.program.ops().iter().any(|op| match op.kind() {
            OpKind::Words(words) => words.call().is_some_and(|call| call.kind == CallCode::Return),
            _ => false,
        });
        let ends = self.flow.block_successors.iter().zip(self.program.ops()).any(|(ways, op)| {
            let returns = matches!(op.kind(), OpKind::Words(words) if words.call().is_some());
            ways.is_exit && matches!(op.kind(), OpKind::Words(_)) && !returns
        });
        if returns && !ends { Role::Resident } else { Role::Main }
    }

    pub(crate) fn op(&self, block: OpIndex) -> &Op {
        &self.program.ops()[block]
    }

    /// Returns the call of a block. A block has at most one, and the calls are sorted by block.
    pub(crate) fn call_in(&self, block: OpIndex) -> Option<&CallSite> {
        let place = self.calls.binary_search_by_key(&block, |call| call.block).ok()?;
        self.calls.get(place)
    }

    /// Creates a finding about a block.
    pub(crate) fn finding(
        &self,
        kind: &'static FindingKind,
        block: OpIndex,
        message: impl Into<String>,
    ) -> RuleFinding {
        let place = Backtrace { block: self.op(block).span, calls: None };
        RuleFinding { block, diagnostic: Diagnostic::new(kind, message).with_backtrace(place) }
    }
}

/// Finding of a rule about a block.
#[derive(Debug)]
pub(crate) struct RuleFinding {
    pub block: OpIndex,
    pub diagnostic: Diagnostic,
}

impl RuleFinding {
    /// Sets the exact part of the block.
    pub(crate) fn with_span(mut self, span: Span) -> Self {
        self.diagnostic.span = Some(span);
        self
    }

    /// Sets a severity, not higher than the rule's.
    pub(crate) fn with_severity(mut self, severity: Severity) -> Self {
        self.diagnostic = self.diagnostic.with_severity(severity);
        self
    }

    pub(crate) fn help(mut self, help: impl Into<String>) -> Self {
        self.diagnostic = self.diagnostic.help(help);
        self
    }

    pub(crate) fn label(mut self, span: Span, text: impl Into<String>) -> Self {
        self.diagnostic.labels.push((span, text.into()));
        self
    }
}
