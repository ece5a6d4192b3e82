//! A verdict as an inspection table: nominal, actual, deviation, position, out of tolerance; and its summary.
use std::fmt::Write;

use super::figures::{count, rounded, signed, signed_to};
use gcode_inspect::verify::{
    Conclusion, Distance, ExtraHole, HoleGeometry, HoleVerdict, Neighbours, Verdict,
};
use gcode_part::{Assumption, Total, exceeds};

/// Extent and order of the table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Layout {
    /// Sorts by position deviation, the worst hole first; else in the order of the reference.
    pub worst_first: bool,
    /// Writes every column of an inspection report, four lines per hole, instead of one line.
    pub full: bool,
}

/// Largest number of holes with a line each, and the number of worst holes listed beyond it.
const LINES: usize = 100;
const OF_MANY: usize = 24;

/// Formats the verdict; lengths in mm, angles in degrees. Values are judged unrounded and shown rounded.
pub fn table(verdict: &Verdict, layout: Layout) -> String {
    let all = verdict.holes.len();
    let mut holes: Vec<&HoleVerdict> = match layout.full || all <= LINES {
        true => verdict.holes.iter().collect(),
        false => worst(&verdict.holes),
    };
    if layout.worst_first {
        holes.sort_by(|a, b| b.position_deviation.total_cmp(&a.position_deviation));
    }
    let mut text = format!(
        "Position of {} against Φ{}: {}\nmm and degrees; deviations are actual − nominal\n\n",
        count(all, "hole"),
        verdict.tolerance,
        verdict.basis
    );
    if layout.full {
        holes.iter().for_each(|hole| full(&mut text, hole, verdict.tolerance));
    } else {
        lines(&mut text, &holes);
        if holes.len() < all {
            let _ = writeln!(text, "the worst {} of {all} holes; --full lists them all", holes.len());
        }
    }
    summary(&mut text, verdict);
    text
}

/// Returns the worst holes, failed ones before others, in the order of the reference.
fn worst(holes: &[HoleVerdict]) -> Vec<&HoleVerdict> {
    let mut order: Vec<usize> = (0..holes.len()).collect();
    if OF_MANY < order.len() {
        order.select_nth_unstable_by(OF_MANY, |one, other| {
            let (a, b) = (&holes[*one], &holes[*other]);
            a.ok.cmp(&b.ok).then(b.position_deviation.total_cmp(&a.position_deviation)).then(one.cmp(other))
        });
        order.truncate(OF_MANY);
    }
    order.sort_unstable();
    order.into_iter().map(|index| &holes[index]).collect()
}

/// Names and widths of the columns between a hole's name and its verdict.
const COLUMNS: [&str; 12] = ["x", "y", "z", "dx", "dy", "dz", "entry", "bottom", "tilt", "depth", "Φ", "out"];
const WIDTHS: [usize; 12] = [9, 9, 9, 8, 8, 8, 7, 7, 7, 8, 7, 7];

/// Writes one line per hole.
fn lines(text: &mut String, holes: &[&HoleVerdict]) {
    if holes.is_empty() {
        return;
    }
    let wide = holes.iter().map(|hole| hole.id.chars().count()).max().unwrap_or(0).clamp(4, 12);
    let mut line = |name: &str, cells: [String; 12], verdict: &str| {
        let cells = cells.iter().zip(WIDTHS).map(|(cell, wide)| format!(" {cell:>wide$}"));
        let _ = writeln!(text, "{name:<wide$}{}  {verdict}", cells.collect::<String>());
    };
    line("hole", COLUMNS.map(str::to_owned), "verdict");
    for hole in holes {
        let [x, y, z] = hole.nominal.entry.map(|v| rounded(v, 3));
        let [dx, dy, dz] = off(hole).map(signed);
        let [entry, bottom, tilt] = [hole.at_entry, hole.at_bottom, hole.tilt].map(|v| rounded(v, 4));
        let [phi, out] = [hole.position_deviation, hole.out_of_tolerance].map(|v| rounded(v, 4));
        let depth = signed(hole.depth_error);
        line(&hole.id, [x, y, z, dx, dy, dz, entry, bottom, tilt, depth, phi, out], &remarks_of(hole));
    }
    text.push('\n');
}

