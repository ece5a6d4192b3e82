//! Passes that make each hole and their tools: all passes on its line, repeated ones as well.
use std::collections::BTreeSet;

use super::record::Record;
use super::steps::StepKind;

/// Passes of each hole of a record; none for a hole that repeats another.
pub(super) struct Passes {
    /// The hole itself, or the one that it repeats.
    first: Vec<usize>,
    /// Holes that repeat each one, in their order.
    pub repeats: Vec<Vec<usize>>,
    /// Steps that cut it, in their order.
    pub steps: Vec<Vec<usize>>,
    /// Tools of these steps; none if one of them is unknown.
    pub tools: Vec<Vec<u32>>,
}

impl Passes {
    pub(super) fn of(record: &Record) -> Self {
        let first: Vec<usize> = record.holes.iter().map(|hole| hole.first_on_line).collect();
        let mut steps = vec![Vec::new(); record.holes.len()];
        let mut repeats = vec![Vec::new(); record.holes.len()];
        for (hole, feeds) in record.feeds.iter().enumerate() {
            steps[first[hole]].extend(feeds);
            if first[hole] != hole {
                repeats[first[hole]].push(hole);
            }
        }
        steps.iter_mut().for_each(|steps| steps.sort_unstable());
        let changes = record.steps.kinds().enumerate().filter_map(|(step, kind)| match kind {
            StepKind::Tool(number) => Some((step, *number)),
            _ => None,
        });
        let changes: Vec<(usize, u32)> = if record.holes.is_empty() { Vec::new() } else { changes.collect() };
        let in_spindle = |step: &usize| {
            let before = changes.partition_point(|(change, _)| change <= step).checked_sub(1)?;
            Some(changes[before].1)
        };
        let of = |steps: &Vec<usize>| steps.iter().map(in_spindle).collect::<Option<_>>();
        let tools = steps.iter().map(|steps| of(steps).unwrap_or_default()).collect();
        Self { first, repeats, steps, tools }
    }

    /// Returns the steps that cut some holes.
    pub(super) fn of_holes(&self, holes: &[usize]) -> Vec<usize> {
        holes.iter().flat_map(|hole| self.steps[*hole].iter().copied()).collect()
    }

    /// Returns the holes that repeat no other.
    pub(super) fn firsts(&self) -> Vec<usize> {
        (0..self.first.len()).filter(|hole| self.first[*hole] == *hole).collect()
    }
}

impl Record {
    /// Returns the tools of each hole's passes in their order; none if one is unknown, or if the hole repeats
    /// another.
    pub fn made_by(&self) -> Vec<Vec<u32>> {
        Passes::of(self).tools
    }
}

/// Describes other tools or another number of passes; `None` if they are unchanged or unknown.
pub(super) fn other_tools(was: &[u32], is: &[u32]) -> Option<String> {
    if was.is_empty() || is.is_empty() || was == is {
        return None;
    }
    let swapped: BTreeSet<_> = was.iter().zip(is).filter(|(before, now)| before != now).collect();
    Some(match swapped.iter().collect::<Vec<_>>()[..] {
        // The same for holes that other tools make as well.
        [(before, now)] if was.len() == is.len() => format!("made by T{now} instead of T{before}"),
        _ => format!("made by {} instead of {}", in_words(is), in_words(was)),
    })
}

/// Formats tools as `T1`, `T1 and T2`, `T1, T2 and T1`; consecutive passes of one tool as `T1 and T2 (3 times)`.
pub(super) fn in_words(tools: &[u32]) -> String {
    let name = |run: &[u32]| match run {
        [tool] => format!("T{tool}"),
        _ => format!("T{} ({} times)", run[0], run.len()),
    };
    let names: Vec<String> = tools.chunk_by(|a, b| a == b).map(name).collect();
    match names.as_slice() {
        [] => String::new(),
        [only] => only.clone(),
        [before @ .., last] => format!("{} and {last}", before.join(", ")),
    }
}
