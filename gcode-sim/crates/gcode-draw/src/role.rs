//! Meaning of lines and symbols; `palette` and `symbol` give them colours, dash patterns and shapes.

/// A point of the drawing plane, mm to the right and up; the view defines the two directions on the part.
pub type Point = [f64; 2];

/// Meaning of a line, from which colour, width and dash pattern follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pen {
    /// Edge of the part.
    Outline,
    /// Construction line, not an edge: for example the circle on which holes lie.
    Construction,
    /// Tick of a scale, drawn outwards; numbers that would collide are omitted.
    Scale,
    /// Tool path at cutting feed.
    Feed,
    /// Tool path with a fault.
    Faulty,
    /// Tool path with a fault, on the far side.
    Hidden,
    /// Tool path in rapid motion.
    Rapid,
    /// Cut that both revisions make.
    Unchanged,
    /// New version of a changed cut.
    New,
    /// Old version of a changed cut.
    Old,
    /// Grid line of a graph.
    Grid,
    /// Actual curve of a graph.
    Measured,
    /// Further actual curves of a graph.
    Others,
    /// Tolerance limit in a graph.
    Limit,
    /// Nominal curve of a graph.
    First,
    /// Second curve of a graph, for comparison.
    Second,
}

/// Result of comparing a hole with its nominal, in order of importance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum HoleStatus {
    /// Out of tolerance, or changed.
    Bad,
    /// Not made, or lost.
    Missing,
    /// Not in the reference, or added.
    Extra,
    /// Not compared.
    Unjudged,
    /// In tolerance, or unchanged.
    Good,
}

impl HoleStatus {
    /// Returns true if the hole needs no attention.
    pub(super) fn is_good(self) -> bool {
        matches!(self, Self::Good | Self::Unjudged)
    }
}
