//! A k-d tree of points for box, pair and nearest-neighbour queries on hundreds of thousands of holes.
use gcode_lang::shares::{share_length, work_on};
use nalgebra::{Point3, Vector3};

/// Size below which a range of nodes is searched linearly; further halving is slower.
pub(crate) const LEAF_SIZE: usize = 8;

/// Points in k-d order: the middle point of each range is its node, and both halves are ranges.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointTree {
    nodes: Vec<Node>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Node {
    pub point: Point3<f64>,
    pub index: u32,
    /// Coordinate of the split: points before the node are less or equal, points after it greater or equal.
    axis: u8,
}

impl Node {
    /// Returns true if the point is in the box. All coordinates are compared, which is faster than a branch
    /// for each.
    #[inline]
    pub(crate) fn is_in(&self, low: &Point3<f64>, high: &Point3<f64>) -> bool {
        let p = &self.point;
        (0..3).fold(true, |inside, i| inside & (low[i] <= p[i]) & (p[i] <= high[i]))
    }

    /// Returns the coordinate of the split and its value.
    #[inline]
    pub(crate) fn halves(&self) -> (usize, f64) {
        let axis = usize::from(self.axis);
        (axis, self.point[axis])
    }
}

impl PointTree {
    /// Builds the tree. A point's index is its place in `points`.
    pub fn new(points: impl IntoIterator<Item = Point3<f64>>) -> Self {
        let nodes = points.into_iter().zip(0u32..).map(|(point, index)| Node { point, index, axis: 0 });
        let mut nodes: Vec<_> = nodes.collect();
        if let Some(first) = nodes.first().map(|node| node.point) {
            let (low, high) =
                nodes.iter().fold((first, first), |(low, high), n| (low.inf(&n.point), high.sup(&n.point)));
            let is_shared = share_length(nodes.len()) < nodes.len();
            let all = (nodes.as_mut_slice(), low, high);
            match is_shared {
                true => work_on(split(all).into_iter().flatten(), sort),
                false => sort(all),
            }
        }
        Self { nodes }
    }

    /// Calls `each` with the index of every point in the box from `low` to `high`, bounds included.
    pub fn in_box(&self, low: &Point3<f64>, high: &Point3<f64>, each: &mut impl FnMut(usize)) {
        self.nodes_in_box(low, high, &mut |node| {
            each(node.index as usize);
            true
        });
    }

    /// Calls `each` with the nodes in the box from `low` to `high`, bounds included, while it returns true. Returns false if it has
    /// returned false. The order of two nodes is the same in every box.
    pub(crate) fn nodes_in_box(
        &self,
        low: &Point3<f64>,
        high: &Point3<f64>,
        each: &mut impl FnMut(&Node) -> bool,
    ) -> bool {
        visit(&self.nodes, 0, low, high, each)
    }

    /// Calls `each` once with the indices of every two points whose coordinates differ by at most `reach`.
    pub fn pairs(&self, reach: f64, each: &mut impl FnMut(usize, usize)) {
        let margin = Vector3::repeat(reach);
        for (place, node) in self.nodes.iter().enumerate() {
            let mut other = |other: &Node| {
                each(node.index as usize, other.index as usize);
                true
            };
            visit(&self.nodes, place + 1, &(node.point - margin), &(node.point + margin), &mut other);
        }
    }

    /// Returns the index and the distance of the nearest point; `None` for an empty tree.
    pub fn nearest(&self, to: &Point3<f64>) -> Option<(usize, f64)> {
        self.nearest_matching(to, &|_, _| true)
    }

    /// Returns the nearest point for which `counts`, called with index and distance, is true.
    pub fn nearest_matching(
        &self,
        to: &Point3<f64>,
        counts: &impl Fn(usize, f64) -> bool,
    ) -> Option<(usize, f64)> {
        let mut best = None;
        closest(&self.nodes, to, counts, &mut best);
        best
    }

    pub(crate) fn nodes(&self) -> &[Node] {
        &self.nodes
    }
}

/// Nodes, and corners of a box that holds them.
type Part<'n> = (&'n mut [Node], Point3<f64>, Point3<f64>);

/// Sorts the points between `low` and `high` into k-d order.
fn sort((nodes, low, high): Part<'_>) {
    split((nodes, low, high)).into_iter().flatten().for_each(sort);
}

