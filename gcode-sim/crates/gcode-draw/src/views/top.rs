//! The top view: the part seen along its axis of revolution y, or a cylinder about x seen along the spindle.
use nalgebra::Vector3;

use super::super::measure::plain;
use super::super::role::{HoleStatus, Pen, Point};
use super::super::scene::{LegendItem, Mark, Sample, Scene, Shape, Stroke, Title};
use super::purpose::PicturePurpose;
use super::side::Side;
use gcode_part::Hole;

/// Contents of a top view; everything but the holes may be unknown.
#[derive(Clone, Debug, Default)]
pub struct TopView {
    /// Name of the part or the program.
    pub name: String,
    /// Viewing direction.
    pub side: Side,
    /// Radius of the part's outline seen along y, mm.
    pub outline: Option<f64>,
    /// Dimensions of a part that is a cylinder about x.
    pub cylinder: Option<Cylinder>,
    /// Diameter of the position tolerance zone, mm.
    pub tolerance: Option<f64>,
    /// Letter of the rotary axis of `DrawnHole::turn`.
    pub rotary: String,
    /// Whether the rotary axis increases as the presented azimuth (from z towards y) decreases.
    pub is_rotary_reversed: bool,
    /// The holes, nominal and actual.
    pub holes: Vec<DrawnHole>,
    /// Purpose of the comparison, which selects the wording.
    pub purpose: PicturePurpose,
    /// Number of differences between two revisions that no hole shows.
    pub other_differences: usize,
    /// Sentence on a different end of the two revisions.
    pub ending: Option<String>,
    /// Tool path.
    pub path: Vec<PathPiece>,
    /// Further lines of the title block.
    pub lines: Vec<String>,
}

/// A cylinder about x, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Radius of its surface.
    pub outer: f64,
    /// Radius on which distances are measured and at which it is unrolled.
    pub radius: f64,
    /// Length of the pattern: holes lie at 0 ≤ x ≤ length.
    pub length: f64,
    /// Number of rows round the circumference.
    pub rows: u32,
}

/// One hole: nominal, actual and verdict.
#[derive(Clone, Debug)]
pub struct DrawnHole {
    /// Number or name in the label.
    pub id: String,
    /// Nominal hole; `None` for an extra one.
    pub nominal: Option<Hole>,
    /// Actual hole; `None` for a missing one.
    pub actual: Option<Hole>,
    /// Result of the comparison.
    pub status: HoleStatus,
    /// Position deviation by ISO 1101 (a diameter), mm.
    pub position_deviation: Option<f64>,
    /// Angle of the rotary axis during drilling, degrees.
    pub rotary_angle: Option<f64>,
    /// Faults other than position, a few words each.
    pub remarks: Vec<String>,
}

/// A piece of the tool path in the part's frame, mm.
#[derive(Clone, Debug)]
pub struct PathPiece {
    /// Points of the polyline.
    pub points: Vec<[f64; 3]>,
    /// Kind of motion.
    pub kind: PathKind,
}

/// Kind of a path piece, in drawing order: feed or rapid of one program, or the cuts of two revisions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PathKind {
    /// Feed move.
    Feed,
    /// Rapid move.
    Rapid,
    /// Cut that both programs make.
    Kept,
    /// Cut of the new program that differs from the old one or is added.
    New,
    /// Cut of the old program that differs from the new one or is removed.
    Gone,
}

impl PathKind {
    const ALL: [Self; 5] = [Self::Feed, Self::Rapid, Self::Kept, Self::New, Self::Gone];

    fn pen(self) -> Pen {
        match self {
            Self::Feed => Pen::Feed,
            Self::Rapid => Pen::Rapid,
            Self::Kept => Pen::Unchanged,
            Self::New => Pen::New,
            Self::Gone => Pen::Old,
        }
    }

    fn legend(self) -> &'static str {
        match self {
            Self::Feed => "tool path, feed",
            Self::Rapid => "tool path, rapid",
            Self::Kept => "unchanged cut",
            Self::New => "changed cut, new",
            Self::Gone => "changed cut, old",
        }
    }
}

