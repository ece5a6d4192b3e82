//! The layout of set-up sheets: one self-contained HTML file for paper (A4) and screens, without script. The macro escapes
//! every text from outside.
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// Basis of all numbers of a sheet.
pub const BASIS: &str = "Predicted by simulation, not measured";

/// Assembles a sheet; `running` is repeated beside the basis on every printed page.
pub fn page(title: &str, running: &str, sections: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(include_str!("style.css"))) }
            }
            body {
                table.frame role="presentation" {
                    thead { tr { td {
                        div.running {
                            b { (BASIS) }
                            span { (running) }
                        }
                    } } }
                    tbody { tr { td { (sections) } } }
                }
            }
        }
    };
    page.into_string()
}

/// Builds a table that a narrow screen shows row by row, each cell with its column's name; columns with a leading `#` hold
/// figures.
pub fn table(columns: &[&str], rows: impl IntoIterator<Item = Vec<Markup>>) -> Markup {
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
pub fn cell(text: impl AsRef<str>) -> Markup {
    html! { (text.as_ref()) }
}

/// Returns blank space for handwriting.
pub fn blank() -> Markup {
    html! { span.blank {} }
}

/// Writes a digest in two halves, with a break opportunity between them.
pub fn digest(bytes: &[u8]) -> Markup {
    let digits = crate::report::encode::sha256(bytes);
    let (one, other) = digits.split_at(digits.len() / 2);
    html! { span.mono.digest { (one) wbr; (other) } }
}

/// Returns the lines for signatures.
pub fn signatures() -> Markup {
    let rows =
        ["prepared", "checked", "approved"].map(|role| vec![html! { (role) }, html! {}, html! {}, html! {}]);
    html! {
        div.together {
            h2 { "Signatures" }
            div.sign.fill { (table(&["", "name", "signature", "date"], rows)) }
        }
    }
}
