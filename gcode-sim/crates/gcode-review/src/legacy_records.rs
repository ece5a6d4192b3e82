//! Accepted results of earlier versions, which recorded less of a run: what they lack is named and not compared.
use std::collections::BTreeMap;

use super::block_list::BlockList;
use super::kinds;
use super::modal_conditions::{ModalAspect, ModalSetting};
use super::record::Record;
use super::steps::{StepKind, UNSIMULATED, UnsimulatedKind};

/// Former and later messages of alarms, one row per line, the oldest first; `{}` is a value.
const ALARMS: &str = include_str!("former_alarms.tsv");

/// Former and present message of `#3000` without a text.
const NO_TEXT: &str =
    "the program stops itself and does not say why\tthe program raises an alarm without a text";

/// Beginning of the name of an additional work coordinate system on a Haas.
const HAAS_SYSTEM: &str = "G154 P";

/// Beginning of the same name in records of earlier versions, that of a Fanuc.
const FORMER_SYSTEM: &str = "G54.1 P";

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

/// G codes that earlier versions did not record.
const LATE_CODES: [&str; 7] = ["G12", "G13", "G45", "G46", "G47", "G48", "G53"];

impl Record {
    /// Returns true for a record of an earlier version, which lacks the first commands.
    pub fn is_legacy(&self) -> bool {
        self.first_commands.is_none()
    }

    /// Names what a record of an earlier version lacks and `current` may have; a record may lack it because its run
    /// had none of it.
    pub fn unrecorded_aspects(&self, current: &Self) -> Vec<String> {
        let mut all = Vec::new();
        if self.is_legacy() {
            all.extend(self.unrecorded_legacy_aspects().into_iter().map(str::to_owned));
        }
        all.extend(self.unrecorded_modes(current).map(|mode| format!("{mode} at the end")));
        all
    }

    /// Returns the names of the modes in the final state of `current` that this record lacks.
    fn unrecorded_modes<'r>(&'r self, current: &'r Self) -> impl Iterator<Item = &'r String> {
        let modes = current.ending.residual.iter().filter(|(_, entry)| entry.code == kinds::MODE.code);
        modes.map(|(name, _)| name).filter(|name| !self.ending.residual.contains_key(*name))
    }

    fn unrecorded_legacy_aspects(&self) -> Vec<&'static str> {
        let mut all = vec!["the state required at the program's start"];
        all.extend(self.program.is_none().then_some("its O number"));
        let conditions = ModalAspect::ALL.into_iter().filter(|what| self.lacks_condition(*what));
        all.extend(conditions.map(|what| what.row().2));
        all.extend(UNSIMULATED.iter().filter(|(what, ..)| self.lacks_unsimulated(*what)).map(|row| row.3));
        let is_unclear = self.steps.all_kinds().any(|kind| matches!(kind, StepKind::Coolant(true, None)));
        all.extend(is_unclear.then_some("mist or coolant"));
        all.extend(self.lacks_again().then_some("repeated holes"));
        all
    }

    /// Returns the record as the earlier version of `accepted` would have recorded it.
    #[must_use]
    pub fn reduced_to(&self, accepted: &Self) -> Self {
        let mut record = self.clone();
        if accepted.has_systems_named(FORMER_SYSTEM) && !accepted.has_systems_named(HAAS_SYSTEM) {
            record.rename_haas_systems();
        }
        if accepted.lacks_other_blocks() {
            record.leave_out(|kind| {
                let StepKind::Silent(UnsimulatedKind::GCode, text) = kind else { return false };
                LATE_CODES.iter().any(|code| text.split(' ').next() == Some(code))
            });
        }
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

    /// Returns true if an additional work coordinate system has a name with this beginning.
    fn has_systems_named(&self, beginning: &str) -> bool {
        let systems = self.conditions.iter().map(|condition| &condition.word(ModalAspect::System).text);
        systems.chain(self.ending.residual.keys()).any(|name| name.starts_with(beginning))
    }

    /// Gives the additional work coordinate systems of a Haas their names in records of earlier versions.
    fn rename_haas_systems(&mut self) {
        for condition in &mut self.conditions {
            let mut setting = condition.word(ModalAspect::System).clone();
            setting.text = setting.text.replace(HAAS_SYSTEM, FORMER_SYSTEM);
            condition.set(ModalAspect::System, setting);
        }
        let residual = std::mem::take(&mut self.ending.residual).into_iter();
        self.ending.residual =
            residual.map(|(name, entry)| (name.replace(HAAS_SYSTEM, FORMER_SYSTEM), entry)).collect();
    }

    /// Returns true for a file without the blocks that no step names.
    pub(super) fn lacks_other_blocks(&self) -> bool {
        self.other_blocks.is_none() && matches!(self.blocks, BlockList::Listed(_))
    }

    fn lacks_condition(&self, what: ModalAspect) -> bool {
        self.conditions.iter().all(|condition| condition.word(what).text.is_empty())
    }

    fn lacks_unsimulated(&self, what: UnsimulatedKind) -> bool {
        !self.steps.all_kinds().any(|kind| matches!(kind, StepKind::Silent(one, _) if *one == what))
    }

    fn lacks_again(&self) -> bool {
        self.holes.iter().enumerate().all(|(number, hole)| hole.first_on_line == number)
    }

    /// Removes steps and renumbers those of the holes.
    fn leave_out(&mut self, is_out: impl Fn(&StepKind) -> bool) {
        let stays: Vec<bool> = self.steps.kinds().map(|kind| !is_out(kind)).collect();
        let kept = (0..stays.len()).filter(|step| stays[*step]);
        let now: BTreeMap<usize, usize> = kept.enumerate().map(|(now, before)| (before, now)).collect();
        self.steps = self.steps.filtered(|_, kind| !is_out(kind));
        for feeds in &mut self.feeds {
            *feeds = feeds.iter().filter_map(|step| now.get(step).copied()).collect();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Record, present_words};
    use crate::changes;

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

    /// A record without steps whose final state has some modes.
    fn record_with(modes: &str) -> Record {
        let text = format!(
            r#"{{"version": 1, "axes": "XYZ", "totals": {{"holes": 0, "moves": 0, "blocks": 1, "seconds": 0.0}},
            "ending": {{"outcome": "end", "words": "the program ends", "stopped": null, "output": [],
            "left": {{{modes}}}}}, "places": [], "other_blocks": [], "begun": [], "steps": [], "holes": []}}"#
        );
        Record::from_json(&text).unwrap()
    }

    #[test]
    fn a_work_offset_of_a_haas_keeps_its_former_name_in_a_comparison() {
        let offset =
            |name: &str| record_with(&format!(r#""{name} X": {{"code": "work-offset", "value": 5.0}}"#));
        let (accepted, current) = (offset("G54.1 P9"), offset("G154 P9"));
        assert!(changes(&accepted, &current.reduced_to(&accepted), 1e-4).is_empty());
        assert!(!changes(&current, &accepted.reduced_to(&current), 1e-4).is_empty());
    }

    #[test]
    fn a_modal_group_that_a_record_lacks_is_named_and_not_compared() {
        let motion = r#""the mode of group 01": {"code": "mode", "value": 1.0}"#;
        let plane = r#""the mode of group 02": {"code": "mode", "value": 17.0}"#;
        let (accepted, current) = (record_with(motion), record_with(&format!("{motion}, {plane}")));
        assert_eq!(accepted.unrecorded_aspects(&current), ["the mode of group 02 at the end"]);
        assert!(current.unrecorded_aspects(&accepted).is_empty());
        assert!(changes(&accepted, &current, 1e-4).is_empty());
    }
}
