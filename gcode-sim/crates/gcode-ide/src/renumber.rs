//! Renumbering of the sequence numbers of a program.
use std::collections::{BTreeMap, BTreeSet};

use crate::entry::EntryKind;
use crate::navigation::Access;
use crate::project::{ProgramKey, Project};
use crate::rename::{MAX_NUMBER, is_number};
use crate::text::{FileEdit, Refusal, TextEdit, TextRange};

impl Project {
    /// Returns the edits that renumber a program, or a range of it, with the jumps to its blocks.
    ///
    /// N0 stays, and no block gets an N that has none.
    ///
    /// # Errors
    ///
    /// The reason why a program could do something else afterwards.
    pub fn renumber(
        &self,
        key: ProgramKey,
        range: Option<TextRange>,
        from: u32,
        step: u32,
    ) -> Result<Vec<FileEdit>, Refusal> {
        if step == 0 || from == 0 {
            return Err(Refusal::new("write a first number and a step of 1 or more"));
        }
        self.refuse_unknown_jumps(key)?;
        let places = self.sequence_numbers(key);
        let (declared, jumps): (Vec<_>, Vec<_>) =
            places.into_iter().partition(|(_, reference)| reference.access == Access::Declaration);
        let is_in =
            |place: TextRange| range.is_none_or(|range| range.start <= place.start && place.end <= range.end);
        let (inside, outside): (Vec<_>, Vec<_>) = declared
            .into_iter()
            .partition(|(number, reference)| *number != 0 && is_in(reference.location.range));
        let kept: BTreeSet<u32> = outside.iter().map(|(number, _)| *number).collect();
        let mut new_numbers: BTreeMap<u32, u32> = BTreeMap::new();
        let mut repeated: BTreeSet<u32> = BTreeSet::new();
        let mut edits = Vec::new();
        for ((old, reference), index) in inside.iter().zip(0_u32..) {
            let new = index
                .checked_mul(step)
                .and_then(|add| from.checked_add(add))
                .filter(|new| *new <= MAX_NUMBER);
            let Some(new) = new else {
                return Err(Refusal::new(format!(
                    "the numbers would go beyond N{MAX_NUMBER}: take a smaller step"
                )));
            };
            if kept.contains(&new) {
                return Err(Refusal::new(format!("N{new} is in use outside the range")));
            }
            if kept.contains(old) || new_numbers.insert(*old, new).is_some() {
                repeated.insert(*old);
            }
            let edit = TextEdit { range: reference.location.range, text: format!("N{new}") };
            edits.push(FileEdit { file: key.file, edit });
        }
        let given: BTreeSet<u32> = new_numbers.values().copied().collect();
        let is_changed = |number: u32| match new_numbers.get(&number) {
            Some(new) => *new != number || repeated.contains(&number),
            None => given.contains(&number),
        };
        self.refuse_unfollowed(key, is_changed)?;
        for (number, reference) in &jumps {
            let (file, range) = (reference.location.file, reference.location.range);
            let refused = |reason: String| Refusal::new(reason).at(file, range);
            if repeated.contains(number) {
                return Err(refused(format!("a jump goes to N{number}, which several blocks have")));
            }
            match new_numbers.get(number) {
                Some(new) => edits.push(FileEdit { file, edit: TextEdit { range, text: new.to_string() } }),
                None if given.contains(number) && !kept.contains(number) => {
                    return Err(refused(format!(
                        "a jump goes to N{number}, which is missing, and would find it"
                    )));
                }
                None => {}
            }
        }
        edits.retain(|edit| self.text(edit.file, edit.edit.range) != edit.edit.text);
        edits.sort_unstable();
        let is_renumbered = |kind: EntryKind, from: u32, to: u32| {
            is_number(kind) && (new_numbers.get(&from) == Some(&to) || repeated.contains(&from))
        };
        self.prove(&edits, is_renumbered, |_, _| false)?;
        Ok(edits)
    }
}
