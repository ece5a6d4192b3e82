//! Tests of removed metal: sweeps, slabs, and the search among them.
use proptest::prelude::*;

use super::*;
use gcode_part::{Surface, Taper};

fn p(x: f64, y: f64, z: f64) -> Point3<f64> {
    Point3::new(x, y, z)
}

fn rest_of(removed: &RemovedMetal, from: Point3<f64>, to: Point3<f64>) -> Vec<[f64; 2]> {
    let mut shares = Shares::default();
    shares.extend([[0.0, 1.0]]);
    removed.first(u32::MAX).uncover(&Strip::line([from, to]), Covers::Certain, &mut shares);
    let mut pieces: Vec<_> =
        shares.pieces().iter().map(|piece| piece.map(|share| (share * 1e6).round() / 1e6)).collect();
    pieces.sort_by(|a, b| a[0].total_cmp(&b[0]));
    pieces
}

/// A mill of 10 feeds from x 0 to x 40 at z −5. A travel of 100 along x at y 0 is covered from −5.01 to 45.01; at y 3
/// from −SQRT[5.01² − 9] = −4.0125; at z −5.02 it is below.
#[test]
fn a_slot_covers_its_width_and_all_above_it() {
    let mut removed = RemovedMetal::new([p(-100.0, -100.0, -20.0), p(100.0, 100.0, 0.0)], Vec::new());
    removed.add([p(0.0, 0.0, -5.0), p(40.0, 0.0, -5.0)], Vector3::z_axis(), &Profile::flat(5.0, true), false);
    for is_closed in [false, true] {
        if is_closed {
            removed.close();
        }
        let along = |y, z| rest_of(&removed, p(-50.0, y, z), p(50.0, y, z));
        assert_eq!(along(0.0, -5.0), [[0.0, 0.4499], [0.9501, 1.0]]);
        assert_eq!(along(0.0, -0.1), [[0.0, 0.4499], [0.9501, 1.0]]);
        assert_eq!(along(3.0, -5.0), [[0.0, 0.459875], [0.940125, 1.0]]);
        assert_eq!(along(0.0, -5.02), [[0.0, 1.0]]);
        assert_eq!(rest_of(&removed, p(40.0, 4.0, 0.0), p(40.0, 4.0, -10.0)), [[0.501, 1.0]]);
    }
}

/// Pecks along one line are one sweep, and a feed back adds none.
#[test]
fn pecks_are_one_sweep() {
    let mut removed = RemovedMetal::new([p(-9.0, -9.0, -50.0), p(9.0, 9.0, 0.0)], Vec::new());
    for depth in 1..=1000 {
        let bottom = f64::from(depth) / -50.0;
        let profile = Profile::flat(3.0, true);
        removed.add([p(1.0, 0.0, bottom + 0.1), p(1.0, 0.0, bottom)], Vector3::z_axis(), &profile, false);
        removed.add([p(1.0, 0.0, bottom), p(1.0, 0.0, 0.0)], Vector3::z_axis(), &profile, false);
    }
    assert_eq!(removed.sweeps.len(), 1);
    assert_eq!(rest_of(&removed, p(3.0, 0.0, 0.0), p(3.0, 0.0, -40.0)), [[0.50025, 1.0]]);
}

/// A thousand steps of 0.05 along a line are one sweep; on a circle of 10 no sweep leaves it by more than 0.01.
#[test]
fn small_steps_along_a_line_are_one_sweep() {
    let profile = Profile::flat(3.0, true);
    let bounds = [p(-99.0, -99.0, -50.0), p(99.0, 99.0, 0.0)];
    let (mut line, mut circle) =
        (RemovedMetal::new(bounds, Vec::new()), RemovedMetal::new(bounds, Vec::new()));
    for step in 0..1000 {
        let at = |step: i32| p(f64::from(step) * 0.05, 0.0, -5.0);
        line.add([at(step), at(step + 1)], Vector3::z_axis(), &profile, false);
        let on = |step: i32| {
            let angle = gcode_lang::units::Deg(f64::from(step) * 0.36);
            p(10.0 * angle.cos(), 10.0 * angle.sin(), -5.0)
        };
        circle.add([on(step), on(step + 1)], Vector3::z_axis(), &profile, false);
    }
    assert_eq!(line.sweeps.len(), 1);
    assert_eq!(rest_of(&line, p(-10.0, 0.0, -1.0), p(90.0, 0.0, -1.0)), [[0.0, 0.0699], [0.6301, 1.0]]);
    let inner = |sweep: &Sweep| nalgebra::center(&sweep.from, &sweep.to).coords.xy().norm();
    let least = circle.sweeps.iter().map(inner).fold(f64::INFINITY, f64::min);
    assert!((9.99..10.0).contains(&least) && circle.sweeps.len() < 500, "{least} {}", circle.sweeps.len());
}