/// Moves the middle point of a part to its middle, and the others before it and behind it, along the longest side of the box. Returns
/// both halves; `None` of a part that is a leaf.
///
/// Holes often lie on a plane; a split across that plane would separate none of them.
fn split<'n>((nodes, low, high): Part<'n>) -> Option<[Part<'n>; 2]> {
    if nodes.len() <= LEAF_SIZE {
        return None;
    }
    let axis = (high - low).imax();
    let middle = nodes.len() / 2;
    // The index decides between equal coordinates, so that the tree is deterministic.
    let order = |a: &Node, b: &Node| a.point[axis].total_cmp(&b.point[axis]).then(a.index.cmp(&b.index));
    nodes.select_nth_unstable_by(middle, order);
    nodes[middle].axis = axis as u8;
    let (mut end, mut start) = (high, low);
    end[axis] = nodes[middle].point[axis];
    start[axis] = end[axis];
    let (before, behind) = nodes.split_at_mut(middle);
    Some([(before, low, end), (&mut behind[1..], start, high)])
}

/// Calls `each` for the nodes in a box while it returns true, without the first `skipped` nodes; returns false if it has returned
/// false. It follows one half in a loop: most boxes are small and meet no other.
fn visit(
    mut nodes: &[Node],
    mut skipped: usize,
    low: &Point3<f64>,
    high: &Point3<f64>,
    each: &mut impl FnMut(&Node) -> bool,
) -> bool {
    while LEAF_SIZE < nodes.len() {
        let middle = nodes.len() / 2;
        let (before, behind) = (&nodes[..middle], &nodes[middle + 1..]);
        let node = &nodes[middle];
        if skipped <= middle && node.is_in(low, high) && !each(node) {
            return false;
        }
        let (axis, place) = node.halves();
        let is_before = skipped < middle && low[axis] <= place;
        if place <= high[axis] {
            if is_before && !visit(before, skipped, low, high, each) {
                return false;
            }
            (nodes, skipped) = (behind, skipped.saturating_sub(middle + 1));
        } else if is_before {
            nodes = before;
        } else {
            return true;
        }
    }
    nodes.iter().skip(skipped).filter(|node| node.is_in(low, high)).all(each)
}

fn closest(
    nodes: &[Node],
    to: &Point3<f64>,
    matches: &impl Fn(usize, f64) -> bool,
    best: &mut Option<(usize, f64)>,
) {
    let middle = nodes.len() / 2;
    let mut look_at = |node: &Node| {
        let distance = (node.point - to).norm();
        let index = node.index as usize;
        if best.is_none_or(|(at, least)| (distance, index) < (least, at)) && matches(index, distance) {
            *best = Some((index, distance));
        }
    };
    if nodes.len() <= LEAF_SIZE {
        nodes.iter().for_each(look_at);
        return;
    }
    look_at(&nodes[middle]);
    let (axis, place) = nodes[middle].halves();
    let beyond = to[axis] - place;
    let (near, far) = match beyond < 0.0 {
        true => (&nodes[..middle], &nodes[middle + 1..]),
        false => (&nodes[middle + 1..], &nodes[..middle]),
    };
    closest(near, to, matches, best);
    if best.is_none_or(|(_, least)| beyond.abs() <= least) {
        closest(far, to, matches, best);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn the_tree_agrees_with_a_search_of_all_points(
            points in prop::collection::vec((-9i32..9, -9i32..9, -9i32..9), 1..60),
            (x, y, z, r) in (-9.0..9.0, -9.0..9.0, -9.0..9.0, 0.0..6.0),
        ) {
            let points: Vec<_> =
                points.iter().map(|(x, y, z)| Point3::new(f64::from(*x), f64::from(*y), f64::from(*z))).collect();
            let tree = PointTree::new(points.iter().copied());
            let (low, high) = (Point3::new(x - r, y - r, z - r), Point3::new(x + r, y + r, z + r));
            let mut found = Vec::new();
            tree.in_box(&low, &high, &mut |i| found.push(i));
            found.sort_unstable();
            let inside = |p: &Point3<f64>| (0..3).all(|i| low[i] <= p[i] && p[i] <= high[i]);
            let all: Vec<_> = (0..points.len()).filter(|i| inside(&points[*i])).collect();
            prop_assert_eq!(found, all);

            let mut pairs = Vec::new();
            tree.pairs(r, &mut |one, other| pairs.push((one.min(other), one.max(other))));
            pairs.sort_unstable();
            let of = |one: usize| (one + 1..points.len()).map(move |other| (one, other));
            let near = |(one, other): &(usize, usize)| (points[*one] - points[*other]).amax() <= r;
            let all: Vec<_> = (0..points.len()).flat_map(of).filter(near).collect();
            prop_assert_eq!(pairs, all);

            let to = Point3::new(x, y, z);
            let least = points.iter().map(|p| (p - to).norm()).fold(f64::INFINITY, f64::min);
            prop_assert_eq!(tree.nearest(&to).unwrap().1, least);
            let odd_ones = points.iter().skip(1).step_by(2).map(|p| (p - to).norm());
            let odd = tree.nearest_matching(&to, &|index, _| index % 2 == 1);
            prop_assert_eq!(odd.map(|(_, distance)| distance), odd_ones.reduce(f64::min));
        }
    }
}
