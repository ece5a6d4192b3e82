//! Check of a long program in pieces: the trees and operations of one piece are in memory at a time.
//!
//! A piece ends where control passes in one way only, from its last block to the next one: no loop and no jump leads across.
//! What the analyses know at its end is the start of the next piece; a computed jump brings its states to the numbers of all
//! pieces (`computed_jumps`). Where this does not hold (a jump over many blocks, a modal macro), or a finding rests on the whole
//! program, the program is checked as a whole.
use std::collections::BTreeMap;

use gcode_lang::diag::Diagnostic;
use gcode_lang::program::{Library, OpIndex, Program, ProgramId};
use gcode_lang::syntax::KnownBlocks;

use super::computed_jumps::ComputedJumps;
use super::context::{CheckContext, LoadedProgram, ProgramUnit, Role};
use super::loader::Loader;
use super::modes::modes_before;
use super::piece::{Piece, PieceEntry, PieceStart};
use super::piece_ends::{PieceSizes, far_jumps, piece_end};
use super::rules::{self, doubled_numbers, limits_lookahead, pending_moves};
use super::vacancy::states_without_arguments;
use super::whole_program::{NotInPieces, WholeProgram};
use super::{ControlKnowledge, FindingLimit};

/// Most blocks behind a piece to which its jumps lead: mostly they are the ends and the alarms of a program.
const MAX_FAR_TARGETS: usize = 200;

/// Most passes over a program until the states of its computed jumps are known.
const MAX_PASSES: usize = 5;

/// How long programs are checked, and what is kept of their findings.
#[derive(Clone, Copy)]
pub(super) struct PieceRules<'a> {
    pub knowledge: ControlKnowledge,
    pub sizes: PieceSizes,
    pub limit: FindingLimit<'a>,
}

/// Returns the findings of all programs, and the number of those beyond the limit; `None` if a long one has to be checked as a whole.
pub(super) fn findings<L: Library>(
    loader: &mut Loader<'_, L>,
    rules: PieceRules<'_>,
) -> Option<(Vec<Diagnostic>, usize)> {
    let mut of_long = Vec::new();
    for id in loader.long.clone() {
        let found = findings_of_program(loader, id, rules).ok()?;
        of_long.push((id, found));
    }
    let mut found = findings_of_others(loader, &mut of_long, rules.knowledge);
    let mut left_over = 0;
    for (id, mut program) in of_long {
        left_over += program.left_over.values().sum::<usize>();
        rules::put_pieces_in_order(&mut program.findings, &program.suppressions);
        found.push((id, program.findings));
    }
    let is_called = |id: &ProgramId| loader.is_called(*id);
    found.sort_by_key(|(id, _)| if is_called(id) { ProgramId(u32::MAX) } else { *id });
    Some((found.into_iter().flat_map(|(_, found)| found).collect(), left_over))
}

/// Checks the programs that are loaded, with the calls of the long ones. Adds what is found of these calls together.
fn findings_of_others<L: Library>(
    loader: &mut Loader<'_, L>,
    long: &mut [(ProgramId, WholeProgram)],
    knowledge: ControlKnowledge,
) -> Vec<(ProgramId, Vec<Diagnostic>)> {
    let mut units = std::mem::take(&mut loader.loaded);
    let others = units.len();
    let mut whole = Vec::new();
    for (id, found) in &*long {
        let program = loader.memory.get(*id);
        let mut is_left_out = vec![true; program.block_count()];
        found.calls.iter().for_each(|block| is_left_out[*block] = false);
        let short = program.without(&is_left_out);
        whole.push((*id, loader.memory.replace(*id, short)));
        let mut none = KnownBlocks::default();
        let calls = LoadedProgram::new(loader.memory, *id, &mut none, loader.settings);
        units.push(LoadedProgram { other_units: found.units, ..calls });
    }
    let mut context = CheckContext::new(loader.memory, (loader.settings, knowledge), units, rules::codes());
    for unit in &mut context.units {
        unit.left_out = loader.repetitions.left_out(unit.id);
    }
    for ((_, found), unit) in long.iter().zip(&mut context.units[others..]) {
        let left_out = &mut unit.left_out.calls;
        for calls in found.missing.values() {
            let all: usize =
                calls.iter().map(|call| 1 + left_out.get(call).copied().unwrap_or_default()).sum();
            left_out.insert(calls[0], all - 1);
        }
    }
    let of_unit = |unit: &ProgramUnit<'_>| (unit.id, rules::findings_in_program(&context, unit));
    let of_others: Vec<_> = context.units[..others].iter().map(of_unit).collect();
    of_others.iter().for_each(|(_, found)| loader.repetitions.note_found(found));
    for ((_, found), calls) in long.iter_mut().zip(&context.units[others..]) {
        found.findings.extend(rules::missing_programs(&context, calls));
    }
    let mut units = context.into_loaded();
    units.truncate(others);
    loader.loaded = units;
    for (id, program) in whole {
        loader.memory.replace(id, program);
    }
    of_others
}

