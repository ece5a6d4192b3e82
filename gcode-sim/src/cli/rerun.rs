//! The command that runs a counterexample: the program with every flag on which its end depends.
use std::path::Path;

use super::conditions::RunConditions;
use crate::report::proof::Counterexample;

/// Largest number of blocks of a run without a flag.
const MAX_BLOCKS: u64 = 10_000_000;

/// Program and conditions of a proof, as flags of `gcode-sim run`.
#[derive(Debug)]
pub(super) struct Rerun {
    program: String,
    /// Folder of the program.
    folder: String,
    flags: Vec<String>,
    call: Option<String>,
}

impl Rerun {
    pub(super) fn new(program: &Path, conditions: &RunConditions, call: Option<String>) -> Self {
        let folder = program.parent().map(|folder| folder.display().to_string());
        let folder = folder.filter(|folder| !folder.is_empty()).unwrap_or_else(|| ".".to_owned());
        Self {
            program: quoted(&program.display().to_string()),
            folder,
            flags: flags(conditions, call.is_some()),
            call,
        }
    }
}

impl Counterexample for Rerun {
    fn call(&self) -> Option<&str> {
        self.call.as_deref()
    }

    fn command(&self, sets: &[String], settings: &[String]) -> String {
        let mut words = Vec::new();
        match &self.call {
            // The block and M30 before the file's own programs, as one text.
            Some(call) => {
                let call = quoted(call);
                words.push(format!("{{ printf '%s\\n' O{CALLER} {call} M30; cat {}; }} |", self.program));
                words.push(format!("gcode-sim run - --program O{CALLER} --lib {}", quoted(&self.folder)));
            }
            None => words.push(format!("gcode-sim run {}", self.program)),
        }
        words.extend(sets.iter().map(|set| format!("--set '{set}'")));
        words.extend(self.flags.iter().cloned());
        words.extend(settings.iter().map(|setting| format!("--control {}", quoted(setting))));
        words.join(" ")
    }
}

/// Number of the program that calls the one of the proof.
const CALLER: u32 = 9999;

/// Returns the flags of conditions as they are typed.
fn flags(conditions: &RunConditions, is_called: bool) -> Vec<String> {
    let path = |path: &std::path::PathBuf| path.display().to_string();
    let mut flags = Vec::new();
    let mut add = |name: &str, value: String| flags.push(format!("--{name} {}", quoted(&value)));
    // Behind a call the calling program is the main one.
    if let Some(main) = conditions.main_program.as_ref().filter(|_| !is_called) {
        add("program", main.clone());
    }
    conditions.libraries.iter().for_each(|folder| add("lib", path(folder)));
    conditions.set.iter().for_each(|set| add("set", set.clone()));
    conditions.start.iter().for_each(|start| add("start", start.clone()));
    conditions.dialect.iter().for_each(|dialect| add("dialect", dialect.clone()));
    conditions.control.iter().for_each(|setting| add("control", setting.clone()));
    conditions.control_file.iter().for_each(|file| add("control-file", path(file)));
    conditions.input.iter().for_each(|input| add("input", input.clone()));
    conditions.machine.iter().for_each(|file| add("machine", path(file)));
    conditions.code.iter().for_each(|code| add("code", code.clone()));
    conditions.skip.iter().for_each(|skip| add("skip", skip.to_string()));
    conditions.cycles.iter().for_each(|cycles| add("cycles", cycles.to_string()));
    if conditions.max_blocks != MAX_BLOCKS {
        add("max-blocks", conditions.max_blocks.to_string());
    }
    flags
}

/// Returns a word as a shell reads it.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./=:,+".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_has_every_flag_of_the_proof() {
        let conditions = RunConditions {
            libraries: vec!["my macros".into()],
            set: vec!["#500=1".to_owned()],
            dialect: Some("haas-ngc".to_owned()),
            control: vec!["NAT=1".to_owned()],
            max_blocks: 10_000_000,
            ..RunConditions::default()
        };
        let sets = ["#1=0.5".to_owned()];
        let rerun = Rerun::new(Path::new("a/b.nc"), &conditions, None);
        assert_eq!(
            rerun.command(&sets, &["1320=X50.".to_owned()]),
            "gcode-sim run a/b.nc --set '#1=0.5' --lib 'my macros' --set '#500=1' --dialect haas-ngc --control NAT=1 \
             --control 1320=X50."
        );
        let limited = RunConditions { max_blocks: 50, ..RunConditions::default() };
        let called = Rerun::new(Path::new("b.nc"), &limited, Some("G65 P2 A#101".to_owned()));
        assert_eq!(
            called.command(&["#101=2".to_owned()], &[]),
            "{ printf '%s\\n' O9999 'G65 P2 A#101' M30; cat b.nc; } | gcode-sim run - --program O9999 --lib . --set '#101=2' \
             --max-blocks 50"
        );
    }

    #[test]
    fn a_word_is_quoted_for_a_shell() {
        assert_eq!(quoted("1320=X-5.,Y2"), "1320=X-5.,Y2");
        assert_eq!(quoted("it's"), "'it'\\''s'");
        assert_eq!(quoted("#1=2"), "'#1=2'");
    }
}
