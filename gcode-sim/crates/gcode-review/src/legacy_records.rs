//! Records that were written when less was noted of a run: what they don't say is named and not compared, so that it is
//! neither taken for a change nor for what was accepted.
use std::collections::BTreeMap;

use super::modal_conditions::{ModalAspect, ModalConditions, ModalSetting};
use super::record::Record;
use super::steps::{StepKind, UnsimulatedKind};

/// What moves nothing, as people call it.
const QUIET: [(UnsimulatedKind, &str); 8] = [
    (UnsimulatedKind::Skip, "block skips"),
    (UnsimulatedKind::Path, "exact stops and look-ahead of single blocks"),
    (UnsimulatedKind::GCode, "G codes without effect here"),
    (UnsimulatedKind::MCode, "M codes without effect here"),
    (UnsimulatedKind::Tool, "T without M06"),
    (UnsimulatedKind::Speed, "S without M03 or M04"),
    (UnsimulatedKind::Switch, "#3003 and #3004"),
    (UnsimulatedKind::Signal, "output signals"),
];

/// Wordings of alarms that were recorded before and what the same alarm says now; `{}` is a value.
const ALARMS: [(&str, &str); 43] = [
    ("a word of a statement is cut short", "a statement keyword is abbreviated"),
    (
        "behind ';' stands what could be a block or a remark",
        "text after ';' is ambiguous: a block or a comment",
    ),
    ("address {} can't be used here", "address {} is not allowed here"),
    ("no G code {} on this control", "the control has no G{}"),
    (
        "R is {} mm, and half the distance from the start to the end is {} mm: no such arc",
        "R is {} mm, less than half the distance from start to end, {} mm",
    ),
    (
        "the arc starts {} mm from its centre and ends {} mm from it ({} allowed)",
        "the arc starts {} mm from its centre and ends {} mm from it (tolerance {})",
    ),
    (
        "the paths of the tool's centre don't meet inside the corner",
        "the tool centre paths do not intersect inside the corner",
    ),
    (
        "the tool is too large for the contour: its centre would run against the programmed path",
        "the tool is too large for the contour: its centre would move against the programmed path",
    ),
    (
        "behind ,R or ,C no move follows that makes a corner in the plane",
        "no move follows ,R or ,C that forms a corner in the plane",
    ),
    ("the move behind ,R or ,C is no G01, G02 or G03", "the move after ,R or ,C is not G01, G02 or G03"),
    ("behind a comma stand R or C, one in a block", "only R or C is allowed after a comma, once in a block"),
    (
        "the corner takes more than there is of the moves that make it",
        "the corner is larger than the moves that form it",
    ),
    ("a program's number is 1 to 99999999", "a program number is 1 to 99999999"),
    ("more than {} calls inside one another", "more than {} nested calls"),
    ("no block N{} to return to", "sequence number N{}, the return target, is not found"),
    ("the expression can't be read at '{}'", "the expression is not valid at '{}'"),
    ("no variable #{} on this control", "the control has no variable #{}"),
    ("#{} can't be written", "#{} cannot be written"),
    ("#{} can't be read", "#{} cannot be read"),
    ("more than five brackets inside one another", "more than five nested brackets"),
    ("{} can't take {}", "{} is not defined for {}"),
    ("more than {} macro calls inside one another", "more than {} nested macro calls"),
    ("no axis {}", "axis number {} does not exist"),
    ("AXNUM: '{}' is no axis of this control", "AXNUM: the control has no axis '{}'"),
    ("the drilling axis can't be told", "the drilling axis is ambiguous"),
    ("no block N{} to go to", "sequence number N{} is not found"),
    ("G can't be an argument", "G is not allowed as an argument"),
    ("G51 can't scale by {}", "G51: scale factor {} is not allowed"),
    ("T can't stand beside G04, G10 or G50", "T is not allowed in a block with G04, G10 or G50"),
    (
        "G29 without a G28 that left an intermediate point",
        "G29 without a preceding G28 with an intermediate point",
    ),
    (
        "M{} behind M{} in one block: only the last M code counts",
        "M{} after M{} in one block: only the last M code counts",
    ),
    ("{} beside M99 while a modal macro call is on", "{} in a block with M99 while a modal macro call is on"),
    ("{} belongs to another kind of tool offset memory", "{} belongs to another type of tool offset memory"),
    (
        "the number in brackets behind {} is missing, not wanted, or out of range",
        "the index of {} is missing, not allowed, or out of range",
    ),
    ("no variable is named {}", "variable name {} is not defined"),
    (
        "'=', '<', '>', '&' and '|' mean nothing in a condition here",
        "'=', '<', '>', '&' and '|' are not operators of a condition here",
    ),
    (
        "a variable's name is made of letters, digits and _",
        "a variable name consists of letters, digits and _",
    ),
    ("address {} stands twice in the block", "address {} is repeated in the block"),
    ("G31 has come to its end without a skip signal", "G31 ended without a skip signal"),
    ("the stylus is pushed {} mm and gives {} mm", "the stylus is deflected by {} mm, limit {} mm"),
    ("{} in such a block is not simulated", "{} in this block is not simulated"),
    ("{} is not here, and {}", "{} is not found: {}"),
    ("{} is not here", "{} is not found"),
];

