//! Main programs of a memory: those that end a run and that no other program calls.
use std::collections::BTreeSet;

use gcode_lang::control::Settings;
use gcode_lang::program::{LoweredWord, Memory, Program, ProgramId};

use super::calls::{CalledProgramName, called_programs};
use super::literal;

/// Returns the programs that other programs in memory call.
pub fn programs_called_by_others(memory: &mut Memory, settings: &Settings) -> BTreeSet<ProgramId> {
    let ids: Vec<_> = memory.ids().collect();
    let calls = ids.into_iter().flat_map(|id| {
        let called = called_programs(memory.lower_program(id), settings);
        let folder = memory.get(id).folder.as_ref();
        let targets: Vec<_> = called.iter().filter_map(|name| name.find(memory, folder)).collect();
        targets.into_iter().filter(move |target| *target != id)
    });
    calls.collect()
}

/// Returns the programs with M02 or M30 that are not among those [called by others](programs_called_by_others), in the order
/// loaded.
pub fn main_programs(memory: &Memory, called: &BTreeSet<ProgramId>) -> Vec<ProgramId> {
    memory.ids().filter(|id| !called.contains(id) && ends_run(memory.get(*id))).collect()
}

/// Returns the main program with those that its calls can reach: all programs if one of them computes the number of a program.
pub fn reachable_programs(memory: &mut Memory, settings: &Settings) -> BTreeSet<ProgramId> {
    // A long program alone isn't read for its calls.
    if memory.programs().len() == 1 {
        return memory.ids().collect();
    }
    let mut reached = BTreeSet::from([memory.main()]);
    let mut pending = vec![memory.main()];
    while let Some(id) = pending.pop() {
        let called = called_programs(memory.lower_program(id), settings);
        if called.contains(&CalledProgramName::Computed) {
            return memory.ids().collect();
        }
        let folder = memory.get(id).folder.as_ref();
        let targets = called.iter().filter_map(|name| name.find(memory, folder));
        pending.extend(targets.filter(|target| reached.insert(*target)));
    }
    reached
}

/// Returns true if the program contains M02 or M30.
fn ends_run(program: &Program) -> bool {
    let is_end =
        |word: &LoweredWord| word.letter == b'M' && matches!(literal::word_count(word), Some(2 | 30));
    program.ops().iter().filter_map(|op| op.kind().words()).any(|words| words.list.iter().any(is_end))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(text: &str) -> Vec<String> {
        let mut memory = Memory::default();
        memory.load("dump.txt", text.as_bytes());
        let called = programs_called_by_others(&mut memory, &Settings::default());
        main_programs(&memory, &called).iter().map(|id| memory.get(*id).path()).collect()
    }

    #[test]
    fn a_main_program_ends_the_run_and_nothing_calls_it() {
        assert_eq!(names("O1\nM98 P2\nM30\nO2\nM99\nO3\nM30\nO4\nM99\n"), ["O0001", "O0003"]);
        assert_eq!(names("O1\nM98 P2\nM30\nO2\nM98 P1\nM30\n"), Vec::<String>::new());
        assert_eq!(names("O1\nIF[#1EQ#0]GOTO1\nM98 P1\nN1 M02\n"), ["O0001"], "a program may call itself");
    }

    #[test]
    fn calls_reach_programs() {
        let reached = |text: &str| {
            let mut memory = Memory::default();
            memory.load("dump.txt", text.as_bytes());
            let reached = reachable_programs(&mut memory, &Settings::default());
            reached.iter().map(|id| memory.get(*id).path()).collect::<Vec<_>>()
        };
        assert_eq!(
            reached("O1\nM98 P3\nM30\nO2\nM98 P1\nM30\nO3\nG65 P4\nM99\nO4\nM99\n"),
            ["O0001", "O0003", "O0004"]
        );
        assert_eq!(reached("O1\nM98 P3\nM30\nO2\nM30\nO3\nM98 P#1\nM99\n"), ["O0001", "O0002", "O0003"]);
        assert_eq!(reached("O1\nM98 P3\nM30\nO2\nM98 P#1\nM99\nO3\nM99\n"), ["O0001", "O0003"]);
    }

    #[test]
    fn folders_have_main_programs_of_their_own() {
        let text = "%\n&F=//CNC_MEM/USER/PATH1/\nO1\nM98 P2\nM30\n&F=//CNC_MEM/USER/PATH2/\nO1\nM30\n\
                    &F=/CNC_MEM/USER/LIBRARY\nO2\nM99\n%\n";
        assert_eq!(names(text), ["//CNC_MEM/USER/PATH1/O0001", "//CNC_MEM/USER/PATH2/O0001"]);
    }
}
