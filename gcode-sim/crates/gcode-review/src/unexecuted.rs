//! Blocks that are written otherwise and that neither run executed: what they do, nobody has seen.
use schemars::JsonSchema;
use serde::Serialize;

use super::align::common;
use super::cause::words;
use super::record::{BlockLocation, Revision};
use gcode_lang::motion::Backtrace;
use gcode_lang::source::SourceId;
use gcode_lang::syntax::parse;

/// An unexecuted changed block, old and new; only one of them if it is added or removed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct UnexecutedChange {
    pub old: Option<BlockLocation>,
    pub new: Option<BlockLocation>,
}

/// A block of a program that was read.
struct ReadBlock {
    place: BlockLocation,
    /// Without sequence number, remarks and spaces.
    words: String,
    /// All that it says was done; an IF whose condition never held is not.
    is_done: bool,
}

/// The blocks of programs that both revisions have, in their order.
pub fn unexecuted(old: &Revision, new: &Revision) -> Vec<UnexecutedChange> {
    let (was, is) = (programs(old), programs(new));
    let mut all = Vec::new();
    for (name, before) in &was {
        let Some((_, now)) = is.iter().find(|(other, _)| other == name) else { continue };
        let pairs = common(before.len(), now.len(), |i, j| before[i].words == now[j].words);
        let (mut i, mut j) = (0, 0);
        for (next_i, next_j) in pairs.into_iter().chain([(before.len(), now.len())]) {
            let idle = |blocks: &[ReadBlock]| -> Vec<BlockLocation> {
                blocks.iter().filter(|block| !block.is_done).map(|block| block.place.clone()).collect()
            };
            let (mut gone, mut come) =
                (idle(&before[i..next_i]).into_iter(), idle(&now[j..next_j]).into_iter());
            loop {
                match (gone.next(), come.next()) {
                    (None, None) => break,
                    (old, new) => all.push(UnexecutedChange { old, new }),
                }
            }
            (i, j) = (next_i + 1, next_j + 1);
        }
    }
    all
}

/// Every program that was read, by its name, with its blocks; the main program has the first place and no name.
fn programs(revision: &Revision) -> Vec<(String, Vec<ReadBlock>)> {
    let run = &revision.simulation.run;
    let mut programs = Vec::new();
    for (source, text) in run.control.memory().sources().iter() {
        for program in parse(source, &text.bytes) {
            let blocks = program.blocks.iter().map(|block| {
                let place = BlockLocation::of(run, &Backtrace { block: block.span, calls: None });
                let is_done = revision.done.contains(&(block.span.source, block.span.start));
                ReadBlock { words: words(&place.block), place, is_done }
            });
            let blocks: Vec<ReadBlock> = blocks.filter(|block| !block.words.is_empty()).collect();
            let is_main = source == SourceId::default() && programs.is_empty();
            let name = blocks.first().map_or_else(String::new, |block| block.place.program.clone());
            programs.push((if is_main { String::new() } else { name }, blocks));
        }
    }
    programs
}
