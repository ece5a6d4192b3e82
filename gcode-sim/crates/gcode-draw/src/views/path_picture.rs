//! The picture of a tool path: one or several views with frames, the holes on top, and a legend.
use super::hole_picture::MAX_LABELLED;
use super::path_legend::legend;
use super::path_places::{MAX_PLACES, limits, places, zeros};
use super::path_strokes::{MAX_SWEPT_POINTS, PathDrawer, ShadeScale};
use super::path_view::{Arrangement, PathView, RunKind, StandardView};
use super::stock_outline::stock_outline;
use super::top::{DrawnHole, TopView, hole_mark};
use super::view_frames::{Frames, PlacedView, ViewBox};
use crate::picture::Picture;
use crate::scene::{Mark, Pen, Scene, Stroke};
use nalgebra::Vector3;

/// Cosine of the largest angle between a hole and the line of sight at which the hole is drawn: 60°.
const FACING: f64 = 0.5;

/// Builds the picture of a tool path with the holes of a top view.
pub fn path_picture(view: &TopView, path: &PathView, arrangement: &Arrangement) -> Picture {
    let frames = Frames::of(ViewBox::of(arrangement.top, view, path), arrangement);
    let (letter, sign) = arrangement.top.axis_of_coordinate(2).unwrap_or(('z', 1.0));
    let axis = ['x', 'y', 'z'].iter().position(|name| *name == letter).unwrap_or(2);
    let tools = tool_order(path);
    let shades = ShadeScale::of(path, arrangement.color_by, &frames, |point| point[axis] * sign);
    let drawer = PathDrawer {
        path,
        color_by: arrangement.color_by,
        shades,
        height: (axis, sign),
        tool_order: &tools,
        extent: frames.extent,
    };
    let mut notes = path.notes.clone();
    let mut scene = Scene { zone: view.tolerance, ..Scene::default() };
    let feed_points = path.runs.iter().filter(|run| run.kind == RunKind::Feed).map(|run| run.points.len());
    let is_swept_drawn = feed_points.sum::<usize>() <= MAX_SWEPT_POINTS;
    if !is_swept_drawn && path.tools.iter().any(|tool| tool.swept_width.is_some()) {
        notes.push("swept width not drawn: too many moves".to_owned());
    }
    let (mut is_cut, mut labelled) = (false, vec![false; view.holes.len()]);
    for (index, placed) in frames.views.iter().enumerate() {
        if placed.kind == StandardView::Top && is_swept_drawn {
            let swept = drawer.swept(placed);
            if !swept.is_empty() && drawer.sweeps_across_sight(placed) {
                notes.push("swept width drawn only where the tool is along the line of sight".to_owned());
            }
            scene.strokes.extend(swept);
        }
        let outlines = view.outlines(placed.side).into_iter();
        let outlines = outlines.map(|shape| shape.map(|point| placed.moved(point)));
        scene.strokes.extend(outlines.map(|shape| Stroke::new(Pen::Outline, shape)));
        scene.strokes.extend(path.stock.iter().flat_map(|stock| stock_outline(stock, placed)));
        scene.strokes.extend(frames.strokes(placed));
        let (rapids, cut) = drawer.rapids(placed);
        is_cut |= cut;
        scene.strokes.extend(rapids);
        scene.strokes.extend(drawer.feeds(placed));
        scene.strokes.extend(limits(path, placed));
        if placed.kind != StandardView::Isometric {
            let circles = view.feature_circles(placed.side);
            let moved =
                |stroke: Stroke| Stroke { shape: stroke.shape.map(|point| placed.moved(point)), ..stroke };
            scene.strokes.extend(circles.map(moved));
        }
        scene.strokes.extend(zeros(path, placed, index == 0));
        scene.strokes.extend(places(path, placed, frames.extent, index == 0));
        scene.marks.extend(marks(view, placed, 1 < frames.views.len(), &mut labelled));
    }
    // Of hundreds of holes those out of tolerance keep their numbers.
    if MAX_LABELLED < view.holes.len() {
        let good = scene.marks.iter_mut().filter(|mark| mark.status.is_good());
        good.for_each(|mark| mark.label.clear());
    }
    if is_cut {
        notes.push("rapids beyond the frame are cut off".to_owned());
    }
    if MAX_PLACES < path.places.len() {
        notes.push(format!("the first {MAX_PLACES} of {} stops are marked", path.places.len()));
    }
    let is_faced = |hole: &&DrawnHole| frames.views.iter().any(|placed| faces_view(hole, placed));
    let (all, faced) = (view.holes.len(), view.holes.iter().filter(is_faced).count());
    if faced < all && arrangement.views != [StandardView::Isometric] {
        notes.push(format!("{} of {all} holes have no symbol: they do not face a view", all - faced));
    }
    let is_shown = |tool: usize| frames.views.iter().any(|placed| drawer.shows_feeds(placed, tool));
    let mut cutting = (0..tools.len()).filter(|tool| tools[*tool].is_some()).peekable();
    if view.holes.is_empty() && cutting.peek().is_some() && !cutting.any(&is_shown) {
        notes.push("all feeds run along the line of sight: another --view shows them".to_owned());
    }
    let legend = legend(view, &drawer, &scene, arrangement, (letter, sign), is_shown);
    let mut title = view.title(title_of(arrangement), view.tolerance, None);
    title.lines.extend(notes);
    Picture { title, scene, legend, table: view.table(), ..Picture::default() }
}

