//! The programs of the folders of a workspace, read in the background.
use std::path::{Path, PathBuf};

use gcode_session::files::{FileAccess, begins_program, program_number};

use crate::overlay::Overlay;

/// Largest number of folders that are looked through.
const MAX_FOLDERS: usize = 5000;

/// Largest number of programs that are read.
const MAX_PROGRAMS: usize = 5000;

/// Endings of program files.
pub(crate) const ENDINGS: [&str; 13] =
    ["nc", "tap", "cnc", "eia", "min", "ncd", "ngc", "gcode", "prg", "pim", "fan", "o", "mpf"];

/// Returns true for a file whose name is that of a program: a usual ending, or `O1234` without one.
pub(crate) fn is_program_name(path: &Path) -> bool {
    match path.extension().and_then(|ending| ending.to_str()) {
        Some(ending) => ENDINGS.iter().any(|known| ending.eq_ignore_ascii_case(known)),
        None => program_number(path).is_some(),
    }
}

/// Returns true for a file that holds programs, by its name or by its first line.
pub(crate) fn is_program(path: &Path, files: &Overlay) -> bool {
    const MAYBE: [&str; 2] = ["txt", "dat"];
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    let is_candidate = ending.is_empty() || MAYBE.iter().any(|known| ending.eq_ignore_ascii_case(known));
    // A binary file can be long: it is not read to its end.
    let is_text = || files.is_open(path) || files.host().is_text(path);
    is_program_name(path)
        || is_candidate && is_text() && files.program(path).is_ok_and(|text| begins_program(&text))
}

/// Calls `each` with every program file below the folders, as far as the limits allow.
pub(crate) fn scan(files: &Overlay, folders: &[PathBuf], mut each: impl FnMut(PathBuf)) {
    let mut waiting: Vec<PathBuf> = folders.iter().rev().cloned().collect();
    let (mut seen, mut found) = (0, 0);
    while let Some(folder) = waiting.pop() {
        seen += 1;
        if MAX_FOLDERS < seen {
            return;
        }
        for path in files.files(&folder).unwrap_or_default() {
            if is_program(&path, files) {
                each(path);
                found += 1;
            }
            if found == MAX_PROGRAMS {
                return;
            }
        }
        waiting.extend(files.host().folders(&folder).into_iter().filter(|path| !is_left_out(path)));
    }
}

/// Returns true for folders of tools: hidden ones, and those of build results.
fn is_left_out(folder: &Path) -> bool {
    let name = folder.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    name.starts_with('.') || matches!(name, "target" | "node_modules")
}
