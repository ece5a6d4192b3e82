//! Which of many points lie near: a k-d tree, so that hundreds of thousands of holes stay n log n.
use nalgebra::Point3;

/// Points in an order that halves them again and again; the middle one of each part is its node.
#[derive(Debug, Default)]
pub struct PointTree {
    nodes: Vec<Node>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    point: Point3<f64>,
    index: u32,
    /// Before the node lie points that are less in this coordinate, behind it those that are more.
    axis: u8,
}

impl PointTree {
    pub fn new(points: impl IntoIterator<Item = Point3<f64>>) -> Self {
        let nodes = points.into_iter().zip(0u32..).map(|(point, index)| Node { point, index, axis: 0 });
        let mut nodes: Vec<_> = nodes.collect();
        halve(&mut nodes);
        Self { nodes }
    }

    /// Tells `each` the index of every point in the box from `low` to `high`.
    pub fn in_box(&self, low: &Point3<f64>, high: &Point3<f64>, each: &mut impl FnMut(usize)) {
        visit(&self.nodes, low, high, each);
    }

    /// The index and the distance of the nearest point.
    pub fn nearest(&self, to: &Point3<f64>) -> Option<(usize, f64)> {
        let mut best = None;
        closest(&self.nodes, to, &mut best);
        best
    }
}

fn halve(nodes: &mut [Node]) {
    if nodes.len() < 2 {
        return;
    }
    let axis = widest(nodes);
    let middle = nodes.len() / 2;
    // The index decides between equal ones, so that the same points always make the same tree.
    let order = |a: &Node, b: &Node| a.point[axis].total_cmp(&b.point[axis]).then(a.index.cmp(&b.index));
    nodes.select_nth_unstable_by(middle, order);
    nodes[middle].axis = axis as u8;
    let (before, behind) = nodes.split_at_mut(middle);
    halve(before);
    halve(&mut behind[1..]);
}

/// Holes often lie on a plane: halving across it would tell nothing apart.
fn widest(nodes: &[Node]) -> usize {
    let first = nodes[0].point;
    let (low, high) =
        nodes.iter().fold((first, first), |(low, high), n| (low.inf(&n.point), high.sup(&n.point)));
    (high - low).imax()
}

fn visit(nodes: &[Node], low: &Point3<f64>, high: &Point3<f64>, each: &mut impl FnMut(usize)) {
    let middle = nodes.len() / 2;
    let Some(Node { point, index, axis }) = nodes.get(middle) else { return };
    if (0..3).all(|i| (low[i]..=high[i]).contains(&point[i])) {
        each(*index as usize);
    }
    let axis = usize::from(*axis);
    if low[axis] <= point[axis] {
        visit(&nodes[..middle], low, high, each);
    }
    if point[axis] <= high[axis] {
        visit(&nodes[middle + 1..], low, high, each);
    }
}

fn closest(nodes: &[Node], to: &Point3<f64>, best: &mut Option<(usize, f64)>) {
    let middle = nodes.len() / 2;
    let Some(Node { point, index, axis }) = nodes.get(middle) else { return };
    let distance = (point - to).norm();
    if best.is_none_or(|(at, least)| (distance, *index as usize) < (least, at)) {
        *best = Some((*index as usize, distance));
    }
    let beyond = to[usize::from(*axis)] - point[usize::from(*axis)];
    let (near, far) = match beyond < 0.0 {
        true => (&nodes[..middle], &nodes[middle + 1..]),
        false => (&nodes[middle + 1..], &nodes[..middle]),
    };
    closest(near, to, best);
    if best.is_none_or(|(_, least)| beyond.abs() <= least) {
        closest(far, to, best);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn the_tree_finds_what_looking_at_all_of_them_finds(
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

            let to = Point3::new(x, y, z);
            let least = points.iter().map(|p| (p - to).norm()).fold(f64::INFINITY, f64::min);
            prop_assert_eq!(tree.nearest(&to).unwrap().1, least);
        }
    }
}
