//! Differences of two revisions, as text and as data.
use std::collections::BTreeMap;
use std::fmt::Write;

use schemars::JsonSchema;
use serde::Serialize;

use super::figures::count;
use super::sarif::{FileLocation, Finding};
use gcode_lang::diag::Severity;
use gcode_review::{BlockLocation, Change, Effect, Record, Totals, UnexecutedChange};

/// The document of `diff --format json`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct ChangesReport {
    /// Basis of the numbers.
    pub basis: &'static str,
    /// Whether the part and the control's final state are the same, and both programs ran to their ends.
    pub same: bool,
    /// Tolerance for equality, mm or degrees.
    pub tolerance: f64,
    /// The differences, each with its effects.
    pub changes: Vec<Change>,
    /// Changed blocks that neither run executed: their effect is not compared.
    pub unexecuted: Vec<UnexecutedChange>,
    /// The old revision.
    pub old: Side,
    /// The new revision.
    pub new: Side,
    /// The end of a run that stopped before its program's end: the rest could not be compared.
    #[serde(skip)]
    stopped: Option<String>,
}

/// Totals of one revision.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Side {
    /// File name as the user gave it.
    pub name: String,
    /// End of the run: end, alarm or limit.
    pub outcome: String,
    /// Numbers of holes, moves and blocks, and the time.
    #[serde(flatten)]
    pub totals: Totals,
}

impl ChangesReport {
    /// Builds the report from the names and records of the revisions, and their differences.
    pub fn new(
        old: (&str, &Record),
        new: (&str, &Record),
        changes: &[Change],
        unexecuted: Vec<UnexecutedChange>,
        tolerance: f64,
    ) -> Self {
        let side = |(name, record): (&str, &Record)| Side {
            name: name.to_owned(),
            outcome: record.outcome().to_owned(),
            totals: record.totals.clone(),
        };
        let stopped = [old.1, new.1].into_iter().find(|record| record.outcome() != "end");
        Self {
            basis: "predicted by simulation, not measured",
            same: changes.is_empty() && stopped.is_none(),
            tolerance,
            changes: changes.to_vec(),
            unexecuted,
            old: side(old),
            new: side(new),
            stopped: stopped.map(|record| record.words().to_owned()),
        }
    }

    /// Formats the differences for a terminal.
    pub fn text(&self) -> String {
        let mut text = String::new();
        append_entries(&mut text, &self.changes, "");
        let _ = match (self.changes.len(), &self.stopped) {
            (0, None) => writeln!(text, "no difference on the part or in the control's final state"),
            (0, Some(words)) if self.old.totals.moves == 0 => {
                writeln!(text, "nothing could be compared: both stop before the first move, {words}")
            }
            (0, Some(words)) => {
                writeln!(text, "no difference before the stop; the rest could not be compared: {words}")
            }
            (number, _) => writeln!(text, "{}", count(number, "change")),
        };
        self.append_unexecuted(&mut text);
        for (word, Side { name, totals, .. }) in [("old", &self.old), ("new", &self.new)] {
            let _ = writeln!(
                text,
                "{word}  {name}: {}, {}, {}, {:.1} s",
                count(totals.holes, "hole"),
                count(totals.moves, "move"),
                count(totals.blocks, "block"),
                totals.seconds
            );
        }
        text
    }

    fn append_unexecuted(&self, text: &mut String) {
        const SHOWN: usize = 6;
        let all = &self.unexecuted;
        if all.is_empty() {
            return;
        }
        let _ = writeln!(text, "changed blocks that neither run executed (effect unknown): {}", all.len());
        for UnexecutedChange { old, new } in all.iter().take(SHOWN) {
            for (word, location) in [("old", old), ("new", new)] {
                let Some(location) = location else { continue };
                let _ = writeln!(text, "    {word} {}", line(location));
            }
        }
        if SHOWN < all.len() {
            let _ = writeln!(text, "… and {} more of them: --format json lists them all", all.len() - SHOWN);
        }
    }
}

/// Writes the changes with their blocks; of each kind a few, and the number of the others.
pub(super) fn append_entries(text: &mut String, changes: &[Change], indent: &str) {
    const SHOWN: usize = 6;
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for change in changes {
        *counts.entry(&change.code).or_default() += 1;
    }
    let mut seen: BTreeMap<&str, usize> = BTreeMap::new();
    for change in changes {
        let number = seen.entry(&change.code).or_default();
        *number += 1;
        let all = counts[&*change.code];
        if *number <= SHOWN {
            append_entry(text, change, indent);
        }
        if *number == SHOWN && SHOWN < all {
            let more = all - SHOWN;
            let _ =
                writeln!(text, "{indent}… and {more} more of {}: --format json lists them all", change.code);
        }
    }
}

/// Writes one change with its blocks and the calls that led to them.
fn append_entry(text: &mut String, change: &Change, indent: &str) {
    const SHOWN: usize = 6;
    let _ = writeln!(text, "{indent}{:<14} {}", change.code, change.message);
    for Effect { code, message, .. } in change.also.iter().take(SHOWN) {
        let _ = writeln!(text, "{indent}    also {message} [{code}]");
    }
    if SHOWN < change.also.len() {
        let more = change.also.len() - SHOWN;
        let _ = writeln!(text, "{indent}    … and {more} more: --format json has them all");
    }
    for (word, location) in [("old", &change.old), ("new", &change.new)] {
        let Some(location) = location else { continue };
        let _ = writeln!(text, "{indent}    {word} {}", line(location));
        for call in &location.calls {
            let _ = writeln!(text, "{indent}        called from {}", line(call));
        }
    }
}

/// Returns `O8101:12  G1 X#11`.
fn line(location: &BlockLocation) -> String {
    format!("{}:{}  {}", location.program, location.line, location.block)
}

/// Returns a change for a code review, at its location in the new revision; `files` are those of the programs by name.
pub(crate) fn change_found(change: &Change, before: &str, files: &BTreeMap<String, String>) -> Finding {
    let Change { code, message, old, new, anchor: near, also } = change;
    // A deleted block has no line in the new file: the message gives its old line.
    let was = old.as_ref().filter(|_| new.is_none());
    let was = was.map(|location| format!(" (was {}:{} {})", location.program, location.line, location.block));
    let also: String =
        also.iter().map(|effect| format!("\nalso {}: {}", effect.code, effect.message)).collect();
    let calls = new.as_ref().map_or(&[][..], |location| &location.calls);
    Finding {
        code: code.to_string().into(),
        severity: Severity::Error,
        message: format!("{before}{message}{}{also}", was.unwrap_or_default()),
        at: new.as_ref().or(near.as_ref()).and_then(|location| location_in(location, files)),
        related: calls_in(calls, files),
    }
}

/// Returns the calls that led to a block, for a code review.
pub(super) fn calls_in(
    calls: &[BlockLocation],
    files: &BTreeMap<String, String>,
) -> Vec<(FileLocation, String)> {
    let called = |call| Some((location_in(call, files)?, "called from here".to_owned()));
    calls.iter().filter_map(called).collect()
}

/// Returns the line of a block in its file; `None` if the file is unknown.
pub(super) fn location_in(
    location: &BlockLocation,
    files: &BTreeMap<String, String>,
) -> Option<FileLocation> {
    let file = files.get(&location.program)?.clone();
    Some(FileLocation { file, line: Some(location.line), column: None })
}
