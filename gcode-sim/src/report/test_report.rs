//! What came of the cases of `test`, as text and as data.
use std::collections::BTreeMap;
use std::fmt::Write;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::changes::{append_entries, change_found, counted, place_in};
use super::sarif::{FileLocation, Finding};
use gcode_lang::alarm::kinds::PS0076;
use gcode_lang::diag::Severity;
use gcode_review::{BlockLocation, Change, Totals, alarm_code, kinds};

/// The document of `test --format json`, and what `test --merge` reads.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TestReport {
    /// The kind of the numbers.
    pub basis: String,
    /// The shard of the cases; `None` for all.
    pub shard: Option<Shard>,
    /// Tolerance for equality, mm or degrees.
    pub tolerance: f64,
    pub cases: Vec<CaseReport>,
    /// The names of the cases whose results were accepted now.
    pub accepted: Vec<String>,
}

/// One of several parts of the cases, run on machines side by side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Shard {
    /// Counts from 1.
    pub number: usize,
    pub of: usize,
    /// Number of cases in all shards.
    pub cases: usize,
}

#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CaseReport {
    pub name: String,
    /// The main program's file; without one, a file of the case.
    pub file: Option<String>,
    pub answer: CaseAnswer,
    pub changes: Vec<Change>,
    /// What an accepted result of an earlier version does not record, so that it is not compared.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub not_compared: Vec<String>,
    /// The first error of the verification against the reference.
    pub against: Option<FirstFailure>,
    /// Why the case is invalid.
    pub error: Option<String>,
    pub totals: Option<Totals>,
    /// How the run ended, in words.
    pub ending: Option<String>,
    /// The files of the programs that `changes` and `against` name.
    pub files: BTreeMap<String, String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum CaseAnswer {
    /// As accepted.
    Same,
    Changed,
    /// Accepted by an earlier version that recorded less; everything it recorded is unchanged.
    Older,
    /// Nothing is accepted yet.
    New,
    /// The case is invalid.
    Refused,
}

/// What is said of [`CaseAnswer::Older`].
pub(super) const OLDER_TEXT: &str =
    "accepted by an earlier version that recorded less; everything it recorded is unchanged";

/// The first error of a failed verdict.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FirstFailure {
    /// The code of the finding.
    pub code: String,
    pub message: String,
    /// The block that causes it, if any.
    pub place: Option<BlockLocation>,
}

impl TestReport {
    /// With the cases in the order of their names: a whole run and its merged shards are the same document.
    pub fn new(
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

    /// The same for people: what isn't as accepted, and how many are.
    pub fn text(&self) -> String {
        let mut text = String::new();
        self.cases.iter().for_each(|case| case.append_text(&mut text));
        for name in &self.accepted {
            let case = self.cases.iter().find(|case| case.name == *name);
            let ending = case.and_then(CaseReport::alarm);
            let ending = ending.map(|words| format!(", which ends with {words}")).unwrap_or_default();
            let _ = writeln!(text, "accepted {name}{ending}");
        }
        let count = |answer| self.cases.iter().filter(|case| case.answer == answer).count();
        let mut words = vec![format!("{} as accepted", count(CaseAnswer::Same))];
        let others = [
            (CaseAnswer::Changed, "changed"),
            (CaseAnswer::Older, "accepted by an earlier version"),
            (CaseAnswer::New, "new"),
            (CaseAnswer::Refused, "refused"),
        ];
        for (answer, word) in others.into_iter().filter(|(answer, _)| count(*answer) > 0) {
            words.push(format!("{} {word}", count(answer)));
        }
        let failing = self.cases.iter().filter(|case| case.against.is_some()).count();
        if failing > 0 {
            words.push(format!("{failing} failing verification"));
        }
        let _ = writeln!(text, "{}: {}", counted(self.cases.len() as u64, "case"), words.join(", "));
        if let Some(Shard { number, of, cases }) = self.shard.filter(|_| self.cases.is_empty()) {
            let _ =
                writeln!(text, "shard {number}/{of} is empty: {} in total", counted(cases as u64, "case"));
        }
        let (lacking, open): (Vec<_>, Vec<_>) = self
            .cases
            .iter()
            .filter(|case| matches!(case.answer, CaseAnswer::Changed | CaseAnswer::Older | CaseAnswer::New))
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

    /// What stands in the way of cases that can't be used.
    pub fn refused(&self) -> impl Iterator<Item = String> + '_ {
        let refused = self.cases.iter().filter(|case| case.answer == CaseAnswer::Refused);
        refused.map(|case| format!("case {}: {}", case.name, case.error.as_deref().unwrap_or_default()))
    }

    /// What isn't as accepted or fails its reference, each with its place.
    pub fn findings(&self) -> Vec<Finding> {
        self.cases.iter().flat_map(CaseReport::findings).collect()
    }
}

impl CaseReport {
    /// A case and its answer, and nothing else yet.
    pub fn new(name: String, file: Option<String>, answer: CaseAnswer) -> Self {
        Self {
            name,
            file,
            answer,
            changes: Vec::new(),
            not_compared: Vec::new(),
            against: None,
            error: None,
            totals: None,
            ending: None,
            files: BTreeMap::new(),
        }
    }

