//! Basis of the result: conditions of the run, digests of all files, and lines for signatures.
use maud::{Markup, html};

use super::words::{count, shown};
use super::{Page, ReviewSide};
use crate::report::encode::sha256;

pub(super) fn proof(page: &Page<'_>, sides: &[ReviewSide<'_>]) -> Markup {
    let settings = &page.new.request.settings;
    let dialect = settings.dialect.name();
    let increment = settings.increment.name();
    html! {
        p {
            "gcode-sim " (env!("CARGO_PKG_VERSION")) ", control " (dialect)
            ", increment " (increment) ". "
            "Run with "
            @for (index, flag) in page.conditions.iter().enumerate() {
                @if index > 0 { ", " }
                code { (shown(flag)) }
            }
            @let is_machine = |flag: &String| flag.starts_with("--machine ");
            @if !page.conditions.iter().any(is_machine) { "; without " code { "--machine" } ": X, Y, Z and a rotary B about Y" }
            "."
        }
        div.scroll {
            table.digests {
                thead { tr { th scope="col" { "File" } th scope="col" { "Is" } th scope="col" { "Size" } th scope="col" { "SHA-256" } } }
                tbody {
                    @for (name, role, bytes) in files(page, sides) {
                        tr {
                            th scope="row" { (name) }
                            td { (role) }
                            td.number { (count(bytes.len() as u64)) " bytes" }
                            td { code.digest { (sha256(bytes)) } }
                        }
                    }
                }
            }
        }
        p.note { "Every number on this page is predicted by simulation. No part was measured." }
    }
}

/// Returns every file that was read, once for each side.
fn files<'a>(page: &'a Page<'_>, sides: &'a [ReviewSide<'_>]) -> Vec<(String, String, &'a [u8])> {
    let mut files = Vec::new();
    for side in sides {
        let word = if sides.len() == 2 { format!("{} ", side.word) } else { String::new() };
        let memory = side.observed.revision.simulation.run.control.memory();
        for (index, (_, source)) in memory.sources().iter().enumerate() {
            let role = if index == 0 { "program" } else { "called program" };
            files.push((shown(&source.name), format!("{word}{role}"), source.bytes.file_content()));
        }
    }
    let others = page.documents.iter();
    files.extend(others.map(|file| (shown(&file.name), file.role.to_owned(), &*file.bytes)));
    files
}

/// Returns the lines to be signed on paper.
pub(super) fn signatures() -> Markup {
    html! {
        table.signatures {
            thead { tr { td {} th scope="col" { "Name" } th scope="col" { "Date" } th scope="col" { "Signature" } } }
            tbody {
                @for who in ["Reviewed by", "Set-up checked by", "Released by"] {
                    tr { th scope="row" { (who) } td {} td {} td {} }
                }
            }
        }
    }
}