/// Checks a long program, first in the role that its number suggests; another one shows only at its end.
fn findings_of_program<L: Library>(
    loader: &mut Loader<'_, L>,
    id: ProgramId,
    rules: PieceRules<'_>,
) -> Result<WholeProgram, NotInPieces> {
    let whole = loader.memory.get(id);
    let part = whole.part(0..0);
    let whole = loader.memory.replace(id, part);
    let suggested = Role::of_uncalled(whole.number(), (false, false));
    let mut result = findings_as(loader, (id, &whole, suggested), rules);
    if let Ok(found) = &result {
        let role = Role::of_uncalled(whole.number(), (found.returns, found.ends));
        if role != suggested {
            result = findings_as(loader, (id, &whole, role), rules);
        }
    }
    loader.memory.replace(id, whole);
    result
}

/// Checks a long program in a role, in as many passes as its computed jumps need.
fn findings_as<L: Library>(
    loader: &mut Loader<'_, L>,
    program: (ProgramId, &Program, Role),
    rules: PieceRules<'_>,
) -> Result<WholeProgram, NotInPieces> {
    let mut computed_jumps = ComputedJumps::default();
    for _ in 0..MAX_PASSES {
        let found = findings_of_pass(loader, program, computed_jumps, rules)?;
        if !found.computed_jumps.are_outdated() {
            return Ok(found);
        }
        computed_jumps = found.computed_jumps.for_next_pass();
    }
    Err(NotInPieces)
}

/// Checks a long program piece by piece, in a role.
fn findings_of_pass<L: Library>(
    loader: &mut Loader<'_, L>,
    (id, whole, role): (ProgramId, &Program, Role),
    computed_jumps: ComputedJumps,
    rules: PieceRules<'_>,
) -> Result<WholeProgram, NotInPieces> {
    let mut found = WholeProgram::new(computed_jumps);
    let mut start = PieceStart::of_program(role);
    let mut first = 0;
    let mut far: BTreeMap<OpIndex, PieceEntry> = BTreeMap::new();
    let mut farthest: OpIndex = 0;
    while first < whole.block_count() {
        let end = piece_end(loader.memory, (id, whole), first, rules.sizes).ok_or(NotInPieces)?;
        let is_last = end == whole.block_count();
        loader.memory.replace(id, whole.part(first..end));
        let mut none = KnownBlocks::default();
        let mut program = LoadedProgram::new(loader.memory, id, &mut none, loader.settings);
        let behind = far.split_off(&end);
        let entries = std::mem::replace(&mut far, behind).into_iter();
        let entries = entries.map(|(target, entry)| PieceEntry { block: target - first, ..entry });
        let entries = entries.chain(found.computed_jumps.entry(end - first)).collect();
        let (targets, far_jumps) = far_jumps(loader.memory.get(id), (whole, first..end));
        if MAX_FAR_TARGETS < targets.len() || targets.iter().any(|target| whole.is_in_loop(*target)) {
            return Err(NotInPieces);
        }
        program.other_units = start.units.0;
        let left_out_until = farthest.saturating_sub(first);
        let is_first = first == 0;
        program.piece = Some(Piece { role, start, entries, far_jumps, left_out_until, is_first, is_last });
        farthest = targets.iter().copied().fold(farthest, OpIndex::max);
        loader.find_called(id, &program.calls);
        loader.load_found(&mut none, usize::MAX);
        // The piece is the last unit.
        let mut units = std::mem::take(&mut loader.loaded);
        units.push(program);
        let control = (loader.settings, rules.knowledge);
        let context = CheckContext::new(loader.memory, control, units, rules::codes());
        let result = match context.units.last() {
            Some(unit) => found.add(&context, unit, (whole, first..end), &loader.long).map(|(start, new)| {
                loader.repetitions.note_found(&new);
                found.keep(new, rules.limit);
                for (target, entry) in far_entries(&context, unit, &targets) {
                    far.entry(target).and_modify(|known| known.join(entry)).or_insert(entry);
                }
                start
            }),
            None => Err(NotInPieces),
        };
        loader.loaded = context.into_loaded();
        loader.loaded.pop();
        start = result?;
        first = end;
    }
    if role == Role::Main && !found.has_exit && found.has_unset {
        return Err(NotInPieces);
    }
    found.points.pointed += loader.repetitions.left_out(id).points;
    let source = whole.span.source;
    let is_other = |other: &ProgramId| *other != id && loader.memory.get(*other).span.source == source;
    // The programs of a file count together.
    if found.missing_points.is_some() && loader.memory.ids().any(|other| is_other(&other)) {
        return Err(NotInPieces);
    }
    found.judge_missing_points(rules.knowledge);
    let numbers = std::mem::take(&mut found.numbers);
    found.findings.extend(doubled_numbers(loader.memory.sources(), numbers, &found.jumps));
    Ok(found)
}
/// Returns the states that the jumps of a piece bring to blocks behind it.
fn far_entries(
    context: &CheckContext<'_>,
    unit: &ProgramUnit<'_>,
    targets: &[OpIndex],
) -> Vec<(OpIndex, PieceEntry)> {
    let (modes, locals) = (modes_before(context, unit), states_without_arguments(unit));
    let pending = if limits_lookahead(context, unit) { Vec::new() } else { pending_moves(context, unit) };
    let nodes = unit.flow.far_nodes().zip(targets).zip(&unit.reached_far);
    let entries = nodes.filter(|(_, is_reached)| **is_reached).filter_map(|((node, target), _)| {
        let pending_move = pending.get(node).copied().flatten().flatten();
        Some((
            *target,
            PieceEntry { block: *target, modes: modes[node]?, locals: locals[node], pending_move },
        ))
    });
    entries.collect()
}
#[cfg(test)]
mod tests {
    use gcode_lang::control::Settings;
    use gcode_lang::program::{Memory, NoLibrary};
    use proptest::collection::vec;
    use proptest::prelude::*;

