//! What the pieces of a program that is checked in pieces know of it together.
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use gcode_lang::diag::Diagnostic;
use gcode_lang::program::{OpIndex, Program, ProgramId};
use gcode_lang::source::Span;

use super::calls::{CallSite, CalledProgramName};
use super::computed_jumps::ComputedJumps;
use super::context::{CheckContext, ProgramUnit, Role};
use super::control_flow::Successors;
use super::first_reach::has_unclear_read;
use super::literal;
use super::locals::Locals;
use super::modes::modes_before;
use super::parameters::has_open_parameter_input;
use super::piece::{Piece, PieceStart};
use super::possible_units::PossibleUnits;
use super::rules::{
    self, PointCounts, alarming_cancel, limits_lookahead, pending_moves, point_counts, sequence_numbers,
};
use super::suppression::{Suppression, suppressions};
use super::units::unit_in_force;
use super::unset_reads::entry_locals;
use super::vacancy::states_without_arguments;
use super::{ControlKnowledge, FindingLimit};

/// What the pieces of a program have in common so far.
#[derive(Default)]
pub(super) struct WholeProgram {
    pub findings: Vec<Diagnostic>,
    /// Number of findings of each kind that are kept.
    kept: BTreeMap<&'static str, usize>,
    /// Number of findings of each kind beyond the limit.
    pub left_over: BTreeMap<&'static str, usize>,
    /// A local is read before it is set.
    pub has_unset: bool,
    pub points: PointCounts,
    /// The first finding about a missing point, and the number of all of them.
    pub missing_points: Option<(Diagnostic, usize)>,
    pub suppressions: Vec<Suppression>,
    pub numbers: Vec<(u32, Span)>,
    pub jumps: BTreeSet<u32>,
    /// Blocks of calls: of those of the programs that are here one of each form, of those of a missing one the first.
    pub calls: Vec<OpIndex>,
    /// Calls of each missing program, as the offsets of their blocks.
    pub missing: BTreeMap<CalledProgramName, Vec<u32>>,
    /// Units that its blocks command.
    pub units: PossibleUnits,
    known_calls: BTreeSet<(ProgramId, bool, Locals)>,
    pub returns: bool,
    pub ends: bool,
    pub has_exit: bool,
    pub computed_jumps: ComputedJumps,
}

/// The check of a program in pieces is not possible.
pub(super) struct NotInPieces;

impl WholeProgram {
    /// Creates what is known before the first piece; of the computed jumps that is what an earlier pass found.
    pub(super) fn new(computed_jumps: ComputedJumps) -> Self {
        Self { computed_jumps, ..Self::default() }
    }

    /// Keeps the findings of a piece that are not suppressed, as far as the limit allows.
    pub(super) fn keep(&mut self, mut new: Vec<Diagnostic>, limit: FindingLimit<'_>) {
        self.has_unset |= new.iter().any(|finding| finding.kind == rules::UNSET_VARIABLE);
        let missing_points = new.iter().filter(|finding| finding.kind == rules::MISSING_POINT);
        for finding in missing_points {
            self.missing_points.get_or_insert_with(|| (finding.clone(), 0)).1 += 1;
        }
        // A suppression stands in the head of the program or at the block itself.
        rules::leave_suppressed(&mut new, &self.suppressions);
        new.retain(|finding| {
            if !(limit.is_shown)(finding) {
                return false;
            }
            let kept = self.kept.entry(finding.kind.code).or_default();
            let is_kept = *kept < limit.of_kind;
            *(if is_kept { kept } else { self.left_over.entry(finding.kind.code).or_default() }) += 1;
            is_kept
        });
        self.findings.extend(new);
    }

    /// Judges the missing points of all pieces together, as the rule does in a program that is checked as a whole.
    pub(super) fn judge_missing_points(&mut self, knowledge: ControlKnowledge) {
        let is_one = |finding: &Diagnostic| finding.kind == rules::MISSING_POINT;
        let are_none = self.points.are_increments();
        if !are_none && !self.points.hardly_have_points() {
            return;
        }
        self.left_over.remove(rules::MISSING_POINT.code);
        self.findings.retain(|finding| !is_one(finding));
        let as_whole = self.missing_points.take().filter(|_| !are_none);
        let as_whole =
            as_whole.map(|(first, count)| rules::missing_points_as_whole(first, count - 1, knowledge));
        self.findings.extend(as_whole);
    }

