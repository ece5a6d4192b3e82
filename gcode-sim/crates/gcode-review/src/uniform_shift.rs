//! Programs whose moves are all shifted by one displacement: their steps are linked in order, even if a shift by
//! the pitch of the holes leads each move to the old end point of the next.
use super::align::{StepRange, align};
use super::links::{Links, StepPair};
use super::program_text::words;
use super::record::Record;
use super::steps::{Step, difference, near};
use gcode_lang::motion::{MAX_AXES, Position};

/// Returns the links of such a program; `None` if `links` leave no move unpaired on either side, or if blocks or
/// displacements differ. Moves to unchanged machine positions with another tool length may be of any blocks.
pub(super) fn pair_shifted_program(
    links: &Links,
    old: &Record,
    new: &Record,
    tolerance: f64,
) -> Option<Links> {
    let is_lost = |(_, link)| matches!(link, StepPair::Lost(i) if old.steps.is_move(i));
    let is_added = |(_, link)| matches!(link, StepPair::Added(j) if new.steps.is_move(j));
    if !(links.unpaired().any(is_lost) && links.unpaired().any(is_added)) {
        return None;
    }
    let pairs = || moves(old).zip(moves(new));
    let both = || pairs().map(|(i, j)| (old.steps.at(i), new.steps.at(j)));
    let discriminant = |record: &Record, step: usize| std::mem::discriminant(record.steps.kind(step));
    let mut kinds = pairs().map(|(i, j)| discriminant(old, i) == discriminant(new, j));
    if moves(old).count() != moves(new).count() || !kinds.all(|is_kind| is_kind) {
        return None;
    }
    let block = |record: &Record, step: &Step<'_>| words(&record.blocks.location(step.block_number).block);
    let is_at_once = || both().all(|(a, b)| near(&a.at, &b.at, tolerance));
    let is_by_the_same =
        || is_uniform_shift(both(), tolerance) && both().all(|(a, b)| block(old, &a) == block(new, &b));
    (is_at_once() || is_by_the_same()).then(|| linked(pairs(), old, new, tolerance))
}

fn moves(record: &Record) -> impl Iterator<Item = usize> {
    (0..record.steps.len()).filter(|step| record.steps.is_move(*step))
}

/// Returns true if every axis that is displaced has one displacement in all moves.
fn is_uniform_shift<'a>(both: impl Iterator<Item = (Step<'a>, Step<'a>)>, tolerance: f64) -> bool {
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
fn linked(pairs: impl Iterator<Item = (usize, usize)>, old: &Record, new: &Record, tolerance: f64) -> Links {
    let mut links = Links::default();
    let (mut i, mut j) = (0, 0);
    let ends = (old.steps.len(), new.steps.len());
    for (to_i, to_j) in pairs.chain([ends]) {
        if (i, j) != (to_i, to_j) {
            let sides = (StepRange::new(&old.steps, i..to_i), StepRange::new(&new.steps, j..to_j));
            links.append(&align(sides, tolerance), i, j);
        }
        if (to_i, to_j) != ends {
            let is_same = old.steps.at(to_i).is_same(&new.steps.at(to_j), tolerance);
            links.push(if is_same { StepPair::Same(to_i, to_j) } else { StepPair::Changed(to_i, to_j) });
        }
        (i, j) = (to_i + 1, to_j + 1);
    }
    links
}
