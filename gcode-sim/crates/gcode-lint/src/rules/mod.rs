//! Rules of the checker, one file and one row of [`ALL`] each.
mod constant_alarm;
mod doubled_n;
mod doubled_program;
mod endless_loop;
mod ignored_move;
mod jump_into_loop;
mod live_position;
mod loop_pairs;
mod missing_argument;
mod missing_end;
mod missing_feed;
mod missing_n;
mod missing_offset;
mod missing_point;
mod missing_program;
mod no_such_variable;
mod open_comment;
mod refused_words;
mod relation_symbol;
mod repeated_address;
mod round_brackets;
mod rounded_pi;
mod several_m_codes;
mod stray_word;
mod unknown_check;
mod unknown_code;
mod unreachable;
mod unreachable_alarm;
mod unreadable;
mod unset_variable;

use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use gcode_lang::diag::{Diagnostic, FindingKind};
use gcode_lang::syntax::BlockMarks;

use super::block_marks::{FAULTLESS, KEEPS_LOCALS, READS_COMMONS_ALONE};
use super::context::{CheckContext, ProgramUnit};
use super::rule::Find;
pub use super::rule::Rule;
use super::suppression::{Suppression, suppressions};
use super::vacancy::keeps_locals;
use super::variables::is_common;
pub(super) use doubled_n::{doubled_numbers, sequence_numbers};
pub(super) use live_position::{limits_lookahead, pending_moves};
pub(super) use missing_point::{PointCounts, as_whole as missing_points_as_whole, point_counts};
pub(super) use missing_program::find as missing_programs;
pub(super) use refused_words::alarming_cancel;

/// All rules, in the order of their findings about one block.
pub static ALL: &[&Rule] = &[
    &unreadable::RULE,
    &round_brackets::RULE,
    &relation_symbol::RULE,
    &loop_pairs::RULE,
    &jump_into_loop::RULE,
    &missing_n::RULE,
    &doubled_n::RULE,
    &doubled_program::RULE,
    &unknown_code::RULE,
    &missing_program::RULE,
    &missing_argument::RULE,
    &several_m_codes::RULE,
    &repeated_address::RULE,
    &no_such_variable::RULE,
    &constant_alarm::RULE,
    &missing_offset::RULE,
    &missing_feed::RULE,
    &ignored_move::RULE,
    &open_comment::RULE,
    &stray_word::RULE,
    &refused_words::RULE,
    &unset_variable::RULE,
    &missing_point::RULE,
    &rounded_pi::RULE,
    &live_position::RULE,
    &endless_loop::RULE,
    &unreachable_alarm::RULE,
    &unreachable::RULE,
    &missing_end::RULE,
    &unknown_check::RULE,
];

/// Kind of finding about a number without a decimal point.
pub static MISSING_POINT: &FindingKind = &missing_point::RULE.kind;

/// Kind of finding about a sequence number that is defined twice.
pub(super) static DOUBLED_N: &FindingKind = &doubled_n::RULE.kind;

/// Kind of finding about a local that is read before it is set.
pub(super) static UNSET_VARIABLE: &FindingKind = &unset_variable::RULE.kind;

/// Kind of finding about a program that is called and not found.
pub(super) static MISSING_PROGRAM: &FindingKind = &missing_program::RULE.kind;

/// Kind of finding about a position read in a move.
pub(super) static LIVE_POSITION: &FindingKind = &live_position::RULE.kind;

/// Kind of finding about a loop that never ends.
pub(super) static ENDLESS_LOOP: &FindingKind = &endless_loop::RULE.kind;

/// Kinds of findings about a block that other blocks, wherever they are, add to or take away.
pub(super) static OF_WHOLE_PROGRAM: [&FindingKind; 3] =
    [&loop_pairs::RULE.kind, &unreachable::RULE.kind, &unreachable_alarm::RULE.kind];

/// Kind of finding about a macro call without a required argument.
pub static MISSING_ARGUMENT: &FindingKind = &missing_argument::RULE.kind;

pub(super) fn codes() -> Vec<&'static str> {
    ALL.iter().map(|rule| rule.kind.code).collect()
}