    use super::*;
    use crate::{CheckResult, check, check_sized};

    /// Pieces of two blocks and more.
    const SMALL: PieceSizes = PieceSizes { whole: 3, piece: 2, window: 4 };

    const SMALL_RULES: PieceRules<'_> =
        PieceRules { knowledge: ControlKnowledge::Stated, sizes: SMALL, limit: FindingLimit::NONE };

    fn memory(text: &str) -> Memory {
        let mut memory = Memory::default();
        memory.load("O1.nc", text.as_bytes().to_vec());
        memory
    }

    /// Returns the findings of a check in small pieces; `None` if a program has to be checked as a whole.
    fn in_pieces(text: &str) -> Option<Vec<Diagnostic>> {
        let (mut memory, settings, mut library) = (memory(text), Settings::default(), NoLibrary);
        let mut loader = Loader::new(&mut memory, &settings, &mut library);
        loader.load_found(&mut KnownBlocks::default(), SMALL.whole);
        assert!(!loader.long.is_empty(), "{text}");
        findings(&mut loader, SMALL_RULES).map(|(findings, _)| findings)
    }

    #[test]
    fn findings_beyond_a_limit_are_counted() {
        let faults = "G0 Y1.\n#34=1\nG0 X2.\n#101=SQRT[-4]\nG0 Z1.\n".repeat(4);
        let text = format!("O1\n(CHECK-OFF ROUNDED-PI)\n#102=3.14*#101\n{faults}M30\n");
        let of_kind = |finding: &Diagnostic| finding.kind.code != "constant-alarm";
        let limit = FindingLimit { of_kind: 3, is_shown: &of_kind };
        let settings = Settings::default();
        let texts = (memory(&text), KnownBlocks::default());
        let rules = PieceRules { limit, ..SMALL_RULES };
        let found = check_sized(texts, &settings, &mut NoLibrary, rules);
        let codes: Vec<_> = found.findings.iter().map(|finding| finding.code().into_owned()).collect();
        assert_eq!(codes, ["no-such-variable"; 3], "the first of a kind that is shown");
        assert_eq!(found.left_over, 1, "neither those that are not shown nor the suppressed one");
    }

