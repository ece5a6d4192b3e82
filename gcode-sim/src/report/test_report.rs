//! The results of the cases of `test`, as text and as data.
use std::collections::BTreeMap;
use std::fmt::Write;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::changes::{append_entries, calls_in, change_found, location_in};
use super::figures::count;
use super::sarif::{FileLocation, Finding};
use gcode_lang::alarm::kinds::PS0076;
use gcode_lang::diag::Severity;
use gcode_part::{Assumption, Total};
use gcode_review::{BlockLocation, Change, Totals, alarm_code, kinds};

/// The document of `test --format json`, which `test --merge` reads.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct TestReport {
    /// Basis of the numbers.
    pub(crate) basis: String,
    /// The shard of the cases; `None` for all.
    pub(crate) shard: Option<Shard>,
    /// Tolerance for equality, mm or degrees.
    pub(crate) tolerance: f64,
    /// The cases in the order of their names.
    pub(crate) cases: Vec<CaseReport>,
    /// The names of the cases whose results were accepted now.
    pub(crate) accepted: Vec<String>,
}

/// One of several parts of the cases, which run on separate machines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Shard {
    /// Counts from 1.
    pub(crate) number: usize,
    /// Number of shards.
    pub(crate) of: usize,
    /// Number of cases in all shards.
    pub(crate) cases: usize,
}

/// The result of one case.
#[derive(Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct CaseReport {
    /// Path of the case below the given folder.
    pub(crate) name: String,
    /// The main program's file; without one, a file of the case.
    pub(crate) file: Option<String>,
    pub(crate) answer: CaseAnswer,
    pub(crate) changes: Vec<Change>,
    /// Aspects that an accepted result of an earlier version does not record, so that they are not compared.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) not_compared: Vec<String>,
    /// The first error of the verification against the reference.
    pub(crate) against: Option<FirstFailure>,
    /// The verdict against the reference, and what the case rests on; null if the case is invalid.
    #[serde(default)]
    pub(crate) verdict: Option<CaseVerdict>,
    /// The claims of claims.toml; null without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) claims: Option<ClaimCounts>,
    /// The reason why the case is invalid.
    pub(crate) error: Option<String>,
    pub(crate) totals: Option<Totals>,
    /// The end of the run, in words.
    pub(crate) ending: Option<String>,
    /// The files of the programs that `changes` and `against` name.
    pub(crate) files: BTreeMap<String, String>,
}

/// Numbers of a case's claims.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ClaimCounts {
    /// Claims that are proved now.
    pub(crate) proved: usize,
    /// Claims that are not proved again: claims.lock records their proof for the same programs and conditions.
    pub(crate) kept: usize,
    /// Claims that fail.
    pub(crate) refuted: usize,
    /// Claims of which neither is known.
    pub(crate) undecided: usize,
}

/// Result of comparing a case with its accepted result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum CaseAnswer {
    /// As accepted.
    #[default]
    Same,
    /// Different from the accepted result.
    Changed,
    /// Accepted by an earlier version that recorded less; everything it recorded is unchanged.
    Older,
    /// Nothing is accepted yet.
    New,
    /// The case is invalid.
    Refused,
}

/// Text for [`CaseAnswer::Older`].
pub(super) const OLDER_TEXT: &str =
    "accepted by an earlier version that recorded less; everything it recorded is unchanged";

/// What a case rests on.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct CaseVerdict {
    /// The line of the verdict, as of `verify`; null without a reference.
    pub(crate) summary: Option<String>,
    /// Number of all holes or flutes.
    pub(crate) total: Total,
    /// Values that the run read and nothing in the program set.
    pub(crate) assumptions: Vec<Assumption>,
}

/// The first error of a failed verdict.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct FirstFailure {
    /// The code of the finding.
    pub(crate) code: String,
    pub(crate) message: String,
    /// The block that causes it, if any.
    #[serde(rename = "place")]
    pub(crate) location: Option<BlockLocation>,
}

