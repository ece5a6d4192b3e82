//! Places on a tool path: start, end, stops, alarm, work zeros, and travel limits.
use super::path_strokes::clipped;
use super::path_view::{PathPlace, PathView, StandardView, TravelLimit};
use super::view_frames::PlacedView;
use crate::scene::{Pen, Point, Shape, Sign, Stroke};

/// Largest number of places with a symbol.
pub(super) const MAX_PLACES: usize = 40;
/// Distance at which places share one symbol, in parts of the extent of the views.
const SAME_PLACE: f64 = 0.012;
/// Largest number of points of a path among which the one where it leaves the frame is looked for.
const MAX_EDGE_POINTS: usize = 1000;

pub(super) fn zeros(path: &PathView, view: &PlacedView, is_named: bool) -> Vec<Stroke> {
    let seen = path.zeros.iter().filter(|(_, at)| is_inside(view, view.side.project(*at)));
    let stroke = |(name, at): &(String, [f64; 3])| Stroke {
        caption: is_named.then(|| name.clone()),
        ..Stroke::new(Pen::Edge, Shape::Zero(view.project(*at)))
    };
    seen.map(stroke).collect()
}

/// Draws the travel limits that cross a plane view as lines across its frame; those that hold for one tool have its name.
pub(super) fn limits(path: &PathView, view: &PlacedView) -> Vec<Stroke> {
    let [low, high] = view.frame;
    let line = |limit: &TravelLimit| {
        let mut unit = [0.0; 3];
        unit[limit.axis] = 1.0;
        // An axis of the part runs along one direction of a plane view, or towards the reader.
        let seen = view.side.project(unit);
        let along = (0..2).find(|direction| 0.5 < seen[*direction].abs())?;
        let at = limit.mm * seen[along];
        let mut ends = [low, high];
        ends.iter_mut().for_each(|end| end[along] = at);
        let is_seen = low[along] < at && at < high[along];
        let shape = Shape::Line(ends.map(|end| view.moved(end)).into());
        is_seen.then(|| Stroke { caption: limit.tool.clone(), ..Stroke::new(Pen::Limit, shape) })
    };
    let is_plane = view.kind != StandardView::Isometric;
    path.limits.iter().filter(|_| is_plane).filter_map(line).collect()
}

fn is_inside(view: &PlacedView, at: Point) -> bool {
    let [low, high] = view.frame;
    (0..2).all(|axis| low[axis] <= at[axis] && at[axis] <= high[axis])
}

/// Returns where a place outside the frame is marked on its edge: where the path leaves the frame towards its start or its
/// end, else at the nearest point.
fn edge_point(path: &PathView, view: &PlacedView, place: &PathPlace) -> Point {
    let [low, high] = view.frame;
    let seen = view.side.project(place.at);
    let nearest = [seen[0].clamp(low[0], high[0]), seen[1].clamp(low[1], high[1])];
    let points: Vec<Point> = match place.sign {
        Sign::Stop => return nearest,
        Sign::Start => path.points.iter().take(MAX_EDGE_POINTS).map(|at| view.side.project(*at)).collect(),
        Sign::End | Sign::Alarm => {
            path.points.iter().rev().take(MAX_EDGE_POINTS).map(|at| view.side.project(*at)).collect()
        }
    };
    let way: Vec<Point> = [seen].into_iter().chain(points).collect();
    way.windows(2).find_map(|pair| clipped([pair[0], pair[1]], view.frame)).map_or(nearest, |[edge, _]| edge)
}

/// Draws the places of the path. Those near each other share a symbol. One outside the frame lies on its edge, in the first
/// view alone, which has the labels.
pub(super) fn places(path: &PathView, view: &PlacedView, extent: f64, is_named: bool) -> Vec<Stroke> {
    struct Group {
        at: Point,
        sign: Sign,
        labels: Vec<String>,
    }
    let mut groups: Vec<Group> = Vec::new();
    let [low, high] = view.frame;
    for place in path.places.iter().take(MAX_PLACES) {
        let PathPlace { sign, at, label } = place;
        let seen = view.side.project(*at);
        let is_inside = (0..2).all(|axis| low[axis] <= seen[axis] && seen[axis] <= high[axis]);
        if !is_inside && !is_named {
            continue;
        }
        let at = if is_inside { seen } else { edge_point(path, view, place) };
        let label = if is_inside { label.clone() } else { format!("{label} (outside)") };
        // Start, end and alarm have symbols of their own in one place, and stand for a stop there.
        let is_same = |group: &&mut Group| {
            libm::hypot(group.at[0] - at[0], group.at[1] - at[1]) < SAME_PLACE * extent
                && (group.sign == *sign || [group.sign, *sign].contains(&Sign::Stop))
        };
        match groups.iter_mut().find(is_same) {
            Some(group) => {
                if group.sign < *sign {
                    (group.sign, group.at) = (*sign, at);
                }
                if !group.labels.contains(&label) {
                    group.labels.push(label);
                }
            }
            None => groups.push(Group { at, sign: *sign, labels: vec![label] }),
        }
    }
    let stroke = |Group { at, sign, labels }: Group| Stroke {
        caption: is_named.then(|| labels.join(", ")),
        ..Stroke::new(Pen::Edge, Shape::Sign { at: view.moved(at), sign })
    };
    groups.into_iter().map(stroke).collect()
}
