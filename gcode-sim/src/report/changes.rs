//! What two revisions do differently, as text and as data.
use std::fmt::Write;

use serde::Serialize;

use crate::changes::{Change, Revision};
use crate::exec::Outcome;
use crate::motion::Place;
use crate::session::Run;

/// The document of `diff --format json`.
#[derive(Debug, Serialize)]
pub struct ChangesReport {
    /// Says what kind of numbers these are.
    pub basis: &'static str,
    /// Nothing changes on the part, nor in what the control is left with.
    pub same: bool,
    /// mm, and degrees for axes that turn.
    pub tolerance: f64,
    pub changes: Vec<ChangeReport>,
    pub old: Totals,
    pub new: Totals,
}

#[derive(Debug, Serialize)]
pub struct ChangeReport {
    pub code: &'static str,
    pub message: String,
    pub old: Option<BlockReport>,
    pub new: Option<BlockReport>,
}

/// A block, and the calls that led to it, innermost first.
#[derive(Debug, Serialize)]
pub struct BlockReport {
    pub program: String,
    pub line: u32,
    pub block: String,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub calls: Vec<BlockReport>,
}

/// One revision in numbers.
#[derive(Debug, Serialize)]
pub struct Totals {
    pub name: String,
    pub outcome: &'static str,
    pub holes: usize,
    pub moves: u64,
    pub blocks: u64,
    pub seconds: f64,
}

impl ChangesReport {
    pub fn new(old: (&str, &Revision), new: (&str, &Revision), changes: &[Change], tolerance: f64) -> Self {
        let run = |revision: &Revision, place: &Option<Place>| {
            place.as_ref().map(|place| block(&revision.simulation.run, place))
        };
        let changes = changes.iter().map(|change| ChangeReport {
            code: change.code,
            message: change.message.clone(),
            old: run(old.1, &change.old),
            new: run(new.1, &change.new),
        });
        let changes: Vec<_> = changes.collect();
        Self {
            basis: "predicted by simulation, not measured",
            same: changes.is_empty(),
            tolerance,
            changes,
            old: totals(old),
            new: totals(new),
        }
    }

    /// The same for people.
    pub fn text(&self) -> String {
        const SHOWN: usize = 20;
        let mut text = String::new();
        for change in self.changes.iter().take(SHOWN) {
            let _ = writeln!(text, "{:<14} {}", change.code, change.message);
            for (word, block) in [("old", &change.old), ("new", &change.new)] {
                let Some(block) = block else { continue };
                let _ = writeln!(text, "    {word} {}", block.line());
                for call in &block.calls {
                    let _ = writeln!(text, "        called from {}", call.line());
                }
            }
        }
        if SHOWN < self.changes.len() {
            let _ = writeln!(text, "… and {} more: --format json has them all", self.changes.len() - SHOWN);
        }
        let _ = match self.changes.len() {
            0 => writeln!(text, "nothing changes on the part"),
            1 => writeln!(text, "1 change"),
            n => writeln!(text, "{n} changes"),
        };
        for (word, totals) in [("old", &self.old), ("new", &self.new)] {
            let _ = writeln!(
                text,
                "{word}  {}: {}, {}, {}, {:.1} s",
                totals.name,
                counted(totals.holes as u64, "hole"),
                counted(totals.moves, "move"),
                counted(totals.blocks, "block"),
                totals.seconds
            );
        }
        text
    }
}

fn counted(count: u64, what: &str) -> String {
    if count == 1 { format!("1 {what}") } else { format!("{count} {what}s") }
}

impl BlockReport {
    /// `O8101:12  G1 X#11`.
    fn line(&self) -> String {
        format!("{}:{}  {}", self.program, self.line, self.block)
    }
}

fn block(run: &Run, place: &Place) -> BlockReport {
    let sources = run.control.memory().sources();
    let report = |span| {
        let (program, line) = run.locate(span);
        BlockReport { program, line, block: sources.text(span).trim().to_owned(), calls: Vec::new() }
    };
    let chain = std::iter::successors(place.calls.as_deref(), |call| call.outer.as_deref());
    let calls = chain.map(|call| report(call.from)).collect();
    BlockReport { calls, ..report(place.block) }
}

fn totals((name, revision): (&str, &Revision)) -> Totals {
    let run = &revision.simulation.run;
    Totals {
        name: name.to_owned(),
        outcome: match run.outcome {
            Outcome::End => "end",
            Outcome::Alarm(_) => "alarm",
            Outcome::Limit => "limit",
        },
        holes: revision.simulation.extracted.holes.len(),
        moves: run.control.moves(),
        blocks: run.control.blocks(),
        seconds: run.control.seconds().0,
    }
}
