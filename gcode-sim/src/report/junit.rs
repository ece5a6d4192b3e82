//! The cases of `test` as JUnit XML for build servers.
use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

use super::test_report::{CaseAnswer, CaseReport, OLDER_TEXT, TestReport};
use gcode_review::kinds;

/// Returns the document of `test --format junit`: one suite with a test for each case.
///
/// # Errors
/// The message of the XML writer.
pub(crate) fn document(report: &TestReport) -> Result<String, String> {
    let mut suite = TestSuite::new("programs");
    suite.add_test_cases(report.cases.iter().map(case));
    let mut all = Report::new("gcode-sim test");
    all.add_test_suite(suite);
    all.to_string().map_err(|error| error.to_string())
}

fn case(case: &CaseReport) -> TestCase {
    // A failure has the terminal's text in full, and a short message for lists.
    let mut text = String::new();
    case.append_text(&mut text);
    let (code, message) = match (case.answer, &case.against, case.changes.first()) {
        (CaseAnswer::Refused, ..) => (kinds::CASE_REFUSED.code, case.error.clone().unwrap_or_default()),
        (CaseAnswer::Changed, _, Some(first)) => {
            let more = case.changes.len() - 1;
            let and = if more == 0 { String::new() } else { format!("; and {more} more") };
            (&*first.code, format!("{}: {}{and}", first.code, first.message))
        }
        (_, Some(against), _) => (&*against.code, format!("{}: {}", against.code, against.message)),
        (CaseAnswer::Older, ..) => {
            (kinds::CASE_OLDER.code, format!("{OLDER_TEXT}; {}", case.unrecorded_text()))
        }
        (CaseAnswer::New, ..) => (kinds::CASE_NEW.code, "nothing accepted yet".to_owned()),
        (CaseAnswer::Same | CaseAnswer::Changed, None, _) => {
            return named(case, TestCaseStatus::success());
        }
    };
    let kind =
        if case.answer == CaseAnswer::Refused { NonSuccessKind::Error } else { NonSuccessKind::Failure };
    let mut status = TestCaseStatus::non_success(kind);
    status.set_type(code).set_message(message).set_description(text);
    named(case, status)
}

fn named(case: &CaseReport, status: TestCaseStatus) -> TestCase {
    let mut test = TestCase::new(case.name.as_str(), status);
    test.set_classname("programs");
    if let Some(file) = &case.file {
        test.extra.insert("file".into(), file.as_str().into());
    }
    test
}
