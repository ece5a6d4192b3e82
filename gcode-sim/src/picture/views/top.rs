//! The top view: the part seen along its axis of revolution y, from +y.
//!
//! x points to the right and z down, so that the picture is right-handed (y comes towards the reader), and azimuths
//! (x = r·cos α, z = r·sin α) grow clockwise.
use nalgebra::{UnitQuaternion, Vector3};

use super::super::measure::plain;
use super::super::scene::{
    Axis, LegendItem, Mark, Misfit, Pen, Point, Sample, Scene, Shape, Standing, Stroke, Title,
};
use super::question::Question;
use crate::part::hole::Hole;

/// What a top view is made of. Everything but the holes may be unknown.
#[derive(Clone, Debug, Default)]
pub struct TopView {
    /// Of the part or the programme.
    pub name: String,
    /// Radius of the part's outline seen along y, mm.
    pub outline: Option<f64>,
    /// Diameter of the position tolerance zone, mm.
    pub tolerance: Option<f64>,
    /// The letter of the axis that `DrawnHole::turn` is about.
    pub rotary: String,
    pub holes: Vec<DrawnHole>,
    /// What the holes are held against.
    pub question: Question,
    pub path: Vec<PathPiece>,
    /// Further lines of the title block.
    pub lines: Vec<String>,
}

/// One hole: as wanted, as made, and what was said about it.
#[derive(Clone, Debug)]
pub struct DrawnHole {
    pub id: String,
    pub nominal: Option<Hole>,
    pub found: Option<Hole>,
    pub standing: Standing,
    /// Position as ISO 1101 has it (diameter), mm.
    pub phi: Option<f64>,
    /// Where the rotary axis stands while the hole is made, degrees.
    pub turn: Option<f64>,
    /// What is wrong where it isn't the position: a few words.
    pub remark: Option<String>,
}

/// A piece of the tool's path in the part's frame, mm.
#[derive(Clone, Debug)]
pub struct PathPiece {
    pub points: Vec<[f64; 3]>,
    pub rapid: bool,
}

/// More circles than this would hide the holes.
const MOST_CIRCLES: usize = 12;

/// The scene of a top view.
pub fn top_view(view: &TopView) -> Scene {
    let marks: Vec<Mark> = view.holes.iter().filter_map(|hole| mark(hole, view)).collect();
    let mut strokes: Vec<Stroke> = view.path.iter().map(path).collect();
    let circles = circles(&view.holes);
    let has_circles = !circles.is_empty();
    strokes.extend(circles);
    strokes.extend(view.outline.map(|radius| Stroke {
        shape: Shape::Circle { centre: [0.0, 0.0], radius },
        pen: Pen::Outline,
        caption: None,
    }));
    let title = Title {
        name: view.name.clone(),
        view: "Top view, seen from +y".to_owned(),
        position: view.tolerance.filter(|_| view.question == Question::Verdict),
        verdict: headline(view),
        lines: worst(view).into_iter().chain(view.lines.iter().cloned()).collect(),
        caution: "Predicted by simulation, not measured".to_owned(),
    };
    let legend = legend(view, &marks, has_circles);
    Scene { title, axes: axes(), strokes, marks, zone: view.tolerance, legend }
}

/// The part's (x, y, z) on the sheet: right and up.
fn seen([x, _, z]: [f64; 3]) -> Point {
    // 0 − z and not −z: no negative zeros in what is compared and printed.
    [x, 0.0 - z]
}

fn axes() -> Vec<Axis> {
    vec![
        Axis { name: "x".to_owned(), direction: seen([1.0, 0.0, 0.0]) },
        Axis { name: "z".to_owned(), direction: seen([0.0, 0.0, 1.0]) },
    ]
}

fn path(piece: &PathPiece) -> Stroke {
    let pen = if piece.rapid { Pen::Rapid } else { Pen::Feed };
    Stroke { shape: Shape::Line(piece.points.iter().map(|p| seen(*p)).collect()), pen, caption: None }
}

