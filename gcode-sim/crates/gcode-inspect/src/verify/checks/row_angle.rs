//! Angle between the rows of a honeycomb: that with which the pattern closes.
use super::*;
use crate::findings::ROW_ANGLE;
use crate::verify::causes::describe_causes;

/// Error of a whole revolution due to rounding to the rotary's increment, 0.01° at the coarsest.
const ROUNDING_ALLOWANCE: Deg = Deg(0.03);

pub(super) fn check(inspection: &HoleInspection<'_>, findings: &mut HoleFindings) {
    let comparison = &inspection.comparison;
    let Some(rows) = &inspection.rows else { return };
    let (pattern, actual, nominal) = (rows.pattern, rows.typical_gap, rows.nominal_gap());
    // Over a revolution the error of the gaps adds up.
    let sum = (actual - nominal).abs() * (360.0 / nominal.0);
    if sum < ROUNDING_ALLOWANCE || !exceeds(pattern.arc_length(sum), comparison.tolerances.position / 2.0) {
        return;
    }
    let tolerance = Deg::atan2(comparison.tolerances.position, pattern.diameter / 2.0);
    if !rows.is_evenly_spaced(tolerance + ROUNDING_ALLOWANCE) {
        return;
    }
    let message = format!(
        "the rows are {}° apart, nominal {:.4}°: neighbours round the circumference are {:.2} mm \
         apart, nominal {:.2}",
        format_angle(actual),
        nominal.0,
        pattern.arc_length(actual),
        pattern.arc_length(nominal)
    );
    let help = format!(
        "use {} rows in each group: 360/{0}° from one row of a group to the next, unrounded",
        pattern.rows / 2
    );
    let finding = Diagnostic::new(&ROW_ANGLE, message).help(help);
    let mut finding = locate_at_call(finding, &comparison.actual[rows.rows[1].first].backtrace);
    finding.notes = if is_whole(actual) && !is_whole(nominal) {
        let cut = if actual.0 < nominal.0 { "FIX or ROUND" } else { "FUP or ROUND" };
        vec![format!("{}° is a whole number of degrees: check for rounding by {cut}", format_angle(actual))]
    } else if let Some(closure) = explain_closure(rows) {
        vec![closure]
    } else {
        let diameter = pattern.diameter * nominal.0 / actual.0;
        let fits = format!(
            "this angle is right for a diameter of {diameter:.2} mm; the pitch is specified on {}",
            pattern.diameter
        );
        let causes = describe_causes(pattern, diameter / pattern.diameter, true);
        std::iter::once(fits).chain(causes).collect()
    };
    findings.add(Subject::Whole, finding);
}

/// Returns a note on the pattern that closes with the actual number of rows, if these are evenly spaced all round.
fn explain_closure(rows: &PatternRows<'_>) -> Option<String> {
    let count = rows.rows.len() as u32;
    let is_even = (rows.typical_gap.0 * f64::from(count) - 360.0).abs() < ROUNDING_ALLOWANCE.0;
    (is_even && count.is_multiple_of(2) && !rows.is_single_group()).then(|| {
        format!(
            "this is the angle of {} rows in each group, for a pitch of about {:.3}: check divisions, \
             pitch and diameter in the call",
            count / 2,
            rows.pattern.closing_pitch(count)
        )
    })
}

fn is_whole(angle: Deg) -> bool {
    (angle.0 - angle.0.round()).abs() < 1e-6
}

/// Formats an angle without trailing zeros.
fn format_angle(angle: Deg) -> String {
    let text = format!("{:.4}", angle.0);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
