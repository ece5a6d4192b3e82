//! A burr from the side and from its tip: its outline and the flutes on the near side.
//!
//! In the side view x points to the right and y up, so the tip is at the left, as on the machine. In the tip
//! view z points to the right and y up.
use super::super::role::{HoleStatus, Pen, Point};
use super::super::scene::{Axis, LegendItem, Mark, Sample, Scene, Shape, Stroke, Title};
use super::flute_view::{Fault, FlutePoint, FluteView};

/// Least component of a normal towards the reader at which the surface counts as visible.
const FACING: f64 = 1e-6;

/// Builds the scene of a burr seen from +z, the tip to the left.
pub fn side_view(view: &FluteView) -> Scene {
    let seen = Viewpoint { place: |[x, y, _]| [x, y], towards: |[_, _, z]| z };
    let mut strokes = seen.flutes(view);
    let below = view.outline.iter().rev().map(|[x, r]| [*x, -r]);
    let mut outline: Vec<Point> = view.outline.iter().copied().chain(below).collect();
    outline.extend(view.outline.first().copied());
    strokes.push(Stroke { shape: Shape::Line(outline), pen: Pen::Outline, caption: None });
    let axes = vec![axis("x", [1.0, 0.0]), axis("y", [0.0, 1.0])];
    let what = "Side view, seen from +z, the tip to the left; y at the end of the cylinder";
    Scene { axes, marks: seen.faults(view), ..scene(view, what, strokes) }
}

/// Builds the scene of a burr seen from −x along its axis.
pub fn tip_view(view: &FluteView) -> Scene {
    let seen = Viewpoint { place: |[_, y, z]| [z, y], towards: |[x, _, _]| -x };
    let mut strokes = seen.flutes(view);
    let circle = |radius: f64, pen: Pen| Stroke {
        shape: Shape::Circle { centre: [0.0, 0.0], radius },
        pen,
        caption: None,
    };
    let radius = view.outline.first().map_or(0.0, |[_, r]| *r);
    strokes.push(circle(radius, Pen::Outline));
    strokes.push(circle(view.tip_radius, Pen::Construction));
    let axes = vec![axis("z", [1.0, 0.0]), axis("y", [0.0, 1.0])];
    let mut scene = scene(view, "Tip view, seen from −x along the axis", strokes);
    scene.legend.push(item(Sample::Pen(Pen::Construction), "Polar angle at which flutes end"));
    Scene { axes, marks: seen.faults(view), ..scene }
}

fn axis(name: &str, direction: Point) -> Axis {
    Axis { name: name.to_owned(), direction }
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
                strokes.push(Stroke { shape: Shape::Line(points), pen, caption });
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
            Mark {
                position: (self.place)(fault.point.position),
                radius: 0.0,
                status: fault.status,
                label: pass.into_iter().chain(what).collect(),
                direction: None,
                deviation: None,
                actual: None,
            }
        };
        view.faults.iter().map(mark).collect()
    }
}

fn item(sample: Sample, text: &str) -> LegendItem {
    LegendItem { sample, text: text.to_owned() }
}

/// Builds the scene except its axes and marks.
fn scene(view: &FluteView, what: &str, strokes: Vec<Stroke>) -> Scene {
    let is_there = |standing: HoleStatus| view.faults.iter().any(|fault| fault.status == standing);
    let signs = [
        (HoleStatus::Bad, "Fault, at its worst point"),
        (HoleStatus::Missing, "Position of a missing flute"),
        (HoleStatus::Extra, "Extra flute"),
    ];
    let signs = signs.into_iter().filter(|(standing, _)| is_there(*standing));
    let mut legend: Vec<LegendItem> =
        signs.map(|(standing, words)| item(Sample::Status(standing), words)).collect();
    let lines = [
        (Pen::Feed, "Wheel contact path on the near side, with the number of its pass"),
        (Pen::Faulty, "Pass with a fault"),
        (Pen::Hidden, "Pass with a fault, on the far side"),
        (Pen::Outline, "Tooth bottom"),
    ];
    let drawn = lines.into_iter().filter(|(pen, _)| strokes.iter().any(|stroke| stroke.pen == *pen));
    legend.extend(drawn.map(|(pen, words)| item(Sample::Pen(pen), words)));
    Scene {
        title: Title {
            name: view.name.clone(),
            view: what.to_owned(),
            position: None,
            verdict: Some(view.verdict.clone()),
            lines: view.lines.clone(),
            caution: "Predicted by simulation, not measured; the wheel is one point".to_owned(),
        },
        strokes,
        legend,
        ..Scene::default()
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

    fn paths(scene: &Scene) -> Vec<Vec<Point>> {
        let lines = scene.strokes.iter().filter(|stroke| stroke.pen == Pen::Feed);
        lines
            .filter_map(|stroke| match &stroke.shape {
                Shape::Line(points) => Some(points.clone()),
                Shape::Circle { .. } => None,
            })
            .collect()
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
