//! An emitted job in memory: programs and files by name.

/// Name of the machine file.
pub const MACHINE: &str = "machine.toml";

/// The programs and the machine file of one job.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Package {
    /// The O-numbers of the main programs; most families have one.
    pub mains: Vec<u32>,
    /// The main programs, then the resident macros that they call.
    pub programs: Vec<Program>,
    /// The machine file's text.
    pub machine: String,
}

/// One program of a package.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Program {
    /// Its O-number.
    pub number: u32,
    /// ASCII text, lines ended by LF.
    pub text: String,
}

impl Package {
    /// Returns the files by name: `O8100.nc`, `O8101.nc`, …, `machine.toml`.
    pub fn files(&self) -> Vec<(String, &str)> {
        let programs = self.programs.iter().map(|program| (file_name(program.number), program.text.as_str()));
        programs.chain([(MACHINE.to_owned(), self.machine.as_str())]).collect()
    }

    /// Returns the main program of a job with exactly one.
    pub fn main(&self) -> Option<&Program> {
        match self.mains.as_slice() {
            [main] => self.program(*main),
            _ => None,
        }
    }

    /// Returns the program with this O-number.
    pub fn program(&self, number: u32) -> Option<&Program> {
        self.programs.iter().find(|program| program.number == number)
    }
}

/// Returns the name of a program's file: `O8100.nc`.
pub fn file_name(number: u32) -> String {
    format!("{}.nc", stem(number))
}

/// Returns the beginning of the names of a program's files.
pub(crate) fn stem(number: u32) -> String {
    format!("O{number:04}")
}