impl TestReport {
    /// Builds the report with the cases in the order of their names, so that a whole run and its merged shards are
    /// the same document.
    pub(crate) fn new(
        shard: Option<Shard>,
        tolerance: f64,
        mut cases: Vec<CaseReport>,
        mut accepted: Vec<String>,
    ) -> Self {
        cases.sort_by(|a, b| a.name.cmp(&b.name));
        accepted.sort();
        let basis = "predicted by simulation, not measured".to_owned();
        Self { basis, shard, tolerance, cases, accepted }
    }

    /// Formats the cases that are not as accepted, and the numbers of all, for a terminal.
    pub(crate) fn text(&self) -> String {
        let mut text = String::new();
        self.cases.iter().for_each(|case| case.append_text(&mut text));
        for name in &self.accepted {
            let case = self.cases.iter().find(|case| case.name == *name);
            let ending = case.and_then(CaseReport::alarm);
            let ending = ending.map(|words| format!(", which ends with {words}")).unwrap_or_default();
            let _ = writeln!(text, "accepted {name}{ending}");
        }
        let number = |answer| self.cases.iter().filter(|case| case.answer == answer).count();
        let failing = self.cases.iter().filter(|case| case.against.is_some()).count();
        let others = [
            (number(CaseAnswer::Changed), "changed"),
            (number(CaseAnswer::Older), "accepted by an earlier version"),
            (number(CaseAnswer::New), "new"),
            (number(CaseAnswer::Refused), "refused"),
            (failing, "failing verification"),
        ];
        let others = others.iter().filter(|(number, _)| 0 < *number);
        let others: String = others.map(|(number, word)| format!(", {number} {word}")).collect();
        let same = number(CaseAnswer::Same);
        let _ = writeln!(text, "{}: {same} as accepted{others}", count(self.cases.len(), "case"));
        if let Some(line) = self.claims_line() {
            let _ = writeln!(text, "{line}");
        }
        if let Some(Shard { number, of, cases }) = self.shard.filter(|_| self.cases.is_empty()) {
            let _ = writeln!(text, "shard {number}/{of} is empty: {} in total", count(cases, "case"));
        }
        let (lacking, open): (Vec<_>, Vec<_>) = self
            .cases
            .iter()
            .filter(|case| matches!(case.answer, CaseAnswer::Changed | CaseAnswer::Older | CaseAnswer::New))
            // What fails its reference is corrected first.
            .filter(|case| case.against.is_none())
            .partition(|case| case.lacks_program());
        for case in lacking {
            let name = &case.name;
            let _ = writeln!(
                text,
                "--accept skips {name}: a called program is not found; name its folder with --lib, or put \
                 it into lib/ of the case"
            );
        }
        if !open.is_empty() {
            text.push_str("use --accept to accept the current results, with --only NAME those of one case\n");
        }
        text
    }

    /// Returns the line on the claims of all cases; `None` without any.
    fn claims_line(&self) -> Option<String> {
        let mut all = self.cases.iter().filter_map(|case| case.claims);
        let first = all.next()?;
        let sum = all.fold(first, |sum, one| ClaimCounts {
            proved: sum.proved + one.proved,
            kept: sum.kept + one.kept,
            refuted: sum.refuted + one.refuted,
            undecided: sum.undecided + one.undecided,
        });
        let others = [
            (sum.refuted, "refuted"),
            (sum.undecided, "undecided"),
            (sum.kept, "not proved again: claims.lock has their proof for the same programs and conditions"),
        ];
        let others = others.iter().filter(|(number, _)| 0 < *number);
        let others: String = others.map(|(number, words)| format!(", {number} {words}")).collect();
        let number = sum.proved + sum.kept + sum.refuted + sum.undecided;
        Some(format!("{}: {} proved{others}", count(number, "claim"), sum.proved))
    }

    /// Returns the errors of the invalid cases.
    pub(crate) fn refused(&self) -> impl Iterator<Item = String> + '_ {
        let refused = self.cases.iter().filter(|case| case.answer == CaseAnswer::Refused);
        refused.map(|case| format!("case {}: {}", case.name, case.error.as_deref().unwrap_or_default()))
    }

    /// Returns the findings of all cases that are not as accepted or fail verification.
    pub(crate) fn findings(&self) -> Vec<Finding> {
        self.cases.iter().flat_map(CaseReport::findings).collect()
    }
}