    fn shown(findings: &[Diagnostic]) -> Vec<String> {
        let each = findings.iter().map(|f| {
            let place = (&f.backtrace, &f.span, &f.labels);
            format!("{} {:?} {} {place:?} {:?} {:?}", f.kind, f.severity, f.message, f.help, f.notes)
        });
        each.collect()
    }

    fn of_whole(text: &str) -> Vec<String> {
        shown(&check("O1.nc", text.as_bytes(), &Settings::default(), &mut NoLibrary).findings)
    }

    #[test]
    fn loops_and_jumps_within_pieces_are_checked_in_pieces() {
        for text in [
            "O1\n#100=0\nWHILE[#100LT3]DO1\n#100=#100+1\nEND1\n#101=1\n#102=1\n#103=#1\n#104=1\nM30\n",
            "O1\nG1 F9.\n#1=2\n#101=#1\nIF[#101EQ2]GOTO5\nN5#102=#2\n#101=1\nX5.\n#3=#5041\nIF[#101EQ2]GOTO6\nN6#2=1\n\
             #102=1\n#102=2\nM30\n",
            "O1(CHECK-OFF UNSET-VARIABLE)\n#101=1\n#101=#1\n#101=2\n#101=#2\n#101=#3\nG1X1.\n#101=2\nN1\nN1\nM30\n",
            "O1\n#101=1\n#101=2\n#101=3\n#101=2\nG65P2A1.\n#101=2\n#101=2\nG65P2B1.\n#101=2\nM30\nO2\nX#3\nM99\n",
            "O1\n#101=1\n#101=2\nIF[#2EQ#0]GOTO90\n#101=#1\n#2=1\n#101=2\nX1.\nIF[#101EQ5.]GOTO90\n#101=2\n#101=2\nM30\n\
             N90#101=#2\n#101=1\n#101=1\n#101=1\nM30\n",
            "O1\nG1\n#101=1\n#101=2\nIF[#102EQ1]GOTO90\n#101=2\nF9.\n#101=2\n#101=2\n#101=2\n#101=2\nN90X5.\n#101=2\nM30\n",
            "O1\n/2X1.\n#110=#111\n/2X1.\n#3=#5021\n#110=#111\n#110=#111\n#110=#111\nM30\n",
            "O1\nX1000\n#101=2\nX1.\n#101=3\n#101=2\n#101=2\n#101=2\n#101=2\n#101=2\n#101=2\n#101=2\nM30\n",
            "O1\nX1000\n#101=2\nX5000\n#101=3\n#101=2\n#101=2\n#101=2\n#101=2\n#101=2\n#101=2\n#101=2\nM30\n",
            "O1\nG65P3A1.\nM8\nG65P3A2.\nM8\nM98P4\nM8\nG65P3B1.\nM8\nG65P3A1.\nM8\nM98P4L2\nG65P3\nM8\nM8\nM30\n",
            "O9001\n#101=1\n#101=2\n#101=3\n#101=#1\n#101=2\n#101=2\nX1.\n#101=2\n#101=2\nM99\n",
            "O1\nG1\n#101=1\n#101=2\n/M30\n#101=2\n#101=2\n#101=2\nU5.\n#101=2\n#101=2\n#101=2\nM30\n",
            "O1\nU4.\n#101=1\nIF[#101EQ5.]GOTO90\n#101=2\n#101=2\nU5.\n#101=2\n#101=2\n#101=2\nN90U6.\n#101=2\nM30\n",
            "O1\nX1..5\n#1=\nX1..5\nX1..5\n#101=\nX1..5\nL X+1\nX1..5\nX1..5\nX1..5\nM30\n",
        ] {
            let found = in_pieces(text);
            assert!(found.is_some(), "{text}");
            assert_eq!(shown(&found.unwrap_or_default()), of_whole(text), "{text}");
        }
    }

    #[test]
    fn what_leads_far_is_checked_as_a_whole() {
        for text in [
            "O1\nN1#101=1\n#101=2\n#101=3\n#101=2\n#101=2\n#101=2\n#101=2\n#101=2\n#101=2\n#101=2\nGOTO1\n",
            // Whether #1 is set where N1 is reached for the first time, and whether the loop is left, rests on all blocks up to the jump.
            "O1\nN1#101=#1\n#101=2\n#101=3\n#101=2\n#101=2\n#1=2\n#101=2\n#101=2\n#101=2\nIF[#100EQ1]GOTO#100\nM30\n",
            "O1\nN1#102=1\n#102=3\nIF[#103EQ5]GOTO1\n#101=2\n#101=2\n#101=2\n#101=2\nIF[#100EQ1]GOTO#100\nM30\n",
            "O1\nM30\n#101=2\n#101=3\n#101=2\n#101=2\n#101=2\n#101=2\n#101=2\n#101=2\n#101=2\n",
        ] {
            assert!(in_pieces(text).is_none(), "{text}");
        }
    }