fn mark(hole: &DrawnHole, view: &TopView) -> Option<Mark> {
    let shown = hole.nominal.as_ref().or(hole.found.as_ref())?;
    let mut label = vec![hole.id.clone()];
    let turn = hole.turn.map(|turn| format!("{} {}°", view.rotary, signed(turn, 3)));
    let phi = hole.phi.map(|phi| format!("Φ{phi:.3}"));
    let words = match hole.standing {
        Standing::Missing | Standing::Extra => Some(view.question.word(hole.standing).to_owned()),
        Standing::Good | Standing::Bad | Standing::Unjudged => hole.remark.clone(),
    };
    if hole.standing == Standing::Good {
        label.extend([words, turn, phi].into_iter().flatten());
    } else {
        label.extend([words, phi, turn].into_iter().flatten());
    }
    label.retain(|line| !line.is_empty());
    let both = hole.nominal.as_ref().zip(hole.found.as_ref());
    Some(Mark {
        at: seen(shown.entry),
        radius: shown.diameter.unwrap_or(0.0) / 2.0,
        standing: hole.standing,
        label,
        direction: Some(seen(shown.axis)),
        misfit: both.and_then(|(nominal, found)| misfit(nominal, found)),
        found: both.map(|(_, found)| seen(found.entry)),
    })
}

/// Where the actual axis crosses the plane `depth` below the nominal entry, perpendicular to the nominal axis.
fn crossing(nominal: &Hole, found: &Hole, depth: f64) -> Option<Vector3<f64>> {
    let (axis, along) = (Vector3::from(nominal.axis), Vector3::from(found.axis));
    let plane = Vector3::from(nominal.entry) - axis * depth;
    let from = Vector3::from(found.entry);
    let slope = along.dot(&axis);
    (0.01 < slope.abs()).then(|| from + along * ((plane - from).dot(&axis) / slope))
}

/// Actual − nominal across the nominal axis, which is turned the shortest way to point at the reader: so a
/// deviation keeps its length, and the zone is a circle for steep holes too.
fn misfit(nominal: &Hole, found: &Hole) -> Option<Misfit> {
    let axis = Vector3::from(nominal.axis);
    let turn = UnitQuaternion::rotation_between(&axis, &Vector3::y())
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
    let end = |depth: f64| {
        let exact = Vector3::from(nominal.entry) - axis * depth;
        Some(seen((turn * (crossing(nominal, found, depth)? - exact)).into()))
    };
    Some(Misfit { entry: end(0.0)?, bottom: end(nominal.depth)? })
}

/// The circles on which holes lie, each with its radius; holes less than 0.05 mm apart share one.
fn circles(holes: &[DrawnHole]) -> Vec<Stroke> {
    let any_nominal = holes.iter().any(|h| h.nominal.is_some());
    let of = |h: &DrawnHole| if any_nominal { h.nominal.clone() } else { h.found.clone() };
    let mut radii: Vec<f64> =
        holes.iter().filter_map(of).map(|h| libm::hypot(h.entry[0], h.entry[2])).collect();
    radii.sort_by(f64::total_cmp);
    radii.dedup_by(|a, b| (*a - *b).abs() < 0.05);
    radii.retain(|r| 1e-3 < *r);
    if MOST_CIRCLES < radii.len() {
        return Vec::new();
    }
    let circle = |radius: f64| Stroke {
        shape: Shape::Circle { centre: [0.0, 0.0], radius },
        pen: Pen::Construction,
        caption: Some(format!("r {}", signed(radius, 2))),
    };
    radii.into_iter().map(circle).collect()
}

