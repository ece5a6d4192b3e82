//! The summary below a verdict's table: the answer, the worst hole, missing and extra holes.
use std::fmt::Write;

use super::figures::{count, rounded};
use gcode_inspect::verify::{Answer, Distance, HoleVerdict, Neighbours, Verdict};

/// Number of missing and of extra holes that are listed; the others are counted.
const MAX_LISTED: usize = 12;

pub(super) fn summary(text: &mut String, verdict: &Verdict) {
    let good = verdict.holes.iter().filter(|hole| hole.ok).count();
    let wanted = verdict.holes.len() + verdict.missing.len();
    let answer = match verdict.verdict {
        Answer::Pass => "PASS",
        Answer::Fail => "FAIL",
    };
    let mut parts = vec![format!("{good} of {} in tolerance", count(wanted, "hole"))];
    if !verdict.missing.is_empty() {
        parts.push(format!("{} missing", verdict.missing.len()));
    }
    if !verdict.extra.is_empty() {
        parts.push(format!("{} extra", verdict.extra.len()));
    }
    let motion = verdict.findings.iter().filter(|f| f.severity == "error" && f.from_motion).count();
    if motion != 0 {
        parts.push(format!("{} in the motion", count(motion, "error")));
    }
    append_line(text, &format!("{answer}     {}", parts.join(", ")));
    if let (Some(worst), Some(from)) = (verdict.worst, &verdict.worst_from) {
        append_line(
            text,
            &format!(
                "worst    Φ{}, tolerance Φ{}: {}",
                rounded(worst, 4),
                verdict.tolerance,
                from.replace("; ", "\n         ")
            ),
        );
        let by_phi =
            |a: &&HoleVerdict, b: &&HoleVerdict| a.position_deviation.total_cmp(&b.position_deviation);
        if let Some(hole) = verdict.holes.iter().rev().max_by(by_phi) {
            append_line(text, &format!("         made by {}", made_by(hole)));
        }
    }
    if let Some(neighbours) = &verdict.neighbours {
        append_neighbours(text, neighbours);
    }
    if let Some(rounding) = verdict.rounding {
        let share = rounding / verdict.tolerance * 100.0;
        let said = "rounding to the control's least increment alone can cause";
        append_line(text, &format!("{said} Φ{rounding:.4}: {share:.1} % of the tolerance zone"));
        if verdict.tolerance < rounding {
            let why = "use a finer increment or a wider tolerance";
            append_line(
                text,
                &format!(
                    "WARNING  this control's least increment is too coarse for Φ{}: {why}",
                    verdict.tolerance
                ),
            );
        }
    }
    for what in &verdict.not_checked {
        append_line(text, &format!("not checked: {what}"));
    }
    if !verdict.missing.is_empty() {
        append_line(text, &format!("missing  {}", list_first(&verdict.missing, |id| id.clone(), ", ")));
    }
    if !verdict.extra.is_empty() {
        append_line(
            text,
            &format!(
                "extra    {}",
                list_first(
                    &verdict.extra,
                    |extra| extra.why.trim_start_matches("extra ").to_owned(),
                    "\n         "
                )
            ),
        );
    }
}

/// Writes the distances of neighbours and the places of the extremes.
fn append_neighbours(text: &mut String, neighbours: &Neighbours) {
    let Neighbours { metric, nominal: wanted, with_six, with_six_nominal: with_six_wanted, min, max } =
        neighbours;
    append_line(
        text,
        &format!(
            "neighbour distance, nominal {wanted:.4} mm ({metric}); {with_six} of {with_six_wanted} inner \
             holes have all six neighbours"
        ),
    );
    for (what, extreme) in [("nearest", min), ("farthest", max)] {
        if let Some(Distance { distance, between: [one, other] }) = extreme {
            append_line(text, &format!("           {what:<8} {distance:.4} mm: {one} and {other}"));
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

pub(super) fn append_line(text: &mut String, line: &str) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{}", line.trim_end());
}

/// Returns `O8101 line 53, T2, called from O8100 line 20`.
pub(super) fn made_by(hole: &HoleVerdict) -> String {
    let tool = hole.from.tool.map_or(String::new(), |tool| format!(", T{tool}"));
    let calls: Vec<_> =
        hole.calls.iter().map(|c| format!(", called from {} line {}", c.program, c.line)).collect();
    format!("{} line {}{tool}{}", hole.from.program, hole.from.line, calls.concat())
}