    /// As accepted, and not against its reference.
    pub fn is_good(&self) -> bool {
        self.answer == CaseAnswer::Same && self.against.is_none()
    }

    /// The alarm that the run ended with.
    fn alarm(&self) -> Option<&str> {
        self.ending.as_deref().filter(|words| words.starts_with("alarm"))
    }

    /// As [`gcode_review::Record::lacks_program`].
    fn lacks_program(&self) -> bool {
        self.alarm().is_some_and(|words| alarm_code(words) == Some(PS0076.code))
    }

    /// What isn't as it should be; nothing of a good case.
    pub(super) fn append_text(&self, text: &mut String) {
        let name = &self.name;
        let mut totals = self.totals.as_ref().map_or_else(String::new, |totals| {
            format!("{}, {}", counted(totals.holes as u64, "hole"), counted(totals.moves, "move"))
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
    }

    /// What can't be held against a result of an earlier version.
    pub(super) fn unrecorded_text(&self) -> String {
        format!("not compared (not recorded in the accepted result): {}", self.not_compared.join(", "))
    }

    fn findings(&self) -> Vec<Finding> {
        let whole = || self.file.clone().map(|file| FileLocation { file, line: Some(1), column: None });
        let found =
            |code: &str, message: String, at: Option<FileLocation>, calls: &[BlockLocation]| Finding {
                code: code.to_owned().into(),
                severity: Severity::Error,
                message: format!("{}: {message}", self.name),
                at: at.or_else(whole),
                related: calls
                    .iter()
                    .filter_map(|call| Some((place_in(call, &self.files)?, "called from here".to_owned())))
                    .collect(),
            };
        let mut all = Vec::new();
        match self.answer {
            CaseAnswer::Refused => {
                all.push(found(kinds::CASE_REFUSED.code, self.error.clone().unwrap_or_default(), None, &[]));
            }
            CaseAnswer::New => {
                all.push(found(kinds::CASE_NEW.code, "nothing accepted yet".to_owned(), None, &[]))
            }
            CaseAnswer::Same | CaseAnswer::Changed | CaseAnswer::Older => {}
        }
        if !self.not_compared.is_empty() {
            all.push(found(kinds::CASE_OLDER.code, self.unrecorded_text(), None, &[]));
        }
        let before = format!("{}: ", self.name);
        for change in &self.changes {
            let found = change_found(change, &before, &self.files);
            all.push(Finding { at: found.at.or_else(whole), ..found });
        }
        if let Some(FirstFailure { code, message, place }) = &self.against {
            let calls = place.as_ref().map_or(&[][..], |place| &place.calls);
            let at = place.as_ref().and_then(|place| place_in(place, &self.files));
            all.push(found(code, message.clone(), at, calls));
        }
        all
    }
}