/// Returns the names of the views, and the direction of a single one.
fn title_of(arrangement: &Arrangement) -> String {
    match arrangement.views[..] {
        [view] => {
            let side = view.side(arrangement.top).name();
            format!(
                "{} view, seen from {}{side}",
                view.name(),
                if view == StandardView::Isometric { "the " } else { "" }
            )
        }
        _ => {
            let top = arrangement.top.name();
            let name = |(index, view): (usize, &StandardView)| match (view, index) {
                (StandardView::Top, 0) => format!("Top (from {top})"),
                (StandardView::Top, _) => format!("top (from {top})"),
                (_, 0) => view.name().to_owned(),
                (..) => view.name().to_lowercase(),
            };
            let names: Vec<String> = arrangement.views.iter().enumerate().map(name).collect();
            let has_top = arrangement.views.contains(&StandardView::Top);
            let top = if has_top { String::new() } else { format!("; top seen from {top}") };
            format!("{}{top}", names.join(", "))
        }
    }
}

/// Numbers the tools in the order of their first feeds.
fn tool_order(path: &PathView) -> Vec<Option<usize>> {
    let mut order: Vec<Option<usize>> = vec![None; path.tools.len()];
    let mut next = 0;
    for run in path.runs.iter().filter(|run| run.kind == RunKind::Feed) {
        if let Some(place @ None) = order.get_mut(run.tool) {
            *place = Some(next);
            next += 1;
        }
    }
    order
}

/// Returns the marks of the holes: all in the top view, in others those that face the reader. Each has its label in the first view that shows it.
fn marks(view: &TopView, placed: &PlacedView, is_crowded: bool, labelled: &mut [bool]) -> Vec<Mark> {
    let mut marks = Vec::new();
    for (index, hole) in view.holes.iter().enumerate() {
        if !faces_view(hole, placed) {
            continue;
        }
        let Some(mark) = hole_mark(hole, view) else { continue };
        let mut mark = mark.seen_from(placed.side);
        mark.position = placed.moved(mark.position);
        mark.actual = mark.actual.map(|at| placed.moved(at));
        if std::mem::replace(&mut labelled[index], true) {
            mark.label.clear();
            mark.deviation = None;
        } else if is_crowded {
            // Small views have room for the number alone; the table has the rest.
            mark.label.truncate(1);
        }
        marks.push(mark);
    }
    marks
}

