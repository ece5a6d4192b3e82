//! A burr from the side and from its tip: its outline and the flutes on the side towards the reader.
//!
//! From the side x points to the right and y up, so the tip is at the left, as on the machine. From the tip z points to
//! the right and y up.
use super::super::role::{HoleStatus, Pen, Point};
use super::super::scene::{Axis, LegendItem, Mark, Sample, Scene, Shape, Stroke, Title};
use super::helix::HelixCourses;

/// What pictures of a burr are made of; mm and degrees.
#[derive(Clone, Debug)]
pub struct FluteView {
    /// Of the program.
    pub name: String,
    pub verdict: (HoleStatus, String),
    /// Further lines of the title block.
    pub lines: Vec<String>,
    /// Along the axis and away from it, from the shank's end of the flutes to the pole.
    pub outline: Vec<[f64; 2]>,
    /// Of the circle at which the flutes end.
    pub tip_radius: f64,
    /// Of each pass, in the order in which they are ground.
    pub flutes: Vec<Vec<FlutePoint>>,
    pub faults: Vec<Fault>,
    pub helix: HelixCourses,
}

/// Where something is wrong.
#[derive(Clone, Debug)]
pub struct Fault {
    pub point: FlutePoint,
    /// Counted from 0; none where no pass is.
    pub pass: Option<usize>,
    pub status: HoleStatus,
    /// What is wrong there, each in few words; empty where another mark of the same finding says it.
    pub labels: Vec<&'static str>,
}

/// A point of a flute in the part's frame, and the direction out of the surface there.
#[derive(Clone, Copy, Debug)]
pub struct FlutePoint {
    pub position: [f64; 3],
    pub normal: [f64; 3],
}

/// Edge-on is not seen.
const FACING: f64 = 1e-6;

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

/// From where the burr is looked at.
struct Viewpoint {
    /// A point of the part on the sheet.
    place: fn([f64; 3]) -> Point,
    /// How much of a direction comes towards the reader.
    towards: fn([f64; 3]) -> f64,
}

impl Viewpoint {
    /// The stretches of the flutes whose surface faces the reader, and all of a flute with a fault; the longest that is
    /// seen of each pass has its number.
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

/// All but the axes and the marks.
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
        // On the cylinder the surface is seen edge-on from the tip.
        assert!(paths(&tip_view(&view([front, front, front, front]))).is_empty());
        let nose = [-0.5, 0.0, 0.8];
        assert_eq!(paths(&tip_view(&view([front, nose, nose, nose]))), [vec![[2.0, 1.0]; 3]]);
    }
}
