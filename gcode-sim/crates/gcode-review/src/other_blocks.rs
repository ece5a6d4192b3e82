//! Blocks of a record that no step names: an edit of one can cause a difference, and one without execution can be changed.
use std::borrow::Cow;
use std::collections::BTreeMap;

use super::block_location::{BlockLocation, OtherBlock};
use super::program_text::{NamedBlock, ProgramSide, words, written};
use super::record::Record;

/// Returns the programs of two records with their blocks: of runs all blocks; if one record is from a file, those that steps
/// and their calls name, and the others if both records have them. The main program has no name.
pub(super) fn sides<'a>(old: &'a Record, new: &'a Record) -> [Vec<ProgramSide<'a>>; 2] {
    if let (Some(was), Some(is)) = (written(old), written(new)) {
        return [was, is];
    }
    let have_others = ![old, new].iter().any(|record| record.lacks_other_blocks());
    [old, new].map(|record| named_sides(record, have_others))
}

/// Returns the blocks of steps by program, with the others or without them.
fn named_sides(record: &Record, with_others: bool) -> Vec<ProgramSide<'_>> {
    let mut found = blocks_of_steps(record);
    let others = if with_others { others(record, &found) } else { Vec::new() };
    for OtherBlock { program, line, block, steps, in_part } in others {
        let location = BlockLocation { program: program.clone(), line, block, calls: Vec::new() };
        found.entry((program, line)).or_insert((location, steps.map(|steps| (steps, !in_part))));
    }
    let outermost = |block: Cow<'_, BlockLocation>| Some(block.outermost_first().next()?.program.clone());
    let first = (record.steps.len() > 0).then(|| record.block(0));
    let main = record.program.clone().or(first.and_then(outermost));
    let mut programs: BTreeMap<String, Vec<NamedBlock>> = BTreeMap::new();
    for ((program, _), block) in found {
        let name = if Some(&program) == main.as_ref() { String::new() } else { program };
        programs.entry(name).or_default().push(block);
    }
    programs.into_iter().map(|(name, blocks)| ProgramSide::named(name, blocks)).collect()
}

/// Returns the blocks that steps and their calls name, by program and line.
fn blocks_of_steps(record: &Record) -> BTreeMap<(String, u32), NamedBlock> {
    let mut found = BTreeMap::new();
    let mut is_known = vec![false; record.blocks.len()];
    for number in 0..record.steps.len() {
        let block_number = record.steps.block_number(number);
        if std::mem::replace(&mut is_known[block_number], true) {
            continue;
        }
        for block in record.blocks.location(block_number).outermost_first() {
            let location = || BlockLocation { calls: Vec::new(), ..block.clone() };
            let of_block = found.entry((block.program.clone(), block.line));
            of_block.or_insert_with(|| (location(), Some((number, true))));
        }
    }
    found
}

/// Returns the blocks with words that no step names, of the programs that the run executes; `None` for a file without them.
pub(super) fn other_blocks(record: &Record) -> Option<Vec<OtherBlock>> {
    (!record.lacks_other_blocks()).then(|| others(record, &blocks_of_steps(record)))
}

/// Returns true if a record has a block that it does not execute as a whole.
pub(super) fn has_idle_blocks(record: &Record) -> bool {
    let Some(programs) = written(record) else {
        return record.other_blocks.iter().flatten().any(|block| block.steps.is_none() || block.in_part);
    };
    let is_idle = |(side, index): (&ProgramSide<'_>, usize)| {
        !side.reached(index).is_some_and(|(_, is_whole)| is_whole) && !words(&side.text(index)).is_empty()
    };
    programs.iter().flat_map(|side| (0..side.count()).map(move |index| (side, index))).any(is_idle)
}

