//! A burr from the side and from its tip: its outline and the flutes on the near side.
//!
//! In the side view x points to the right and y up, so the tip is at the left, as on the machine. In the tip
//! view z points to the right and y up.
use super::flute_view::{Fault, FlutePoint, FluteView};
use crate::picture::{LegendItem, Picture, Sample, Title};
use crate::scene::{Axis, HoleStatus, Mark, Pen, Point, Scene, Shape, Stroke};
use crate::side::Side;
use nalgebra::Vector3;

/// Least component of a normal towards the reader at which the surface counts as visible.
const FACING: f64 = 1e-6;

/// Builds the picture of a burr seen from +z, the tip to the left.
pub fn side_view(view: &FluteView) -> Picture {
    let below = view.outline.iter().rev().map(|[x, r]| [*x, -r]);
    let outline = view.outline.iter().copied().chain(below).chain(view.outline.first().copied());
    let outline = Stroke::new(Pen::Outline, Shape::Line(outline.collect()));
    let what = "Side view, seen from +z, the tip to the left; y at the end of the cylinder";
    picture(view, what, Side::Z, [("x", [1.0, 0.0]), ("y", [0.0, 1.0])], vec![outline])
}

/// Builds the picture of a burr seen from −x along its axis.
pub fn tip_view(view: &FluteView) -> Picture {
    let circle = |radius: f64, pen: Pen| Stroke::new(pen, Shape::Circle { centre: [0.0, 0.0], radius });
    let radius = view.outline.first().map_or(0.0, |[_, r]| *r);
    let circles = vec![circle(radius, Pen::Outline), circle(view.tip_radius, Pen::Construction)];
    let axes = [("z", [1.0, 0.0]), ("y", [0.0, 1.0])];
    picture(view, "Tip view, seen from −x along the axis", Side::MINUS_X, axes, circles)
}

fn faces(point: &FlutePoint, side: Side) -> bool {
    FACING < side.towards().dot(&Vector3::from(point.normal))
}

/// Returns the sections of the flutes on the near side, and all sections of a faulty pass. The longest visible
/// section of each pass has its number.
fn flutes(view: &FluteView, side: Side) -> Vec<Stroke> {
    let mut strokes = Vec::new();
    for (pass, flute) in view.flutes.iter().enumerate() {
        let sections = || {
            let all = flute.chunk_by(|one, other| faces(one, side) == faces(other, side));
            all.filter(|section| 1 < section.len()).map(|section| (section, faces(&section[0], side)))
        };
        let longest = sections().filter(|(_, near)| *near).map(|(section, _)| section.len()).max();
        let is_faulty = view.faults.iter().any(|fault| fault.pass == Some(pass));
        for (section, is_near) in sections() {
            let pen = match (is_near, is_faulty) {
                (true, false) => Pen::Feed,
                (true, true) => Pen::Faulty,
                (false, true) => Pen::FaultyFarSide,
                (false, false) => continue,
            };
            let points = section.iter().map(|point| side.project(point.position)).collect();
            let is_longest = is_near && Some(section.len()) == longest;
            let caption = is_longest.then(|| format!("{}", pass + 1));
            strokes.push(Stroke { caption, ..Stroke::new(pen, Shape::Line(points)) });
        }
    }
    strokes
}

fn mark(fault: &Fault, side: Side) -> Mark {
    let far = if faces(&fault.point, side) { "" } else { " (far side)" };
    let pass = fault.pass.map(|pass| format!("pass {}{far}", pass + 1));
    let what = fault.labels.iter().enumerate().map(|(index, what)| match (index, fault.pass) {
        (0, None) => format!("{what}{far}"),
        _ => (*what).to_owned(),
    });
    let label = pass.into_iter().chain(what).collect();
    Mark { label, ..Mark::new(side.project(fault.point.position), fault.status) }
}

/// Builds a picture; `edges` are drawn over the flutes.
fn picture(
    view: &FluteView,
    what: &str,
    side: Side,
    axes: [(&str, Point); 2],
    edges: Vec<Stroke>,
) -> Picture {
    let strokes: Vec<Stroke> = flutes(view, side).into_iter().chain(edges).collect();
    let has_status = |status: HoleStatus| view.faults.iter().any(|fault| fault.status == status);
    let has_pen = |pen: Pen| strokes.iter().any(|stroke| stroke.pen == pen);
    let signs = [
        (HoleStatus::Bad, "Fault, at its worst point"),
        (HoleStatus::Missing, "Position of a missing flute"),
        (HoleStatus::Extra, "Extra flute"),
    ];
    let lines = [
        (Pen::Feed, "Wheel contact path on the near side, with the number of its pass"),
        (Pen::Faulty, "Pass with a fault"),
        (Pen::FaultyFarSide, "Pass with a fault, on the far side"),
        (Pen::Outline, "Tooth bottom"),
        (Pen::Construction, "Polar angle at which flutes end"),
    ];
    let signs = signs.into_iter().filter(|(status, _)| has_status(*status));
    let signs = signs.map(|(status, words)| LegendItem::new(Sample::Status(status), words));
    let lines = lines.into_iter().filter(|(pen, _)| has_pen(*pen));
    let legend = signs.chain(lines.map(|(pen, words)| LegendItem::new(Sample::Pen(pen), words))).collect();
    let axes = axes.map(|(name, direction)| Axis { name: name.to_owned(), direction }).into();
    Picture {
        title: Title {
            name: view.name.clone(),
            view: what.to_owned(),
            position: None,
            verdict: Some(view.verdict.clone()),
            lines: view.lines.clone(),
            caution: "Predicted by simulation, not measured; the wheel is one point".to_owned(),
        },
        scene: Scene {
            axes,
            strokes,
            marks: view.faults.iter().map(|fault| mark(fault, side)).collect(),
            zone: None,
        },
        legend,
        ..Picture::default()
    }
}

#[cfg(test)]
mod tests {
    use super::super::flute_view::HelixCourses;
    use super::*;

    fn view(out: [[f64; 3]; 4]) -> FluteView {
        let spot = |(n, out): (usize, [f64; 3])| FlutePoint { position: [n as f64, 1.0, 2.0], normal: out };
        FluteView {
            name: "b".to_owned(),
            verdict: (HoleStatus::Good, "PASS".to_owned()),
            lines: Vec::new(),
            outline: vec![[5.0, 2.0], [0.0, 2.0], [-2.0, 0.0]],
            tip_radius: 0.5,
            flutes: vec![out.into_iter().enumerate().map(spot).collect()],
            faults: Vec::new(),
            helix: HelixCourses::default(),
        }
    }

    fn paths(picture: &Picture) -> Vec<Vec<Point>> {
        let lines = picture.scene.strokes.iter().filter(|stroke| stroke.pen == Pen::Feed);
        let points = lines.filter_map(|stroke| match &stroke.shape {
            Shape::Line(points) => Some(points.clone()),
            _ => None,
        });
        points.collect()
    }

    #[test]
    fn surface_that_faces_away_is_not_drawn() {
        let (front, back) = ([0.0, 0.0, 1.0], [0.0, 0.0, -1.0]);
        let seen = paths(&side_view(&view([front, front, back, front])));
        assert_eq!(seen, [vec![[0.0, 1.0], [1.0, 1.0]]]);
        // From the tip, the surface of the cylinder is edge-on.
        assert!(paths(&tip_view(&view([front, front, front, front]))).is_empty());
        let nose = [-0.5, 0.0, 0.8];
        assert_eq!(paths(&tip_view(&view([front, nose, nose, nose]))), [vec![[2.0, 1.0]; 3]]);
    }
}