/// Returns true if a view has a symbol for a hole.
fn faces_view(hole: &DrawnHole, placed: &PlacedView) -> bool {
    let Some(shown) = hole.shown() else { return false };
    match placed.kind {
        StandardView::Top => true,
        StandardView::Isometric => false,
        StandardView::Front | StandardView::Right => {
            FACING <= Vector3::from(shown.axis).dot(&placed.side.towards()).abs()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::path_view::{ColorBy, DrawnTool, PathPlace, PathRun, RunAxis, TravelLimit};
    use super::*;
    use crate::scene::{HoleStatus, Point, Shape, Sign, Tint};
    use crate::side::{Projection, Side};
    use gcode_part::{Hole, Stock, StockAxis};

    /// A slot of 10 mm along x at z −2 from (0, 0) to (100, 40), reached by a rapid from z 300.
    fn slot() -> PathView {
        let run = |kind, points| PathRun {
            kind,
            tool: 0,
            program: 0,
            feed: 100.0,
            axis: RunAxis::Along(2),
            points,
        };
        PathView {
            points: vec![
                [0.0, 0.0, 300.0],
                [0.0, 0.0, -2.0],
                [0.0, 0.0, -2.0],
                [100.0, 0.0, -2.0],
                [100.0, 40.0, -2.0],
            ],
            runs: vec![run(RunKind::Rapid, 0..2), run(RunKind::Feed, 2..5)],
            tools: vec![DrawnTool { name: "T1 end mill Φ10".to_owned(), swept_width: Some(10.0) }],
            places: vec![PathPlace { sign: Sign::Start, at: [0.0, 0.0, 300.0], label: "start".to_owned() }],
            ..PathView::default()
        }
    }

    fn picture(path: &PathView, views: &[StandardView], projection: Projection) -> Picture {
        let arrangement =
            Arrangement { top: Side::Z, views: views.into(), projection, color_by: ColorBy::Depth };
        path_picture(&TopView::default(), path, &arrangement)
    }

    /// Returns the drawn feeds, without the swept widths.
    fn feeds(picture: &Picture) -> Vec<&Vec<Point>> {
        let is_feed = |stroke: &&Stroke| {
            stroke.pen == Pen::Feed && stroke.style.is_some_and(|style| style.width.is_none())
        };
        let strokes = picture.scene.strokes.iter().filter(is_feed);
        strokes
            .filter_map(|stroke| if let Shape::Line(points) = &stroke.shape { Some(points) } else { None })
            .collect()
    }

    /// The lower rim of an upright cylinder is open to the reader on one side and hidden on the other, each half as long; seen
    /// from the front it is one line.
    #[test]
    fn the_far_half_of_a_cylinders_far_rim_is_dashed() {
        let stock = Stock::Cylinder {
            axis: StockAxis::Z,
            diameter: 80.0,
            from: -20.0,
            to: 0.0,
            pocket: Vec::new(),
            void: Vec::new(),
        };
        let path = PathView { stock: Some(stock), ..slot() };
        let lines = |view, pen| {
            let picture = picture(&path, &[view], Projection::Third);
            let strokes = picture.scene.strokes.into_iter().filter(move |stroke| stroke.pen == pen);
            let points =
                strokes.filter_map(
                    |stroke| if let Shape::Line(points) = stroke.shape { Some(points) } else { None },
                );
            points.collect::<Vec<_>>()
        };
        let [dashed] = &lines(StandardView::Isometric, Pen::Construction)[..] else {
            panic!("one hidden line")
        };
        // Its ends are at the sides of the outline, a diameter apart, which an isometric drawing enlarges by √1.5; all of it is above
        // the line through them: farther off.
        let (first, last) = (dashed[0], dashed[dashed.len() - 1]);
        let middle = dashed[dashed.len() / 2];
        assert!((libm::hypot(first[0] - last[0], first[1] - last[1]) - 80.0 * 1.5f64.sqrt()).abs() < 1e-9);
        assert!(first[1].max(last[1]) < middle[1], "{first:?} {middle:?} {last:?}");
        // Upper rim, half of the lower one, two sides.
        assert_eq!(lines(StandardView::Isometric, Pen::Outline).len(), 4);
        assert_eq!(lines(StandardView::Front, Pen::Construction).len(), 0);
    }

    #[test]
    fn the_top_view_has_the_swept_width_and_the_front_view_has_not() {
        let widths = |view| {
            let picture = picture(&slot(), &[view], Projection::Third);
            picture.scene.strokes.iter().filter_map(|stroke| stroke.style?.width).collect::<Vec<_>>()
        };
        assert_eq!((widths(StandardView::Top), widths(StandardView::Front)), (vec![10.0], vec![]));
    }

    /// A tool along y cuts no band of its width as seen along z; one of unknown direction does.
    #[test]
    fn a_tool_across_the_line_of_sight_sweeps_no_band() {
        let bands = |axis: RunAxis| {
            let mut path = slot();
            path.runs.iter_mut().for_each(|run| run.axis = axis);
            let picture = picture(&path, &[StandardView::Top], Projection::Third);
            picture.scene.strokes.iter().filter_map(|stroke| stroke.style?.width).count()
        };
        let axes = [RunAxis::Along(2), RunAxis::Unknown, RunAxis::Along(1), RunAxis::Oblique];
        assert_eq!(axes.map(bands), [1, 1, 0, 0]);
    }

    /// A probing move along the slot and a feed over it: the probing move is drawn last.
    #[test]
    fn a_probing_move_lies_on_the_feeds() {
        let mut path = slot();
        path.runs.insert(1, PathRun { kind: RunKind::Probe, points: 2..4, ..path.runs[1].clone() });
        let picture = picture(&path, &[StandardView::Top], Projection::Third);
        let is_cut = |stroke: &&Stroke| stroke.style.is_none_or(|style| style.width.is_none());
        let pens = picture.scene.strokes.iter().filter(is_cut).map(|stroke| stroke.pen);
        let pens: Vec<Pen> = pens.filter(|pen| matches!(pen, Pen::Feed | Pen::Probe)).collect();
        assert_eq!(pens.last(), Some(&Pen::Probe), "{pens:?}");
    }

    /// The limit x 104 lies inside the frame, which reaches to 105 + 8.8, and y −20 outside; the limit of x is a point in the
    /// right view.
    #[test]
    fn a_travel_limit_within_the_frame_is_a_line() {
        let limit = |axis, mm| TravelLimit { axis, mm, tool: None };
        let path = PathView { limits: vec![limit(0, 104.0), limit(1, -20.0)], ..slot() };
        let limits = |view| {
            let picture = picture(&path, &[view], Projection::Third);
            picture.scene.strokes.into_iter().filter(|stroke| stroke.pen == Pen::Limit).collect::<Vec<_>>()
        };
        let top = limits(StandardView::Top);
        let Shape::Line(line) = &top[0].shape else { panic!("a line") };
        assert!(
            (top.len(), limits(StandardView::Front).len(), limits(StandardView::Right).len()) == (1, 1, 0)
        );
        // The frame begins 13.8 mm left of x 0.
        assert!((line[0][0] - 117.8).abs() < 1e-9 && (line[1][0] - 117.8).abs() < 1e-9, "{line:?}");
    }

    /// The deepest tip of T1 at z −6 crosses the front and the right view with the tool's name; from above it is no line.
    #[test]
    fn a_travel_limit_of_a_tool_has_its_name() {
        let limit = TravelLimit { axis: 2, mm: -6.0, tool: Some("T1".to_owned()) };
        let path = PathView { limits: vec![limit], ..slot() };
        let named = |view| {
            let picture = picture(&path, &[view], Projection::Third);
            let limits = picture.scene.strokes.into_iter().filter(|stroke| stroke.pen == Pen::Limit);
            limits.map(|stroke| stroke.caption).collect::<Vec<_>>()
        };
        let t1 = vec![Some("T1".to_owned())];
        assert_eq!([named(StandardView::Front), named(StandardView::Right)], [t1.clone(), t1]);
        assert!(named(StandardView::Top).is_empty());
    }

    /// In the front view the rapid from z 300 enters the frame at x 0: there the start is marked, not at a corner. The front
    /// view as the second of two has no mark of it.
    #[test]
    fn a_start_outside_is_marked_where_the_path_enters() {
        let starts = |views: &[StandardView]| {
            let picture = picture(&slot(), views, Projection::Third);
            let sign = |stroke: &Stroke| match stroke.shape {
                Shape::Sign { at, .. } => Some((at, stroke.caption.clone())),
                _ => None,
            };
            picture.scene.strokes.iter().filter_map(sign).collect::<Vec<_>>()
        };
        let front = starts(&[StandardView::Front]);
        // 13.8 mm from the left of the frame, at its top: −2 ± 8.8.
        let [right, up] = front[0].0;
        assert!((right - 13.8).abs() < 1e-9 && (up - 17.6).abs() < 1e-9, "{front:?}");
        assert_eq!(front[0].1.as_deref(), Some("start (outside)"));
        assert_eq!(starts(&[StandardView::Top, StandardView::Front]).len(), 1);
    }

    /// In the third angle the top is above the front, in the first below; both have the same abscissa.
    #[test]
    fn views_are_aligned_as_on_a_drawing() {
        for (projection, is_above) in [(Projection::Third, true), (Projection::First, false)] {
            let picture = picture(&slot(), &[StandardView::Top, StandardView::Front], projection);
            let [top, front] = feeds(&picture)[..] else { panic!("two feeds") };
            assert!((top[0][0] - front[0][0]).abs() < 1e-9 && (top[1][0] - top[0][0] - 100.0).abs() < 1e-9);
            assert_eq!(front[0][1] < top[0][1], is_above, "{projection:?}");
        }
    }

    /// The right view is beside the front view, at the same ordinate, and has y to the right.
    #[test]
    fn the_right_view_is_beside_the_front_view() {
        let picture = picture(&slot(), &[StandardView::Front, StandardView::Right], Projection::Third);
        let [front, right] = feeds(&picture)[..] else { panic!("two feeds") };
        assert!((front[0][1] - right[0][1]).abs() < 1e-9 && front[1][0] < right[0][0]);
        assert!((right[right.len() - 1][0] - right[0][0] - 40.0).abs() < 1e-9, "{right:?}");
    }

    /// The feeds with the radius of the cutter reach from −5 to 105, so that 8 % of 110 mm are added on every side: in the
    /// front view the rapid is cut at −2 + 8.8.
    #[test]
    fn a_rapid_is_cut_at_the_frame() {
        let picture = picture(&slot(), &[StandardView::Front], Projection::Third);
        let rapid = picture.scene.strokes.iter().find(|stroke| stroke.pen == Pen::Rapid).unwrap();
        let Shape::Line(points) = &rapid.shape else { panic!("a line") };
        assert!((points[0][1] - points[1][1] - 8.8).abs() < 1e-9, "{points:?}");
        assert!(picture.title.lines.contains(&"rapids beyond the frame are cut off".to_owned()));
        let named = picture.scene.strokes.iter().filter_map(|stroke| stroke.caption.as_deref());
        assert!(named.into_iter().any(|caption| caption == "start (outside)"));
    }

    /// From z 0 to −8 in four steps of 2 mm: five shades, the deepest the darkest.
    #[test]
    fn deeper_is_darker() {
        let mut path = slot();
        path.points = (0..5)
            .flat_map(|n| {
                [[10.0 * f64::from(n), 0.0], [10.0 * f64::from(n), 30.0]]
                    .map(|[x, y]| [x, y, -2.0 * f64::from(n)])
            })
            .collect();
        path.runs = (0..5).map(|n| PathRun { points: 2 * n..2 * n + 2, ..path.runs[1].clone() }).collect();
        let picture = picture(&path, &[StandardView::Top], Projection::Third);
        let shades = picture.scene.strokes.iter().filter_map(|stroke| match stroke.style?.tint? {
            Tint::Shade(shade) => Some(shade),
            Tint::Class(_) | Tint::Pale => None,
        });
        let shades: Vec<f64> = shades.collect();
        assert!(shades.len() == 5 && shades.windows(2).all(|pair| pair[1] < pair[0]), "{shades:?}");
        assert_eq!((shades[0], shades[4]), (1.0, 0.0));
    }

    /// Of 201 holes one is out of tolerance: it alone has a number. Of 200 all have one.
    #[test]
    fn beyond_200_holes_those_out_of_tolerance_have_numbers() {
        let numbered = |count: usize| {
            let hole = |index: usize| DrawnHole {
                id: index.to_string(),
                status: if index == 7 { HoleStatus::Bad } else { HoleStatus::Good },
                actual: Some(Hole {
                    entry: [index as f64, 0.0, 0.0],
                    axis: [0.0, 0.0, 1.0],
                    ..Hole::default()
                }),
                ..DrawnHole::default()
            };
            let view = TopView { side: Side::Z, holes: (0..count).map(hole).collect(), ..TopView::default() };
            let arrangement = Arrangement {
                top: Side::Z,
                views: vec![StandardView::Top],
                projection: Projection::Third,
                color_by: ColorBy::Depth,
            };
            let marks = path_picture(&view, &slot(), &arrangement).scene.marks;
            marks.iter().filter(|mark| !mark.label.is_empty()).count()
        };
        assert_eq!((numbered(200), numbered(201)), (200, 1));
    }
}
