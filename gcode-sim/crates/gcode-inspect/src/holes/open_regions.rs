//! Pockets and voids as bodies that overlap: a plane between two of them, or between one and the space round the stock, is no
//! metal.
//!
//! A strip across such a plane is in neither body as a whole. Bodies that end at a face of the stock are extended beyond it, and
//! bodies that touch are joined by a third that is in both together.
use nalgebra::{Point3, Vector3};

use crate::machine::TOUCH_DEPTH;
use gcode_part::{NOISE, Rod, Surface};

/// Length by which a body goes on beyond a face of the stock, mm.
const BEYOND: f64 = 1000.0;

/// Largest number of bodies that are joined.
const MAX_JOINED: usize = 200;

/// Extent along one coordinate.
type Extent = [f64; 2];

/// Pockets, and voids.
pub(super) struct OpenRegions {
    pub pockets: Vec<Surface>,
    pub voids: Vec<Surface>,
}

impl OpenRegions {
    /// Returns bodies that hold the same metal of a stock.
    pub(super) fn new(stock: Option<&Surface>, mut pockets: Vec<Surface>, mut voids: Vec<Surface>) -> Self {
        if let Some(stock) = stock {
            pockets.iter_mut().chain(&mut voids).for_each(|region| *region = beyond_stock(region, stock));
        }
        join(&mut voids, &[]);
        // What joins a void and a pocket may go, as the pocket may.
        join(&mut pockets, &voids);
        Self { pockets, voids }
    }
}

/// Adds the bodies that join these, and these with others.
fn join(bodies: &mut Vec<Surface>, others: &[Surface]) {
    let mut next = 0;
    while next < bodies.len() {
        let one = bodies[next];
        let earlier = bodies[..next].to_vec();
        for other in others.iter().chain(&earlier) {
            for axis in 0..3 {
                let Some(joint) = joint(&one, other, axis) else { continue };
                let is_known = bodies.iter().chain(others).any(|body| holds(body, &joint));
                if !is_known && bodies.len() < MAX_JOINED {
                    bodies.push(joint);
                }
            }
        }
        next += 1;
    }
}

/// Section of a body across one of the part's axes.
#[derive(Clone, Copy)]
enum Section {
    /// Extents along the two other coordinates.
    Rectangle([Extent; 2]),
    Disc {
        centre: [f64; 2],
        radius: f64,
    },
}

impl Section {
    /// Returns a section that is in both, of a shape that a body has; `None` without one.
    fn common(self, other: Self) -> Option<Self> {
        match (self, other) {
            (Self::Rectangle(a), Self::Rectangle(b)) => {
                let both = [0, 1].map(|i| [a[i][0].max(b[i][0]), a[i][1].min(b[i][1])]);
                both.iter().all(|[low, high]| TOUCH_DEPTH < high - low).then_some(Self::Rectangle(both))
            }
            _ if self.holds(other) => Some(other),
            _ => other.holds(self).then_some(self),
        }
    }

    fn holds(self, other: Self) -> bool {
        match (self, other) {
            (Self::Rectangle(a), Self::Rectangle(b)) => {
                (0..2).all(|i| a[i][0] <= b[i][0] + NOISE && b[i][1] <= a[i][1] + NOISE)
            }
            (Self::Rectangle(a), Self::Disc { centre, radius }) => {
                (0..2).all(|i| a[i][0] <= centre[i] - radius + NOISE && centre[i] + radius <= a[i][1] + NOISE)
            }
            (Self::Disc { centre, radius }, Self::Rectangle(b)) => {
                let far = [0, 1].map(|i| (b[i][0] - centre[i]).abs().max((b[i][1] - centre[i]).abs()));
                libm::hypot(far[0], far[1]) <= radius + NOISE
            }
            (Self::Disc { centre, radius }, Self::Disc { centre: of_other, radius: other }) => {
                let aside = libm::hypot(centre[0] - of_other[0], centre[1] - of_other[1]);
                aside + other <= radius + NOISE
            }
        }
    }

    /// Returns true if a section holds another one but for a thickness that counts as none.
    fn covers(self, other: Self) -> bool {
        match self {
            Self::Disc { centre, radius } => Self::Disc { centre, radius: radius + TOUCH_DEPTH }.holds(other),
            Self::Rectangle(_) => self.holds(other),
        }
    }
}

/// Returns the coordinates across an axis.
fn across(axis: usize) -> [usize; 2] {
    [(axis + 1) % 3, (axis + 2) % 3]
}

