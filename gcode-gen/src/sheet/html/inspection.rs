//! The inspection form: requirements, empty columns for results, and the predictions.
use gcode_inspect::verify::{HoleVerdict, Verdict};
use gcode_sim::report::encode::base64;
use gcode_sim::report::figures::{rounded, signed, signed_to};
use gcode_sim::report::sheet::layout::BASIS;
use maud::{Markup, html};

use super::{cell, table};
use crate::check::PackageVerdict;
use crate::sheet::Sheet;
use crate::sheet::measure::{LISTED, characteristics};

/// Builds the form after AS9102, form 3: requirements are filled in, results are the inspector's.
pub(super) fn form(sheet: &Sheet<'_>) -> Markup {
    let all = characteristics(sheet.job, &sheet.checked.verdict);
    html! {
        h2 { "Inspection" }
        p {
            "In the manner of AS9102, form 3. The columns for results are for the inspector and are empty here: "
            "a simulation is not a measurement. "
            @if let PackageVerdict::Holes(_) = sheet.checked.verdict { "Nominal positions are in the tables of holes below." }
        }
        div.wide { table {
            thead { tr {
                th.n { "char. no." } th { "reference" } th { "characteristic" } th { "requirement" }
                th { "results" } th { "gauge, non-conformance" } th { "predicted (simulation)" }
            } }
            tbody {
                @for (index, one) in all.iter().enumerate() {
                    tr {
                        td.n data-name="char. no." { (index + 1) }
                        td.wrap data-name="reference" { (one.reference) }
                        td data-name="characteristic" { (one.name) }
                        td data-name="requirement" { (one.requirement) }
                        td.result data-name="results" {}
                        td.result data-name="gauge, non-conformance" {}
                        td.wrap data-name="predicted (simulation)" { (one.predicted) }
                    }
                }
            }
        } }
    }
}

/// Returns nominal and predicted positions; of many holes the worst ones.
pub(super) fn holes(sheet: &Sheet<'_>) -> Markup {
    let PackageVerdict::Holes(verdict) = &sheet.checked.verdict else { return html! {} };
    let shown = shown(verdict);
    let nominal = shown.iter().map(|hole| {
        let placed = &hole.nominal;
        let diameter = placed.diameter.map_or("-".to_owned(), |d| rounded(d, 3));
        let place = placed.entry.map(|v| rounded(v, 3)).into_iter().chain(placed.axis.map(|v| rounded(v, 6)));
        let all = std::iter::once(hole.id.clone()).chain(place).chain([rounded(placed.depth, 3), diameter]);
        all.map(cell).collect()
    });
    let predicted = shown.iter().map(|hole| {
        let off = std::array::from_fn::<_, 3, _>(|i| signed(hole.actual.entry[i] - hole.nominal.entry[i]));
        let rest = [
            rounded(hole.tilt, 4),
            signed_to(hole.depth_error, 4),
            format!("Φ{}", rounded(hole.position_deviation, 4)),
            format!("Φ{}", verdict.tolerance),
            rounded(hole.out_of_tolerance, 4),
        ];
        std::iter::once(hole.id.clone()).chain(off).chain(rest).map(cell).collect()
    });
    html! {
        h2 { "Holes" }
        @if shown.len() < verdict.holes.len() {
            p {
                "The worst " (shown.len()) " of " (verdict.holes.len()) " holes; "
                code { "gcode-sim verify --full" } " and " code { "--format json" } " list all."
            }
        }
        div.together {
            h3 { "Nominal, in the part's frame: entry, axis out of the part, depth, diameter" }
            (table(&["hole", "#x", "#y", "#z", "#i", "#j", "#k", "#depth", "#diameter"], nominal))
        }
        div.together {
            h3 { (BASIS) ": deviations (actual − nominal) where the axis enters, tilt, depth, position as in ISO 1101" }
            (table(&["hole", "#dx", "#dy", "#dz", "#tilt", "#depth", "#position", "#tolerance", "#out"], predicted))
        }
    }
}

fn shown(verdict: &Verdict) -> Vec<&HoleVerdict> {
    let mut all: Vec<&HoleVerdict> = verdict.holes.iter().collect();
    if all.len() > LISTED {
        all.sort_by(|a, b| b.position_deviation.total_cmp(&a.position_deviation));
        all.truncate(24);
    }
    all
}

/// Returns the pictures of the part as the simulated program makes it.
pub(super) fn pictures(sheet: &Sheet<'_>) -> Markup {
    if sheet.pictures.is_empty() {
        return html! {};
    }
    html! {
        h2 { "The part as made by the simulated program" }
        @for (name, png) in &sheet.pictures {
            figure {
                img src={ "data:image/png;base64," (base64(png)) } alt=(name);
                figcaption { (name) ": " (BASIS) "." }
            }
        }
    }
}
