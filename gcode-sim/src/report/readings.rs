//! Readings of an edge finder along the surface: as JSON, as a table, as CSV, and as a curve.
use std::fmt::Write;

use schemars::JsonSchema;
use serde::Serialize;

use crate::report::figures::count;
use gcode_control::Outcome;
use gcode_draw::{Chart, Curve, Graph, Pen, Plot, PlotBody};
use gcode_inspect::stylus::{Gap, Reading, ReadingPass};
use gcode_inspect::verify::Answer;
use gcode_lang::diag::Severity;
use gcode_session::StylusRun;

/// The readings of an edge finder; lengths in mm.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct ReadingsReport {
    basis: &'static str,
    /// Radius of the ball.
    radius: f64,
    /// Tolerance of a reading, either way, if given.
    tolerance: Option<f64>,
    /// A pass requires a complete run with readings on the whole path.
    verdict: Option<Answer>,
    /// Outcome of the run: end, alarm or limit.
    outcome: &'static str,
    least: Option<f64>,
    greatest: Option<f64>,
    passes: Vec<PassRow>,
    findings: Vec<FindingRow>,
    #[serde(skip)]
    gaps: Vec<Gap>,
    /// Numbers of feeds towards the surface and away from it.
    #[serde(skip)]
    approach_retract_counts: [usize; 2],
    #[serde(skip)]
    name: String,
}

#[derive(Debug, Serialize, JsonSchema)]
struct FindingRow {
    code: String,
    severity: &'static str,
    message: String,
    program: Option<String>,
    line: Option<u32>,
}

#[derive(Debug, Serialize, JsonSchema)]
struct PassRow {
    moves: usize,
    length: f64,
    least: f64,
    greatest: f64,
    readings: Vec<ReadingRow>,
}

#[derive(Debug, Serialize, JsonSchema)]
struct ReadingRow {
    along: f64,
    x: f64,
    y: f64,
    z: f64,
    reading: f64,
    program: String,
    line: u32,
}

impl ReadingsReport {
    /// Builds the report of the program `name`, for a ball of this radius.
    pub(crate) fn new(name: &str, following: &StylusRun, radius: f64, tolerance: Option<f64>) -> Self {
        let row = |pass: &ReadingPass, reading: &Reading| {
            let (program, line) = following.run.locate(pass.backtraces[reading.move_index].block);
            let [x, y, z] = reading.ball_centre.coords.into();
            ReadingRow { along: reading.path_length, x, y, z, reading: reading.value, program, line }
        };
        let passes: Vec<_> = following
            .readings
            .passes
            .iter()
            .filter_map(|pass| {
                let (least, greatest) = pass.extremes()?;
                Some(PassRow {
                    moves: pass.backtraces.len(),
                    length: pass.length(),
                    least: least.value,
                    greatest: greatest.value,
                    readings: pass.readings.iter().map(|reading| row(pass, reading)).collect(),
                })
            })
            .collect();
        let least = passes.iter().map(|pass| pass.least).reduce(f64::min);
        let greatest = passes.iter().map(|pass| pass.greatest).reduce(f64::max);
        let worst = least.zip(greatest).map(|(least, greatest)| greatest.max(-least));
        let within = |tolerance: f64| worst.is_some_and(|worst| worst <= tolerance);
        let findings = &following.readings.findings;
        let ended = matches!(following.run.outcome, Outcome::End);
        let whole = ended && findings.iter().all(|finding| finding.severity < Severity::Error);
        let verdict = tolerance.map(|t| if whole && within(t) { Answer::Pass } else { Answer::Fail });
        let rows = findings.iter().map(|finding| {
            let at = finding.backtrace.as_ref().map(|backtrace| following.run.locate(backtrace.block));
            let (program, line) = at.unzip();
            let (code, message) = (finding.code().into_owned(), finding.message.clone());
            FindingRow { code, severity: finding.severity.name(), message, program, line }
        });
        Self {
            basis: "predicted by simulation, not measured",
            radius,
            tolerance,
            verdict,
            outcome: match following.run.outcome {
                Outcome::End => "end",
                Outcome::Alarm(_) => "alarm",
                Outcome::Limit => "limit",
            },
            least,
            greatest,
            passes,
            findings: rows.collect(),
            gaps: following.readings.gaps.clone(),
            approach_retract_counts: following.readings.approach_retract_counts,
            name: name.to_owned(),
        }
    }

    /// Returns the verdict; `None` without a tolerance.
    pub(crate) fn verdict(&self) -> Option<Answer> {
        self.verdict
    }

    /// Returns true if no feed of the program follows the surface.
    pub(crate) fn is_empty(&self) -> bool {
        self.passes.is_empty()
    }

