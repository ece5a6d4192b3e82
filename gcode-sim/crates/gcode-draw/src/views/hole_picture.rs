//! The picture of holes alone: their symbols, the part's outline or a frame with coordinates, and a legend.
use nalgebra::Vector3;

use super::path_places::zeros;
use super::path_view::PathView;
use super::purpose::PicturePurpose;
use super::top::{DrawnHole, TopView, hole_mark, number_few, signed};
use super::view_frames::Frames;
use crate::picture::{LegendItem, Picture, Sample};
use crate::scene::{Axis, Mark, Pen, Point, Scene, Shape, Sign, Stroke};
use crate::side::Side;
use gcode_part::Hole;

/// Legend texts of tool paths.
const PATHS: [(Pen, &str); 5] = [
    (Pen::Feed, "tool path, feed"),
    (Pen::Rapid, "tool path, rapid"),
    (Pen::Unchanged, "unchanged cut"),
    (Pen::New, "changed cut, new"),
    (Pen::Old, "changed cut, old"),
];

/// Number of holes beyond which good ones have no number.
pub(super) const MAX_LABELLED: usize = 200;

/// Largest number of construction circles; more would hide the holes.
const MAX_CIRCLES: usize = 12;

/// Builds the picture of a top view.
pub fn top_view(view: &TopView) -> Picture {
    let (near, far): (Vec<_>, Vec<_>) = view.holes.iter().partition(|hole| faces_reader(hole, view));
    let unit = [("x", [1.0, 0.0, 0.0]), ("y", [0.0, 1.0, 0.0]), ("z", [0.0, 0.0, 1.0])];
    // The part of a family has its own axes; others have a frame with coordinates.
    let is_framed = view.outline.is_none() && view.cylinder.is_none() && !view.holes.is_empty();
    let is_framed = is_framed && view.purpose == PicturePurpose::Verdict;
    let is_empty = view.outline.is_none() && view.holes.is_empty() && view.path.is_empty();
    let axes = unit.map(|(name, direction)| Axis { name: name.to_owned(), direction });
    let part = Scene {
        axes: if is_framed || is_empty { Vec::new() } else { axes.into() },
        strokes: view.path.clone(),
        marks: near.into_iter().filter_map(|hole| hole_mark(hole, view)).collect(),
        zone: view.tolerance,
    };
    let mut scene = part.seen_from(view.side);
    // Of thousands of holes few would have a number, each on a leader.
    let is_dense = MAX_LABELLED < scene.marks.len();
    if view.cylinder.is_some() || view.purpose == PicturePurpose::Change || is_dense {
        number_few(&mut scene.marks);
    }
    scene.strokes.extend(view.feature_circles(view.side));
    if view.side == Side::Y {
        scene.strokes.extend(circles(&view.holes));
    }
    let outlines = view.outlines(view.side).into_iter();
    scene.strokes.extend(outlines.map(|shape| Stroke::new(Pen::Outline, shape)));
    if is_framed {
        let construction = scene.strokes.iter().filter(|stroke| stroke.pen == Pen::Construction);
        let corners: Vec<Point> = construction.flat_map(|stroke| stroke.shape.points()).collect();
        scene.strokes.extend(framed(view, &corners));
    }
    let hidden = (!far.is_empty()).then(|| match far.len() {
        1 => "1 hole on the far side not drawn".to_owned(),
        count => format!("{count} holes on the far side not drawn"),
    });
    let what = format!("Top view, seen from {}", view.side.name());
    let position = view.tolerance.filter(|_| view.purpose == PicturePurpose::Verdict);
    let legend = legend(view, &scene);
    Picture {
        title: view.title(what, position, hidden),
        scene,
        legend,
        table: view.table(),
        ..Picture::default()
    }
}

/// Draws the frame with its scales, and the work zeros in it; the frame encloses the holes and the points given.
fn framed(view: &TopView, corners: &[Point]) -> Vec<Stroke> {
    let path = PathView { zeros: view.zeros.clone(), ..PathView::default() };
    let frames = Frames::in_place(view, &path, corners);
    let draw = |placed| frames.strokes(placed).into_iter().chain(zeros(&path, placed, true));
    frames.views.iter().flat_map(draw).collect()
}

