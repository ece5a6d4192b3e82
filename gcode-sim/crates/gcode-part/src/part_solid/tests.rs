//! Distances and contacts on plates, tubes and bores, worked out by hand, and random solids against sampled boundaries.
use nalgebra::{Point3, Unit, Vector3};
use proptest::prelude::*;

use super::*;
use crate::solid::Rod;

fn block(min: [f64; 3], max: [f64; 3]) -> Surface {
    Surface::Block { min: Point3::from(min), max: Point3::from(max) }
}

fn rod(base: [f64; 3], axis: [f64; 3], length: f64, radius: f64) -> Surface {
    let axis = Unit::new_normalize(Vector3::from(axis));
    Surface::Rod(Rod { base: Point3::from(base), axis, length, radius })
}

fn solid(body: Surface, voids: &[Surface]) -> PartSolid {
    PartSolid::new(body, voids.to_vec()).unwrap()
}

/// A plate of 120 × 80 × 20 with a bore Φ40 through it about x 60, y 40, and a slot 10 wide and 5 deep from x 100 to its end.
fn plate() -> PartSolid {
    let bore = rod([60.0, 40.0, -20.0], [0.0, 0.0, 1.0], 20.0, 20.0);
    let slot = block([100.0, 35.0, -5.0], [120.0, 45.0, 0.0]);
    solid(block([0.0, 0.0, -20.0], [120.0, 80.0, 0.0]), &[bore, slot])
}

/// A tube Φ120 with a bore Φ100 from x 0 to 180.
fn tube() -> PartSolid {
    let along = |length, radius| rod([0.0; 3], [1.0, 0.0, 0.0], length, radius);
    solid(along(180.0, 60.0), &[along(180.0, 50.0)])
}

/// In the bore the wall is as far as the radius leaves; above it the rim, √(20² + 5²) from the axis and √(3² + 4²) from a point 3
/// off it. Above the middle of the slot its floor is 7 and its edges √(5² + 2²) away.
#[test]
fn distances_of_walls_rims_and_floors_are_those_worked_out_by_hand() {
    let (plate, tube) = (plate(), tube());
    let rim = |off: f64, above: f64| libm::hypot(off, above);
    for (solid, p, distance) in [
        (&plate, [60.0, 40.0, -10.0], 20.0),
        (&plate, [67.0, 40.0, -10.0], 13.0),
        (&plate, [60.0, 40.0, 5.0], rim(20.0, 5.0)),
        (&plate, [77.0, 40.0, 4.0], rim(3.0, 4.0)),
        (&plate, [60.0, 40.0, -26.0], rim(20.0, 6.0)),
        (&plate, [60.0, 40.0, -0.001], 20.0),
        (&plate, [60.0, 40.0, 0.0], 20.0),
        (&plate, [81.5, 40.0, -10.0], -1.5),
        (&plate, [110.0, 40.0, 2.0], rim(5.0, 2.0)),
        (&plate, [110.0, 40.0, -3.0], 2.0),
        (&plate, [110.0, 44.0, -3.0], 1.0),
        (&plate, [123.0, 40.0, -1.0], 5.0),
        (&plate, [90.0, 40.0, 3.0], 3.0),
        (&plate, [110.0, 60.0, -1.0], -1.0),
        (&plate, [124.0, 83.0, -4.0], 5.0),
        (&tube, [90.0, 0.0, 0.0], 50.0),
        (&tube, [90.0, 0.0, 48.0], 2.0),
        (&tube, [90.0, 53.0, 0.0], -3.0),
        (&tube, [-4.0, 0.0, 47.0], 5.0),
        (&tube, [-4.0, 0.0, 0.0], rim(50.0, 4.0)),
        (&tube, [-4.0, 55.0, 0.0], 4.0),
        (&tube, [183.0, 0.0, 64.0], 5.0),
    ] {
        let found = solid.nearest(&Point3::from(p));
        assert!((found.distance - distance).abs() < 1e-7, "{p:?}: {found:?} is not {distance}");
    }
    let rim = plate.nearest(&Point3::new(77.0, 40.0, 4.0)).normal;
    assert!((rim.into_inner() - Vector3::new(-0.6, 0.0, 0.8)).norm() < 1e-7, "{rim:?}");
}

/// Returns the length of the way at which a ball of radius 3 touches.
fn touch(solid: &PartSolid, from: [f64; 3], to: [f64; 3]) -> Option<f64> {
    let (from, to) = (Point3::from(from), Point3::from(to));
    Some(solid.contact_between(&from, &to, 3.0)? * (to - from).norm())
}

