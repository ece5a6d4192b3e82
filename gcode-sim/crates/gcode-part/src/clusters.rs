//! Clusters of points: union–find whose neighbour queries run on a k-d tree.
//!
//! Each point is joined with the points in its query box that satisfy a predicate. A subtree whose points are
//! already one cluster is skipped, so a million coincident points cost O(n log n).
use std::ops::Range;

use nalgebra::Point3;

use crate::local_search::LocalSearch;
use crate::point_tree::{LEAF_SIZE, Node, PointTree};

/// The clusters of the points of a tree.
#[derive(Debug)]
pub struct Clusters<'t> {
    tree: &'t PointTree,
    nodes: &'t [Node],
    /// Most points are alone in their boxes.
    search: LocalSearch,
    /// For each point, itself or a point of its cluster with a lower index.
    parents: Vec<u32>,
    /// For each node, in the order of the tree: whether all points of its subtree are one cluster.
    is_uniform: Vec<bool>,
}

impl<'t> Clusters<'t> {
    /// Returns the clusters of a tree in which each point is a cluster of its own.
    pub fn new(tree: &'t PointTree) -> Self {
        let nodes = tree.nodes();
        let points = nodes.len();
        Self {
            tree,
            nodes,
            search: LocalSearch::default(),
            parents: (0..points as u32).collect(),
            is_uniform: vec![false; points],
        }
    }

    /// Joins point `index` with each point of the box from `low` to `high` that satisfies `belongs`.
    pub fn join(
        &mut self,
        index: usize,
        low: &Point3<f64>,
        high: &Point3<f64>,
        belongs: &impl Fn(usize) -> bool,
    ) {
        let about = self.search.nodes_about(self.tree, low, high);
        let is_other = |node: &Node| node.index as usize != index && node.is_in(low, high);
        if about.is_none_or(|nodes| nodes.iter().any(is_other)) {
            self.visit(0..self.nodes.len(), index as u32, low, high, belongs);
        }
    }

    /// Returns for each point the lowest index in its cluster.
    pub fn representatives(mut self) -> Vec<usize> {
        (0..self.nodes.len()).map(|index| self.root(index as u32) as usize).collect()
    }

    fn visit(
        &mut self,
        part: Range<usize>,
        index: u32,
        low: &Point3<f64>,
        high: &Point3<f64>,
        belongs: &impl Fn(usize) -> bool,
    ) {
        let Some(middle) = middle(&part) else { return };
        let node = self.nodes[middle];
        if self.is_uniform[middle] && self.root(node.index) == self.root(index) {
            return;
        }
        if part.len() <= LEAF_SIZE {
            for at in part.clone() {
                self.join_node(at, index, low, high, belongs);
            }
            let root = self.root(node.index);
            self.is_uniform[middle] = part.into_iter().all(|at| self.root(self.nodes[at].index) == root);
            return;
        }
        self.join_node(middle, index, low, high, belongs);
        let (axis, place) = node.halves();
        let (before, behind) = (part.start..middle, middle + 1..part.end);
        if low[axis] <= place {
            self.visit(before.clone(), index, low, high, belongs);
        }
        if place <= high[axis] {
            self.visit(behind.clone(), index, low, high, belongs);
        }
        self.is_uniform[middle] =
            self.is_uniform_with(&before, node.index) && self.is_uniform_with(&behind, node.index);
    }

    /// Joins the point of one node if it lies in the box and satisfies `belongs`.
    fn join_node(
        &mut self,
        node: usize,
        index: u32,
        low: &Point3<f64>,
        high: &Point3<f64>,
        belongs: &impl Fn(usize) -> bool,
    ) {
        let node = self.nodes[node];
        if node.is_in(low, high) && belongs(node.index as usize) {
            let (a, b) = (self.root(index), self.root(node.index));
            self.parents[a.max(b) as usize] = a.min(b);
        }
    }

    fn is_uniform_with(&mut self, part: &Range<usize>, index: u32) -> bool {
        middle(part).is_none_or(|m| self.is_uniform[m] && self.root(self.nodes[m].index) == self.root(index))
    }

    fn root(&mut self, index: u32) -> u32 {
        let mut at = index as usize;
        while self.parents[at] as usize != at {
            self.parents[at] = self.parents[self.parents[at] as usize];
            at = self.parents[at] as usize;
        }
        at as u32
    }
}

/// Returns the node of a range of the tree; `None` if the range is empty.
fn middle(part: &Range<usize>) -> Option<usize> {
    (!part.is_empty()).then(|| part.start + part.len() / 2)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Returns the transitive closure of “within `reach` in every coordinate, and `belongs`”, by brute force.
    fn linked(points: &[Point3<f64>], reach: f64, belongs: &dyn Fn(usize, usize) -> bool) -> Vec<usize> {
        let mut first: Vec<usize> = (0..points.len()).collect();
        let near = |i: usize, j: usize| (points[i] - points[j]).amax() <= reach && belongs(i, j);
        while let Some((i, j)) = (0..points.len())
            .flat_map(|i| (0..points.len()).map(move |j| (i, j)))
            .find(|(i, j)| near(*i, *j) && first[*i] != first[*j])
        {
            let (least, other) = (first[i].min(first[j]), first[i].max(first[j]));
            first.iter_mut().filter(|f| **f == other).for_each(|f| *f = least);
        }
        first
    }

    /// A comparison pair by pair would take 10¹⁰ of them.
    #[test]
    fn a_hundred_thousand_points_on_one_spot_are_joined_at_once() {
        let spot = Point3::new(1.0, 2.0, 3.0);
        let tree = PointTree::new(std::iter::repeat_n(spot, 100_000));
        let mut groups = Clusters::new(&tree);
        let asked = std::cell::Cell::new(0u32);
        for index in 0..100_000 {
            groups.join(index, &spot, &spot, &|_| {
                asked.set(asked.get() + 1);
                true
            });
        }
        assert!(groups.representatives().iter().all(|first| *first == 0));
        assert!(asked.get() < 200_000, "{} pairs", asked.get());
    }

    proptest! {
        #[test]
        fn clusters_are_the_transitive_closure(
            points in prop::collection::vec((-4i32..4, -4i32..4, -1i32..2, 0u8..3), 1..40),
        ) {
            let kinds: Vec<u8> = points.iter().map(|p| p.3).collect();
            let points: Vec<_> =
                points.iter().map(|p| Point3::new(f64::from(p.0), f64::from(p.1), f64::from(p.2))).collect();
            let belongs = |i: usize, j: usize| kinds[i] == kinds[j];
            let tree = PointTree::new(points.iter().copied());
            let mut groups = Clusters::new(&tree);
            for (index, point) in points.iter().enumerate() {
                let reach = nalgebra::Vector3::repeat(1.0);
                groups.join(index, &(point - reach), &(point + reach), &|other| belongs(index, other));
            }
            prop_assert_eq!(groups.representatives(), linked(&points, 1.0, &belongs));
        }
    }
}
