//! Strips of points between two straight lines.
use gcode_part::common_shares;
use nalgebra::Point3;

/// A straight line, from its start to its end.
pub(super) type Line = [Point3<f64>; 2];

/// All points between two lines: at each share of both, those between their points there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strip {
    pub edges: [Line; 2],
    /// Where the first edge is in the body, metal above it is left only if metal is left on it.
    pub is_on_first: bool,
}

impl Strip {
    /// Returns the strip between two lines.
    pub(super) fn between(one: Line, other: Line) -> Self {
        Self { edges: [one, other], is_on_first: false }
    }

    /// Returns the points of one line.
    pub(super) fn line(line: Line) -> Self {
        Self::between(line, line)
    }

    /// Returns the shares between which all points are in a convex body; `piece` returns those of a line.
    pub(super) fn piece(&self, piece: impl Fn(&Line) -> Option<[f64; 2]>) -> Option<[f64; 2]> {
        let [one, other] = &self.edges;
        let first = piece(one)?;
        if one == other { Some(first) } else { common_shares(first, piece(other)?) }
    }

    /// Returns the largest distance between the edges, mm.
    pub(super) fn width(&self) -> f64 {
        let [one, other] = &self.edges;
        (one[0] - other[0]).norm().max((one[1] - other[1]).norm())
    }

    /// Returns the length of the longer edge, mm.
    pub(super) fn length(&self) -> f64 {
        self.edges.iter().map(|[from, to]| (to - from).norm()).fold(0.0, f64::max)
    }

    /// Returns the line half way between the edges.
    pub(super) fn middle(&self) -> Line {
        let [one, other] = &self.edges;
        [0, 1].map(|end| nalgebra::center(&one[end], &other[end]))
    }

    /// Returns the strips on both sides of the middle.
    pub(super) fn halves(&self) -> [Self; 2] {
        let (middle, [one, other]) = (self.middle(), self.edges);
        [[one, middle], [middle, other]].map(|edges| Self { edges, ..*self })
    }

    /// Returns the corners of a box about the strip.
    pub(super) fn bounds(&self) -> [Point3<f64>; 2] {
        let [one, other] = &self.edges;
        let low = one[0].inf(&one[1]).inf(&other[0]).inf(&other[1]);
        [low, one[0].sup(&one[1]).sup(&other[0]).sup(&other[1])]
    }
}