/// Largest number of numbered holes; beyond it good holes have neither number nor dial, which would hide each
/// other.
pub(super) const MAX_NUMBERED: usize = 60;

/// Largest number of construction circles; more would hide the holes.
const MAX_CIRCLES: usize = 12;

/// Builds the scene of a top view.
pub fn top_view(view: &TopView) -> Scene {
    let (near, far): (Vec<_>, Vec<_>) = view.holes.iter().partition(|hole| faces_reader(hole, view));
    let mut marks: Vec<Mark> = near.into_iter().filter_map(|hole| mark(hole, view)).collect();
    if view.cylinder.is_some() || view.purpose == PicturePurpose::Change {
        number_few(&mut marks);
    }
    let mut strokes: Vec<Stroke> = view.path.iter().filter_map(|piece| path(piece, view.side)).collect();
    let circles = if view.side == Side::Y { circles(&view.holes) } else { Vec::new() };
    let has_circles = !circles.is_empty();
    strokes.extend(circles);
    strokes.extend(view.outline.map(|radius| Stroke {
        shape: Shape::Circle { centre: [0.0, 0.0], radius },
        pen: Pen::Outline,
        caption: None,
    }));
    if let Some(Cylinder { outer, length, .. }) = view.cylinder {
        strokes.extend([outer, -outer].map(|y| Stroke {
            shape: Shape::Line(vec![[0.0, y], [length, y]]),
            pen: Pen::Outline,
            caption: None,
        }));
    }
    let hidden = (!far.is_empty()).then(|| format!("{} holes on the far side not drawn", far.len()));
    let title = Title {
        name: view.name.clone(),
        view: format!("Top view, seen from {}", view.side.name()),
        position: view.tolerance.filter(|_| view.purpose == PicturePurpose::Verdict),
        verdict: headline(view),
        lines: worst(view).into_iter().chain(view.lines.iter().cloned()).chain(hidden).collect(),
        caution: "Predicted by simulation, not measured".to_owned(),
    };
    let legend = legend(view, &marks, has_circles);
    Scene { title, axes: view.side.axes(), strokes, marks, zone: view.tolerance, legend, chart: None }
}

/// Removes the numbers and dials that would hide the holes of a dense pattern.
pub(super) fn number_few(marks: &mut [Mark]) {
    if MAX_NUMBERED < marks.len() {
        for mark in marks.iter_mut().filter(|mark| mark.status.is_good()) {
            mark.label.clear();
            mark.deviation = None;
        }
    }
    if MAX_NUMBERED < marks.iter().filter(|mark| !mark.label.is_empty()).count() {
        marks.iter_mut().for_each(|mark| mark.label.clear());
    }
}

/// Returns the name of the azimuth axis, with a minus sign if the rotary axis runs the other way.
pub(super) fn turn_name(view: &TopView) -> String {
    if view.is_rotary_reversed { format!("−{}", view.rotary) } else { view.rotary.clone() }
}

/// Returns false for holes on the far side of a cylinder.
fn faces_reader(hole: &DrawnHole, view: &TopView) -> bool {
    let shown = hole.nominal.as_ref().or(hole.actual.as_ref());
    let away = |hole: &Hole| Vector3::from(hole.axis).dot(&view.side.towards()) < -1e-6;
    view.cylinder.is_none() || !shown.is_some_and(away)
}

/// Projects a path piece; `None` if it runs straight towards the reader.
fn path(piece: &PathPiece, side: Side) -> Option<Stroke> {
    let points: Vec<Point> = piece.points.iter().map(|p| side.project(*p)).collect();
    let first = *points.first()?;
    let goes = points.iter().any(|p| 1e-3 < libm::hypot(p[0] - first[0], p[1] - first[1]));
    goes.then(|| Stroke { shape: Shape::Line(points), pen: piece.kind.pen(), caption: None })
}

