//! Boxes of axes and sides of tools against distances worked out by hand.
use proptest::prelude::*;

use super::*;
use crate::machine::{Chain, Head, HeadKind};
use gcode_part::Surface;

fn at([x, y, z, b]: [f64; 4]) -> Position {
    Position([x, y, z, 0.0, b, 0.0, 0.0, 0.0])
}

fn found(deepest: Deepest) -> Option<DeepPoint> {
    match deepest {
        Deepest::Clear => None,
        Deepest::Metal(point) => Some(point),
        Deepest::Unknown => panic!("given up"),
    }
}

fn deepest(surface: Surface, from: [f64; 4], to: [f64; 4]) -> Option<DeepPoint> {
    let (machine, setup) = (Machine::default(), Setup::default());
    let bodies = |p: &Point3<f64>, _: &Vector3<f64>, each: &mut dyn FnMut(NearestPoint)| {
        each(surface.nearest(p));
        true
    };
    found(AxisBox::new(&machine, &setup, &at(from), &at(to)).deepest(
        &bodies,
        0.01,
        &mut SearchBudget::default(),
    ))
}

#[test]
fn corners_edges_and_the_inside_are_searched() {
    let body = Surface::Ellipsoid { a: 100.0, b: 80.0 };
    // X first: (92, 0), 8 mm below the surface.
    let corner = deepest(body, [102.0, 0.0, 0.0, 0.0], [92.0, 92.0, 0.0, 0.0]).unwrap();
    assert!((corner.depth - 8.0).abs() < 1e-9 && corner.arrived == Some(1), "{corner:?}");
    assert!(deepest(body, [102.0, 0.0, 0.0, 0.0], [100.02, 92.0, 0.0, 0.0]).is_none());
    // No corner is inside, but the edge from (−120, 70) to (120, 70) leads through the axis, 10 mm below the pole.
    let edge = deepest(body, [-120.0, 70.0, 0.0, 0.0], [120.0, 130.0, 0.0, 0.0]).unwrap();
    assert!((edge.depth - 10.0).abs() < 0.01 && edge.arrived.is_none(), "{edge:?}");
    // All twelve edges pass the sphere of 10, and its centre is the middle of the box.
    let sphere = Surface::Ellipsoid { a: 10.0, b: 10.0 };
    let inside = deepest(sphere, [-12.0, -12.0, -12.0, 0.0], [12.0, 12.0, 12.0, 0.0]).unwrap();
    assert!((inside.depth - 10.0).abs() < 0.01, "{inside:?}");
}

/// Half a turn of B while X goes from 150 to 110 past a box to x 100: with B first the tip stands at x −110 on the
/// part, and outside. To x 90 and with B at 90° it is at z −90 … 90, and the box reaches to z 95.
#[test]
fn rotations_are_searched_with_the_slides() {
    let block = Surface::Block { min: Point3::new(-100.0, -5.0, -95.0), max: Point3::new(100.0, 5.0, 95.0) };
    assert!(deepest(block, [160.0, 0.0, 0.0, 0.0], [145.0, 0.0, 0.0, 180.0]).is_none());
    // The corner of the box is 137.9 mm from B's axis.
    let corner = deepest(block, [160.0, 0.0, 0.0, 0.0], [130.0, 0.0, 0.0, 180.0]).unwrap();
    assert!(corner.arrived.is_none() && 1.0 < corner.depth, "{corner:?}");
}

/// A tool of 10 and 40 long over a box of 200 × 10 × 190: at y 9.98 its side is 0.02 mm in the box, and at 10.2 it
/// passes. Its lower end, 3 above the tip, stays above the box if the tip ends at z 93. Its upper end reaches 5 mm into the
/// box if it comes from below.
#[test]
fn the_side_of_a_tool_is_searched() {
    let block = Surface::Block { min: Point3::new(-100.0, -5.0, -95.0), max: Point3::new(100.0, 5.0, 95.0) };
    let machine = Machine {
        head: Head::new(HeadKind::Fixed(Vector3::z_axis()), 0.0),
        table: Chain::default(),
        ..Machine::default()
    };
    let setup = Setup::default();
    let bodies = |p: &Point3<f64>, _: &Vector3<f64>, each: &mut dyn FnMut(NearestPoint)| {
        each(block.nearest(p));
        true
    };
    let side = |from: [f64; 4], to: [f64; 4]| {
        let line = AxisBox::line(&machine, &setup, &at(from), &at(to));
        let tool = ToolPart::flutes(3.0, 40.0, 5.0);
        let is_clear = line.is_clear_by_planes(&[tool], |p| block.nearest(p));
        let deepest = line.with_tool(tool).deepest(&bodies, 0.01, &mut SearchBudget::default());
        (is_clear, found(deepest).map(|point| point.depth))
    };
    let (is_clear, depth) = side([-150.0, 9.98, 50.0, 0.0], [150.0, 9.98, 50.0, 0.0]);
    assert!(!is_clear && (depth.unwrap() - 0.02).abs() < 1e-9, "{depth:?}");
    assert_eq!(side([-150.0, 10.2, 50.0, 0.0], [150.0, 10.2, 50.0, 0.0]).1, None);
    assert_eq!(side([0.0, 20.0, 200.0, 0.0], [0.0, 20.0, -200.0, 0.0]).1, None);
    assert_eq!(side([0.0, 0.0, 150.0, 0.0], [50.0, 4.0, 93.0, 0.0]), (true, None));
    let (_, depth) = side([0.0, 0.0, -150.0, 0.0], [0.0, 0.0, -130.0, 0.0]);
    assert!((depth.unwrap() - 5.0).abs() < 0.01, "{depth:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// If a sampled position of the box is in metal, metal is found.
    #[test]
    fn metal_in_the_box_is_found(
        ends in prop::array::uniform6(-120.0..120.0f64),
        turns in (-30.0..30.0f64, -30.0..30.0f64),
        samples in prop::collection::vec(prop::array::uniform4(0.0..1.0f64), 200),
    ) {
        let body = Surface::Block { min: Point3::new(-60.0, -40.0, -20.0), max: Point3::new(60.0, 40.0, 20.0) };
        let from = [ends[0], ends[1], ends[2], turns.0];
        let to = [ends[3], ends[4], ends[5], turns.1];
        let (machine, setup) = (Machine::default(), Setup::default());
        let bodies = |p: &Point3<f64>, _: &Vector3<f64>, each: &mut dyn FnMut(NearestPoint)| {
            each(body.nearest(p));
            true
        };
        let all = AxisBox::new(&machine, &setup, &at(from), &at(to));
        let mut best = None;
        let root = all.bounded(all.root(), &bodies, 0.01, &mut best);
        let found = found(all.deepest_inside(root, &bodies, 0.01, (best, &mut SearchBudget::default())));
        for t in samples {
            let position = at([0, 1, 2, 3].map(|i| from[i] + (to[i] - from[i]) * t[i]));
            let depth = -body.nearest(&machine.forward(&position, &setup).tip).distance;
            let is_found = found.is_some() || depth <= 0.01 + RESOLUTION + 1e-9;
            prop_assert!(is_found, "{} {:?}", depth, found);
        }
    }
}
