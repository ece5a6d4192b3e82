//! Accepted results of earlier versions, which recorded less of a run: what they lack is named and not compared.
use std::collections::BTreeMap;

use super::modal_conditions::{ModalAspect, ModalSetting};
use super::record::Record;
use super::steps::{StepKind, UNSIMULATED, UnsimulatedKind};

/// Former and later messages of alarms, one row per line, the oldest first; `{}` is a value.
const ALARMS: &str = include_str!("former_alarms.tsv");

/// Former and present message of `#3000` without a text.
const NO_TEXT: &str =
    "the program stops itself and does not say why\tthe program raises an alarm without a text";

/// Returns the words of an accepted end with the present message of its alarm. A text of `#3000` stays.
pub(super) fn present_words(words: &str) -> String {
    let present = || {
        let (code, message) = words.strip_prefix("alarm ")?.split_once(' ')?;
        let table = if code.starts_with("MC") { NO_TEXT } else { ALARMS };
        let rows = table.lines().filter_map(|row| row.split_once('\t'));
        // A later row may reword the message of an earlier one.
        let message = rows
            .fold(message.to_owned(), |message, (was, is)| reworded(&message, was, is).unwrap_or(message));
        Some(format!("alarm {code} {message}"))
    };
    present().unwrap_or_else(|| words.to_owned())
}

/// Returns a message of the form `was` in the form `is`, with the same values.
fn reworded(message: &str, was: &str, is: &str) -> Option<String> {
    let (first, rest) = was.split_once("{}").unwrap_or((was, ""));
    let mut left = message.strip_prefix(first)?;
    if !was.contains("{}") {
        return left.is_empty().then(|| is.to_owned());
    }
    let mut text = is.to_owned();
    let mut parts = rest.split("{}").peekable();
    while let Some(part) = parts.next() {
        let end = if parts.peek().is_none() { left.strip_suffix(part)?.len() } else { left.find(part)? };
        text = text.replacen("{}", &left[..end], 1);
        left = &left[end + part.len()..];
    }
    left.is_empty().then_some(text)
}

impl Record {
    /// Returns true for a record of an earlier version, which lacks the first commands.
    pub fn is_legacy(&self) -> bool {
        self.first_commands.is_none()
    }

    /// Names what a record of an earlier version lacks; it may lack it because the run had none of it.
    pub fn unrecorded_aspects(&self) -> Vec<&'static str> {
        if !self.is_legacy() {
            return Vec::new();
        }
        let mut all = vec!["the state required at the program's start"];
        all.extend(self.program.is_none().then_some("its O number"));
        let conditions = ModalAspect::ALL.into_iter().filter(|what| self.lacks_condition(*what));
        all.extend(conditions.map(|what| what.row().2));
        all.extend(UNSIMULATED.iter().filter(|(what, ..)| self.lacks_unsimulated(*what)).map(|row| row.3));
        let is_unclear = self.steps.iter().any(|step| matches!(step.kind, StepKind::Coolant(true, None)));
        all.extend(is_unclear.then_some("mist or coolant"));
        all.extend(self.lacks_again().then_some("repeated holes"));
        all
    }

    /// Returns the record as the earlier version of `accepted` would have recorded it.
    #[must_use]
    pub fn reduced_to(&self, accepted: &Self) -> Self {
        let mut record = self.clone();
        if !accepted.is_legacy() {
            return record;
        }
        record.first_commands = None;
        if accepted.program.is_none() {
            record.program = None;
        }
        for condition in &mut record.conditions {
            for what in ModalAspect::ALL.into_iter().filter(|what| accepted.lacks_condition(*what)) {
                condition.set(what, ModalSetting::default());
            }
        }
        if accepted.lacks_again() {
            record.holes.iter_mut().enumerate().for_each(|(number, hole)| hole.first_on_line = number);
        }
        record
            .leave_out(|kind| matches!(kind, StepKind::Silent(what, _) if accepted.lacks_unsimulated(*what)));
        record
    }

    fn lacks_condition(&self, what: ModalAspect) -> bool {
        self.conditions.iter().all(|condition| condition.word(what).text.is_empty())
    }

    fn lacks_unsimulated(&self, what: UnsimulatedKind) -> bool {
        !self.steps.iter().any(|step| matches!(&step.kind, StepKind::Silent(one, _) if *one == what))
    }

    fn lacks_again(&self) -> bool {
        self.holes.iter().enumerate().all(|(number, hole)| hole.first_on_line == number)
    }

    /// Removes steps and renumbers those of the holes.
    fn leave_out(&mut self, is_out: impl Fn(&StepKind) -> bool) {
        let stays: Vec<bool> = self.steps.iter().map(|step| !is_out(&step.kind)).collect();
        let kept = (0..stays.len()).filter(|step| stays[*step]);
        let now: BTreeMap<usize, usize> = kept.enumerate().map(|(now, before)| (before, now)).collect();
        self.steps.retain(|step| !is_out(&step.kind));
        for feeds in &mut self.feeds {
            *feeds = feeds.iter().filter_map(|step| now.get(step).copied()).collect();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::present_words;

    #[test]
    fn an_alarm_with_a_former_message_has_its_present_one() {
        for (was, is) in [
            (
                "alarm PS1196 the drilling axis can't be told",
                "alarm PS1196 the drilling axis is ambiguous or changes without G80",
            ),
            (
                "alarm PS1196 the drilling axis is ambiguous",
                "alarm PS1196 the drilling axis is ambiguous or changes without G80",
            ),
            ("alarm PS0119 SQRT can't take -4", "alarm PS0119 SQRT: -4 is out of range"),
            ("alarm PS0119 SQRT is not defined for -4", "alarm PS0119 SQRT: -4 is out of range"),
            ("alarm PS0010 no G code 5.5 on this control", "alarm PS0010 the control has no G05.5"),
            ("alarm PS0010 the control has no G12", "alarm PS0010 the control has no G12"),
            (
                "alarm PS0020 the arc starts 5.0000 mm from its centre and ends 4.9000 mm from it (0.05 allowed)",
                "alarm PS0020 the radius of the arc is 5.0000 mm at its start and 4.9000 mm at its end (tolerance 0.05 mm)",
            ),
            (
                "alarm MC3001 the program stops itself and does not say why",
                "alarm MC3001 the program raises an alarm without a text",
            ),
            (
                "alarm PS0007 M05 behind M03 in one block: only the last M code counts",
                "alarm PS0007 M05 after M03 in one block: only the last M code counts",
            ),
        ] {
            assert_eq!(present_words(was), is);
            assert_eq!(present_words(is), is);
        }
        for same in ["the program ends by M02", "alarm MC3001 no axis 3", "alarm PS0112 division by zero"] {
            assert_eq!(present_words(same), same);
        }
    }
}
