//! Chooses the main program of a case's folder.
use std::path::{Path, PathBuf};

use crate::cli::{UsageError, input};
use gcode_lang::control::Settings;
use gcode_lang::program::Memory;
use gcode_lang::syntax::ast::ProgramName;
use gcode_lint::{CalledProgramName, called_programs};

/// Returns `main.nc`, the only program, or the only one that no other calls: a main program with its macros.
pub(super) fn of(folder: &Path, programs: &[PathBuf]) -> Result<PathBuf, UsageError> {
    let is_main = |path: &&PathBuf| path.file_stem().is_some_and(|stem| stem == "main");
    if let Some(main) = programs.iter().find(is_main) {
        return Ok(main.clone());
    }
    if let [only] = programs {
        return Ok(only.clone());
    }
    let candidates = uncalled(programs)?;
    if let [only] = candidates[..] {
        return Ok(only.clone());
    }
    let names: Vec<_> = candidates.iter().filter_map(|path| path.file_name()?.to_str()).collect();
    let which = if names.is_empty() {
        "only programs that call one another".to_owned()
    } else {
        format!("several programs that no other calls, {}", names.join(", "))
    };
    Err(UsageError::new(format!("{} contains {which}: name the main program main.nc", folder.display())))
}

/// Returns the programs that none of the others calls.
fn uncalled(programs: &[PathBuf]) -> Result<Vec<&PathBuf>, UsageError> {
    let settings = Settings::default();
    let mut files = Vec::with_capacity(programs.len());
    for path in programs {
        let mut memory = Memory::default();
        memory.load(path.display().to_string(), input::bytes(path)?);
        let calls: Vec<CalledProgramName> =
            memory.ids().flat_map(|id| called_programs(memory.lower_program(id), &settings)).collect();
        let names: Vec<ProgramName> = memory.programs().iter().map(|p| p.name.clone()).collect();
        files.push((path, names, calls));
    }
    let is_called = |names: &[ProgramName], call: &CalledProgramName| match call {
        CalledProgramName::Number(number) => names.contains(&ProgramName::Number(*number)),
        CalledProgramName::Name(name) => names.contains(&ProgramName::of(name.clone())),
        CalledProgramName::Computed | CalledProgramName::Missing => false,
    };
    let from_others = |path: &PathBuf, names: &[ProgramName]| {
        let others = files.iter().filter(|(other, ..)| *other != path);
        others.flat_map(|(.., calls)| calls).any(|call| is_called(names, call))
    };
    Ok(files.iter().filter(|(path, names, _)| !from_others(path, names)).map(|(path, ..)| *path).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::output;

    /// Returns the file chosen from a folder with these programs, or the error.
    fn chosen(files: &[(&str, &str)]) -> Result<String, String> {
        let folder = tempfile::tempdir().unwrap();
        let paths: Vec<PathBuf> = files.iter().map(|(name, _)| folder.path().join(name)).collect();
        for (path, (_, text)) in paths.iter().zip(files) {
            output::write(path, text.as_bytes()).unwrap();
        }
        match of(Path::new("part"), &paths) {
            Ok(path) => Ok(path.file_name().unwrap().to_string_lossy().into_owned()),
            Err(refusal) => Err(refusal.to_string()),
        }
    }

    #[test]
    fn the_main_program_is_the_one_that_no_other_calls() {
        let row = ("O9001.nc", "O9001\nG66 P9002\nG67\nM99\n");
        let hole = ("hole.nc", "O9002\nM99\n");
        assert_eq!(chosen(&[("O1.nc", "O1\nG65 P9001\nM30\n"), row, hole]), Ok("O1.nc".to_owned()));
        // A program that calls itself is not called by another.
        assert_eq!(chosen(&[("O1.nc", "O1\nM98 P1\nM98 P9002\nM30\n"), hole]), Ok("O1.nc".to_owned()));
        assert_eq!(chosen(&[("main.nc", "O1\nM30\n"), hole]), Ok("main.nc".to_owned()));
        assert_eq!(chosen(&[hole]), Ok("hole.nc".to_owned()));
    }

    #[test]
    fn an_ambiguous_main_program_is_refused() {
        let hole = ("O9002.nc", "O9002\nM99\n");
        assert_eq!(
            chosen(&[("O1.nc", "O1\nM98 P#1\nM30\n"), hole]),
            Err("part contains several programs that no other calls, O1.nc, O9002.nc: name the main program main.nc"
                .to_owned())
        );
        assert_eq!(
            chosen(&[("O1.nc", "O1\nM98 P9002\nM30\n"), ("O9002.nc", "O9002\nM98 P1\nM99\n")]),
            Err("part contains only programs that call one another: name the main program main.nc".to_owned())
        );
    }
}
