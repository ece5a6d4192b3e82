//! The end of the sheet: unchecked aspects.
use maud::{Markup, html};

use crate::check::PackageVerdict;
use crate::sheet::Sheet;

/// Aspects that no simulation here covers, for any part.
const NEVER: &[&str] = &[
    "the machine's own errors: positioning, run-out of the rotary axis, accuracy of the head setting",
    "chips, clamps, fixtures, the tool's shank and holder, the machine's travel: only the tool against the part's surface is simulated",
    "acceleration and the time of operator stops and tool changes: run times are paths divided by feeds and rapid rates",
];

pub(super) fn unknown(sheet: &Sheet<'_>) -> Markup {
    let own = match &sheet.checked.verdict {
        PackageVerdict::Holes(verdict) => verdict.not_checked.as_slice(),
        PackageVerdict::Flutes(verdict) => verdict.not_checked.as_slice(),
        PackageVerdict::Measured => &[],
    };
    html! {
        div.together {
            h2 { "Not checked" }
            ul {
                @for what in NEVER { li { (what) } }
                @for what in own { li { (what) } }
            }
        }
    }
}