    /// Adds what a piece knows of the program. Returns the state behind it, and its findings.
    pub(super) fn add(
        &mut self,
        context: &CheckContext<'_>,
        unit: &ProgramUnit<'_>,
        (whole, blocks): (&Program, Range<OpIndex>),
        long: &[ProgramId],
    ) -> Result<(PieceStart, Vec<Diagnostic>), NotInPieces> {
        let is_last = blocks.end == whole.block_count();
        if leads_elsewhere(context, unit, (whole, &blocks), long) || !is_last && !unit.reaches_end {
            return Err(NotInPieces);
        }
        self.computed_jumps.add(context, unit);
        // Where another pass follows, the states at the end of the piece are all that matters.
        let mut findings = match self.computed_jumps.are_outdated() {
            true => Vec::new(),
            false => rules::findings_in(context, unit),
        };
        if findings.iter().any(|finding| rests_on_whole(context, finding))
            || self.computed_jumps.lead_back() && rests_on_cycles(unit, &findings)
        {
            return Err(NotInPieces);
        }
        let judged_in = unit_in_force(context, unit);
        let is_judged_in_another = |piece: &Piece| !piece.is_first && piece.start.units.1 != judged_in;
        if unit.piece.as_ref().is_some_and(is_judged_in_another) {
            return Err(NotInPieces);
        }
        self.units = unit.commanded_units();
        let end = blocks.len();
        let (returns, ends) = unit.returns_or_ends();
        self.returns |= returns;
        self.ends |= ends;
        self.has_exit |= unit.has_exit();
        // A program that is not found is one finding, whatever the number of its calls.
        findings.retain(|finding| finding.kind != rules::MISSING_PROGRAM);
        self.points.add(point_counts(unit, context.settings));
        self.suppressions.extend(suppressions(unit));
        self.numbers.extend(sequence_numbers(unit));
        self.jumps.extend(unit.flow.jumps.iter().filter(|jump| !jump.is_return).map(|jump| jump.number));
        // What a called program knows of its calls is their arguments.
        for call in &unit.calls {
            let is_new = match context.called_unit(call) {
                Some(called) => {
                    let form = (context.units[called].id, call.has_own_locals, entry_locals(call));
                    self.known_calls.insert(form)
                }
                None if call.target == CalledProgramName::Missing => true,
                None if !unit.is_reached[call.block] => false,
                None => {
                    let calls = self.missing.entry(call.target.clone()).or_default();
                    calls.push(unit.op(call.block).span.start);
                    calls.len() == 1
                }
            };
            self.calls.extend(is_new.then_some(blocks.start + call.block));
        }
        if is_last {
            return Ok((PieceStart::of_program(unit.role), findings));
        }
        let start = PieceStart {
            modes: modes_before(context, unit)[end].ok_or(NotInPieces)?,
            locals: states_without_arguments(unit)[end].ok_or(NotInPieces)?,
            units: (self.units, judged_in),
            may_be_left_out: unit.piece.as_ref().is_some_and(|piece| piece.start.may_be_left_out)
                || unit.flow.block_successors.iter().any(Successors::may_leave),
            pending_move: match limits_lookahead(context, unit) {
                true => None,
                false => pending_moves(context, unit)[end].flatten(),
            },
        };
        Ok((start, findings))
    }
}

/// Returns true for a finding, or the lack of one, that the other blocks of a program decide too.
fn rests_on_whole(context: &CheckContext<'_>, finding: &Diagnostic) -> bool {
    let is_haas = context.settings.codes == gcode_lang::control::Dialect::HaasNgc;
    rules::OF_WHOLE_PROGRAM.contains(&finding.kind) || is_haas && finding.kind == rules::LIVE_POSITION
}

/// Returns true if a finding, or the lack of one, rests on the cycles about a block, where jumps lead back to other pieces.
fn rests_on_cycles(unit: &ProgramUnit<'_>, findings: &[Diagnostic]) -> bool {
    findings.iter().any(|finding| finding.kind == rules::ENDLESS_LOOP)
        || unit.role == Role::Main && has_unclear_read(unit, states_without_arguments(unit))
}

/// Returns true if control may come from other blocks than the one before the piece, or go to others than the next one, and not
/// by a computed jump.
fn leads_elsewhere(
    context: &CheckContext<'_>,
    unit: &ProgramUnit<'_>,
    (whole, blocks): (&Program, &Range<OpIndex>),
    long: &[ProgramId],
) -> bool {
    let is_outside = |to: OpIndex| !blocks.contains(&to) || to == blocks.start && to != 0;
    let leads_out = unit.flow.jumps.iter().filter(|jump| !jump.is_far).any(|jump| {
        let from = if jump.is_return { 0 } else { blocks.start + jump.block + 1 };
        let targets = [whole.find_number(jump.number, from), whole.find_number(jump.number, 0)];
        let targets = if jump.is_return { &targets[..] } else { &targets[..1] };
        targets.iter().flatten().any(|to| is_outside(*to))
    });
    let calls_own_blocks = |word: &gcode_lang::program::LoweredWord| {
        word.letter == b'M' && (literal::word_count(word) == Some(97) || literal::word_count(word).is_none())
    };
    let calls_long = |call: &CallSite| {
        call.start_span.is_some()
            || call.is_modal
            || call.target.find(context.memory, call.folder.as_ref()).is_some_and(|id| long.contains(&id))
    };
    let others = &context.units[..context.units.len() - 1];
    leads_out
        || unit.reached_words().any(|(_, words)| words.list.iter().any(calls_own_blocks))
        // A macro that is called modally elsewhere makes it right.
        || unit.reached_words().any(|(_, words)| alarming_cancel(context, words).is_some())
        || context.units.iter().flat_map(|unit| &unit.calls).any(calls_long)
        || !unit.callers.is_empty()
        || unit.entry_blocks.len() != 1 + unit.piece.as_ref().map_or(0, |piece| piece.entries.len())
        || others.iter().any(|other| other.flow.jumps.iter().any(|jump| jump.is_return))
        || has_open_parameter_input(unit.program)
}
