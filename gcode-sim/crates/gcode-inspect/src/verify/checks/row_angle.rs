//! The rows of a honeycomb stand at the angle with which the pattern closes: another one is told with the distance it
//! makes round the circumference and the diameter it would be right for.
use super::{HoleFinding, HoleInspection};
use crate::findings::ROW_ANGLE;
use crate::verify::causes::describe_causes;
use crate::verify::hole_finding::locate_at_call;
use crate::verify::rows::PatternRows;
use gcode_lang::diag::Diagnostic;
use gcode_lang::units::Deg;
use gcode_part::Pattern;

/// What rounding to the rotary's increment, 0.01° at the coarsest, may make of a turn.
const ROUNDING_ALLOWANCE: Deg = Deg(0.03);

pub(super) fn check(inspection: &HoleInspection<'_>, objections: &mut Vec<HoleFinding>) {
    let comparison = &inspection.comparison;
    let Some(pattern) = comparison.pattern else { return };
    let Some(rows) = PatternRows::of(comparison, pattern) else { return };
    let (usual, wanted) = (rows.typical_gap, rows.nominal_gap(pattern));
    // After a whole turn the error has added up.
    let turn = (usual - wanted).abs() * (360.0 / wanted.0);
    if turn < ROUNDING_ALLOWANCE || pattern.arc_length(turn) <= comparison.tolerances.position / 2.0 {
        return;
    }
    let tolerance = Deg::atan2(comparison.tolerances.position, pattern.diameter / 2.0);
    if !rows.is_evenly_spaced(tolerance + ROUNDING_ALLOWANCE) {
        return;
    }
    let (found, right) = (pattern.arc_length(usual), pattern.arc_length(wanted));
    let fits = pattern.diameter * wanted.0 / usual.0;
    let message = format!(
        "the rows are {}° apart, nominal {:.4}°: neighbours round the circumference are {found:.2} mm \
         apart, nominal {right:.2}",
        format_angle(usual),
        wanted.0
    );
    let finding = Diagnostic::new(&ROW_ANGLE, message).help(help(pattern));
    let mut finding = locate_at_call(finding, &comparison.actual[rows.rows[1].first].backtrace);
    if is_whole(usual) && !is_whole(wanted) {
        let cut = if usual.0 < wanted.0 { "FIX or ROUND" } else { "FUP or ROUND" };
        finding = finding.note(format!(
            "{}° is a whole number of degrees: check for rounding by {cut}",
            format_angle(usual)
        ));
    } else if let Some(closes) = explain_closure(pattern, &rows, usual) {
        finding = finding.note(closes);
    } else {
        finding = finding.note(format!(
            "this angle is right for a diameter of {fits:.2} mm; the pitch is specified on {}",
            pattern.diameter
        ));
        if let Some(causes) = describe_causes(pattern, fits / pattern.diameter, true) {
            finding = finding.note(causes);
        }
    }
    objections.push(HoleFinding::unlocated(finding));
}

/// The pattern that another number of rows closes with, of rows that stand as evenly round as these do.
fn explain_closure(pattern: &Pattern, rows: &PatternRows, usual: Deg) -> Option<String> {
    let count = rows.rows.len() as u32;
    let even = (usual.0 * f64::from(count) - 360.0).abs() < ROUNDING_ALLOWANCE.0;
    (even && count.is_multiple_of(2) && !rows.is_single_group(pattern)).then(|| {
        format!(
            "this is the angle of {} rows in each group, for a pitch of about {:.3}: check divisions, \
             pitch and diameter in the call",
            count / 2,
            pattern.closing_pitch(count)
        )
    })
}

fn help(pattern: &Pattern) -> String {
    format!(
        "use {} rows in each group: 360/{0}° from one row of a group to the next, unrounded",
        pattern.rows / 2
    )
}

fn is_whole(angle: Deg) -> bool {
    (angle.0 - angle.0.round()).abs() < 1e-6
}

/// Without needless zeros.
fn format_angle(angle: Deg) -> String {
    let text = format!("{:.4}", angle.0);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