    /// Formats every tenth of each pass for a terminal.
    pub(crate) fn text(&self) -> String {
        let mut text = format!(
            "Readings of an edge finder, ball of radius {}: {}\nmm; above 0: gap between ball and surface; \
             below 0: stylus deflected; x y z: ball centre\n",
            self.radius, self.basis
        );
        for (index, pass) in self.passes.iter().enumerate() {
            let _ = writeln!(text, "\npass {}: {} moves along {:.3} mm", index + 1, pass.moves, pass.length);
            let _ = writeln!(text, "{:>10}{:>11}{:>11}{:>11}{:>10}", "along", "x", "y", "z", "reading");
            let mut shown = f64::NEG_INFINITY;
            for tenth in 0..=10 {
                let along = pass.length * f64::from(tenth) / 10.0;
                let distance = |row: &&ReadingRow| (row.along - along).abs();
                let nearest =
                    |one: &&ReadingRow, other: &&ReadingRow| distance(one).total_cmp(&distance(other));
                let Some(row) = pass.readings.iter().min_by(nearest) else { continue };
                if row.along <= shown {
                    continue;
                }
                shown = row.along;
                let [x, y, z, reading] = [row.x, row.y, row.z, row.reading].map(|v| plain(v, 5e-5));
                let _ = writeln!(text, "{:>10.3}{x:>11.4}{y:>11.4}{z:>11.4}{reading:>10.4}", row.along);
            }
        }
        if self.approach_retract_counts != [0, 0] {
            let [to, from] = self.approach_retract_counts.map(|n| count(n, "feed"));
            let _ = writeln!(text, "\nno reading: {to} towards the surface, {from} away from it");
        }
        let _ = writeln!(text, "\n{}", self.sentence());
        text
    }

    /// Returns `reading -0.0012 to 0.0500, spread 0.0512`, with the verdict on it.
    fn sentence(&self) -> String {
        let Some((least, greatest)) = self.least.zip(self.greatest) else {
            return "no feed follows the surface".to_owned();
        };
        let range = format!(
            "reading {:.4} to {:.4}, spread {:.4}",
            plain(least, 5e-5),
            plain(greatest, 5e-5),
            greatest - least
        );
        match (self.verdict, self.tolerance) {
            (Some(Answer::Pass), Some(t)) => format!("PASS: {range}, all within {t} of 0"),
            (Some(Answer::Fail), Some(_)) if self.outcome != "end" => {
                format!("FAIL: the program did not end; {range}")
            }
            (Some(Answer::Fail), Some(_)) if !self.gaps.is_empty() => {
                format!(
                    "FAIL: {} without a reading in the path; elsewhere {range}",
                    count(self.gaps.len(), "gap")
                )
            }
            (Some(Answer::Fail), Some(t)) if self.greatest <= Some(t) && self.least >= Some(-t) => {
                format!("FAIL: {range}; see the findings")
            }
            (Some(Answer::Fail), Some(t)) => format!("FAIL: {range}, not all within {t} of 0"),
            _ => range,
        }
    }

    /// Formats one line per reading.
    pub(crate) fn csv(&self) -> String {
        let mut text = String::from("pass,along,x,y,z,reading,program,line\n");
        for (index, pass) in self.passes.iter().enumerate() {
            for row in &pass.readings {
                let numbers =
                    [row.along, row.x, row.y, row.z, row.reading].map(|v| plain(v, 5e-13).to_string());
                let _ = writeln!(text, "{},{},{},{}", index + 1, numbers.join(","), row.program, row.line);
            }
        }
        text
    }

    /// Returns the readings over the path, pass after pass, with the gaps between them.
    pub(crate) fn plot(&self) -> Plot {
        let mut begun = 0.0;
        let (mut curves, mut gaps) = (Vec::new(), Vec::new());
        for behind in 0..=self.passes.len() {
            for gap in self.gaps.iter().filter(|gap| gap.passes_before == behind) {
                gaps.push([begun, begun + gap.length]);
                begun += gap.length;
            }
            if let Some(pass) = self.passes.get(behind) {
                let points = pass.readings.iter().map(|row| [begun + row.along, row.reading]).collect();
                curves.push(Curve { points, pen: Pen::Measured, is_clipped: false });
                begun += pass.length;
            }
        }
        let limit = |limit: f64| [0.0, begun].map(|way| [way, -limit, limit]);
        let end = |row: Option<&ReadingRow>| {
            row.map(|row| format!("x {:.3}, y {:.3}, z {:.3}", row.x, row.y, plain(row.z, 5e-4)))
        };
        let first = self.passes.first().and_then(|pass| end(pass.readings.first()));
        let last = self.passes.last().and_then(|pass| end(pass.readings.last()));
        let ends = first
            .zip(last)
            .map(|(first, last)| format!("Ball radius {}, centre from {first} to {last}", self.radius));
        Plot {
            title: format!("Edge finder along the surface, {}", self.name),
            notes: [
                Some(self.sentence()),
                (!self.gaps.is_empty()).then(|| {
                    "Between dotted lines, with a thick line at 0: feed without a reading".to_owned()
                }),
                ends,
                Some("Predicted by simulation, not measured; below 0 the stylus is deflected".to_owned()),
            ]
            .into_iter()
            .flatten()
            .collect(),
            body: PlotBody::Chart(Chart {
                x_label: "Path of the ball centre, mm".to_owned(),
                guides: Vec::new(),
                gaps,
                graphs: vec![Graph {
                    y_label: "Reading: distance of the ball from the surface, mm".to_owned(),
                    curves,
                    band: self.tolerance.into_iter().flat_map(limit).collect(),
                    has_zero_line: true,
                    markers: Vec::new(),
                }],
            }),
        }
    }
}

/// Replaces −0 and rounding residues by 0.
fn plain(value: f64, residue: f64) -> f64 {
    if value.abs() < residue { 0.0 } else { value }
}
