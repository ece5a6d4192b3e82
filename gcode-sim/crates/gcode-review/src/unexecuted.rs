//! Changed blocks that no run executes.
use super::change::UnexecutedChange;
use super::other_blocks::{has_idle_blocks, sides};
use super::program_text::{ChangedPassage, ProgramSide, read_words, words};
use super::record::Record;

/// Returns the changed blocks of programs of both records that no run executed as a whole, in their order: their effect
/// is unknown. A file of an earlier version has none.
pub fn unexecuted(old: &Record, new: &Record) -> Vec<UnexecutedChange> {
    if ![old, new].into_iter().any(has_idle_blocks) {
        return Vec::new();
    }
    let [was, is] = sides(old, new);
    let has_words = |side: &ProgramSide<'_>, index: usize| !words(&side.text(index)).is_empty();
    let with_words = |side: &ProgramSide<'_>| (0..side.count()).any(|index| has_words(side, index));
    let is_done =
        |side: &ProgramSide<'_>, index: usize| side.reached(index).is_some_and(|(_, is_whole)| is_whole);
    let is_idle = |side: &ProgramSide<'_>| {
        (0..side.count()).any(|index| !is_done(side, index) && has_words(side, index))
    };
    let mut all = Vec::new();
    for before in &was {
        let Some(now) = is.iter().find(|other| other.name == before.name) else { continue };
        let is_compared = before.name.is_empty() || with_words(before) && with_words(now);
        if !(is_compared && (is_idle(before) || is_idle(now))) {
            continue;
        }
        let sides = [before, now];
        let passage = ChangedPassage::new(sides, read_words);
        for gap in passage.differences() {
            let [mut lost, mut added] = [0, 1].map(|side| {
                let blocks = passage.indices(side, &gap[side]).iter().map(|index| *index as usize);
                blocks
                    .filter(move |index| !is_done(sides[side], *index))
                    .map(move |index| sides[side].location(index))
            });
            let changes = std::iter::from_fn(|| match (lost.next(), added.next()) {
                (None, None) => None,
                (old, new) => Some(UnexecutedChange { old, new }),
            });
            all.extend(changes);
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use gcode_inspect::machine::Machine;
    use gcode_lang::program::NoLibrary;
    use gcode_session::Request;

    use super::*;
    use crate::Revision;

    /// A dump has O2 in two folders: each is compared with that of its own folder.
    #[test]
    fn programs_of_one_number_are_paired_by_their_folders() {
        let run = |library: &str| {
            let text = format!(
                "O1\nM98 P2\nM30\n&F=//CNC_MEM/USER/PATH1/\nO2\n#100=1\nM99\n&F=//CNC_MEM/USER/LIBRARY/\nO2\n{library}\nM99\n"
            );
            let request = Request::new("O1.nc", text.into_bytes(), Machine::default());
            Revision::of(&request, &mut NoLibrary, None).unwrap()
        };
        let lines = |old: &Revision, new: &Revision| {
            let all = unexecuted(&old.record, &new.record).into_iter();
            all.map(|change| [change.old, change.new].map(|block| block.map(|block| block.line)))
                .collect::<Vec<_>>()
        };
        assert_eq!(lines(&run("#100=2"), &run("#100=2")), [[None; 2]; 0]);
        assert_eq!(lines(&run("#100=2"), &run("#100=3")), [[Some(10), Some(10)]]);
    }
}
