//! What lines and signs stand for: colours, dashes and shapes follow from that (`palette`, `symbol`).

/// A point of the plane of the drawing, mm: to the right and up. A view says which way of the part is right.
pub type Point = [f64; 2];

/// What a line stands for; its colour and dashes follow from that.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pen {
    /// Edge of the part.
    Outline,
    /// Not an edge, only helps the eye: the circle on which holes lie.
    Construction,
    /// Tick of a scale, drawn outwards; where its numbers would run into each other some are left out.
    Scale,
    /// Path of the tool while it cuts.
    Feed,
    /// The same where something is wrong with it.
    Faulty,
    /// That on the side that isn't seen.
    Hidden,
    /// Path of the tool in rapid motion.
    Rapid,
    /// Of two revisions a cut of both, one that is another one now, and what it was before.
    Unchanged,
    New,
    Old,
    /// Of a graph.
    Grid,
    /// A curve of a graph: what was found, and where that is one of many, the others.
    Measured,
    Others,
    /// Edge of what is allowed, in a graph.
    Limit,
    /// Two curves of a graph to compare with what was found.
    First,
    Second,
}

/// How a hole stands against what was wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum HoleStatus {
    Bad,
    Missing,
    Extra,
    /// Nothing was held against it.
    Unjudged,
    Good,
}

impl HoleStatus {
    /// Nothing to look at twice.
    pub fn is_good(self) -> bool {
        matches!(self, Self::Good | Self::Unjudged)
    }
}
