//! Refusal to rename a variable that a message to the operator names: the screen would show another text.
use crate::entry::EntryKind;
use crate::project::{ProgramKey, Project};
use crate::text::{Refusal, TextRange, line_range, lossy};

/// Variables whose assignment shows the comment behind it.
const MESSAGES: [u32; 2] = [3000, 3006];

impl Project {
    /// Refuses a variable that the text of `#3000=n(TEXT)` or `#3006=1(TEXT)` names.
    pub(super) fn refuse_messages(&self, keys: &[ProgramKey], number: u32) -> Result<(), Refusal> {
        for key in keys {
            let Some(index) = self.file(key.file) else { continue };
            let is_message =
                |kind: EntryKind, value: u32| kind == EntryKind::Write && MESSAGES.contains(&value);
            let entries = index.program_entries(key.program);
            for entry in entries.filter(|entry| is_message(entry.kind, entry.value)) {
                let line = line_range(index.text(), entry.range.start);
                let behind = lossy(TextRange::new(entry.range.end, line.end).of(index.text()));
                let text = behind.split_once('(').map(|(_, text)| text).unwrap_or_default();
                if names_variable(text.split(')').next().unwrap_or_default(), number) {
                    let reason = format!(
                        "the message of {} names #{number}: change its text by hand first",
                        self.place(*key, entry.range)
                    );
                    return Err(Refusal::new(reason).at(key.file, entry.range));
                }
            }
        }
        Ok(())
    }
}

/// Returns true if a text names a variable by its number.
fn names_variable(text: &str, number: u32) -> bool {
    text.split('#').skip(1).any(|part| {
        let digits = part.len() - part.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        part[..digits].parse() == Ok(number)
    })
}