#[test]
fn a_ball_touches_walls_edges_and_ends_where_the_drawing_says() {
    let (plate, tube) = (plate(), tube());
    let expected = [
        // The top from 10 above; the bore's wall both ways in x and y: 20 − 3.
        (&plate, [20.0, 40.0, 10.0], [20.0, 40.0, -10.0], Some(7.0)),
        (&plate, [60.0, 40.0, -10.0], [100.0, 40.0, -10.0], Some(17.0)),
        (&plate, [60.0, 40.0, -10.0], [20.0, 40.0, -10.0], Some(17.0)),
        (&plate, [60.0, 40.0, -10.0], [60.0, 70.0, -10.0], Some(17.0)),
        (&plate, [60.0, 40.0, -10.0], [60.0, 10.0, -10.0], Some(17.0)),
        // Off the axis by 8 the centre moves on the circle of 17: √(17² − 8²) = 15.
        (&plate, [60.0, 48.0, -10.0], [90.0, 48.0, -10.0], Some(15.0)),
        // Down the bore, and to the end of it.
        (&plate, [60.0, 40.0, 10.0], [60.0, 40.0, -40.0], None),
        (&plate, [76.9, 40.0, 10.0], [76.9, 40.0, -40.0], None),
        // 1.8 inside the rim: the centre stops √(3² − 1.8²) = 2.4 above the top.
        (&plate, [78.2, 40.0, 10.0], [78.2, 40.0, -40.0], Some(7.6)),
        // The floor of the slot, and its end.
        (&plate, [110.0, 40.0, 10.0], [110.0, 40.0, -10.0], Some(12.0)),
        (&plate, [130.0, 40.0, -1.0], [90.0, 40.0, -1.0], Some(27.0)),
        // The corner of the plate at 45° in the plane of its top: 3 before the edge.
        (&plate, [-10.0, -10.0, -5.0], [10.0, 10.0, -5.0], Some(200.0_f64.sqrt() - 3.0)),
        // Beside the plate, and 0.1 above it.
        (&plate, [-10.0, -3.01, -5.0], [130.0, -3.01, -5.0], None),
        (&plate, [-10.0, 40.0, 3.1], [130.0, 40.0, 3.1], None),
        (&plate, [-10.0, 20.0, 2.9], [130.0, 20.0, 2.9], Some(10.0 - (9.0_f64 - 2.9 * 2.9).sqrt())),
        // Past the end of the tube; its end face; its bore both ways.
        (&tube, [-30.0, 0.0, 100.0], [-30.0, 0.0, 0.0], None),
        (&tube, [-30.0, 0.0, 55.0], [10.0, 0.0, 55.0], Some(27.0)),
        (&tube, [-30.0, 0.0, 46.9], [210.0, 0.0, 46.9], None),
        (&tube, [60.0, 0.0, 0.0], [60.0, 60.0, 0.0], Some(47.0)),
        (&tube, [60.0, 0.0, 0.0], [60.0, -60.0, 0.0], Some(47.0)),
        (&tube, [210.0, 0.0, -55.0], [170.0, 0.0, -55.0], Some(27.0)),
        (&tube, [90.0, 0.0, 70.0], [90.0, 0.0, 40.0], Some(7.0)),
    ];
    for (solid, from, to, length) in expected {
        let found = touch(solid, from, to);
        let agrees = match (found, length) {
            (Some(found), Some(length)) => (found - length).abs() < 1e-6,
            (found, length) => found == length,
        };
        assert!(agrees, "{from:?} to {to:?}: {found:?} is not {length:?}");
    }
}

/// A ball at the wall of the bore leaves it, and finds the other wall 34 away; towards the wall it signals at once. Along the wall it
/// moves freely.
#[test]
fn a_ball_at_a_wall_leaves_freely_and_reaches_the_opposite_one() {
    let plate = plate();
    for x in [77.0, 77.0004] {
        let to_other = touch(&plate, [x, 40.0, -10.0], [40.0, 40.0, -10.0]);
        assert!(to_other.is_some_and(|length| (length - (x - 43.0)).abs() < 1e-6), "{to_other:?}");
        assert_eq!(touch(&plate, [x, 40.0, -10.0], [60.0, 40.0, -10.0]), None);
        assert_eq!(touch(&plate, [x, 40.0, -10.0], [x, 40.0, -15.0]), None);
    }
    assert_eq!(touch(&plate, [77.0004, 40.0, -10.0], [90.0, 40.0, -10.0]), Some(0.0));
}

/// Two voids that touch are one, and where a void ends at a face no skin covers it.
#[test]
fn no_skin_remains_between_voids_that_touch() {
    let halves = [block([-5.0, -5.0, -10.0], [5.0, 5.0, -4.0]), block([-5.0, -5.0, -4.0], [5.0, 5.0, 0.0])];
    let body = block([-20.0, -20.0, -10.0], [20.0, 20.0, 0.0]);
    let solid = solid(body, &halves);
    assert!((solid.nearest(&Point3::new(0.0, 0.0, -4.0)).distance - 5.0).abs() < 1e-7);
    assert_eq!(touch(&solid, [0.0, 0.0, 20.0], [0.0, 0.0, -30.0]), None);
}

