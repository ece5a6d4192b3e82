//! A burr from the side and from its tip: its outline and the flutes on the near side.
//!
//! In the side view x points to the right and y up, so the tip is at the left, as on the machine. In the tip
//! view z points to the right and y up.
use super::flute_view::{Fault, FlutePoint, FluteView};
use crate::picture::{LegendItem, Picture, Sample, Title};
use crate::scene::{Axis, HoleStatus, Mark, Pen, Point, Scene, Shape, Stroke};

/// Least component of a normal towards the reader at which the surface counts as visible.
const FACING: f64 = 1e-6;

/// Builds the picture of a burr seen from +z, the tip to the left.
pub fn side_view(view: &FluteView) -> Picture {
    let seen = Viewpoint { place: |[x, y, _]| [x, y], towards: |[_, _, z]| z };
    let below = view.outline.iter().rev().map(|[x, r]| [*x, -r]);
    let outline = view.outline.iter().copied().chain(below).chain(view.outline.first().copied());
    let outline = Stroke::new(Pen::Outline, Shape::Line(outline.collect()));
    let what = "Side view, seen from +z, the tip to the left; y at the end of the cylinder";
    picture(view, what, &seen, ["x", "y"], vec![outline])
}

/// Builds the picture of a burr seen from −x along its axis.
pub fn tip_view(view: &FluteView) -> Picture {
    let seen = Viewpoint { place: |[_, y, z]| [z, y], towards: |[x, _, _]| -x };
    let circle = |radius: f64, pen: Pen| Stroke::new(pen, Shape::Circle { centre: [0.0, 0.0], radius });
    let radius = view.outline.first().map_or(0.0, |[_, r]| *r);
    let circles = vec![circle(radius, Pen::Outline), circle(view.tip_radius, Pen::Construction)];
    picture(view, "Tip view, seen from −x along the axis", &seen, ["z", "y"], circles)
}

/// A viewing direction on the burr.
struct Viewpoint {
    /// Projects a point of the part to the sheet.
    place: fn([f64; 3]) -> Point,
    /// Returns the component of a direction towards the reader.
    towards: fn([f64; 3]) -> f64,
}

impl Viewpoint {
    /// Returns the sections of the flutes on the near side, and all sections of a faulty pass. The longest visible
    /// section of each pass has its number.
    fn flutes(&self, view: &FluteView) -> Vec<Stroke> {
        let mut strokes = Vec::new();
        for (pass, flute) in view.flutes.iter().enumerate() {
            let faces = |spot: &FlutePoint| FACING < (self.towards)(spot.normal);
            let stretches = || {
                let all = flute.chunk_by(|one, other| faces(one) == faces(other));
                all.filter(|stretch| 1 < stretch.len()).map(|stretch| (stretch, faces(&stretch[0])))
            };
            let longest = stretches().filter(|(_, near)| *near).map(|(stretch, _)| stretch.len()).max();
            let is_faulty = view.faults.iter().any(|fault| fault.pass == Some(pass));
            for (stretch, is_near) in stretches() {
                let pen = match (is_near, is_faulty) {
                    (true, false) => Pen::Feed,
                    (true, true) => Pen::Faulty,
                    (false, true) => Pen::Hidden,
                    (false, false) => continue,
                };
                let points = stretch.iter().map(|spot| (self.place)(spot.position)).collect();
                let is_longest = is_near && Some(stretch.len()) == longest;
                let caption = is_longest.then(|| format!("{}", pass + 1));
                strokes.push(Stroke { caption, ..Stroke::new(pen, Shape::Line(points)) });
            }
        }
        strokes
    }

    fn faults(&self, view: &FluteView) -> Vec<Mark> {
        let mark = |fault: &Fault| {
            let behind = (self.towards)(fault.point.normal) <= FACING;
            let side = if behind { " (far side)" } else { "" };
            let pass = fault.pass.map(|pass| format!("pass {}{side}", pass + 1));
            let what = fault.labels.iter().enumerate().map(|(index, what)| match (index, fault.pass) {
                (0, None) => format!("{what}{side}"),
                _ => (*what).to_owned(),
            });
            let label = pass.into_iter().chain(what).collect();
            Mark { label, ..Mark::new((self.place)(fault.point.position), fault.status) }
        };
        view.faults.iter().map(mark).collect()
    }
}

/// Builds a picture; `edges` are drawn over the flutes.
fn picture(view: &FluteView, what: &str, seen: &Viewpoint, axes: [&str; 2], edges: Vec<Stroke>) -> Picture {
    let strokes: Vec<Stroke> = seen.flutes(view).into_iter().chain(edges).collect();
    let signs = [
        (HoleStatus::Bad, "Fault, at its worst point"),
        (HoleStatus::Missing, "Position of a missing flute"),
        (HoleStatus::Extra, "Extra flute"),
    ];
    let signs =
        signs.into_iter().filter(|(status, _)| view.faults.iter().any(|fault| fault.status == *status));
    let lines = [
        (Pen::Feed, "Wheel contact path on the near side, with the number of its pass"),
        (Pen::Faulty, "Pass with a fault"),
        (Pen::Hidden, "Pass with a fault, on the far side"),
        (Pen::Outline, "Tooth bottom"),
        (Pen::Construction, "Polar angle at which flutes end"),
    ];
    let lines = lines.into_iter().filter(|(pen, _)| strokes.iter().any(|stroke| stroke.pen == *pen));
    let legend = signs.map(|(status, words)| LegendItem::new(Sample::Status(status), words));
    let legend = legend.chain(lines.map(|(pen, words)| LegendItem::new(Sample::Pen(pen), words))).collect();
    let [right, up] = axes.map(str::to_owned);
    let axes = vec![Axis { name: right, direction: [1.0, 0.0] }, Axis { name: up, direction: [0.0, 1.0] }];
    Picture {
        title: Title {
            name: view.name.clone(),
            view: what.to_owned(),
            position: None,
            verdict: Some(view.verdict.clone()),
            lines: view.lines.clone(),
            caution: "Predicted by simulation, not measured; the wheel is one point".to_owned(),
        },
        scene: Scene { axes, strokes, marks: seen.faults(view), zone: None },
        legend,
        chart: None,
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
    fn what_faces_away_is_not_drawn() {
        let (front, back) = ([0.0, 0.0, 1.0], [0.0, 0.0, -1.0]);
        let seen = paths(&side_view(&view([front, front, back, front])));
        assert_eq!(seen, [vec![[0.0, 1.0], [1.0, 1.0]]]);
        // From the tip, the surface of the cylinder is edge-on.
        assert!(paths(&tip_view(&view([front, front, front, front]))).is_empty());
        let nose = [-0.5, 0.0, 0.8];
        assert_eq!(paths(&tip_view(&view([front, nose, nose, nose]))), [vec![[2.0, 1.0]; 3]]);
    }
}
