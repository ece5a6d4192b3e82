//! Rapids that are there once only and lead back to where the other revision stands: they make up for what is told already.
use super::align::StepPair;
use super::steps::{Step, difference, near};
use gcode_lang::motion::Position;

/// For every link of a region, `(its place among all links, itself)`, whether it is such a rapid; none where nothing else of the
/// region is different.
///
/// The other revision stands where its rapid before has ended, or goes there by its next one that both make, but for nothing or
/// for one of `shifts`, by which moves of the region end elsewhere.
pub(super) fn find_return_rapids(
    region: &[(usize, StepPair)],
    links: &[StepPair],
    steps: (&[Step], &[Step]),
    shifts: &[Position],
    tolerance: f64,
) -> Vec<bool> {
    let is_back = |(k, link): &(usize, StepPair)| {
        let (step, other) = match *link {
            StepPair::Lost(i) => (&steps.0[i], neighbours(links, steps.1, *k, |link| link.sides().1)),
            StepPair::Added(j) => (&steps.1[j], neighbours(links, steps.0, *k, |link| link.sides().0)),
            StepPair::Same(..) | StepPair::Changed(..) => return false,
        };
        let mut stands = other.into_iter().flatten().filter(|other| other.is_rapid());
        let is_there = |stand: &Step| {
            let way = difference(&step.to, &stand.to);
            near(&way, &Position::default(), tolerance)
                || shifts.iter().any(|shift| near(&way, shift, tolerance))
        };
        step.is_rapid() && stands.any(is_there)
    };
    let back: Vec<bool> = region.iter().map(is_back).collect();
    if back.iter().all(|back| *back) { vec![false; back.len()] } else { back }
}

/// The move of the other revision before a link, and its next one that both make.
fn neighbours<'a>(
    links: &[StepPair],
    steps: &'a [Step],
    at: usize,
    side: impl Fn(&StepPair) -> Option<usize>,
) -> [Option<&'a Step>; 2] {
    let is_linked = |link: &&StepPair| matches!(link, StepPair::Same(..) | StepPair::Changed(..));
    let a_move = |link: &StepPair| side(link).map(|step| &steps[step]).filter(|step| step.is_move());
    [links[..at].iter().rev().find_map(a_move), links[at + 1..].iter().filter(is_linked).find_map(a_move)]
}
