//! The rows of a honeycomb stand at the angle with which the pattern closes: another one is told with the distance it
//! makes round the circumference and the diameter it would be right for.
use super::{Comparison, Objection};
use crate::diag::Diagnostic;
use crate::part::honeycomb::Pattern;
use crate::units::Deg;
use crate::verify::causes::causes;
use crate::verify::objection::at_the_call;
use crate::verify::rows::Rows;

/// What rounding to the rotary's increment, 0.01° at the coarsest, may make of a turn.
const ROUNDED: Deg = Deg(0.03);

pub(super) fn check(comparison: &Comparison<'_>, objections: &mut Vec<Objection>) {
    let Some(pattern) = comparison.pattern else { return };
    let Some(rows) = Rows::of(comparison, pattern) else { return };
    let (usual, wanted) = (rows.usual, rows.wanted(pattern));
    // After a whole turn the error has added up.
    let turn = (usual - wanted).abs() * (360.0 / wanted.0);
    if turn < ROUNDED || pattern.arc(turn) <= comparison.tolerances.position / 2.0 {
        return;
    }
    let tolerance = Deg::atan2(comparison.tolerances.position, pattern.diameter / 2.0);
    if !rows.fit(tolerance + ROUNDED) {
        return;
    }
    let (found, right) = (pattern.arc(usual), pattern.arc(wanted));
    let fits = pattern.diameter * wanted.0 / usual.0;
    let message = format!(
        "the rows are {}° apart, nominal {:.4}°: neighbours round the circumference are {found:.2} mm \
         apart, nominal {right:.2}",
        plain(usual),
        wanted.0
    );
    let finding = Diagnostic::error("row-angle", message).help(help(pattern));
    let mut finding = at_the_call(finding, &comparison.found[rows.rows[1].first].place);
    if whole(usual) && !whole(wanted) {
        let cut = if usual.0 < wanted.0 { "FIX or ROUND" } else { "FUP or ROUND" };
        finding = finding
            .note(format!("{}° is a whole number of degrees: check for rounding by {cut}", plain(usual)));
    } else if let Some(closes) = closes(pattern, &rows, usual) {
        finding = finding.note(closes);
    } else {
        finding = finding.note(format!(
            "this angle is right for a diameter of {fits:.2} mm; the pitch is specified on {}",
            pattern.diameter
        ));
        if let Some(causes) = causes(pattern, fits / pattern.diameter, true) {
            finding = finding.note(causes);
        }
    }
    objections.push(Objection::whole(finding));
}

/// The pattern that another number of rows closes with, of rows that stand as evenly round as these do.
fn closes(pattern: &Pattern, rows: &Rows, usual: Deg) -> Option<String> {
    let count = rows.rows.len() as u32;
    let even = (usual.0 * f64::from(count) - 360.0).abs() < ROUNDED.0;
    (even && count.is_multiple_of(2) && !rows.one_group(pattern)).then(|| {
        format!(
            "this is the angle of {} rows in each group, for a pitch of about {:.3}: check divisions, \
             pitch and diameter in the call",
            count / 2,
            pattern.pitch_of(count)
        )
    })
}

fn help(pattern: &Pattern) -> String {
    format!(
        "use {} rows in each group: 360/{0}° from one row of a group to the next, unrounded",
        pattern.rows / 2
    )
}

fn whole(angle: Deg) -> bool {
    (angle.0 - angle.0.round()).abs() < 1e-6
}

/// Without needless zeros.
fn plain(angle: Deg) -> String {
    let text = format!("{:.4}", angle.0);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
