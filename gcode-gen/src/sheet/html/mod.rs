//! The sheet as HTML: self-contained, for paper (A4) and for screens. The macro escapes every text from
//! outside.
mod alignment;
mod drawing;
mod end;
mod gauge;
mod head;
mod inspection;
mod machine;
mod stops;
mod time;
mod zero;

use gcode_part::job::Job;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::{BASIS, Sheet};
use crate::package::stem;

pub(super) fn page(sheet: &Sheet<'_>) -> String {
    let main = mains(sheet);
    let words = sheet.job.sheet();
    let part = words.part.as_deref().unwrap_or("part not named");
    let drawing = [("drawing", &words.drawing), ("revision", &words.revision)];
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { "Set-up sheet: " (part) ", " (main) }
                style { (PreEscaped(include_str!("style.css"))) }
            }
            body {
                table.frame role="presentation" {
                    thead { tr { td {
                        div.running {
                            b { (BASIS) }
                            span {
                                (part)
                                @for (name, word) in drawing {
                                    @if let Some(word) = word { ", " (name) " " (word) }
                                }
                                ", " (main)
                            }
                        }
                    } } }
                    tbody { tr { td { (sections(sheet)) } } }
                }
            }
        }
    };
    page.into_string()
}

fn sections(sheet: &Sheet<'_>) -> Markup {
    html! {
        (head::facts(sheet))
        (head::verdict(sheet))
        (head::programs(sheet))
        (zero::zero(sheet))
        (machine::tools(sheet))
        (machine::head_angles(sheet))
        (gauge::blocks(sheet))
        (stops::stops(sheet))
        (alignment::readings(sheet))
        (alignment::alarms(sheet))
        (machine::settings(sheet))
        (inspection::form(sheet))
        (inspection::holes(sheet))
        (inspection::pictures(sheet))
        // On paper, the rest of the page is next to the signatures.
        div.together {
            (time::time(sheet))
            (end::unknown(sheet))
            (end::sign())
        }
    }
}

/// Builds a table that a narrow screen shows row by row, each cell with its column's name; columns with a
/// leading `#` hold figures.
fn table(columns: &[&str], rows: impl IntoIterator<Item = Vec<Markup>>) -> Markup {
    html! {
        div.wide {
            table {
                thead { tr {
                    @for name in columns {
                        @match name.strip_prefix('#') {
                            Some(name) => th.n { (name) },
                            None => th { (name) },
                        }
                    }
                } }
                tbody {
                    @for row in rows {
                        tr {
                            @for (cell, name) in row.iter().zip(columns) {
                                @match name.strip_prefix('#') {
                                    Some(name) => td.n data-name=(name) { (cell) },
                                    None => td data-name=(name) { (cell) },
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Returns a cell of plain text.
fn cell(text: impl AsRef<str>) -> Markup {
    html! { (text.as_ref()) }
}

/// Returns blank space for handwriting.
fn blank() -> Markup {
    html! { span.blank {} }
}

/// Returns the main programs: `O8100`.
fn mains(sheet: &Sheet<'_>) -> String {
    sheet.package.mains.iter().map(|main| stem(*main)).collect::<Vec<_>>().join(", ")
}

/// Returns the kind of part, for a heading.
fn kind(job: &Job) -> &'static str {
    match job {
        Job::PinHoles(_) => "pin holes on an ellipsoid of revolution",
        Job::Honeycomb(_) => "honeycomb of radial holes on a cylinder",
        Job::Burr(_) => "ball-end rotary burr",
        Job::Alignment(_) => "setting up a part of revolution",
    }
}
