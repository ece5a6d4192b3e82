//! Text behind the last `%` of a file, which no control reads: findings there are left out.
use gcode_lang::program::{Memory, Program};
use gcode_lang::source::Span;
use gcode_lang::syntax::ast::ProgramName;

use crate::CheckResult;

/// Removes the findings in text behind the last `%`, and its part of the number of programs.
pub(crate) fn leave_out(result: &mut CheckResult) {
    let behind: Vec<Span> = behind_end(&result.memory).map(|program| program.span).collect();
    if behind.is_empty() {
        return;
    }
    result.programs = result.programs.saturating_sub(behind.len());
    result.findings.retain(|finding| {
        let place = finding.backtrace.as_ref().map(|backtrace| backtrace.block).or(finding.span);
        let is_behind =
            |from: &Span| place.is_some_and(|place| place.source == from.source && from.start <= place.start);
        !behind.iter().any(is_behind)
    });
}

/// Iterates over the programs behind the last `%` of their file: without an O word and never closed, after other programs.
fn behind_end(memory: &Memory) -> impl Iterator<Item = &Program> {
    let follows = |one: &Program, last: &Program| {
        one.span.source == last.span.source && one.span.start < last.span.start
    };
    memory.programs().iter().filter(move |last| {
        last.name == ProgramName::Unnamed
            && !last.is_closed
            && memory.programs().iter().any(|one| follows(one, last))
    })
}

#[cfg(test)]
mod tests {
    use gcode_lang::control::Settings;
    use gcode_lang::program::NoLibrary;

    fn checked(text: &str) -> (usize, Vec<String>) {
        let result = crate::check("O1.nc", text.as_bytes(), &Settings::default(), &mut NoLibrary);
        (result.programs, result.findings.iter().map(|finding| finding.code().into_owned()).collect())
    }

    #[test]
    fn text_behind_the_last_percent_sign_has_no_findings() {
        let tail = "G0 Y0.\nG01 Y15 F100\nGOTO 7\n";
        assert_eq!(checked(&format!("%\nO1\nG0 X0.\nM30\n%\n{tail}")), (1, Vec::new()));
        // Closed, with an O word, or after a leader alone it is a program.
        for text in [format!("%\nO1\nM30\n%\n{tail}%\n"), format!("%\nO1\nM30\n%\nO2\n{tail}")] {
            let (programs, found) = checked(&text);
            assert_eq!(programs, 2, "{text}");
            assert!(found.contains(&"missing-n".to_owned()), "{text}: {found:?}");
        }
        let (programs, found) = checked(&format!("%\n{tail}"));
        assert!(programs == 1 && found.contains(&"missing-n".to_owned()), "{found:?}");
    }
}