/// Returns the label of a hole: number, remarks, rotary angle and deviation.
pub(super) fn label(hole: &DrawnHole, view: &TopView) -> Vec<String> {
    let mut label = vec![hole.id.clone()];
    let turn = hole.rotary_angle.map(|turn| format!("{} {}°", view.rotary, signed(turn, 3)));
    let phi = hole
        .position_deviation
        .filter(|phi| view.purpose.shows_deviation(*phi, 3))
        .map(|phi| format!("Φ{phi:.3}"));
    let words = match hole.status {
        HoleStatus::Missing | HoleStatus::Extra => vec![view.purpose.status_word(hole.status).to_owned()],
        HoleStatus::Good | HoleStatus::Bad | HoleStatus::Unjudged => hole.remarks.clone(),
    };
    label.extend(words);
    if hole.status == HoleStatus::Good {
        label.extend([turn, phi].into_iter().flatten());
    } else {
        label.extend([phi, turn].into_iter().flatten());
    }
    label.retain(|line| !line.is_empty());
    label
}

fn mark(hole: &DrawnHole, view: &TopView) -> Option<Mark> {
    let shown = hole.nominal.as_ref().or(hole.actual.as_ref())?;
    let both = hole.nominal.as_ref().zip(hole.actual.as_ref());
    Some(Mark {
        position: view.side.project(shown.entry),
        radius: shown.diameter.unwrap_or(0.0) / 2.0,
        status: hole.status,
        label: label(hole, view),
        direction: Some(view.side.project(shown.axis)),
        deviation: both.and_then(|(nominal, found)| view.side.zone_deviation(nominal, found)),
        actual: both.map(|(_, found)| view.side.project(found.entry)),
    })
}

/// Returns the circles on which holes lie, with their radii; radii less than 0.05 mm apart are merged.
fn circles(holes: &[DrawnHole]) -> Vec<Stroke> {
    let any_nominal = holes.iter().any(|h| h.nominal.is_some());
    let of = |h: &DrawnHole| if any_nominal { h.nominal.clone() } else { h.actual.clone() };
    let mut radii: Vec<f64> =
        holes.iter().filter_map(of).map(|h| libm::hypot(h.entry[0], h.entry[2])).collect();
    radii.sort_by(f64::total_cmp);
    radii.dedup_by(|a, b| (*a - *b).abs() < 0.05);
    radii.retain(|r| 1e-3 < *r);
    if MAX_CIRCLES < radii.len() {
        return Vec::new();
    }
    let circle = |radius: f64| Stroke {
        shape: Shape::Circle { centre: [0.0, 0.0], radius },
        pen: Pen::Construction,
        caption: Some(format!("r {}", signed(radius, 2))),
    };
    radii.into_iter().map(circle).collect()
}