/// Returns the extent of a body along an axis, and its section, if this is the same all along.
fn prism(body: &Surface, axis: usize) -> Option<(Extent, Section)> {
    let [low, high] = body.bounds();
    let extent = [low[axis], high[axis]];
    let section = match body {
        Surface::Block { .. } => Section::Rectangle(across(axis).map(|i| [low[i], high[i]])),
        Surface::Rod(rod) if 1.0 - NOISE <= rod.axis[axis].abs() => {
            Section::Disc { centre: across(axis).map(|i| rod.base[i]), radius: rod.radius }
        }
        Surface::Rod(_) | Surface::Ellipsoid { .. } | Surface::Cylinder { .. } => return None,
    };
    Some((extent, section))
}

/// Returns the body with an extent along an axis and a section across it.
fn body(axis: usize, [from, to]: Extent, section: Section) -> Surface {
    let [u, v] = across(axis);
    match section {
        Section::Rectangle([a, b]) => {
            let (mut min, mut max) = (Point3::origin(), Point3::origin());
            (min[axis], min[u], min[v]) = (from, a[0], b[0]);
            (max[axis], max[u], max[v]) = (to, a[1], b[1]);
            Surface::Block { min, max }
        }
        Section::Disc { centre, radius } => {
            let mut base = Point3::origin();
            (base[axis], base[u], base[v]) = (from, centre[0], centre[1]);
            let direction = Vector3::ith_axis(axis);
            Surface::Rod(Rod { base, axis: direction, length: to - from, radius })
        }
    }
}

/// Returns a body that is in two that touch along an axis, and goes as far as both; `None` if one goes as far as that itself.
fn joint(one: &Surface, other: &Surface, axis: usize) -> Option<Surface> {
    let ((a, of_one), (b, of_other)) = (prism(one, axis)?, prism(other, axis)?);
    let is_beside = a[1] < b[0] - TOUCH_DEPTH || b[1] < a[0] - TOUCH_DEPTH;
    let goes_as_far = |a: Extent, b: Extent| a[0] <= b[0] && b[1] <= a[1];
    if is_beside || goes_as_far(a, b) || goes_as_far(b, a) {
        return None;
    }
    Some(body(axis, [a[0].min(b[0]), a[1].max(b[1])], of_one.common(of_other)?))
}

/// Returns true if a body holds another one.
fn holds(body: &Surface, other: &Surface) -> bool {
    (0..3).any(|axis| match (prism(body, axis), prism(other, axis)) {
        (Some((a, section)), Some((b, of_other))) => a[0] <= b[0] && b[1] <= a[1] && section.holds(of_other),
        _ => false,
    })
}

