//! Errors that prevent a run.
use super::Request;
use gcode_lang::alarm::Alarm;
use gcode_lang::program::{Memory, Program};
use gcode_lang::syntax::ast::ProgramPath;

/// An error that prevents a run.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// The file contains no program.
    #[error("{name} contains no program")]
    NoProgram {
        /// The file's name.
        name: String,
    },
    /// The file does not contain the chosen main program.
    #[error("{name} contains no program {program}; it contains {programs}")]
    NoSuchProgram {
        /// The file's name.
        name: String,
        /// The chosen program.
        program: String,
        /// Programs of the file.
        programs: String,
    },
    /// The file contains two programs of the same number or name.
    #[error(
        "{name}, line {line}: {program} is defined twice, and a control refuses the second: give it a \
         number of its own"
    )]
    DuplicateProgram {
        /// The file's name.
        name: String,
        /// Line of the second program.
        line: u32,
        /// Number or name of the program.
        program: String,
    },
    /// A variable cannot be set before the start.
    #[error("#{number} cannot be set: {alarm}")]
    Variable {
        /// Number of the variable.
        number: u32,
        /// The alarm of the assignment.
        alarm: Alarm,
    },
}

/// Returns the error of a main program that the file does not contain; it names the first programs of the file.
pub(super) fn no_such_program(request: &Request, memory: &Memory, path: &ProgramPath) -> SessionError {
    const NAMED: usize = 10;
    let mut programs: Vec<_> = memory.programs().iter().map(Program::path).collect();
    let more = programs.len().saturating_sub(NAMED);
    programs.truncate(NAMED);
    programs.extend((more > 0).then(|| format!("{more} more")));
    let folder = path.folder.as_ref().map_or_else(String::new, ToString::to_string);
    SessionError::NoSuchProgram {
        name: request.name.clone(),
        program: folder + &path.name.label(),
        programs: programs.join(", "),
    }
}