/// Formats a number without trailing zeros and with a true minus sign.
fn signed(number: f64, places: usize) -> String {
    let text = format!("{number:.places$}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.replace('-', "−") }
}

fn count(holes: &[DrawnHole], standing: HoleStatus) -> usize {
    holes.iter().filter(|h| h.status == standing).count()
}

pub(super) fn headline(view: &TopView) -> Option<(HoleStatus, String)> {
    let of = |standing| count(&view.holes, standing);
    let counts = [HoleStatus::Good, HoleStatus::Bad, HoleStatus::Missing, HoleStatus::Extra].map(of);
    let (standing, words) = view.purpose.headline(counts, view.other_differences)?;
    Some((standing, view.ending.iter().cloned().chain([words]).collect::<Vec<_>>().join("; ")))
}

pub(super) fn worst(view: &TopView) -> Option<String> {
    let known = view.holes.iter().filter_map(|h| Some((h.position_deviation?, &h.id)));
    let (phi, id) = known.fold(None, |worst: Option<(f64, &String)>, next| match worst {
        Some(worst) if next.0 <= worst.0 => Some(worst),
        _ => Some(next),
    })?;
    view.purpose
        .shows_deviation(phi, 4)
        .then(|| format!("{}: Φ{phi:.4} (hole\u{a0}{id})", view.purpose.worst_label()))
}

/// Returns the legend lines of the symbols that are drawn.
pub(super) fn standings(view: &TopView) -> Vec<LegendItem> {
    let all =
        [HoleStatus::Good, HoleStatus::Bad, HoleStatus::Missing, HoleStatus::Extra, HoleStatus::Unjudged];
    let drawn = all.into_iter().filter(|standing| 0 < count(&view.holes, *standing));
    let item = |standing: HoleStatus| LegendItem {
        sample: Sample::Status(standing),
        text: view.purpose.legend(standing).to_owned(),
    };
    drawn.map(item).collect()
}

fn legend(view: &TopView, marks: &[Mark], has_circles: bool) -> Vec<LegendItem> {
    let mut items = standings(view);
    let mut add = |sample: Sample, text: &str| items.push(LegendItem { sample, text: text.to_owned() });
    if marks.iter().any(|m| m.deviation.is_some())
        && let Some(zone) = view.tolerance
    {
        let text = format!("{} Φ{}, axial view,", view.purpose.deviation_label(), plain(zone));
        add(Sample::Deviation, &text);
    }
    if marks.iter().any(|m| m.direction.is_some_and(|d| 0.02 < libm::hypot(d[0], d[1]))) {
        add(Sample::Direction, "hole axis, outwards");
    }
    if marks.iter().any(|m| m.actual.is_some()) {
        add(Sample::Displacement, view.purpose.displacement_label());
    }
    if view.outline.is_some() || view.cylinder.is_some() {
        add(Sample::Pen(Pen::Outline), "part outline");
    }
    if has_circles {
        let wanted = view.holes.iter().any(|h| h.nominal.is_some());
        let text = if wanted { "radius r, mm" } else { "radius r where the feed begins, mm" };
        add(Sample::Pen(Pen::Construction), text);
    }
    for kind in PathKind::ALL {
        if view.path.iter().any(|piece| piece.kind == kind && path(piece, view.side).is_some()) {
            add(Sample::Pen(kind.pen()), kind.legend());
        }
    }
    items
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hole(entry: [f64; 3], axis: [f64; 3]) -> Hole {
        Hole { id: None, entry, axis, depth: 15.0, diameter: Some(6.0), from: None }
    }

    fn drawn(nominal: Hole, found: Hole) -> DrawnHole {
        DrawnHole {
            id: "1".to_owned(),
            nominal: Some(nominal),
            actual: Some(found),
            status: HoleStatus::Good,
            position_deviation: Some(0.02),
            rotary_angle: Some(-72.0),
            remarks: Vec::new(),
        }
    }

    #[test]
    fn z_points_down_so_that_the_view_from_above_is_right_handed() {
        let holes =
            vec![drawn(hole([0.0, 9.0, 5.0], [0.0, 1.0, 0.0]), hole([0.0, 9.0, 5.0], [0.0, 1.0, 0.0]))];
        let scene = top_view(&TopView { holes, rotary: "B".to_owned(), ..TopView::default() });
        assert_eq!(scene.marks[0].position, [0.0, -5.0]);
        assert_eq!(scene.marks[0].label, ["1", "B −72°", "Φ0.020"]);
        assert_eq!(scene.axes[1].direction, [0.0, -1.0]);
    }

    #[test]
    fn an_axial_hole_shows_its_deviation_as_it_is() {
        let up = [0.0, 1.0, 0.0];
        let deviation =
            Side::Y.zone_deviation(&hole([420.0, 675.0, 0.0], up), &hole([420.03, 677.0, 0.04], up)).unwrap();
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
        let deviation = Side::Y.zone_deviation(&hole([1000.0, 300.0, 0.0], axis), &found).unwrap();
        assert!((deviation.entry[0] - 0.05).abs() < 1e-9 && deviation.entry[1].abs() < 1e-9, "{deviation:?}");
    }

    /// Tilted by 0.3° about its entry: at 15 mm depth that is 15·tan 0.3° = 0.0785 mm, to the other side.
    #[test]
    fn a_tilted_hole_is_off_at_its_bottom() {
        let tilt = gcode_lang::units::Deg(0.3);
        let found = hole([420.0, 675.0, 0.0], [tilt.sin(), tilt.cos(), 0.0]);
        let deviation = Side::Y.zone_deviation(&hole([420.0, 675.0, 0.0], [0.0, 1.0, 0.0]), &found).unwrap();
        assert!(libm::hypot(deviation.entry[0], deviation.entry[1]) < 1e-9);
        assert!((deviation.bottom[0] + 15.0 * tilt.tan()).abs() < 1e-9, "{deviation:?}");
    }
}