/// The travel crosses the bore 10 above the floor of a pocket in it, and a rib between two slots is nearest above the rib.
#[test]
fn the_nearest_place_of_a_travel_is_found_behind_a_wider_gap() {
    let body = block([0.0, 0.0, -20.0], [100.0, 20.0, 0.0]);
    let slots =
        [block([-1.0, -1.0, -10.0], [60.0, 21.0, 0.0]), block([62.0, -1.0, -10.0], [101.0, 21.0, 0.0])];
    let solid = solid(body, &slots);
    let (from, to) = (Point3::new(5.0, 10.0, 1.0), Point3::new(95.0, 10.0, 1.0));
    let at = solid.nearest_between(&from, &to) * 90.0 + 5.0;
    assert!((60.0..=62.0).contains(&at), "{at}");
    assert!((touch(&solid, from.into(), to.into()).unwrap() - (55.0 - 8.0_f64.sqrt())).abs() < 1e-6);
}

fn random_voids() -> impl Strategy<Value = Vec<Surface>> {
    let block = (prop::array::uniform3(-25.0..20.0f64), prop::array::uniform3(2.0..25.0f64))
        .prop_map(|(min, size)| block(min, [0, 1, 2].map(|i| min[i] + size[i])));
    let rod = (
        prop::array::uniform3(-25.0..25.0f64),
        prop::array::uniform3(-1.0..1.0f64),
        2.0..40.0f64,
        1.0..9.0f64,
    )
        .prop_filter("a direction", |(_, axis, ..)| Vector3::from(*axis).norm() > 0.1)
        .prop_map(|(base, axis, length, radius)| rod(base, axis, length, radius));
    prop::collection::vec(prop_oneof![block, rod], 1..4)
}

fn random_solid() -> impl Strategy<Value = PartSolid> {
    let body = prop_oneof![
        Just(block([-20.0, -15.0, -10.0], [20.0, 15.0, 10.0])),
        Just(rod([-20.0, 0.0, 0.0], [1.0, 0.0, 0.0], 40.0, 15.0)),
    ];
    (body, random_voids()).prop_map(|(body, voids)| solid(body, &voids))
}

/// Returns points of the metal that lie on every face, on a grid of its lines.
fn points_of_metal(solid: &PartSolid) -> Vec<Point3<f64>> {
    let bodies = solid.voids().iter().map(|void| (*void, SKIN)).chain([(solid.body(), -SKIN)]);
    let faces = bodies.flat_map(|(body, by)| Face::all(&body, by, &Point3::new(1.0, 2.0, 3.0)));
    let points = faces.flat_map(|face| face.grid(40));
    points.filter(|p| solid.is_metal(p)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// No point of the metal is nearer, and that which is found is metal; a random sample of the surface is nearly reached.
    #[test]
    fn the_distance_is_that_of_the_nearest_sample_of_the_surface(
        solid in random_solid(),
        points in prop::collection::vec(prop::array::uniform3(-40.0..40.0f64), 6),
    ) {
        let metal = points_of_metal(&solid);
        prop_assume!(metal.len() > 50);
        for p in points.into_iter().map(Point3::from) {
            let found = solid.nearest(&p);
            let least = metal.iter().map(|q| (p - q).norm()).fold(f64::INFINITY, f64::min);
            prop_assert!(found.distance <= least + 1e-6, "{p}: {found:?}, a sample is {least} away");
            // The foot lies on the surface: just behind it is metal, unless it is a sharp edge, and it is in no void.
            let foot = p - found.normal.into_inner() * found.distance;
            prop_assert!(solid.body().nearest(&foot).distance < 1e-6);
            prop_assert!(solid.voids().iter().all(|void| -1e-6 < void.nearest(&foot).distance));
            if found.distance < 0.0 {
                prop_assert!(solid.is_metal(&p));
            }
        }
    }

    /// A ball in contact has its centre the radius away from the metal, and is nowhere deeper on its way there.
    #[test]
    fn a_ball_stops_where_it_touches_and_not_before(
        solid in random_solid(),
        (from, to) in (prop::array::uniform3(-40.0..40.0f64), prop::array::uniform3(-40.0..40.0f64)),
        radius in 0.1..5.0f64,
    ) {
        let (from, to) = (Point3::from(from), Point3::from(to));
        prop_assume!(solid.nearest(&from).distance > radius + 0.01 && (to - from).norm() > 1.0);
        let found = solid.contact_between(&from, &to, radius);
        let distance = |t: f64| solid.nearest(&(from + (to - from) * t)).distance;
        if let Some(t) = found {
            prop_assert!((distance(t) - radius).abs() < 1e-6, "{}", distance(t));
        }
        for n in 0..100 {
            let t = found.unwrap_or(1.0) * f64::from(n) / 100.0;
            prop_assert!(radius < distance(t) + 1e-6, "at {t} of {found:?}: {}", distance(t));
        }
    }
}