/// Returns the findings of all rules except the suppressed ones, by program and block.
///
/// Several threads share the rules of a long program, and the short programs.
pub(super) fn findings(context: &CheckContext<'_>) -> Vec<Diagnostic> {
    let units = context.units.iter().enumerate();
    let (long, short): (Vec<_>, Vec<_>) =
        units.partition(|(_, unit)| MIN_BLOCKS_TO_SHARE <= unit.blocks.len());
    let of_unit = |(place, unit): (usize, &ProgramUnit<'_>)| (place, findings_in_program(context, unit));
    let next = AtomicUsize::new(0);
    let find_next = || short.get(next.fetch_add(1, Ordering::Relaxed)).copied().map(of_unit);
    let blocks = short.iter().map(|(_, unit)| unit.blocks.len()).sum();
    let mut found = on_threads(threads_for(blocks).min(short.len()), find_next);
    found.extend(long.into_iter().map(of_unit));
    found.sort_by_key(|(place, _)| *place);
    found.into_iter().flat_map(|(_, findings)| findings).collect()
}

/// Returns the number of threads that check some blocks.
///
/// The system is asked for many blocks alone: the answer takes as long as the work on a few.
fn threads_for(blocks: usize) -> usize {
    if blocks < MIN_BLOCKS_TO_SHARE { 1 } else { thread::available_parallelism().map_or(1, usize::from) }
}

/// Takes results from a function on this thread and on others until it has no more.
fn on_threads<T: Send>(threads: usize, next: impl Fn() -> Option<T> + Sync) -> Vec<T> {
    let rest = || std::iter::from_fn(&next).collect::<Vec<_>>();
    thread::scope(|scope| {
        let others: Vec<_> = (1..threads).map(|_| scope.spawn(rest)).collect();
        let own = rest();
        let joined =
            others.into_iter().map(|other| other.join().unwrap_or_else(|e| std::panic::resume_unwind(e)));
        own.into_iter().chain(joined.flatten()).collect()
    })
}

/// Returns the findings of all rules in one program except the suppressed ones, by block.
pub(super) fn findings_in_program(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    let mut found = findings_in(context, unit);
    put_in_order(&mut found, &suppressions(unit));
    found
}

/// Removes the suppressed findings of a program and sorts the others by block; they are in the order of the rules.
fn put_in_order(found: &mut Vec<Diagnostic>, off: &[Suppression]) {
    leave_suppressed(found, off);
    found.sort_by_key(|finding| finding.backtrace.as_ref().map(|place| place.block.start));
}

/// Removes the suppressed findings.
pub(super) fn leave_suppressed(found: &mut Vec<Diagnostic>, off: &[Suppression]) {
    found.retain(|finding| !off.iter().any(|suppression| suppression.suppresses(finding)));
}

/// Does the same with the findings of the pieces of a program, which are not in the order of the rules.
pub(super) fn put_pieces_in_order(found: &mut Vec<Diagnostic>, off: &[Suppression]) {
    found.sort_by_cached_key(|finding| ALL.iter().position(|rule| &rule.kind == finding.kind));
    put_in_order(found, off);
}

/// Number of blocks from which several threads share the rules: fewer are checked sooner than a thread starts.
const MIN_BLOCKS_TO_SHARE: usize = 2000;

/// Number of blocks that one thread checks at a time by the rules about a block alone.
const SHARE: usize = 5000;

/// Findings with the place of their rule among all, and marks of some blocks.
type Found = (Vec<(usize, Vec<Diagnostic>)>, Option<(usize, Vec<BlockMarks>)>);

/// Returns the findings in one program, rule by rule.
pub(super) fn findings_in(context: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<Diagnostic> {
    let shares = unit.blocks.len().div_ceil(SHARE);
    let next = AtomicUsize::new(0);
    let find_next = || -> Option<Found> {
        let place = next.fetch_add(1, Ordering::Relaxed);
        let Some(rule) = ALL.get(place) else {
            let share = place - ALL.len();
            return (share < shares).then(|| findings_about_blocks(context, unit, share));
        };
        let found = match rule.find {
            Find::InProgram(find) => vec![(place, find(context, unit))],
            Find::InBlock(_) => Vec::new(),
        };
        Some((found, None))
    };
    let all = on_threads(threads_for(unit.blocks.len()).min(ALL.len()), find_next);
    let (mut found, mut marks) = (Vec::new(), vec![0; unit.blocks.len()]);
    for (findings, share) in all {
        found.extend(findings);
        if let Some((first, share)) = share {
            marks[first..first + share.len()].copy_from_slice(&share);
        }
    }
    _ = unit.new_marks.set(marks);
    found.sort_by_key(|(place, _)| *place);
    found.into_iter().flat_map(|(_, findings)| findings).collect()
}

/// Returns the findings of the rules about a block alone in one share of a program, and the marks of its blocks.
///
/// A block in which the check before found nothing has nothing now.
fn findings_about_blocks(context: &CheckContext<'_>, unit: &ProgramUnit<'_>, share: usize) -> Found {
    let mut found: Vec<_> = (0..ALL.len()).map(|place| (place, Vec::new())).collect();
    let first = share * SHARE;
    let blocks = first..unit.blocks.len().min(first + SHARE);
    let marks = blocks.map(|block| {
        if unit.marks[block] & FAULTLESS != 0 || !unit.is_reached[block] {
            return 0;
        }
        let mut marks = FAULTLESS;
        for (rule, (_, all)) in ALL.iter().zip(&mut found) {
            let Find::InBlock(find) = rule.find else { continue };
            let findings = find(context, unit, block);
            if !findings.is_empty() {
                marks = 0;
                all.extend(findings);
            }
        }
        if unit.reads(block).iter().all(|read| is_common(read.number)) {
            marks |= READS_COMMONS_ALONE;
            marks |= if keeps_locals(&unit.blocks[block]) { KEEPS_LOCALS } else { 0 };
        }
        marks
    });
    let marks = marks.collect();
    found.retain(|(_, findings)| !findings.is_empty());
    (found, Some((first, marks)))
}

#[cfg(test)]
pub(super) mod testing {
    //! Runs all rules on a program and returns the findings of one.
    use super::Rule;
    use crate::{ControlKnowledge, check, check_loaded};
    use gcode_lang::control::Settings;
    use gcode_lang::program::{Memory, NoLibrary};

    pub(crate) const NOWHERE: [u32; 0] = [];

    /// Returns the line numbers of a rule's findings, counted from 1.
    pub(crate) fn lines(rule: &Rule, text: &str) -> Vec<u32> {
        let checked = check("test.nc", text.as_bytes(), &Settings::default(), &mut NoLibrary);
        let of_rule = checked.findings.iter().filter(|f| f.kind == &rule.kind);
        of_rule
            .map(|f| checked.memory.sources().line_column(f.backtrace.as_ref().unwrap().block).line)
            .collect()
    }

    /// Returns the messages of a rule's findings where no file states the control.
    pub(crate) fn messages_if_assumed(rule: &Rule, text: &str) -> Vec<String> {
        let mut memory = Memory::default();
        memory.load("test.nc", text.as_bytes());
        let assumed = ControlKnowledge::Assumed;
        let checked = check_loaded(memory, &Settings::default(), assumed, &mut NoLibrary);
        checked.findings.into_iter().filter(|f| f.kind == &rule.kind).map(|f| f.message).collect()
    }

    pub(crate) fn messages(rule: &Rule, text: &str) -> Vec<String> {
        let checked = check("test.nc", text.as_bytes(), &Settings::default(), &mut NoLibrary);
        checked.findings.into_iter().filter(|f| f.kind == &rule.kind).map(|f| f.message).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_code_is_unique_in_lower_case_and_has_its_section() {
        for (place, Rule { kind, .. }) in ALL.iter().enumerate() {
            assert!(kind.code.bytes().all(|b| b.is_ascii_lowercase() || b == b'-'), "{kind}");
            assert!(ALL[..place].iter().all(|other| &other.kind != kind), "{kind}");
            assert!(kind.page().starts_with(&format!("{kind}: {}\n", kind.title)), "{kind}");
        }
    }
}
