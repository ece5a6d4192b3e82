//! The development: a cylinder about x, cut open along one line and unrolled.
//!
//! It is seen from outside: the azimuth (from z towards y) grows to the right, from 0 to 360, and x goes down. The cut
//! is the seam: its left and its right edge are the same line of the part.
use super::super::measure::plain;
use super::super::scene::{Axis, LegendItem, Mark, Misfit, Pen, Point, Sample, Scene, Shape, Stroke, Title};
use super::side::off;
use super::top::{Cylinder, DrawnHole, TopView, headline, label, standings, worst};
use crate::part::hole::Hole;
use crate::units::Deg;

/// Of more holes those that are as wanted have neither number nor dial: they would hide each other.
const NUMBERED: usize = 60;

/// The scene of a development; `None` of a part that is no cylinder.
pub fn development(view: &TopView) -> Option<Scene> {
    let sheet = Unrolled(view.cylinder?);
    let mut marks: Vec<Mark> = view.holes.iter().filter_map(|hole| sheet.mark(hole, view)).collect();
    if NUMBERED < marks.len() {
        for mark in marks.iter_mut().filter(|mark| mark.standing.is_good()) {
            mark.label.clear();
            mark.misfit = None;
        }
    }
    if NUMBERED < marks.iter().filter(|mark| !mark.label.is_empty()).count() {
        marks.iter_mut().for_each(|mark| mark.label.clear());
    }
    let title = Title {
        name: view.name.clone(),
        view: format!("Development of diameter {}, seen from outside", plain(2.0 * sheet.0.radius)),
        position: view.tolerance,
        verdict: headline(view),
        lines: worst(view)
            .into_iter()
            .chain(view.lines.iter().cloned())
            .chain([format!("x from 0 to {}", plain(sheet.0.length))])
            .collect(),
        caution: "Predicted by simulation, not measured".to_owned(),
    };
    let axes = vec![
        Axis { name: view.rotary.clone(), direction: [1.0, 0.0] },
        Axis { name: "x".to_owned(), direction: [0.0, -1.0] },
    ];
    let legend = legend(view, &marks);
    Some(Scene { title, axes, strokes: sheet.strokes(), marks, zone: view.tolerance, legend, graph: None })
}

/// Places of the cylinder on the sheet, mm.
struct Unrolled(Cylinder);

impl Unrolled {
    fn width(&self) -> f64 {
        std::f64::consts::TAU * self.0.radius
    }

    /// Right of the seam, 0 to 360; what stands on it, whichever way rounding goes, at its left.
    fn right(&self, entry: [f64; 3]) -> f64 {
        let turn = Deg::atan2(entry[1], entry[2]).0.rem_euclid(360.0);
        let turn = if turn > 360.0 - 1e-3 { turn - 360.0 } else { turn };
        Deg(turn).to_rad() * self.0.radius
    }

    fn place(&self, hole: &Hole) -> Point {
        // 0 − x: no negative zeros.
        [self.right(hole.entry), 0.0 - hole.entry[0]]
    }

    fn mark(&self, hole: &DrawnHole, view: &TopView) -> Option<Mark> {
        let shown = hole.nominal.as_ref().or(hole.found.as_ref())?;
        let both = hole.nominal.as_ref().zip(hole.found.as_ref());
        Some(Mark {
            at: self.place(shown),
            radius: shown.diameter.unwrap_or(0.0) / 2.0,
            standing: hole.standing,
            label: label(hole, view),
            direction: None,
            misfit: both.and_then(|(nominal, found)| misfit(nominal, found)),
            found: None,
        })
    }

    /// The seam, a quarter turn each, and where the pattern begins and ends.
    fn strokes(&self) -> Vec<Stroke> {
        let (width, length) = (self.width(), self.0.length);
        let beyond = 0.05 * width;
        let line = |from: Point, to: Point, pen: Pen, caption: Option<String>| Stroke {
            shape: Shape::Line(vec![from, to]),
            pen,
            caption,
        };
        let mut strokes = Vec::new();
        for quarter in 0..=4u8 {
            let (at, degrees) = (width * f64::from(quarter) / 4.0, 90 * u32::from(quarter));
            let pen = if quarter % 4 == 0 { Pen::Outline } else { Pen::Construction };
            strokes.push(line([at, 0.0], [at, 0.0 - length], pen, None));
            // The number stands beyond the pattern, where no hole is.
            let caption = Some(format!("{degrees}°"));
            strokes.push(line([at, 0.0 - length], [at, 0.0 - length - beyond], Pen::Construction, caption));
        }
        for x in [0.0, length] {
            strokes.push(line([0.0, 0.0 - x], [width, 0.0 - x], Pen::Construction, None));
        }
        strokes
    }
}

