//! One entry for all effects of an edit: the one with the highest precedence is the headline.
use std::collections::BTreeMap;

use super::change::{Change, Effect};
use super::edits::Edits;
use super::kinds::{
    CUTTER_SIDE, CYCLE, DWELL, FEED, RETURN_LEVEL, TOOL, TOOL_LENGTH, WORK_SYSTEM, precedence,
};

/// An effect and the numbers of the edits that cause it; none if no edit precedes it.
pub(super) type CausedEffect = (Vec<usize>, Effect);

/// Returns one entry for each edit, and for edits that cause one effect together; in the order of their headlines.
pub(super) fn entries(effects: Vec<CausedEffect>, edits: &Edits<'_>) -> Vec<Change> {
    let mut joined: Vec<usize> = (0..edits.len()).collect();
    for (causes, _) in &effects {
        for other in causes.iter().skip(1) {
            let [first, other] = [causes[0], *other].map(|edit| root(&joined, edit));
            joined[first.max(other)] = first.min(other);
        }
    }
    let mut groups: BTreeMap<Option<usize>, Vec<(usize, CausedEffect)>> = BTreeMap::new();
    for (number, (causes, effect)) in effects.into_iter().enumerate() {
        let cause = causes.first().map(|edit| root(&joined, *edit));
        groups.entry(cause).or_default().push((number, (causes, effect)));
    }
    let mut entries: Vec<(usize, Change)> = Vec::with_capacity(groups.len());
    for mut all in groups.into_values() {
        all.sort_by_key(|(_, (_, effect))| precedence(&effect.code));
        let mut all = all.into_iter();
        let Some((number, (causes, headline))) = all.next() else { continue };
        let mut change = Change::from(headline);
        if !causes.is_empty()
            && is_motion(&change.code)
            && let Some(blocks) = edits.blocks([change.old.as_ref(), change.new.as_ref()])
        {
            [change.old, change.new] = blocks;
        }
        change.also = all.map(|(_, (_, effect))| effect).collect();
        entries.push((number, change));
    }
    entries.sort_by_key(|(number, _)| *number);
    entries.into_iter().map(|(_, change)| change).collect()
}

/// Returns true if the blocks of such an effect are those of moves, which may be other than the edited one.
fn is_motion(code: &str) -> bool {
    let kinds = [&FEED, &DWELL, &TOOL, &TOOL_LENGTH, &CUTTER_SIDE, &WORK_SYSTEM, &CYCLE, &RETURN_LEVEL];
    ["hole-", "move-"].iter().any(|begin| code.starts_with(begin))
        || kinds.iter().any(|kind| kind.code == code)
}

/// Returns the first edit that an edit is joined with.
fn root(joined: &[usize], mut edit: usize) -> usize {
    while joined[edit] != edit {
        edit = joined[edit];
    }
    edit
}

#[cfg(test)]
mod tests {
    use super::super::kinds::{FEED, HOLE_MOVED, MODE, MOVE_SHIFTED, SPINDLE};
    use super::*;

    #[test]
    fn effects_of_edits_that_do_the_same_are_one_entry() {
        let edits = Edits::of_lines(&[3, 5, 7]);
        let effect = |causes: &[usize], kind| (causes.to_vec(), Effect::new(kind, "", [None, None]));
        let all = vec![
            effect(&[2], &FEED),
            effect(&[], &MODE),
            effect(&[0, 1], &MOVE_SHIFTED),
            effect(&[2], &SPINDLE),
            effect(&[1], &HOLE_MOVED),
        ];
        let shown =
            |change: &Change| change.effects().map(|(code, _)| code.to_owned()).collect::<Vec<_>>().join(" ");
        let shown: Vec<String> = entries(all, &edits).iter().map(shown).collect();
        assert_eq!(shown, ["mode", "spindle feed", "hole-moved move-shifted"]);
    }
}
