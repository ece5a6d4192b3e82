//! What an emitted job consists of, before anything is written: programs and files by name.

/// The programs and the machine file of one job.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Package {
    /// The main program's O-number.
    pub main: u32,
    pub programs: Vec<Program>,
    /// The machine file's text.
    pub machine: String,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Program {
    pub number: u32,
    /// In ASCII, lines ended by LF.
    pub text: String,
}

impl Package {
    /// What is written where: `O8100.nc`, `O8101.nc`, …, `machine.toml`.
    pub fn files(&self) -> Vec<(String, &str)> {
        let programs = self.programs.iter().map(|program| (file_name(program.number), program.text.as_str()));
        programs.chain([("machine.toml".to_owned(), self.machine.as_str())]).collect()
    }

    pub fn program(&self, number: u32) -> Option<&Program> {
        self.programs.iter().find(|program| program.number == number)
    }
}

pub fn file_name(number: u32) -> String {
    format!("O{number:04}.nc")
}
