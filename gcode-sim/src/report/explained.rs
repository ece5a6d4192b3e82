//! The result of `explain`: the pages of a code, or a list of all codes.
use std::fmt::Write;

use schemars::JsonSchema;
use serde::Serialize;

use super::explain;

/// The document of `explain --format json`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct ExplainReport {
    pub pages: Vec<PageReport>,
}

#[derive(Debug, Serialize, JsonSchema)]
pub struct PageReport {
    pub code: &'static str,
    /// The meaning of the code in a few words.
    pub title: &'static str,
    /// The whole page in Markdown; absent in the list of all codes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub text: Option<&'static str>,
    #[serde(skip)]
    shown: String,
}

impl ExplainReport {
    /// Returns the pages of a code in any of its spellings; `hole-depth`, a code of `verify` and of `diff`,
    /// has two.
    pub fn of(code: &str) -> Option<Self> {
        let page = |page: explain::Page| PageReport {
            code: page.code,
            title: page.title,
            text: Some(page.text),
            shown: page.plain_text(),
        };
        let pages: Vec<_> = explain::pages(code).map(page).collect();
        (!pages.is_empty()).then_some(Self { pages })
    }

    /// Returns the list of all codes.
    pub fn list() -> Self {
        let page = |page: explain::Page| PageReport {
            code: page.code,
            title: page.title,
            text: None,
            shown: String::new(),
        };
        Self { pages: explain::all().map(page).collect() }
    }

    /// Formats the pages for a terminal, or one line per code.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for (number, PageReport { code, title, text: page, shown }) in self.pages.iter().enumerate() {
            let _ = match page {
                None => writeln!(text, "{code:<20} {title}"),
                Some(_) if number == 0 => write!(text, "{shown}"),
                Some(_) => write!(text, "\n{shown}"),
            };
        }
        text
    }
}