/// Actual − nominal along the circumference and along x.
fn misfit(nominal: &Hole, found: &Hole) -> Option<Misfit> {
    let azimuth = Deg::atan2(nominal.axis[1], nominal.axis[2]);
    let end = |depth: f64| {
        let off = off(nominal, found, depth)?;
        Some([off.y * azimuth.cos() - off.z * azimuth.sin(), 0.0 - off.x])
    };
    Some(Misfit { entry: end(0.0)?, bottom: end(nominal.depth)? })
}

fn legend(view: &TopView, marks: &[Mark]) -> Vec<LegendItem> {
    let item = |sample: Sample, text: String| LegendItem { sample, text };
    let mut items = standings(view);
    if let Some(zone) = view.tolerance.filter(|_| marks.iter().any(|m| m.misfit.is_some())) {
        let text = format!("{} Φ{}, seen along the hole,", view.question.misfit(), plain(zone));
        items.push(item(Sample::Misfit, text));
    }
    items.push(item(Sample::Pen(Pen::Outline), "seam: both edges are one line".to_owned()));
    items.push(item(Sample::Pen(Pen::Construction), "quarter turns, ends of the pattern".to_owned()));
    items
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::scene::Standing;

    fn hole(x: f64, azimuth: f64, radius: f64) -> Hole {
        let (s, c) = (Deg(azimuth).sin(), Deg(azimuth).cos());
        let entry = [x, radius * s, radius * c];
        Hole { id: None, entry, axis: [0.0, s, c], depth: 5.0, diameter: Some(3.0), from: None }
    }

    fn drawn(nominal: Hole, found: Hole) -> DrawnHole {
        DrawnHole {
            id: "1".to_owned(),
            nominal: Some(nominal),
            found: Some(found),
            standing: Standing::Good,
            phi: None,
            turn: None,
            remark: None,
        }
    }

    fn scene(hole: DrawnHole) -> Scene {
        let cylinder = Some(Cylinder { outer: 110.0, radius: 100.0, length: 60.0 });
        development(&TopView { cylinder, holes: vec![hole], ..TopView::default() }).unwrap()
    }

    /// A quarter turn of radius 100 is 157.08 mm, on whichever diameter the hole begins.
    #[test]
    fn azimuth_goes_right_as_an_arc_and_x_down() {
        let mark = scene(drawn(hole(20.0, 90.0, 110.0), hole(20.0, 90.0, 112.0))).marks.remove(0);
        assert!((mark.at[0] - 157.079_632_679).abs() < 1e-6 && mark.at[1] == -20.0, "{mark:?}");
    }

    #[test]
    fn what_stands_on_the_seam_stands_at_its_left() {
        for azimuth in [0.0, 360.0, -0.000_1, 359.999_9] {
            let mark = scene(drawn(hole(0.0, azimuth, 100.0), hole(0.0, azimuth, 100.0))).marks.remove(0);
            assert!(mark.at[0].abs() < 0.001, "{azimuth}: {mark:?}");
        }
        let mark = scene(drawn(hole(0.0, -1.0, 100.0), hole(0.0, -1.0, 100.0))).marks.remove(0);
        assert!((mark.at[0] - 359.0 * 100.0 * std::f64::consts::PI / 180.0).abs() < 1e-6);
    }

    /// 0.02 mm towards larger azimuth at 90°, where that is −z, and 0.03 mm in x.
    #[test]
    fn a_misfit_points_where_the_hole_is() {
        let mut found = hole(20.03, 90.0, 100.0);
        found.entry[2] -= 0.02;
        let misfit = scene(drawn(hole(20.0, 90.0, 100.0), found)).marks[0].misfit.unwrap();
        assert!((misfit.entry[0] - 0.02).abs() < 1e-9 && (misfit.entry[1] + 0.03).abs() < 1e-9, "{misfit:?}");
    }
}
