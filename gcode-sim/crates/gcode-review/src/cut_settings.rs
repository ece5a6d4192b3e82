//! What a cut that is made at another time is made with: tool, modes, feed, spindle and coolant are those of that time.
use std::collections::BTreeMap;

use super::descriptions::short;
use super::modal_conditions::ModalAspect;
use super::record::Record;
use super::steps::StepKind;
use super::tool_setup::CutState;

/// For cuts that both revisions make, by their steps, in words how each of them is made otherwise now; nothing where
/// it isn't.
pub(super) fn changed_cut_settings(
    old: &Record,
    new: &Record,
    cuts: &[(usize, usize)],
) -> Vec<Option<String>> {
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
        let words = |aspect| (old.under(*i).word(aspect), new.under(*j).word(aspect));
        let words = ModalAspect::ALL.into_iter().map(words).filter(|(was, is)| was.text != is.text);
        let words = words.filter(|(was, is)| !was.text.is_empty() && !is.text.is_empty());
        texts.extend(words.map(|(was, is)| format!("{} instead of {}", is.text, was.text)));
        if let (Some(was), Some(is)) = (old.steps[*i].kind.rate(), new.steps[*j].kind.rate())
            && (was - is).abs() > 1e-6 * was.abs().max(is.abs())
        {
            texts.push(format!("F{} instead of F{}", short(is), short(was)));
        }
        let others = was.others(is).map(|[whether, was, is]| format!("{whether}{is} instead of {was}"));
        texts.extend(others);
        (!texts.is_empty()).then(|| format!("with {}", texts.join(", ")))
    };
    cuts.iter().map(of).collect()
}

/// The tool in the spindle and what is in force at some steps.
fn states(
    record: &Record,
    steps: impl Iterator<Item = usize>,
    is_named: bool,
) -> BTreeMap<usize, (Option<u32>, CutState)> {
    let mut wanted: Vec<usize> = steps.collect();
    wanted.sort_unstable();
    let (mut state, mut tool) = (CutState::default(), None);
    let mut done = 0;
    let mut states = BTreeMap::new();
    for step in wanted {
        for (number, step) in record.steps.iter().enumerate().take(step).skip(done) {
            state.follow(&step.kind, number, is_named);
            if let StepKind::Tool(number) = step.kind {
                tool = Some(number);
            }
        }
        done = done.max(step);
        states.insert(step, (tool, state.clone()));
    }
    states
}
