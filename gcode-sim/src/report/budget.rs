//! An error budget as JSON, as a table, and as bars.
use std::fmt::Write;

use schemars::JsonSchema;
use serde::Serialize;

use super::figures::count;
use gcode_draw::{Bar, Plot, PlotBody};
use gcode_inspect::budget::{Budget, BudgetRequest, ErrorShare, Statistics};
use gcode_inspect::machine::Distribution;

/// The position deviations of all holes under errors; diameters and lengths in mm.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct BudgetReport {
    basis: &'static str,
    samples: usize,
    seed: u64,
    tolerance: f64,
    holes: Vec<HoleRow>,
    /// Statistics of the worst hole of each part.
    parts: BudgetRow,
    sources: Vec<SourceRow>,
}

#[derive(Debug, Serialize, JsonSchema)]
struct BudgetRow {
    mean: f64,
    p50: f64,
    p95: f64,
    p997: f64,
    max: f64,
    within: f64,
}

#[derive(Debug, Serialize, JsonSchema)]
struct HoleRow {
    id: String,
    #[serde(flatten)]
    row: BudgetRow,
    /// Position deviation without errors.
    nominal: f64,
    sources: Vec<SourceRow>,
}

#[derive(Debug, Serialize, JsonSchema)]
struct SourceRow {
    source: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    spread: Option<String>,
    moves: f64,
    share: f64,
}

fn row(of: Statistics) -> BudgetRow {
    let Statistics { mean, p50, p95, p997, max, share_in_tolerance: within } = of;
    BudgetRow { mean, p50, p95, p997, max, within }
}

fn source_row(of: &ErrorShare, spread: Option<String>) -> SourceRow {
    SourceRow { source: of.source.clone(), spread, moves: of.displacement, share: of.share }
}

impl BudgetReport {
    pub(crate) fn new(request: &BudgetRequest<'_>, budget: &Budget) -> Self {
        let holes = budget.holes.iter().map(|hole| HoleRow {
            id: hole.id.clone(),
            row: row(hole.statistics),
            nominal: hole.nominal,
            sources: hole.shares.iter().map(|share| source_row(share, None)).collect(),
        });
        let spread = |name: &str| {
            let source =
                request.sources.iter().find(|source| source.quantity.name(request.machine) == name)?;
            Some(match source.distribution {
                Distribution::Fixed(value) => format!("fixed {value}"),
                Distribution::Normal(value) => format!("normal {value}"),
                Distribution::Uniform(value) => format!("uniform {value}"),
            })
        };
        let sources = budget.shares.iter().map(|share| source_row(share, spread(&share.source)));
        Self {
            basis: "predicted by simulation, not measured",
            samples: request.samples,
            seed: request.seed,
            tolerance: request.tolerance,
            holes: holes.collect(),
            parts: row(budget.parts),
            sources: sources.collect(),
        }
    }

    /// Formats the budget for a terminal.
    pub(crate) fn text(&self) -> String {
        let mut text = format!(
            "Position of {} in {} samples: {}\nmm; within: the share inside Φ{}; exact: without errors\n\n",
            count(self.holes.len(), "hole"),
            self.samples,
            self.basis,
            self.tolerance
        );
        let wide = self.holes.iter().map(|hole| hole.id.chars().count()).max().unwrap_or(0).clamp(5, 12);
        let _ = writeln!(
            text,
            "{:<wide$} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8}",
            "hole", "mean", "50 %", "95 %", "99.7 %", "largest", "within", "exact"
        );
        let line = |name: &str, row: &BudgetRow| {
            format!(
                "{name:<wide$} {:>8.4} {:>8.4} {:>8.4} {:>8.4} {:>8.4} {:>6.1} %",
                row.mean,
                row.p50,
                row.p95,
                row.p997,
                row.max,
                row.within * 100.0
            )
        };
        for hole in &self.holes {
            let _ = writeln!(text, "{} {:>8.4}", line(&hole.id, &hole.row), hole.nominal);
        }
        let _ = writeln!(text, "{}\n", line("worst", &self.parts));
        let wide = self.sources.iter().map(|row| row.source.len()).max().unwrap_or(0).max(6);
        let _ = writeln!(text, "{:<wide$} {:>9} {:>8}  specified", "source", "moves", "share");
        for row in &self.sources {
            let _ = writeln!(
                text,
                "{:<wide$} {:>9.5} {:>6.1} %  {}",
                row.source,
                row.moves,
                row.share * 100.0,
                row.spread.as_deref().unwrap_or("")
            );
        }
        text
    }

    /// Returns the shares of the sources as bars.
    pub(crate) fn bars(&self) -> Plot {
        let bar = |row: &SourceRow| Bar {
            name: row.source.clone(),
            length: row.share,
            text: format!("{:.1} %, {:.4} mm", row.share * 100.0, row.moves),
        };
        Plot {
            title: "Error sources: share of the mean square".to_owned(),
            notes: vec![
                format!(
                    "Worst hole of a part: Φ{:.3} at 95 %, Φ{:.3} at 99.7 %; {:.1} % of the parts within Φ{}",
                    self.parts.p95,
                    self.parts.p997,
                    self.parts.within * 100.0,
                    self.tolerance
                ),
                format!("{} samples, seed {}; {}", self.samples, self.seed, self.basis),
            ],
            body: PlotBody::Bars(self.sources.iter().map(bar).collect()),
        }
    }
}
