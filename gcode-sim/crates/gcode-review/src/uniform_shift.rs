//! Programs whose moves are all shifted by one displacement: their steps are linked in order, even if a shift by
//! the pitch of the holes leads each move to the old end point of the next.
use super::align::{StepPair, align};
use super::program_text::words;
use super::record::Record;
use super::steps::{Step, difference, near};
use gcode_lang::motion::{MAX_AXES, Position};

/// Returns the links of such a program; `None` if `links` leave no move unpaired on either side, or if blocks or
/// displacements differ. Moves to unchanged machine positions with another tool length may be of any blocks.
pub(super) fn pair_shifted_program(
    links: &[StepPair],
    old: &Record,
    new: &Record,
    tolerance: f64,
) -> Option<Vec<StepPair>> {
    let is_lost = |link: &StepPair| matches!(link, StepPair::Lost(i) if old.steps[*i].is_move());
    let is_added = |link: &StepPair| matches!(link, StepPair::Added(j) if new.steps[*j].is_move());
    if !(links.iter().any(is_lost) && links.iter().any(is_added)) {
        return None;
    }
    let pairs: Vec<(usize, usize)> = moves(old).zip(moves(new)).collect();
    let both = || pairs.iter().map(|(i, j)| (&old.steps[*i], &new.steps[*j]));
    let is_as_many = moves(old).count() == pairs.len() && moves(new).count() == pairs.len();
    let is_kind = |(a, b): (&Step, &Step)| std::mem::discriminant(&a.kind) == std::mem::discriminant(&b.kind);
    if !is_as_many || !both().all(is_kind) {
        return None;
    }
    let is_block = |(a, b): (&Step, &Step)| {
        words(&old.blocks[a.block_number].block) == words(&new.blocks[b.block_number].block)
    };
    let is_at_once = || both().all(|(a, b)| near(&a.at, &b.at, tolerance));
    let is_by_the_same = || both().all(is_block) && is_uniform_shift(both(), tolerance);
    (is_at_once() || is_by_the_same()).then(|| linked(&pairs, old, new, tolerance))
}

fn moves(record: &Record) -> impl Iterator<Item = usize> {
    let steps = record.steps.iter().enumerate();
    steps.filter(|(_, step)| step.is_move()).map(|(number, _)| number)
}

/// Returns true if every axis that is displaced has one displacement in all moves.
fn is_uniform_shift<'a>(both: impl Iterator<Item = (&'a Step, &'a Step)>, tolerance: f64) -> bool {
    let mut common = Position::default();
    for (old, new) in both {
        let shift = difference(&new.to, &old.to);
        for axis in 0..MAX_AXES {
            if shift[axis].abs() <= tolerance {
                continue;
            }
            if common[axis] == 0.0 {
                common[axis] = shift[axis];
            } else if (common[axis] - shift[axis]).abs() > tolerance {
                return false;
            }
        }
    }
    true
}

/// Links pairs of moves, and aligns the commands between them.
fn linked(pairs: &[(usize, usize)], old: &Record, new: &Record, tolerance: f64) -> Vec<StepPair> {
    let mut links = Vec::with_capacity(old.steps.len());
    let (mut i, mut j) = (0, 0);
    for &(to_i, to_j) in pairs.iter().chain([&(old.steps.len(), new.steps.len())]) {
        let between = align(&old.steps[i..to_i], &new.steps[j..to_j], tolerance);
        links.extend(between.into_iter().map(|link| match link {
            StepPair::Same(a, b) => StepPair::Same(i + a, j + b),
            StepPair::Changed(a, b) => StepPair::Changed(i + a, j + b),
            StepPair::Lost(a) => StepPair::Lost(i + a),
            StepPair::Added(b) => StepPair::Added(j + b),
        }));
        if let (Some(was), Some(is)) = (old.steps.get(to_i), new.steps.get(to_j)) {
            let is_same = was.is_same(is, tolerance);
            links.push(if is_same { StepPair::Same(to_i, to_j) } else { StepPair::Changed(to_i, to_j) });
        }
        (i, j) = (to_i + 1, to_j + 1);
    }
    links
}