/// Of `#3000` without a text.
const NO_TEXT: (&str, &str) =
    ("the program stops itself and does not say why", "the program raises an alarm without a text");

/// The words of an accepted ending as this version writes them. A text of `#3000` stays as it is.
pub(super) fn present_words(words: &str) -> String {
    let present = || {
        let (code, message) = words.strip_prefix("alarm ")?.split_once(' ')?;
        let wordings = if code.starts_with("MC") { &[NO_TEXT][..] } else { &ALARMS[..] };
        let message = wordings.iter().find_map(|(was, is)| reworded(message, was, is))?;
        Some(format!("alarm {code} {message}"))
    };
    present().unwrap_or_else(|| words.to_owned())
}

/// A message that has the form `was`, in the form `is` with the same values.
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
    /// It was written when less was noted of a run: what a program commands first was noted last of all.
    pub fn is_legacy(&self) -> bool {
        self.begun.is_none()
    }

    /// What can't be held against it, in people's words; nothing for one that notes all. Of an older one nobody knows
    /// whether what it has none of was noted.
    pub fn unrecorded_aspects(&self) -> Vec<&'static str> {
        if !self.is_legacy() {
            return Vec::new();
        }
        let mut all = vec!["the state required at the program's start"];
        all.extend(self.program.is_none().then_some("its O number"));
        let conditions =
            ModalAspect::ALL.into_iter().filter(|what| self.lacks_condition(*what)).map(|what| match what {
                ModalAspect::System => "the work offset by its number",
                ModalAspect::Length => "tool length offsets by their numbers",
                ModalAspect::Cutter => "the cutter's side and D",
                ModalAspect::Path => "G61 to G64",
                ModalAspect::Level => "G98 and G99",
                ModalAspect::Cycle => "the drilling cycle",
            });
        all.extend(conditions);
        all.extend(QUIET.iter().filter(|(what, _)| self.lacks_quiet(*what)).map(|(_, words)| *words));
        let is_unclear = self.steps.iter().any(|step| matches!(step.kind, StepKind::Coolant(true, None)));
        all.extend(is_unclear.then_some("mist or coolant"));
        all.extend(self.lacks_again().then_some("repeated holes"));
        all
    }

    /// What `accepted` would say of this run: no more than was noted when it was written.
    #[must_use]
    pub fn reduced_to(&self, accepted: &Self) -> Self {
        let mut record = self.clone();
        if !accepted.is_legacy() {
            return record;
        }
        record.begun = None;
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
        let lacking = QUIET.map(|(what, _)| what).into_iter().filter(|what| accepted.lacks_quiet(*what));
        let lacking: Vec<UnsimulatedKind> = lacking.collect();
        record.leave_out(|kind| matches!(kind, StepKind::Silent(what, _) if lacking.contains(what)));
        record
    }

    fn lacks_condition(&self, what: ModalAspect) -> bool {
        self.conditions.iter().all(|condition: &ModalConditions| condition.word(what).text.is_empty())
    }

    fn lacks_quiet(&self, what: UnsimulatedKind) -> bool {
        !self.steps.iter().any(|step| matches!(&step.kind, StepKind::Silent(one, _) if *one == what))
    }

    fn lacks_again(&self) -> bool {
        self.holes.iter().enumerate().all(|(number, hole)| hole.first_on_line == number)
    }

    /// Takes steps out; what counts steps counts those that are left.
    fn leave_out(&mut self, is_out: impl Fn(&StepKind) -> bool) {
        let mut now = BTreeMap::new();
        for (before, _) in self.steps.iter().enumerate().filter(|(_, step)| !is_out(&step.kind)) {
            now.insert(before, now.len());
        }
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
    fn an_alarm_that_was_worded_otherwise_is_the_same_alarm() {
        for (was, is) in [
            ("alarm PS1124 the drilling axis can't be told", "alarm PS1124 the drilling axis is ambiguous"),
            ("alarm PS0119 SQRT can't take -4", "alarm PS0119 SQRT is not defined for -4"),
            (
                "alarm PS0020 the arc starts 5.0000 mm from its centre and ends 4.9000 mm from it (0.05 allowed)",
                "alarm PS0020 the arc starts 5.0000 mm from its centre and ends 4.9000 mm from it (tolerance 0.05)",
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
