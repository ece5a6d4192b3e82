//! The HTML file: head, style, data and script, under a policy that allows no other code and no fetches.
use maud::{DOCTYPE, Markup, PreEscaped, html};
use serde::Serialize;
use sha2::{Digest, Sha256};

use crate::report::encode::base64;

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = concat!(include_str!("table.js"), include_str!("viewer.js"), include_str!("page.js"));

/// Assembles a self-contained page; the script reads `data`.
pub(super) fn document(
    title: &str,
    body: &Markup,
    data: &impl Serialize,
) -> Result<String, serde_json::Error> {
    // In JSON `<` occurs in strings only, and escaped it cannot end the script element.
    let data = serde_json::to_string(data)?.replace('<', "\\u003c");
    let policy = format!(
        "default-src 'none'; style-src 'sha256-{}'; script-src 'sha256-{}'; base-uri 'none'; form-action 'none'",
        base64(&Sha256::digest(STYLE)),
        base64(&Sha256::digest(SCRIPT))
    );
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(policy);
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                meta name="generator" content={ "gcode-sim " (env!("CARGO_PKG_VERSION")) };
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                (body)
                script #data type="application/json" { (PreEscaped(data)) }
                script { (PreEscaped(SCRIPT)) }
            }
        }
    };
    Ok(page.into_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_cannot_end_the_script_element() {
        let page = document("T", &html! {}, &"</script><img src=x onerror=alert(1)>").unwrap();
        assert!(!page.contains("<img"), "{page}");
        assert_eq!(page.matches("</script>").count(), 2);
    }
}
