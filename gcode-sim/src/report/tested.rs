//! What came of the cases of `test`, as text and as data.
use std::fmt::Write;

use serde::Serialize;

use super::changes::{counted, entries};
use crate::changes::{Change, Totals};

/// The document of `test --format json`.
#[derive(Debug, Serialize)]
pub struct TestReport {
    /// Says what kind of numbers these are.
    pub basis: &'static str,
    pub cases: Vec<CaseReport>,
    /// The names of the cases whose results were accepted now.
    pub accepted: Vec<String>,
}

#[derive(Debug, Serialize)]
pub struct CaseReport {
    pub name: String,
    /// `same`, `changed`, `new` where nothing is accepted yet, `refused` where the case can't be used.
    pub answer: &'static str,
    pub changes: Vec<Change>,
    /// What the reference says against the holes.
    pub against: Option<String>,
    pub error: Option<String>,
    pub totals: Option<Totals>,
    /// How the run ended, in words.
    pub ending: Option<String>,
}

impl TestReport {
    pub fn new(cases: impl Iterator<Item = CaseReport>, accepted: Vec<String>) -> Self {
        Self { basis: "predicted by simulation, not measured", cases: cases.collect(), accepted }
    }

    /// The same for people: what isn't as accepted, and how many are.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for case in &self.cases {
            let totals = case
                .totals
                .as_ref()
                .map(|t| format!("{}, {}", counted(t.holes as u64, "hole"), counted(t.moves, "move")));
            let mut totals = totals.unwrap_or_default();
            if let Some(ending) = case.ending.as_ref().filter(|words| words.starts_with("alarm")) {
                totals.push_str(&format!("; {ending}"));
            }
            let _ = match (case.answer, &case.error) {
                (_, Some(error)) => writeln!(text, "refused  {}: {error}", case.name),
                ("new", _) => writeln!(text, "new      {}: nothing accepted yet ({totals})", case.name),
                ("changed", _) => writeln!(text, "changed  {}", case.name),
                _ => Ok(()),
            };
            entries(&mut text, &case.changes, "    ");
            if let Some(against) = &case.against {
                let _ = writeln!(text, "fails    {}: {against}", case.name);
            }
        }
        for name in &self.accepted {
            let case = self.cases.iter().find(|case| case.name == *name);
            let ending =
                case.and_then(|case| case.ending.as_deref()).filter(|words| words.starts_with("alarm"));
            let ending = ending.map(|words| format!(", which ends with {words}")).unwrap_or_default();
            let _ = writeln!(text, "accepted {name}{ending}");
        }
        let count = |answer| self.cases.iter().filter(|case| case.answer == answer).count();
        let mut words = vec![format!("{} as accepted", count("same"))];
        for answer in ["changed", "new", "refused"] {
            if count(answer) > 0 {
                words.push(format!("{} {answer}", count(answer)));
            }
        }
        let failing = self.cases.iter().filter(|case| case.against.is_some()).count();
        if failing > 0 {
            words.push(format!("{failing} against its reference"));
        }
        let _ = writeln!(text, "{}: {}", counted(self.cases.len() as u64, "case"), words.join(", "));
        if count("changed") + count("new") > 0 {
            text.push_str("--accept takes what is new; --only NAME takes one\n");
        }
        text
    }
}
