//! Box queries one near the other: the points about the last place are remembered, and the tree is searched again only elsewhere.
use nalgebra::{Point3, Vector3};

use super::point_tree::{Node, PointTree};

/// Largest number of points that are remembered; of more the tree finds those in a small box sooner.
const MAX_KEPT: usize = 24;

/// Number of points below which the next box that is remembered is larger.
const MIN_KEPT: usize = 8;

/// Range of the margin about a query within which the points are remembered, mm.
const MARGINS: [f64; 2] = [1e-3, 1e3];

/// Points of one tree about the last query. What a query finds, and in which order, depends on the tree alone.
#[derive(Clone, Debug)]
pub struct LocalSearch {
    /// Corners of the box that holds `nodes`; no box lies in the first one.
    low: Point3<f64>,
    high: Point3<f64>,
    nodes: Vec<Node>,
    margin: f64,
}

impl Default for LocalSearch {
    fn default() -> Self {
        let all = Vector3::repeat(f64::INFINITY);
        Self { low: Point3::from(all), high: Point3::from(-all), nodes: Vec::new(), margin: 1.0 }
    }
}

impl LocalSearch {
    /// Calls `each` with the index of every point in the box from `low` to `high`, as [`PointTree::in_box`] does. All calls have the
    /// same tree.
    pub fn in_box(
        &mut self,
        tree: &PointTree,
        low: &Point3<f64>,
        high: &Point3<f64>,
        each: &mut impl FnMut(usize),
    ) {
        match self.nodes_about(tree, low, high) {
            Some(nodes) => {
                let inside = nodes.iter().filter(|node| node.is_in(low, high));
                inside.for_each(|node| each(node.index as usize));
            }
            None => tree.in_box(low, high, each),
        }
    }

    /// Returns the nodes of a box that holds the one from `low` to `high`; `None` if they are many.
    pub(crate) fn nodes_about(
        &mut self,
        tree: &PointTree,
        low: &Point3<f64>,
        high: &Point3<f64>,
    ) -> Option<&[Node]> {
        let is_within = (0..3).all(|i| self.low[i] <= low[i] && high[i] <= self.high[i]);
        (is_within || self.remember(tree, low, high)).then_some(&self.nodes)
    }

    /// Remembers the points about a box; returns false if they are many.
    fn remember(&mut self, tree: &PointTree, low: &Point3<f64>, high: &Point3<f64>) -> bool {
        let mut nodes = std::mem::take(&mut self.nodes);
        nodes.clear();
        let [least, most] = MARGINS;
        let margin = Vector3::repeat(self.margin);
        let (low, high) = (low - margin, high + margin);
        let is_complete = tree.nodes_in_box(&low, &high, &mut |node| {
            nodes.push(*node);
            nodes.len() <= MAX_KEPT
        });
        let by = match is_complete {
            false => 0.5,
            true if nodes.len() < MIN_KEPT => 2.0,
            true => 1.0,
        };
        let margin = (self.margin * by).clamp(least, most);
        *self = match is_complete {
            true => Self { low, high, nodes, margin },
            false => Self { nodes, margin, ..Self::default() },
        };
        is_complete
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Places follow each other in small and in large steps; many points lie on one spot.
        #[test]
        fn every_query_finds_what_the_tree_finds_in_its_order(
            points in prop::collection::vec((-9i32..9, -9i32..9, -2i32..2), 1..200),
            crowd in 0usize..60,
            steps in prop::collection::vec((-2.0..2.0, -2.0..2.0, 0.0..3.0, prop::bool::weighted(0.1)), 1..60),
        ) {
            let spot = std::iter::repeat_n(Point3::new(0.0, 0.0, 0.0), crowd);
            let points = points.iter().map(|(x, y, z)| Point3::new(f64::from(*x), f64::from(*y), f64::from(*z)));
            let tree = PointTree::new(points.chain(spot));
            let (mut search, mut at) = (LocalSearch::default(), Point3::origin());
            for (x, y, size, is_far) in steps {
                at += Vector3::new(x, y, 0.0) * if is_far { 5.0 } else { 0.3 };
                let (low, high) = (at - Vector3::repeat(size), at + Vector3::repeat(size));
                let (mut found, mut expected) = (Vec::new(), Vec::new());
                search.in_box(&tree, &low, &high, &mut |index| found.push(index));
                tree.in_box(&low, &high, &mut |index| expected.push(index));
                prop_assert_eq!(found, expected);
            }
        }
    }

    /// Each query of a search without a limit would keep 100,000 points.
    #[test]
    fn points_on_one_spot_are_not_remembered() {
        let tree = PointTree::new(std::iter::repeat_n(Point3::origin(), 100_000));
        let mut search = LocalSearch::default();
        for _ in 0..100 {
            let (low, high) = (Point3::new(-1.0, -1.0, -1.0), Point3::new(1.0, 1.0, 1.0));
            assert!(search.nodes_about(&tree, &low, &high).is_none());
            assert_eq!(search.nodes.len(), MAX_KEPT + 1);
        }
        assert_eq!(search.margin, MARGINS[0]);
    }
}