/// Writes every column, with a line each for nominal, actual and deviation.
fn full(text: &mut String, hole: &HoleVerdict, tolerance: f64) {
    let head = ["x", "y", "z", "i", "j", "k", "d", "l"].map(|name| format!("{name:>10}")).concat();
    let _ = writeln!(text, "{:<11}{head}", format!("hole {}", hole.id));
    let columns = |placed: &HoleGeometry| {
        let [x, y, z] = placed.entry.map(|v| rounded(v, 4));
        let [i, j, k] = placed.axis.map(|v| rounded(v, 6));
        let d = placed.diameter.map_or("-".to_owned(), |d| rounded(d, 3));
        [x, y, z, i, j, k, d, rounded(placed.depth, 4)].map(|column| format!("{column:>10}")).concat()
    };
    let _ = writeln!(text, "{:<11}{}", " nominal", columns(&hole.nominal));
    let _ = writeln!(text, "{:<11}{}", " actual", columns(&hole.actual));
    let (nominal, actual) = (&hole.nominal, &hole.actual);
    let axis = [0, 1, 2].map(|i| signed_to(actual.axis[i] - nominal.axis[i], 6));
    let diameter = match (actual.diameter, nominal.diameter) {
        (Some(actual), Some(nominal)) => signed_to(actual - nominal, 3),
        _ => "-".to_owned(),
    };
    let rest = [diameter, signed(hole.depth_error)];
    let all = off(hole).map(signed).into_iter().chain(axis).chain(rest);
    let _ = writeln!(
        text,
        "{:<11}{}",
        " deviation",
        all.map(|column| format!("{column:>10}")).collect::<String>()
    );
    let _ = writeln!(
        text,
        " position   Φ{}, tolerance Φ{tolerance}, out of tolerance by {} (entry {}, bottom {}, tilt {}°)",
        rounded(hole.position_deviation, 4),
        rounded(hole.out_of_tolerance, 4),
        rounded(hole.at_entry, 4),
        rounded(hole.at_bottom, 4),
        rounded(hole.tilt, 4)
    );
    let _ = writeln!(text, " verdict    {}; made by {}", remarks_of(hole), made_by(hole));
    text.push('\n');
}

fn off(hole: &HoleVerdict) -> [f64; 3] {
    [0, 1, 2].map(|i| hole.actual.entry[i] - hole.nominal.entry[i])
}

fn remarks_of(hole: &HoleVerdict) -> String {
    let why: Vec<_> = hole.error_codes.iter().map(|code| code.trim_start_matches("hole-")).collect();
    if hole.ok { "pass".to_owned() } else { format!("FAIL {}", why.join(", ")) }
}

/// Number of missing and of extra holes that are listed; the others are counted.
const MAX_LISTED: usize = 12;

/// Writes the summary below the table: the answer, the worst hole, missing and extra holes.
fn summary(text: &mut String, verdict: &Verdict) {
    append_conclusion(text, &verdict.conclusion(), &verdict.likely_causes);
    if let (Some(worst), Some(from)) = (verdict.worst, &verdict.worst_from) {
        let _ = writeln!(
            text,
            "worst    Φ{}, tolerance Φ{}: {}",
            rounded(worst, 4),
            verdict.tolerance,
            from.replace("; ", "\n         ")
        );
        let by_phi =
            |a: &&HoleVerdict, b: &&HoleVerdict| a.position_deviation.total_cmp(&b.position_deviation);
        if let Some(hole) = verdict.holes.iter().rev().max_by(by_phi) {
            let _ = writeln!(text, "         made by {}", made_by(hole));
        }
    }
    if let Some(neighbours) = &verdict.neighbours {
        append_neighbours(text, neighbours);
    }
    if let Some(rounding) = verdict.rounding {
        let tolerance = verdict.tolerance;
        let share = rounding / tolerance * 100.0;
        let _ = writeln!(
            text,
            "rounding to the control's least increment alone can cause Φ{rounding:.4}: {share:.1} % of the \
             tolerance zone"
        );
        if exceeds(rounding, tolerance) {
            let _ = writeln!(
                text,
                "WARNING  this control's least increment is too coarse for Φ{tolerance}: use a finer \
                 increment or a wider tolerance"
            );
        }
    }
    for what in &verdict.not_checked {
        let _ = writeln!(text, "not checked: {what}");
    }
    append_assumptions(text, &verdict.assumptions, Total::Holes(verdict.holes.len() + verdict.extra.len()));
    if !verdict.missing.is_empty() {
        let _ = writeln!(text, "missing  {}", list_first(&verdict.missing, |id| id.clone(), ", "));
    }
    if !verdict.extra.is_empty() {
        let why = |extra: &ExtraHole| extra.why.trim_start_matches("extra ").to_owned();
        let _ = writeln!(text, "extra    {}", list_first(&verdict.extra, why, "\n         "));
    }
}

