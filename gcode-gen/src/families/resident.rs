//! Resident macros: programs that stay in the control and serve all jobs by their arguments.
use gcode_part::job::JobControl;

use super::control::alarm_thousands;
use super::start::{changed_condition, external_offset_term, shift_threshold};
use crate::nc::{name, number};
use crate::package::Program;

/// A resident macro as in its `.nc` file: text with marks in braces for what depends on machine and control.
/// Everything else is an argument.
#[derive(Debug)]
pub struct Macro {
    /// Its O-number.
    pub number: u32,
    /// File name in `macros/`, where its marks are filled in as for the family's new job.
    pub file: &'static str,
    pub(super) text: &'static str,
}

impl Macro {
    /// Fills in the marks: those of the control, and the family's `marks`.
    pub(super) fn program(&self, control: JobControl, marks: &[(&str, String)]) -> Program {
        let JobControl { dialect, increment } = control;
        let of_control = [
            ("{name}", name(self.number, dialect)),
            ("{k}", alarm_thousands(dialect).to_owned()),
            ("{changed}", changed_condition(dialect).to_owned()),
            ("{increment}", number(increment.size())),
            // A value is rounded to its increment: within half of one it is the same.
            ("{half}", number(increment.size() / 2.0)),
            ("{per_unit}", number(increment.per_unit())),
            ("{rounding}", number(shift_threshold(increment))),
            // The external offset of the axis with number 1 + #12.
            ("{external}", external_offset_term(dialect, "[5201+#12]")),
        ];
        let all = of_control.iter().chain(marks);
        let text = all.fold(self.text.to_owned(), |text, (mark, value)| text.replace(mark, value));
        Program { number: self.number, text }
    }
}

#[cfg(test)]
mod tests {
    use gcode_lang::control::{Dialect, Increment};
    use gcode_part::job::Job;

    use super::*;
    use crate::families::{ALL, emit};
    use crate::nc::REMARK;

    /// Fails if a mark is left, if a control cannot show a character, if a remark is longer than those of main
    /// programs, or if a message is longer than the 26 characters of an old control.
    fn assert_displayable(text: &str) {
        assert!(!text.contains(['{', '}']), "a mark is left:\n{text}");
        let shown = |b: u8| b == b'\n' || (b.is_ascii_graphic() || b == b' ') && !b.is_ascii_lowercase();
        assert!(text.bytes().all(shown), "a character no control shows:\n{text}");
        for line in text.lines() {
            let remark = line.strip_prefix('(').map(|rest| rest.trim_end_matches(')'));
            let is_short = remark.is_none_or(|remark| remark.len() <= REMARK);
            assert!(is_short, "{line} has {} characters", line.len() - 2);
            for stop in ["#3000=", "#3006="] {
                let Some((_, rest)) = line.split_once(stop) else { continue };
                let message = rest.split_once('(').expect(line).1.trim_end_matches(')');
                assert!(message.len() <= 26, "{message} has {} characters", message.len());
            }
        }
    }

    fn with_control(mut job: Job, control: JobControl) -> Job {
        *match &mut job {
            Job::PinHoles(job) => &mut job.control,
            Job::Honeycomb(job) => &mut job.control,
            Job::Burr(job) => &mut job.control,
            Job::Alignment(job) => &mut job.control,
            Job::Pattern(job) => &mut job.control,
        } = control;
        job
    }

    /// Changes of the new jobs that change the text of a macro.
    const CHANGES: [[&str; 3]; 12] = [
        ["pin-holes", "", ""],
        ["pin-holes", "kind = \"manual\"", "kind = \"axis\"\nletter = \"A\""],
        ["honeycomb", "", ""],
        ["honeycomb", "# clamp =", "clamp ="],
        ["burr", "", ""],
        ["burr", "X = 1, Y = 1, A = 1, B = 1, C = 1", "X = 1, Y = -1, A = 1, B = -1, C = 1"],
        ["burr", "X = 1, Y = 1, A = 1, B = 1, C = 1", "X = -1, Y = 1, A = -1, B = 1, C = -1"],
        ["alignment", "", ""],
        ["alignment", "letter = \"B\"", "letter = \"A\""],
        ["alignment", "letter = \"B\"", "letter = \"C\""],
        ["pattern", "", ""],
        ["pattern", "dialect = \"fanuc-31i\"", "dialect = \"haas-ngc\""],
    ];

    #[test]
    fn every_control_can_show_every_program() {
        for [name, from, to] in CHANGES {
            let family = ALL.iter().find(|family| family.name == name).unwrap();
            assert!(family.new_job.contains(from), "{name}: {from}");
            let job = Job::parse(&family.new_job.replacen(from, to, 1)).unwrap();
            for (_, dialect) in Dialect::ALL {
                for (_, increment) in Increment::ALL {
                    let package = emit(&with_control(job.clone(), JobControl { dialect, increment }));
                    let macros = family.macros.iter().flat_map(|of_main| *of_main);
                    macros.for_each(|one| assert!(package.program(one.number).is_some(), "{}", one.file));
                    package.programs.iter().for_each(|program| assert_displayable(&program.text));
                }
            }
        }
    }

    #[test]
    fn the_rotary_is_released_before_it_turns_and_clamped_before_the_drill_comes() {
        let family = ALL.iter().find(|family| family.name == "honeycomb").unwrap();
        let job = family.new_job.replacen("# clamp =", "clamp =", 1).replacen("\"B\"", "\"A\"", 1);
        let package = emit(&Job::parse(&job).unwrap());
        let text = &package.program(family.macros[0][0].number).unwrap().text;
        assert!(text.contains("DO1\nM11\nA[#21*#18*#15]\nM10\n#20="), "{text}");
    }

    #[test]
    fn marks_are_filled_wherever_they_stand() {
        let control = JobControl { dialect: Dialect::HaasNgc, increment: Increment::default() };
        let text = Macro { number: 9, file: "", text: "{name}{a}{b}-{a} {k}016" };
        let marks = [("{a}", "1.".to_owned()), ("{b}", String::new())];
        assert_eq!(text.program(control, &marks).text, "O000091.-1. 1016");
        assert_displayable("#3000=1(26 CHARACTERS ARE NOT MORE)\n#3006=1(SO)\n");
    }

    #[test]
    #[should_panic(expected = "has 27 characters")]
    fn a_long_message_fails() {
        assert_displayable("IF[#1 EQ #0]THEN #3000=1(27 CHARACTERS ARE TOO MANY!)\n");
    }
}
