//! The control settings for `--control`, as text and as data.
use schemars::JsonSchema;
use serde::Serialize;

use gcode_lang::control::{CODE_RANGES, CodeCallKind, ROWS, SEQUENTIAL_CODES};

/// The document of `settings --format json`.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct SettingsReport {
    pub(crate) settings: Vec<SettingReport>,
}

#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct SettingReport {
    /// The key for `--control`, before the `=`; a range is given by its first and last key.
    pub(crate) key: String,
    /// Its meaning, with the parameter's number where a control has one.
    pub(crate) meaning: String,
    /// Allowed values, in words.
    pub(crate) allowed: String,
}

impl SettingReport {
    fn new(key: impl Into<String>, meaning: impl Into<String>, allowed: impl Into<String>) -> Self {
        Self { key: key.into(), meaning: meaning.into(), allowed: allowed.into() }
    }
}

impl SettingsReport {
    /// Returns all settings.
    pub(crate) fn all() -> Self {
        let rows = ROWS.iter().map(|row| SettingReport::new(row.key, row.meaning, row.values.to_string()));
        let mut settings: Vec<_> = rows.collect();
        settings.push(SettingReport::new("#1000 to #1031", "an input signal", "0 or 1"));
        let (program, kind) = ("a code that calls a program", "the program's number; G-201 is a modal call");
        settings.push(SettingReport::new("G201, M50, T, …", program, kind));
        for family in SEQUENTIAL_CODES {
            let (first, last) = (family.first, family.last);
            let (letter, kind) = (char::from(family.letter), word(family.kind));
            let most = family.program + u32::from(last - first);
            let meaning = format!("{letter} codes that call O{} to O{most} as {kind}s", family.program);
            settings.push(SettingReport::new(format!("{first} to {last}"), meaning, "a code, 0 for none"));
        }
        for range in CODE_RANGES {
            let (first, last) = (range.first, range.first + 2);
            let (letter, kind) = (char::from(range.letter), word(range.kind));
            let meaning =
                format!("a range of {letter} codes that call {kind}s: first code, first program, how many");
            settings.push(SettingReport::new(format!("{first} to {last}"), meaning, "numbers"));
        }
        let meaning = "the address that calls O9004 with #146, O9005 with #147";
        settings.push(SettingReport::new("6090, 6091", meaning, "its character code"));
        let meaning = "a code of the machine builder, also in the table [codes] of a control file: the program it calls, P for that of its word P, or its effect";
        settings.push(SettingReport::new("G120.1, M77", meaning, "O9010, P, nothing or wait"));
        let meaning =
            "a value of the machine that a program for a Haas reads, or the output that an input follows";
        settings.push(SettingReport::new("#20255, #11017", meaning, "a number, #12003 or !#12003"));
        Self { settings }
    }

    /// Formats the settings for a terminal.
    pub(crate) fn text(&self) -> String {
        let line = |SettingReport { key, meaning, allowed }: &SettingReport| {
            format!("{key:<16} {meaning} [{allowed}]\n")
        };
        self.settings.iter().map(line).collect()
    }
}

fn word(kind: CodeCallKind) -> &'static str {
    match kind {
        CodeCallKind::Macro | CodeCallKind::MacroInP | CodeCallKind::Modal => "macro",
        CodeCallKind::Subprogram => "subprogram",
    }
}
