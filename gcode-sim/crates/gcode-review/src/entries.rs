//! One entry for all effects of an edit: what matters most is the headline, the others stand beside it.
use std::collections::BTreeMap;

use super::change::{Change, Effect};
use super::edits::Edits;

/// Of several effects of one edit the first of these is the headline. What happens to the part comes first, then what is
/// commanded, then what follows from it: a spindle speed before the feed by the turn.
const PRECEDENCE: [&str; 42] = [
    "outcome",
    "program",
    "hole-lost",
    "hole-added",
    "hole-moved",
    "hole-tilted",
    "hole-depth",
    "hole-diameter",
    "hole-tool",
    "hole-pass",
    "hole-order",
    "move-order",
    "start",
    "work-system",
    "tool-length",
    "cutter-side",
    "cycle",
    "return-level",
    "path-mode",
    "tool",
    "m-code",
    "spindle",
    "stop",
    "move-kind",
    "move-arc",
    "move-shifted",
    "move-added",
    "move-lost",
    "feed",
    "dwell",
    "coolant",
    "g-code",
    "block-skip",
    "switch",
    "signal",
    "output",
    "work-offset",
    "tool-offset",
    "parameter",
    "variable",
    "mode",
    "counter",
];

/// An effect and the numbers of the edits that it comes from; none where no edit is seen that it follows.
pub(super) type CausedEffect = (Vec<usize>, Effect);

/// All effects, those of one edit in one entry, and those of edits that do the same thing; the entries in the order in which
/// their headlines were found.
pub(super) fn entries(effects: Vec<CausedEffect>, edits: &Edits) -> Vec<Change> {
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
        all.sort_by_key(|(_, (_, effect))| rank(&effect.code));
        let mut all = all.into_iter();
        let Some((number, (causes, headline))) = all.next() else { continue };
        let mut change = Change::from(headline);
        if !causes.is_empty()
            && is_motion(&change.code)
            && let Some(blocks) = edits.blocks([change.old.as_ref(), change.new.as_ref()])
        {
            [change.old, change.new] = blocks.clone();
        }
        change.also = all.map(|(_, (_, effect))| effect).collect();
        entries.push((number, change));
    }
    entries.sort_by_key(|(number, _)| *number);
    entries.into_iter().map(|(_, change)| change).collect()
}

/// Whether the blocks of such an effect are those of moves, which may be others than the one that is edited.
fn is_motion(code: &str) -> bool {
    let codes =
        ["feed", "dwell", "tool", "tool-length", "cutter-side", "work-system", "cycle", "return-level"];
    ["hole-", "move-"].iter().any(|begin| code.starts_with(begin)) || codes.contains(&code)
}

/// The first edit that an edit is joined with.
fn root(joined: &[usize], mut edit: usize) -> usize {
    while joined[edit] != edit {
        edit = joined[edit];
    }
    edit
}

fn rank(code: &str) -> usize {
    PRECEDENCE.iter().position(|known| *known == code).unwrap_or(PRECEDENCE.len())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::super::change::CODES;
    use super::*;

    #[test]
    fn every_code_has_its_precedence() {
        assert_eq!(BTreeSet::from(PRECEDENCE), BTreeSet::from(CODES));
    }

    #[test]
    fn effects_of_edits_that_do_the_same_are_one_entry() {
        let edits = Edits::of_lines(&[3, 5, 7]);
        let effect = |causes: &[usize], code| (causes.to_vec(), Effect::new(code, code));
        let all = vec![
            effect(&[2], "feed"),
            effect(&[], "mode"),
            effect(&[0, 1], "move-shifted"),
            effect(&[2], "spindle"),
            effect(&[1], "hole-moved"),
        ];
        let shown =
            |change: &Change| change.effects().map(|(code, _)| code.to_owned()).collect::<Vec<_>>().join(" ");
        let shown: Vec<String> = entries(all, &edits).iter().map(shown).collect();
        assert_eq!(shown, ["mode", "spindle feed", "hole-moved move-shifted"]);
    }
}