/// Writes the distances of neighbours and the places of the extremes.
fn append_neighbours(text: &mut String, neighbours: &Neighbours) {
    let Neighbours { metric, nominal, with_six, with_six_nominal, min, max } = neighbours;
    let _ = writeln!(
        text,
        "neighbour distance, nominal {nominal:.4} mm ({metric}); {with_six} of {with_six_nominal} inner \
         holes have all six neighbours"
    );
    for (what, extreme) in [("nearest", min), ("farthest", max)] {
        if let Some(Distance { distance, between: [one, other] }) = extreme {
            let _ = writeln!(text, "           {what:<8} {distance:.4} mm: {one} and {other}");
        }
    }
}

/// Joins the first few items and the number of the others.
fn list_first<T>(all: &[T], name: impl Fn(&T) -> String, between: &str) -> String {
    let mut shown: Vec<_> = all.iter().take(MAX_LISTED).map(name).collect();
    if MAX_LISTED < all.len() {
        shown.push(format!("… and {} more", all.len() - MAX_LISTED));
    }
    shown.join(between)
}

/// Returns `O8101 line 53, T2, called from O8100 line 20`.
fn made_by(hole: &HoleVerdict) -> String {
    let tool = hole.from.tool.map_or(String::new(), |tool| format!(", T{tool}"));
    let calls: Vec<_> =
        hole.calls.iter().map(|c| format!(", called from {} line {}", c.program, c.line)).collect();
    format!("{} line {}{tool}{}", hole.from.program, hole.from.line, calls.concat())
}

/// Writes a line for each assumption; `total` is the number of all holes or flutes of the result.
pub(super) fn append_assumptions(text: &mut String, assumptions: &[Assumption], total: Total) {
    for assumption in assumptions {
        let _ = writeln!(text, "assumes  {}", assumption.sentence(total));
    }
}