    /// A missing macro may return to any number, an unreadable block and a computed GOTO may lead there, forward and back.
    #[test]
    fn computed_jumps_bring_their_states_to_the_numbers_of_all_pieces() {
        for jump in ["G65P2A1.", "/GOTO#100", "X1..5", "N9X1..5"] {
            // At N7, line 8, #1 is unset behind the block before and behind the jump; #3 is set at both.
            let text = format!(
                "O1\nN1G1\n#3=1.\n#101=1\n#101=1\n{jump}\n#101=2\nN7#102=#1\n#101=3\n#101=3\n#101=3\nN8X#3\n#101=3\n\
                 N4X9.\n#3=2\n#101=4\n{jump}\n#101=5\nM30\n"
            );
            let found = in_pieces(&text).unwrap_or_else(|| panic!("{text}"));
            assert_eq!(shown(&found), of_whole(&text), "{text}");
            let places = |code: &str| {
                let of_code = found.iter().filter(|finding| finding.kind.code == code);
                of_code.map(|f| text[..f.span.unwrap().start as usize].lines().count()).collect::<Vec<_>>()
            };
            assert_eq!(places("unset-variable"), [8], "{text}");
        }
    }

    /// Blocks of all kinds, some of them with faults.
    const BLOCKS: &str = "(N[1-4]0 ?)?(G0?[0-3] ?)?X[0-9]\\.(Y[0-9]{1,2}\\.)?( F[0-9]0\\.)?|M30|M99|G81Z-1\\.R1\\.|#1=#2|#[1-4]=#[1-4]\\+1\
        |IF\\[#1EQ#0\\]GOTO[1-4]0|M98P2|G65P2A1\\.|WHILE\\[#1LT2\\]DO1|END1|\\(A\\)|O2|IF\\[#1EQ2\\]THEN#3000=1\\(A\\)|G4X#7|/2X1\\.\
        |#34=#[1-4]|#100=#10[0-9]\\+1|#101=#450|#2=#[1-4]\\*3\\.14|#101=SQRT\\[-4\\]|#3=#5021|IF\\[#0EQ#0\\]GOTO20\
        |\\(CHECK-OFF ROUNDED-PI\\)|X#101|G10L52|G11|N[1-9]0|G80|G66P2|G67|#33=#0|X[1-9]0{0,3}\
        |X1\\.\\.5|#1=|L X\\+1|END3|DO4|G1X\\[#1|(N[1-9]0)?(G65P9A1\\.|M98P9)|(N[1-9]0)?X1\\.\\.1|GOTO#100|(N[1-9]0)?U[1-9]\\.|/M30\
        |/?GOTO[5-9]0|IF\\[#2EQ#0\\]GOTO[5-9]0|M96P#1Q1|G0X#1";

    proptest! {
        #[test]
        fn a_check_in_pieces_finds_what_a_check_of_the_whole_finds(
            groups in vec((proptest::string::string_regex(BLOCKS).unwrap(), 0..4_usize), 1..25),
            is_ended in any::<bool>(),
        ) {
            let group = |(block, plain): &(String, usize)| format!("{block}\n{}", "#110=#111+1.\n".repeat(*plain));
            let blocks: String = groups.iter().map(group).collect();
            let end = if is_ended { "M30\n" } else { "" };
            let text = format!("O1\n{blocks}{end}(THE END OF THE WHOLE PROGRAM)\n");
            let settings = Settings::default();
            let texts = (memory(&text), KnownBlocks::default());
            let CheckResult { findings, programs, .. } = check_sized(texts, &settings, &mut NoLibrary, SMALL_RULES);
            let whole = check("O1.nc", text.as_bytes(), &settings, &mut NoLibrary);
            prop_assert_eq!(shown(&findings), shown(&whole.findings), "{}", text);
            prop_assert_eq!(programs, whole.programs);
        }
    }
}
