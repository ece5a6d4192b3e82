//! Remedies for the alarms of the measurements, from `alarms.txt`, for the set-up sheet.
use std::sync::LazyLock;

/// An alarm that a macro or main program raises because of the machine, the part or the operation.
pub(crate) struct MacroAlarm {
    /// n of `#3000=n`.
    pub(crate) number: u32,
    /// Text as the control shows it.
    pub(crate) text: &'static str,
    /// Remedy at the machine.
    pub(crate) remedy: String,
}

/// The alarms in the order of the work.
pub(crate) static ALARMS: LazyLock<Vec<MacroAlarm>> = LazyLock::new(|| {
    let mut alarms: Vec<MacroAlarm> = Vec::new();
    // The first paragraph describes the file.
    for paragraph in include_str!("alarms.txt").split("\n\n").skip(1) {
        let mut lines = paragraph.lines();
        let head = lines.next().and_then(|head| head.split_once(' '));
        let Some((number, text)) = head.and_then(|(number, text)| Some((number.parse().ok()?, text))) else {
            continue;
        };
        let mut remedy = lines.map(str::trim).collect::<Vec<_>>().join(" ");
        if let Some(other) = remedy.strip_prefix("= ") {
            let same = alarms.iter().find(|alarm| alarm.number.to_string() == other);
            remedy = same.map_or_else(String::new, |alarm| alarm.remedy.clone());
        }
        alarms.push(MacroAlarm { number, text, remedy });
    }
    alarms
});

#[cfg(test)]
mod tests {
    use super::super::emit;
    use super::*;
    use gcode_part::job::{Alignment, Job};

    fn job() -> Alignment {
        match Job::parse(super::super::FAMILY.new_job) {
            Ok(Job::Alignment(job)) => job,
            other => panic!("{other:?}"),
        }
    }

    /// Returns number and text of every `#3000=` in a text.
    fn raised(text: &str) -> impl Iterator<Item = (u32, &str)> {
        text.split("#3000=").skip(1).map(|rest| {
            let (number, rest) = rest.split_once('(').unwrap();
            (number.parse().unwrap(), rest.split_once(')').unwrap().0)
        })
    }

    #[test]
    fn the_alarms_are_those_of_the_programs_except_of_arguments() {
        let package = emit(&job());
        let mut unknown = Vec::new();
        for program in &package.programs {
            // Macros check their arguments last.
            let own = program.text.split("(REFUSED,").next().unwrap();
            let known = |(number, text): &(u32, &str)| {
                ALARMS.iter().any(|alarm| alarm.number == *number && alarm.text == *text)
            };
            unknown.extend(
                raised(own).filter(|raised| !known(raised)).map(|(number, text)| format!("{number} {text}")),
            );
        }
        assert!(unknown.is_empty(), "{unknown:?}");
        assert_eq!(ALARMS.len(), include_str!("alarms.txt").split("\n\n").count() - 1);
        for alarm in ALARMS.iter() {
            assert!(!alarm.remedy.is_empty(), "{} has no remedy", alarm.number);
            let there = package
                .programs
                .iter()
                .any(|program| raised(&program.text).any(|raised| raised == (alarm.number, alarm.text)));
            assert!(there, "nothing raises {} {}", alarm.number, alarm.text);
        }
    }
}
