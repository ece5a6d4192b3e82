//! Clusters of points: union–find whose neighbour queries run on a k-d tree.
//!
//! Each point is joined with the points in its query box that satisfy a predicate. A subtree whose points are
//! already one cluster is skipped, so a million coincident points cost O(n log n).
use std::ops::Range;

use gcode_lang::shares;
use nalgebra::Point3;

use crate::local_search::LocalSearch;
use crate::point_tree::{LEAF_SIZE, Node, PointTree};

/// Returns for each point of a tree the lowest index in its cluster: a point is joined with each one in its box that `belongs` to it.
pub fn clusters(
    tree: &PointTree,
    box_about: impl Fn(usize) -> [Point3<f64>; 2] + Sync,
    belongs: impl Fn(usize, usize) -> bool,
) -> Vec<usize> {
    let all: Vec<usize> = (0..tree.nodes().len()).collect();
    // Most points are alone in their boxes.
    let crowded = shares::map_shares(&all, |share| {
        let mut search = LocalSearch::default();
        let crowded = |index: &usize| {
            let [low, high] = box_about(*index);
            let is_other = |node: &Node| node.index as usize != *index && node.is_in(&low, &high);
            let about = search.nodes_about(tree, &low, &high);
            about.is_none_or(|nodes| nodes.iter().any(is_other)).then_some((*index, low, high))
        };
        share.iter().filter_map(crowded).collect()
    });
    let mut clusters = Clusters::new(tree.nodes());
    for (index, low, high) in crowded {
        clusters.visit(0..all.len(), index as u32, &low, &high, &|other| belongs(index, other));
    }
    clusters.representatives()
}

/// The clusters of the points of a tree.
struct Clusters<'t> {
    nodes: &'t [Node],
    /// For each point, itself or a point of its cluster with a lower index.
    parents: Vec<u32>,
    /// For each node, in the order of the tree: whether all points of its subtree are one cluster.
    is_uniform: Vec<bool>,
}

impl<'t> Clusters<'t> {
    /// Returns the clusters of a tree in which each point is a cluster of its own.
    fn new(nodes: &'t [Node]) -> Self {
        let points = nodes.len();
        Self { nodes, parents: (0..points as u32).collect(), is_uniform: vec![false; points] }
    }

    /// Returns for each point the lowest index in its cluster.
    fn representatives(mut self) -> Vec<usize> {
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
        let asked = std::cell::Cell::new(0u32);
        let belongs = |_, _| {
            asked.set(asked.get() + 1);
            true
        };
        let groups = clusters(&tree, |_| [spot, spot], belongs);
        assert!(groups.iter().all(|first| *first == 0));
        assert!(asked.get() < 200_000, "{} pairs", asked.get());
    }

    /// Three points 1 mm apart, the next three 5 mm farther. Threads share 6,001 points, and no share begins with one of three.
    #[test]
    fn clusters_of_many_points_are_those_of_one_thread() {
        let place = |index: usize| (index + 2 * (index / 3) * 2) as f64;
        let points: Vec<_> = (0..6001).map(|index| Point3::new(place(index), 0.0, 0.0)).collect();
        let reach = nalgebra::Vector3::repeat(1.0);
        let tree = PointTree::new(points.iter().copied());
        let groups = clusters(&tree, |index| [points[index] - reach, points[index] + reach], |_, _| true);
        assert!(groups.iter().enumerate().all(|(index, first)| *first == index - index % 3));
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
            let reach = nalgebra::Vector3::repeat(1.0);
            let groups = clusters(&tree, |index| [points[index] - reach, points[index] + reach], belongs);
            prop_assert_eq!(groups, linked(&points, 1.0, &belongs));
        }
    }
}
