//! The project's file, `gcode.toml`: what the commands use for the programs of a folder and of the folders below it.
//!
//! ```toml
//! machine = "mill3/machine.toml"
//! control = "mill3/control.toml"
//! libraries = ["macros"]
//! allow = ["doubled-n"]
//!
//! [references]
//! "parts/O8100.nc" = "parts/job.toml"
//!
//! [[folder]]
//! path = "haas"
//! dialect = "haas-ngc"
//! ```
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Deserialize;

use super::FileError;
use crate::reader::{FileKey, Items, Located, Reader, Section, names};
use gcode_lang::control::Dialect;

/// Name of the file.
pub const PROJECT_FILE: &str = "gcode.toml";

/// The project's file: what the commands use for the programs of its folder and of the folders below it, unless a flag says
/// otherwise. Paths begin at the folder of the file.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProjectFile {
    /// The machine file, as --machine.
    machine: Option<PathBuf>,
    /// The file with settings of the control, as --control-file.
    control: Option<PathBuf>,
    /// The family of controls, as --dialect.
    #[schemars(extend("enum" = names(&Dialect::ALL)))]
    dialect: Option<Located<String>>,
    /// Folders that hold called programs, searched after those of --lib.
    #[serde(default)]
    libraries: Vec<PathBuf>,
    /// The references of programs, as --reference of verify: a program's path and the path of its hole list or job file.
    #[serde(default)]
    references: BTreeMap<PathBuf, PathBuf>,
    /// Names of rules whose findings check leaves out.
    #[serde(default)]
    allow: Vec<String>,
    /// What differs in a folder. The longest path that contains a program counts, key by key.
    #[serde(default, with = "Items::<Section<FileFolder>>")]
    folder: Vec<FileFolder>,
}

/// What differs in one folder.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FileFolder {
    /// The folder, below that of the file.
    path: PathBuf,
    /// The machine file, as --machine.
    machine: Option<PathBuf>,
    /// The file with settings of the control, as --control-file.
    control: Option<PathBuf>,
    /// The family of controls, as --dialect.
    #[schemars(extend("enum" = names(&Dialect::ALL)))]
    dialect: Option<Located<String>>,
    /// Folders that hold called programs, searched before those of the whole project.
    #[serde(default)]
    libraries: Vec<PathBuf>,
    /// Names of rules whose findings check leaves out, beside those of the whole project.
    #[serde(default)]
    allow: Vec<String>,
}

/// What a project's file says of one program; paths begin at the folder of the file.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct ProjectEntry {
    /// Machine file.
    pub machine: Option<PathBuf>,
    /// Control file.
    pub control: Option<PathBuf>,
    /// Family of controls.
    pub dialect: Option<String>,
    /// Folders of called programs.
    pub libraries: Vec<PathBuf>,
    /// Reference.
    pub reference: Option<PathBuf>,
}

impl ProjectFile {
    /// Parses the text of a project's file.
    ///
    /// # Errors
    /// A syntax error, or a key that is unknown or has a value that is not allowed, with its line.
    pub fn parse(text: &str) -> Result<Self, FileError> {
        let reader = Reader { text };
        let file: Self = reader.parse().map_err(|error| {
            match error.message.strip_prefix("key 'references' is string ") {
                Some(_) => FileError {
                    message: format!(
                        "{}; write [references] and below it \"O1001.nc\" = \"O1001.csv\"",
                        error.message
                    ),
                    ..error
                },
                None => error,
            }
        })?;
        let dialects = file.folder.iter().map(|folder| ("folder.dialect", &folder.dialect));
        for (key, dialect) in std::iter::once(("dialect", &file.dialect)).chain(dialects) {
            if let Some(dialect) = dialect {
                reader.choice(key, dialect, &Dialect::ALL)?;
            }
        }
        Ok(file)
    }

    /// Returns what holds for a program, by its path below the folder of the file.
    pub fn entry(&self, program: &Path) -> ProjectEntry {
        let text = |dialect: &Option<Located<String>>| dialect.as_ref().map(|name| name.as_ref().clone());
        let mut entry = ProjectEntry {
            machine: self.machine.clone(),
            control: self.control.clone(),
            dialect: text(&self.dialect),
            libraries: self.libraries.clone(),
            reference: self.references.get(program).cloned(),
        };
        for folder in self.folders_of(program) {
            entry.machine = folder.machine.clone().or(entry.machine);
            entry.control = folder.control.clone().or(entry.control);
            entry.dialect = text(&folder.dialect).or(entry.dialect);
            entry.libraries.splice(0..0, folder.libraries.iter().cloned());
        }
        entry
    }