impl CaseReport {
    /// Returns true if the case is as accepted and passes verification.
    pub(crate) fn is_good(&self) -> bool {
        self.answer == CaseAnswer::Same && self.against.is_none()
    }

    /// Returns the alarm that ended the run.
    fn alarm(&self) -> Option<&str> {
        self.ending.as_deref().filter(|words| words.starts_with("alarm"))
    }

    /// Returns true if a called program is not found, like [`gcode_review::Record::lacks_program`].
    fn lacks_program(&self) -> bool {
        self.alarm().is_some_and(|words| alarm_code(words) == Some(PS0076.code))
    }

    /// Writes the failures of a case; nothing for a good one.
    pub(super) fn append_text(&self, text: &mut String) {
        let name = &self.name;
        let mut totals = self.totals.as_ref().map_or_else(String::new, |totals| {
            format!("{}, {}", count(totals.holes, "hole"), count(totals.moves, "move"))
        });
        if let Some(alarm) = self.alarm() {
            totals.push_str(&format!("; {alarm}"));
        }
        let _ = match self.answer {
            CaseAnswer::Refused => {
                writeln!(text, "refused  {name}: {}", self.error.as_deref().unwrap_or_default())
            }
            CaseAnswer::New => writeln!(text, "new      {name}: nothing accepted yet ({totals})"),
            CaseAnswer::Changed => writeln!(text, "changed  {name}"),
            CaseAnswer::Older => writeln!(text, "older    {name}: {OLDER_TEXT} ({totals})"),
            CaseAnswer::Same => Ok(()),
        };
        append_entries(text, &self.changes, "    ");
        if !self.not_compared.is_empty() {
            let _ = writeln!(text, "    {}", self.unrecorded_text());
        }
        if let Some(FirstFailure { code, message, .. }) = &self.against {
            let _ = writeln!(text, "fails    {name}: {code}: {message}");
        }
        let verdict = self.verdict.iter().filter(|verdict| verdict.summary.is_some());
        for (verdict, one) in
            verdict.flat_map(|verdict| verdict.assumptions.iter().map(move |one| (verdict, one)))
        {
            let _ = writeln!(text, "assumes  {name}: {}", one.sentence(verdict.total));
        }
    }

    /// Returns the line on aspects that the accepted result does not record.
    pub(super) fn unrecorded_text(&self) -> String {
        format!("not compared (not recorded in the accepted result): {}", self.not_compared.join(", "))
    }

    fn findings(&self) -> Vec<Finding> {
        let whole = || self.file.clone().map(|file| FileLocation { file, line: Some(1), column: None });
        let found = |code: &str, message: String, location: Option<&BlockLocation>| Finding {
            code: code.to_owned().into(),
            severity: Severity::Error,
            message: format!("{}: {message}", self.name),
            at: location.and_then(|location| location_in(location, &self.files)).or_else(whole),
            related: location.map_or_else(Vec::new, |location| calls_in(&location.calls, &self.files)),
        };
        let mut all = Vec::new();
        match self.answer {
            CaseAnswer::Refused => {
                all.push(found(kinds::CASE_REFUSED.code, self.error.clone().unwrap_or_default(), None));
            }
            CaseAnswer::New => all.push(found(kinds::CASE_NEW.code, "nothing accepted yet".to_owned(), None)),
            CaseAnswer::Same | CaseAnswer::Changed | CaseAnswer::Older => {}
        }
        if !self.not_compared.is_empty() {
            all.push(found(kinds::CASE_OLDER.code, self.unrecorded_text(), None));
        }
        let before = format!("{}: ", self.name);
        for change in &self.changes {
            let found = change_found(change, &before, &self.files);
            all.push(Finding { at: found.at.or_else(whole), ..found });
        }
        if let Some(FirstFailure { code, message, location }) = &self.against {
            all.push(found(code, message.clone(), location.as_ref()));
        }
        all
    }
}
