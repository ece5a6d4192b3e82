//! Outline of a part of a family, as it is seen from any side: an ellipsoid of revolution about y, or a cylinder or a shaft about x.
use nalgebra::Vector3;

use super::top::{Cylinder, DrawnHole, TopView};
use crate::scene::Shape;
use crate::side::Side;
use gcode_lang::units::Deg;

/// Cosine of the angle to the line of sight up to which an axis of revolution points at the reader.
const ALONG: f64 = 0.999;
/// Part of a radius by which an outline of unknown extent reaches beyond its holes.
const BEYOND: f64 = 0.25;
/// Number of chords of the outline of an ellipsoid.
const CHORDS: u32 = 192;

impl TopView {
    /// Returns the outline of the part as a side shows it. Of an ellipsoid it reaches from its upper pole to a little below the
    /// lowest hole, of a shaft a little beyond its holes: where the part ends, is unknown.
    pub(super) fn outlines(&self, side: Side) -> Vec<Shape> {
        let ellipsoid = self.outline.map(|radii| self.ellipsoid(side, radii));
        let cylinder =
            self.cylinder.map(|Cylinder { outer, length, .. }| generators(side, outer, [0.0, length]));
        let shaft = self.shaft.map(|radius| self.shaft_sides(side, radius));
        [ellipsoid, cylinder, shaft].into_iter().flatten().flatten().collect()
    }

    /// Returns the places from which an ellipsoid is seen along its surface: seen along its axis its equator, a circle.
    fn ellipsoid(&self, side: Side, [equator, pole]: [f64; 2]) -> Vec<Shape> {
        let towards = side.towards().normalize();
        if ALONG < towards.y.abs() {
            return vec![Shape::Circle { centre: [0.0, 0.0], radius: equator }];
        }
        let entries = self.holes.iter().filter_map(DrawnHole::shown).map(|hole| hole.entry[1]);
        let lowest = entries.fold(pole, f64::min) - BEYOND * pole;
        // Scaled to a sphere of radius 1, the outline is the great circle across the scaled line of sight.
        let radii = Vector3::new(equator, pole, equator);
        let sight = towards.component_div(&radii).normalize();
        let level = sight.cross(&Vector3::y()).normalize();
        let rise = level.cross(&sight);
        let point = |chord: u32| {
            let angle = Deg(360.0 / f64::from(CHORDS) * f64::from(chord) - 90.0);
            (level * angle.cos() + rise * angle.sin()).component_mul(&radii)
        };
        let high = (0..=CHORDS).map(point).filter(|at| lowest <= at.y);
        vec![Shape::Line(high.map(|at| side.project(at.into())).collect())]
    }

    /// Returns the sides of a shaft of unknown length.
    fn shaft_sides(&self, side: Side, radius: f64) -> Vec<Shape> {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for hole in self.holes.iter().filter_map(DrawnHole::shown) {
            let reach = hole.diameter.unwrap_or(0.0) / 2.0;
            (low, high) = (low.min(hole.entry[0] - reach), high.max(hole.entry[0] + reach));
        }
        if high <= low {
            return Vec::new();
        }
        generators(side, radius, [low - BEYOND * radius, high + BEYOND * radius])
    }
}

/// Returns the two lines along which a cylinder about x ends to the eye, or its circle where x points at the reader.
fn generators(side: Side, radius: f64, [from, to]: [f64; 2]) -> Vec<Shape> {
    let towards = side.towards().normalize();
    if ALONG < towards.x.abs() {
        return vec![Shape::Circle { centre: [0.0, 0.0], radius }];
    }
    let across = towards.cross(&Vector3::x()).normalize() * radius;
    let line = |sign: f64| {
        let end = |x: f64| side.project([x, sign * across.y, sign * across.z]);
        Shape::Line(vec![end(from), end(to)])
    };
    vec![line(1.0), line(-1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Point;
    use gcode_part::Hole;

    fn drawn(entry: [f64; 3]) -> DrawnHole {
        DrawnHole {
            nominal: Some(Hole { entry, diameter: Some(6.0), ..Hole::default() }),
            ..DrawnHole::default()
        }
    }

    fn points(view: &TopView, side: Side) -> Vec<Point> {
        view.outlines(side).iter().flat_map(Shape::points).collect()
    }

    /// The shaft's sides are 60 mm above and below its axis, and 15 mm longer than its holes at each end; seen along its axis it is a
    /// circle. In the isometric view, which is enlarged by √1.5, its sides are 120·√1.5 apart.
    #[test]
    fn a_shaft_has_its_sides_in_every_view() {
        let holes = vec![drawn([10.0, 0.0, 60.0]), drawn([40.0, 0.0, 60.0])];
        let view = TopView { holes, shaft: Some(60.0), ..TopView::default() };
        for side in [Side::Z, Side::Z.front(), Side::Y] {
            let ends = points(&view, side);
            assert_eq!(ends, [[-8.0, 60.0], [58.0, 60.0], [-8.0, -60.0], [58.0, -60.0]], "{side:?}");
        }
        assert_eq!(view.outlines(Side::X), [Shape::Circle { centre: [0.0, 0.0], radius: 60.0 }]);
        let isometric = view.outlines(Side::Z.isometric());
        let [Shape::Line(upper), Shape::Line(lower)] = &isometric[..] else { panic!("{isometric:?}") };
        // Both lines run along the projected x axis.
        let way = [upper[1][0] - upper[0][0], upper[1][1] - upper[0][1]];
        let apart = [upper[0][0] - lower[0][0], upper[0][1] - lower[0][1]];
        let distance = (way[0] * apart[1] - way[1] * apart[0]).abs() / libm::hypot(way[0], way[1]);
        assert!((distance - 120.0 * 1.5f64.sqrt()).abs() < 1e-9, "{distance}");
        assert!((libm::hypot(way[0], way[1]) - 66.0).abs() < 1e-9, "edges along x keep their length");
    }

    /// An ellipsoid of 100 by 50 with its lowest hole at y 30: from the front an arch over the pole that ends 12.5 mm lower, where its
    /// half width is 100·√(1 − 0.35²) = 93.675.
    #[test]
    fn an_ellipsoid_is_an_arch_from_the_front() {
        let view = TopView {
            holes: vec![drawn([80.0, 30.0, 0.0]), drawn([0.0, 50.0, 0.0])],
            outline: Some([100.0, 50.0]),
            ..TopView::default()
        };
        assert_eq!(view.outlines(Side::Y), [Shape::Circle { centre: [0.0, 0.0], radius: 100.0 }]);
        let arch = points(&view, Side::Y.front());
        let highest = arch.iter().map(|point| point[1]).fold(f64::MIN, f64::max);
        assert!((highest - 50.0).abs() < 1e-9, "{highest}");
        for end in [arch[0], arch[arch.len() - 1]] {
            // The last chord ends at most 1/192 of a turn above the end.
            assert!((17.5..17.5 + 50.0 * 0.033).contains(&end[1]), "{end:?}");
        }
        let is_on = |[x, y]: Point| (libm::hypot(x / 100.0, y / 50.0) - 1.0).abs() < 1e-9;
        assert!(arch.iter().all(|point| is_on(*point)) && arch.windows(2).all(|pair| pair[0] != pair[1]));
        // From the right and in the isometric view it is an arch too, whose ends are apart.
        for side in [Side::Y.from_right(), Side::Y.isometric()] {
            let arch = points(&view, side);
            assert!(
                50.0 < libm::hypot(
                    arch[0][0] - arch[arch.len() - 1][0],
                    arch[0][1] - arch[arch.len() - 1][1]
                )
            );
        }
    }
}
