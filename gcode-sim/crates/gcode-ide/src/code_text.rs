//! Meanings of G codes, M codes and addresses on a control.
use gcode_lang::control::{CalledProgram, CodeCallKind, Settings};
use gcode_lang::program::g_codes::{self, Effect, GCodeRow};
use gcode_lang::program::m_codes::{M_CODES, MCodeEffect, MCodeRow};

/// Returns the row of a G code × 10 on a control.
pub(crate) fn g_row(code: u32, settings: &Settings) -> Option<&'static GCodeRow> {
    g_codes::row_on(code, g_codes::find(code), settings)
}

/// Returns the meaning of a G code × 10; `None` for a code that the control lacks.
pub(crate) fn g_text(code: u32, settings: &Settings) -> Option<String> {
    if let Some(called) = settings.code_calls.find_call(b'G', code) {
        return Some(call_text(called));
    }
    let row = g_row(code, settings)?;
    let group = row.group().map_or_else(
        || {
            if matches!(row.effect, Effect::OneShot(_)) {
                ", acts in its block".into()
            } else {
                String::new()
            }
        },
        |group| format!(", modal group {group:02}"),
    );
    let simulated = if row.effect == Effect::NotSimulated { "; not simulated" } else { "" };
    Some(format!("{}{group}{simulated}", row.description))
}

/// Returns the row of an M code on a control.
pub(crate) fn m_row(code: u32, settings: &Settings) -> Option<&'static MCodeRow> {
    M_CODES.iter().find(|row| row.code == code && row.dialects.contains(&settings.codes))
}

/// Returns the meaning of an M code.
pub(crate) fn m_text(code: u32, settings: &Settings) -> String {
    if let Some(called) = code.checked_mul(10).and_then(|code| settings.code_calls.find_call(b'M', code)) {
        return call_text(called);
    }
    match m_row(code, settings) {
        Some(row) if row.effect == MCodeEffect::NotSimulated => format!("{}; not simulated", row.description),
        Some(row) => row.description.to_owned(),
        None => "code of the machine builder".to_owned(),
    }
}

fn call_text(called: CalledProgram) -> String {
    let program = called.program;
    match called.kind {
        CodeCallKind::Macro => format!("calls O{program:04} as G65 does: the other words are arguments"),
        CodeCallKind::Modal => format!("calls O{program:04} as G66 does, until G67"),
        CodeCallKind::MacroInP => "calls the program in P as G65 does".to_owned(),
        CodeCallKind::Subprogram => format!("calls O{program:04} as M98 does"),
    }
}

/// What a block is, as far as it decides the meaning of its addresses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct BlockKind {
    pub is_cycle: bool,
    pub is_arc: bool,
    pub is_dwell: bool,
    pub is_subprogram_call: bool,
    pub is_macro_call: bool,
    pub is_return: bool,
}

/// Returns the meaning of an address.
pub(crate) fn address_text(letter: u8, block: BlockKind, settings: &Settings) -> Option<String> {
    let text = match letter {
        b'X' | b'U' | b'P' if block.is_dwell => {
            if letter == b'P' {
                "time, milliseconds"
            } else {
                "time, seconds"
            }
        }
        b'P' if block.is_subprogram_call || block.is_macro_call => "number of the called program",
        b'P' if block.is_return => "sequence number in the calling program where it continues",
        b'L' if block.is_subprogram_call || block.is_macro_call => "number of calls",
        b'Q' if block.is_subprogram_call => "sequence number at which the called program starts",
        b'R' if block.is_cycle => "R point level",
        b'Q' if block.is_cycle => "depth of a peck, or the shift of a boring cycle",
        b'P' if block.is_cycle => "dwell at the bottom, milliseconds",
        b'K' | b'L' if block.is_cycle => "number of repeats",
        b'Z' if block.is_cycle => "bottom of the hole",
        b'I' | b'J' | b'K' if block.is_arc => "centre of the arc from its start",
        b'R' if block.is_arc => "radius of the arc",
        b'F' => "feed rate",
        b'S' => "spindle speed",
        b'T' => "tool",
        b'H' => "number of the tool length offset",
        b'D' => "number of the cutter radius offset",
        b'N' => "sequence number",
        b'O' => "program number",
        letter if settings.axes.find(letter).is_some() => {
            let rotary = matches!(letter, b'A' | b'B' | b'C');
            return Some(format!("{} axis {}", if rotary { "rotary" } else { "linear" }, char::from(letter)));
        }
        _ => return None,
    };
    Some(text.to_owned())
}
