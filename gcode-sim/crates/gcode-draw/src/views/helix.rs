//! Graphs of the helix angle along the flutes: actual, nominal with tolerance, and deviation.
use super::flute_view::{FluteView, HelixCourses, HelixPoint};
use crate::chart::{Chart, ChartMarker, Curve, Graph};
use crate::picture::{LegendItem, Picture, Sample, Title};
use crate::scene::{HoleStatus, Pen, Point};
use gcode_part::exceeds;

/// Height of a tolerance band, in parts of the graph's height, below which it is drawn as a line.
const MIN_BAND_SHARE: f64 = 0.1;
/// Least enlargement of deviations that justifies a separate graph.
const MIN_MAGNIFICATION: f64 = 2.0;

/// Builds the picture with the graphs of the helix angle.
pub fn helix_graph(view: &FluteView) -> Picture {
    let helix = &view.helix;
    let mut graphs = vec![helix.angles()];
    if helix.needs_deviations() {
        graphs.push(helix.deviations());
    }
    let chart = Chart {
        x_label: "Along the outline from the shank end, mm; above: polar angle θ on the nose".to_owned(),
        guides: helix.nose.clone(),
        gaps: Vec::new(),
        graphs,
    };
    Picture {
        title: Title {
            name: view.name.clone(),
            view: "Helix angle along the flutes; below 0 left-hand".to_owned(),
            position: None,
            verdict: Some(view.verdict.clone()),
            lines: view.lines.clone(),
            caution: "Predicted by simulation, not measured".to_owned(),
        },
        legend: helix.legend(),
        chart: Some(chart),
        ..Picture::default()
    }
}

impl HelixCourses {
    /// Returns the pass with the largest deviation from the law; the laws alone if no pass is ground.
    fn shown(&self) -> &[HelixPoint] {
        self.passes.get(self.worst_pass).filter(|pass| !pass.is_empty()).unwrap_or(&self.nominal)
    }

    /// Returns the curves of all passes, the worst last, on top.
    fn curves(&self, value: impl Fn(&HelixPoint) -> f64) -> Vec<Curve> {
        let others = self.passes.iter().enumerate().filter(|(pass, _)| *pass != self.worst_pass);
        let all = others.map(|(_, pass)| (pass, Pen::MeasuredOther));
        let worst = self.passes.get(self.worst_pass).map(|pass| (pass, Pen::Measured));
        all.chain(worst).map(|(pass, pen)| curve(pass, pen, &value)).collect()
    }

    /// Returns true if the tolerance band is too thin in the graph of angles and a separate graph enlarges it.
    fn needs_deviations(&self) -> bool {
        let all = || self.passes.iter().flatten();
        let angles = spread(all().flat_map(|at| [at.actual, at.nominal]));
        let band = 2.0 * self.tolerance;
        let off = band.max(spread(all().map(HelixPoint::error).chain([0.0])));
        band < MIN_BAND_SHARE * angles && MIN_MAGNIFICATION * off < angles
    }

    fn angles(&self) -> Graph {
        let shown = self.shown();
        let mut curves = vec![Curve { is_clipped: true, ..curve(shown, Pen::Comparison, |at| at.other_law) }];
        curves.extend(self.curves(|at| at.actual));
        curves.push(curve(shown, Pen::Nominal, |at| at.nominal));
        let allowed =
            |at: &HelixPoint| [at.path_length, at.nominal - self.tolerance, at.nominal + self.tolerance];
        Graph {
            y_label: "Helix angle, degrees".to_owned(),
            curves,
            band: shown.iter().map(allowed).collect(),
            has_zero_line: false,
            markers: self.sign(|at| at.actual).into_iter().collect(),
        }
    }

    fn deviations(&self) -> Graph {
        let allowed = |at: &HelixPoint| [at.path_length, -self.tolerance, self.tolerance];
        Graph {
            y_label: "Deviation from the specified helix angle, degrees".to_owned(),
            curves: self.curves(HelixPoint::error),
            band: self.shown().iter().map(allowed).collect(),
            has_zero_line: true,
            markers: self.sign(HelixPoint::error).into_iter().collect(),
        }
    }

    /// Returns the largest deviation of a pass if it exceeds the tolerance.
    fn fault(&self, pass: &[HelixPoint]) -> Option<HelixPoint> {
        let worst = pass.iter().copied().max_by(|a, b| a.error().abs().total_cmp(&b.error().abs()))?;
        exceeds(worst.error().abs(), self.tolerance).then_some(worst)
    }