/// Returns false for holes on the far side of a cylinder.
fn faces_reader(hole: &DrawnHole, view: &TopView) -> bool {
    let away = |hole: &Hole| Vector3::from(hole.axis).dot(&view.side.towards()) < -1e-6;
    view.cylinder.is_none() || !hole.shown().is_some_and(away)
}

/// Returns the circles on which holes lie, with their radii; radii less than 0.05 mm apart are merged.
fn circles(holes: &[DrawnHole]) -> Vec<Stroke> {
    let any_nominal = holes.iter().any(|hole| hole.nominal.is_some());
    let of = |hole: &DrawnHole| {
        let [x, _, z] = if any_nominal { hole.nominal.as_ref() } else { hole.actual.as_ref() }?.entry;
        Some(libm::hypot(x, z))
    };
    let mut radii: Vec<f64> = holes.iter().filter_map(of).collect();
    radii.sort_by(f64::total_cmp);
    radii.dedup_by(|a, b| (*a - *b).abs() < 0.05);
    radii.retain(|r| 1e-3 < *r);
    if MAX_CIRCLES < radii.len() {
        return Vec::new();
    }
    let circle = |radius: f64| Stroke {
        caption: Some(format!("r {}", signed(radius, 2))),
        ..Stroke::new(Pen::Construction, Shape::Circle { centre: [0.0, 0.0], radius })
    };
    radii.into_iter().map(circle).collect()
}

