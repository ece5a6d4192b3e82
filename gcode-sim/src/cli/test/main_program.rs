//! Chooses the main program of a case's folder.
use std::path::{Path, PathBuf};

use crate::cli::{UsageError, input, output};
use gcode_lang::control::Settings;
use gcode_lang::program::Memory;
use gcode_lang::syntax::ast::ProgramName;
use gcode_lint::{CalledProgramName, called_programs, main_programs, programs_called_by_others};

/// Main program of a case.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MainProgram {
    pub file: PathBuf,
    /// Path of the program in its file, if the file has several main programs.
    pub path: Option<String>,
}

impl MainProgram {
    fn of_file(file: &Path) -> Self {
        Self { file: file.to_owned(), path: None }
    }

    /// Returns the name that distinguishes it from the other main programs of its folder: `O0001`, `ALL-PROG.O0001`; a
    /// folder of a dump is part of it, `ALL-PROG.CNC_MEM-USER-PATH1-O0001`.
    pub(super) fn label(&self) -> String {
        let stem = self.file.file_stem().unwrap_or_default().to_string_lossy();
        match &self.path {
            None => stem.into_owned(),
            Some(path) => format!("{stem}.{}", path.trim_matches('/').replace(['/', '<', '>'], "-")),
        }
    }
}

/// Returns the main programs of a folder: `main.nc`, the only one that no other program calls, or, if there are several, each
/// that ends a run.
pub(super) fn of(folder: &Path, programs: &[PathBuf]) -> Result<Vec<MainProgram>, UsageError> {
    let is_main = |path: &&PathBuf| path.file_stem().is_some_and(|stem| stem == "main");
    if let Some(main) = programs.iter().find(is_main) {
        return Ok(vec![MainProgram::of_file(main)]);
    }
    let files = programs.iter().map(|path| ProgramFile::read(path)).collect::<Result<Vec<_>, _>>()?;
    let mut candidates = uncalled(files);
    let mut mains = Vec::new();
    let mut left_out = Vec::new();
    for file in candidates.iter_mut() {
        match &file.mains()[..] {
            [] => left_out.push(file.path),
            [_] => mains.push(MainProgram::of_file(file.path)),
            several => {
                let of_path = |path: &String| MainProgram {
                    path: Some(path.clone()),
                    ..MainProgram::of_file(file.path)
                };
                mains.extend(several.iter().map(of_path));
            }
        }
    }
    if let ([], [only]) = (&mains[..], &candidates[..]) {
        return Ok(vec![MainProgram::of_file(only.path)]);
    }
    if !mains.is_empty() {
        for file in left_out {
            output::print_message(&format!(
                "note: {}: no program calls it by its number, and it ends no run: it is not a case\n",
                file.display()
            ));
        }
        return Ok(mains);
    }
    let names: Vec<_> = candidates.iter().filter_map(|file| file.path.file_name()?.to_str()).collect();
    let which = if names.is_empty() {
        "only programs that call one another".to_owned()
    } else {
        format!("several programs that no other calls and that do not end a run, {}", names.join(", "))
    };
    Err(UsageError::new(format!("{} contains {which}: name the main program main.nc", folder.display())))
}

/// A file with its programs.
struct ProgramFile<'p> {
    path: &'p Path,
    memory: Memory,
}

impl<'p> ProgramFile<'p> {
    fn read(path: &'p Path) -> Result<Self, UsageError> {
        let mut memory = Memory::default();
        memory.load(path.display().to_string(), input::program(path)?);
        Ok(Self { path, memory })
    }

    /// Returns the paths of the main programs.
    fn mains(&mut self) -> Vec<String> {
        let called = programs_called_by_others(&mut self.memory, &Settings::default());
        let mains = main_programs(&self.memory, &called);
        mains.into_iter().map(|id| self.memory.get(id).path()).collect()
    }

    fn calls(&mut self) -> Vec<CalledProgramName> {
        let (memory, settings) = (&mut self.memory, Settings::default());
        memory.ids().flat_map(|id| called_programs(memory.lower_program(id), &settings)).collect()
    }

