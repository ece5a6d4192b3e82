//! A burr from the side and from its tip: its outline and the flutes on the side towards the reader.
//!
//! From the side x points to the right and y up, so the tip is at the left, as on the machine. From the tip z points to
//! the right and y up.
use super::super::scene::{Axis, LegendItem, Pen, Point, Sample, Scene, Shape, Standing, Stroke, Title};

/// What pictures of a burr are made of; mm and degrees.
#[derive(Clone, Debug)]
pub struct FluteView {
    /// Of the program.
    pub name: String,
    pub verdict: (Standing, String),
    /// Further lines of the title block.
    pub lines: Vec<String>,
    /// Along the axis and away from it, from the shank's end of the flutes to the pole.
    pub outline: Vec<[f64; 2]>,
    /// Of the circle at which the flutes end.
    pub tip_radius: f64,
    pub flutes: Vec<Vec<Spot>>,
    /// Polar angle and helix angle along the flute that is farthest from the law.
    pub measured: Vec<Point>,
    /// The same as each law has it.
    pub constant_helix: Vec<Point>,
    pub published: Vec<Point>,
}

/// A point of a flute in the part's frame, and the direction out of the surface there.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    pub at: [f64; 3],
    pub out: [f64; 3],
}

/// Edge-on is not seen.
const FACING: f64 = 1e-6;

pub fn side_view(view: &FluteView) -> Scene {
    let mut strokes = flutes(view, |[x, y, _]| [x, y], |[_, _, z]| z);
    let below = view.outline.iter().rev().map(|[x, r]| [*x, -r]);
    let mut outline: Vec<Point> = view.outline.iter().copied().chain(below).collect();
    outline.extend(view.outline.first().copied());
    strokes.push(Stroke { shape: Shape::Line(outline), pen: Pen::Outline, caption: None });
    let radius = view.outline.first().map_or(0.0, |[_, r]| *r);
    strokes.push(Stroke {
        shape: Shape::Line(vec![[0.0, -radius], [0.0, radius]]),
        pen: Pen::Construction,
        caption: None,
    });
    let axes = vec![axis("x", [1.0, 0.0]), axis("y", [0.0, 1.0])];
    scene(view, "Side view, seen from +z, the tip to the left", strokes, axes, "End of the cylinder")
}

pub fn tip_view(view: &FluteView) -> Scene {
    let mut strokes = flutes(view, |[_, y, z]| [z, y], |[x, _, _]| -x);
    let circle = |radius: f64, pen: Pen| Stroke {
        shape: Shape::Circle { centre: [0.0, 0.0], radius },
        pen,
        caption: None,
    };
    let radius = view.outline.first().map_or(0.0, |[_, r]| *r);
    strokes.push(circle(radius, Pen::Outline));
    strokes.push(circle(view.tip_radius, Pen::Construction));
    let axes = vec![axis("z", [1.0, 0.0]), axis("y", [0.0, 1.0])];
    scene(view, "Tip view, seen from −x along the axis", strokes, axes, "Polar angle at which flutes end")
}

fn axis(name: &str, direction: Point) -> Axis {
    Axis { name: name.to_owned(), direction }
}

/// The stretches of the flutes whose surface faces the reader.
fn flutes(
    view: &FluteView,
    seen: impl Fn([f64; 3]) -> Point,
    towards: impl Fn([f64; 3]) -> f64,
) -> Vec<Stroke> {
    let mut strokes = Vec::new();
    let mut stretch: Vec<Point> = Vec::new();
    let mut end = |stretch: &mut Vec<Point>| {
        if 1 < stretch.len() {
            let shape = Shape::Line(std::mem::take(stretch));
            strokes.push(Stroke { shape, pen: Pen::Feed, caption: None });
        }
        stretch.clear();
    };
    for flute in &view.flutes {
        for spot in flute {
            if FACING < towards(spot.out) {
                stretch.push(seen(spot.at));
            } else {
                end(&mut stretch);
            }
        }
        end(&mut stretch);
    }
    strokes
}

fn scene(view: &FluteView, what: &str, strokes: Vec<Stroke>, axes: Vec<Axis>, construction: &str) -> Scene {
    let item = |pen: Pen, text: &str| LegendItem { sample: Sample::Pen(pen), text: text.to_owned() };
    Scene {
        title: Title {
            name: view.name.clone(),
            view: what.to_owned(),
            position: None,
            verdict: Some(view.verdict.clone()),
            lines: view.lines.clone(),
            caution: "Predicted by simulation, not measured; the wheel is one point".to_owned(),
        },
        axes,
        strokes,
        legend: vec![
            item(Pen::Feed, "Path of the wheel's contact, on the side that is seen"),
            item(Pen::Outline, "Tooth bottom"),
            item(Pen::Construction, construction),
        ],
        ..Scene::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(out: [[f64; 3]; 4]) -> FluteView {
        let spot = |(n, out): (usize, [f64; 3])| Spot { at: [n as f64, 1.0, 2.0], out };
        FluteView {
            name: "b".to_owned(),
            verdict: (Standing::Good, "PASS".to_owned()),
            lines: Vec::new(),
            outline: vec![[5.0, 2.0], [0.0, 2.0], [-2.0, 0.0]],
            tip_radius: 0.5,
            flutes: vec![out.into_iter().enumerate().map(spot).collect()],
            measured: Vec::new(),
            constant_helix: Vec::new(),
            published: Vec::new(),
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
