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