/// Writes the line that stands for the verdict, and below it what probably explains it.
pub(super) fn append_conclusion(text: &mut String, conclusion: &Conclusion<'_>, likely_causes: &[String]) {
    let _ = writeln!(text, "{}     {}", conclusion.answer.word(), conclusion.summary);
    if !likely_causes.is_empty() {
        let _ = writeln!(text, "cause    {}", list_first(likely_causes, String::clone, "\n         "));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_inspect::verify::{Answer, Ending, SummaryWords};
    use gcode_part::Origin;

    fn hole(id: &str, phi: f64, error_codes: &[&'static str]) -> HoleVerdict {
        let placed = |x: f64| HoleGeometry {
            entry: [x, 674.93, 0.0],
            axis: [0.0, 1.0, 0.0],
            diameter: Some(6.0),
            depth: 15.0,
        };
        HoleVerdict {
            id: id.into(),
            position_deviation: phi,
            at_entry: phi / 2.0,
            at_bottom: phi / 2.0,
            depth_error: -0.00002,
            drilled_index: 0,
            far_side_index: None,
            ok: error_codes.is_empty(),
            tilt: 0.0,
            out_of_tolerance: (phi - 0.1).max(0.0),
            rounding: 0.0211,
            nominal: placed(420.0),
            actual: placed(420.0 + phi / 2.0),
            from: Origin { program: "O8101".into(), line: 31, tool: Some(2) },
            calls: vec![Origin { program: "O8100".into(), line: 20, tool: None }],
            neighbours: None,
            error_codes: error_codes.to_vec(),
        }
    }

    fn verdict() -> Verdict {
        Verdict {
            basis: "predicted by simulation, not measured",
            tolerance: 0.1,
            depth_tolerance: 0.1,
            verdict: Answer::Fail,
            outcome: Ending::End,
            summary: "1 of 17 holes in tolerance, 15 missing".to_owned(),
            likely_causes: Vec::new(),
            worst: Some(0.1234),
            worst_from: Some("hole 2, …".into()),
            rounding: Some(0.0211),
            holes: vec![hole("1", 0.0002, &[]), hole("2", 0.1234, &["hole-position"])],
            missing: (3..18).map(|id| id.to_string()).collect(),
            extra: Vec::new(),
            repeated: Vec::new(),
            words: SummaryWords::default(),
            findings: Vec::new(),
            neighbours: None,
            not_checked: Vec::new(),
            assumptions: Vec::new(),
            diagnostics: Vec::new(),
        }
    }

    #[test]
    fn a_hole_has_one_line() {
        insta::assert_snapshot!(table(&verdict(), Layout::default()), @r"
Position of 2 holes against Φ0.1: predicted by simulation, not measured
mm and degrees; deviations are actual − nominal

hole         x         y         z       dx       dy       dz   entry  bottom    tilt    depth       Φ     out  verdict
1      420.000   674.930     0.000  +0.0001   0.0000   0.0000  0.0001  0.0001  0.0000   0.0000  0.0002  0.0000  pass
2      420.000   674.930     0.000  +0.0617   0.0000   0.0000  0.0617  0.0617  0.0000   0.0000  0.1234  0.0234  FAIL position

FAIL     1 of 17 holes in tolerance, 15 missing
worst    Φ0.1234, tolerance Φ0.1: hole 2, …
         made by O8101 line 31, T2, called from O8100 line 20
rounding to the control's least increment alone can cause Φ0.0211: 21.1 % of the tolerance zone
missing  3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, … and 3 more
");
    }

    #[test]
    fn the_full_table_has_every_column_worst_hole_first() {
        insta::assert_snapshot!(table(&verdict(), Layout { worst_first: true, full: true }), @r"
Position of 2 holes against Φ0.1: predicted by simulation, not measured
mm and degrees; deviations are actual − nominal

hole 2              x         y         z         i         j         k         d         l
 nominal     420.0000  674.9300    0.0000  0.000000  1.000000  0.000000     6.000   15.0000
 actual      420.0617  674.9300    0.0000  0.000000  1.000000  0.000000     6.000   15.0000
 deviation    +0.0617    0.0000    0.0000  0.000000  0.000000  0.000000     0.000    0.0000
 position   Φ0.1234, tolerance Φ0.1, out of tolerance by 0.0234 (entry 0.0617, bottom 0.0617, tilt 0.0000°)
 verdict    FAIL position; made by O8101 line 31, T2, called from O8100 line 20

hole 1              x         y         z         i         j         k         d         l
 nominal     420.0000  674.9300    0.0000  0.000000  1.000000  0.000000     6.000   15.0000
 actual      420.0001  674.9300    0.0000  0.000000  1.000000  0.000000     6.000   15.0000
 deviation    +0.0001    0.0000    0.0000  0.000000  0.000000  0.000000     0.000    0.0000
 position   Φ0.0002, tolerance Φ0.1, out of tolerance by 0.0000 (entry 0.0001, bottom 0.0001, tilt 0.0000°)
 verdict    pass; made by O8101 line 31, T2, called from O8100 line 20

FAIL     1 of 17 holes in tolerance, 15 missing
worst    Φ0.1234, tolerance Φ0.1: hole 2, …
         made by O8101 line 31, T2, called from O8100 line 20
rounding to the control's least increment alone can cause Φ0.0211: 21.1 % of the tolerance zone
missing  3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, … and 3 more
");
    }

    /// Rounding alone causes Φ0.0211: more than a zone of 0.02, less than one of 0.0212.
    #[test]
    fn a_zone_smaller_than_rounding_is_warned_of() {
        let text_at = |tolerance: f64| table(&Verdict { tolerance, ..verdict() }, Layout::default());
        let warning = "WARNING  this control's least increment is too coarse for Φ0.02: use a finer increment or a wider tolerance";
        assert!(text_at(0.02).contains(warning));
        assert!(!text_at(0.0212).contains("WARNING"));
    }
}