/// Returns [`other_blocks`] beside those of the steps.
fn others(record: &Record, of_steps: &BTreeMap<(String, u32), NamedBlock>) -> Vec<OtherBlock> {
    let Some(programs) = written(record) else { return record.other_blocks.clone().unwrap_or_default() };
    let mut others = Vec::new();
    for side in &programs {
        if (0..side.count()).all(|index| side.reached(index).is_none()) {
            continue;
        }
        for index in 0..side.count() {
            let (program, line) = side.place(index);
            if !of_steps.contains_key(&(program.to_owned(), line)) && !words(&side.text(index)).is_empty() {
                let (program, block) = (program.to_owned(), side.text(index).into_owned());
                let reached = side.reached(index);
                let in_part = reached.is_some_and(|(_, is_whole)| !is_whole);
                others.push(OtherBlock {
                    program,
                    line,
                    block,
                    steps: reached.map(|(steps, _)| steps),
                    in_part,
                });
            }
        }
    }
    others
}

#[cfg(test)]
mod tests {
    use gcode_inspect::machine::Machine;
    use gcode_lang::program::NoLibrary;
    use gcode_session::Request;

    use crate::{Record, Revision, changes, unexecuted};

    /// G52 and an assignment make no step: the file keeps them, because later moves depend on them.
    #[test]
    fn an_edited_block_without_a_step_is_the_cause_behind_a_file() {
        let record = |shift: &str, depth: &str| {
            let text = format!("O1\nG90 G54 G0 X0 Y0 Z9.\n{shift}\n{depth}\nG1 X10. F9\nZ-#1\nM30\n");
            let request = Request::new("O1.nc", text.into_bytes(), Machine::default());
            Revision::of(&request, &mut NoLibrary, None).unwrap().record
        };
        let file = record("G52 X1.", "#1=5.").to_json().unwrap();
        // A file of an earlier version names the blocks that move.
        let others = file.find("\"other_blocks\"").unwrap()..file.find("\"begun\"").unwrap();
        let earlier = file.replace(&file[others], "");
        let shifted = ["G52 X1.", "G52 X2."];
        for (new, of_edit, of_move) in [
            (record("G52 X2.", "#1=5."), shifted, ["G1 X10. F9"; 2]),
            (record("G52 X1.", "#1=6."), ["#1=5.", "#1=6."], ["Z-#1"; 2]),
        ] {
            for (file, expected) in [(&file, of_edit), (&earlier, of_move)] {
                let found = changes(&Record::from_json(file).unwrap(), &new, 1e-4);
                let blocks = [&found[0].old, &found[0].new].map(|at| at.as_ref().unwrap().block.clone());
                assert_eq!(blocks, expected);
            }
        }
    }

    fn record(text: &str) -> Record {
        let request = Request::new("O1.nc", text.as_bytes(), Machine::default());
        Revision::of(&request, &mut NoLibrary, None).unwrap().record
    }

    /// The second size of a family of parts: #500 is vacant, so that no run takes the branch.
    #[test]
    fn a_changed_block_of_another_branch_is_found_behind_a_file() {
        let text = |length: &str, guard: &str| {
            format!(
                "O1\n#1=40.\nIF[#500EQ2]GOTO20\nGOTO30\nN20 #1={length}\nN30 G0 X#1\nIF[#1LT1]THEN#3000={guard}\nM30\n"
            )
        };
        let accepted = Record::from_json(&record(&text("80.", "1")).to_json().unwrap()).unwrap();
        let blocks = |length: &str, guard: &str| {
            let new = record(&text(length, guard));
            assert!(changes(&accepted, &new, 1e-4).is_empty());
            let all = unexecuted(&accepted, &new).into_iter().map(|change| change.new.unwrap().block);
            all.collect::<Vec<_>>()
        };
        assert!(blocks("80.", "1").is_empty() && blocks("80. (LONG)", "1").is_empty());
        assert_eq!(blocks("30.", "1"), ["N20 #1=30."]);
        assert_eq!(blocks("80.", "2"), ["IF[#1LT1]THEN#3000=2"]);
    }
}
