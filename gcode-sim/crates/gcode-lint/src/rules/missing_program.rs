//! Calls of programs that are neither in the file nor in the folders: PS0076, or PS0310 by name.
use crate::calls::CalledAs;
use crate::subject::{CheckContext, ProgramUnit, RuleFinding};

pub(super) const NAME: &str = "missing-program";

pub(super) fn find(subject: &CheckContext<'_>, unit: &ProgramUnit<'_>) -> Vec<RuleFinding> {
    let mut found = Vec::new();
    let mut told: Vec<&CalledAs> = Vec::new();
    for call in unit.calls.iter().filter(|call| unit.reached[call.block]) {
        // Each program once: what is missing is one thing, however often it is called.
        if subject.called(call).is_some() || call.target != CalledAs::Nothing && told.contains(&&call.target)
        {
            continue;
        }
        told.push(&call.target);
        let label = call.target.label();
        let finding = match call.target {
            CalledAs::Computed => continue,
            // M98 Q alone starts in this program.
            CalledAs::Nothing if call.start.is_some() => continue,
            CalledAs::Nothing => unit
                .error(NAME, call.block, "PS0076: a call without a program number")
                .help("write the program number after P"),
            CalledAs::Number(_) => unit
                .error(NAME, call.block, format!("PS0076: program {label} is not found"))
                .help("give the folder that holds it with --lib"),
            CalledAs::Name(_) => unit
                .error(NAME, call.block, format!("PS0310: program {label} is not found"))
                .help("give the folder that holds it with --lib, or put it into the same file"),
        };
        found.push(finding.on(call.span));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::testing::lines;
    use super::NAME;

    #[test]
    fn called_programs_must_be_there() {
        let text =
            "O1\nM98 P30002\nG65 P3 A1.\nM98 P2 L2\n#1=2\nG65 P#1\nG65 A1.\nG65 P3 A2.\nM30\nO2\nM99\n";
        assert_eq!(lines(NAME, text), [3, 7]);
    }
}
