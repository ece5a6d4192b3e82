//! Tells that a machine file is there and isn't used: forgetting `--machine` is easily done, and the holes of another
//! machine are other holes.
use std::path::Path;

use super::args::ProgramArguments;
use super::output;
use crate::session::Request;

/// The name that the generator gives a machine file.
const NAME: &str = "machine.toml";

/// Says so where no `--machine` is given and one is at hand, or where the program's own remarks name one.
pub(super) fn tell(arguments: &ProgramArguments, request: &Request) {
    if arguments.conditions.machine.is_some() {
        return;
    }
    let beside = arguments.program.with_file_name(NAME);
    let piped = arguments.program == Path::new("-");
    let what = if !piped && beside.is_file() {
        let file = beside.display();
        format!("{file} stands beside the program and isn't used: --machine {file}")
    } else if names_one(&request.bytes) {
        "the program's remarks name a machine file, and none is used: --machine MACHINE.toml".to_owned()
    } else {
        return;
    };
    output::tell(&format!("note: {what}\n"));
}

/// As the header of an emitted program does, which stands at the top of it.
fn names_one(program: &[u8]) -> bool {
    const WORDS: &[u8] = b"MACHINE FILE";
    const TOP: usize = 65_536;
    program[..program.len().min(TOP)].windows(WORDS.len()).any(|part| part.eq_ignore_ascii_case(WORDS))
}