proptest! {
    /// Boxes, slabs and recent sweeps change nothing: what is left of a line is what a search of all sweeps leaves.
    #[test]
    fn indexed_sweeps_leave_what_a_plain_search_leaves(
        passes in prop::collection::vec(
            (prop::sample::select(vec![0, 0, 0, 1, 2]), -30.0..30.0f64, -30.0..30.0f64, 0..3u32), 1..60),
        step in 0.5..7.0f64,
        lines in prop::collection::vec(prop::array::uniform6(-45.0..45.0f64), 8),
        first in 0..60usize,
    ) {
        let mut removed = RemovedMetal::new([p(-50.0, -50.0, -20.0), p(50.0, 50.0, 0.0)], Vec::new());
        let mut at = p(-30.0, -30.0, -5.0);
        for (kind, x, y, depth) in passes {
            let height = -5.0 - f64::from(depth / 2);
            let to = match kind {
                // To and fro, with a step between the passes.
                0 => p(-at.x.signum() * 30.0 + x / 10.0, at.y, height),
                1 => p(x, y, height),
                _ => p(at.x, y, -1.0),
            };
            let mut tool = Profile::flat(3.0, depth != 1);
            if depth == 1 {
                // Flutes that end below the surface.
                tool.parts = vec![ToolPart::flutes(0.0, 3.0, 3.0)];
            }
            removed.add([at, to], Vector3::z_axis(), &tool, false);
            at = if kind == 0 { p(to.x, to.y + step, to.z) } else { to };
        }
        let count = first.min(removed.sweeps.len());
        for [a, b, c, d, e, f] in lines {
            let line = [p(a, b, c / 5.0), p(d, e, f / 5.0)];
            for (count, covers) in
                [(count, Covers::Certain), (usize::MAX, Covers::Kept), (usize::MAX, Covers::All)]
            {
                let (mut indexed, mut plain) = (Shares::default(), Shares::default());
                // What is above the metal is no share of it.
                let in_metal = Surface::Block { min: removed.bounds[0], max: removed.bounds[1] };
                indexed.extend(in_metal.piece(&line[0], &line[1], 0.0));
                plain.extend(in_metal.piece(&line[0], &line[1], 0.0));
                removed.first(count as u32).uncover(&Strip::line(line), covers, &mut indexed);
                for sweep in removed.sweeps.iter().take(count) {
                    let profile = &removed.profiles[sweep.profile as usize];
                    for part in profile.parts.iter().filter(|_| profile.is_certain || covers == Covers::All) {
                        plain.take_away(sweep.covered(part, &line));
                    }
                }
                let sorted = |shares: &Shares| {
                    let mut pieces = shares.pieces().to_vec();
                    pieces.sort_by(|a, b| a[0].total_cmp(&b[0]));
                    pieces
                };
                prop_assert_eq!(sorted(&indexed), sorted(&plain));
            }
        }
    }

    /// A point is covered if and only if some position of the tool holds it.
    #[test]
    fn the_rest_is_what_no_position_of_the_tool_holds(
        ends in prop::array::uniform6(-10.0..10.0f64),
        travel in prop::array::uniform6(-15.0..15.0f64),
        direction in prop::array::uniform3(-1.0..1.0f64),
        (radius, low, length) in (0.5..5.0f64, 0.0..3.0f64, 0.5..8.0f64),
        slope in prop::sample::select(vec![0.0, 0.0, 0.6, 1.0, 2.7]),
    ) {
        let axis = Unit::try_new(Vector3::from(direction), 0.1);
        prop_assume!(axis.is_some());
        let axis = axis.unwrap();
        let (from, to) = (p(ends[0], ends[1], ends[2]), p(ends[3], ends[4], ends[5]));
        // A cone has its tip at the lower end and a cylinder on it.
        let cylinder = ToolPart::flutes(low + length, low + 2.0 * length, slope * length);
        let cone = ToolPart {
            taper: Taper { radius: -slope * low, slope },
            ..ToolPart::flutes(low, low + length, 0.0)
        };
        let parts = if slope == 0.0 { vec![ToolPart::flutes(low, low + length, radius)] } else { vec![cone, cylinder] };
        let sweep = Sweep { from, to, axis, profile: 0, has_scratched: false };
        let (a, b) = (p(travel[0], travel[1], travel[2]), p(travel[3], travel[4], travel[5]));
        let covered: Vec<_> = parts.iter().filter_map(|part| sweep.covered(part, &[a, b])).collect();
        for s in 0..=50 {
            let s = f64::from(s) / 50.0;
            let q = a + (b - a) * s;
            let excess = |t: f64| {
                let to_q = q - (from + (to - from) * t);
                let height = to_q.dot(&axis);
                let aside = (to_q - axis.into_inner() * height).norm();
                let of_part = |part: &ToolPart| {
                    let beside = (aside - part.taper.at(height)) / libm::hypot(1.0, part.taper.slope);
                    beside.max(aside - part.radius()).max(part.from - height).max(height - part.to)
                };
                parts.iter().map(of_part).fold(f64::INFINITY, f64::min)
            };
            let least = (0..=1000).map(|t| excess(f64::from(t) / 1000.0)).fold(f64::INFINITY, f64::min);
            let is_covered = covered.iter().any(|[first, last]| *first <= s && s <= *last);
            prop_assert!(!is_covered || least < TOUCH_DEPTH + 0.02, "{} {}", s, least);
            prop_assert!(is_covered || least > TOUCH_DEPTH - 1e-6, "{} {}", s, least);
        }
    }
}