/// Returns a region that goes on beyond the flat faces of a stock at which it ends, and beyond a round one that it covers.
fn beyond_stock(region: &Surface, stock: &Surface) -> Surface {
    let mut region = *region;
    for axis in 0..3 {
        let (Some((of_stock, around)), Some((own, section))) = (prism(stock, axis), prism(&region, axis))
        else {
            continue;
        };
        let from = if own[0] <= of_stock[0] + TOUCH_DEPTH { own[0] - BEYOND } else { own[0] };
        let to = if of_stock[1] - TOUCH_DEPTH <= own[1] { own[1] + BEYOND } else { own[1] };
        let section = match section {
            Section::Disc { centre, radius } if section.covers(around) => {
                Section::Disc { centre, radius: radius + BEYOND }
            }
            _ => section,
        };
        region = body(axis, [from, to], section);
    }
    region
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn block(min: [f64; 3], max: [f64; 3]) -> Surface {
        Surface::Block { min: Point3::from(min), max: Point3::from(max) }
    }

    fn rod(base: [f64; 3], length: f64, radius: f64) -> Surface {
        Surface::Rod(Rod { base: Point3::from(base), axis: Vector3::z_axis(), length, radius })
    }

    fn voids(all: &[Surface]) -> Vec<Surface> {
        let stock = block([0.0; 3], [10.0; 3]);
        OpenRegions::new(Some(&stock), Vec::new(), all.to_vec()).voids
    }

    fn least(bodies: &[Surface], p: &Point3<f64>) -> f64 {
        bodies.iter().map(|body| body.nearest(p).distance).fold(f64::INFINITY, f64::min)
    }

    /// Returns true if one body holds both ends of a line.
    fn hold(bodies: &[Surface], from: [f64; 3], to: [f64; 3]) -> bool {
        let ends = [from, to].map(Point3::from);
        bodies.iter().any(|body| ends.iter().all(|p| body.nearest(p).distance < 0.0))
    }

    #[test]
    fn a_line_over_a_common_plane_is_in_one_body() {
        // Three steps of a stair, the last two at both sides of y 5.
        let stair = [
            block([2.0, 1.0, 6.0], [4.0, 9.0, 8.0]),
            block([4.0, 1.0, 4.0], [6.0, 9.0, 8.0]),
            block([6.0, 5.0, 2.0], [8.0, 9.0, 8.0]),
        ];
        assert!(hold(&voids(&stair), [2.5, 6.0, 7.0], [7.5, 8.0, 7.0]));
        assert!(!hold(&voids(&stair), [2.5, 4.0, 7.0], [7.5, 8.0, 7.0]));
        assert!(!hold(&voids(&stair), [2.5, 6.0, 5.0], [7.5, 8.0, 5.0]));
        // A bore below a wider one, and a slot above both.
        let bores = [
            rod([5.0, 5.0, 4.0], 3.0, 2.0),
            rod([5.0, 5.0, 1.0], 3.0, 1.0),
            block([1.0, 2.0, 7.0], [9.0, 8.0, 8.0]),
        ];
        assert!(hold(&voids(&bores), [5.5, 5.0, 1.5], [5.0, 5.5, 7.9]));
        assert!(!hold(&voids(&bores), [6.5, 5.0, 1.5], [5.0, 5.5, 7.9]));
        // Half a millimetre apart.
        let apart = [block([1.0, 1.0, 1.0], [4.0, 9.0, 8.0]), block([4.5, 1.0, 1.0], [8.0, 9.0, 8.0])];
        assert!(!hold(&voids(&apart), [2.0, 2.0, 2.0], [6.0, 2.0, 2.0]));
    }

    #[test]
    fn a_body_goes_on_beyond_the_faces_at_which_it_ends() {
        let slot = [block([0.0, 2.0, 6.0], [10.0, 8.0, 10.0])];
        assert!(hold(&voids(&slot), [-20.0, 5.0, 30.0], [30.0, 5.0, 7.0]));
        assert!(!hold(&voids(&slot), [-20.0, 5.0, 30.0], [30.0, 5.0, 5.9]));
        assert!(!hold(&voids(&slot), [-20.0, 8.1, 30.0], [30.0, 5.0, 7.0]));
        let closed = [block([0.1, 2.0, 6.0], [10.0, 8.0, 10.0])];
        assert!(!hold(&voids(&closed), [-20.0, 5.0, 7.0], [5.0, 5.0, 7.0]));
        // A layer over the whole end of a bar.
        let bar = rod([0.0; 3], 50.0, 10.0);
        let layer = rod([0.0, 0.0, 48.0], 2.0, 10.0);
        let pockets = OpenRegions::new(Some(&bar), vec![layer], Vec::new()).pockets;
        assert!(hold(&pockets, [-30.0, 0.0, 49.0], [5.0, 0.0, 60.0]));
        assert!(!hold(&pockets, [-30.0, 0.0, 47.9], [5.0, 0.0, 60.0]));
    }

    proptest! {
        /// In the stock a point is in one of the bodies if and only if it is in one that is stated.
        #[test]
        fn the_metal_is_the_same(
            boxes in prop::collection::vec(
                (prop::array::uniform3(0..10i32), prop::array::uniform3(1..8i32), any::<bool>()),
                1..6,
            ),
            points in prop::collection::vec(prop::array::uniform3(0.0..10.0f64), 40),
        ) {
            let stated: Vec<Surface> = boxes
                .iter()
                .map(|(low, size, is_round)| {
                    let (low, size) = (low.map(f64::from), size.map(f64::from));
                    let high = [0, 1, 2].map(|i| (low[i] + size[i]).min(10.0));
                    match is_round {
                        true => rod(low, high[2] - low[2], size[0] / 2.0),
                        false => block(low, high),
                    }
                })
                .collect();
            let regular = voids(&stated);
            for p in points.into_iter().map(Point3::from) {
                prop_assert!(least(&stated, &p) >= 0.0 || least(&regular, &p) < 0.0, "{p} is lost");
                prop_assert!(least(&regular, &p) >= 0.0 || least(&stated, &p) <= TOUCH_DEPTH, "{p} is added");
            }
        }
    }
}
