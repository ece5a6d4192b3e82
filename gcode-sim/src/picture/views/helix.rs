//! The helix angle of a flute over the polar angle from the tip: as measured, and as each law has it.
use super::super::scene::{LegendItem, Pen, Point, Sample, Scene, Shape, Stroke, Title};
use super::flutes::FluteView;

/// Degrees from line to line of the grid.
const GRID: usize = 15;

pub fn helix_graph(view: &FluteView) -> Scene {
    let curve = |points: &[Point], pen: Pen| Stroke {
        shape: Shape::Line(points.iter().map(|[polar, angle]| [*polar, angle.abs()]).collect()),
        pen,
        caption: None,
    };
    let line = |ends: [Point; 2], pen: Pen| Stroke { shape: Shape::Line(ends.to_vec()), pen, caption: None };
    let mut strokes = Vec::new();
    for degrees in (0..=90).step_by(GRID) {
        let at = degrees as f64;
        let edge = if degrees == 0 { Pen::Outline } else { Pen::Grid };
        strokes.push(line([[at, 0.0], [at, 90.0]], edge));
        strokes.push(line([[0.0, at], [90.0, at]], edge));
    }
    strokes.push(curve(&view.measured, Pen::Feed));
    strokes.push(curve(&view.constant_helix, Pen::First));
    strokes.push(curve(&view.published, Pen::Second));
    let item = |pen: Pen, text: &str| LegendItem { sample: Sample::Pen(pen), text: text.to_owned() };
    Scene {
        title: Title {
            name: view.name.clone(),
            view: "Helix angle (up) over the polar angle θ from the tip (to the right), degrees".to_owned(),
            position: None,
            verdict: Some(view.verdict.clone()),
            lines: view.lines.clone(),
            caution: "Predicted by simulation, not measured".to_owned(),
        },
        strokes,
        graph: Some(GRID),
        legend: vec![
            item(Pen::Feed, "Measured, on the worst flute"),
            item(Pen::First, "Law constant-helix"),
            item(Pen::Second, "Law published"),
        ],
        ..Scene::default()
    }
}
