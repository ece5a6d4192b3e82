//! The gauge blocks under the sine table, from the thickest to the thinnest; only a part that is set up has them.
use gcode_sim::gauge;
use gcode_sim::job::Job;
use gcode_sim::report::figures::{near, short, signed_to};
use gcode_sim::units::{Deg, Mm};
use maud::{Markup, html};

use super::{cell, table};
use crate::sheet::Sheet;

pub(super) fn blocks(sheet: &Sheet<'_>) -> Markup {
    let Job::Alignment(job) = sheet.job else { return html! {} };
    let sine = &job.sine_table;
    let setting = gauge::setting(Mm(sine.length), Deg(sine.phi), &sine.gauge_blocks);
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
                "Rollers " (short(sine.length)) " mm apart, angle " (short(sine.phi)) "°: H = L·sin φ = " (near(setting.height.0, 5))
                " mm, with the fewest blocks of the set " (sine.gauge_blocks.name) " that come nearest. They leave "
                (signed_to(setting.left, 2)) "″ (seconds of arc)."
            }
            @if setting.stack.blocks.is_empty() {
                p { "No blocks: the table lies flat." }
            } @else {
                (table(&["#block", "#mm", "wrung"], rows.chain([sum])))
            }
            p.note { "To turn the part by one minute of arc more the stack gets " (near(minute, 4)) " mm higher." }
        }
    }
}
