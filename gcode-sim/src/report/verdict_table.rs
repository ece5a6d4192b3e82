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
    let mut text = match verdict.is_of_motion {
        true => format!("Motion in the stated stock: {}\n\n", verdict.basis),
        false => format!(
            "Position of {} against Φ{}: {}\nmm and degrees; deviations are actual − nominal\n\n",
            match verdict.missing.len() {
                0 => count(all, "hole"),
                missing => format!("{all} of {}", count(all + missing, "hole")),
            },
            verdict.tolerance,
            verdict.basis
        ),
    };
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

/// Names of the columns between a hole's name and its verdict; the others are among those of `--full`.
const COLUMNS: [&str; 10] = ["x", "y", "z", "dx", "dy", "dz", "bottom", "tilt", "depth", "Φ"];

/// Width of the table: longer lists of faults end with the number of the others.
const WIDTH: usize = 100;

/// Writes one line per hole.
fn lines(text: &mut String, holes: &[&HoleVerdict]) {
    if holes.is_empty() {
        return;
    }
    let cells = |hole: &&HoleVerdict| {
        let [x, y, z] = hole.nominal.entry.map(|v| rounded(v, 3));
        let [dx, dy, dz] = off(hole).map(signed);
        let [bottom, tilt, phi] = [hole.at_bottom, hole.tilt, hole.position_deviation].map(|v| rounded(v, 4));
        let depth = if hole.is_breakthrough() { "through".to_owned() } else { signed(hole.depth_error) };
        [x, y, z, dx, dy, dz, bottom, tilt, depth, phi]
    };
    let rows: Vec<[String; 10]> =
        [COLUMNS.map(str::to_owned)].into_iter().chain(holes.iter().map(cells)).collect();
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: [usize; 10] = std::array::from_fn(width);
    let wide = holes.iter().map(|hole| hole.id.chars().count()).max().unwrap_or(0).clamp(4, 12);
    let names = ["hole"].into_iter().chain(holes.iter().map(|hole| hole.id.as_str()));
    let used = wide + widths.iter().map(|width| width + 1).sum::<usize>() + 2;
    let remarks = |hole: &&HoleVerdict| short_remarks(hole, WIDTH.saturating_sub(used));
    let verdicts = ["verdict".to_owned()].into_iter().chain(holes.iter().map(remarks));
    for ((name, row), verdict) in names.zip(&rows).zip(verdicts) {
        let cells = row.iter().zip(widths).map(|(cell, wide)| format!(" {cell:>wide$}"));
        let _ = writeln!(text, "{name:<wide$}{}  {verdict}", cells.collect::<String>());
    }
    text.push('\n');
}

/// Returns the verdict with as many faults as fit in a width, and the number of the others: `FAIL position +2`.
fn short_remarks(hole: &HoleVerdict, width: usize) -> String {
    let mut shown = fault_names(hole).len();
    loop {
        let text = with_faults(hole, shown);
        if text.chars().count() <= width || shown == 0 {
            return text;
        }
        shown -= 1;
    }
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
    with_faults(hole, usize::MAX)
}

/// Returns the verdict with the first `most` of its kinds of faults, and the number of the others.
fn with_faults(hole: &HoleVerdict, most: usize) -> String {
    if hole.ok {
        return "pass".to_owned();
    }
    let names = fault_names(hole);
    let shown = names.len().min(most);
    let first = names[..shown].join(", ");
    let more = names.len() - shown;
    let more = (0 < more).then(|| format!("+{more}"));
    ["FAIL".to_owned()]
        .into_iter()
        .chain((!first.is_empty()).then_some(first))
        .chain(more)
        .collect::<Vec<_>>()
        .join(" ")
}

/// Returns the kinds of a hole's faults, each once.
fn fault_names(hole: &HoleVerdict) -> Vec<&'static str> {
    let mut names: Vec<&str> = Vec::new();
    for name in hole.error_codes.iter().map(|code| code.trim_start_matches("hole-")) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
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
            is_through: false,
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
            is_of_motion: false,
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
Position of 2 of 17 holes against Φ0.1: predicted by simulation, not measured
mm and degrees; deviations are actual − nominal

hole       x       y     z      dx     dy     dz bottom   tilt  depth      Φ  verdict
1    420.000 674.930 0.000 +0.0001 0.0000 0.0000 0.0001 0.0000 0.0000 0.0002  pass
2    420.000 674.930 0.000 +0.0617 0.0000 0.0000 0.0617 0.0000 0.0000 0.1234  FAIL position

FAIL     1 of 17 holes in tolerance, 15 missing
worst    Φ0.1234, tolerance Φ0.1: hole 2, …
         made by O8101 line 31, T2, called from O8100 line 20
rounding to the control's least increment alone can cause Φ0.0211: 21.1 % of the tolerance zone
missing  3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, … and 3 more
");
    }

    /// The columns take 78 characters with the two spaces behind them: 22 are left.
    #[test]
    fn a_line_has_at_most_100_characters() {
        let codes = ["hole-position", "hole-cut-aside", "hole-cut-aside", "hole-depth", "feature-depth"];
        let text = table(&Verdict { holes: vec![hole("1", 0.6, &codes)], ..verdict() }, Layout::default());
        let line = text.lines().find(|line| line.starts_with("1 ")).unwrap();
        assert!(line.ends_with("  FAIL position +3"), "{line}");
        assert!(line.chars().count() <= 100, "{line}");
        assert_eq!(short_remarks(&hole("1", 0.6, &codes), 8), "FAIL +4");
        assert_eq!(
            short_remarks(&hole("1", 0.6, &codes), 80),
            "FAIL position, cut-aside, depth, feature-depth"
        );
    }

    #[test]
    fn the_full_table_has_every_column_worst_hole_first() {
        insta::assert_snapshot!(table(&verdict(), Layout { worst_first: true, full: true }), @r"
Position of 2 of 17 holes against Φ0.1: predicted by simulation, not measured
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