    /// Returns a path among the references that has the name of a program without a reference, in another folder or case.
    pub fn misnamed_reference(&self, program: &Path) -> Option<&Path> {
        let name = program.file_name()?;
        let is_like =
            |other: &&PathBuf| other.file_name().is_some_and(|other| other.eq_ignore_ascii_case(name));
        let is_known = self.references.contains_key(program);
        self.references.keys().find(is_like).map(PathBuf::as_path).filter(|_| !is_known)
    }

    /// Returns true if the findings of a rule are left out in a file, by its path below the folder of the project's file.
    pub fn allows(&self, rule: &str, file: &Path) -> bool {
        let allowed = self.folders_of(file).into_iter().flat_map(|folder| &folder.allow);
        self.allow.iter().chain(allowed).any(|name| name.eq_ignore_ascii_case(rule))
    }

    /// Iterates over the names of all rules that are left out somewhere.
    pub fn allowed_rules(&self) -> impl Iterator<Item = &str> {
        let folders = self.folder.iter().flat_map(|folder| &folder.allow);
        self.allow.iter().chain(folders).map(String::as_str)
    }

    /// Returns the sections of the folders that contain a file, the outermost first.
    fn folders_of(&self, file: &Path) -> Vec<&FileFolder> {
        let mut folders: Vec<_> =
            self.folder.iter().filter(|folder| file.starts_with(&folder.path)).collect();
        folders.sort_by_key(|folder| folder.path.components().count());
        folders
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "\
machine = \"mill3/machine.toml\"
libraries = [\"macros\"]
allow = [\"doubled-n\"]

[references]
\"parts/O8100.nc\" = \"parts/job.toml\"

[[folder]]
path = \"haas/old\"
control = \"haas/old.toml\"
libraries = [\"haas/old/lib\"]

[[folder]]
path = \"haas\"
machine = \"haas/machine.toml\"
dialect = \"haas-ngc\"
control = \"haas/control.toml\"
libraries = [\"haas/lib\"]
allow = [\"unreachable\"]
";

    #[test]
    fn the_innermost_folder_decides_key_by_key() {
        let file = ProjectFile::parse(TEXT).unwrap();
        let entry = file.entry(Path::new("parts/O8100.nc"));
        assert_eq!(entry.machine.as_deref(), Some(Path::new("mill3/machine.toml")));
        assert_eq!(entry.reference.as_deref(), Some(Path::new("parts/job.toml")));
        assert_eq!((entry.control, entry.dialect), (None, None));
        let entry = file.entry(Path::new("haas/old/O1.nc"));
        assert_eq!(entry.machine.as_deref(), Some(Path::new("haas/machine.toml")));
        assert_eq!(entry.control.as_deref(), Some(Path::new("haas/old.toml")));
        assert_eq!(entry.dialect.as_deref(), Some("haas-ngc"));
        assert_eq!(entry.libraries, ["haas/old/lib", "haas/lib", "macros"].map(PathBuf::from));
        assert_eq!(entry.reference, None);
    }

    #[test]
    fn a_rule_is_left_out_in_its_folder() {
        let file = ProjectFile::parse(TEXT).unwrap();
        assert!(
            file.allows("doubled-n", Path::new("O1.nc")) && file.allows("doubled-n", Path::new("haas/O1.nc"))
        );
        assert!(file.allows("unreachable", Path::new("haas/O1.nc")));
        assert!(!file.allows("unreachable", Path::new("haas2/O1.nc")), "a folder of another name");
        assert_eq!(file.allowed_rules().collect::<Vec<_>>(), ["doubled-n", "unreachable"]);
    }

    #[test]
    fn a_wrong_key_is_named_with_its_line() {
        for (text, message) in [
            ("machin = \"m.toml\"\n", "line 1: key 'machin' is unknown"),
            ("\ndialect = \"fanuc\"\n", "line 2: key 'dialect' is 'fanuc'"),
            ("[[folder]]\nmachine = \"m.toml\"\n", "line 1: key 'folder.path' is missing"),
        ] {
            let error = ProjectFile::parse(text).unwrap_err().to_string();
            assert!(error.starts_with(message), "{error}");
        }
    }
}
