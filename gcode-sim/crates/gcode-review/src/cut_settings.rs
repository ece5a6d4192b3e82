//! Conditions of a cut that is made at another time: tool, modal codes, feed, spindle and coolant.
use std::collections::BTreeMap;

use super::align::Alignment;
use super::descriptions::short;
use super::modal_conditions::ModalAspect;
use super::record::Record;
use super::steps::StepKind;
use super::tool_setup::CutState;

/// Returns for each cut that both revisions make how its conditions differ, in words; `None` if they are equal.
pub(super) fn changed_cut_settings(
    alignment: &Alignment<'_>,
    cuts: &[(usize, usize)],
) -> Vec<Option<String>> {
    let [old, new] = alignment.records;
    let is_named = CutState::is_named(old, new);
    let before = states(old, cuts.iter().map(|(i, _)| *i), is_named);
    let now = states(new, cuts.iter().map(|(_, j)| *j), is_named);
    let of = |(i, j): &(usize, usize)| {
        let ((tool, was), (tool_now, is)) = (&before[i], &now[j]);
        let mut texts = Vec::new();
        if let (Some(was), Some(is)) = (tool, tool_now)
            && was != is
        {
            texts.push(format!("T{is} instead of T{was}"));
        }
        for aspect in ModalAspect::ALL {
            let [was, is] = [old.under(*i), new.under(*j)].map(|under| &under.word(aspect).text);
            if was != is && !was.is_empty() && !is.is_empty() {
                texts.push(format!("{is} instead of {was}"));
            }
        }
        if let (Some(was), Some(is)) = (old.steps.kind(*i).rate(), new.steps.kind(*j).rate())
            && (was - is).abs() > 1e-6 * was.abs().max(is.abs())
        {
            texts.push(format!("F{} instead of F{}", short(is), short(was)));
        }
        texts.extend(was.others(is).map(|[whether, was, is]| format!("{whether}{is} instead of {was}")));
        (!texts.is_empty()).then(|| format!("with {}", texts.join(", ")))
    };
    cuts.iter().map(of).collect()
}

/// Returns the tool in the spindle and the state at some steps, by their numbers.
fn states(
    record: &Record,
    steps: impl Iterator<Item = usize>,
    is_named: bool,
) -> BTreeMap<usize, (Option<u32>, CutState)> {
    let mut states: BTreeMap<usize, (Option<u32>, CutState)> =
        steps.map(|step| (step, Default::default())).collect();
    let (mut now, mut done) = ((None, CutState::default()), 0);
    for (end, state) in &mut states {
        for number in done..*end {
            let kind = record.steps.kind(number);
            now.1.follow(kind, number, is_named);
            if let StepKind::Tool(tool) = kind {
                now.0 = Some(*tool);
            }
        }
        done = *end;
        state.clone_from(&now);
    }
    states
}