    fn is_called_by(&self, call: &CalledProgramName) -> bool {
        let has = |name: ProgramName| self.memory.programs().iter().any(|program| program.name == name);
        match call {
            CalledProgramName::Number(number) => has(ProgramName::Number(*number)),
            CalledProgramName::Name(name) => has(ProgramName::of(name.clone())),
            CalledProgramName::Computed | CalledProgramName::Missing => false,
        }
    }
}

/// Returns the files whose programs none of the others calls.
fn uncalled(mut files: Vec<ProgramFile<'_>>) -> Vec<ProgramFile<'_>> {
    let calls: Vec<_> = files.iter_mut().map(ProgramFile::calls).collect();
    let is_uncalled = |(index, file): &(usize, ProgramFile<'_>)| {
        let others = calls.iter().enumerate().filter(|(other, _)| other != index);
        !others.flat_map(|(_, calls)| calls).any(|call| file.is_called_by(call))
    };
    files.into_iter().enumerate().filter(is_uncalled).map(|(_, file)| file).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the labels of the main programs of a folder with these programs, or the error.
    fn chosen(files: &[(&str, &str)]) -> Result<Vec<String>, String> {
        let folder = tempfile::tempdir().unwrap();
        let paths: Vec<PathBuf> = files.iter().map(|(name, _)| folder.path().join(name)).collect();
        for (path, (_, text)) in paths.iter().zip(files) {
            output::write(path, text.as_bytes()).unwrap();
        }
        match of(Path::new("part"), &paths) {
            Ok(mains) => Ok(mains.iter().map(MainProgram::label).collect()),
            Err(refusal) => Err(refusal.to_string()),
        }
    }

    fn labels(names: &[&str]) -> Result<Vec<String>, String> {
        Ok(names.iter().map(|name| (*name).to_owned()).collect())
    }

    #[test]
    fn the_main_program_is_the_one_that_no_other_calls() {
        let row = ("O9001.nc", "O9001\nG66 P9002\nG67\nM99\n");
        let hole = ("hole.nc", "O9002\nM99\n");
        assert_eq!(chosen(&[("O1.nc", "O1\nG65 P9001\nM30\n"), row, hole]), labels(&["O1"]));
        // A program that calls itself is not called by another.
        assert_eq!(chosen(&[("O1.nc", "O1\nM98 P1\nM98 P9002\nM30\n"), hole]), labels(&["O1"]));
        assert_eq!(chosen(&[("main.nc", "O1\nM30\n"), hole]), labels(&["main"]));
        assert_eq!(chosen(&[hole]), labels(&["hole"]));
        // A computed call may call the other, which ends no run.
        assert_eq!(chosen(&[("O1.nc", "O1\nM98 P#1\nM30\n"), hole]), labels(&["O1"]));
    }

    #[test]
    fn each_program_that_ends_a_run_is_a_case() {
        let (one, two) = (("O1.nc", "O1\nM98 P9002\nM30\n"), ("O2.tap", "O2\nM98 P9002\nM02\n"));
        let hole = ("O9002.nc", "O9002\nM99\n");
        assert_eq!(chosen(&[one, two, hole]), labels(&["O1", "O2"]));
        let dump = "%\nO1\nM98 P3\nM30\nO2\nM30\nO3\nM99\n%\n";
        assert_eq!(chosen(&[("ALL-PROG.TXT", dump)]), labels(&["ALL-PROG.O0001", "ALL-PROG.O0002"]));
        let beside = [("ALL-PROG.TXT", dump), ("x.nc", "O5\nM30\n"), ("y.nc", "O6\nM99\n")];
        assert_eq!(chosen(&beside), labels(&["ALL-PROG.O0001", "ALL-PROG.O0002", "x"]));
    }

    #[test]
    fn a_folder_without_a_main_program_is_refused() {
        assert_eq!(
            chosen(&[("O1.nc", "O1\nM98 P9002\nM30\n"), ("O9002.nc", "O9002\nM98 P1\nM99\n")]),
            Err("part contains only programs that call one another: name the main program main.nc".to_owned())
        );
    }
}