fn legend(view: &TopView, scene: &Scene) -> Vec<LegendItem> {
    let has_axis = |mark: &Mark| mark.direction.is_some_and(|d| 0.02 < libm::hypot(d[0], d[1]));
    let has_pen = |pen: Pen| scene.strokes.iter().any(|stroke| stroke.pen == pen);
    let has_zero = scene.strokes.iter().any(|stroke| matches!(stroke.shape, Shape::Zero(_)));
    let is_alarm = |stroke: &Stroke| matches!(stroke.shape, Shape::Sign { sign: Sign::Alarm, .. });
    let has_alarm = scene.strokes.iter().any(is_alarm);
    let is_nominal = view.holes.iter().any(|hole| hole.nominal.is_some());
    let radius = if is_nominal { "radius r, mm" } else { "radius r where the feed begins, mm" };
    let others = [
        (scene.marks.iter().any(has_axis), Sample::Direction, "hole axis, outwards"),
        (
            scene.marks.iter().any(|mark| mark.actual.is_some()),
            Sample::Displacement,
            view.purpose.displacement_label(),
        ),
        (has_pen(Pen::Thread), Sample::Pen(Pen::Thread), "thread"),
        (has_pen(Pen::Outline), Sample::Pen(Pen::Outline), "part outline"),
        (has_zero, Sample::Zero, "work zero"),
        (has_alarm, Sample::Sign(Sign::Alarm), "where a run stopped"),
        (has_pen(Pen::Construction), Sample::Pen(Pen::Construction), radius),
    ];
    let paths = PATHS.map(|(pen, text)| (has_pen(pen), Sample::Pen(pen), text));
    let drawn = others.into_iter().chain(paths).filter(|(is_drawn, ..)| *is_drawn);
    let items = view.status_legend(&scene.marks).into_iter();
    items.chain(drawn.map(|(_, sample, text)| LegendItem::new(sample, text))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{HoleStatus, ZoneDeviation};
    use crate::side::deviation;

    fn hole(entry: [f64; 3], axis: [f64; 3]) -> Hole {
        Hole { id: None, entry, axis, depth: 15.0, diameter: Some(6.0), ..Hole::default() }
    }

    fn seen(nominal: &Hole, found: &Hole) -> ZoneDeviation {
        Side::Y.zone_deviation(nominal.axis, deviation(nominal, found).unwrap())
    }

    #[test]
    fn the_view_from_above_has_z_downwards() {
        let hole = Some(hole([0.0, 9.0, 5.0], [0.0, 1.0, 0.0]));
        let holes = vec![DrawnHole {
            id: "1".to_owned(),
            nominal: hole.clone(),
            actual: hole,
            status: HoleStatus::Good,
            position_deviation: Some(0.02),
            rotary_angle: Some(-72.0),
            ..DrawnHole::default()
        }];
        let view = TopView { holes, rotary: "B".to_owned(), outline: Some([10.0; 2]), ..TopView::default() };
        let scene = top_view(&view).scene;
        assert_eq!(scene.marks[0].position, [0.0, -5.0]);
        assert_eq!(scene.marks[0].label, ["1", "B −72°", "Φ0.020"]);
        assert_eq!(scene.axes[1].direction, [0.0, -1.0]);
    }

    /// Two holes of 6 at x 10 and 110 in a plate seen along z, and zero near them. A part with an outline has its axes instead.
    #[test]
    fn holes_without_an_outline_have_a_frame_with_coordinates_and_the_work_zero() {
        let drawn =
            |x: f64| DrawnHole { actual: Some(hole([x, 0.0, 0.0], [0.0, 0.0, 1.0])), ..DrawnHole::default() };
        let holes = vec![drawn(10.0), drawn(110.0)];
        let zeros = vec![("G54".to_owned(), [0.0; 3])];
        let view = TopView { holes, zeros, side: Side::Z, ..TopView::default() };
        let of = |view: &TopView| {
            let scene = top_view(view).scene;
            let frame = scene.strokes.iter().find_map(|stroke| match &stroke.shape {
                Shape::Line(points) if stroke.pen == Pen::Scale => Some(points.clone()),
                _ => None,
            });
            let names = scene.strokes.iter().filter(|stroke| stroke.pen == Pen::Ruler);
            let names: Vec<String> = names.filter_map(|stroke| stroke.caption.clone()).collect();
            let has_zero = scene.strokes.iter().any(|stroke| stroke.shape == Shape::Zero([0.0, 0.0]));
            (frame, names, has_zero, scene.axes.len())
        };
        let (frame, names, has_zero, axes) = of(&view);
        let frame = frame.unwrap();
        // From zero, which the frame holds, to 113, and 8 % of 113 mm.
        assert!((frame[0][0] + 9.04).abs() < 1e-9 && (frame[1][0] - 122.04).abs() < 1e-9, "{frame:?}");
        assert!(
            has_zero
                && axes == 0
                && ["x", "y", "0", "20", "100"].iter().all(|name| names.contains(&(*name).to_owned())),
            "{names:?}"
        );
        let (frame, _, has_zero, axes) = of(&TopView { outline: Some([200.0; 2]), ..view });
        assert_eq!((frame, has_zero, axes), (None, false, 2));
    }

    #[test]
    fn an_axial_hole_shows_its_deviation_unchanged() {
        let up = [0.0, 1.0, 0.0];
        let deviation = seen(&hole([420.0, 675.0, 0.0], up), &hole([420.03, 677.0, 0.04], up));
        for end in [deviation.entry, deviation.bottom] {
            assert!((end[0] - 0.03).abs() < 1e-9 && (end[1] + 0.04).abs() < 1e-9, "{deviation:?}");
        }
    }

    /// A hole tilted 60° outwards to +x: 0.05 mm along its own meridian projects to 0.025 mm and is drawn as
    /// 0.05 mm.
    #[test]
    fn a_steep_hole_keeps_the_length_of_its_deviation() {
        let axis = [0.75f64.sqrt(), 0.5, 0.0];
        let down_the_meridian = [0.5 * 0.05, -(0.75f64.sqrt()) * 0.05, 0.0];
        let found = hole([1000.0 + down_the_meridian[0], 300.0 + down_the_meridian[1], 0.0], axis);
        let deviation = seen(&hole([1000.0, 300.0, 0.0], axis), &found);
        assert!((deviation.entry[0] - 0.05).abs() < 1e-9 && deviation.entry[1].abs() < 1e-9, "{deviation:?}");
    }

    /// Tilted by 0.3° about its entry: at 15 mm depth that is 15·tan 0.3° = 0.0785 mm, to the other side.
    #[test]
    fn a_tilted_hole_is_off_at_its_bottom() {
        let tilt = gcode_lang::units::Deg(0.3);
        let found = hole([420.0, 675.0, 0.0], [tilt.sin(), tilt.cos(), 0.0]);
        let deviation = seen(&hole([420.0, 675.0, 0.0], [0.0, 1.0, 0.0]), &found);
        assert!(libm::hypot(deviation.entry[0], deviation.entry[1]) < 1e-9);
        assert!((deviation.bottom[0] + 15.0 * tilt.tan()).abs() < 1e-9, "{deviation:?}");
    }
}