/// A number without needless zeros and with a true minus sign.
fn signed(number: f64, places: usize) -> String {
    let text = format!("{number:.places$}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.replace('-', "−") }
}

fn count(holes: &[DrawnHole], standing: Standing) -> usize {
    holes.iter().filter(|h| h.standing == standing).count()
}

fn headline(view: &TopView) -> Option<(Standing, String)> {
    let of = |standing| count(&view.holes, standing);
    let counts = [Standing::Good, Standing::Bad, Standing::Missing, Standing::Extra].map(of);
    view.question.headline(counts)
}

fn worst(view: &TopView) -> Option<String> {
    let known = view.holes.iter().filter_map(|h| Some((h.phi?, &h.id)));
    let (phi, id) = known.fold(None, |worst: Option<(f64, &String)>, next| match worst {
        Some(worst) if next.0 <= worst.0 => Some(worst),
        _ => Some(next),
    })?;
    Some(format!("{}: Φ{phi:.4} (hole\u{a0}{id})", view.question.worst()))
}

fn legend(view: &TopView, marks: &[Mark], has_circles: bool) -> Vec<LegendItem> {
    let mut items = Vec::new();
    let mut add = |sample: Sample, text: &str| items.push(LegendItem { sample, text: text.to_owned() });
    for standing in [Standing::Good, Standing::Bad, Standing::Missing, Standing::Extra, Standing::Unjudged] {
        if 0 < count(&view.holes, standing) {
            add(Sample::Standing(standing), view.question.legend(standing));
        }
    }
    if marks.iter().any(|m| m.misfit.is_some())
        && let Some(zone) = view.tolerance
    {
        let text = format!("{} Φ{}, seen along the hole,", view.question.misfit(), plain(zone));
        add(Sample::Misfit, &text);
    }
    if marks.iter().any(|m| m.direction.is_some_and(|d| 0.02 < libm::hypot(d[0], d[1]))) {
        add(Sample::Direction, "hole axis, outwards");
    }
    if marks.iter().any(|m| m.found.is_some()) {
        add(Sample::Astray, "to where the hole is instead");
    }
    if view.outline.is_some() {
        add(Sample::Pen(Pen::Outline), "part outline");
    }
    if has_circles {
        let wanted = view.holes.iter().any(|h| h.nominal.is_some());
        let text = if wanted { "radius r, mm" } else { "radius r where the feed begins, mm" };
        add(Sample::Pen(Pen::Construction), text);
    }
    for (rapid, pen, text) in [(false, Pen::Feed, "tool path, feed"), (true, Pen::Rapid, "tool path, rapid")]
    {
        if view.path.iter().any(|p| p.rapid == rapid) {
            add(Sample::Pen(pen), text);
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
            found: Some(found),
            standing: Standing::Good,
            phi: Some(0.02),
            turn: Some(-72.0),
            remark: None,
        }
    }

    #[test]
    fn z_points_down_so_that_the_view_from_above_is_right_handed() {
        let holes =
            vec![drawn(hole([0.0, 9.0, 5.0], [0.0, 1.0, 0.0]), hole([0.0, 9.0, 5.0], [0.0, 1.0, 0.0]))];
        let scene = top_view(&TopView { holes, rotary: "B".to_owned(), ..TopView::default() });
        assert_eq!(scene.marks[0].at, [0.0, -5.0]);
        assert_eq!(scene.marks[0].label, ["1", "B −72°", "Φ0.020"]);
        assert_eq!(scene.axes[1].direction, [0.0, -1.0]);
    }

    #[test]
    fn an_axial_hole_shows_its_misfit_as_it_is() {
        let up = [0.0, 1.0, 0.0];
        let misfit = misfit(&hole([420.0, 675.0, 0.0], up), &hole([420.03, 677.0, 0.04], up)).unwrap();
        for end in [misfit.entry, misfit.bottom] {
            assert!((end[0] - 0.03).abs() < 1e-9 && (end[1] + 0.04).abs() < 1e-9, "{misfit:?}");
        }
    }

    /// A hole leaning 60° out to +x: 0.05 mm along its own meridian looks like 0.025 from above, and is 0.05.
    #[test]
    fn a_steep_hole_keeps_the_length_of_its_misfit() {
        let axis = [0.75f64.sqrt(), 0.5, 0.0];
        let down_the_meridian = [0.5 * 0.05, -(0.75f64.sqrt()) * 0.05, 0.0];
        let found = hole([1000.0 + down_the_meridian[0], 300.0 + down_the_meridian[1], 0.0], axis);
        let misfit = misfit(&hole([1000.0, 300.0, 0.0], axis), &found).unwrap();
        assert!((misfit.entry[0] - 0.05).abs() < 1e-9 && misfit.entry[1].abs() < 1e-9, "{misfit:?}");
    }

    /// Tilted by 0.3° about its entry: at 15 mm depth that is 15·tan 0.3° = 0.0785 mm, to the other side.
    #[test]
    fn a_tilted_hole_is_off_at_its_bottom() {
        let tilt = crate::units::Deg(0.3);
        let found = hole([420.0, 675.0, 0.0], [tilt.sin(), tilt.cos(), 0.0]);
        let misfit = misfit(&hole([420.0, 675.0, 0.0], [0.0, 1.0, 0.0]), &found).unwrap();
        assert!(libm::hypot(misfit.entry[0], misfit.entry[1]) < 1e-9);
        assert!((misfit.bottom[0] + 15.0 * tilt.tan()).abs() < 1e-9, "{misfit:?}");
    }
}
