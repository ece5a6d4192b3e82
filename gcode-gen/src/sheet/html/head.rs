//! The head of the sheet: part, machine, programs, and the verdict of the simulation.
use gcode_sim::report::figures::rounded;
use gcode_sim::report::sheet::layout::{BASIS, digest};
use maud::{Markup, html};

use super::{blank, cell, kind, mains, table};
use crate::check::PackageVerdict;
use crate::proved::{not_proved, proved};
use crate::sheet::Sheet;

pub(super) fn facts(sheet: &Sheet<'_>) -> Markup {
    let words = sheet.job.sheet();
    let control = sheet.job.control();
    let (dialect, increment) = (control.dialect.name(), control.increment.name());
    let word_or_blank = |word: &Option<String>| word.as_ref().map_or_else(blank, |word| html! { (word) });
    html! {
        h1 { "Set-up sheet" }
        p { (kind(sheet.job)) ", main " (if sheet.package.mains.len() == 1 { "program " } else { "programs " }) b { (mains(sheet)) } }
        div.wide { table.facts { tbody {
            tr { th { "part" } td { (word_or_blank(&words.part)) } th { "drawing" } td { (word_or_blank(&words.drawing)) } }
            tr { th { "revision" } td { (word_or_blank(&words.revision)) } th { "material" } td { (word_or_blank(&words.material)) } }
            tr {
                th { "machine" } td { (word_or_blank(&words.machine)) }
                th { "control" }
                td { (dialect) ", least increment " (increment) " (" (control.increment.size()) " mm and degrees)" }
            }
            tr { th { "serial number of the part" } td { (blank()) } th { "order" } td { (blank()) } }
        } } }
        p.note { "Lengths in mm, angles in degrees, feeds in mm/min. Fill in empty lines by hand." }
    }
}

pub(super) fn verdict(sheet: &Sheet<'_>) -> Markup {
    html! {
        div.verdict {
            @match &sheet.checked.verdict {
                PackageVerdict::Holes(verdict) => {
                    b { (verdict.conclusion().answer.word()) ". " (BASIS) ". " }
                    (verdict.summary)
                    @if let Some(worst) = verdict.worst {
                        "; the worst position is Φ" (rounded(worst, 4)) ", tolerance Φ" (verdict.tolerance)
                    }
                    "."
                }
                PackageVerdict::Flutes(verdict) => {
                    b { (verdict.conclusion().answer.word()) ". " (BASIS) ". " }
                    (verdict.summary)
                    @if let Some(off) = verdict.surface_deviation {
                        "; contact deviation from the tooth bottom at most " (rounded(off, 4)) " mm, tolerance " (verdict.tolerance)
                        " mm"
                    }
                    "."
                }
                PackageVerdict::Measured => {
                    b { "PASS. " (BASIS) ". " }
                    "On simulated parts in known wrong positions:"
                    @for line in sheet.checked.report.lines() { p { (line) } }
                    @for warning in &sheet.checked.warnings { p { b { (warning.trim_end()) } } }
                }
            }
            " The machine's own errors are not in these numbers."
        }
    }
}

pub(super) fn programs(sheet: &Sheet<'_>) -> Markup {
    let rows = sheet
        .package
        .files()
        .into_iter()
        .map(|(name, text)| vec![cell(&name), cell(title(text)), digest(text.as_bytes())]);
    let first = sheet.package.files().into_iter().map(|(name, _)| name).next().unwrap_or_default();
    html! {
        h2 { "Programs" }
        (table(&["file", "content", "SHA-256"], rows))
        p.note {
            "The hash is that of the file as " code { "gcode-gen emit" } " writes it. Before it goes to the control: "
            code { "certutil -hashfile " (first) " SHA256" } " (Windows) or "
            code { "sha256sum " (first) } ". An edited file is not the simulated one."
        }
        (proofs(sheet))
    }
}

/// Lists what is proved of the macros, which their hashes identify.
fn proofs(sheet: &Sheet<'_>) -> Markup {
    let all = proved(sheet.package);
    let without = not_proved(sheet.package, &all);
    html! {
        @for one in &all {
            p { b { "Proved of " (one.macros.join(", ")) ". " } (one.says) "." }
        }
        @if !without.is_empty() {
            p.note { "No recorded proof covers " (without.join(", ")) " as written for this job." }
        }
        @if !all.is_empty() {
            p.note { "Proofs are about the simulated control and hold for files with these hashes alone." }
        }
    }
}

/// Returns a program's first comment, or the purpose of the machine file.
fn title(text: &str) -> &str {
    let line = text.lines().find(|line| line.starts_with('O')).unwrap_or("");
    let comment = line.split_once('(').and_then(|(_, rest)| rest.strip_suffix(')'));
    comment.unwrap_or("the machine, for gcode-sim")
}
