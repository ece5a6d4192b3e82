//! `gcode-sim new project`: a project's file, with what its folder holds already.
#![expect(clippy::disallowed_methods, reason = "the command line finds files")]

use std::path::Path;

use clap::Args;

use super::{ExitStatus, OutputFile, UsageError};
use crate::cli::input;
use gcode_session::files::MACHINE_FILE;

/// Name of a file with settings of the control.
const CONTROL_FILE: &str = "control.toml";

/// Names of folders that hold called programs.
const LIBRARIES: [&str; 3] = ["macros", "lib", "sub"];

#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    file: OutputFile,
}

pub(super) fn run(arguments: &Arguments) -> Result<ExitStatus, UsageError> {
    let folder = arguments.file.path().map_or(Path::new("."), input::folder_of);
    let has_file = |name: &str| folder.join(name).is_file();
    let libraries: Vec<_> = LIBRARIES.into_iter().filter(|name| folder.join(name).is_dir()).collect();
    arguments.file.write(&text(has_file(MACHINE_FILE), has_file(CONTROL_FILE), &libraries))?;
    Ok(ExitStatus::Passed)
}

/// Returns the text of the project's file; a key whose file or folder is absent is commented out.
fn text(has_machine: bool, has_control: bool, libraries: &[&str]) -> String {
    let key = |name: &str, value: String, exists: bool, about: &str| {
        let line = format!("{}{name} = {value}", if exists { "" } else { "# " });
        format!("{line:<30} # {about}")
    };
    let folders = if libraries.is_empty() { &LIBRARIES[..1] } else { libraries };
    let machine = format!("\"{MACHINE_FILE}\"");
    let control = format!("\"{CONTROL_FILE}\"");
    include_str!("project.toml")
        .replace("MACHINE\n", &(key("machine", machine, has_machine, "as --machine") + "\n"))
        .replace("CONTROL\n", &(key("control", control, has_control, "as --control-file") + "\n"))
        .replace(
            "LIBRARIES\n",
            &(key(
                "libraries",
                format!("{folders:?}"),
                !libraries.is_empty(),
                "as --lib: folders of called programs",
            ) + "\n"),
        )
}

#[cfg(test)]
mod tests {
    use super::*;
    use gcode_part::job::project::{ProjectEntry, ProjectFile};
    use std::path::PathBuf;

    fn entry(text: &str) -> ProjectEntry {
        ProjectFile::parse(text).unwrap().entry(Path::new("O1234.nc"))
    }

    #[test]
    fn an_empty_folder_gets_comments_alone() {
        assert_eq!(entry(&text(false, false, &[])), ProjectEntry::default());
    }

    #[test]
    fn what_the_folder_holds_is_named() {
        let entry = entry(&text(true, true, &["macros", "lib"]));
        assert_eq!(entry.machine.as_deref(), Some(Path::new("machine.toml")));
        assert_eq!(entry.control.as_deref(), Some(Path::new("control.toml")));
        assert_eq!(entry.libraries, ["macros", "lib"].map(PathBuf::from));
    }

    #[test]
    fn the_comments_are_keys() {
        let is_key = |line: &str| line.contains(" = ") || line.starts_with('[');
        let lines = text(false, false, &[]);
        let lines =
            lines.lines().map(|line| line.strip_prefix("# ").filter(|rest| is_key(rest)).unwrap_or(line));
        let entry = entry(&lines.collect::<Vec<_>>().join("\n"));
        assert_eq!(entry.reference.as_deref(), Some(Path::new("O1234.csv")));
        assert_eq!(entry.dialect.as_deref(), Some("fanuc-31i"));
    }
}