    fn sign(&self, value: impl Fn(&HelixPoint) -> f64) -> Option<ChartMarker> {
        let worst = self.fault(self.passes.get(self.worst_pass)?)?;
        let others = self.passes.iter().filter(|pass| self.fault(pass).is_some()).count() - 1;
        let more = if others == 0 { String::new() } else { format!(", and {others} more") };
        Some(ChartMarker {
            position: [worst.path_length, value(&worst)],
            status: HoleStatus::Bad,
            name: format!("pass {}{more}", self.worst_pass + 1),
        })
    }

    fn legend(&self) -> Vec<LegendItem> {
        let [asked, other] = self.laws;
        let pen = |pen: Pen, text: String| Some(LegendItem::new(Sample::Pen(pen), text));
        let is_ground = !self.passes.is_empty();
        let sample = Sample::Status(HoleStatus::Bad);
        let fault = self.sign(|at| at.actual).map(|_| LegendItem::new(sample, "Fault: out of tolerance"));
        let worst = format!("Pass {}, the largest deviation from the law", self.worst_pass + 1);
        let items = [
            fault,
            pen(Pen::Measured, worst).filter(|_| is_ground),
            pen(Pen::MeasuredOther, "The other passes".to_owned()).filter(|_| 1 < self.passes.len()),
            pen(Pen::Nominal, format!("Specified: law {asked}")),
            pen(Pen::Limit, format!("Tolerance: ±{}°", self.tolerance)),
            pen(Pen::Comparison, format!("Law {other}, for comparison")),
        ];
        items.into_iter().flatten().collect()
    }
}

/// Returns the difference of the greatest and the least value; negative without values.
fn spread(values: impl Iterator<Item = f64>) -> f64 {
    let reach = |(low, high): (f64, f64), value: f64| (low.min(value), high.max(value));
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), reach);
    high - low
}

fn curve(points: &[HelixPoint], pen: Pen, value: impl Fn(&HelixPoint) -> f64) -> Curve {
    let points: Vec<Point> = points.iter().map(|at| [at.path_length, value(at)]).collect();
    Curve { points, pen, is_clipped: false }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn courses(off: &[f64]) -> HelixCourses {
        let at = |way: f64, off: f64| HelixPoint {
            path_length: way,
            actual: 20.0 + off,
            nominal: 20.0,
            other_law: 20.0 + way,
        };
        let passes: Vec<Vec<HelixPoint>> = off
            .iter()
            .map(|off| (0..=10).map(|n| at(f64::from(n), if n == 6 { *off } else { 0.01 })).collect())
            .collect();
        let worst = (0..off.len()).max_by(|a, b| off[*a].abs().total_cmp(&off[*b].abs())).unwrap_or(0);
        let laws = ["constant-helix", "published"];
        HelixCourses { passes, worst_pass: worst, tolerance: 0.3, laws, ..HelixCourses::default() }
    }

    /// A band of 0.6° in 40° of angles is too thin; a fault of 30° is as visible there as in a separate graph.
    #[test]
    fn a_thin_tolerance_band_gets_a_separate_graph_of_deviations() {
        let turning = |off: f64| {
            let mut helix = courses(&[off]);
            for at in &mut helix.passes[0] {
                (at.actual, at.nominal) =
                    (at.actual + 4.0 * at.path_length, at.nominal + 4.0 * at.path_length);
            }
            helix.needs_deviations()
        };
        assert!(!courses(&[0.2]).needs_deviations());
        assert!(turning(0.2) && turning(-1.0));
        assert!(!courses(&[-30.0]).needs_deviations() && !turning(30.0));
    }

    #[test]
    fn the_largest_deviation_has_a_marker() {
        let helix = courses(&[0.1, -0.4, 0.35]);
        let sign = helix.sign(|at| at.actual).unwrap();
        assert_eq!((sign.position, sign.name.as_str()), ([6.0, 19.6], "pass 2, and 1 more"));
        assert!(courses(&[0.1, -0.29]).sign(|at| at.actual).is_none());
    }

    #[test]
    fn the_graph_distinguishes_left_and_right_hand() {
        let mut helix = courses(&[0.0]);
        helix.passes[0].iter_mut().for_each(|at| at.actual = -20.0);
        let graph = helix.angles();
        let ground = graph.curves.iter().find(|curve| curve.pen == Pen::Measured).unwrap();
        assert!(ground.points.iter().all(|point| point[1] == -20.0));
        assert_eq!(graph.markers[0].position[1], -20.0);
    }
}
