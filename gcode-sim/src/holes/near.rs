//! Which of many points lie near: a k-d tree, so that hundreds of thousands of holes stay n log n.
use nalgebra::Point3;

/// Points in an order that halves them again and again, along x, y, z in turn; the middle one is the node.
#[derive(Debug, Default)]
pub struct PointTree {
    nodes: Vec<(Point3<f64>, u32)>,
}

impl PointTree {
    pub fn new(points: impl IntoIterator<Item = Point3<f64>>) -> Self {
        let mut nodes: Vec<_> = points.into_iter().zip(0u32..).collect();
        halve(&mut nodes, 0);
        Self { nodes }
    }

    /// Tells `each` the index of every point in the box from `low` to `high`.
    pub fn in_box(&self, low: &Point3<f64>, high: &Point3<f64>, each: &mut impl FnMut(usize)) {
        visit(&self.nodes, 0, low, high, each);
    }

    /// The index and the distance of the nearest point.
    pub fn nearest(&self, to: &Point3<f64>) -> Option<(usize, f64)> {
        let mut best = None;
        closest(&self.nodes, 0, to, &mut best);
        best
    }
}

fn halve(nodes: &mut [(Point3<f64>, u32)], axis: usize) {
    if nodes.len() < 2 {
        return;
    }
    let middle = nodes.len() / 2;
    // The index decides between equal ones, so that the same points always make the same tree.
    nodes.select_nth_unstable_by(middle, |a, b| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1)));
    let (before, after) = nodes.split_at_mut(middle);
    halve(before, (axis + 1) % 3);
    halve(&mut after[1..], (axis + 1) % 3);
}

fn visit(
    nodes: &[(Point3<f64>, u32)],
    axis: usize,
    low: &Point3<f64>,
    high: &Point3<f64>,
    each: &mut impl FnMut(usize),
) {
    let middle = nodes.len() / 2;
    let Some((point, index)) = nodes.get(middle) else { return };
    if (0..3).all(|i| (low[i]..=high[i]).contains(&point[i])) {
        each(*index as usize);
    }
    if low[axis] <= point[axis] {
        visit(&nodes[..middle], (axis + 1) % 3, low, high, each);
    }
    if point[axis] <= high[axis] {
        visit(&nodes[middle + 1..], (axis + 1) % 3, low, high, each);
    }
}

fn closest(nodes: &[(Point3<f64>, u32)], axis: usize, to: &Point3<f64>, best: &mut Option<(usize, f64)>) {
    let middle = nodes.len() / 2;
    let Some((point, index)) = nodes.get(middle) else { return };
    let distance = (point - to).norm();
    if best.is_none_or(|(at, least)| (distance, *index as usize) < (least, at)) {
        *best = Some((*index as usize, distance));
    }
    let beyond = to[axis] - point[axis];
    let (near, far) = match beyond < 0.0 {
        true => (&nodes[..middle], &nodes[middle + 1..]),
        false => (&nodes[middle + 1..], &nodes[..middle]),
    };
    closest(near, (axis + 1) % 3, to, best);
    if best.is_none_or(|(_, least)| beyond.abs() <= least) {
        closest(far, (axis + 1) % 3, to, best);
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
