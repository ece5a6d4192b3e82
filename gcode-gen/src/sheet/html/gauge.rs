//! The gauge blocks under the sine table, thickest first; for alignment jobs only.
use gcode_lang::units::{Deg, Mm};
use gcode_part::gauge;
use gcode_part::job::Job;
use gcode_sim::report::figures::{rounded, short, signed_to};
use maud::{Markup, html};

use super::{cell, table};
use crate::sheet::Sheet;

/// Returns the sentence on the part's direction of rotation when the blocks get higher.
fn sense(sign: i8) -> &'static str {
    if sign < 0 {
        "Direction: higher blocks rotate the part back, from Y towards X (sine_table.sign -1). A tilt #583 \
         above 0 is corrected by higher blocks. If the run-out afterwards shows twice the tilt, the \
         direction is the opposite."
    } else {
        "Direction: higher blocks rotate the part from X towards Y (sine_table.sign 1). A tilt #583 above \
         0 is corrected by lower blocks. If the run-out afterwards shows twice the tilt, the direction is \
         the opposite."
    }
}

pub(super) fn blocks(sheet: &Sheet<'_>) -> Markup {
    let Job::Alignment(job) = sheet.job else { return html! {} };
    let sine = &job.sine_table;
    let setting = gauge::sine_setting(Mm(sine.length), Deg(sine.phi), &sine.gauge_blocks);
    let rows = setting.stack.blocks.iter().enumerate();
    let rows = rows
        .map(|(index, block)| vec![html! { (index + 1) }, cell(block.to_string()), html! { span.tick {} }]);
    let sum = vec![cell("stack"), html! { b { (setting.stack.thickness()) } }, html! {}];
    // To first order dH = L·cos φ·δ.
    let minute = sine.length * Deg(sine.phi).cos() * Deg(1.0 / 60.0).to_rad();
    html! {
        div.together {
            h2 { "Gauge blocks under the sine table" }
            p {
                "Rollers " (short(sine.length)) " mm apart, angle " (short(sine.phi)) "°: H = L·sin φ = " (rounded(setting.height.0, 5))
                " mm, with the fewest blocks of the set " (sine.gauge_blocks.name) " that come nearest. The remaining error is "
                (signed_to(setting.remainder, 2)) "″ (seconds of arc)."
            }
            @if setting.stack.blocks.is_empty() {
                p { "No blocks: the table is flat." }
            } @else {
                (table(&["#block", "#mm", "wrung"], rows.chain([sum])))
            }
            p.note { "For one minute of arc more the stack is " (rounded(minute, 4)) " mm higher." }
            p { (sense(sine.sign)) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// U·#583 is subtracted from φ: with the sign −1 a tilt above 0 makes it larger, and the blocks higher.
    #[test]
    fn the_direction_of_the_table_follows_its_sign() {
        assert!(sense(1).contains(
            "from X towards Y (sine_table.sign 1). A tilt #583 above 0 is corrected by lower blocks"
        ));
        assert!(sense(-1).contains(
            "from Y towards X (sine_table.sign -1). A tilt #583 above 0 is corrected by higher blocks"
        ));
    }
}
