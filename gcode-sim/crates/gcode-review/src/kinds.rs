//! Kinds of changes and of answers of `test`, one row each, in the order of precedence: the headline of an entry is
//! the effect whose kind comes first. Effects on the part come first, then commands, then their consequences.
use gcode_lang::diag::{Document, FindingKind, Severity};

/// Declares a static [`FindingKind`] per line, and `ALL`. Each row has a section in docs/changes.md with the
/// heading `code: title`.
macro_rules! change_kinds {
    ($($name:ident = $code:literal, $title:literal;)+) => {
        $(
            #[doc = concat!("`", $code, "`: ", $title, ".")]
            pub static $name: FindingKind = FindingKind {
                code: $code,
                severity: Severity::Note,
                title: $title,
                document: Document::Section(include_str!("../../../../docs/changes.md")),
            };
        )+

        /// All rows, in the order of precedence and of the sections.
        pub static ALL: &[&FindingKind] = &[$(&$name),+];
    };
}

change_kinds! {
    OUTCOME = "outcome", "the runs end differently";
    PROGRAM = "program", "the main program has another name";
    HOLE_LOST = "hole-lost", "a hole is missing";
    HOLE_ADDED = "hole-added", "a hole is new";
    HOLE_MOVED = "hole-moved", "a hole has another position";
    HOLE_TILTED = "hole-tilted", "a hole has another direction";
    HOLE_DEPTH = "hole-depth", "a hole is deeper or less deep than before";
    HOLE_DIAMETER = "hole-diameter", "a hole is made by a tool of another diameter";
    HOLE_TOOL = "hole-tool", "a hole is made by another tool";
    HOLE_PASS = "hole-pass", "a pass of a hole ends at another point, and the finished hole is unchanged";
    HOLE_ORDER = "hole-order", "holes are made in a different order";
    MOVE_ORDER = "move-order", "moves are made in a different order";
    START = "start", "the program depends on the state that it starts in";
    WORK_SYSTEM = "work-system", "another work offset is active";
    TOOL_LENGTH = "tool-length", "another tool length offset";
    CUTTER_SIDE = "cutter-side", "another cutter compensation";
    CYCLE = "cycle", "another canned cycle, or another Q";
    RETURN_LEVEL = "return-level", "the rapids between holes run at another level";
    PATH_MODE = "path-mode", "corners are cut in another mode";
    TOOL = "tool", "another tool is called";
    M_CODE = "m-code", "an M code of the machine builder is new, missing or changed";
    SPINDLE = "spindle", "spindle speed, direction or state differs";
    STOP = "stop", "an operator stop is new, missing or has another text";
    MOVE_KIND = "move-kind", "a rapid replaces a feed, or a feed a rapid";
    MOVE_ARC = "move-arc", "an arc has another direction, radius or centre";
    MOVE_SHIFTED = "move-shifted", "a move ends at another point";
    MOVE_ADDED = "move-added", "a move is new";
    MOVE_LOST = "move-lost", "a move is missing";
    FEED = "feed", "a move has another feed";
    DWELL = "dwell", "a dwell is longer, shorter, new or missing";
    COOLANT = "coolant", "the coolant state differs";
    G_CODE = "g-code", "a G code without simulated effect is new, missing or changed";
    BLOCK_SKIP = "block-skip", "a block skip is added or removed";
    SWITCH = "switch", "#3003 or #3004 has another value";
    SIGNAL = "signal", "an output signal is set differently";
    OUTPUT = "output", "printed lines differ";
    WORK_OFFSET = "work-offset", "a work offset has another final value";
    TOOL_OFFSET = "tool-offset", "a tool offset has another final value";
    PARAMETER = "parameter", "a parameter has another final value";
    VARIABLE = "variable", "a common variable has another final value";
    MODE = "mode", "another modal code is active at the end";
    COUNTER = "counter", "the parts counter has another final value";
    UNEXECUTED = "unexecuted", "a changed block is not executed";
    REFERENCE = "reference", "a case has lost its reference";
    CASE_NEW = "case-new", "a case has no accepted result";
    CASE_OLDER = "case-older", "accepted by an earlier version that recorded less";
    CASE_REFUSED = "case-refused", "a case can't be used";
}

/// Returns the precedence of a code, 0 the highest.
pub(crate) fn precedence(code: &str) -> usize {
    ALL.iter().position(|kind| kind.code == code).unwrap_or(ALL.len())
}
