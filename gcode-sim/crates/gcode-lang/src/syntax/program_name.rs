//! Names of programs, and the folders of a control's memory that hold them.
/// Number or name of a program.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ProgramName {
    /// `O0001`, `:0007` or `<O0123>`.
    Number(u32),
    /// `<BRACKET-OP1>`.
    Name(String),
    /// Main program without an O word.
    Unnamed,
}

impl ProgramName {
    /// Returns the label that a control displays: `O8101`, `<BRACKET-OP1>`; `MAIN` for an unnamed program.
    pub fn label(&self) -> String {
        match self {
            Self::Number(number) => format!("O{number:04}"),
            Self::Name(name) => format!("<{name}>"),
            Self::Unnamed => "MAIN".into(),
        }
    }

    /// Interprets the text of `<text>`: O and digits are a number, any other text is a name.
    pub fn of(text: String) -> Self {
        let digits = text.strip_prefix('O').filter(|digits| digits.bytes().all(|b| b.is_ascii_digit()));
        match digits.and_then(|digits| digits.parse().ok()) {
            Some(number @ 1..=99_999_999) => Self::Number(number),
            _ => Self::Name(text),
        }
    }
}

/// Folders of a control's memory that lie in no other one.
const TOP_FOLDERS: [&str; 4] = ["USER", "MTB1", "MTB2", "SYSTEM"];

/// Folder of a control's memory, without slashes at its ends: `CNC_MEM/USER/PATH1`.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Folder(String);

impl Folder {
    /// Reads a path of a folder line; letter case, surrounding spaces and slashes at the ends do not matter. The control's memory
    /// is the device of a path that names none: `/USER/PATH1/`.
    pub fn new(path: &str) -> Self {
        let path = path.trim().trim_matches('/').to_ascii_uppercase();
        let top = path.split('/').next().unwrap_or_default();
        Self(if TOP_FOLDERS.contains(&top) { format!("CNC_MEM/{path}") } else { path })
    }

    /// Returns true if the path is that of the other folder, or ends with it.
    pub fn ends_with(&self, end: &Self) -> bool {
        self.0.strip_suffix(&end.0).is_some_and(|before| before.is_empty() || before.ends_with('/'))
    }

    /// Returns the path without slashes at its ends.
    pub fn path(&self) -> &str {
        &self.0
    }
}

impl std::fmt::Display for Folder {
    /// Writes the path as a control does: `//CNC_MEM/USER/PATH1/`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "//{}/", self.0)
    }
}

/// Program of a file, with its folder if it is stated.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProgramPath {
    /// Folder; `None` for any.
    pub folder: Option<Folder>,
    /// O number or name.
    pub name: ProgramName,
}

impl ProgramPath {
    /// Reads `O1234`, `1234`, `NAME`, `<NAME>` or `//CNC_MEM/USER/PATH1/O1234`; `None` without a name.
    pub fn parse(text: &str) -> Option<Self> {
        let (folder, name) = match text.trim().rsplit_once('/') {
            Some((folder, name)) => (Some(Folder::new(folder)), name),
            None => (None, text.trim()),
        };
        let name = name.strip_prefix('<').and_then(|name| name.strip_suffix('>')).unwrap_or(name);
        let is_number = !name.is_empty() && name.bytes().all(|b| b.is_ascii_digit());
        let name = if is_number { format!("O{name}") } else { name.to_ascii_uppercase() };
        (!name.is_empty()).then(|| Self { folder, name: ProgramName::of(name) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_ends_with_whole_names() {
        let of = |path: &str, end: &str| Folder::new(path).ends_with(&Folder::new(end));
        assert!(of("//CNC_MEM/USER/PARTS/JOB2/", "JOB2"));
        assert!(of("//CNC_MEM/USER/PARTS/JOB2/", "parts/job2"));
        assert!(!of("//CNC_MEM/USER/PARTS/JOB12/", "JOB2") && !of("JOB12", "JOB2") && of("JOB2", "JOB2"));
    }

    #[test]
    fn a_program_is_chosen_by_number_name_or_path() {
        let path = |text: &str| {
            ProgramPath::parse(text).map(|path| (path.folder.map(|f| f.to_string()), path.name.label()))
        };
        assert_eq!(path("O1234"), Some((None, "O1234".into())));
        assert_eq!(path(" 12 "), Some((None, "O0012".into())));
        assert_eq!(path("<bracket-op1>"), Some((None, "<BRACKET-OP1>".into())));
        let folder = Some("//CNC_MEM/USER/PATH1/".into());
        assert_eq!(path("/cnc_mem/user/path1/o7"), Some((folder.clone(), "O0007".into())));
        assert_eq!(path("/user/path1/o7"), Some((folder, "O0007".into())));
        assert_eq!(path("/JOBS/o7"), Some((Some("//JOBS/".into()), "O0007".into())));
        assert_eq!(path("//CNC_MEM/"), None);
    }
}
